#include "render/plane-view.h"
#include "render/light.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct corner {
	double at[3]; /* as the camera sees it */
};

/* ---- a ring, as the camera sees it ---- */

static void turn(const struct camera *c, const double v[3], double ret[3])
{
	const double *row[3] = { c->right, c->down, c->forward };
	for (int k = 0; k < 3; k++)
		ret[k] = row[k][0] * v[0] + row[k][1] * v[1] + row[k][2] * v[2];
}

struct placed {
	double origin[3], u[3], v[3], normal[3];
};

static struct placed place(const struct camera *c, const struct plane_region *r)
{
	struct placed p;
	double from[3], u[3], v[3], n[3];
	for (int k = 0; k < 3; k++) {
		from[k] = r->origin_m[k] - c->eye_m[k];
		u[k] = (double)r->u[k];
		v[k] = (double)r->v[k];
		n[k] = (double)r->normal[k];
	}
	turn(c, from, p.origin);
	turn(c, u, p.u);
	turn(c, v, p.v);
	turn(c, n, p.normal);
	return p;
}

/* What is on the inner side of a depth, in place of what was there (Sutherland and Hodgman 1974). Edges along the cut fall together in
 * pairs where it goes through more than once, and spans do not see them. */
static void cut_ring(GArray *ring, GArray *spare, double depth_m, double side)
{
	g_array_set_size(spare, 0);
	for (guint n = 0; n < ring->len; n++) {
		const struct corner *a = &g_array_index(ring, struct corner, n),
				    *b = &g_array_index(ring, struct corner, (n + 1) % ring->len);
		double from = side * (a->at[2] - depth_m), to = side * (b->at[2] - depth_m);
		if (from >= 0)
			g_array_append_vals(spare, a, 1);
		if ((from >= 0) == (to >= 0))
			continue;
		struct corner between;
		for (int k = 0; k < 3; k++)
			between.at[k] = a->at[k] + from / (from - to) * (b->at[k] - a->at[k]);
		between.at[2] = depth_m;
		g_array_append_val(spare, between);
	}
	g_array_set_size(ring, 0);
	g_array_append_vals(ring, spare->data, spare->len);
}

/* ---- spans ---- */

struct crossing {
	int32_t row;
	float x;
};

static int by_row(const void *a, const void *b)
{
	const struct crossing *x = a, *y = b;
	if (x->row != y->row)
		return x->row < y->row ? -1 : 1;
	return (x->x > y->x) - (x->x < y->x);
}

static int32_t first_middle(double px, uint32_t size)
{
	return (int32_t)fmin(fmax(ceil(px - 0.5), 0), (double)size);
}

static void cross_rows(const struct camera *c, const double a[2], const double b[2], GArray *to)
{
	if (a[1] > b[1]) {
		cross_rows(c, b, a, to);
		return;
	}
	int32_t from = first_middle(a[1], c->height), end = first_middle(b[1], c->height);
	double by_row = from < end ? (b[0] - a[0]) / (b[1] - a[1]) : 0;
	for (int32_t y = from; y < end; y++) {
		double x = a[0] + by_row * (y + 0.5 - a[1]);
		struct crossing at = { y, (float)fmin(fmax(x, -1e6), 1e6) };
		g_array_append_val(to, at);
	}
}

static void project(const struct camera *c, const struct corner *p, double ret[2])
{
	double scale = c->focal_px / camera_scale_m(c, p->at[2]);
	ret[0] = p->at[0] * scale + camera_middle_x(c);
	ret[1] = p->at[1] * scale + camera_middle_y(c);
}

static void cross_ring(const struct camera *c, const GArray *ring, GArray *to)
{
	for (guint n = 0; n < ring->len; n++) {
		double a[2], b[2];
		project(c, &g_array_index(ring, struct corner, n), a);
		project(c, &g_array_index(ring, struct corner, (n + 1) % ring->len), b);
		cross_rows(c, a, b, to);
	}
}

/* All crossings of a plane's rings with the middles of rows. */
static GArray *crossings_of(
	const frame *f, const plane_regions *regions, const struct plane_region *r)
{
	const struct camera *c = &f->camera;
	struct placed p = place(c, r);
	GArray *all = g_array_new(FALSE, FALSE, sizeof(struct crossing));
	g_autoptr(GArray) ring = g_array_new(FALSE, FALSE, sizeof(struct corner));
	g_autoptr(GArray) spare = g_array_new(FALSE, FALSE, sizeof(struct corner));
	for (uint32_t n = r->first_ring; n < r->first_ring + r->rings; n++) {
		g_array_set_size(ring, 0);
		for (uint32_t i = 0; i < regions->ring[n].count; i++) {
			const float *at = regions->vertex[regions->ring[n].first + i];
			struct corner corner;
			for (int k = 0; k < 3; k++)
				corner.at[k] = p.origin[k] + (double)at[0] * p.u[k] +
					       (double)at[1] * p.v[k];
			g_array_append_val(ring, corner);
		}
		cut_ring(ring, spare, c->near_m, 1);
		cut_ring(ring, spare, c->far_m, -1);
		cross_ring(c, ring, all);
	}
	g_array_sort(all, by_row);
	return all;
}

/* Between the first crossing of a row and the second, the third and the fourth. */
static GArray *spans_of(const frame *f, const GArray *crossings)
{
	GArray *spans = g_array_new(FALSE, FALSE, sizeof(struct plane_span));
	for (guint n = 0; n + 1 < crossings->len; n += 2) {
		const struct crossing *a = &g_array_index(crossings, struct crossing, n),
				      *b = a + 1;
		struct plane_span s = { a->row, first_middle((double)a->x, f->camera.width),
			first_middle((double)b->x, f->camera.width), 0 };
		if (s.from < s.end)
			g_array_append_val(spans, s);
	}
	return spans;
}

