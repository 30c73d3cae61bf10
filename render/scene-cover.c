#include "render/scene-cover.h"
#include <math.h>
#include <string.h>

/* A chunk's box is looked at in so many pixels along its longest side, and in blocks of them. */
#define SIDE   128
#define BLOCK  16
#define BLOCKS (SIDE / BLOCK)
#define SIDES  6
#define WORD   64
#define WORDS  (SIDE / WORD)
/* As masks draw them unless a style says otherwise (step.h). */
#define DISC 1.5f
/* So much more of what is claimed they cover at the ends of surface, and so much less by chance. With these, strokes are as dense as wanted
 * wherever there are enough points (bench coherence, an even layer of courtyard, bridge and pump: 0.92 to 1.04). */
#define WIDER  0.2f
#define CLOSER 1.05f
/* Where scans overlap it is less than is claimed, but so it is where leaves hang before each other. */
#define AREA_LEAST 0.75f

/* Fewer points that face one way are no surface. */
#define POINTS_LEAST 16u

/* A point that faces one of the six ways along the axes, more than the others. */
struct claim {
	uint32_t point;
	float facing; /* cosine */
	float x_px, y_px;
};

struct scene_cover {
	struct claim *of_side[SIDES];
	uint32_t points[SIDES], room;
	/* Of one side. */
	uint64_t covered[SIDE][WORDS]; /* bits */
	float claimed[BLOCKS][BLOCKS]; /* pixels, by where the points are */
	float shown[BLOCKS][BLOCKS];   /* pixels that are covered */
};

scene_cover *scene_cover_new(void)
{
	return g_new0(scene_cover, 1);
}

void scene_cover_free(scene_cover *w)
{
	if (!w)
		return;
	for (int n = 0; n < SIDES; n++)
		g_free(w->of_side[n]);
	g_free(w);
}

/* ---- who faces where ---- */

static int side_of(const float n[3])
{
	int along = 0;
	for (int k = 1; k < 3; k++)
		if (fabsf(n[k]) > fabsf(n[along]))
			along = k;
	return 2 * along + (n[along] < 0);
}

static void sort_points(scene_cover *w, const scene *s, const struct scene_chunk *c)
{
	if (c->count > w->room) {
		w->room = c->count;
		for (int n = 0; n < SIDES; n++)
			w->of_side[n] = g_renew(struct claim, w->of_side[n], w->room);
	}
	memset(w->points, 0, sizeof w->points);
	for (uint32_t i = c->first; i < c->first + c->count; i++) {
		float n[3];
		if (s->normal[i][0] == MODEL_NORMAL_NONE)
			continue;
		model_unpack_normal(s->normal[i], n);
		int side = side_of(n);
		w->of_side[side][w->points[side]++] = (struct claim){ i, fabsf(n[side / 2]), 0, 0 };
	}
}

/* ---- one side ---- */

static float px_per_m(const struct scene_chunk *c, int side)
{
	float wide_m = 2 * fmaxf(c->half_m[(side / 2 + 1) % 3], c->half_m[(side / 2 + 2) % 3]);
	return wide_m > 0 ? SIDE / wide_m : 0;
}

/* Of a number from -1 on. */
static inline int floor_of(float x)
{
	int whole = (int)x;
	return whole - (x < (float)whole);
}

static inline int ceil_of(float x)
{
	int whole = (int)x;
	return whole + (x > (float)whole);
}

/* From left to right, both with. */
static inline void cover_row(uint64_t row[WORDS], int left, int right)
{
	for (int word = left / WORD; word <= right / WORD; word++) {
		int from = MAX(left - word * WORD, 0), to = MIN(right - word * WORD, WORD - 1);
		row[word] |= UINT64_MAX >> (WORD - 1 - to + from) << from;
	}
}

