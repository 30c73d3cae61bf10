#include "process/plane-grow.h"
#include "process/plane-near.h"
#include "process/voxel-shape.h"
#include "process/voxels.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cubes have a few points each. */
#define VOXEL_LEAST_M  0.1
#define VOXEL_SPACINGS 2.0
#define GAP_POINTS     2.5
/* A plane lies through any three points: where they are as sparse as from an aeroplane, a region is at least so many large. */
#define AREA_POINTS 64
/* Of cubes that join: how far their mean is from the plane, and the cosine of the angle to it. Distances that are given in noises
 * too hold where points waver more than those of a scanner that stands on the ground, as from an aeroplane. */
#define JOIN_M      0.02
#define JOIN_NOISES 2.0
#define JOIN_COSINE 0.966f
#define AGREE_LEAST 0.8f /* length of the mean of a cube's normals */
/* Points of a plane: how far at first, cosine, and so many times the noise at last. */
#define NEAR_M        0.05f
#define NEAR_NOISES   4.f
#define NOISES        3.f
#define THICK_LEAST_M 0.01f
#define THICK_MOST_M  0.045f
/* Planes that are one. */
#define SAME_COSINE 0.9998
#define SAME_M      0.015
#define SAME_NOISES 0.5
/* Next to an edge normals are of what is around it, and cubes do not join. */
#define BOX_MARGIN_M     0.3f
#define BOX_MARGIN_CUBES 2.5f

/* ---- moments ---- */

struct moments {
	double weight, sum[3], square[6];
};

static void add_to(struct moments *m, const double at[3], double weight)
{
	static const int pair[6][2] = { { 0, 0 }, { 0, 1 }, { 0, 2 }, { 1, 1 }, { 1, 2 },
		{ 2, 2 } };
	m->weight += weight;
	for (int k = 0; k < 3; k++)
		m->sum[k] += weight * at[k];
	for (int k = 0; k < 6; k++)
		m->square[k] += weight * at[pair[k][0]] * at[pair[k][1]];
}

