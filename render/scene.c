#include "render/large.h"
#include "render/scene-bend.h"
#include "render/scene-cover.h"
#include "render/scene-grey.h"
#include <math.h>
#include <string.h>

#define STEPS     65535.f /* of a position in its box */
#define SPACING_M 65535   /* in units: that or more */

/* Of the spacing: discs of surface that was met aslant. */
#define LONGEST    2.5f
#define LEAF_SLANT 1.4f
/* No plane, but leaves: of the plane's error, 0.1 mm and of the point's size. */
#define LEAF_ERROR       200.f
#define LEAF_ERROR_SIZES 0.35f

/* Points that lightness is counted of: one in so many; and which part is left out at either end. */
#define LEVEL_STEP   7
#define LEVEL_PART   0.05
#define LEVELS_LEAST 0.1f

/* Cells of a chunk's box along each axis, for the shares of kinds around a point. */
#define CELLS 8
/* Ridges of feature points at an edge are so many points wide. */
#define RIDGE_WIDTH 2.f

void scene_free(scene *s)
{
	if (!s)
		return;
	large_free(s->memory);
	scene_bend_free(s->bend);
	g_free(s->chunk);
	g_free(s);
}

scene *scene_alloc(uint32_t count, uint32_t chunks)
{
	scene *s = g_new0(scene, 1);
	s->serial = scene_serial();
	s->count = count;
	s->chunks = chunks;
	s->lightest = 1;
	size_t n = (size_t)s->count + 16; /* vectors read beyond the end */
	struct {
		void *plane;
		size_t bytes;
	} of_point[] = { { &s->q[0], sizeof *s->q[0] }, { &s->q[1], sizeof *s->q[1] },
		{ &s->q[2], sizeof *s->q[2] }, { &s->spacing, sizeof *s->spacing },
		{ &s->disc, sizeof *s->disc }, { &s->normal, sizeof *s->normal },
		{ &s->direction, sizeof *s->direction }, { &s->rgba, sizeof *s->rgba },
		{ &s->kind, sizeof *s->kind }, { &s->degree, sizeof *s->degree },
		{ &s->list, sizeof *s->list }, { &s->list_spacing, sizeof *s->list_spacing } };
	size_t bytes = 0;
	for (size_t k = 0; k < G_N_ELEMENTS(of_point); k++)
		bytes += large_part(n * of_point[k].bytes);
	char *at = s->memory = large_new(bytes);
	for (size_t k = 0; k < G_N_ELEMENTS(of_point); k++)
		*(void **)of_point[k].plane = large_take(&at, n * of_point[k].bytes);
	memset(s->list, 0, n * sizeof *s->list);
	s->chunk = g_new0(struct scene_chunk, s->chunks + 1);
	return s;
}

uint64_t scene_serial(void)
{
	static uint64_t last;
	return __atomic_add_fetch(&last, 1, __ATOMIC_RELAXED);
}

size_t scene_bytes(const scene *s)
{
	size_t point = 5 * sizeof(uint16_t) + sizeof *s->normal + sizeof *s->direction +
		       sizeof *s->rgba + 2 + 2 * sizeof *s->list;
	return sizeof *s + s->count * point + s->chunks * sizeof *s->chunk;
}

/* ---- a chunk ---- */

static void place_chunk(scene *s, struct scene_chunk *c, const struct model_chunk *from)
{
	for (int k = 0; k < 3; k++) {
		c->centre_m[k] = (float)(from->centre_m[k] - s->origin_m[k]);
		c->half_m[k] = from->half_size_m[k];
		c->step_m[k] = 2 * c->half_m[k] / STEPS;
	}
	c->first = (uint32_t)from->first;
	c->count = from->points;
	c->leaf = from->leaf;
}

static uint16_t units(float m)
{
	return (uint16_t)fminf(fmaxf(m / SCENE_UNIT_M + 0.5f, 1), SPACING_M);
}

/* Surface that was met aslant has points far apart one way: the patch of each is long. Of leaves nobody knows how they stand. */
static void measure(scene *s, uint32_t at, const struct model_point *p)
{
	float size = fmaxf(p->size, 1), spacing = fmaxf(p->spacing, 1);
	if (p->kind == FEATURE_UNDIRECTED || p->plane_error == MODEL_ERROR_NONE ||
		p->plane_error > fmaxf(LEAF_ERROR, LEAF_ERROR_SIZES * size))
		spacing = fminf(spacing, LEAF_SLANT * size);
	float disc = CLAMP(fmaxf(spacing * spacing / size, size), spacing, LONGEST * spacing);
	s->spacing[at] = (uint16_t)fminf(spacing + 0.5f, SPACING_M);
	s->disc[at] = (uint16_t)fminf(disc + 0.5f, SPACING_M);
}

