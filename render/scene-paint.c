#include "render/scene-paint.h"
#include "process/segments.h"
#include "process/vector3.h"
#include "render/large.h"
#include "render/scene-bend.h"
#include <math.h>
#include <string.h>

#define CELLS SCENE_PAINT_CELLS
/* Of a difference of colours, 0..1: how much is none, and how much as good as an edge. */
#define COLOURS_ALIKE  0.08f
#define COLOURS_DIFFER 0.4f
/* How much there is to see of features that are no edges, most of which are leaves. */
#define DETAIL_UNDIRECTED 0.45f
#define LEAFY             0.3f /* part of them */
/* How much what is beside details counts as one. */
#define DETAIL_BESIDE  0.8f
#define DETAIL_SPREADS 3.f
/* Part of the directions around a point that must be one direction, for those beside edges to go along with them. */
#define ONE_WAY 0.45f
/* Curvatures, 1/m: what is bent less is as good as flat; and how much less it must be bent the other way. */
#define BENT_LEAST     0.5f
#define BENT_BOTH_WAYS 1.5f

struct cell {
	float rgb[3];
	float detail, points; /* sum, of how many */
	float way[6];         /* sum of products of edges' directions: xx yy zz xy xz yz */
	float edges;
};

/* A chunk as it is looked at. */
struct look {
	const scene *s;
	const struct scene_chunk *chunk;
	float cell_m;
	uint32_t across[3]; /* cells along each axis that there are, at most CELLS */
	struct cell *cell;
};

static bool is_edge(const scene *s, uint32_t point)
{
	return s->kind[point] == FEATURE_DIRECTED && s->direction[point][0] != MODEL_NORMAL_NONE;
}

static void cell_of(const struct look *l, uint32_t point, uint32_t ret[3])
{
	for (int k = 0; k < 3; k++) {
		float at_m = l->chunk->step_m[k] * (float)l->s->place[point].q[k];
		ret[k] = MIN((uint32_t)(at_m / l->cell_m), l->across[k] - 1);
	}
}

static struct cell *cell_at(const struct look *l, const uint32_t at[3])
{
	return &l->cell[(at[2] * CELLS + at[1]) * CELLS + at[0]];
}

static void add_way(struct cell *c, const float d[3])
{
	static const int pair[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 0, 2 },
		{ 1, 2 } };
	for (int k = 0; k < 6; k++)
		c->way[k] += d[pair[k][0]] * d[pair[k][1]];
	c->edges++;
}

static float detail_of(const scene *s, uint32_t point)
{
	float degree = (float)s->degree[point] / 255;
	if (is_edge(s, point))
		return 1;
	return s->kind[point] >= FEATURE_UNDIRECTED ? DETAIL_UNDIRECTED : degree * degree;
}

static void count_point(const struct look *l, uint32_t point)
{
	uint32_t at[3];
	const scene *s = l->s;
	cell_of(l, point, at);
	struct cell *c = cell_at(l, at);
	for (int k = 0; k < 3; k++)
		c->rgb[k] += s->rgba[point][k];
	c->detail += detail_of(s, point);
	c->points++;
	if (is_edge(s, point)) {
		float d[3];
		model_unpack_normal(s->direction[point], d);
		add_way(c, d);
	}
}

static void add_cell(struct cell *to, const struct cell *c, float weight)
{
	for (int k = 0; k < 3; k++)
		to->rgb[k] += weight * c->rgb[k];
	for (int k = 0; k < 6; k++)
		to->way[k] += weight * c->way[k];
	to->edges += weight * c->edges;
	to->detail += weight * c->detail;
	to->points += weight * c->points;
}

/* Of the cells that touch it along faces, which count half, and its own. */
static struct cell around(const struct look *l, const uint32_t at[3])
{
	struct cell sum = { 0 };
	add_cell(&sum, cell_at(l, at), 1);
	for (int k = 0; k < 3; k++)
		for (int step = -1; step <= 1; step += 2) {
			uint32_t there[3] = { at[0], at[1], at[2] };
			there[k] += (uint32_t)step;
			if (there[k] < l->across[k])
				add_cell(&sum, cell_at(l, there), 0.5f);
		}
	return sum;
}

