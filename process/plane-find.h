#ifndef PROCESS_PLANE_FIND_H
#define PROCESS_PLANE_FIND_H
/* What the files that find plane regions share. Internal to process/plane-*. */
#include "process/plane-outline.h"
#include "process/plane-regions.h"

/* Numbers of the planes whose lines a vertex lies on, and 1; 0: of none. */
struct plane_met {
	uint32_t with[2];
};

/* A region while it is being found. */
struct plane_draft {
	struct plane_region r; /* rings and texels: its own alone, from 0 on */
	float box_m[2][2];     /* u v: low, high of the cubes that it was found by */
	GArray *ring;          /* of struct plane_ring */
	GArray *vertex;        /* of float[2] */
	GArray *met; /* of struct plane_met, for each vertex; empty until planes have met */
	uint8_t (*texel)[4];
	float spacing_m;   /* median of its points */
	float main_way[2]; /* u v: most of its edges run along it or across */
};
void plane_draft_clear(struct plane_draft *d);

static inline bool plane_is_in_box(const struct plane_draft *d, const float at[2])
{
	return at[0] >= d->box_m[0][0] && at[1] >= d->box_m[0][1] && at[0] <= d->box_m[1][0] &&
	       at[1] <= d->box_m[1][1];
}

static inline double plane_distance_m(const struct plane_region *r, const double at_m[3])
{
	double d = 0;
	for (int k = 0; k < 3; k++)
		d += (at_m[k] - r->origin_m[k]) * (double)r->normal[k];
	return d;
}

static inline void plane_place(const struct plane_region *r, const double at_m[3], float ret[2])
{
	double u = 0, v = 0;
	for (int k = 0; k < 3; k++) {
		u += (at_m[k] - r->origin_m[k]) * (double)r->u[k];
		v += (at_m[k] - r->origin_m[k]) * (double)r->v[k];
	}
	ret[0] = (float)u;
	ret[1] = (float)v;
}

static inline void plane_point(const struct plane_region *r, const float at[2], double ret_m[3])
{
	for (int k = 0; k < 3; k++)
		ret_m[k] = r->origin_m[k] + (double)(at[0] * r->u[k]) + (double)(at[1] * r->v[k]);
}

/* Chunks of one leaf, which stand together in the model. */
struct plane_leaf {
	uint64_t first_chunk, end_chunk;
	uint32_t leaf;
};

#endif
