#include "process/features-cloud.h"
#include "process/cloud-cells.h"
#include "process/features-private.h"
#include "process/model.h"
#include "process/vector3.h"
#include <stdlib.h>
#include <string.h>

/* What stands around: this many point sizes away. */
#define AROUND_SIZES 4.0f
#define AROUND_LEAST 8
/* More points of a cell than these are not looked at; for curvature, of a cell as wide as the radius. */
#define CELL_POINTS 24
#define BEND_POINTS 16
/* How much errors vary, of the least of them, by chance alone: of planes through some 16 points. */
#define ERROR_VARIES 0.55f
/* All stand on one side: how far their middle is away, in the radius; of half a disc it is 0.42. */
#define ONE_SIDED   0.34f
#define COLOUR_STEP 0.15f
#define AMONG       1.5f
#define LINE_SIZES  8.0f
#define SIZE_SHARE  0.7f
#define ANSWER_MOST 8.0f
#define LEVELS_MOST 12
/* Curvature is looked for within so many widths of windows for normals (features-curvature.c), which noise and point size widen. */
#define BEND_WIDTHS  1.5f
#define NOISE_WIDENS 62

static void position(const struct cloud_view *v, size_t i, double ret[3])
{
	memcpy(ret, cloud_view_at(v, i), 3 * sizeof *ret);
}

/* ---- the degree ---- */

/* What is summed up around a point. */
struct sums {
	const struct features_cloud_input *of;
	struct feature_frame frame;
	float n, error, error2, least, a, b, aa, ab, bb;
	float c[4], ca[4], cb[4], cc[4]; /* red, green, blue, intensity */
};

static void add_look(struct sums *s, uint32_t i, float a, float b)
{
	const struct point_record *r = &s->of->look->record[i];
	const float value[4] = { r->rgb[0] / 255.f, r->rgb[1] / 255.f, r->rgb[2] / 255.f,
		logf(1 + r->intensity) };
	for (int k = 0; k < 4; k++) {
		s->c[k] += value[k];
		s->ca[k] += value[k] * a;
		s->cb[k] += value[k] * b;
		s->cc[k] += value[k] * value[k];
	}
}

static void add_neighbour(uint32_t i, const float off[3], void *data)
{
	struct sums *s = data;
	float a = vector3_dot(off, s->frame.first), b = vector3_dot(off, s->frame.second);
	float error = s->of->plane_error_m[i];
	if (!isfinite(error))
		return;
	s->n++;
	s->error += error;
	s->error2 += error * error;
	s->least = fminf(s->least, error);
	s->a += a;
	s->b += b;
	s->aa += a * a;
	s->ab += a * b;
	s->bb += b * b;
	if (s->of->look)
		add_look(s, i, a, b);
}

/* How much a value changes across, against what is left. */
static float slope_answer(const struct sums *s, int k, float radius_m, float step)
{
	float n = s->n, ma = s->a / n, mb = s->b / n, mc = s->c[k] / n;
	float aa = s->aa / n - ma * ma, ab = s->ab / n - ma * mb, bb = s->bb / n - mb * mb;
	float ca = s->ca[k] / n - mc * ma, cb = s->cb[k] / n - mc * mb, cc = s->cc[k] / n - mc * mc;
	float det = aa * bb - ab * ab;
	if (!(det > 1e-6f * radius_m * radius_m * radius_m * radius_m))
		return 0;
	float x = (ca * bb - cb * ab) / det, y = (cb * aa - ca * ab) / det;
	float left = sqrtf(fmaxf(cc - x * ca - y * cb, 0));
	return fminf(sqrtf(x * x + y * y) * radius_m / (step + AMONG * left), ANSWER_MOST);
}

struct job {
	const struct features_cloud_input *of;
	const struct features_options *o;
	features *f;
	float noise_m; /* the least of plane errors that is common */
};

