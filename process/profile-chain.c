#include "process/profile-chain.h"
#include "process/profile-places.h"
#include "process/vector3.h"
#include <math.h>
#include <string.h>

/* Ends that are so near, and turn less, go on in each other. */
#define LINK_M        0.05
#define LINK_SPACINGS 1.0
#define LINK_COS      0.7 /* 45 degrees */
/* Straight pieces of a curve pass each other: where they do so are both cut off, no more of either than this part, and no more than nobody
 * could tell from the other. */
#define CROSS_PART     0.45
#define CROSS_SAME_COS 0.97  /* of a face that both lie on */
#define CROSS_SINE2    0.003 /* 3 degrees */
#define CROSS_STEP_M   0.2
#define CROSS_MOST_M   0.4
/* Where pieces of a curve meet it is round, unless that leaves them by more. */
#define ROUND_M    0.04
#define ROUND_TURN 0.12 /* radians from vertex to vertex */
#define ROUND_MOST 8
/* Ends so near to a corner go there. */
#define CORNER_M        0.06
#define CORNER_SPACINGS 1.5
#define CORNER_SINE2    0.1
#define CORNER_PAST_M   0.02 /* lines pass each other so near */

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
	return &g_array_index(e->pieces, struct profile_piece, end / 2);
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

/* Where it is, and where others may cut it off. */
static void add_places(struct ends *e, uint32_t end)
{
	double most = fmin(CROSS_PART * profile_piece_length(piece_of_end(e, end)), CROSS_MOST_M);
	for (double back = 0;; back += CROSS_STEP_M) {
		double at[3];
		for (int k = 0; k < 3; k++)
			at[k] = e->at[end][k] - fmin(back, most) * end_way(e, end, k);
		places_add_at(&e->places, at, end);
		if (back >= most)
			return;
	}
}

struct link {
	double cost;
	uint32_t a, b;
	double at[3];
};

static int by_cost(const void *a, const void *b)
{
	const struct link *x = a, *y = b;
	if (x->cost != y->cost)
		return x->cost < y->cost ? -1 : 1;
	return x->a != y->a ? (x->a > y->a) - (x->a < y->a) : (x->b > y->b) - (x->b < y->b);
}

/* They lie on one face, or nothing is known of those of either. */
static bool shares_face(const struct profile_piece *p, const struct profile_piece *q)
{
	bool some[2] = { false, false };
	for (int i = 0; i < 2; i++) {
		some[0] |= vector3_length(p->face[i]) > 0;
		some[1] |= vector3_length(q->face[i]) > 0;
		for (int n = 0; n < 2; n++)
			if (vector3_dot(p->face[i], q->face[n]) > (float)CROSS_SAME_COS)
				return true;
	}
	return !some[0] && !some[1];
}

/* Where two ends pass each other, if they do; its cost is what is cut off. */
static bool find_crossing(const struct ends *e, struct link *l, double cosine)
{
	const struct profile_piece *p = piece_of_end(e, l->a), *q = piece_of_end(e, l->b);
	double ways[2][3], at[2], sine = sqrt(fmax(1 - cosine * cosine, 0)), from[2][3],
				  off_m = profile_piece_off_m(spacing_of(e, l->a, l->b));
	for (int k = 0; k < 3; k++) {
		ways[0][k] = end_way(e, l->a, k);
		ways[1][k] = end_way(e, l->b, k);
	}
	if (!straight_nearest(e->at[l->a], ways[0], e->at[l->b], ways[1], CROSS_SINE2, at) ||
		at[0] > 0 || at[1] > 0 || !shares_face(p, q) ||
		-at[0] > CROSS_PART * profile_piece_length(p) ||
		-at[1] > CROSS_PART * profile_piece_length(q) || -at[0] * sine > off_m ||
		-at[1] * sine > off_m)
		return false;
	for (int k = 0; k < 3; k++) {
		from[0][k] = e->at[l->a][k] + at[0] * ways[0][k];
		from[1][k] = e->at[l->b][k] + at[1] * ways[1][k];
		l->at[k] = (from[0][k] + from[1][k]) / 2;
	}
	l->cost = -at[0] - at[1];
	return apart(from[0], from[1]) < CORNER_PAST_M + spacing_of(e, l->a, l->b) / 2;
}

