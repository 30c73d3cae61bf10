#include "render/large.h"
#include "render/scene-bend.h"
#include "render/scene-lines.h"
#include "render/scene-pager.h"
#include "render/scene-paint.h"
#include "render/scene-planes.h"
#include "render/scene-take.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Points that lightness is counted of: one in so many; and which part is left out at either end. */
#define LEVEL_STEP   MODEL_TONES_STEP
#define LEVEL_PART   0.05
#define LEVELS_LEAST 0.1f
/* Points that are asked how far they stand apart: so many of so many chunks. */
#define SPACING_CHUNKS 256u
#define SPACING_POINTS 16u
/* How light the lightest become where all are dark. */
#define EXPOSED_LIGHT 0.62f

void scene_free(scene *s)
{
	if (!s)
		return;
	scene_pager_free(s->pager);
	large_free(s->memory);
	scene_bend_free(s->bend);
	scene_paint_free(s->paint);
	scene_lines_free(s->lines);
	scene_planes_free(s->planes);
	g_free(s->chunk);
	g_free(s->list_ends);
	g_free(s);
}

void scene_set_lines(scene *s, const profile_lines *lines)
{
	scene_lines_free(s->lines);
	s->lines = scene_lines_new(lines, s->origin_m);
}

void scene_alloc_points(scene *s, size_t n)
{
	struct {
		void *plane;
		size_t bytes;
	} of_point[] = {
		{ &s->place, sizeof *s->place },
		{ &s->disc, sizeof *s->disc },
		{ &s->normal, sizeof *s->normal },
		{ &s->direction, sizeof *s->direction },
		{ &s->rgba, sizeof *s->rgba },
		{ &s->kind, sizeof *s->kind },
		{ &s->degree, sizeof *s->degree },
		{ &s->list, sizeof *s->list },
	};
	size_t bytes = 0;
	for (size_t k = 0; k < G_N_ELEMENTS(of_point); k++)
		bytes += large_part(n * of_point[k].bytes);
	char *at = s->memory = large_new(bytes);
	for (size_t k = 0; k < G_N_ELEMENTS(of_point); k++)
		*(void **)of_point[k].plane = large_take(&at, n * of_point[k].bytes);
}

scene *scene_alloc(uint32_t count, uint32_t chunks)
{
	scene *s = g_new0(scene, 1);
	s->serial = scene_serial();
	s->paint = scene_paint_new();
	s->count = count;
	s->chunks = chunks;
	s->lightest = 1;
	s->unit_m = SCENE_UNIT_M;
	size_t n = (size_t)s->count + 16; /* vectors read beyond the end */
	scene_alloc_points(s, n);
	memset(s->list, 0, n * sizeof *s->list);
	s->chunk = g_new0(struct scene_chunk, s->chunks + 1);
	s->list_ends = g_new0(struct scene_list_ends, s->chunks + 1);
	for (uint32_t c = 0; c < chunks; c++) {
		s->chunk[c].part = 1;
		s->chunk[c].list_ends = &s->list_ends[c];
	}
	return s;
}

uint64_t scene_serial(void)
{
	static uint64_t last;
	return __atomic_add_fetch(&last, 1, __ATOMIC_RELAXED);
}

static size_t bytes_of(uint64_t points, uint64_t chunks)
{
	return sizeof(scene) + points * SCENE_POINT_BYTES +
	       chunks * (sizeof(struct scene_chunk) + sizeof(struct scene_list_ends));
}

size_t scene_bytes(const scene *s)
{
	return s->pager ? scene_pager_bytes(s->pager) : bytes_of(s->count, s->chunks);
}

static int compare_chunks(const void *a, const void *b)
{
	const struct scene_chunk *key = a, *c = b;
	return key->first < c->first ? -1 : key->first >= c->first + c->count;
}

struct scene_owner scene_owner_of(const scene *s, uint32_t id)
{
	if (s->pager)
		return scene_pager_owner_of(s->pager, id);
	struct scene_chunk key = { .first = id };
	const struct scene_chunk *c =
		bsearch(&key, s->chunk, s->chunks, sizeof key, compare_chunks);
	return c ? (struct scene_owner){ c->first, c->first + c->count, c->leaf }
		 : (struct scene_owner){ 0 };
}

/* ---- all ---- */

static double number_in(const model *m, const char *name, double fallback)
{
	JsonObject *manifest = product_manifest(model_file(m));
	return json_object_get_double_member_with_default(manifest, name, fallback);
}

void scene_find_origin(scene *s, const struct model_chunk *chunk, uint64_t chunks)
{
	double low[3] = { INFINITY, INFINITY, INFINITY },
	       high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (uint64_t n = 0; n < chunks; n++)
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], chunk[n].centre_m[k]);
			high[k] = fmax(high[k], chunk[n].centre_m[k]);
		}
	for (int k = 0; k < 3 && chunks; k++)
		s->origin_m[k] = (low[k] + high[k]) / 2;
}