static void cross(const double a[3], const double b[3], double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The eigenvector of the least eigenvalue: two rows of C - eigenvalue are across it. */
static void flattest(const double c[6], double ret[3])
{
	double values[3], best = 0;
	symmetric_eigenvalues(c, values);
	double row[3][3] = { { c[0] - values[2], c[1], c[2] }, { c[1], c[3] - values[2], c[4] },
		{ c[2], c[4], c[5] - values[2] } };
	for (int k = 0; k < 3; k++) {
		double n[3];
		cross(row[k], row[(k + 1) % 3], n);
		double length2 = dot(n, n);
		if (length2 <= best)
			continue;
		best = length2;
		for (int i = 0; i < 3; i++)
			ret[i] = n[i] / sqrt(length2);
	}
}

struct fit {
	double middle[3], normal[3];
};

/* Keeps the side that the normal was on. */
static void refit(const struct moments *m, struct fit *f)
{
	double c[6], normal[3];
	static const int pair[6][2] = { { 0, 0 }, { 0, 1 }, { 0, 2 }, { 1, 1 }, { 1, 2 },
		{ 2, 2 } };
	memcpy(normal, f->normal, sizeof normal);
	for (int k = 0; k < 3; k++)
		f->middle[k] = m->sum[k] / m->weight;
	for (int k = 0; k < 6; k++)
		c[k] = m->square[k] / m->weight - f->middle[pair[k][0]] * f->middle[pair[k][1]];
	flattest(c, f->normal);
	if (dot(f->normal, normal) < 0)
		for (int k = 0; k < 3; k++)
			f->normal[k] = -f->normal[k];
}

static double away(const struct fit *f, const double at[3])
{
	double from[3] = { at[0] - f->middle[0], at[1] - f->middle[1], at[2] - f->middle[2] };
	return dot(from, f->normal);
}

/* ---- growing ---- */

struct grown {
	struct fit fit;
	struct moments moments;
	double area_m2;
	uint32_t number; /* of: what its cubes are marked with */
};

struct growing {
	const voxels *v;
	double origin_m[3]; /* of what moments are reckoned from */
	uint32_t *of, *queue;
	uint32_t next;
	double noise_m; /* of the leaf */
};

#define FREE UINT32_MAX

static void place_of(const struct growing *g, uint32_t i, double ret[3])
{
	voxel_point_m(g->v, i, ret);
	for (int k = 0; k < 3; k++)
		ret[k] -= g->origin_m[k];
}

static float agreement(const struct voxel *v)
{
	return sqrtf(v->normal[0] * v->normal[0] + v->normal[1] * v->normal[1] +
		     v->normal[2] * v->normal[2]);
}

static bool joins(const struct growing *g, uint32_t i, const struct fit *f, const double at[3])
{
	const struct voxel *v = &g->v->voxel[i];
	float length = agreement(v), along = 0;
	for (int k = 0; k < 3; k++)
		along += v->normal[k] * (float)f->normal[k];
	return length > AGREE_LEAST && along > JOIN_COSINE * length &&
	       fabs(away(f, at)) < fmax(JOIN_M, JOIN_NOISES * g->noise_m);
}

/* From a cube on; refits: the plane follows what has joined. */
static uint32_t grow(struct growing *g, uint32_t seed, bool refits, struct grown *r)
{
	uint32_t count = 0, refit_at = 8;
	r->moments = (struct moments){ 0 };
	r->area_m2 = 0;
	g->of[seed] = r->number;
	g->queue[count++] = seed;
	for (uint32_t n = 0; n < count; n++) {
		uint32_t i = g->queue[n];
		double at[3];
		place_of(g, i, at);
		add_to(&r->moments, at, MIN(g->v->voxel[i].points, 32));
		r->area_m2 += g->v->voxel[i].area_m2;
		if (refits && n + 1 == refit_at) {
			refit(&r->moments, &r->fit);
			refit_at *= 2;
		}
		for (uint32_t k = g->v->first_link[i]; k < g->v->first_link[i + 1]; k++) {
			uint32_t j = g->v->link[k];
			double there[3];
			place_of(g, j, there);
			if (g->of[j] == FREE && joins(g, j, &r->fit, there)) {
				g->of[j] = r->number;
				g->queue[count++] = j;
			}
		}
	}
	return count;
}

static void release(struct growing *g, uint32_t count)
{
	for (uint32_t n = 0; n < count; n++)
		g->of[g->queue[n]] = FREE;
}

/* First along with what joins, then once more by the plane that came out. */
static bool grow_from(struct growing *g, uint32_t seed, float area_least_m2, struct grown *r)
{
	const struct voxel *v = &g->v->voxel[seed];
	float length = agreement(v);
	r->number = g->next;
	place_of(g, seed, r->fit.middle);
	for (int k = 0; k < 3; k++)
		r->fit.normal[k] = (double)(v->normal[k] / length);
	for (int pass = 0; pass < 2; pass++) {
		uint32_t count = grow(g, seed, pass == 0, r);
		if (r->area_m2 < (double)area_least_m2 || count < 8) {
			release(g, count);
			return false;
		}
		refit(&r->moments, &r->fit);
		if (pass == 0)
			release(g, count);
	}
	g->next++;
	return true;
}

struct seed {
	float rough;
	uint32_t voxel;
};

static int by_roughness(const void *a, const void *b)
{
	const struct seed *x = a, *y = b;
	if (x->rough != y->rough)
		return x->rough < y->rough ? -1 : 1;
	return (x->voxel > y->voxel) - (x->voxel < y->voxel);
}

static struct seed *seeds_of(const voxels *v, uint32_t *ret_count)
{
	struct seed *s = g_new(struct seed, v->count + 1);
	uint32_t count = 0;
	for (uint32_t i = 0; i < v->count; i++) {
		float length = agreement(&v->voxel[i]);
		if (length > AGREE_LEAST)
			s[count++] = (struct seed){ 1 - length + 5 * v->voxel[i].error_m, i };
	}
	qsort(s, count, sizeof *s, by_roughness);
	*ret_count = count;
	return s;
}

static int by_area(const void *a, const void *b)
{
	const struct grown *x = a, *y = b;
	if (x->area_m2 != y->area_m2)
		return x->area_m2 > y->area_m2 ? -1 : 1;
	return (x->number > y->number) - (x->number < y->number);
}

/* ---- planes that are one ---- */

static bool is_same(const struct fit *a, const struct fit *b, double noise_m)
{
	double same_m = fmax(SAME_M, SAME_NOISES * noise_m);
	return dot(a->normal, b->normal) > SAME_COSINE && fabs(away(a, b->middle)) < same_m &&
	       fabs(away(b, a->middle)) < same_m;
}

/* The larger takes what lies on its plane. becomes: of each number, the place of its region. */
static uint32_t merge(struct grown *r, uint32_t count, double noise_m, uint32_t *becomes)
{
	uint32_t left = 0;
	for (uint32_t n = 0; n < count; n++) {
		uint32_t into = 0;
		while (into < left && !is_same(&r[into].fit, &r[n].fit, noise_m))
			into++;
		becomes[r[n].number] = into;
		if (into == left) {
			r[left++] = r[n];
			continue;
		}
		struct moments *m = &r[into].moments;
		m->weight += r[n].moments.weight;
		for (int k = 0; k < 6; k++) {
			m->square[k] += r[n].moments.square[k];
			if (k < 3)
				m->sum[k] += r[n].moments.sum[k];
		}
		r[into].area_m2 += r[n].area_m2;
		refit(m, &r[into].fit);
	}
	return left;
}

/* ---- drafts ---- */

/* Of what stands, v is up; of what lies, u is east. */
static void set_axes(struct plane_region *r, const double normal[3])
{
	static const double up[3] = { 0, 0, 1 }, east[3] = { 1, 0, 0 };
	double u[3], v[3], length;
	if (fabs(normal[2]) < 0.9) {
		cross(up, normal, u);
		length = sqrt(dot(u, u));
		for (int k = 0; k < 3; k++)
			u[k] /= length;
		cross(normal, u, v);
	} else {
		cross(normal, east, v);
		length = sqrt(dot(v, v));
		for (int k = 0; k < 3; k++)
			v[k] /= length;
		cross(v, normal, u);
	}
	for (int k = 0; k < 3; k++) {
		r->u[k] = (float)u[k];
		r->v[k] = (float)v[k];
		r->normal[k] = (float)normal[k];
	}
}

/* As they were, but in the plane of a normal that is hardly another: the box stays. */
static void turn_axes(struct plane_region *r, const double normal[3])
{
	double u[3] = { (double)r->u[0], (double)r->u[1], (double)r->u[2] }, v[3];
	double off = dot(u, normal), length;
	for (int k = 0; k < 3; k++)
		u[k] -= off * normal[k];
	length = sqrt(dot(u, u));
	for (int k = 0; k < 3; k++)
		u[k] /= length;
	cross(normal, u, v);
	for (int k = 0; k < 3; k++) {
		r->u[k] = (float)u[k];
		r->v[k] = (float)v[k];
		r->normal[k] = (float)normal[k];
	}
}

static float near_m(double noise_m)
{
	return fmaxf(NEAR_M, NEAR_NOISES * (float)noise_m);
}

static struct plane_draft draft_of(const struct grown *g, const double origin_m[3], double noise_m)
{
	struct plane_draft d = { .box_m = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } } };
	set_axes(&d.r, g->fit.normal);
	for (int k = 0; k < 3; k++)
		d.r.origin_m[k] = g->fit.middle[k] + origin_m[k];
	d.r.thickness_m = near_m(noise_m);
	return d;
}

