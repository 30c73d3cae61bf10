#include "process/plane-straight.h"
#include "process/plane-inside.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Edges that are turned into a main direction: longer than this, and no farther from it. */
#define MAIN_LEAST_M   0.25f
#define MAIN_SINE      0.07f
#define MAIN_SINE_MOST 0.25f
#define MAIN_OFF       0.6f /* spacings that one end may be turned by */
/* Edges that meet at less than this have no corner that could be reckoned. */
#define CORNER_SINE 0.25f
/* How far a corner may move, in widths of what is of an edge. */
#define CORNER_MOST 4.f
/* A vertex lies between those beside it. */
#define PRUNE_M 0.003f
/* Of the line where two planes meet. */
/* In metres, and in spacings of points, whichever is more. */
#define MEET_M          0.12f
#define MEET_SPACINGS   1.f
#define MEET_SINE       0.3
#define BESIDE_M        0.15f
#define BESIDE_SPACINGS 1.5f
#define CORNER_M        0.25f
#define CORNER_SPACINGS 2.f

typedef float place[2];

struct edge {
	uint32_t from, to; /* of the ring's places; to may be beyond the last one */
	place middle, way; /* unit */
	float length_m;
	bool is_main;
};

/* ---- which edges there are (Douglas and Peucker 1973) ---- */

static const float *at_of(const place *p, uint32_t count, uint32_t n)
{
	return p[n % count];
}

static float off_line(const float a[2], const float b[2], const float p[2])
{
	float way[2] = { b[0] - a[0], b[1] - a[1] }, length = hypotf(way[0], way[1]);
	if (!(length > 0))
		return hypotf(p[0] - a[0], p[1] - a[1]);
	return fabsf(way[0] * (p[1] - a[1]) - way[1] * (p[0] - a[0])) / length;
}

static void split(
	const place *p, uint32_t count, uint32_t from, uint32_t to, float within_m, GArray *corners)
{
	float most = 0;
	uint32_t at = from;
	for (uint32_t n = from + 1; n < to; n++) {
		float off =
			off_line(at_of(p, count, from), at_of(p, count, to), at_of(p, count, n));
		if (off > most) {
			most = off;
			at = n;
		}
	}
	if (most > within_m) {
		split(p, count, from, at, within_m, corners);
		split(p, count, at, to, within_m, corners);
	} else
		g_array_append_val(corners, from);
}

/* Begins at the place that is farthest from the first one, which surely is a corner. */
static uint32_t first_corner(const place *p, uint32_t count)
{
	uint32_t best = 0;
	float most = -1;
	for (uint32_t n = 0; n < count; n++) {
		float away = hypotf(p[n][0] - p[0][0], p[n][1] - p[0][1]);
		if (away > most) {
			most = away;
			best = n;
		}
	}
	return best;
}

/* By all places between its corners, but for those that round them off. */
static struct edge edge_of(const place *p, uint32_t count, uint32_t from, uint32_t to)
{
	struct edge e = { .from = from, .to = to };
	const float *a = at_of(p, count, from), *b = at_of(p, count, to);
	uint32_t skip = MIN((to - from) / 6, 4), many = to - from + 1 - 2 * skip;
	double sum[2] = { 0 }, xx = 0, xy = 0, yy = 0;
	e.length_m = hypotf(b[0] - a[0], b[1] - a[1]);
	for (uint32_t n = from + skip; n <= to - skip; n++)
		for (int k = 0; k < 2; k++)
			sum[k] += (double)at_of(p, count, n)[k] / many;
	for (uint32_t n = from + skip; n <= to - skip; n++) {
		double x = (double)at_of(p, count, n)[0] - sum[0],
		       y = (double)at_of(p, count, n)[1] - sum[1];
		xx += x * x;
		xy += x * y;
		yy += y * y;
	}
	double angle = 0.5 * atan2(2 * xy, xx - yy);
	e.way[0] = (float)cos(angle);
	e.way[1] = (float)sin(angle);
	if (e.way[0] * (b[0] - a[0]) + e.way[1] * (b[1] - a[1]) < 0)
		e.way[0] = -e.way[0], e.way[1] = -e.way[1];
	e.middle[0] = (float)sum[0];
	e.middle[1] = (float)sum[1];
	return e;
}

static GArray *edges_of(const place *p, uint32_t count, float within_m)
{
	g_autoptr(GArray) corners = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	GArray *edges = g_array_new(FALSE, FALSE, sizeof(struct edge));
	uint32_t first = first_corner(p, count), opposite = first + count / 2;
	split(p, count, first, opposite, within_m, corners);
	split(p, count, opposite, first + count, within_m, corners);
	for (guint n = 0; n < corners->len; n++) {
		uint32_t from = g_array_index(corners, uint32_t, n),
			 to = n + 1 < corners->len ? g_array_index(corners, uint32_t, n + 1)
						   : first + count;
		struct edge e = edge_of(p, count, from, to);
		g_array_append_val(edges, e);
	}
	return edges;
}

