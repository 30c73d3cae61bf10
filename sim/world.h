#ifndef SIM_WORLD_H
#define SIM_WORLD_H
/* A world is a procedural site with exact geometry, materials and light, ray-cast with Embree.
 *
 * Axes: x east, y north, z up, metres; azimuth is measured clockwise from +y seen from above, as
 * surveyors do. A world is a pure function of (scene, seed, variant): the same three give the same triangles
 * and the same colours on every run. It is const once made, so every function below may be called
 * from any number of threads at once.
 *
 * Nothing of a world crosses to the product except through the simulated devices; tests ask it for
 * the truth. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct world world;

/* What a surface belongs to. The first six are the classes that the product tells apart; the rest
 * are things that stand in a site and belong to none of them. */
enum world_class {
	WORLD_NOTHING, /* sky, or beyond the limit */
	WORLD_BUILDING,
	WORLD_VEGETATION,
	WORLD_TERRAIN,   /* ground, paving, grass, road, floor */
	WORLD_STRUCTURE, /* lamp posts, railings, bridges, bollards, fountains, benches */
	WORLD_WATER,
	WORLD_VEHICLE,
	WORLD_PERSON,
	WORLD_FURNITURE,
	WORLD_CLASSES
};

/* How a surface meets the beam: most scatter it; glass and water mirror it away unless met nearly
 * head-on. */
enum world_optics { WORLD_DIFFUSE, WORLD_GLASS, WORLD_WATER_SURFACE };

/* The first surface along a ray. */
struct surface {
	double range_m;     /* from the origin along the unit direction */
	float normal[3];    /* unit, towards the origin */
	float albedo[3];    /* linear RGB, 0..1, texture included */
	float reflectivity; /* at the lidar's wavelength, 0..1 (retro-reflectors above 1) */
	uint16_t instance;  /* 1..; each tree, building, car, person ... has its own; 0 = none */
	uint8_t class;      /* enum world_class */
	uint8_t optics;     /* enum world_optics */
};

/* Where a tripod stands: the scanner's own frame (z up, y = its zero azimuth) in the world. The
 * rotation takes scanner to world and is made of yaw (clockwise), then up to half a degree of tilt.
 */
struct world_station {
	double position_m[3];  /* centre of the head, about 1.7 m above the ground */
	double rotation[3][3]; /* world = rotation * scanner + position */
};

/* Names of the scenes, NULL-terminated: court, street, bridge, hall, range. */
extern const char *const world_scene_names[];

/* The same place as it may otherwise be; all zero: as it is. */
struct world_variant {
	uint64_t moved; /* people, cars and furniture stand where this number puts them */
	bool symmetric; /* hall: half a turn about its middle changes nothing */
	bool repeated;  /* street: all houses of a row, and what stands before them, are the same */
};

/* Fails for a scene that does not exist, naming those that do, and for a variant that the scene does not have. variant may be
 * NULL. */
world *world_new(
	const char *scene, uint64_t seed, const struct world_variant *variant, GError **error);
void world_free(world *w); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(world, world_free)

/* Stations are counted from 1. Every scene has at least ten, 5 to 20 m apart along a walk through
 * the place, the first four chosen so that they show it well; any neighbouring two see much in
 * common. */
uint32_t world_station_count(const world *w);
void world_get_station(const world *w, uint32_t number, struct world_station *ret_station);

/* The first surface within limit_m along the ray, or false. direction is a unit vector. */
bool world_cast(const world *w, const double origin_m[3], const double direction[3], double limit_m,
	struct surface *ret_surface);

/* Linear RGB radiance that reaches the origin along each of `count` rays (three numbers each, unit directions): sunlit and sky-lit surface, mirrored
 * sky in glass and water, haze, or the sky itself. 1.0 is a white wall in full sun. Rays that lie next to each other in space should
 * come next to each other here: eight of them cost half of eight calls. */
void world_radiance(const world *w, const double origin_m[3], const double *direction,
	uint32_t count, float *ret_rgb);

#endif