static void widen(struct plane_draft *d, const double at_m[3], float margin_m)
{
	float at[2];
	plane_place(&d->r, at_m, at);
	for (int k = 0; k < 2; k++) {
		d->box_m[0][k] = fminf(d->box_m[0][k], at[k] - margin_m);
		d->box_m[1][k] = fmaxf(d->box_m[1][k], at[k] + margin_m);
	}
}

/* By its own points, once with those that are near, once with those within the noise. */
static void refine(const model *m, const struct plane_leaf *leaf, const double origin_m[3],
	double noise_m, struct plane_draft *d, uint32_t count)
{
	const float thick_most_m = fmaxf(THICK_MOST_M, NEAR_NOISES * (float)noise_m);
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	g_autofree struct moments *sum = g_new0(struct moments, count);
	g_autofree double *square = g_new0(double, count);
	g_autoptr(plane_near) near =
		plane_near_new(d, count, chunk, leaf->first_chunk, leaf->end_chunk);
	for (uint64_t c = leaf->first_chunk; c < leaf->end_chunk; c++) {
		const struct model_point *p = model_points(m) + chunk[c].first;
		for (uint32_t i = 0; i < chunk[c].points; i++) {
			double at_m[3], from[3], away_m;
			float normal[3];
			for (int k = 0; k < 3; k++)
				at_m[k] = chunk[c].centre_m[k] + (double)p[i].position_m[k];
			model_unpack_normal(p[i].normal, normal);
			struct plane_draft *of =
				plane_nearest(near, c, at_m, normal, near_m(noise_m), &away_m);
			if (!of)
				continue;
			for (int k = 0; k < 3; k++)
				from[k] = at_m[k] - origin_m[k];
			/* A square metre counts as much wherever it is. */
			double weight = pow(MAX(p[i].spacing, 1) * 1e-4, 2);
			add_to(&sum[of - d], from, weight);
			square[of - d] += weight * away_m * away_m;
		}
	}
	for (uint32_t n = 0; n < count; n++) {
		if (!(sum[n].weight > 0))
			continue;
		struct fit f;
		struct plane_region *r = &d[n].r;
		for (int k = 0; k < 3; k++)
			f.normal[k] = (double)r->normal[k];
		refit(&sum[n], &f);
		/* The box stays: its middle moves along the plane by nothing. */
		double shift = 0;
		for (int k = 0; k < 3; k++)
			shift += (f.middle[k] + origin_m[k] - r->origin_m[k]) * f.normal[k];
		for (int k = 0; k < 3; k++)
			r->origin_m[k] += shift * f.normal[k];
		turn_axes(r, f.normal);
		r->noise_m = (float)sqrt(square[n] / sum[n].weight);
		r->thickness_m = CLAMP(NOISES * r->noise_m, THICK_LEAST_M, thick_most_m);
	}
}

