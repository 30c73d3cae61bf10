#include "process/profile-join.h"
#include "process/profile-places.h"
#include <math.h>
#include <string.h>

/* Pieces side by side are one when they are so near, and half a spacing; those longer than LONG_M when their directions agree the better. */
#define BESIDE_M        0.012
#define BESIDE_SPACINGS 0.5
#define BESIDE_GUESSED  1.2 /* spacings, where beams do not tell ends any better */
#define LONG_M          0.5
#define SAME_LONG_COS   0.9945 /* 6 degrees */
#define SAME_SHORT_COS  0.978  /* 12 */
/* One behind the other they are one when what is between is shorter. */
#define BETWEEN_M 0.2
/* What makes one longer by so much moves it. */
#define LONGER_M 0.1
/* What grew in feature points is explained by edges that are so near, and go the same way, along this part of it. */
#define EXPLAINS_M             0.02
#define EXPLAINS_SPACINGS      0.8
#define EXPLAINS_COS           0.966 /* 15 degrees */
#define EXPLAINS_SHARE         0.75
#define EXPLAINS_STEP_M        0.1
#define EXPLAINS_EDGE_M        0.008
#define EXPLAINS_MARK_M        0.06 /* feature points of edges, grown askew */
#define EXPLAINS_EDGE_SPACINGS 0.3
/* Ends that are so near, and turn less, go on in each other. */
#define LINK_M        0.05
#define LINK_SPACINGS 1.0
#define LINK_COS      0.7 /* 45 degrees */
/* Ends so near to a corner go there. */
#define CORNER_M        0.06
#define CORNER_SPACINGS 1.5
#define CORNER_PAST_M   0.02 /* lines pass each other so near */

/* ---- twice, or in parts ---- */

struct profile_joiner {
	struct profile_options options;
	GArray *pieces; /* of struct profile_piece: those that stay */
	GArray *sums;   /* of struct line_sums, of each: all that became part of it */
	struct places places;
};

profile_joiner *profile_joiner_new(const struct profile_options *options)
{
	profile_joiner *j = g_new0(profile_joiner, 1);
	j->options = *options;
	j->pieces = g_array_new(FALSE, FALSE, sizeof(struct profile_piece));
	j->sums = g_array_new(FALSE, FALSE, sizeof(struct line_sums));
	places_init(&j->places);
	return j;
}

void profile_joiner_free(profile_joiner *j)
{
	if (!j)
		return;
	g_array_unref(j->pieces);
	g_array_unref(j->sums);
	places_clear(&j->places);
	g_free(j);
}

static struct profile_piece *piece_at(const GArray *pieces, uint32_t i)
{
	return &g_array_index(pieces, struct profile_piece, i);
}

static double cosine_of(const struct profile_piece *a, const struct profile_piece *b)
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += a->line.along[k] * b->line.along[k];
	return sum;
}

static bool is_parallel(const struct profile_piece *a, const struct profile_piece *b)
{
	double shorter = fmin(profile_piece_length(a), profile_piece_length(b));
	return fabs(cosine_of(a, b)) > (shorter > LONG_M ? SAME_LONG_COS : SAME_SHORT_COS);
}

static struct line_sums sums_of(const struct profile_piece *p)
{
	struct line_sums sums = { 0 };
	for (int n = 0; n < 3; n++) {
		double at[3];
		straight_place(&p->line, p->from_m + n * profile_piece_length(p) / 2, at);
		line_sums_add(&sums, at, pow(profile_piece_length(p), 3) * (double)p->support);
	}
	return sums;
}