static bool find_link(const struct ends *e, struct link *l)
{
	double gap = apart(e->at[l->a], e->at[l->b]), cosine = 0;
	for (int k = 0; k < 3; k++)
		cosine -= end_way(e, l->a, k) * end_way(e, l->b, k);
	if (cosine < LINK_COS)
		return false;
	if (!find_crossing(e, l, cosine)) {
		if (gap > LINK_M + LINK_SPACINGS * spacing_of(e, l->a, l->b))
			return false;
		l->cost = gap;
		for (int k = 0; k < 3; k++)
			l->at[k] = (e->at[l->a][k] + e->at[l->b][k]) / 2;
	}
	l->cost += 0.1 * (1 - cosine);
	return true;
}

static void find_links(const struct ends *e, GArray *ret)
{
	for (uint32_t a = 0; a < e->count; a++) {
		g_autoptr(GArray) near = ends_near(e, a);
		for (guint n = 0; n < near->len; n++) {
			struct link link = { 0, a, g_array_index(near, uint32_t, n), { 0 } };
			if (link.b > a && link.b / 2 != a / 2 && find_link(e, &link))
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
			e->at[l->a][k] = e->at[l->b][k] = l->at[k];
	}
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
				!straight_nearest(
					e->at[a], ways[0], e->at[b], ways[1], CORNER_SINE2, at) ||
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

/* A line while its pieces are put together. */
struct chain {
	GArray *place; /* of double[3] */
	GArray *piece; /* of struct profile_piece *: from each place on */
};

static const double *place_at(const struct chain *c, guint n)
{
	return &((const double *)(const void *)c->place->data)[3 * n];
}

static void add_vertex(profile_lines *lines, const double at[3], const struct profile_piece *p)
{
	struct profile_vertex v;
	for (int k = 0; k < 3; k++)
		v.at_m[k] = (float)at[k];
	for (int f = 0; f < 2; f++)
		model_pack_normal(p->face[f], v.face[f]);
	g_array_append_val(lines->vertex, v);
}

static void between(const double a[3], const double b[3], double part, double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = a[k] + part * (b[k] - a[k]);
}

/* From piece to piece around a place: a parabola that both touch as far from there as half the shorter one is long; or straight to it, where
 * that would leave it by far. */
static void add_bend(profile_lines *lines, const struct profile_piece *const piece[2],
	const double before[3], const double at[3], const double behind[3])
{
	double long_m[2] = { apart(before, at), apart(at, behind) };
	double half_m = fmin(long_m[0], long_m[1]) / 2, end[2][3], middle[3];
	between(at, before, half_m / fmax(long_m[0], 1e-9), end[0]);
	between(at, behind, half_m / fmax(long_m[1], 1e-9), end[1]);
	between(end[0], end[1], 0.5, middle);
	double leaves_m = apart(at, middle) / 2,
	       turn = 2 * asin(fmin(2 * leaves_m / fmax(half_m, 1e-9), 1));
	if (leaves_m > ROUND_M) {
		add_vertex(lines, at, piece[1]);
		return;
	}
	int steps = CLAMP((int)ceil(turn / ROUND_TURN), 1, ROUND_MOST);
	for (int n = 0; n <= steps; n++) {
		double t = (double)n / steps, ends[2][3], place[3];
		between(end[0], at, t, ends[0]);
		between(at, end[1], t, ends[1]);
		between(ends[0], ends[1], t, place);
		add_vertex(lines, place, piece[2 * n > steps]);
	}
}

/* What is closed begins amid its first piece, so that it is round all around. */
static void add_places_of(profile_lines *lines, const struct chain *c, bool is_closed)
{
	guint count = c->piece->len;
	double first[3];
	between(place_at(c, 0), place_at(c, 1), is_closed ? 0.5 : 0, first);
	const struct profile_piece **piece = (const struct profile_piece **)(void *)c->piece->data;
	add_vertex(lines, first, piece[0]);
	for (guint n = 1; n < count; n++)
		add_bend(lines, &piece[n - 1], place_at(c, n - 1), place_at(c, n),
			place_at(c, n + 1));
	if (is_closed)
		add_bend(lines,
			(const struct profile_piece *const[2]){ piece[count - 1], piece[0] },
			place_at(c, count - 1), place_at(c, 0), place_at(c, 1));
	add_vertex(lines, is_closed ? first : place_at(c, count), piece[is_closed ? 0 : count - 1]);
}

static double length_of(const profile_lines *lines, guint first)
{
	double sum = 0;
	for (guint n = first + 1; n < lines->vertex->len; n++) {
		const float *a = g_array_index(lines->vertex, struct profile_vertex, n - 1).at_m,
			    *b = g_array_index(lines->vertex, struct profile_vertex, n).at_m;
		sum += (double)vector3_length(
			(const float[3]){ b[0] - a[0], b[1] - a[1], b[2] - a[2] });
	}
	return sum;
}

/* From an end on through all that is linked. */
static void add_line(profile_lines *lines, const struct ends *e, uint32_t begin, bool *is_done)
{
	struct profile_line line = { .first = lines->vertex->len };
	g_autoptr(GArray) places = g_array_new(FALSE, FALSE, 3 * sizeof(double));
	g_autoptr(GArray) pieces = g_array_new(FALSE, FALSE, sizeof(struct profile_piece *));
	const struct chain chain = { places, pieces };
	double sure = 0, longest = 0, all_m = 0;
	uint32_t end = begin;
	g_array_append_vals(places, e->at[begin], 1);
	for (;;) {
		const struct profile_piece *p = piece_of_end(e, end);
		double length = apart(e->at[end], e->at[end ^ 1]);
		g_array_append_val(pieces, p);
		g_array_append_vals(places, e->at[end ^ 1], 1);
		is_done[end / 2] = true;
		all_m += length;
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
	add_places_of(lines, &chain, line.closed);
	line.count = lines->vertex->len - line.first;
	line.length_m = (float)length_of(lines, line.first);
	line.confidence = all_m > 0 ? (float)fmin(sure / all_m, 1) : 0;
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

profile_lines *profile_chain(
	GArray *pieces, const double origin_m[3], const struct profile_options *options)
{
	profile_lines *lines = profile_lines_new();
	struct ends e = { .pieces = pieces, .count = 2 * pieces->len };
	places_init(&e.places);
	g_autofree bool *is_done = g_new0(bool, pieces->len + 1);
	memcpy(lines->origin_m, origin_m, sizeof lines->origin_m);
	e.link = g_new(uint32_t, e.count + 1);
	e.at = g_malloc_n(e.count + 1, sizeof *e.at);
	for (uint32_t n = 0; n < e.count; n++) {
		const struct profile_piece *p = piece_of_end(&e, n);
		e.link[n] = UINT32_MAX;
		straight_place(&p->line, n & 1 ? p->to_m : p->from_m, e.at[n]);
		add_places(&e, n);
	}
	link_ends(&e);
	meet_corners(&e);
	/* Open ones from their ends, then those that are closed from anywhere. */
	for (int closed = 0; closed < 2; closed++)
		for (uint32_t n = 0; n < e.count; n++)
			if (!is_done[n / 2] && (closed || e.link[n] == UINT32_MAX))
				add_line(lines, &e, n, is_done);
	drop_short(lines, options);
	places_clear(&e.places);
	g_free(e.link);
	g_free(e.at);
	return lines;
}
