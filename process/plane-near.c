#include "process/plane-near.h"
#include "process/vector3.h"
#include <math.h>

#define NEAR_COSINE 0.6f
/* Of rounding. */
#define CHUNK_MARGIN_M 1e-3

struct plane_near {
	struct plane_draft *from;
	uint64_t first_chunk;
	GArray *list;    /* of uint32_t: which of them, chunk after chunk, in their order */
	guint *first_of; /* in list: of each chunk, and of the end */
};

/* Half of how far the chunk reaches along a direction. */
static double reach_m(const struct model_chunk *c, const float along[3])
{
	double ret = CHUNK_MARGIN_M;
	for (int k = 0; k < 3; k++)
		ret += (double)(c->half_size_m[k] * fabsf(along[k]));
	return ret;
}

bool plane_is_near(const struct plane_draft *d, const struct model_chunk *c, double within_m)
{
	return fabs(plane_distance_m(&d->r, c->centre_m)) <= within_m + reach_m(c, d->r.normal);
}

bool plane_may_reach(const struct plane_draft *d, const struct model_chunk *c, double within_m)
{
	const float *axis[2] = { d->r.u, d->r.v };
	float at[2];
	if (!plane_is_near(d, c, within_m))
		return false;
	plane_place(&d->r, c->centre_m, at);
	for (int k = 0; k < 2; k++) {
		float reach = (float)reach_m(c, axis[k]);
		if (at[k] + reach < d->box_m[0][k] || at[k] - reach > d->box_m[1][k])
			return false;
	}
	return true;
}

plane_near *plane_near_new(struct plane_draft *from, uint32_t count,
	const struct model_chunk *chunk, uint64_t first, uint64_t end)
{
	plane_near *n = g_new(plane_near, 1);
	*n = (plane_near){ from, first, g_array_new(FALSE, FALSE, sizeof(uint32_t)),
		g_new(guint, end - first + 1) };
	for (uint64_t c = first; c < end; c++) {
		n->first_of[c - first] = n->list->len;
		for (uint32_t k = 0; k < count; k++)
			if (plane_may_reach(&from[k], &chunk[c], (double)from[k].r.thickness_m))
				g_array_append_val(n->list, k);
	}
	n->first_of[end - first] = n->list->len;
	return n;
}

void plane_near_free(plane_near *n)
{
	if (!n)
		return;
	g_array_unref(n->list);
	g_free(n->first_of);
	g_free(n);
}

struct plane_draft *plane_nearest(const plane_near *n, uint64_t chunk, const double at_m[3],
	const float normal[3], float within_m, double *ret_m)
{
	struct plane_draft *best = NULL;
	bool has_normal = normal[0] != 0 || normal[1] != 0 || normal[2] != 0;
	uint64_t at_chunk = chunk - n->first_chunk;
	for (guint i = n->first_of[at_chunk]; i < n->first_of[at_chunk + 1]; i++) {
		struct plane_draft *of = &n->from[g_array_index(n->list, uint32_t, i)];
		const struct plane_region *r = &of->r;
		double d = plane_distance_m(r, at_m);
		float at[2], cosine = vector3_dot(normal, r->normal);
		if (fabs(d) > (double)MIN(within_m, r->thickness_m) ||
			(has_normal && cosine < NEAR_COSINE) || (best && fabs(d) >= fabs(*ret_m)))
			continue;
		plane_place(r, at_m, at);
		if (!plane_is_in_box(of, at))
			continue;
		best = of;
		*ret_m = d;
	}
	return best;
}