/* With one more part, the line is the one that is nearest to all of them. */
static void fit_anew(profile_joiner *j, uint32_t number, const struct profile_piece *p)
{
	struct profile_piece *q = piece_at(j->pieces, number);
	struct line_sums *all = &g_array_index(j->sums, struct line_sums, number);
	const struct line_sums more = sums_of(p);
	struct straight line;
	double from[3], to[3];
	all->weight += more.weight;
	for (int k = 0; k < 6; k++) {
		all->product[k] += more.product[k];
		if (k < 3)
			all->sum[k] += more.sum[k];
	}
	if (!line_sums_fit(all, &line, NULL))
		return;
	straight_place(&q->line, q->from_m, from);
	straight_place(&q->line, q->to_m, to);
	q->line = line;
	q->from_m = straight_along(&line, from);
	q->to_m = straight_along(&line, to);
	if (q->from_m > q->to_m) {
		for (int k = 0; k < 3; k++)
			q->line.along[k] = -q->line.along[k];
		q->from_m = -q->from_m;
		q->to_m = -q->to_m;
	}
}

/* Takes p into q as far as they are one; true: nothing is left of p. */
static bool absorb(profile_joiner *j, uint32_t number, struct profile_piece *p)
{
	struct profile_piece *q = piece_at(j->pieces, number);
	double spacings = p->is_guessed && q->is_guessed ? BESIDE_GUESSED : BESIDE_SPACINGS,
	       beside_m = BESIDE_M + spacings * (double)fmaxf(p->spacing_m, q->spacing_m);
	double end[2][3], at[2], off[2];
	if (!is_parallel(p, q))
		return false;
	for (int e = 0; e < 2; e++) {
		straight_place(&p->line, e ? p->to_m : p->from_m, end[e]);
		at[e] = straight_along(&q->line, end[e]);
		off[e] = straight_off(&q->line, end[e]);
	}
	double from = fmin(at[0], at[1]), to = fmax(at[0], at[1]);
	if (from > q->to_m + BETWEEN_M || to < q->from_m - BETWEEN_M)
		return false;
	if (off[0] <= beside_m && off[1] <= beside_m) {
		places_add(&j->places, q, from, fmin(to, q->from_m), number);
		places_add(&j->places, q, fmax(from, q->to_m), to, number);
		double whole = fmax(to, q->to_m) - fmin(from, q->from_m);
		double both = profile_piece_length(p) * (double)p->support +
			      profile_piece_length(q) * (double)q->support;
		double shared = fmax(fmin(to, q->to_m) - fmax(from, q->from_m), 0);
		q->support = fmaxf(q->support * (float)(profile_piece_length(q) / whole),
			(float)fmin((both - shared) / whole, 1));
		bool extends = whole > LONGER_M + profile_piece_length(q);
		q->from_m = fmin(q->from_m, from);
		q->to_m = fmax(q->to_m, to);
		/* What lies beside it all along may be another edge: the longer one is known better. */
		if (extends)
			fit_anew(j, number, p);
		return true;
	}
	/* They part, or meet, at a small angle: what lies beside the other goes. */
	int near = off[0] < off[1] ? 0 : 1;
	if (off[near] > beside_m)
		return false;
	double past_m = near ? fmax(q->from_m - at[1], at[1] - q->to_m)
			     : fmax(q->from_m - at[0], at[0] - q->to_m);
	if (past_m > 0)
		return false;
	double other = at[1 - near] > at[near] ? q->to_m : q->from_m;
	double share = fabs(at[1 - near] - at[near]) > 1e-6
			       ? (other - at[near]) / (at[1 - near] - at[near])
			       : 1;
	double part = (beside_m - off[near]) / (off[1 - near] - off[near]);
	double cut = fmin(share, part) * profile_piece_length(p);
	if (near)
		p->to_m -= cut;
	else
		p->from_m += cut;
	return false;
}

/* All that may have to do with it, in order; caller unrefs. */
static GArray *pieces_near(const profile_joiner *j, const struct profile_piece *p, double reach_m)
{
	struct places_found near = places_found_new(j->pieces->len);
	double from = p->from_m - reach_m, to = p->to_m + reach_m;
	uint32_t steps = places_steps(from, to);
	for (uint32_t s = 0; s <= steps; s++) {
		double at[3];
		straight_place(&p->line, from + (to - from) * s / MAX(steps, 1), at);
		places_find(&j->places, at, &near);
	}
	return places_found_take(&near);
}

