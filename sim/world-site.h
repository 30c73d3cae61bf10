#ifndef SIM_WORLD_SITE_H
#define SIM_WORLD_SITE_H
/* A site: a world while it is built, and the parts that the finished world keeps.
 *
 * Scenes draw into it with pens. What stands many times (trees, shrubs) is drawn once as a model
 * and placed by frames. Places are claimed as discs on the ground, those of the walk first, so
 * nothing stands in another's way. */
#include "sim/geometry.h"
#include "sim/material.h"
#include "sim/noise.h"
#include "sim/world.h"

struct placement {
	struct frame at; /* model to world */
	uint32_t model;
	uint16_t object;
};

struct disc {
	float x, y, radius;
};

struct light {
	vec towards_sun;
	vec sun; /* radiance of a white surface that faces the sun, from the sun alone */
	vec zenith, horizon, ground; /* radiance of the sky, and of what is below it */
	vec fill;                    /* light from everywhere, for interiors */
	float clouds;                /* 0..1 */
	float haze_m;                /* distance at which 63 % is haze */
};

/* Where light is gathered beforehand. */
struct bounds {
	vec low, high;
	float cell_m;
};

struct site {
	struct mesh solid, glass;
	GArray *materials;  /* of struct material */
	GArray *clear;      /* of uint8_t by material, see struct pen */
	GArray *objects;    /* class of each, uint8_t; [0] is nothing */
	GPtrArray *models;  /* of struct mesh * */
	GArray *placements; /* of struct placement */
	GArray *walk;       /* of vec: where stations are wanted, z unused */
	GArray *claims;     /* of struct disc */
	float (*ground)(const struct site *s, float x, float y); /* NULL: z = 0 */
	float relief[8];         /* the scene's own numbers for ground() */
	struct dice dice, loose; /* loose: of what can be moved, where it was */
	uint64_t seed;
	struct world_variant variant;
	struct light light;
	struct bounds bounds;
};

void site_init(struct site *s, uint64_t seed);
void site_clear(struct site *s);

uint16_t site_material(struct site *s, struct material m);
uint16_t site_object(struct site *s, enum world_class class);
/* A pen in the static mesh, its frame at (x, y, z) and turned clockwise. */
struct pen site_pen(struct site *s, float x, float y, float z, float clockwise_rad);
/* The same, on the ground, with a new object. */
struct pen site_stand(
	struct site *s, enum world_class class, float x, float y, float clockwise_rad);
/* A pen for a new model; its triangles take the object of each placement. */
struct pen site_model(struct site *s, uint32_t *ret_model);
void site_place(struct site *s, uint32_t model, const struct pen *at);
float site_ground(const struct site *s, float x, float y);
/* Whether a disc is free of all claims; if so it is claimed. */
bool site_claim(struct site *s, float x, float y, float radius);
bool site_is_free(const struct site *s, float x, float y, float radius);
/* How far a place is from the nearest of the walk. */
float site_from_walk(const struct site *s, float x, float y);
/* Between these two stands what can be moved: chance is then the variant's own. */
void site_begin_loose(struct site *s, struct dice *ret_kept);
void site_end_loose(struct site *s, const struct dice *kept);
/* How far a loose thing was pushed aside, at most by so much; 0 where nothing was moved. */
float site_nudge(struct site *s, float most);
/* Replaces all that stands at x < 0 by what stands at x > 0, half a turn about the origin further. */
void site_make_symmetric(struct site *s);
void site_walk_to(struct site *s, float x, float y);

/* The scenes. */
void scene_court(struct site *s);
void scene_street(struct site *s);
void scene_bridge(struct site *s);
void scene_hall(struct site *s);
void scene_range(struct site *s);

#endif