/* Aslant it is an ellipse; a circle of the same area does. */
static void cover_disc(scene_cover *w, const struct claim *at, float radius_px)
{
	float radius = radius_px * sqrtf(at->facing);
	int from = ceil_of(MAX(at->y_px - radius - 0.5f, 0)),
	    end = floor_of(MIN(at->y_px + radius - 0.5f, SIDE - 1));
	for (int y = from; y <= end; y++) {
		float down = (float)y + 0.5f - at->y_px;
		float half = sqrtf(MAX(radius * radius - down * down, 0));
		int left = ceil_of(MAX(at->x_px - half - 0.5f, 0)),
		    right = floor_of(MIN(at->x_px + half - 0.5f, SIDE - 1));
		if (left <= right)
			cover_row(w->covered[y], left, right);
	}
}

/* Without an instruction for it, which not all have. */
static inline uint32_t ones_of(uint16_t bits)
{
	uint32_t n = bits - (bits >> 1 & 0x5555u);
	n = (n & 0x3333) + (n >> 2 & 0x3333);
	n = (n + (n >> 4)) & 0x0F0F;
	return (n + (n >> 8)) & 0x1F;
}

static void draw_side(scene_cover *w, const scene *s, const struct scene_chunk *c, int side)
{
	const int across = (side / 2 + 1) % 3, down = (side / 2 + 2) % 3;
	const float scale = px_per_m(c, side);
	memset(w->covered, 0, sizeof w->covered);
	memset(w->claimed, 0, sizeof w->claimed);
	memset(w->shown, 0, sizeof w->shown);
	for (uint32_t n = 0; n < w->points[side]; n++) {
		struct claim *at = &w->of_side[side][n];
		float edge_px = s->place[at->point].spacing * s->unit_m * scale;
		float x_px = (float)s->place[at->point].q[across] * c->step_m[across] * scale,
		      y_px = (float)s->place[at->point].q[down] * c->step_m[down] * scale;
		at->x_px = MIN(x_px, SIDE - 1);
		at->y_px = MIN(y_px, SIDE - 1);
		w->claimed[(int)at->y_px / BLOCK][(int)at->x_px / BLOCK] +=
			edge_px * edge_px * at->facing;
		cover_disc(w, at, s->disc[at->point] * (s->unit_m * DISC / 2) * scale);
	}
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x += BLOCK)
			w->shown[y / BLOCK][x / BLOCK] +=
				(float)ones_of((uint16_t)(w->covered[y][x / WORD] >> x % WORD));
}

/* Of the blocks around. */
static float area_at(const scene_cover *w, int x, int y)
{
	float shown = 0, claimed = 0;
	for (int v = MAX(y - 1, 0); v <= MIN(y + 1, BLOCKS - 1); v++)
		for (int u = MAX(x - 1, 0); u <= MIN(x + 1, BLOCKS - 1); u++) {
			shown += w->shown[v][u];
			claimed += w->claimed[v][u];
		}
	float area = shown / MAX(claimed, 1e-6f);
	return area > 1 ? MAX(area - WIDER, 1) : CLAMP(area * CLOSER, AREA_LEAST, 1);
}

static void widen_side(scene_cover *w, scene *s, int side)
{
	float longer[BLOCKS][BLOCKS];
	for (int y = 0; y < BLOCKS; y++)
		for (int x = 0; x < BLOCKS; x++)
			longer[y][x] = sqrtf(area_at(w, x, y));
	for (uint32_t n = 0; n < w->points[side]; n++) {
		const struct claim *at = &w->of_side[side][n];
		float wide = s->place[at->point].spacing *
			     longer[(int)at->y_px / BLOCK][(int)at->x_px / BLOCK];
		if (s->kind[at->point] < FEATURE_UNDIRECTED) /* edges and leaves are no surface */
			s->place[at->point].spacing =
				(uint16_t)MAX(MIN(wide + 0.5f, s->disc[at->point]), 1);
	}
}

void scene_cover_chunk(scene_cover *w, scene *s, const struct scene_chunk *c)
{
	sort_points(w, s, c);
	for (int side = 0; side < SIDES; side++)
		if (w->points[side] >= POINTS_LEAST && px_per_m(c, side) > 0) {
			draw_side(w, s, c, side);
			widen_side(w, s, side);
		}
}