/* ---- a plane ---- */

static void set_texture(struct plane_view *v, const struct placed *p)
{
	const struct plane_region *r = v->plane->region;
	const double *way[2] = { p->u, p->v };
	float *to[2] = { v->u, v->v };
	for (int n = 0; n < 2; n++) {
		double from = 0;
		for (int k = 0; k < 3; k++) {
			to[n][k] = (float)way[n][k] / r->texel_m;
			from += way[n][k] * p->origin[k];
		}
		to[n][3] = (float)((-from - (double)r->low_m[n]) / (double)r->texel_m);
	}
}

static struct plane_view view_of(const frame *f, const struct scene_plane *plane, uint8_t pipeline)
{
	const struct plane_region *r = plane->region;
	struct placed p = place(&f->camera, r);
	struct plane_view v = { .plane = plane,
		.leaf = r->leaf,
		.pipeline = pipeline,
		.back_m = r->thickness_m,
		.lit = 1 };
	double along = 0;
	for (int k = 0; k < 3; k++) {
		v.normal[k] = (float)p.normal[k];
		along += p.normal[k] * p.origin[k];
	}
	v.along = (float)along;
	if (f->light.amount > 0)
		v.lit = light_of_srgb(
			1 - f->light.amount * (1 - frame_diffuse(&f->light, v.normal)));
	set_texture(&v, &p);
	return v;
}

/* From where the surface's back is seen. */
static bool is_turned(const frame *f, const struct plane_view *v)
{
	return f->camera.parallel_m > 0 ? v->normal[2] > 0 : v->along > 0;
}

static void index_rows(struct plane_view *v, const GArray *spans)
{
	const struct plane_span *s = (const struct plane_span *)(void *)spans->data;
	if (!spans->len)
		return;
	v->top = s[0].row;
	v->bottom = s[spans->len - 1].row + 1;
	v->row = g_new(uint32_t, (size_t)(v->bottom - v->top) + 1);
	uint32_t at = 0;
	for (int32_t y = v->top; y <= v->bottom; y++) {
		while (at < spans->len && s[at].row < y)
			at++;
		v->row[y - v->top] = at;
	}
}

/* ---- all ---- */

static void find_pipelines(const frame *f, const struct chunk_view *views, uint32_t count,
	bool ret_has[PIPELINES_MAX + 1])
{
	memset(ret_has, 0, (PIPELINES_MAX + 1) * sizeof *ret_has);
	for (uint32_t n = 0; n < count; n++)
		ret_has[views[n].pipeline] = frame_has_planes(f, views[n].pipeline);
}

static void gather(plane_views *v, GArray *const *spans)
{
	for (uint32_t n = 0; n < v->count; n++) {
		v->view[n].first_span = v->spans;
		v->spans += spans[n]->len;
	}
	v->span = g_new(struct plane_span, v->spans + 1);
	for (uint32_t n = 0; n < v->count; n++) {
		struct plane_span *to = v->span + v->view[n].first_span;
		for (guint k = 0; k < spans[n]->len; k++) {
			to[k] = g_array_index(spans[n], struct plane_span, k);
			to[k].view = n;
		}
	}
}

/* Those that the style asks for, and whose backs it does not hide. */
static void choose(const frame *f, const bool *has, plane_views *v)
{
	const struct scene_planes *planes = f->scene->planes;
	for (uint32_t n = 0; n < planes->count; n++) {
		const struct scene_plane *p = &planes->plane[n];
		uint8_t pipeline = f->drawing->pipeline_of[p->region->leaf];
		if (!has[pipeline])
			continue;
		struct plane_view view = view_of(f, p, pipeline);
		if (!is_turned(f, &view) || frame_pipeline(f, pipeline)->mask.backs != BACKS_HIDDEN)
			v->view[v->count++] = view;
	}
}

static void find_spans(const frame *f, plane_views *v)
{
	const plane_regions *regions = f->scene->planes->regions;
	g_autofree GArray **spans = g_new(GArray *, v->count + 1);
#pragma omp parallel for schedule(dynamic, 1) if (!f->single_thread)
	for (uint32_t n = 0; n < v->count; n++) {
		g_autoptr(GArray) crossings = crossings_of(f, regions, v->view[n].plane->region);
		spans[n] = spans_of(f, crossings);
		index_rows(&v->view[n], spans[n]);
	}
	gather(v, spans);
	for (uint32_t n = 0; n < v->count; n++)
		g_array_unref(spans[n]);
}

plane_views *plane_views_new(const frame *f, const struct chunk_view *views, uint32_t count)
{
	bool has[PIPELINES_MAX + 1];
	if (!f->scene->planes)
		return NULL;
	find_pipelines(f, views, count, has);
	g_autoptr(plane_views) v = g_new0(plane_views, 1);
	v->lens = lens_of(&f->camera);
	v->view = g_new0(struct plane_view, f->scene->planes->count + 1);
	choose(f, has, v);
	if (!v->count)
		return NULL;
	find_spans(f, v);
	return g_steal_pointer(&v);
}

void plane_views_free(plane_views *v)
{
	if (!v)
		return;
	for (uint32_t n = 0; n < v->count; n++)
		g_free(v->view[n].row);
	g_free(v->view);
	g_free(v->span);
	g_free(v);
}