static void copy_point(scene *s, struct scene_chunk *c, uint32_t at, const struct model_point *p,
	const struct scene_grey *grey)
{
	for (int k = 0; k < 3; k++) {
		float q = c->step_m[k] > 0 ? (p->position_m[k] + c->half_m[k]) / c->step_m[k] : 0;
		s->q[k][at] = (uint16_t)fminf(fmaxf(q + 0.5f, 0), STEPS);
	}
	measure(s, at, p);
	memcpy(s->normal[at], p->normal, sizeof p->normal);
	memcpy(s->direction[at], p->kind < FEATURE_UNDIRECTED ? p->principal : p->direction,
		sizeof p->direction);
	if (p->rgba[3])
		memcpy(s->rgba[at], p->rgba, sizeof p->rgba);
	else
		scene_grey_colour(grey, p->intensity, s->rgba[at]);
	s->kind[at] = MIN(p->kind, FEATURE_KINDS - 1);
	s->degree[at] = p->feature;
}

static void find_extremes(const scene *s, struct scene_chunk *c)
{
	c->spacing_least_m = INFINITY;
	for (uint32_t i = c->first; i < c->first + c->count; i++) {
		float spacing_m = s->spacing[i] * SCENE_UNIT_M;
		c->disc_most_m = fmaxf(c->disc_most_m, s->disc[i] * SCENE_UNIT_M);
		c->spacing_least_m = fminf(c->spacing_least_m, spacing_m);
		c->spacing_most_m = fmaxf(c->spacing_most_m, spacing_m);
	}
}

static void list_kinds(scene *s, struct scene_chunk *c)
{
	uint32_t at = 0;
	for (int kind = 0; kind < FEATURE_KINDS; kind++) {
		for (uint32_t i = 0; i < c->count; i++)
			if (s->kind[c->first + i] == kind)
				s->list[c->first + at++] = (uint16_t)i;
		c->kind_end[kind] = at;
	}
}

/* ---- how far points of the same kind stand apart ---- */

struct shares {
	uint16_t of_kind[FEATURE_KINDS][CELLS + 2][CELLS + 2][CELLS + 2]; /* with an empty margin */
	uint32_t around[FEATURE_KINDS][CELLS][CELLS][CELLS];
};

static int cell_of(uint16_t q)
{
	return q * CELLS >> 16;
}

static void count_kinds(const scene *s, const struct scene_chunk *c, struct shares *h)
{
	memset(h->of_kind, 0, sizeof h->of_kind);
	for (uint32_t i = c->first; i < c->first + c->count; i++)
		h->of_kind[s->kind[i]][cell_of(s->q[2][i]) + 1][cell_of(s->q[1][i]) + 1]
			  [cell_of(s->q[0][i]) + 1]++;
}

static uint32_t sum_around(const uint16_t of[CELLS + 2][CELLS + 2][CELLS + 2], int z, int y, int x)
{
	uint32_t sum = 0;
	for (int n = 0; n < 27; n++)
		sum += of[z + n / 9][y + n / 3 % 3][x + n % 3];
	return sum;
}

static void add_up(struct shares *h)
{
	for (int kind = 0; kind < FEATURE_KINDS; kind++)
		for (int n = 0; n < CELLS * CELLS * CELLS; n++) {
			int z = n / (CELLS * CELLS), y = n / CELLS % CELLS, x = n % CELLS;
			h->around[kind][z][y][x] = sum_around(h->of_kind[kind], z, y, x);
		}
}

/* Part of the points around that are of the point's own kind. */
static float share_at(const scene *s, const struct shares *h, uint32_t i)
{
	int z = cell_of(s->q[2][i]), y = cell_of(s->q[1][i]), x = cell_of(s->q[0][i]);
	uint32_t all = 0;
	for (int kind = 0; kind < FEATURE_KINDS; kind++)
		all += h->around[kind][z][y][x];
	return (float)h->around[s->kind[i]][z][y][x] / (float)MAX(all, 1);
}

