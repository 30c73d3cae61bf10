#include "process/profile-pieces.h"
#include "process/features.h"
#include "process/line-grow.h"
#include <string.h>

/* Feature points follow each other when they are no farther apart: by themselves, and in spacings of them. */
#define GAP_M    0.12
#define TURN_COS 0.966 /* 15 degrees */
/* Edges are some points wide. */
#define WITHIN_M          0.02f
#define WITHIN_SPACINGS   1.0f
#define UNDIRECTED_SHARE  0.6f
#define UNDIRECTED_WEIGHT 0.3f
/* Shorter ones are none; so many points are the least. */
#define LENGTH_LEAST_M 0.15
#define POINTS_LEAST   4u
#define DIRECTED_SHARE 4u /* one in so many makes it directional */
#define SUPPORT_M      0.05
#define SEED_M         0.15
#define SEED_SPACINGS  6.0

int profile_piece_by_length(const void *a, const void *b)
{
	const struct profile_piece *x = a, *y = b;
	double m = profile_piece_length(x), n = profile_piece_length(y);
	return m != n ? (m > n ? -1 : 1) : memcmp(x, y, sizeof *x);
}

int profile_piece_by_worth(const void *a, const void *b)
{
	const struct profile_piece *x = a, *y = b;
	int rank[2] = { MIN(x->kind, PROFILE_MARK), MIN(y->kind, PROFILE_MARK) };
	return rank[0] != rank[1] ? rank[0] - rank[1] : profile_piece_by_length(a, b);
}

struct edge_point {
	struct line_place on;
	float spacing_m;
	uint16_t leaf;
	uint8_t degree, kind;
	bool is_seed;
};

static struct edge_point edge_point_of(const struct model_chunk *c, const struct model_point *p,
	const double origin_m[3], double unit_m, const struct profile_options *o)
{
	struct edge_point e = { .spacing_m = (float)p->spacing * 1e-4f / (float)unit_m,
		.leaf = p->leaf,
		.degree = p->feature,
		.kind = p->kind };
	bool is_directed = p->kind == FEATURE_DIRECTED,
	     is_plant = o->leaf_class && o->leaf_class[p->leaf] == CLASS_VEGETATION;
	e.is_seed = is_directed || (!is_plant && p->normal[0] != MODEL_NORMAL_NONE);
	for (int k = 0; k < 3; k++)
		e.on.at[k] = (c->centre_m[k] - origin_m[k] + (double)p->position_m[k]) / unit_m;
	e.on.within_m = fmaxf(WITHIN_M, WITHIN_SPACINGS * e.spacing_m);
	e.on.weight = 1;
	if (is_directed)
		model_unpack_normal(p->direction, e.on.along);
	else {
		e.on.within_m *= UNDIRECTED_SHARE;
		e.on.weight = UNDIRECTED_WEIGHT;
	}
	return e;
}

static GArray *gather(const model *m, const double origin_m[3], double unit_m,
	const struct profile_options *options)
{
	GArray *all = g_array_new(FALSE, FALSE, sizeof(struct edge_point));
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	for (uint64_t n = 0; n < chunks; n++) {
		const struct model_point *p = model_points(m) + chunk[n].first;
		for (uint32_t i = 0; i < chunk[n].points; i++) {
			if (p[i].kind < FEATURE_UNDIRECTED || (p[i].flags & FEATURE_BEHIND))
				continue;
			struct edge_point e =
				edge_point_of(&chunk[n], &p[i], origin_m, unit_m, options);
			g_array_append_val(all, e);
		}
		product_forget(model_file(m), p, chunk[n].points * sizeof *p);
	}
	return all;
}

static const struct edge_point *edge_point_at(const GArray *all, uint32_t i)
{
	return &g_array_index(all, struct edge_point, i);
}

/* ---- seeds ---- */