/* The direction that most of the sum has, by going through it again and again; false: there is none. */
static bool main_way(const struct cell *c, float ret[3])
{
	const float *m = c->way;
	float v[3] = { m[0] + 0.01f, m[1] + 0.007f, m[2] + 0.003f }, length = 0;
	if (!(c->edges > 0))
		return false;
	for (int n = 0; n < 8; n++) {
		float next[3] = { m[0] * v[0] + m[3] * v[1] + m[4] * v[2],
			m[3] * v[0] + m[1] * v[1] + m[5] * v[2],
			m[4] * v[0] + m[5] * v[1] + m[2] * v[2] };
		length = vector3_length(next);
		if (!(length > 1e-6f))
			return false;
		for (int k = 0; k < 3; k++)
			v[k] = next[k] / length;
	}
	memcpy(ret, v, sizeof v);
	return length > ONE_WAY * c->edges;
}

static bool is_bent(const uint8_t k[2])
{
	const float *table = scene_bend_table();
	float k1 = fabsf(table[k[0]]), k2 = fabsf(table[k[1]]);
	return k1 > BENT_LEAST && k1 > BENT_BOTH_WAYS * k2;
}

/* In the plane of a point, across the direction in which it is bent most: along cylinders and mouldings. */
static void across(const scene *s, uint32_t point, int16_t ret[2])
{
	float n[3], d[3], v[3];
	model_unpack_normal(s->normal[point], n);
	model_unpack_normal(s->direction[point], d);
	vector3_cross(n, d, v);
	if (vector3_length(v) > 1e-3f)
		model_pack_normal(v, ret);
}

/* bend: k1 and k2 of the point; NULL: not known. */
static void find_way(const struct look *l, const uint8_t bend[2], uint32_t point,
	const struct cell *near, int16_t ret[2])
{
	const scene *s = l->s;
	float way[3];
	ret[0] = MODEL_NORMAL_NONE;
	ret[1] = 0;
	if (is_edge(s, point))
		memcpy(ret, s->direction[point], sizeof *s->direction);
	else if (main_way(near, way))
		model_pack_normal(way, ret);
	else if (bend && s->kind[point] < FEATURE_UNDIRECTED &&
		 s->direction[point][0] != MODEL_NORMAL_NONE &&
		 s->normal[point][0] != MODEL_NORMAL_NONE && is_bent(bend))
		across(s, point, ret);
}

static uint32_t pack_way(const int16_t way[2])
{
	int8_t byte[2] = { SCENE_PAINT_NO_WAY, 0 };
	for (int k = 0; k < 2 && way[0] != MODEL_NORMAL_NONE; k++)
		byte[k] = (int8_t)lrintf((float)way[k] / SCENE_PAINT_WAY_FACTOR);
	return (uint32_t)(uint8_t)byte[0] << 16 | (uint32_t)(uint8_t)byte[1] << 24;
}

static uint32_t pack_rgb(const float rgb[3])
{
	static const float most[3] = { 31, 63, 31 };
	uint32_t bits[3];
	for (int k = 0; k < 3; k++)
		bits[k] = (uint32_t)(rgb[k] * most[k] / 255 + 0.5f);
	return bits[0] | bits[1] << 5 | bits[2] << 11;
}

static void look_at_point(const struct look *l, const uint8_t bend[2], uint32_t point,
	const struct cell *near, scene_paint *to)
{
	const uint8_t *rgba = l->s->rgba[point];
	float differs = 0, mean[3];
	int16_t way[2];
	for (int k = 0; k < 3; k++) {
		mean[k] = near->rgb[k] / near->points;
		differs = fmaxf(differs, fabsf((float)rgba[k] - mean[k]) / 255);
	}
	differs = (differs - COLOURS_ALIKE) / (COLOURS_DIFFER - COLOURS_ALIKE);
	float beside = DETAIL_BESIDE * fminf(DETAIL_SPREADS * near->detail / near->points, 1);
	float detail = fmaxf(detail_of(l->s, point), beside);
	to->detail[point] = (uint8_t)(255 * CLAMP(fmaxf(detail, differs), 0, 1) + 0.5f);
	find_way(l, bend, point, near, way);
	to->look[point] = pack_rgb(mean) | pack_way(way);
}