/* ---- main directions ---- */

/* A quarter turn of an edge changes nothing: angles count four times. */
static void add_ways(const GArray *edges, double sum[2])
{
	for (guint n = 0; n < edges->len; n++) {
		const struct edge *e = &g_array_index(edges, struct edge, n);
		double angle = 4 * atan2((double)e->way[1], (double)e->way[0]);
		sum[0] += (double)(e->length_m * e->length_m) * cos(angle);
		sum[1] += (double)(e->length_m * e->length_m) * sin(angle);
	}
}

static void turn_to_main(GArray *edges, const float main_way[2], float spacing_m)
{
	for (guint n = 0; n < edges->len; n++) {
		struct edge *e = &g_array_index(edges, struct edge, n);
		if (e->length_m < MAIN_LEAST_M)
			continue;
		for (int quarter = 0; quarter < 4; quarter++) {
			place way = { quarter & 1 ? -main_way[1] : main_way[0],
				quarter & 1 ? main_way[0] : main_way[1] };
			if (quarter & 2)
				way[0] = -way[0], way[1] = -way[1];
			float along = way[0] * e->way[0] + way[1] * e->way[1],
			      sine = way[0] * e->way[1] - way[1] * e->way[0];
			if (along < 0 || fabsf(sine) > fmaxf(MAIN_SINE, fminf(MAIN_OFF * spacing_m /
											e->length_m,
										MAIN_SINE_MOST)))
				continue;
			memcpy(e->way, way, sizeof way);
			e->is_main = true;
		}
	}
}

/* ---- corners ---- */

static void project(const struct edge *e, const float at[2], float ret[2])
{
	float along = (at[0] - e->middle[0]) * e->way[0] + (at[1] - e->middle[1]) * e->way[1];
	for (int k = 0; k < 2; k++)
		ret[k] = e->middle[k] + along * e->way[k];
}

static float off_edge(const struct edge *e, const float at[2])
{
	return (at[1] - e->middle[1]) * e->way[0] - (at[0] - e->middle[0]) * e->way[1];
}

/* Main edges that follow each other on one line are one. */
static void join_edges(GArray *edges, const place *p, uint32_t count, float within_m)
{
	for (guint n = 0; n + 1 < edges->len;) {
		struct edge *a = &g_array_index(edges, struct edge, n),
			    *b = &g_array_index(edges, struct edge, n + 1);
		bool same = a->is_main && b->is_main &&
			    a->way[0] * b->way[0] + a->way[1] * b->way[1] > 0.99f &&
			    fabsf(off_edge(a, b->middle)) < within_m;
		if (!same) {
			n++;
			continue;
		}
		float part = b->length_m / (a->length_m + b->length_m);
		struct edge whole = edge_of(p, count, a->from, b->to);
		for (int k = 0; k < 2; k++)
			whole.middle[k] = a->middle[k] + part * (b->middle[k] - a->middle[k]);
		memcpy(whole.way, a->way, sizeof whole.way);
		whole.is_main = true;
		*a = whole;
		g_array_remove_index(edges, n + 1);
	}
}

/* Short edges between main ones that stand on each other: corners are not round. */
static void drop_chamfers(GArray *edges, float within_m)
{
	for (guint n = 0; edges->len > 4 && n < edges->len;) {
		const struct edge *e = &g_array_index(edges, struct edge, n),
				  *a = &g_array_index(
					  edges, struct edge, (n + edges->len - 1) % edges->len),
				  *b = &g_array_index(edges, struct edge, (n + 1) % edges->len);
		float sine = a->way[0] * b->way[1] - a->way[1] * b->way[0];
		if (!e->is_main && e->length_m < CORNER_MOST * within_m && a->is_main &&
			b->is_main && fabsf(sine) > 0.5f)
			g_array_remove_index(edges, n);
		else
			n++;
	}
}

static void add_vertex(GArray *to, guint from, const float at[2])
{
	if (to->len > from) {
		const float *last = g_array_index(to, place, to->len - 1);
		if (hypotf(at[0] - last[0], at[1] - last[1]) < 1e-3f)
			return;
	}
	g_array_append_vals(to, at, 1);
}