/* ---- all ---- */

static int by_spacing(const void *a, const void *b)
{
	const uint16_t *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

/* In metres, of these or, where there are none, 0: what so much of them are below. */
static double quantile_m(GArray *of, double part)
{
	g_array_sort(of, by_spacing);
	return of->len ? g_array_index(of, uint16_t, (guint)(part * of->len)) * 1e-4 : 0;
}

/* By one point in sixteen, how far apart they are, and how far they waver about the planes around them: a quarter of these lie in
 * places that are no plane. */
static void look_at_leaf(
	const model *m, const struct plane_leaf *leaf, double *ret_spacing_m, double *ret_noise_m)
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	g_autoptr(GArray) spacing = g_array_new(FALSE, FALSE, sizeof(uint16_t)),
			  error = g_array_new(FALSE, FALSE, sizeof(uint16_t));
	for (uint64_t c = leaf->first_chunk; c < leaf->end_chunk; c++)
		for (uint32_t i = 0; i < chunk[c].points; i += 16) {
			const struct model_point *p = &model_points(m)[chunk[c].first + i];
			g_array_append_val(spacing, p->spacing);
			if (p->plane_error != MODEL_ERROR_NONE)
				g_array_append_val(error, p->plane_error);
		}
	*ret_spacing_m = quantile_m(spacing, 0.5);
	*ret_noise_m = quantile_m(error, 0.25);
}

