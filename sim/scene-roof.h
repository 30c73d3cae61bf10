#ifndef SIM_SCENE_ROOF_H
#define SIM_SCENE_ROOF_H
/* Pitched roofs with real courses of tiles, and what stands on them. */
#include "sim/scene-facade.h"

struct roof {
	const struct palette *palette;
	uint16_t cover, gable;
	float length, depth, rise; /* ridge along x, eaves at y = 0 and depth, z = 0 */
	float overhang;
	float hip[2]; /* how far the ridge ends before the left and right end; 0 is a gable */
};

void draw_roof(const struct pen *p, const struct roof *r);
/* A sloping quad, a-b its lower edge, d-c its upper, in courses that overlap. */
void draw_tiled(const struct pen *p, vec a, vec b, vec c, vec d);
/* Gabled dormer; its front stands at the pen's origin, towards -y, its back runs into the roof. */
void draw_dormer(
	struct site *s, const struct pen *p, const struct roof *r, float width, float height);
void draw_chimney(
	const struct pen *p, const struct palette *m, float width, float depth, float height);
/* Rows of both along the front slope. */
void furnish_roof(struct site *s, const struct pen *p, const struct roof *r, unsigned dormers,
	unsigned chimneys);
/* Four-sided spire or pyramid over a square tower; z = 0 at its foot. */
void draw_spire(const struct pen *p, float half, float rise);

#endif