/* Where two edges meet; where they hardly turn, a step from the one to the other. */
static void add_corner(GArray *to, guint from, const struct edge *a, const struct edge *b,
	const float at[2], float within_m)
{
	float sine = a->way[0] * b->way[1] - a->way[1] * b->way[0];
	if (fabsf(sine) > CORNER_SINE) {
		float along = off_edge(b, a->middle) / sine;
		place meet = { a->middle[0] + along * a->way[0], a->middle[1] + along * a->way[1] };
		if (hypotf(meet[0] - at[0], meet[1] - at[1]) < CORNER_MOST * within_m) {
			add_vertex(to, from, meet);
			return;
		}
	}
	place on[2];
	project(a, at, on[0]);
	project(b, at, on[1]);
	if (hypotf(on[0][0] - on[1][0], on[0][1] - on[1][1]) < within_m) {
		for (int k = 0; k < 2; k++)
			on[0][k] = (on[0][k] + on[1][k]) / 2;
		add_vertex(to, from, on[0]);
		return;
	}
	add_vertex(to, from, on[0]);
	add_vertex(to, from, on[1]);
}

static void put_ring(const GArray *edges, const place *p, uint32_t count, float within_m,
	GArray *ring, GArray *vertex)
{
	guint from = vertex->len;
	for (guint n = 0; n < edges->len; n++) {
		const struct edge *a = &g_array_index(edges, struct edge, n),
				  *b = &g_array_index(edges, struct edge, (n + 1) % edges->len);
		add_corner(vertex, from, a, b, at_of(p, count, a->to), within_m);
	}
	struct plane_ring r = { from, vertex->len - from };
	if (r.count >= 3)
		g_array_append_val(ring, r);
	else
		g_array_set_size(vertex, from);
}

/* From places of a ring. */
struct border {
	const place *p;
	uint32_t count;
	GArray *edges;
};

static void free_border(gpointer data)
{
	struct border *b = data;
	g_array_unref(b->edges);
}

static GArray *borders_of(const GArray *places, const GArray *ends, float within_m)
{
	GArray *all = g_array_new(FALSE, FALSE, sizeof(struct border));
	uint32_t from = 0;
	g_array_set_clear_func(all, free_border);
	for (guint n = 0; n < ends->len; n++) {
		uint32_t end = g_array_index(ends, uint32_t, n);
		struct border b = { (const place *)(void *)places->data + from, end - from, NULL };
		b.edges = edges_of(b.p, b.count, within_m);
		g_array_append_val(all, b);
		from = end;
	}
	return all;
}

/* Of what stands, upright; of what lies, as most of its edges run. */
static void find_main_way(struct plane_draft *d, const GArray *borders)
{
	double sum[2] = { 0 };
	for (guint n = 0; n < borders->len; n++)
		add_ways(g_array_index(borders, struct border, n).edges, sum);
	double angle = fabsf(d->r.normal[2]) < 0.9f ? 0 : atan2(sum[1], sum[0]) / 4;
	d->main_way[0] = (float)cos(angle);
	d->main_way[1] = (float)sin(angle);
}

void plane_straighten(
	struct plane_draft *d, const GArray *places, const GArray *ends, float within_m)
{
	g_autoptr(GArray) borders = borders_of(places, ends, within_m);
	find_main_way(d, borders);
	for (guint n = 0; n < borders->len; n++) {
		const struct border *b = &g_array_index(borders, struct border, n);
		turn_to_main(b->edges, d->main_way, d->spacing_m);
		join_edges(b->edges, b->p, b->count, within_m);
		drop_chamfers(b->edges, within_m);
		put_ring(b->edges, b->p, b->count, within_m, d->ring, d->vertex);
	}
}

/* ---- where planes meet ---- */

/* a u + b v = c, a and b a unit vector. */
struct meeting {
	double a, b, c;
};

static bool meeting_of(
	const struct plane_region *p, const struct plane_region *q, struct meeting *ret)
{
	double a = 0, b = 0, c = 0;
	for (int k = 0; k < 3; k++) {
		a += (double)(q->normal[k] * p->u[k]);
		b += (double)(q->normal[k] * p->v[k]);
		c += (double)q->normal[k] * (q->origin_m[k] - p->origin_m[k]);
	}
	double length = hypot(a, b);
	*ret = (struct meeting){ a / length, b / length, c / length };
	return length > MEET_SINE;
}

struct met {
	struct plane_met planes;
	struct meeting line[2];
	double off[2];
	int count;
};

/* The two nearest. */
static void keep_nearest(struct met *m, const struct meeting *line, double off, uint32_t plane)
{
	int at = m->count < 2 ? m->count++ : 2;
	while (at > 0 && fabs(off) < fabs(m->off[at - 1])) {
		if (at < 2) {
			m->line[at] = m->line[at - 1];
			m->off[at] = m->off[at - 1];
			m->planes.with[at] = m->planes.with[at - 1];
		}
		at--;
	}
	if (at == 2)
		return;
	m->line[at] = *line;
	m->off[at] = off;
	m->planes.with[at] = plane + 1;
}

