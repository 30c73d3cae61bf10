#include "process/features-cloud.h"
#include "process/features-private.h"
#include "process/model.h"
#include <stdlib.h>
#include <string.h>

/* What stands around: this many point sizes away. */
#define AROUND_SIZES 4.0f
#define AROUND_LEAST 8
/* More points of a voxel than this are not looked at. */
#define VOXEL_POINTS 24
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

/* ---- points by voxel ---- */

struct voxels {
	const struct cloud_view *view;
	float side_m;
	uint32_t *order; /* points, voxel by voxel */
	uint64_t *key;   /* of each in order */
	uint32_t *slot;  /* of a hash table: place in order of the first of a voxel, plus one */
	uint32_t slots, count;
};

static void position(const struct cloud_view *v, size_t i, double ret[3])
{
	memcpy(ret, cloud_view_at(v, i), 3 * sizeof *ret);
}

static uint64_t voxel_key(const int64_t at[3])
{
	return ((uint64_t)at[0] & 0x1fffff) | ((uint64_t)at[1] & 0x1fffff) << 21 |
	       ((uint64_t)at[2] & 0x1fffff) << 42;
}

static void voxel_at(const struct voxels *x, const double p[3], int64_t ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = (int64_t)floor(p[k] / x->side_m);
}

static uint32_t hash_of(const struct voxels *x, uint64_t key)
{
	key *= 0x9e3779b97f4a7c15U;
	return (uint32_t)(key >> 32) & (x->slots - 1);
}

struct keyed {
	uint64_t key;
	uint32_t point;
};

static int by_key(const void *a, const void *b)
{
	const struct keyed *x = a, *y = b;
	return x->key != y->key ? (x->key > y->key) - (x->key < y->key)
				: (x->point > y->point) - (x->point < y->point);
}

/* use: which points; NULL: all. */
static void voxels_init(
	struct voxels *x, const struct cloud_view *v, float side_m, const uint8_t *use)
{
	*x = (struct voxels){ .view = v, .side_m = side_m, .slots = 64 };
	g_autofree struct keyed *all = g_new(struct keyed, v->count + 1);
	for (size_t i = 0; i < v->count; i++) {
		double p[3];
		int64_t at[3];
		if (use && !use[i])
			continue;
		position(v, i, p);
		voxel_at(x, p, at);
		all[x->count++] = (struct keyed){ voxel_key(at), (uint32_t)i };
	}
	qsort(all, x->count, sizeof *all, by_key);
	while (x->slots < 2 * x->count)
		x->slots *= 2;
	x->order = g_new(uint32_t, x->count + 1);
	x->key = g_new(uint64_t, x->count + 1);
	x->slot = g_new0(uint32_t, x->slots);
	for (uint32_t i = 0; i < x->count; i++) {
		x->order[i] = all[i].point;
		x->key[i] = all[i].key;
		if (i && all[i].key == all[i - 1].key)
			continue;
		uint32_t h = hash_of(x, all[i].key);
		while (x->slot[h])
			h = (h + 1) & (x->slots - 1);
		x->slot[h] = i + 1;
	}
}

static void voxels_clear(struct voxels *x)
{
	g_free(x->order);
	g_free(x->key);
	g_free(x->slot);
}

/* Points of a voxel, from *ret_first on in order. */
static uint32_t find_voxel(const struct voxels *x, uint64_t key, uint32_t *ret_first)
{
	for (uint32_t h = hash_of(x, key); x->slot[h]; h = (h + 1) & (x->slots - 1)) {
		uint32_t first = x->slot[h] - 1, end = first;
		if (x->key[first] != key)
			continue;
		while (end < x->count && x->key[end] == key)
			end++;
		*ret_first = first;
		return end - first;
	}
	return 0;
}

/* Calls visit for the points within radius_m (at most a voxel's side), with what each is off. */
static void visit_around(const struct voxels *x, const double at[3], float radius_m,
	void (*visit)(uint32_t point, const float off[3], void *data), void *data)
{
	int64_t middle[3];
	voxel_at(x, at, middle);
	for (int n = 0; n < 27; n++) {
		int64_t there[3] = { middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1,
			middle[2] + n / 9 - 1 };
		uint32_t first = 0, count = find_voxel(x, voxel_key(there), &first);
		uint32_t stride = count / VOXEL_POINTS + 1;
		for (uint32_t i = 0; i < count; i += stride) {
			double p[3];
			position(x->view, x->order[first + i], p);
			float off[3] = { (float)(p[0] - at[0]), (float)(p[1] - at[1]),
				(float)(p[2] - at[2]) };
			if (off[0] * off[0] + off[1] * off[1] + off[2] * off[2] <=
				radius_m * radius_m)
				visit(x->order[first + i], off, data);
		}
	}
}