static float list_spacing_m(const scene *s, const struct shares *h, uint32_t i)
{
	float spacing_m = s->spacing[i] * SCENE_UNIT_M;
	switch (s->kind[i]) {
	case FEATURE_DIRECTED: return spacing_m / RIDGE_WIDTH; /* along the edge */
	case FEATURE_DITHER:
		/* As if it were black, of which fewer are fainter; where beams are far apart they are all there are. */
		return fmaxf(1 / sqrtf(s->dither_per_m2), spacing_m);
	default: return spacing_m / sqrtf(fmaxf(share_at(s, h, i), 1e-3f));
	}
}

static void space_list(scene *s, struct scene_chunk *c, struct shares *h)
{
	count_kinds(s, c, h);
	add_up(h);
	for (uint32_t k = c->first; k < c->first + c->count; k++) {
		uint32_t point = c->first + s->list[k];
		float *most_m = &c->list_spacing_most_m[s->kind[point]];
		s->list_spacing[k] = units(list_spacing_m(s, h, point));
		*most_m = fmaxf(*most_m, s->list_spacing[k] * SCENE_UNIT_M);
	}
}

/* Of one thread. */
struct room {
	scene_cover *cover;
	struct shares shares;
};

static void take_chunk(scene *s, uint32_t n, const model *m, const struct model_chunk *from,
	const struct scene_grey *grey, struct room *room)
{
	struct scene_chunk *c = &s->chunk[n];
	const struct model_point *p = model_points(m) + from->first;
	place_chunk(s, c, from);
	for (uint32_t i = 0; i < c->count; i++)
		copy_point(s, c, c->first + i, p + i, grey);
	scene_cover_chunk(room->cover, s, c);
	find_extremes(s, c);
	list_kinds(s, c);
	space_list(s, c, &room->shares);
	product_forget(model_file(m), p, from->points * sizeof *p);
}

/* ---- all ---- */

static double number_in(const model *m, const char *name, double fallback)
{
	JsonObject *manifest = product_manifest(model_file(m));
	return json_object_get_double_member_with_default(manifest, name, fallback);
}

static void find_origin(scene *s, const struct model_chunk *chunk)
{
	double low[3] = { INFINITY, INFINITY, INFINITY },
	       high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (uint32_t n = 0; n < s->chunks; n++)
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], chunk[n].centre_m[k]);
			high[k] = fmax(high[k], chunk[n].centre_m[k]);
		}
	for (int k = 0; k < 3 && s->chunks; k++)
		s->origin_m[k] = (low[k] + high[k]) / 2;
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

static void find_levels(scene *s)
{
	uint32_t count[256] = { 0 };
	for (uint32_t i = 0; i < s->count; i += LEVEL_STEP)
		if (s->rgba[i][3])
			count[scene_lightness(s->rgba[i])]++;
	s->darkest = lightness_below(count, LEVEL_PART);
	s->lightest = lightness_below(count, 1 - LEVEL_PART);
	if (s->lightest - s->darkest < LEVELS_LEAST) { /* no colours, or all the same */
		s->darkest = 0;
		s->lightest = 1;
	}
}

scene *scene_new(const model *m, GError **error)
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	if (model_count(m) > INT32_MAX - 4096) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NO_SPACE,
			"%s: %" G_GUINT64_FORMAT " points are more than can be drawn at once",
			product_path(model_file(m)), model_count(m));
		return NULL;
	}
	scene *s = scene_alloc((uint32_t)model_count(m), (uint32_t)chunks);
	struct features_options defaults = features_defaults(NULL);
	s->dither_per_m2 = (float)number_in(m, "dither_per_m2", defaults.dither_per_m2);
	s->tone_exponent = (float)number_in(m, "tone_exponent", defaults.tone_exponent);
	s->bend = g_new0(struct scene_bend_plane, 1);
	s->bend->model = m;
	const struct scene_grey grey = scene_grey_of(m);
	find_origin(s, chunk);
#pragma omp parallel
	{
		g_autofree struct room *room = g_new(struct room, 1);
		room->cover = scene_cover_new();
#pragma omp for schedule(dynamic, 8)
		for (uint32_t n = 0; n < s->chunks; n++)
			take_chunk(s, n, m, &chunk[n], &grey, room);
		scene_cover_free(room->cover);
	}
	find_levels(s);
	return s;
}
