#include "process/features-ridges.h"
#include <string.h>

/* Windows of more cells each way are looked at by every second, of twice as many by every fourth. */
#define WINDOW_EVERY 12
#define WINDOW_MOST  40
#define WINDOW_LEAST 2
#define TILE_CELLS   8
/* Scans that see the place with so much wider beams do not tell more of it. */
#define TRUST_LEAST 0.2f
/* What is not moved to a cut counts less among what is. */
#define UNMOVED_WEIGHT 0.25f

_Static_assert(WINDOW_MOST < WINDOW_EVERY << (RIDGE_LEVELS - 1), "the last level is wide enough");

/* Edges are some cells wide; where they are highest, they are. */
static bool is_highest(const range_grid *g, const uint8_t *degree, uint32_t row, uint32_t column)
{
	static const int8_t way[2][2] = { { 0, 1 }, { 1, 0 } };
	size_t i = (size_t)row * g->columns + column, a = i, b = i;
	for (int w = 0; w < 2; w++) {
		bool is_a = range_grid_step(g, row, column, way[w][0], way[w][1], &a);
		bool is_b = range_grid_step(g, row, column, -way[w][0], -way[w][1], &b);
		if ((!is_a || degree[a] < degree[i]) && (!is_b || degree[b] <= degree[i]))
			return true;
	}
	return false;
}

static struct ridge_point point_of(
	const struct features_input *of, const features *f, size_t i, const struct feature_cut *cut)
{
	const range_grid *g = of->grid;
	float degree = f->degree[i] * (1 / 255.f);
	struct ridge_point ret = { .x = g->x_m[i],
		.y = g->y_m[i],
		.z = g->z_m[i],
		.weight = degree * degree,
		.leaf = of->leaf ? of->leaf[i] : 0 };
	if (cut) {
		ret.x = cut->at_m[0];
		ret.y = cut->at_m[1];
		ret.z = cut->at_m[2];
		memcpy(ret.cut, cut->direction, sizeof ret.cut);
	}
	return ret;
}

/* The cut of a cell, if it has one; *at goes on with the cells. */
static const struct feature_cut *next_cut(const GArray *cuts, guint *at, size_t i)
{
	while (cuts && *at < cuts->len && g_array_index(cuts, struct feature_cut, *at).cell < i)
		++*at;
	const struct feature_cut *ret =
		cuts && *at < cuts->len ? &g_array_index(cuts, struct feature_cut, *at) : NULL;
	return ret && ret->cell == i ? ret : NULL;
}

static void list_points(features_ridges *r, const struct features_input *of, const features *f)
{
	const size_t words = (size_t)r->words * r->grid->rows;
	uint32_t count = 0;
	guint at_cut = 0;
	r->place = g_new(uint32_t, words + 1);
	for (size_t w = 0; w < words; w++) {
		r->place[w] = count;
		count += (uint32_t)__builtin_popcountll(r->bits[w]);
	}
	r->place[words] = count;
	r->point = g_new(struct ridge_point, count + 1);
	for (size_t w = 0; w < words; w++) {
		struct ridge_point *to = r->point + r->place[w];
		for (uint64_t bits = r->bits[w]; bits; bits &= bits - 1) {
			size_t i = w / r->words * r->grid->columns + w % r->words * 64 +
				   (size_t)__builtin_ctzll(bits);
			*to++ = point_of(of, f, i, next_cut(f->cuts, &at_cut, i));
		}
	}
}

/* ---- tiles ---- */

/* Of the cells of a word those on every diagonal, on every second, on every fourth. */
static uint64_t on_diagonals(uint64_t bits, uint32_t row, int level)
{
	static const uint64_t every[RIDGE_LEVELS] = { ~(uint64_t)0, 0x5555555555555555,
		0x1111111111111111 };
	return bits & every[level] << (-row & ((1u << level) - 1));
}