static voxels *voxels_of(const model *m, const struct plane_leaf *leaf, double median_m)
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	voxels *v = voxels_new(fmax(VOXEL_SPACINGS * median_m, VOXEL_LEAST_M));
	for (uint64_t c = leaf->first_chunk; c < leaf->end_chunk; c++) {
		const struct model_point *p = model_points(m) + chunk[c].first;
		for (uint32_t i = 0; i < chunk[c].points; i++) {
			struct voxel_point q = { .scan = 1, .size_m = (float)p[i].size * 1e-4f };
			float spacing_m = MAX(p[i].spacing, 1) * 1e-4f;
			for (int k = 0; k < 3; k++)
				q.at_m[k] = chunk[c].centre_m[k] + (double)p[i].position_m[k];
			model_unpack_normal(p[i].normal, q.normal);
			q.error_m = p[i].plane_error == MODEL_ERROR_NONE
					    ? 0.05f
					    : (float)p[i].plane_error * 1e-4f;
			q.area_m2 = spacing_m * spacing_m;
			voxels_add(v, &q);
		}
	}
	voxels_finish(v);
	voxels_link(v, GAP_POINTS);
	return v;
}

static GArray *grow_all(struct growing *g, float area_least_m2)
{
	GArray *all = g_array_new(FALSE, TRUE, sizeof(struct grown));
	uint32_t seeds;
	g_autofree struct seed *seed = seeds_of(g->v, &seeds);
	for (uint32_t n = 0; n < seeds; n++) {
		struct grown r = { 0 };
		if (g->of[seed[n].voxel] == FREE && grow_from(g, seed[n].voxel, area_least_m2, &r))
			g_array_append_val(all, r);
	}
	return all;
}

static void make_drafts(const struct growing *g, const struct grown *r, uint32_t count,
	const uint32_t *becomes, struct plane_draft *to)
{
	for (uint32_t n = 0; n < count; n++)
		to[n] = draft_of(&r[n], g->origin_m, g->noise_m);
	for (uint32_t i = 0; i < g->v->count; i++) {
		double at_m[3];
		voxel_point_m(g->v, i, at_m);
		if (g->of[i] != FREE)
			widen(&to[becomes[g->of[i]]], at_m,
				fmaxf(BOX_MARGIN_M, BOX_MARGIN_CUBES * (float)g->v->size_m));
	}
}

void plane_grow(const model *m, const struct plane_leaf *leaf, float area_least_m2, GArray *ret)
{
	uint64_t chunks;
	double spacing_m, noise_m;
	look_at_leaf(m, leaf, &spacing_m, &noise_m);
	g_autoptr(voxels) v = voxels_of(m, leaf, spacing_m);
	struct growing g = { .v = v,
		.of = g_new(uint32_t, v->count + 1),
		.queue = g_new(uint32_t, v->count + 1),
		.noise_m = noise_m };
	memcpy(g.origin_m, model_chunks(m, &chunks)[leaf->first_chunk].centre_m, sizeof g.origin_m);
	for (uint32_t i = 0; i < v->count; i++)
		g.of[i] = FREE;
	area_least_m2 = fmaxf(area_least_m2, AREA_POINTS * (float)(spacing_m * spacing_m));
	g_autoptr(GArray) all = grow_all(&g, area_least_m2);
	struct grown *r = (struct grown *)(void *)all->data;
	g_autofree uint32_t *becomes = g_new(uint32_t, all->len + 1);
	g_array_sort(all, by_area);
	uint32_t count = merge(r, all->len, noise_m, becomes);
	g_autofree struct plane_draft *d = g_new(struct plane_draft, count + 1);
	make_drafts(&g, r, count, becomes, d);
	for (int pass = 0; pass < 2 && count; pass++)
		refine(m, leaf, g.origin_m, noise_m, d, count);
	for (uint32_t n = 0; n < count; n++)
		d[n].r.leaf = leaf->leaf;
	g_array_append_vals(ret, d, count);
	g_free(g.of);
	g_free(g.queue);
}
