#include "render/scene-units.h"

#define NOT_FREE 255
#define NONE     SCENE_UNITS_NONE

struct scene_units {
	uint32_t count, left;
	uint32_t head[SCENE_UNIT_ORDERS];
	/* Of each unit that begins a free block its order, and its neighbours in the list of these. */
	uint8_t *order;
	uint32_t *next, *before;
};

static void put(scene_units *u, uint32_t unit, uint8_t order)
{
	u->order[unit] = order;
	u->before[unit] = NONE;
	u->next[unit] = u->head[order];
	if (u->head[order] != NONE)
		u->before[u->head[order]] = unit;
	u->head[order] = unit;
}

static void remove_from_list(scene_units *u, uint32_t unit)
{
	uint8_t order = u->order[unit];
	u->order[unit] = NOT_FREE;
	if (u->before[unit] == NONE)
		u->head[order] = u->next[unit];
	else
		u->next[u->before[unit]] = u->next[unit];
	if (u->next[unit] != NONE)
		u->before[u->next[unit]] = u->before[unit];
}

scene_units *scene_units_new(uint32_t count)
{
	const uint8_t whole = SCENE_UNIT_ORDERS - 1;
	scene_units *u = g_new(scene_units, 1);
	u->count = u->left = count >> whole << whole;
	u->order = g_malloc(u->count + 1);
	u->next = g_new(uint32_t, u->count + 1);
	u->before = g_new(uint32_t, u->count + 1);
	for (uint32_t k = 0; k < SCENE_UNIT_ORDERS; k++)
		u->head[k] = NONE;
	for (uint32_t n = 0; n < u->count; n++)
		u->order[n] = NOT_FREE;
	/* The lowest first. */
	for (uint32_t n = u->count; n > 0; n -= 1u << whole)
		put(u, n - (1u << whole), whole);
	return u;
}

void scene_units_free(scene_units *u)
{
	if (!u)
		return;
	g_free(u->order);
	g_free(u->next);
	g_free(u->before);
	g_free(u);
}

uint32_t scene_units_take(scene_units *u, uint8_t order)
{
	uint8_t larger = order;
	while (larger < SCENE_UNIT_ORDERS && u->head[larger] == NONE)
		larger++;
	if (larger == SCENE_UNIT_ORDERS)
		return NONE;
	uint32_t unit = u->head[larger];
	remove_from_list(u, unit);
	while (larger > order) {
		larger--;
		put(u, unit + (1u << larger), larger);
	}
	u->left -= 1u << order;
	return unit;
}

void scene_units_give(scene_units *u, uint32_t unit, uint8_t order)
{
	u->left += 1u << order;
	for (; order + 1u < SCENE_UNIT_ORDERS; order++) {
		uint32_t buddy = unit ^ 1u << order;
		if (u->order[buddy] != order)
			break;
		remove_from_list(u, buddy);
		unit &= ~(1u << order);
	}
	put(u, unit, order);
}

uint32_t scene_units_left(const scene_units *u)
{
	return u->left;
}

uint32_t scene_units_count(const scene_units *u)
{
	return u->count;
}