void scene_find_spacing(scene *s, const model *m)
{
	uint64_t chunks, all = 0, below = 0;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	g_autofree uint64_t *count = g_new0(uint64_t, UINT16_MAX + 1);
	for (uint64_t n = 0; n < chunks; n += 1 + chunks / SPACING_CHUNKS)
		for (uint32_t i = 0; i < MIN(chunk[n].points, SPACING_POINTS); i++) {
			/* Each stands for as many of its chunk. */
			uint64_t part = chunk[n].points / MIN(chunk[n].points, SPACING_POINTS);
			count[model_points(m)[chunk[n].first + i].spacing] += part;
			all += part;
		}
	uint32_t median = 0;
	while (median < UINT16_MAX && 2 * (below += count[median]) < all)
		median++;
	bool is_far = 2 * count[UINT16_MAX] > all;
	s->unit_m = is_far ? SCENE_UNIT_FAR_M : SCENE_UNIT_M;
	s->spacing_median_m = (float)median * SCENE_UNIT_M;
}

void scene_find_densities(scene *s, const model *m)
{
	struct features_options defaults = features_defaults(NULL);
	s->dither_per_m2 = (float)number_in(m, "dither_per_m2", defaults.dither_per_m2);
	s->tone_exponent = (float)number_in(m, "tone_exponent", defaults.tone_exponent);
}

/* The lightness that a part of the coloured points is below. */
static float lightness_below(const uint32_t count[256], double part)
{
	uint64_t all = 0, below = 0;
	for (int n = 0; n < 256; n++)
		all += count[n];
	for (int n = 0; n < 256; n++)
		if ((double)(below += count[n]) >= part * (double)all)
			return (float)n / 255;
	return 1;
}

void scene_set_levels(scene *s, const uint32_t count[256])
{
	s->darkest = lightness_below(count, LEVEL_PART);
	s->lightest = lightness_below(count, 1 - LEVEL_PART);
	if (s->lightest - s->darkest < LEVELS_LEAST) { /* no colours, or all the same */
		s->darkest = 0;
		s->lightest = 1;
	}
}

float scene_exposure_of(const scene *s, float exposure)
{
	float light = fmaxf(s->lightest, LEVELS_LEAST),
	      times = EXPOSED_LIGHT * (1 - light) / (light * (1 - EXPOSED_LIGHT));
	return powf(fmaxf(times, 1), exposure);
}

static void find_levels(scene *s)
{
	uint32_t count[256] = { 0 };
	for (uint32_t i = 0; i < s->count; i += LEVEL_STEP)
		if (s->rgba[i][3])
			count[scene_lightness(s->rgba[i])]++;
	scene_set_levels(s, count);
}

static void take_chunk(scene *s, uint32_t n, const model *m, const struct model_chunk *from,
	const struct scene_grey *grey, scene_taker *taker)
{
	struct scene_chunk *c = &s->chunk[n];
	const struct model_point *p = model_points(m) + from->first;
	scene_place_chunk(s, c, from);
	c->first = (uint32_t)from->first;
	scene_take(taker, s, c, p, grey);
	scene_planes_mark(s, c);
	product_forget(model_file(m), p, from->points * sizeof *p);
}

static scene *new_whole(const model *m, const uint8_t *leaf_class, GError **error)
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	if (model_count(m) > SCENE_POINTS_MOST) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NO_SPACE,
			"%s: %" G_GUINT64_FORMAT " points are more than can be drawn at once",
			product_path(model_file(m)), model_count(m));
		return NULL;
	}
	const struct scene_grey grey = scene_grey_of(m, leaf_class);
	struct scene_planes *planes;
	if (!scene_planes_load(m, &grey, &planes, error))
		return NULL;
	scene *s = scene_alloc((uint32_t)model_count(m), (uint32_t)chunks);
	s->planes = planes;
	scene_find_spacing(s, m);
	scene_find_densities(s, m);
	s->bend = g_new0(struct scene_bend_plane, 1);
	s->bend->model = m;
	scene_find_origin(s, chunk, chunks);
#pragma omp parallel
	{
		scene_taker *taker = scene_taker_new();
#pragma omp for schedule(dynamic, 8)
		for (uint32_t n = 0; n < s->chunks; n++)
			take_chunk(s, n, m, &chunk[n], &grey, taker);
		scene_taker_free(taker);
	}
	find_levels(s);
	return s;
}

scene *scene_new(const model *m, GError **error)
{
	return new_whole(m, NULL, error);
}

/* What a machine of today is left with for all else. */
static uint64_t memory_by_itself(void)
{
	uint64_t all = (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE);
	return all / 2;
}

scene *scene_new_within(
	const model *m, const uint8_t *leaf_class, uint64_t memory_bytes, GError **error)
{
	uint64_t chunks, most = memory_bytes ? memory_bytes : memory_by_itself();
	model_chunks(m, &chunks);
	bool fits = model_count(m) <= SCENE_POINTS_MOST && bytes_of(model_count(m), chunks) <= most;
	return fits || !model_in_short(m).tones ? new_whole(m, leaf_class, error)
						: scene_paged(m, leaf_class, most, error);
}