static float geometry_answer(
	const struct job *j, const struct sums *s, float radius_m, uint8_t *flags)
{
	float mean = s->error / s->n, varies = sqrtf(fmaxf(s->error2 / s->n - mean * mean, 0));
	float crease = varies / (ERROR_VARIES * fmaxf(fmaxf(s->least, j->noise_m), 1e-6f));
	float border = hypotf(s->a, s->b) / (s->n * radius_m * ONE_SIDED);
	if (crease >= 1)
		*flags |= FEATURE_CREASE;
	if (border >= 1)
		*flags |= FEATURE_SILHOUETTE;
	return fminf(fmaxf(crease, border), ANSWER_MOST);
}

static float look_degree(const struct job *j, const struct sums *s, float radius_m, uint8_t *flags)
{
	const points *look = j->of->look;
	bool colour = look && look->have & POINTS_HAVE_COLOUR,
	     light = look && look->have & POINTS_HAVE_INTENSITY;
	float weight = j->o->colour_weight + j->o->intensity_weight, edge = 0, lit = 0;
	for (int k = 0; k < 3 && colour; k++)
		edge = fmaxf(edge, slope_answer(s, k, radius_m, COLOUR_STEP));
	if (light)
		lit = slope_answer(s, 3, radius_m, 2 * COLOUR_STEP);
	*flags |= (edge >= 1 ? FEATURE_COLOUR_EDGE : 0) | (lit >= 1 ? FEATURE_INTENSITY_EDGE : 0);
	if (colour && light)
		return j->o->colour_weight * feature_soft(edge) +
		       j->o->intensity_weight * feature_soft(lit);
	return weight * feature_soft(fmaxf(edge, lit));
}

static void estimate_point(
	const struct job *j, const struct cloud_cells *x, size_t i, float radius_m)
{
	float normal[3];
	double at[3];
	model_unpack_normal(j->of->normal[i], normal);
	struct sums s = { .of = j->of, .least = INFINITY, .frame = feature_frame_of(normal) };
	position(&j->of->view, i, at);
	cloud_cells_visit(x, at, radius_m, CELL_POINTS, add_neighbour, &s);
	if (s.n < AROUND_LEAST)
		return;
	float degree = j->o->geometry_weight *
		       feature_soft(geometry_answer(j, &s, radius_m, &j->f->flags[i]));
	degree += look_degree(j, &s, radius_m, &j->f->flags[i]);
	j->f->degree[i] = (uint8_t)lrintf(255 * fminf(degree, 1));
	if (j->f->degree[i] > feature_least(j->o))
		j->f->kind[i] = FEATURE_UNDIRECTED;
}

/* ---- curvature ---- */

struct bend {
	const struct features_cloud_input *of;
	struct feature_frame frame;
	struct feature_form form;
};

/* Which eighth of the turn, from a towards b. */
static int way_of(float a, float b)
{
	static const int8_t ways[8] = { 0, 1, 3, 2, 7, 6, 4, 5 };
	return ways[(b < 0) << 2 | (a < 0) << 1 | (fabsf(b) > fabsf(a))];
}

/* Normals of a cloud may look to either side: they are turned to that of the point. */
static void add_normal(uint32_t i, const float off[3], void *data)
{
	struct bend *b = data;
	float there[3];
	if (b->of->normal[i][0] == MODEL_NORMAL_NONE || !(vector3_dot(off, off) > 0))
		return;
	model_unpack_normal(b->of->normal[i], there);
	if (vector3_dot(there, b->frame.normal) < 0)
		for (int k = 0; k < 3; k++)
			there[k] = -there[k];
	feature_form_add(&b->form, &b->frame, off, there,
		way_of(vector3_dot(off, b->frame.first), vector3_dot(off, b->frame.second)));
}

static void bend_point(const struct job *j, const struct cloud_cells *x, size_t i, float radius_m)
{
	float normal[3];
	double at[3];
	model_unpack_normal(j->of->normal[i], normal);
	position(&j->of->view, i, at);
	struct bend b = { .of = j->of, .frame = feature_frame_of(normal) };
	float wide = x->side_m / radius_m;
	cloud_cells_visit(x, at, radius_m, (uint32_t)(BEND_POINTS * wide * wide), add_normal, &b);
	feature_form_keep(&b.form, &b.frame, j->f, i);
}

/* ---- lines ---- */