/* Directional ones first, of each those of the highest degree. */
static uint32_t *seeds_of(const GArray *all, uint32_t *ret_count)
{
	uint32_t first[2 * 256 + 1] = { 0 };
	for (int pass = 0; pass < 2; pass++) {
		uint32_t *seeds = pass ? g_new(uint32_t, first[2 * 256 - 1] + 1) : NULL;
		for (guint i = 0; i < all->len; i++) {
			const struct edge_point *e = edge_point_at(all, i);
			uint32_t place = (e->kind == FEATURE_DIRECTED ? 0 : 256) + 255u - e->degree;
			if (e->is_seed && pass)
				seeds[first[place]++] = i;
			else if (e->is_seed)
				first[place + 1]++;
		}
		if (pass) {
			*ret_count = first[2 * 256 - 1];
			return seeds;
		}
		for (int d = 1; d <= 2 * 256; d++)
			first[d] += first[d - 1];
	}
	g_assert_not_reached();
}

/* ---- pieces ---- */

/* Most of them, by votes that cancel each other out (Boyer & Moore 1991). */
static uint16_t common_leaf(const GArray *all, const GArray *found)
{
	uint16_t leaf = 0;
	int votes = 0;
	for (guint n = 0; n < found->len; n++) {
		uint16_t other = edge_point_at(all, g_array_index(found, uint32_t, n))->leaf;
		if (votes == 0)
			leaf = other;
		votes += other == leaf ? 1 : -1;
	}
	return leaf;
}

static float support_of(const GArray *all, const struct line_run *r)
{
	uint32_t bins = (uint32_t)ceil((r->to_m - r->from_m) / SUPPORT_M) + 1, some = 0;
	g_autofree uint8_t *bin = g_malloc0(bins);
	for (guint n = 0; n < r->found->len; n++) {
		const struct edge_point *e =
			edge_point_at(all, g_array_index(r->found, uint32_t, n));
		double reach = (double)fminf(e->spacing_m, 0.1f),
		       at = straight_along(&r->line, e->on.at);
		int from = (int)((at - reach - r->from_m) / SUPPORT_M),
		    to = (int)((at + reach - r->from_m) / SUPPORT_M);
		for (int b = MAX(from, 0); b <= MIN(to, (int)bins - 1); b++)
			bin[b] = 1;
	}
	for (uint32_t b = 0; b < bins; b++)
		some += bin[b];
	return (float)some / (float)bins;
}

static bool piece_of(const GArray *all, const struct line_run *r, struct profile_piece *ret)
{
	double spacing = 0, degree = 0;
	uint32_t directed = 0;
	for (guint n = 0; n < r->found->len; n++) {
		const struct edge_point *e =
			edge_point_at(all, g_array_index(r->found, uint32_t, n));
		spacing += (double)e->spacing_m;
		degree += e->degree;
		directed += e->kind == FEATURE_DIRECTED;
	}
	if (r->found->len < POINTS_LEAST || r->to_m - r->from_m < LENGTH_LEAST_M)
		return false;
	*ret = (struct profile_piece){ .line = r->line,
		.from_m = r->from_m,
		.to_m = r->to_m,
		.spacing_m = (float)(spacing / r->found->len),
		.degree = (float)(degree / r->found->len / 255),
		.support = support_of(all, r),
		.is_directed =
			directed >= POINTS_LEAST && DIRECTED_SHARE * directed >= r->found->len,
		.leaf = common_leaf(all, r->found) };
	return true;
}

/* Around a seed of no direction: wide enough for some points in a row. */
static double seed_m(const GArray *all, uint32_t seed)
{
	return fmax(SEED_M, SEED_SPACINGS * (double)edge_point_at(all, seed)->spacing_m);
}

GArray *profile_pieces_grow(const model *m, const double origin_m[3], double unit_m,
	const struct profile_options *options)
{
	g_autoptr(GArray) all = gather(m, origin_m, unit_m, options);
	uint32_t count;
	g_autofree uint32_t *seed = seeds_of(all, &count);
	g_autoptr(line_grower) g =
		line_grower_new(all->data, all->len, sizeof(struct edge_point), GAP_M, TURN_COS);
	g_autoptr(GArray) pieces = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
	for (uint32_t n = 0; n < count; n++) {
		struct line_run run;
		struct profile_piece piece;
		if (edge_point_at(all, seed[n])->on.is_used ||
			!line_grower_grow(g, seed[n], seed_m(all, seed[n]), &run) ||
			!piece_of(all, &run, &piece))
			continue;
		g_array_append_val(pieces, piece);
		if (n % 4096 == 0 && options->progress &&
			!options->progress(PROFILE_GROWN_PART * n / count, options->user_data))
			return NULL;
	}
	return g_steal_pointer(&pieces);
}