/* Calls are in the order of the cells. next: of each tile, goes on. */
static void lay_row(
	const features_ridges *r, struct ridge_tiles *t, uint32_t row, int level, uint32_t *next)
{
	for (uint32_t word = 0; word < r->words; word++) {
		const size_t at = (size_t)row * r->words + word;
		const uint64_t all = r->bits[at];
		for (uint64_t bits = on_diagonals(all, row, level); bits; bits &= bits - 1) {
			const uint32_t bit = (uint32_t)__builtin_ctzll(bits);
			const size_t tile =
				(size_t)(row / t->size) * t->across + (word * 64 + bit) / t->size;
			const struct ridge_point *p =
				r->point + r->place[at] +
				__builtin_popcountll(all & (((uint64_t)1 << bit) - 1));
			const uint32_t to = next[tile]++;
			if (!t->point)
				continue;
			t->x[to] = p->x;
			t->y[to] = p->y;
			t->z[to] = p->z;
			t->point[to] = *p;
		}
	}
}

static void lay_tiles(const features_ridges *r, int level, struct ridge_tiles *t)
{
	const range_grid *g = r->grid;
	*t = (struct ridge_tiles){ .size = TILE_CELLS * MAX(1u << level >> 1, 1) };
	t->across = (g->columns + t->size - 1) / t->size;
	const size_t tiles = (size_t)t->across * ((g->rows + t->size - 1) / t->size);
	t->first = g_new0(uint32_t, tiles + 2);
	/* Counted first; then the places before the first of each tile become those after its last. */
	for (uint32_t row = 0; row < g->rows; row++)
		lay_row(r, t, row, level, t->first + 2);
	for (size_t k = 2; k < tiles + 2; k++)
		t->first[k] += t->first[k - 1];
	const size_t count = t->first[tiles + 1];
	t->x = g_new(float, count + 1);
	t->y = g_new(float, count + 1);
	t->z = g_new(float, count + 1);
	t->point = g_new(struct ridge_point, count + 1);
	for (uint32_t row = 0; row < g->rows; row++)
		lay_row(r, t, row, level, t->first + 1);
}

void features_ridges_free(features_ridges *r)
{
	if (!r)
		return;
	for (int level = 0; level < RIDGE_LEVELS; level++) {
		g_free(r->tiles[level].first);
		g_free(r->tiles[level].x);
		g_free(r->tiles[level].y);
		g_free(r->tiles[level].z);
		g_free(r->tiles[level].point);
	}
	g_free(r->bits);
	g_free(r->place);
	g_free(r->point);
	g_free(r);
}

features_ridges *features_ridges_new(
	const struct features_input *of, const features *f, const struct features_options *options)
{
	const struct features_options o = features_defaults(options);
	const range_grid *g = of->grid;
	const uint8_t least = feature_least(&o);
	features_ridges *r = g_new0(features_ridges, 1);
	r->grid = g;
	r->words = g->columns / 64 + 1;
	r->bits = g_new0(uint64_t, (size_t)r->words * g->rows + 1);
#pragma omp parallel for schedule(static) if (!o.single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			if (f->degree[i] > least && g->range_m[i] > 0 &&
				is_highest(g, f->degree, row, column))
				r->bits[(size_t)row * r->words + column / 64] |= (uint64_t)1
										 << column % 64;
		}
	list_points(r, of, f);
#pragma omp parallel for schedule(dynamic) if (!o.single_thread)
	for (int level = 0; level < RIDGE_LEVELS; level++)
		lay_tiles(r, level, &r->tiles[level]);
	return r;
}

uint32_t ridges_count(const features_ridges *r, uint32_t row, uint32_t column)
{
	const uint32_t from = column < RIDGES_NEAR ? 0 : column - RIDGES_NEAR,
		       top = row < RIDGES_NEAR ? 0 : row - RIDGES_NEAR,
		       bottom = MIN(row + RIDGES_NEAR, r->grid->rows - 1), word = from / 64,
		       shift = from % 64;
	const uint64_t mask = ((uint64_t)1 << (2 * RIDGES_NEAR + 1)) - 1;
	uint32_t ret = 0;
	for (uint32_t y = top; y <= bottom; y++) {
		const uint64_t *bits = r->bits + (size_t)y * r->words + word;
		uint64_t run = bits[0] >> shift;
		if (shift && word + 1 < r->words)
			run |= bits[1] << (64 - shift);
		ret += (uint32_t)__builtin_popcountll(run & mask);
	}
	return ret;
}

/* What is looked around in, and how much it counts; tiles: of many cells every second is enough, or every fourth. */
struct search {
	const struct ridges_window *window;
	const struct ridge_tiles *tiles;
	float trust;
};

