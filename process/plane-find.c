#include "process/plane-find.h"
#include "process/plane-grow.h"
#include "process/plane-inside.h"
#include "process/plane-near.h"
#include "process/plane-outline.h"
#include "process/plane-straight.h"
#include "process/plane-texture.h"
#include "process/segments.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AREA_LEAST_M2 1.f
#define TEXEL_LEAST_M 0.01f
#define TEXEL_SPACING 0.4f
/* Parts of a region, and holes in it, that are left out: also those of so few points, where these are far apart. */
#define PART_LEAST_M2 0.2
#define PART_POINTS   16
#define HOLE_LEAST_M2 0.02
#define HOLE_POINTS   4
/* Of a patch's diameter: as the mask has discs by itself. */
#define REACH 0.75f
/* Points that are farther apart were seen from an aeroplane or the like, and lie in no order: so many spacings reach over what gaps chance
 * leaves among them. */
#define SPARSE_M        0.1f
#define SPARSE_SPACINGS 1.4f
/* What is of an edge: cells of the outline, and parts of the spacing. */
#define EDGE_CELLS   1.6f
#define EDGE_SPACING 0.6f
#define EDGE_MOST_M  0.1f
#define EDGE_SPARSE  1.f /* spacings, of points that lie in no order */
/* Where points are far apart they lie less well on their plane: so much of their spacing, and that at most. */
#define FAR_SPACING 0.3f
#define FAR_MOST_M  0.12f
/* So much of a patch may reach out of the polygon, and be gone. */
#define SLIVER_M   0.01f
#define FOOT_M     0.12f /* points that face elsewhere, from its border */
#define FOOT_THICK 0.4f  /* and those that stand off it by more of its thickness */
#define AGREES     0.6f  /* cosine */
#define SLIVER     0.3f
/* Points so near a plane close slits in it. */
#define BESIDE_M     0.08
#define BESIDE_THICK 1.5
/* Of all textures together: what a storage block of a GPU takes, with smaller ones of them (scene-planes.h). */
#define TEXELS_MOST      20e6f
#define TEXTURE_MARGIN_M 0.3f

void plane_draft_clear(struct plane_draft *d)
{
	g_clear_pointer(&d->ring, g_array_unref);
	g_clear_pointer(&d->vertex, g_array_unref);
	g_clear_pointer(&d->met, g_array_unref);
	g_clear_pointer(&d->texel, g_free);
}

struct search {
	const model *m;
	struct plane_options o;
	const struct model_chunk *chunk;
	uint64_t chunks;
	GArray *leaf;  /* of struct plane_leaf */
	GArray *draft; /* of struct plane_draft, leaf by leaf */
	guint *first;  /* draft of each leaf, and of the end */
	uint8_t *explained;
	bool is_stopped;
	GError *error;
};

static struct plane_draft *drafts(const struct search *s)
{
	return (struct plane_draft *)(void *)s->draft->data;
}

static void say(struct search *s, double fraction)
{
	if (s->o.progress && !s->is_stopped)
		s->is_stopped = !s->o.progress(fraction, s->o.user_data);
}

/* ---- leaves ---- */

static bool is_flat_thing(const struct search *s, uint32_t leaf)
{
	if (!s->o.leaf_class)
		return true;
	uint8_t class = s->o.leaf_class[MIN(leaf, UINT16_MAX)];
	return class == CLASS_BUILDING || class == CLASS_TERRAIN || class == CLASS_STRUCTURE;
}

static void find_leaves(struct search *s)
{
	for (uint64_t c = 0; c < s->chunks;) {
		struct plane_leaf l = { c, c + 1, s->chunk[c].leaf };
		while (l.end_chunk < s->chunks && s->chunk[l.end_chunk].leaf == l.leaf)
			l.end_chunk++;
		if (is_flat_thing(s, l.leaf))
			g_array_append_val(s->leaf, l);
		c = l.end_chunk;
	}
}

