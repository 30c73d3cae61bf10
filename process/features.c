#include "process/features.h"
#include "process/features-private.h"
#include "process/geometry.h"
#include "process/model.h"
#include "process/normals.h"
#include <string.h>

static float or_default(float value, float otherwise)
{
	return value > 0 ? value : value < 0 ? 0 : otherwise;
}

struct features_options features_defaults(const struct features_options *options)
{
	struct features_options o = options ? *options : (struct features_options){ 0 };
	o.radius_m = or_default(o.radius_m, GEOMETRY_RADIUS_M);
	o.geometry_weight = or_default(o.geometry_weight, 1);
	o.colour_weight = or_default(o.colour_weight, 0.7f);
	o.intensity_weight = or_default(o.intensity_weight, 0.3f);
	o.threshold = or_default(o.threshold, 0.42f);
	o.line_radius_m = or_default(o.line_radius_m, 0.4f);
	o.line_error = or_default(o.line_error, 1);
	o.dither_per_m2 = or_default(o.dither_per_m2, 60);
	o.tone_exponent = or_default(o.tone_exponent, 1);
	return o;
}

void features_free(features *f)
{
	if (!f)
		return;
	g_free(f->degree);
	g_free(f->kind);
	g_free(f->flags);
	g_free(f->direction);
	g_clear_pointer(&f->cuts, g_array_unref);
	g_free(f->line_error);
	g_free(f->k1);
	g_free(f->k2);
	g_free(f->principal);
	g_free(f);
}

features *features_new(uint32_t columns, uint32_t rows)
{
	features *f = g_new0(features, 1);
	size_t cells = (size_t)columns * rows;
	f->columns = columns;
	f->rows = rows;
	f->degree = g_malloc0(cells + 1);
	f->kind = g_malloc0(cells + 1);
	f->flags = g_malloc0(cells + 1);
	f->direction = g_malloc_n(cells + 1, sizeof *f->direction);
	f->line_error = g_new(uint16_t, cells + 1);
	f->k1 = g_new(float, cells + 1);
	f->k2 = g_new(float, cells + 1);
	f->principal = g_malloc_n(cells + 1, sizeof *f->principal);
	for (size_t i = 0; i < cells; i++) {
		f->line_error[i] = FEATURE_LINE_ERROR_NONE;
		f->k1[i] = f->k2[i] = NAN;
		for (int k = 0; k < 2; k++)
			f->direction[i][k] = f->principal[i][k] = MODEL_NORMAL_NONE;
	}
	return f;
}

void feature_planes_init(struct feature_planes *p, size_t cells)
{
	for (int k = 0; k < 3; k++)
		p->normal[k] = g_new(float, cells + 64);
	p->error_m = g_new(float, cells + 64);
	p->offset_m = g_new(float, cells + 64);
	p->count = g_new(float, cells + 64);
	p->curvature = g_new(float, cells + 64);
}

void feature_planes_clear(struct feature_planes *p)
{
	for (int k = 0; k < 3; k++)
		g_free(p->normal[k]);
	g_free(p->error_m);
	g_free(p->offset_m);
	g_free(p->count);
	g_free(p->curvature);
}

/* ---- the degree ---- */

struct weights {
	float geometry, colour, intensity;
};

static struct weights weights_of(const range_grid *g, const struct features_options *o)
{
	struct weights w = { o->geometry_weight, g->rgb ? o->colour_weight : 0,
		g->intensity ? o->intensity_weight : 0 };
	float all = o->colour_weight + o->intensity_weight, have = w.colour + w.intensity;
	if (have > 0) {
		w.colour *= all / have;
		w.intensity *= all / have;
	}
	return w;
}

static void add_edges(const range_grid *g, const struct features_options *o, const float *answer,
	float weight, uint8_t flag, features *f, float *degree)
{
#pragma omp parallel for schedule(static) if (!o->single_thread)
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		if (!(g->range_m[i] > 0))
			continue;
		degree[i] += weight * feature_soft(answer[i]);
		if (flag && answer[i] >= 1)
			f->flags[i] |= flag;
	}
}