/* Whether the place is on the piece, as exactly as feature points tell it. */
static bool is_on(const struct profile_piece *q, const struct profile_piece *p, bool is_edge,
	const double at[3])
{
	double along = straight_along(&q->line, at), within_m = is_edge && p->kind > PROFILE_END
									? EXPLAINS_MARK_M
								: is_edge ? EXPLAINS_EDGE_M
									  : EXPLAINS_M;
	return along > q->from_m - BETWEEN_M / 2 && along < q->to_m + BETWEEN_M / 2 &&
	       straight_off(&q->line, at) <
		       within_m + (is_edge ? EXPLAINS_EDGE_SPACINGS : EXPLAINS_SPACINGS) *
					  (double)fmaxf(p->spacing_m, q->spacing_m);
}

/* Those that do not go its way are none that explain it. */
static void leave_out_crossing(
	const profile_joiner *j, const struct profile_piece *p, GArray *numbers)
{
	guint kept = 0;
	for (guint n = 0; n < numbers->len; n++) {
		uint32_t number = g_array_index(numbers, uint32_t, n);
		if (fabs(cosine_of(p, piece_at(j->pieces, number))) > EXPLAINS_COS)
			g_array_index(numbers, uint32_t, kept++) = number;
	}
	g_array_set_size(numbers, kept);
}

bool profile_joiner_explains(const profile_joiner *j, const struct profile_piece *p, bool is_edge)
{
	g_autoptr(GArray) near = pieces_near(j, p, 0);
	uint32_t steps = (uint32_t)ceil(profile_piece_length(p) / EXPLAINS_STEP_M), some = 0;
	leave_out_crossing(j, p, near);
	for (uint32_t s = 0; s <= steps && near->len; s++) {
		double at[3];
		straight_place(&p->line, p->from_m + (p->to_m - p->from_m) * s / MAX(steps, 1), at);
		for (guint n = 0; n < near->len; n++)
			if (is_on(piece_at(j->pieces, g_array_index(near, uint32_t, n)), p, is_edge,
				    at)) {
				some++;
				break;
			}
	}
	return some >= EXPLAINS_SHARE * (steps + 1);
}

void profile_joiner_add(profile_joiner *j, const struct profile_piece *piece)
{
	struct profile_piece p = *piece;
	g_autoptr(GArray) near = pieces_near(j, &p, BETWEEN_M);
	for (guint n = 0; n < near->len; n++)
		if (absorb(j, g_array_index(near, uint32_t, n), &p) ||
			profile_piece_length(&p) < (double)j->options.length_least_m / 2)
			return;
	if (profile_joiner_explains(j, &p, true))
		return;
	places_add(&j->places, &p, p.from_m, p.to_m, j->pieces->len);
	struct line_sums sums = sums_of(&p);
	g_array_append_val(j->pieces, p);
	g_array_append_val(j->sums, sums);
}

GArray *profile_joiner_pieces(const profile_joiner *j)
{
	return g_array_ref(j->pieces);
}

/* ---- ends ---- */

/* Of a piece: 2 n where it begins, 2 n + 1 where it ends. */
struct ends {
	GArray *pieces;
	uint32_t count;
	uint32_t *link; /* the end that it goes on in; UINT32_MAX: none */
	double (*at)[3];
	struct places places;
};

static const struct profile_piece *piece_of_end(const struct ends *e, uint32_t end)
{
	return piece_at(e->pieces, end / 2);
}

/* Out of the piece. */
static double end_way(const struct ends *e, uint32_t end, int k)
{
	return (end & 1 ? 1 : -1) * piece_of_end(e, end)->line.along[k];
}

static double apart(const double a[3], const double b[3])
{
	double square = 0;
	for (int k = 0; k < 3; k++)
		square += (a[k] - b[k]) * (a[k] - b[k]);
	return sqrt(square);
}

static double spacing_of(const struct ends *e, uint32_t a, uint32_t b)
{
	return (double)fmaxf(piece_of_end(e, a)->spacing_m, piece_of_end(e, b)->spacing_m);
}

