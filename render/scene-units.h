#ifndef RENDER_SCENE_UNITS_H
#define RENDER_SCENE_UNITS_H
/* Room for points, in units of 512: blocks of one, two, four or eight of them, as a chunk of so many points needs. Two halves of a block
 * that are free become one again (Knowlton 1965, "A fast storage allocator": buddies). Not thread-safe. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define SCENE_UNIT_POINTS 512u
#define SCENE_UNIT_ORDERS 4u
#define SCENE_UNITS_NONE  UINT32_MAX

typedef struct scene_units scene_units;
/* All of them are free; count becomes a multiple of eight. */
scene_units *scene_units_new(uint32_t count);
void scene_units_free(scene_units *u); /* NULL is fine */
/* The order of the block that so many points need: of 2^order units. */
static inline uint8_t scene_units_order(uint32_t count)
{
	uint8_t order = 0;
	while ((SCENE_UNIT_POINTS << order) < count)
		order++;
	return order;
}
/* The first unit of a block; SCENE_UNITS_NONE: there is none of this size. */
uint32_t scene_units_take(scene_units *u, uint8_t order);
void scene_units_give(scene_units *u, uint32_t unit, uint8_t order);
uint32_t scene_units_left(const scene_units *u); /* in blocks of any size */
uint32_t scene_units_count(const scene_units *u);

#endif