static void grow_leaves(struct search *s)
{
	g_autofree GArray **of = g_new0(GArray *, s->leaf->len + 1);
#pragma omp parallel for schedule(dynamic, 1)
	for (guint n = 0; n < s->leaf->len; n++) {
		of[n] = g_array_new(FALSE, TRUE, sizeof(struct plane_draft));
		plane_grow(s->m, &g_array_index(s->leaf, struct plane_leaf, n), s->o.area_least_m2,
			of[n]);
	}
	s->first = g_new(guint, s->leaf->len + 1);
	for (guint n = 0; n < s->leaf->len; n++) {
		s->first[n] = s->draft->len;
		g_array_append_vals(s->draft, of[n]->data, of[n]->len);
		g_array_unref(of[n]);
	}
	s->first[s->leaf->len] = s->draft->len;
}

/* ---- points ---- */

static void point_m(const struct model_chunk *c, const struct model_point *p, double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = c->centre_m[k] + (double)p->position_m[k];
}

/* As scenes have it: surface that was met aslant has points far apart one way. */
static float disc_m(const struct model_point *p)
{
	float size = MAX(p->size, 1), spacing = MAX(p->spacing, 1);
	float disc = fmaxf(spacing * spacing / size, size);
	return CLAMP(disc, spacing, 2.5f * spacing) * 1e-4f;
}

static struct plane_spot spot_of(
	const struct plane_region *r, const double at_m[3], const struct model_point *p)
{
	struct plane_spot s = { .reach_m = REACH * disc_m(p),
		.spacing_m = MAX(p->spacing, 1) * 1e-4f,
		.intensity = p->intensity };
	if (s.spacing_m > SPARSE_M)
		s.reach_m = fmaxf(s.reach_m, SPARSE_SPACINGS * s.spacing_m);
	plane_place(r, at_m, s.at);
	memcpy(s.rgba, p->rgba, sizeof s.rgba);
	return s;
}

/* Of a plane, those that no other of its leaf is nearer to; and those beside it. */
static GArray *spots_of(const struct search *s, guint leaf, const plane_near *near, guint number)
{
	const struct plane_leaf *l = &g_array_index(s->leaf, struct plane_leaf, leaf);
	struct plane_draft *d = drafts(s);
	const double beside_m = fmax(BESIDE_M, BESIDE_THICK * (double)d[number].r.thickness_m);
	GArray *spots = g_array_new(FALSE, FALSE, sizeof(struct plane_spot));
	for (uint64_t c = l->first_chunk; c < l->end_chunk; c++) {
		const struct model_chunk *chunk = &s->chunk[c];
		const struct model_point *p = model_points(s->m) + chunk->first;
		if (!plane_may_reach(&d[number], chunk, beside_m))
			continue;
		for (uint32_t i = 0; i < chunk->points; i++) {
			double at_m[3], away_m;
			float normal[3];
			point_m(chunk, &p[i], at_m);
			if (fabs(plane_distance_m(&d[number].r, at_m)) > beside_m)
				continue;
			model_unpack_normal(p[i].normal, normal);
			bool is_on = plane_nearest(near, c, at_m, normal, INFINITY, &away_m) ==
				     &d[number];
			struct plane_spot spot = spot_of(&d[number].r, at_m, &p[i]);
			spot.is_beside = !is_on;
			if (!is_on && !plane_is_in_box(&d[number], spot.at))
				continue;
			g_array_append_val(spots, spot);
		}
	}
	return spots;
}