/* near: 1 at the place itself, 0 at the radius. */
static void add_point(
	const struct search *s, const struct ridge_point *p, float near, struct feature_around *a)
{
	const struct ridges_window *w = s->window;
	const float weight =
		s->trust * near * p->weight * (w->is_cut && !ridge_has_cut(p) ? UNMOVED_WEIGHT : 1);
	const float off[3] = { p->x - (float)w->at[0], p->y - (float)w->at[1],
		p->z - (float)w->at[2] };
	feature_keep_point(a, off, p->cut, weight, w->frame);
}

#define AT_ONCE 64
/* So many points side by side: most are too far away. */
static void add_points(
	const struct search *s, uint32_t from, uint32_t count, struct feature_around *a)
{
	const struct ridges_window *w = s->window;
	const struct ridge_tiles *t = s->tiles;
	const float *x = t->x + from, *y = t->y + from, *z = t->z + from;
	const float here[3] = { (float)w->at[0], (float)w->at[1], (float)w->at[2] },
		    per = 1 / (w->radius_m * w->radius_m);
	float near[AT_ONCE];
#pragma omp simd
	for (uint32_t n = 0; n < count; n++) {
		float dx = x[n] - here[0], dy = y[n] - here[1], dz = z[n] - here[2];
		near[n] = 1 - (dx * dx + dy * dy + dz * dz) * per;
	}
	for (uint32_t n = 0; n < count; n++) {
		const struct ridge_point *p = t->point + from + n;
		if (near[n] > 0 && (p->leaf == 0 || w->leaf == 0 || p->leaf == w->leaf))
			add_point(s, p, near[n], a);
	}
}

/* Tiles that hold columns from..to, both included, of a row of tiles. */
static void add_run(
	const struct search *s, uint32_t row, int32_t from, int32_t to, struct feature_around *a)
{
	const struct ridge_tiles *t = s->tiles;
	const size_t at = (size_t)row * t->across;
	const uint32_t end = t->first[at + (uint32_t)to / t->size + 1];
	for (uint32_t n = t->first[at + (uint32_t)from / t->size]; n < end; n += AT_ONCE)
		add_points(s, n, MIN(end - n, AT_ONCE), a);
}

void ridges_look_around(const struct ridges_window *w, uint32_t cell, struct feature_around *a)
{
	const range_grid *g = w->ridges->grid;
	const double *at = w->at;
	const float range_m = (float)sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
	const float level = fmaxf((float)(hypot(at[0], at[1]) / range_m), 0.1f);
	const float row_m = range_m * (float)g->row_rad,
		    column_m = range_m * level * (float)g->column_rad;
	const int32_t width = (int32_t)g->columns, row = (int32_t)cell / width,
		      column = (int32_t)cell % width;
	const int32_t down = CLAMP((int)ceilf(w->radius_m / row_m), WINDOW_LEAST, WINDOW_MOST);
	const int32_t right =
		MIN(CLAMP((int)ceilf(w->radius_m / column_m), WINDOW_LEAST, WINDOW_MOST),
			(width - 1) / 2);
	struct search s = { w, w->ridges->tiles,
		fminf(1, w->spacing_m * w->spacing_m / (row_m * row_m)) };
	if (s.trust < TRUST_LEAST)
		return;
	for (int32_t most = WINDOW_EVERY; MAX(down, right) >= most; most *= 2)
		s.tiles++;
	const int32_t size = (int32_t)s.tiles->size, low = MAX(row - down, 0),
		      high = MIN(row + down, (int32_t)g->rows - 1);
	const int32_t left = MAX(column - right, 0), end = MIN(column + right, width - 1);
	/* Those that begin beyond the seam; tiles there are not to be looked at twice. */
	const int32_t beyond = column - right + width, after = column + right - width;
	for (int32_t r = low / size; r <= high / size; r++) {
		add_run(&s, (uint32_t)r, left, end, a);
		if (g->wraps && column < right && beyond / size > end / size)
			add_run(&s, (uint32_t)r, beyond, width - 1, a);
		if (g->wraps && after >= 0 && after / size < left / size)
			add_run(&s, (uint32_t)r, 0, after, a);
	}
}
