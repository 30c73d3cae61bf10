#include "process/profile-lines.h"
#include "process/profile-chain.h"
#include "process/profile-cross.h"
#include "process/profile-join.h"
#include "process/profile-rim.h"
#include <math.h>
#include <string.h>

#define LENGTH_LEAST_M 0.2f
/* Pieces that are looked at side by side. */
#define BATCH 32u
/* What grew becomes edges, and those that are so much longer than what they were found by are found again by all of their length. */
#define PASSES 4
#define LONGER 1.3

profile_lines *profile_lines_new(void)
{
	profile_lines *p = g_new0(profile_lines, 1);
	p->line = g_array_new(FALSE, TRUE, sizeof(struct profile_line));
	p->vertex = g_array_new(FALSE, TRUE, sizeof(struct profile_vertex));
	return p;
}

void profile_lines_free(profile_lines *p)
{
	if (!p)
		return;
	g_array_unref(p->line);
	g_array_unref(p->vertex);
	g_free(p);
}

/* The middle of all chunks. */
static void find_origin(const model *m, double ret_m[3])
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	for (int k = 0; k < 3; k++) {
		double low = INFINITY, high = -INFINITY;
		for (uint64_t n = 0; n < chunks; n++) {
			low = fmin(low, chunk[n].centre_m[k]);
			high = fmax(high, chunk[n].centre_m[k]);
		}
		ret_m[k] = chunks ? (low + high) / 2 : 0;
	}
}

static int by_length(const void *a, const void *b)
{
	const struct profile_piece *x = a, *y = b;
	double m = profile_piece_length(x), n = profile_piece_length(y);
	return m != n ? (m > n ? -1 : 1) : memcmp(x, y, sizeof *x);
}

/* Creases, then ends, before what else there is: where faces meet is known the best. */
static int by_worth(const void *a, const void *b)
{
	const struct profile_piece *x = a, *y = b;
	int rank[2] = { MIN(x->kind, PROFILE_MARK), MIN(y->kind, PROFILE_MARK) };
	return rank[0] != rank[1] ? rank[0] - rank[1] : by_length(a, b);
}

static bool is_known(const struct profile_piece *p, const void *joiner)
{
	return profile_joiner_explains(joiner, p, true);
}

/* The longest first, some at a time: what these show explains many of those that come later. false: progress stopped it. */
static bool settle(const profile_around *around, GArray *pieces, bool is_again,
	profile_joiner *joiner, const struct profile_options *options)
{
	g_array_sort(pieces, is_again ? by_worth : by_length);
	for (guint n = 0; n < pieces->len; n += BATCH) {
		GArray *found[BATCH];
		guint count = MIN(BATCH, pieces->len - n);
#pragma omp parallel for schedule(dynamic) if (!options->single_thread)
		for (guint k = 0; k < count; k++) {
			const struct profile_piece *p =
				&g_array_index(pieces, struct profile_piece, n + k);
			found[k] = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
			if (is_again &&
				(p->kind > PROFILE_END ||
					profile_piece_length(p) < LONGER * (double)p->seen_m))
				g_array_append_val(found[k], *p);
			else if (!profile_joiner_explains(joiner, p, is_again))
				profile_piece_settle(around, p, is_known, joiner, found[k]);
		}
		g_autoptr(GArray) edges = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
		for (guint k = 0; k < count; k++) {
			g_array_append_vals(edges, found[k]->data, found[k]->len);
			g_array_unref(found[k]);
		}
		g_array_sort(edges, by_worth);
		for (guint k = 0; k < edges->len; k++)
			profile_joiner_add(joiner, &g_array_index(edges, struct profile_piece, k));
		if (options->progress &&
			!options->progress(0.4 + 0.55 * n / pieces->len, options->user_data))
			return false;
	}
	return true;
}

/* Lengths as those of points are from here on, in units. */
static struct profile_options defaults(const struct profile_options *options, double unit_m)
{
	struct profile_options o = options ? *options : (struct profile_options){ 0 };
	o.length_least_m /= (float)unit_m;
	if (!(o.length_least_m > 0))
		o.length_least_m = LENGTH_LEAST_M;
	return o;
}

static void to_metres(profile_lines *p, double unit_m)
{
	for (guint n = 0; n < p->line->len; n++)
		g_array_index(p->line, struct profile_line, n).length_m *= (float)unit_m;
	for (guint n = 0; n < p->vertex->len; n++)
		for (int k = 0; k < 3; k++)
			g_array_index(p->vertex, struct profile_vertex, n).at_m[k] *= (float)unit_m;
}

/* Ends of faces, by the beams along all of their length; what lies on one line now is one. */
static profile_joiner *fit_rims(
	const profile_around *around, GArray *pieces, const struct profile_options *options)
{
	profile_joiner *joiner = profile_joiner_new(options);
#pragma omp parallel for schedule(dynamic) if (!options->single_thread)
	for (guint n = 0; n < pieces->len; n++)
		profile_rim_fit(around, &g_array_index(pieces, struct profile_piece, n));
	g_array_sort(pieces, by_worth);
	for (guint n = 0; n < pieces->len; n++)
		profile_joiner_add(joiner, &g_array_index(pieces, struct profile_piece, n));
	return joiner;
}

profile_lines *profile_lines_find(const model *m, const struct profile_options *options)
{
	const double unit_m = profile_unit_m(m);
	const struct profile_options o = defaults(options, unit_m);
	double origin_m[3];
	find_origin(m, origin_m);
	g_autoptr(profile_around) around = profile_around_new(m, origin_m, unit_m);
	g_autoptr(GArray) pieces = profile_pieces_grow(m, origin_m, unit_m, &o);
	for (int pass = 0; pieces && pass < PASSES; pass++) {
		g_autoptr(profile_joiner) joiner = profile_joiner_new(&o);
		if (!settle(around, pieces, pass > 0, joiner, &o))
			return NULL;
		g_array_unref(pieces);
		pieces = profile_joiner_pieces(joiner);
	}
	if (!pieces)
		return NULL;
	g_autoptr(profile_joiner) joiner = fit_rims(around, pieces, &o);
	g_autoptr(GArray) whole = profile_joiner_pieces(joiner);
	g_array_sort(whole, by_length);
	profile_cross_cut(whole, &o);
	profile_lines *lines = profile_chain(whole, origin_m, &o);
	to_metres(lines, unit_m);
	return lines;
}