/* Caller unrefs. */
static GArray *ends_near(const struct ends *e, uint32_t end)
{
	struct places_found near = places_found_new(e->count);
	places_find(&e->places, e->at[end], &near);
	return places_found_take(&near);
}

struct link {
	double cost;
	uint32_t a, b;
};

static int by_cost(const void *a, const void *b)
{
	const struct link *x = a, *y = b;
	if (x->cost != y->cost)
		return x->cost < y->cost ? -1 : 1;
	return x->a != y->a ? (x->a > y->a) - (x->a < y->a) : (x->b > y->b) - (x->b < y->b);
}

static void find_links(struct ends *e, GArray *ret)
{
	for (uint32_t a = 0; a < e->count; a++) {
		g_autoptr(GArray) near = ends_near(e, a);
		for (guint n = 0; n < near->len; n++) {
			uint32_t b = g_array_index(near, uint32_t, n);
			double gap = apart(e->at[a], e->at[b]), cosine = 0;
			for (int k = 0; k < 3; k++)
				cosine -= end_way(e, a, k) * end_way(e, b, k);
			if (b <= a || b / 2 == a / 2 || cosine < LINK_COS ||
				gap > LINK_M + LINK_SPACINGS * spacing_of(e, a, b))
				continue;
			struct link link = { gap + 0.1 * (1 - cosine), a, b };
			g_array_append_val(ret, link);
		}
	}
	g_array_sort(ret, by_cost);
}

static void link_ends(struct ends *e)
{
	g_autoptr(GArray) links = g_array_new(FALSE, FALSE, sizeof(struct link));
	find_links(e, links);
	for (guint n = 0; n < links->len; n++) {
		const struct link *l = &g_array_index(links, struct link, n);
		if (e->link[l->a] != UINT32_MAX || e->link[l->b] != UINT32_MAX)
			continue;
		e->link[l->a] = l->b;
		e->link[l->b] = l->a;
		for (int k = 0; k < 3; k++)
			e->at[l->a][k] = e->at[l->b][k] = (e->at[l->a][k] + e->at[l->b][k]) / 2;
	}
}

/* Where two lines come nearest to each other: how far along each from a place on it; false: they are parallel. */
static bool nearest(const double p[3], const double along[3], const double q[3],
	const double way[3], double ret[2])
{
	double cosine = 0, a = 0, b = 0;
	for (int k = 0; k < 3; k++) {
		cosine += along[k] * way[k];
		a += (q[k] - p[k]) * along[k];
		b += (p[k] - q[k]) * way[k];
	}
	double sine2 = 1 - cosine * cosine;
	ret[0] = (a + cosine * b) / sine2;
	ret[1] = (b + cosine * a) / sine2;
	return sine2 > 0.1;
}

/* Free ends that nearly meet the end of another line, or pass it, meet it. */
static void meet_corners(struct ends *e)
{
	for (uint32_t a = 0; a < e->count; a++) {
		if (e->link[a] != UINT32_MAX)
			continue;
		g_autoptr(GArray) near = ends_near(e, a);
		for (guint n = 0; n < near->len; n++) {
			uint32_t b = g_array_index(near, uint32_t, n);
			double ways[2][3], at[2],
				reach = CORNER_M + CORNER_SPACINGS * spacing_of(e, a, b);
			for (int k = 0; k < 3; k++) {
				ways[0][k] = end_way(e, a, k);
				ways[1][k] = end_way(e, b, k);
			}
			if (b / 2 == a / 2 || e->link[b] != UINT32_MAX ||
				!nearest(e->at[a], ways[0], e->at[b], ways[1], at) ||
				fabs(at[0]) > reach || fabs(at[1]) > reach)
				continue;
			double p[3], q[3];
			for (int k = 0; k < 3; k++) {
				p[k] = e->at[a][k] + at[0] * ways[0][k];
				q[k] = e->at[b][k] + at[1] * ways[1][k];
			}
			if (apart(p, q) > CORNER_PAST_M + spacing_of(e, a, b) / 2)
				continue;
			for (int k = 0; k < 3; k++)
				e->at[a][k] = e->at[b][k] = (p[k] + q[k]) / 2;
			break;
		}
	}
}

