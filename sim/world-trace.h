#ifndef SIM_WORLD_TRACE_H
#define SIM_WORLD_TRACE_H
/* The finished world and the rays through it. There are two scenes of Embree's: shadow rays and
 * what is seen through a pane go through the solid one, which has no panes and no water in it. */
#include <embree3/rtcore.h>

#include "sim/world-site.h"

/* What a placement turns normals with: the inverse transpose of its frame. */
struct turn {
	vec x, y, z;
};

/* Light gathered in a grid of probes: for each the irradiance as four coefficients (constant, x, y,
 * z) of RGB. */
struct probes {
	vec low;
	float cell_m;
	int n[3];
	vec (*light)[4];
};

struct world {
	struct site site;
	RTCDevice device;
	RTCScene solid, all;
	GPtrArray *model_scenes; /* RTCScene of each model */
	struct turn *turns;      /* by placement */
	struct probes probes;
	GArray *stations; /* of struct world_station */
};

struct ray {
	vec origin, direction;
	float limit_m;
};

struct hit {
	float range_m;
	vec place;
	vec normal;  /* of the triangle, unit, towards the ray's origin */
	vec shading; /* smoothed over the mesh, same side */
	const struct material *material;
	uint32_t face; /* differs from face to face and from tree to tree */
	uint16_t object;
};

/* smooth: the shading normal is wanted; it costs a look at the mesh's points. */
bool trace_all(const struct world *w, const struct ray *r, bool smooth, struct hit *ret_hit);
bool trace_solid(const struct world *w, const struct ray *r, bool smooth, struct hit *ret_hit);
/* Whether a hit is of a pane or of water. */
bool hit_is_clear(const struct hit *h);

/* Eight rays side by side. Of neighbours, which go the same way through Embree's trees, they cost a third to a half of eight single ones.
 * `lanes` has a bit for each of r[0..] that is meant; others are neither read nor written. */
#define PACKET 8
enum packet_kind {
	PACKET_LOOK, /* from one place, to much the same side; normals are smoothed */
	PACKET_PROBE /* to all sides; normals are the triangles' */
};
/* The bits of those that hit something, which is in ret_hit. */
unsigned packet_all(
	const struct world *w, const struct ray *r, unsigned lanes, struct hit *ret_hit);
unsigned packet_solid(const struct world *w, const struct ray *r, unsigned lanes,
	enum packet_kind kind, struct hit *ret_hit);
/* How far the rays get, their limits at most. */
void packet_distance(const struct world *w, const struct ray *r, unsigned lanes, float *ret_m);
/* The bits of those that hit something solid. */
unsigned packet_blocked(
	const struct world *w, const struct ray *r, unsigned lanes, enum packet_kind kind);

/* Angle of a pixel, which textures are filtered for. */
#define PIXEL_RAD 0.0013f
float hit_footprint(const struct ray *r, const struct hit *h);

/* Builds Embree's scenes from the drawn meshes. */
void trace_commit(struct world *w);
void trace_free(struct world *w);

/* Sun and sky of a seed. */
void light_choose(struct light *l, struct dice *d);
/* clouds: with them, or only the gradient. */
vec light_sky(const struct light *l, vec direction, bool clouds);
/* Fills the probes; light bounces once or twice. */
void light_gather(struct world *w);
vec light_ambient(const struct world *w, vec place, vec normal);
/* Light that comes back along 1 to PACKET rays. */
void light_along(const struct world *w, const struct ray *r, unsigned count, vec *ret_light);

#endif