static bool is_beside(const struct plane_draft *q, const plane_inside *inside,
	const struct plane_region *p, const float at[2])
{
	double at_m[3];
	float there[2];
	plane_point(p, at, at_m);
	plane_place(&q->r, at_m, there);
	return plane_inside_near(inside, there, fmaxf(BESIDE_M, BESIDE_SPACINGS * q->spacing_m));
}

/* Onto the nearest line, or where both cross; else the second one is none of its. */
static void move_vertex(struct met *m, float spacing_m, const float at[2], float ret[2])
{
	float corner_m = fmaxf(CORNER_M, CORNER_SPACINGS * spacing_m);
	double to[2] = { (double)at[0] - m->off[0] * m->line[0].a,
		(double)at[1] - m->off[0] * m->line[0].b };
	double sine = m->count < 2 ? 0 : m->line[0].a * m->line[1].b - m->line[0].b * m->line[1].a;
	bool crosses = false;
	if (fabs(sine) > MEET_SINE) {
		double u = (m->line[0].c * m->line[1].b - m->line[0].b * m->line[1].c) / sine,
		       v = (m->line[0].a * m->line[1].c - m->line[0].c * m->line[1].a) / sine;
		crosses = hypot(u - (double)at[0], v - (double)at[1]) < (double)corner_m;
		if (crosses) {
			to[0] = u;
			to[1] = v;
		}
	}
	if (!crosses)
		m->planes.with[1] = 0;
	ret[0] = (float)to[0];
	ret[1] = (float)to[1];
}

static void find_met(
	const struct plane_draft *all, uint32_t number, uint32_t other, struct met *met)
{
	const struct plane_draft *d = &all[number];
	struct meeting line;
	if (other == number || !all[other].ring->len || !meeting_of(&d->r, &all[other].r, &line))
		return;
	const float meet_m = fmaxf(MEET_M, MEET_SPACINGS * d->spacing_m);
	g_autoptr(plane_inside) inside = NULL;
	for (guint k = 0; k < d->vertex->len; k++) {
		const float *at = g_array_index(d->vertex, place, k);
		double off = line.a * (double)at[0] + line.b * (double)at[1] - line.c;
		if (fabs(off) > (double)meet_m)
			continue;
		if (!inside)
			inside = plane_inside_new(&all[other]);
		if (is_beside(&all[other], inside, &d->r, at))
			keep_nearest(&met[k], &line, off, other);
	}
}

GArray *plane_meet(const struct plane_draft *all, uint32_t count, uint32_t number, GArray *ret_met)
{
	const struct plane_draft *d = &all[number];
	g_autofree struct met *met = g_new0(struct met, d->vertex->len + 1);
	GArray *to = g_array_new(FALSE, FALSE, sizeof(place));
	for (uint32_t n = 0; n < count; n++)
		find_met(all, number, n, met);
	for (guint k = 0; k < d->vertex->len; k++) {
		place at;
		memcpy(at, g_array_index(d->vertex, place, k), sizeof at);
		if (met[k].count)
			move_vertex(&met[k], d->spacing_m, at, at);
		g_array_append_vals(to, at, 1);
		g_array_append_val(ret_met, met[k].planes);
	}
	return to;
}

/* ---- few vertices ---- */

static void prune_ring(
	const struct plane_draft *d, const struct plane_ring *r, GArray *vertex, GArray *met)
{
	const place *p = (const place *)(void *)d->vertex->data + r->first;
	guint from = vertex->len;
	for (uint32_t k = 0; k < r->count; k++) {
		const float *before = vertex->len > from
					      ? g_array_index(vertex, place, vertex->len - 1)
					      : p[r->count - 1];
		if (off_line(before, p[(k + 1) % r->count], p[k]) < PRUNE_M)
			continue;
		g_array_append_vals(vertex, p[k], 1);
		g_array_append_vals(met, &g_array_index(d->met, struct plane_met, r->first + k), 1);
	}
}

void plane_prune(struct plane_draft *d)
{
	GArray *ring = g_array_new(FALSE, FALSE, sizeof(struct plane_ring)),
	       *vertex = g_array_new(FALSE, FALSE, sizeof(place)),
	       *met = g_array_new(FALSE, FALSE, sizeof(struct plane_met));
	for (guint n = 0; n < d->ring->len; n++) {
		const struct plane_ring *r = &g_array_index(d->ring, struct plane_ring, n);
		struct plane_ring left = { vertex->len, 0 };
		prune_ring(d, r, vertex, met);
		left.count = vertex->len - left.first;
		if (left.count >= 3) {
			g_array_append_val(ring, left);
			continue;
		}
		g_array_set_size(vertex, left.first);
		g_array_set_size(met, left.first);
	}
	g_array_unref(d->ring);
	g_array_unref(d->vertex);
	g_array_unref(d->met);
	d->ring = ring;
	d->vertex = vertex;
	d->met = met;
}