/* ---- the degree ---- */

/* What is summed up around a point. */
struct sums {
	const struct features_cloud_input *of;
	float axis[2][3]; /* along the surface */
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
	float a = off[0] * s->axis[0][0] + off[1] * s->axis[0][1] + off[2] * s->axis[0][2];
	float b = off[0] * s->axis[1][0] + off[1] * s->axis[1][1] + off[2] * s->axis[1][2];
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

static void estimate_point(const struct job *j, const struct voxels *x, size_t i, float radius_m)
{
	struct sums s = { .of = j->of, .least = INFINITY };
	float normal[3];
	double at[3];
	model_unpack_normal(j->of->normal[i], normal);
	int low = fabsf(normal[0]) < fabsf(normal[1])
			  ? (fabsf(normal[0]) < fabsf(normal[2]) ? 0 : 2)
			  : (fabsf(normal[1]) < fabsf(normal[2]) ? 1 : 2);
	float length = sqrtf(fmaxf(1 - normal[low] * normal[low], 1e-6f));
	for (int k = 0; k < 3; k++)
		s.axis[0][k] = ((k == low) - normal[low] * normal[k]) / length;
	for (int k = 0; k < 3; k++)
		s.axis[1][k] = normal[(k + 1) % 3] * s.axis[0][(k + 2) % 3] -
			       normal[(k + 2) % 3] * s.axis[0][(k + 1) % 3];
	position(&j->of->view, i, at);
	visit_around(x, at, radius_m, add_neighbour, &s);
	if (s.n < AROUND_LEAST)
		return;
	float degree = j->o->geometry_weight *
		       feature_soft(geometry_answer(j, &s, radius_m, &j->f->flags[i]));
	degree += look_degree(j, &s, radius_m, &j->f->flags[i]);
	j->f->degree[i] = (uint8_t)lrintf(255 * fminf(degree, 1));
	if (j->f->degree[i] > feature_least(j->o))
		j->f->kind[i] = FEATURE_UNDIRECTED;
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
		feature_keep_point(&g->around, off, NULL, near * degree * degree);
}

static void fit_point(const struct job *j, const struct voxels *x, size_t i, float radius_m)
{
	struct gather g = { .f = j->f, .radius_m = radius_m };
	struct feature_line line;
	float ahead[3], explained_m = j->o->line_error *
				      hypotf(j->noise_m, SIZE_SHARE * j->of->point_size_m[i]);
	double at[3];
	model_unpack_normal(j->of->normal[i], ahead);
	position(&j->of->view, i, at);
	visit_around(x, at, radius_m, gather_point, &g);
	bool is = feature_fit_line(&g.around, NULL, ahead, explained_m, radius_m, &line);
	feature_keep_line(j->f, i, &line, is);
}

/* ---- all points, those of about one size after those of another ---- */

static float around_m(const struct job *j, size_t i)
{
	return AROUND_SIZES * j->of->point_size_m[i];
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

/* Runs work on the points that use names (NULL: all), with voxels of about the radius of each. */
static bool for_all(const struct job *j, const uint8_t *use,
	float (*radius_m)(const struct job *, size_t),
	void (*work)(const struct job *, const struct voxels *, size_t, float),
	bool (*progress)(double, gpointer), gpointer user_data, double from)
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
		struct voxels x;
		float side_m = ldexpf(least_m, level);
		if (!wanted[level])
			continue;
		if (progress && !progress(from + 0.5 * level / LEVELS_MOST, user_data))
			return false;
		voxels_init(&x, &j->of->view, side_m, use);
#pragma omp parallel for schedule(dynamic, 1024) if (!j->o->single_thread)
		for (size_t i = 0; i < count; i++) {
			float r = has_place(j, i) && (!use || use[i]) ? radius_m(j, i) : 0;
			if (r > 0 && level_of(r, least_m) == level)
				work(j, &x, i, fminf(r, side_m));
		}
		voxels_clear(&x);
	}
	return true;
}

/* ---- dithering ---- */

/* Interleaves the bits of a place among voxels: near along the curve is near in space. */
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
	g_autofree struct keyed *order = g_new(struct keyed, count + 1);
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
		order[used++] = (struct keyed){ key, (uint32_t)i };
	}
	qsort(order, used, sizeof *order, by_key);
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
	if (!for_all(&j, NULL, around_m, estimate_point, progress, user_data, 0))
		return NULL;
	g_autofree uint8_t *use = g_malloc(of->view.count + 1);
	for (size_t i = 0; i < of->view.count; i++)
		use[i] = f->kind[i] == FEATURE_UNDIRECTED;
	if (!for_all(&j, use, line_m, fit_point, progress, user_data, 0.5))
		return NULL;
	dither(&j);
	return g_steal_pointer(&f);
}