static void sum_up(const struct look *l, struct scene_paint_chunk *to)
{
	double sum[4] = { 0 };
	for (uint32_t n = 0; n < CELLS * CELLS * CELLS; n++) {
		for (int k = 0; k < 3; k++)
			sum[k] += l->cell[n].rgb[k];
		sum[3] += l->cell[n].points;
	}
	for (int k = 0; k < 3; k++)
		to->rgba[k] = (uint8_t)(sum[k] / sum[3] + 0.5);
	to->rgba[3] = 255;
	to->cell_m = l->cell_m;
	uint32_t undirected =
		l->chunk->kind_end[FEATURE_UNDIRECTED] - l->chunk->kind_end[FEATURE_UNDIRECTED - 1];
	to->is_leafy = (float)undirected > LEAFY * (float)l->chunk->count;
}

/* bend: of its points, or NULL. */
static void look_at_chunk(const scene *s, const struct scene_chunk *chunk, const uint8_t (*bend)[2],
	scene_paint *to, struct scene_paint_chunk *ret, struct cell *cell, struct cell *near)
{
	float longest = fmaxf(fmaxf(chunk->half_m[0], chunk->half_m[1]), chunk->half_m[2]);
	struct look l = { s, chunk, fmaxf(2 * longest / CELLS, 1e-3f), { 0 }, cell };
	for (int k = 0; k < 3; k++)
		l.across[k] = CLAMP((uint32_t)(2 * chunk->half_m[k] / l.cell_m) + 1, 1, CELLS);
	memset(cell, 0, CELLS * CELLS * CELLS * sizeof *cell);
	for (uint32_t i = 0; i < chunk->count; i++)
		count_point(&l, chunk->first + i);
	sum_up(&l, ret);
	uint32_t at[3];
	for (at[2] = 0; at[2] < l.across[2]; at[2]++)
		for (at[1] = 0; at[1] < l.across[1]; at[1]++)
			for (at[0] = 0; at[0] < l.across[0]; at[0]++)
				near[cell_at(&l, at) - cell] = around(&l, at);
	for (uint32_t i = 0; i < chunk->count; i++) {
		cell_of(&l, chunk->first + i, at);
		look_at_point(&l, bend ? bend[i] : NULL, chunk->first + i,
			&near[cell_at(&l, at) - cell], to);
	}
}

/* ---- leaves ---- */

struct box {
	float low[3], high[3];
};

static void widen(struct box *b, const float centre_m[3], const float half_m[3])
{
	for (int k = 0; k < 3; k++) {
		b->low[k] = fminf(b->low[k], centre_m[k] - half_m[k]);
		b->high[k] = fmaxf(b->high[k], centre_m[k] + half_m[k]);
	}
}

static void widen_leaf(
	uint32_t leaf, const float centre_m[3], const float half_m[3], gpointer user_data)
{
	widen((struct box *)user_data + leaf, centre_m, half_m);
}

/* Of all chunks of a leaf together, wherever they are. */
static void find_middles(const scene *s, float (*ret_m)[3])
{
	g_autofree struct box *box = g_new(struct box, SEGMENTS_MAX + 1);
	for (uint32_t n = 0; n <= SEGMENTS_MAX; n++)
		box[n] = (struct box){ { INFINITY, INFINITY, INFINITY },
			{ -INFINITY, -INFINITY, -INFINITY } };
	if (s->pager)
		scene_pager_boxes(s->pager, widen_leaf, box);
	else
		for (uint32_t n = 0; n < s->chunks; n++)
			widen(&box[s->chunk[n].leaf], s->chunk[n].centre_m, s->chunk[n].half_m);
	for (uint32_t n = 0; n <= SEGMENTS_MAX; n++)
		for (int k = 0; k < 3; k++)
			ret_m[n][k] = (box[n].low[k] + box[n].high[k]) / 2;
}

