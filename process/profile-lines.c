#include "process/profile-lines.h"
#include "process/profile-agree.h"
#include "process/profile-chain.h"
#include "process/profile-cross.h"
#include "process/profile-extent.h"
#include "process/profile-join.h"
#include "process/profile-rim.h"
#include <math.h>
#include <string.h>

#define LENGTH_LEAST_M 0.2f
/* Of the work, when edges of all looks are found. */
#define SETTLED_PART 0.97
/* Pieces that are looked at side by side. */
#define BATCH 32u
/* What grew becomes edges, and those that are so much longer than what they were found by are found again by all of their length. */
#define PASSES 3
#define LONGER 1.3
/* And after these passes, in one more, one looks beside those that are so long, of buildings: beside a chord of what is round there is always another. */
#define BESIDE PASSES
#define LONG_M 0.5
/* All of that once for each of these. */
static const struct profile_look looks[] = {
	{ false, 0 },
	{ true, 0 },
	{ true, 1 },
	{ false, 2 },
	{ true, 3 },
	{ false, 4 },
};
#define LOOKS G_N_ELEMENTS(looks)
_Static_assert(LOOKS <= PROFILE_AGREE_LOOKS, "a bit each");

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

static bool is_known(const struct profile_piece *p, const void *joiner)
{
	return profile_joiner_explains(joiner, p, true);
}

/* Of all passes of all looks, which and how far. */
static bool tell(const struct profile_options *o, uint32_t look, int pass, double part)
{
	return !o->progress ||
	       o->progress(PROFILE_GROWN_PART + (SETTLED_PART - PROFILE_GROWN_PART) *
							(look + (pass + part) / (BESIDE + 1)) /
							LOOKS,
		       o->user_data);
}

struct sight {
	const profile_around *around;
	const struct profile_options *options;
	uint32_t look;
};

static bool may_have_others_beside(const struct profile_piece *p, const struct profile_options *o)
{
	return p->kind <= PROFILE_END && profile_piece_length(p) >= LONG_M &&
	       (!o->leaf_class || o->leaf_class[p->leaf] == CLASS_BUILDING);
}

/* What comes of a piece in a pass, beside what the joiner has. */
static void look_at(const struct sight *s, const struct profile_piece *p, int pass,
	const profile_joiner *joiner, GArray *ret)
{
	const struct profile_look *look = &looks[s->look];
	const bool is_again = pass > 0;
	if (pass == BESIDE) {
		if (may_have_others_beside(p, s->options))
			profile_piece_look_beside(s->around, p, look, is_known, joiner, ret);
	} else if (is_again &&
		   (p->kind > PROFILE_END || profile_piece_length(p) < LONGER * (double)p->seen_m))
		g_array_append_val(ret, *p);
	else if (!profile_joiner_explains(joiner, p, is_again))
		profile_piece_settle(s->around, p, look, is_known, joiner, ret);
}

static void add_all(profile_joiner *joiner, GArray *pieces)
{
	g_array_sort(pieces, profile_piece_by_worth);
	for (guint n = 0; n < pieces->len; n++)
		profile_joiner_add(joiner, &g_array_index(pieces, struct profile_piece, n));
}

