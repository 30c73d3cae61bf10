#include "process/features-ridges.h"

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
static bool is_highest(const struct features_view *v, uint32_t row, uint32_t column)
{
	static const int8_t way[2][2] = { { 0, 1 }, { 1, 0 } };
	const range_grid *g = v->scan.grid;
	size_t i = (size_t)row * g->columns + column, a = i, b = i;
	for (int w = 0; w < 2; w++) {
		bool is_a = range_grid_step(g, row, column, way[w][0], way[w][1], &a);
		bool is_b = range_grid_step(g, row, column, -way[w][0], -way[w][1], &b);
		if ((!is_a || v->degree[a] < v->degree[i]) &&
			(!is_b || v->degree[b] <= v->degree[i]))
			return true;
	}
	return false;
}

static struct ridge_point point_of(const struct features_view *v, size_t i,
	const struct feature_cut *cut, const struct pose *to_scan)
{
	const range_grid *g = v->scan.grid;
	double at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
	float degree = v->degree[i] * (1 / 255.f);
	struct ridge_point ret = { .weight = degree * degree, .cell = (uint32_t)i };
	for (int k = 0; cut && k < 3; k++) {
		at[k] = cut->at_m[k];
		ret.cut[k] = cut->direction[k];
		if (to_scan)
			ret.cut[k] = (float)(to_scan->rotation[k][0] * (double)cut->direction[0] +
					     to_scan->rotation[k][1] * (double)cut->direction[1] +
					     to_scan->rotation[k][2] * (double)cut->direction[2]);
	}
	if (to_scan)
		pose_apply(to_scan, at, at);
	ret.x = (float)at[0];
	ret.y = (float)at[1];
	ret.z = (float)at[2];
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

static void list_points(struct ridges *r, const struct features_view *v, const struct pose *to_scan)
{
	const range_grid *g = v->scan.grid;
	const size_t words = (size_t)r->words * g->rows;
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
			size_t i = w / r->words * g->columns + w % r->words * 64 +
				   (size_t)__builtin_ctzll(bits);
			*to++ = point_of(v, i, next_cut(v->cuts, &at_cut, i), to_scan);
		}
	}
}

void ridges_clear(struct ridges *r)
{
	for (int level = 0; level < RIDGE_LEVELS; level++) {
		g_free(r->tiles[level].first);
		g_free(r->tiles[level].point);
	}
	g_free(r->bits);
	g_free(r->place);
	g_free(r->point);
}

/* The tile of a cell; false: it is not on one of the diagonals. */
static bool find_tile(const struct ridge_tiles *t, const range_grid *g, uint32_t cell,
	uint32_t stride, size_t *ret)
{
	const uint32_t row = cell / g->columns, column = cell % g->columns;
	*ret = (size_t)(row / t->size) * t->across + column / t->size;
	return ((row + column) & (stride - 1)) == 0;
}

static struct ridge_tiles lay_tiles(const struct ridges *r, const range_grid *g, uint32_t stride)
{
	const uint32_t count = r->place[(size_t)r->words * g->rows];
	struct ridge_tiles ret = { .size = TILE_CELLS * MAX(stride / 2, 1) };
	ret.across = (g->columns + ret.size - 1) / ret.size;
	const size_t tiles = (size_t)ret.across * ((g->rows + ret.size - 1) / ret.size);
	size_t tile;
	ret.first = g_new0(uint32_t, tiles + 2);
	for (uint32_t n = 0; n < count; n++)
		if (find_tile(&ret, g, r->point[n].cell, stride, &tile))
			ret.first[tile + 2]++;
	for (size_t k = 2; k < tiles + 2; k++)
		ret.first[k] += ret.first[k - 1];
	ret.point = g_new(struct ridge_point, ret.first[tiles + 1] + 1);
	for (uint32_t n = 0; n < count; n++)
		if (find_tile(&ret, g, r->point[n].cell, stride, &tile))
			ret.point[ret.first[tile + 1]++] = r->point[n];
	return ret;
}

struct ridges ridges_find(const struct features_view *v, const struct pose *to_scan, uint8_t least,
	bool single_thread)
{
	const range_grid *g = v->scan.grid;
	struct ridges ret = { .words = g->columns / 64 + 1 };
	ret.bits = g_new0(uint64_t, (size_t)ret.words * g->rows + 1);
#pragma omp parallel for schedule(static) if (!single_thread)
	for (uint32_t row = 0; row < g->rows; row++)
		for (uint32_t column = 0; column < g->columns; column++) {
			size_t i = (size_t)row * g->columns + column;
			if (v->degree[i] > least && g->range_m[i] > 0 && is_highest(v, row, column))
				ret.bits[(size_t)row * ret.words + column / 64] |= (uint64_t)1
										   << column % 64;
		}
	list_points(&ret, v, to_scan);
	for (int level = 0; level < RIDGE_LEVELS; level++)
		ret.tiles[level] = lay_tiles(&ret, g, 1u << level);
	return ret;
}

uint32_t ridges_count(const struct ridges *r, uint32_t rows, uint32_t row, uint32_t column)
{
	const uint32_t from = column < RIDGES_NEAR ? 0 : column - RIDGES_NEAR,
		       top = row < RIDGES_NEAR ? 0 : row - RIDGES_NEAR,
		       bottom = MIN(row + RIDGES_NEAR, rows - 1), word = from / 64,
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

/* Where one view is looked around in, and how much it counts; tiles: of many cells every second is enough, or every fourth. */
struct search {
	const struct ridges_window *window;
	const struct ridge_tiles *tiles;
	float trust;
};

static void add_point(const struct search *s, const struct ridge_point *p, struct feature_around *a)
{
	const struct ridges_window *w = s->window;
	float off[3] = { p->x - w->here[0], p->y - w->here[1], p->z - w->here[2] };
	float near = 1 - (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) /
				 (w->radius_m * w->radius_m);
	if (near > 0)
		feature_keep_point(a, off, p->cut,
			s->trust * near * p->weight *
				(w->is_cut && !ridge_has_cut(p) ? UNMOVED_WEIGHT : 1));
}

static bool is_of_leaf(const struct ridges_window *w, uint32_t cell)
{
	const uint16_t *leaf = w->view->scan.leaf;
	uint16_t there = leaf && w->leaf ? leaf[cell] : 0;
	return there == 0 || there == w->leaf;
}

/* Tiles that hold columns from..to, both included, of a row of tiles. */
static void add_run(
	const struct search *s, uint32_t row, int32_t from, int32_t to, struct feature_around *a)
{
	const struct ridge_tiles *t = s->tiles;
	const size_t at = (size_t)row * t->across;
	const uint32_t end = t->first[at + (uint32_t)to / t->size + 1];
	for (uint32_t n = t->first[at + (uint32_t)from / t->size]; n < end; n++)
		if (is_of_leaf(s->window, t->point[n].cell))
			add_point(s, &t->point[n], a);
}

void ridges_look_around(
	const struct ridges_window *w, uint32_t cell, const double at[3], struct feature_around *a)
{
	const range_grid *g = w->view->scan.grid;
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