/* ---- all ---- */

/* Those that were not looked at yet. */
static void look_at_new(const scene *s, scene_paint *to)
{
#pragma omp parallel
	{
		g_autofree struct cell *cell = g_new(struct cell, 2 * CELLS * CELLS * CELLS);
		uint8_t room[MODEL_CHUNK_POINTS][2];
#pragma omp for schedule(dynamic, 8)
		for (uint32_t n = 0; n < s->chunks; n++) {
			const struct scene_chunk *c = &s->chunk[n];
			size_t place = (size_t)(scene_paint_chunk_of(to, s, c) - to->chunk);
			if (to->stamp && to->stamp[place] == c->stamp)
				continue;
			look_at_chunk(s, c, scene_bend_of_chunk(s, n, room), to, &to->chunk[place],
				cell, cell + CELLS * CELLS * CELLS);
			memcpy(to->chunk[place].middle_m, to->middle_m[c->leaf],
				sizeof to->middle_m[0]);
			if (to->stamp)
				to->stamp[place] = c->stamp;
		}
	}
}

static void look_at_all(const scene *s, scene_paint *to)
{
	uint32_t points = s->pager ? scene_pager_points(s->pager) : s->count,
		 chunks = s->pager ? points / SCENE_PAGER_ALIGNED : s->chunks;
	size_t count = points + 16u; /* vectors read beyond the end */
	char *at = large_new(large_part(count * sizeof *to->look) + count);
	to->look = large_take(&at, count * sizeof *to->look);
	to->detail = (uint8_t *)at;
	memset(to->look + points, 0, 16 * sizeof *to->look);
	memset(to->detail + points, 0, 16);
	to->chunk = g_new0(struct scene_paint_chunk, chunks + 1);
	to->stamp = s->pager ? g_new0(uint32_t, chunks + 1) : NULL;
	to->middle_m = g_malloc0_n(SEGMENTS_MAX + 1, sizeof *to->middle_m);
	find_middles(s, to->middle_m);
	look_at_new(s, to);
}

static void clear(scene_paint *p)
{
	large_free(p->look); /* and detail */
	g_free(p->chunk);
	g_free(p->stamp);
	g_free(p->middle_m);
	memset(p, 0, sizeof *p);
}

const scene_paint *scene_paint_hold(const scene *s)
{
	struct scene_paint_plane *p = s->paint;
	g_mutex_lock(&p->lock);
	p->holders++;
	if (!p->paint.look)
		look_at_all(s, &p->paint);
	g_mutex_unlock(&p->lock);
	return &p->paint;
}

void scene_paint_release(const scene *s)
{
	struct scene_paint_plane *p = s->paint;
	g_mutex_lock(&p->lock);
	p->holders--;
	g_mutex_unlock(&p->lock);
}

void scene_paint_forget(const scene *s)
{
	struct scene_paint_plane *p = s->paint;
	g_mutex_lock(&p->lock);
	if (!p->holders)
		clear(&p->paint);
	g_mutex_unlock(&p->lock);
}

bool scene_paint_is_there(const scene *s)
{
	struct scene_paint_plane *p = s->paint;
	g_mutex_lock(&p->lock);
	bool ret = p->paint.look;
	g_mutex_unlock(&p->lock);
	return ret;
}

void scene_paint_follow(const scene *s)
{
	struct scene_paint_plane *p = s->paint;
	if (!p)
		return;
	g_mutex_lock(&p->lock);
	if (p->paint.look)
		look_at_new(s, &p->paint);
	g_mutex_unlock(&p->lock);
}

struct scene_paint_plane *scene_paint_new(void)
{
	struct scene_paint_plane *p = g_new0(struct scene_paint_plane, 1);
	g_mutex_init(&p->lock);
	return p;
}

void scene_paint_free(struct scene_paint_plane *p)
{
	if (!p)
		return;
	clear(&p->paint);
	g_mutex_clear(&p->lock);
	g_free(p);
}