/* The longest first, some at a time: what these show explains many of those that come later. false: progress stopped it. */
static bool settle(const struct sight *s, GArray *pieces, int pass, profile_joiner *joiner)
{
	const struct profile_options *options = s->options;
	g_array_sort(pieces, pass > 0 ? profile_piece_by_worth : profile_piece_by_length);
	for (guint n = 0; n < pieces->len; n += BATCH) {
		GArray *found[BATCH];
		guint count = MIN(BATCH, pieces->len - n);
#pragma omp parallel for schedule(dynamic) if (!options->single_thread)
		for (guint k = 0; k < count; k++) {
			found[k] = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
			look_at(s, &g_array_index(pieces, struct profile_piece, n + k), pass,
				joiner, found[k]);
		}
		g_autoptr(GArray) edges = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
		for (guint k = 0; k < count; k++) {
			g_array_append_vals(edges, found[k]->data, found[k]->len);
			g_array_unref(found[k]);
		}
		add_all(joiner, edges);
		if (!tell(options, s->look, pass, (double)n / pieces->len))
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

/* Ends of faces, by the beams along all of their length; where beams tell of none there is none. In the same order. */
static void fit_rims(
	const profile_around *around, GArray *pieces, const struct profile_options *options)
{
	g_autofree enum profile_rim *told = g_new(enum profile_rim, pieces->len + 1);
	guint kept = 0;
#pragma omp parallel for schedule(dynamic) if (!options->single_thread)
	for (guint n = 0; n < pieces->len; n++)
		told[n] = profile_rim_fit(around, &g_array_index(pieces, struct profile_piece, n));
	for (guint n = 0; n < pieces->len; n++)
		if (told[n] != PROFILE_RIM_NONE)
			g_array_index(pieces, struct profile_piece, kept++) =
				g_array_index(pieces, struct profile_piece, n);
	g_array_set_size(pieces, kept);
}

/* What lies on one line is one. */
static GArray *join(GArray *pieces, const struct profile_options *options)
{
	g_autoptr(profile_joiner) joiner = profile_joiner_new(options);
	add_all(joiner, pieces);
	return profile_joiner_pieces(joiner);
}

/* What one look makes of pieces that grew; NULL: progress stopped it. */
static GArray *find_edges(const struct sight *s, const GArray *grown)
{
	g_autoptr(GArray) pieces = g_array_copy((GArray *)grown);
	for (int pass = 0; pass <= BESIDE; pass++) {
		g_autoptr(profile_joiner) joiner = profile_joiner_new(s->options);
		/* Those that one looks beside stay as they are. */
		if (pass == BESIDE)
			add_all(joiner, pieces);
		if (!settle(s, pieces, pass, joiner))
			return NULL;
		g_array_unref(pieces);
		pieces = profile_joiner_pieces(joiner);
	}
	fit_rims(s->around, pieces, s->options);
	GArray *joined = join(pieces, s->options);
	fit_rims(s->around, joined, s->options);
	return joined;
}

/* Those of all looks, as far as they agree; NULL: progress stopped it. */
static GArray *find_agreed(
	const profile_around *around, const GArray *grown, const struct profile_options *options)
{
	GArray *found[LOOKS], *agreed = NULL;
	uint32_t done = 0;
	for (; done < LOOKS; done++) {
		const struct sight sight = { around, options, done };
		found[done] = find_edges(&sight, grown);
		if (!found[done])
			break;
	}
	if (done == LOOKS)
		agreed = profile_agree(found, LOOKS, options->single_thread);
	while (done > 0)
		g_array_unref(found[--done]);
	return agreed;
}

/* In the same order. */
static GArray *cut_extents(
	const profile_around *around, const GArray *pieces, const struct profile_options *options)
{
	GArray *ret = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
	g_autofree GArray **part = g_new(GArray *, pieces->len + 1);
#pragma omp parallel for schedule(dynamic, 64) if (!options->single_thread)
	for (guint n = 0; n < pieces->len; n++) {
		part[n] = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
		profile_extent_cut(around, &g_array_index(pieces, struct profile_piece, n),
			(double)options->length_least_m / 2, part[n]);
	}
	for (guint n = 0; n < pieces->len; n++) {
		g_array_append_vals(ret, part[n]->data, part[n]->len);
		g_array_unref(part[n]);
	}
	return ret;
}

profile_lines *profile_lines_find(const model *m, const struct profile_options *options)
{
	const double unit_m = profile_unit_m(m);
	const struct profile_options o = defaults(options, unit_m);
	double origin_m[3];
	find_origin(m, origin_m);
	g_autoptr(profile_around) around = profile_around_new(m, origin_m, unit_m);
	g_autoptr(GArray) grown = profile_pieces_grow(m, origin_m, unit_m, &o);
	g_autoptr(GArray) agreed = grown ? find_agreed(around, grown, &o) : NULL;
	if (!agreed)
		return NULL;
	g_autoptr(GArray) joined = join(agreed, &o);
	g_autoptr(GArray) whole = cut_extents(around, joined, &o);
	g_array_sort(whole, profile_piece_by_length);
	profile_cross_cut(whole, &o);
	profile_lines *lines = profile_chain(whole, origin_m, &o);
	to_metres(lines, unit_m);
	return lines;
}