struct gather {
	const features *f;
	struct feature_around around;
	float radius_m;
};

static void gather_point(uint32_t i, const float off[3], void *data)
{
	struct gather *g = data;
	float near = 1 - (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) /
				 (g->radius_m * g->radius_m);
	float degree = g->f->degree[i] * (1 / 255.f);
	if (near > 0)
		feature_keep_point(&g->around, off, NULL, near * degree * degree, 0);
}

static void fit_point(const struct job *j, const struct cloud_cells *x, size_t i, float radius_m)
{
	struct gather g = { .f = j->f, .radius_m = radius_m };
	struct feature_line line;
	float ahead[3], explained_m = j->o->line_error *
				      hypotf(j->noise_m, SIZE_SHARE * j->of->point_size_m[i]);
	double at[3];
	model_unpack_normal(j->of->normal[i], ahead);
	position(&j->of->view, i, at);
	cloud_cells_visit(x, at, radius_m, CELL_POINTS, gather_point, &g);
	bool is = feature_fit_line(&g.around, NULL, ahead, explained_m, radius_m, &line);
	feature_keep_line(j->f, i, &line, is);
}

/* ---- all points, those of about one size after those of another ---- */

static float around_m(const struct job *j, size_t i)
{
	return AROUND_SIZES * j->of->point_size_m[i];
}

/* Normals are of windows of two point sizes, or of half radius_m at least; and they need more the noisier they are. */
static float bend_m(const struct job *j, size_t i)
{
	float noise_m = sqrtf(NOISE_WIDENS * j->noise_m * j->of->point_size_m[i]);
	return fmaxf(around_m(j, i), BEND_WIDTHS * fmaxf(j->o->radius_m, noise_m));
}

static float line_m(const struct job *j, size_t i)
{
	return fmaxf(j->o->line_radius_m, LINE_SIZES * j->of->point_size_m[i]);
}

static bool has_place(const struct job *j, size_t i)
{
	return j->of->point_size_m[i] > 0 && j->of->normal[i][0] != MODEL_NORMAL_NONE;
}

static int level_of(float radius_m, float least_m)
{
	return CLAMP((int)ceilf(log2f(fmaxf(radius_m / least_m, 1))), 0, LEVELS_MOST - 1);
}

/* Runs work on the points that use names (NULL: all), with cells of about the radius of each. */
static bool for_all(const struct job *j, const uint8_t *use,
	float (*radius_m)(const struct job *, size_t),
	void (*work)(const struct job *, const struct cloud_cells *, size_t, float),
	bool (*progress)(double, gpointer), gpointer user_data, double from, double share)
{
	const size_t count = j->of->view.count;
	float least_m = INFINITY;
	bool wanted[LEVELS_MOST] = { 0 };
	for (size_t i = 0; i < count; i++)
		if (has_place(j, i) && (!use || use[i]))
			least_m = fminf(least_m, fmaxf(radius_m(j, i), 1e-3f));
	for (size_t i = 0; i < count; i++)
		if (has_place(j, i) && (!use || use[i]))
			wanted[level_of(radius_m(j, i), least_m)] = true;
	for (int level = 0; level < LEVELS_MOST; level++) {
		struct cloud_cells x;
		float side_m = ldexpf(least_m, level);
		if (!wanted[level])
			continue;
		if (progress && !progress(from + share * level / LEVELS_MOST, user_data))
			return false;
		cloud_cells_init(&x, &j->of->view, side_m, use);
#pragma omp parallel for schedule(dynamic, 1024) if (!j->o->single_thread)
		for (size_t i = 0; i < count; i++) {
			float r = has_place(j, i) && (!use || use[i]) ? radius_m(j, i) : 0;
			if (r > 0 && level_of(r, least_m) == level)
				work(j, &x, i, fminf(r, side_m));
		}
		cloud_cells_clear(&x);
	}
	return true;
}

/* ---- dithering ---- */