static void estimate_degree(features *f, const struct features_input *of,
	const struct feature_planes *p, const struct features_options *o)
{
	const range_grid *g = of->grid;
	const struct weights w = weights_of(g, o);
	size_t cells = range_grid_cells(g);
	g_autofree float *answer = g_new0(float, cells + 1);
	g_autofree float *degree = g_new0(float, cells + 1);
	feature_depth_edges(of, p, o, answer, f->flags);
	feature_creases(of, p, o, answer, f->flags, &f->cuts);
	add_edges(g, o, answer, w.geometry, 0, f, degree);
	if (g->rgb) {
		feature_colour_edges(g, o, answer);
		add_edges(g, o, answer, w.colour, FEATURE_COLOUR_EDGE, f, degree);
	}
	if (g->intensity) {
		feature_intensity_edges(g, o, answer);
		add_edges(g, o, answer, w.intensity, FEATURE_INTENSITY_EDGE, f, degree);
	}
#pragma omp parallel for schedule(static) if (!o->single_thread)
	for (size_t i = 0; i < cells; i++) {
		f->degree[i] = (uint8_t)lrintf(255 * fminf(degree[i], 1));
		f->kind[i] = f->degree[i] > feature_least(o) ? FEATURE_UNDIRECTED : FEATURE_NONE;
	}
}

/* ---- all of it ---- */

static uint32_t *segments_of(const struct features_input *of)
{
	size_t cells = range_grid_cells(of->grid);
	uint32_t *ret = of->leaf ? g_new(uint32_t, cells + 1) : NULL;
	for (size_t i = 0; ret && i < cells; i++)
		ret[i] = of->leaf[i];
	return ret;
}

features *features_estimate(const struct features_input *of, const struct features_options *options)
{
	const range_grid *g = of->grid;
	struct features_options o = features_defaults(options);
	features *f = features_new(g->columns, g->rows);
	g_autofree uint32_t *segments = segments_of(of);
	struct feature_planes p;
	if (!(o.range_noise_m > 0))
		o.range_noise_m = normals_range_noise_m(g, &o.noise_at_m);
	struct normals_options normals = { .radius_m = o.radius_m,
		.range_noise_m = o.range_noise_m,
		.segment = segments,
		.single_thread = o.single_thread,
		.portable = o.portable };
	feature_planes_init(&p, range_grid_cells(g));
	struct normals_planes planes = { .normal = { p.normal[0], p.normal[1], p.normal[2] },
		.error_m = p.error_m,
		.curvature = p.curvature,
		.offset_m = p.offset_m,
		.count = p.count };
	const float *const normal[3] = { p.normal[0], p.normal[1], p.normal[2] };
	normals_fit(g, &normals, &planes);
	estimate_degree(f, of, &p, &o);
	normals_mend(g, &normals, &planes);
	feature_curvature(of, normal, &o, f);
	feature_dither(g, normal, &o, f);
	feature_planes_clear(&p);
	return f;
}

features *features_of_scans(const struct features_input *scans, size_t count, size_t which,
	const struct features_options *options)
{
	g_autofree struct features_view *views = g_new0(struct features_view, count);
	g_autofree features **all = g_new0(features *, count);
	g_autoptr(GPtrArray) ridges =
		g_ptr_array_new_with_free_func((GDestroyNotify)features_ridges_free);
	for (size_t k = 0; k < count; k++) {
		all[k] = features_estimate(&scans[k], options);
		views[k] = (struct features_view){ scans[k],
			features_ridges_new(&scans[k], all[k], options) };
		g_ptr_array_add(ridges, (gpointer)views[k].ridges);
	}
	features_fit_lines(all[which], &scans[which], views, count, options);
	for (size_t k = 0; k < count; k++)
		if (k != which)
			features_free(all[k]);
	return all[which];
}