static int by_size(const void *a, const void *b)
{
	const float *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

static float median_spacing_m(const GArray *spots)
{
	g_autofree float *of = g_new(float, spots->len / 16 + 1);
	guint count = 0;
	for (guint n = 0; n < spots->len; n += 16)
		of[count++] = g_array_index(spots, struct plane_spot, n).spacing_m;
	qsort(of, count, sizeof *of, by_size);
	return count ? of[count / 2] : 0;
}

/* ---- a region ---- */

/* Of an outline, what is of an edge. */
static float edge_m(const struct plane_draft *d, float step_m)
{
	if (d->spacing_m > SPARSE_M)
		return fmaxf(EDGE_CELLS * step_m, EDGE_SPARSE * d->spacing_m);
	return fminf(fmaxf(EDGE_CELLS * step_m, EDGE_SPACING * d->spacing_m), EDGE_MOST_M);
}

static void make_region(struct search *s, guint leaf, const plane_near *near, guint number)
{
	struct plane_draft *d = &drafts(s)[number];
	g_autoptr(GError) error = NULL;
	g_autoptr(GArray) spots = spots_of(s, leaf, near, number);
	const struct plane_spot *spot = (const struct plane_spot *)(void *)spots->data;
	g_autoptr(GArray) places = g_array_new(FALSE, FALSE, sizeof(float[2]));
	g_autoptr(GArray) ends = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	float step_m = 0;
	d->ring = g_array_new(FALSE, FALSE, sizeof(struct plane_ring));
	d->vertex = g_array_new(FALSE, FALSE, sizeof(float[2]));
	d->met = g_array_new(FALSE, TRUE, sizeof(struct plane_met));
	d->spacing_m = median_spacing_m(spots);
	double point_m2 = (double)(d->spacing_m * d->spacing_m);
	if (!plane_outline(spot, spots->len, fmax(PART_LEAST_M2, PART_POINTS * point_m2),
		    fmax(HOLE_LEAST_M2, HOLE_POINTS * point_m2), places, ends, &step_m, &error)) {
#pragma omp critical(plane_error)
		if (!s->error)
			s->error = g_steal_pointer(&error);
		return;
	}
	plane_straighten(d, places, ends, edge_m(d, step_m));
	if (d->ring->len)
		plane_texture(d, spot, spots->len,
			fmaxf(s->o.texel_m, TEXEL_SPACING * d->spacing_m), TEXTURE_MARGIN_M);
}

/* By the boxes of the planes. */
static void coarsen_texels(struct search *s)
{
	float texels = 0;
	for (guint n = 0; n < s->draft->len; n++) {
		const struct plane_draft *d = &drafts(s)[n];
		texels += (d->box_m[1][0] - d->box_m[0][0]) * (d->box_m[1][1] - d->box_m[0][1]) /
			  (s->o.texel_m * s->o.texel_m);
	}
	if (texels > TEXELS_MOST)
		s->o.texel_m *= sqrtf(texels / TEXELS_MOST);
}

static plane_near *near_of_leaf(const struct search *s, guint leaf)
{
	const struct plane_leaf *l = &g_array_index(s->leaf, struct plane_leaf, leaf);
	guint from = s->first[leaf], count = s->first[leaf + 1] - from;
	return plane_near_new(drafts(s) + from, count, s->chunk, l->first_chunk, l->end_chunk);
}

static void make_regions(struct search *s)
{
	coarsen_texels(s);
	g_autofree guint *leaf_of = g_new(guint, s->draft->len + 1);
	g_autofree plane_near **near = g_new0(plane_near *, s->leaf->len + 1);
#pragma omp parallel for schedule(dynamic, 1)
	for (guint n = 0; n < s->leaf->len; n++)
		near[n] = near_of_leaf(s, n);
	for (guint n = 0; n < s->leaf->len; n++)
		for (guint k = s->first[n]; k < s->first[n + 1]; k++)
			leaf_of[k] = n;
#pragma omp parallel for schedule(dynamic, 1)
	for (guint n = 0; n < s->draft->len; n++)
		make_region(s, leaf_of[n], near[leaf_of[n]], n);
	for (guint n = 0; n < s->leaf->len; n++)
		plane_near_free(near[n]);
}

/* All at once, from what they were before. */
static void meet(struct search *s)
{
	g_autofree GArray **to = g_new(GArray *, s->draft->len + 1);
	g_autofree GArray **met = g_new(GArray *, s->draft->len + 1);
#pragma omp parallel for schedule(dynamic, 1)
	for (guint n = 0; n < s->draft->len; n++) {
		met[n] = g_array_new(FALSE, FALSE, sizeof(struct plane_met));
		to[n] = plane_meet(drafts(s), s->draft->len, n, met[n]);
	}
	for (guint n = 0; n < s->draft->len; n++) {
		g_array_unref(drafts(s)[n].vertex);
		g_array_unref(drafts(s)[n].met);
		drafts(s)[n].vertex = to[n];
		drafts(s)[n].met = met[n];
		plane_prune(&drafts(s)[n]);
	}
}

static float ring_area_m2(const float (*p)[2], uint32_t count)
{
	double sum = 0;
	for (uint32_t n = 0; n < count; n++) {
		const float *a = p[n], *b = p[(n + 1) % count];
		sum += (double)a[0] * (double)b[1] - (double)a[1] * (double)b[0];
	}
	return (float)(sum / 2);
}

/* Outlines and holes run the other way round (findContours). */
static void measure(struct plane_draft *d)
{
	d->r.area_m2 = 0;
	for (guint n = 0; n < d->ring->len; n++) {
		const struct plane_ring *r = &g_array_index(d->ring, struct plane_ring, n);
		d->r.area_m2 += ring_area_m2(
			(const float(*)[2])(void *)d->vertex->data + r->first, r->count);
	}
	d->r.area_m2 = fabsf(d->r.area_m2);
}

/* ---- what they explain ---- */

static bool agrees(const struct plane_draft *d, const struct model_point *p)
{
	float normal[3], cosine = 0, length2 = 0;
	model_unpack_normal(p->normal, normal);
	for (int k = 0; k < 3; k++) {
		cosine += normal[k] * d->r.normal[k];
		length2 += normal[k] * normal[k];
	}
	return !(length2 > 0) || cosine > AGREES;
}

/* How far off it explains points at most. */
static float far_most_m(const struct plane_draft *d)
{
	return fmaxf(FAR_MOST_M, d->r.thickness_m);
}

/* Where a patch reaches out of the polygon it still closes gaps to what is beside, and so does the foot of what stands on it. */
static bool explains(const struct plane_draft *d, const plane_inside *inside,
	const struct model_point *p, const double at_m[3])
{
	float at[2], thick_m = d->r.thickness_m + FAR_SPACING * (float)p->spacing * 1e-4f;
	double off_m = plane_distance_m(&d->r, at_m);
	if (fabs(off_m) > (double)fminf(thick_m, far_most_m(d)))
		return false;
	plane_place(&d->r, at_m, at);
	if (!plane_inside_near(inside, at, 0))
		return false;
	float reach_m = REACH * disc_m(p), out_m = reach_m - fmaxf(SLIVER_M, SLIVER * reach_m);
	if (!agrees(d, p) || off_m > (double)(FOOT_THICK * d->r.thickness_m))
		out_m = fmaxf(out_m, FOOT_M);
	return !plane_inside_is_border(inside, at, out_m);
}

static void explain_chunk(const struct search *s, struct plane_draft *const *d,
	plane_inside *const *inside, guint count, uint64_t chunk, uint64_t *points)
{
	const struct model_chunk *c = &s->chunk[chunk];
	const struct model_point *p = model_points(s->m) + c->first;
	g_autofree bool *is_near = g_new(bool, count + 1);
	for (guint n = 0; n < count; n++)
		is_near[n] = plane_is_near(d[n], c, (double)far_most_m(d[n]));
	for (uint32_t i = 0; i < c->points; i++) {
		double at_m[3];
		point_m(c, &p[i], at_m);
		guint n = 0;
		while (n < count && !(is_near[n] && explains(d[n], inside[n], &p[i], at_m)))
			n++;
		if (n == count)
			continue;
		uint64_t at = c->first + i;
		uint8_t bit = (uint8_t)(1u << at % 8);
#pragma omp atomic
		s->explained[at / 8] |= bit;
#pragma omp atomic
		points[n]++;
	}
}

static void explain_leaf(struct search *s, guint leaf)
{
	const struct plane_leaf *l = &g_array_index(s->leaf, struct plane_leaf, leaf);
	guint count = s->first[leaf + 1] - s->first[leaf];
	g_autofree struct plane_draft **d = g_new(struct plane_draft *, count + 1);
	g_autofree plane_inside **inside = g_new(plane_inside *, count + 1);
	g_autofree uint64_t *points = g_new0(uint64_t, count + 1);
	for (guint n = 0; n < count; n++) {
		d[n] = &drafts(s)[s->first[leaf] + n];
		inside[n] = plane_inside_new(d[n]);
	}
#pragma omp parallel for schedule(dynamic, 1)
	for (uint64_t c = l->first_chunk; c < l->end_chunk; c++)
		explain_chunk(s, d, inside, count, c, points);
	for (guint n = 0; n < count; n++) {
		d[n]->r.points = points[n];
		plane_inside_free(inside[n]);
	}
}

/* ---- all together ---- */

static bool is_kept(const struct search *s, const struct plane_draft *d)
{
	return d->ring->len && d->r.area_m2 >= s->o.area_least_m2;
}

struct gathered {
	GArray *region, *ring, *vertex, *texel;
};

static void gather(struct gathered *g, const struct plane_draft *d)
{
	struct plane_region r = d->r;
	r.first_ring = g->ring->len;
	r.rings = d->ring->len;
	r.first_texel = g->texel->len;
	for (guint n = 0; n < d->ring->len; n++) {
		struct plane_ring ring = g_array_index(d->ring, struct plane_ring, n);
		ring.first += g->vertex->len;
		g_array_append_val(g->ring, ring);
	}
	g_array_append_vals(g->vertex, d->vertex->data, d->vertex->len);
	g_array_append_vals(g->texel, d->texel, r.width * r.height);
	g_array_append_val(g->region, r);
}

static plane_regions *finish(struct search *s)
{
	plane_regions *r = g_new0(plane_regions, 1);
	struct gathered g = { g_array_new(FALSE, FALSE, sizeof(struct plane_region)),
		g_array_new(FALSE, FALSE, sizeof(struct plane_ring)),
		g_array_new(FALSE, FALSE, sizeof(float[2])),
		g_array_new(FALSE, FALSE, sizeof(uint8_t[4])) };
	for (guint n = 0; n < s->draft->len; n++)
		gather(&g, &drafts(s)[n]);
	r->count = g.region->len;
	r->rings = g.ring->len;
	r->vertices = g.vertex->len;
	r->texels = g.texel->len;
	r->points = model_count(s->m);
	r->region = (const void *)g_array_free(g.region, FALSE);
	r->ring = (const void *)g_array_free(g.ring, FALSE);
	r->vertex = (const void *)g_array_free(g.vertex, FALSE);
	r->texel = (const void *)g_array_free(g.texel, FALSE);
	r->explained = g_steal_pointer(&s->explained);
	return r;
}

/* Those that came to nothing. */
static void drop(struct search *s)
{
	guint left = 0, at = 0;
	struct plane_draft *d = drafts(s);
	for (guint n = 0; n < s->leaf->len; n++) {
		guint end = s->first[n + 1];
		s->first[n] = left;
		for (; at < end; at++) {
			measure(&d[at]);
			if (is_kept(s, &d[at]))
				d[left++] = d[at];
			else
				plane_draft_clear(&d[at]);
		}
	}
	s->first[s->leaf->len] = left;
	g_array_set_size(s->draft, left);
}

static plane_regions *search(struct search *s)
{
	find_leaves(s);
	grow_leaves(s);
	say(s, 0.4);
	if (s->is_stopped)
		return NULL;
	make_regions(s);
	if (s->error)
		return NULL;
	say(s, 0.8);
	drop(s);
	meet(s);
	drop(s);
	for (guint n = 0; n < s->leaf->len && !s->is_stopped; n++)
		explain_leaf(s, n);
	say(s, 1);
	return s->is_stopped ? NULL : finish(s);
}

plane_regions *plane_regions_find(const model *m, const struct plane_options *o, GError **error)
{
	static const struct plane_options defaults;
	struct search s = { .m = m,
		.o = o ? *o : defaults,
		.leaf = g_array_new(FALSE, FALSE, sizeof(struct plane_leaf)),
		.draft = g_array_new(FALSE, TRUE, sizeof(struct plane_draft)),
		.explained = g_malloc0((model_count(m) + 7) / 8 + 1) };
	s.chunk = model_chunks(m, &s.chunks);
	if (!(s.o.area_least_m2 > 0))
		s.o.area_least_m2 = AREA_LEAST_M2;
	if (!(s.o.texel_m > 0))
		s.o.texel_m = TEXEL_LEAST_M;
	plane_regions *r = search(&s);
	if (r)
		r->classes = segments_classes_checksum(s.o.leaf_class);
	for (guint n = 0; n < s.draft->len; n++)
		plane_draft_clear(&drafts(&s)[n]);
	g_array_unref(s.draft);
	g_array_unref(s.leaf);
	g_free(s.first);
	g_free(s.explained);
	if (s.error)
		g_propagate_error(error, s.error);
	return r;
}