/* Interleaves the bits of a place among cubes: near along the curve is near in space. */
static uint64_t spread_bits(uint64_t x)
{
	x &= 0x1fffff;
	x = (x | x << 32) & 0x1f00000000ffffULL;
	x = (x | x << 16) & 0x1f0000ff0000ffULL;
	x = (x | x << 8) & 0x100f00f00f00f00fULL;
	x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
	return (x | x << 2) & 0x1249249249249249ULL;
}

static float tone_of(const struct features_cloud_input *of, size_t i, float white)
{
	const struct point_record *r = of->look ? &of->look->record[i] : NULL;
	if (r && of->look->have & POINTS_HAVE_COLOUR)
		return (0.299f * r->rgb[0] + 0.587f * r->rgb[1] + 0.114f * r->rgb[2]) * (1 / 255.f);
	return r && of->look->have & POINTS_HAVE_INTENSITY ? r->intensity / white : 0.5f;
}

static float white_of(const struct features_cloud_input *of)
{
	double sum = 0;
	for (size_t i = 0; of->look && i < of->view.count; i++)
		sum += of->look->record[i].intensity;
	return fmaxf(2 * (float)(sum / fmax((double)of->view.count, 1)), 1);
}

static void dither(const struct job *j)
{
	const size_t count = j->of->view.count;
	const double side_m = 0.25 / sqrt(j->o->dither_per_m2 + 1e-3);
	g_autofree struct cloud_keyed *order = g_new(struct cloud_keyed, count + 1);
	const float white = white_of(j->of);
	size_t used = 0;
	for (size_t i = 0; i < count; i++) {
		double p[3];
		uint64_t key = 0;
		if (!(j->of->point_size_m[i] > 0) || j->f->kind[i] != FEATURE_NONE)
			continue;
		position(&j->of->view, i, p);
		for (int k = 0; k < 3; k++)
			key |= spread_bits((uint64_t)((int64_t)floor(p[k] / side_m) + (1 << 20)))
			       << k;
		order[used++] = (struct cloud_keyed){ key, (uint32_t)i };
	}
	cloud_keyed_sort(order, used);
	double together = 0.5, next = 1;
	for (size_t n = 0; n < used; n++) {
		size_t i = order[n].point;
		float area_m2 = j->of->point_size_m[i] * j->of->point_size_m[i];
		float dark = feature_darkness(tone_of(j->of, i, white), j->o->tone_exponent);
		together += fminf(dark * area_m2 * j->o->dither_per_m2, 1);
		if (together < next)
			continue;
		j->f->kind[i] = FEATURE_DITHER;
		together -= next;
		next = 0.75 +
		       0.5 * feature_noise((uint32_t)
					     i); /* 1 on average; the curve's own steps do not show then */
	}
}

/* ---- all of it ---- */

static int by_float(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* A quarter of the planes' errors is below. */
static float noise_of(const struct features_cloud_input *of)
{
	size_t stride = of->view.count / 100000 + 1, kept = 0;
	g_autofree float *error = g_new(float, of->view.count / stride + 2);
	for (size_t i = 0; i < of->view.count; i += stride)
		if (isfinite(of->plane_error_m[i]))
			error[kept++] = of->plane_error_m[i];
	qsort(error, kept, sizeof *error, by_float);
	return kept ? error[kept / 4] : 0;
}

features *features_of_cloud(const struct features_cloud_input *of,
	const struct features_options *options,
	bool (*progress)(double fraction, gpointer user_data), gpointer user_data)
{
	struct features_options o = features_defaults(options);
	g_autoptr(features) f = features_new((uint32_t)of->view.count, 1);
	struct job j = { of, &o, f, noise_of(of) };
	if (!for_all(&j, NULL, around_m, estimate_point, progress, user_data, 0, 0.4) ||
		!for_all(&j, NULL, bend_m, bend_point, progress, user_data, 0.4, 0.3))
		return NULL;
	g_autofree uint8_t *use = g_malloc(of->view.count + 1);
	for (size_t i = 0; i < of->view.count; i++)
		use[i] = f->kind[i] == FEATURE_UNDIRECTED;
	if (!for_all(&j, use, line_m, fit_point, progress, user_data, 0.7, 0.3))
		return NULL;
	dither(&j);
	return g_steal_pointer(&f);
}