/* ---- lines ---- */

static void add_vertex(profile_lines *lines, const double at[3], const struct profile_piece *p)
{
	struct profile_vertex v;
	for (int k = 0; k < 3; k++)
		v.at_m[k] = (float)at[k];
	for (int f = 0; f < 2; f++)
		model_pack_normal(p->face[f], v.face[f]);
	g_array_append_val(lines->vertex, v);
}

/* From an end on through all that is linked. */
static void add_line(profile_lines *lines, const struct ends *e, uint32_t begin, bool *is_done)
{
	struct profile_line line = { .first = lines->vertex->len };
	double sure = 0, longest = 0;
	uint32_t end = begin;
	for (;;) {
		const struct profile_piece *p = piece_of_end(e, end);
		double length = apart(e->at[end], e->at[end ^ 1]);
		if (end == begin)
			add_vertex(lines, e->at[end], p);
		add_vertex(lines, e->at[end ^ 1], p);
		is_done[end / 2] = true;
		line.length_m += (float)length;
		sure += length * (double)(p->support * (p->kind <= PROFILE_END ? 1 : 0.6f));
		if (length > longest) {
			longest = length;
			line.leaf = p->leaf;
			line.kind = p->kind;
		}
		uint32_t next = e->link[end ^ 1];
		line.closed = next == begin;
		if (next == UINT32_MAX || is_done[next / 2])
			break;
		end = next;
	}
	line.count = lines->vertex->len - line.first;
	line.confidence = line.length_m > 0 ? fminf((float)sure / line.length_m, 1) : 0;
	g_array_append_val(lines->line, line);
}

static int by_length(const void *a, const void *b)
{
	const struct profile_line *x = a, *y = b;
	if (x->length_m != y->length_m)
		return x->length_m > y->length_m ? -1 : 1;
	return (x->first > y->first) - (x->first < y->first);
}

static void drop_short(profile_lines *lines, const struct profile_options *o)
{
	guint kept = 0;
	for (guint n = 0; n < lines->line->len; n++) {
		const struct profile_line line = g_array_index(lines->line, struct profile_line, n);
		if (line.length_m >= o->length_least_m)
			g_array_index(lines->line, struct profile_line, kept++) = line;
	}
	g_array_set_size(lines->line, kept);
	g_array_sort(lines->line, by_length);
}

profile_lines *profile_joiner_finish(profile_joiner *j, const double origin_m[3])
{
	profile_lines *lines = profile_lines_new();
	struct ends e = { .pieces = j->pieces, .count = 2 * j->pieces->len };
	places_init(&e.places);
	g_autofree bool *is_done = g_new0(bool, j->pieces->len + 1);
	memcpy(lines->origin_m, origin_m, sizeof lines->origin_m);
	e.link = g_new(uint32_t, e.count + 1);
	e.at = g_malloc_n(e.count + 1, sizeof *e.at);
	for (uint32_t n = 0; n < e.count; n++) {
		const struct profile_piece *p = piece_of_end(&e, n);
		e.link[n] = UINT32_MAX;
		straight_place(&p->line, n & 1 ? p->to_m : p->from_m, e.at[n]);
		places_add_at(&e.places, e.at[n], n);
	}
	link_ends(&e);
	meet_corners(&e);
	/* Open ones from their ends, then those that are closed from anywhere. */
	for (int closed = 0; closed < 2; closed++)
		for (uint32_t n = 0; n < e.count; n++)
			if (!is_done[n / 2] && (closed || e.link[n] == UINT32_MAX))
				add_line(lines, &e, n, is_done);
	drop_short(lines, &j->options);
	places_clear(&e.places);
	g_free(e.link);
	g_free(e.at);
	return lines;
}
