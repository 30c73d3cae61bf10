#include "process/plan.h"
#include <stdlib.h>
#include <string.h>

#define TURNS     120
#define FACING    (9 * G_PI / 180) /* headings this near may be one surface */
#define CHANNELS  4
#define SHIFT_M   0.5f
#define RISE_GATE 1.0f /* scanners stand on different ground */

/* Votes for shifts, one sheet for each quarter of headings: a shift that lays only one wall on another, which any slide along
 * the wall does, must not win over one that fits several ways. */
struct ballot {
	uint32_t columns; /* in both directions */
	float half_m;
	float *votes, *sum; /* CHANNELS sheets; one */
};

struct rotated {
	float x, y, heading, low, high, weight;
};

static float lesser(float a, float b) /* inline, as fminf is not */
{
	return a < b ? a : b;
}

static float greater(float a, float b)
{
	return a > b ? a : b;
}

static void vote_pair(struct ballot *k, float *sheet, const struct plan_edge *a,
	const struct rotated *b, float rise)
{
	float x = a->x_m - b->x + k->half_m, y = a->y_m - b->y + k->half_m;
	if (!(x >= 0 && y >= 0 && x < 2 * k->half_m && y < 2 * k->half_m))
		return;
	float overlap =
		lesser(a->high_m, b->high + rise) - greater(a->low_m, b->low + rise) + RISE_GATE;
	float votes = lesser(overlap, lesser(a->weight, b->weight));
	if (votes > 0)
		sheet[(size_t)(y * (1 / SHIFT_M)) * k->columns + (size_t)(x * (1 / SHIFT_M))] +=
			votes;
}

static size_t first_at(const struct plan *a, float heading)
{
	size_t low = 0, high = a->edges;
	while (low < high) {
		size_t middle = (low + high) / 2;
		if (a->edge[middle].heading_rad < heading)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static void vote_range(struct ballot *k, const struct plan *a, const struct rotated *b, float rise,
	float from, float to)
{
	size_t sheet = (size_t)k->columns * k->columns;
	for (size_t i = first_at(a, from); i < a->edges && a->edge[i].heading_rad < to; i++) {
		int channel = (int)(a->edge[i].heading_rad * (float)(CHANNELS / (2 * G_PI)));
		vote_pair(k, k->votes + MIN(channel, CHANNELS - 1) * sheet, &a->edge[i], b, rise);
	}
}

static void vote_turn(
	struct ballot *k, const struct plan *a, const struct plan *b, float turn, float rise)
{
	const float full = (float)(2 * G_PI), gate = (float)FACING;
	float c = cosf(turn), s = sinf(turn);
	memset(k->votes, 0, sizeof *k->votes * CHANNELS * k->columns * k->columns);
	for (size_t i = 0; i < b->edges; i++) {
		const struct plan_edge *e = &b->edge[i];
		float heading = e->heading_rad + turn;
		heading -= heading >= full ? full : 0;
		struct rotated r = { c * e->x_m - s * e->y_m, s * e->x_m + c * e->y_m, heading,
			e->low_m, e->high_m, e->weight };
		vote_range(k, a, &r, rise, heading - gate, heading + gate);
		if (heading < gate)
			vote_range(k, a, &r, rise, heading + full - gate, full + 1);
		if (heading > full - gate)
			vote_range(k, a, &r, rise, -1, heading - full + gate);
	}
}

/* Sums of 3 by 3 cells, then square roots over the sheets. */
static void count_votes(struct ballot *k)
{
	size_t n = k->columns, sheet = n * n;
	memset(k->sum, 0, sheet * sizeof *k->sum);
	g_autofree float *row = g_new0(float, n);
	for (int channel = 0; channel < CHANNELS; channel++) {
		const float *v = k->votes + channel * sheet;
		for (size_t r = 1; r + 1 < n; r++) {
			for (size_t c = 0; c < n; c++)
				row[c] = v[(r - 1) * n + c] + 2 * v[r * n + c] + v[(r + 1) * n + c];
			for (size_t c = 1; c + 1 < n; c++)
				k->sum[r * n + c] += sqrtf(row[c - 1] + 2 * row[c] + row[c + 1]);
		}
	}
}

/* The best shifts so far, as a heap with the worst on top. */
struct best {
	struct plan_shift *shift;
	size_t count, max;
};

static void best_sink(struct best *b, size_t at)
{
	for (size_t child; (child = 2 * at + 1) < b->count; at = child) {
		if (child + 1 < b->count && b->shift[child + 1].votes < b->shift[child].votes)
			child++;
		if (b->shift[at].votes <= b->shift[child].votes)
			return;
		struct plan_shift swap = b->shift[at];
		b->shift[at] = b->shift[child];
		b->shift[child] = swap;
	}
}

static void best_add(struct best *b, const struct plan_shift *s)
{
	if (b->count == b->max) {
		if (s->votes <= b->shift[0].votes)
			return;
		b->shift[0] = *s;
		best_sink(b, 0);
		return;
	}
	size_t at = b->count++;
	for (; at > 0 && b->shift[(at - 1) / 2].votes > s->votes; at = (at - 1) / 2)
		b->shift[at] = b->shift[(at - 1) / 2];
	b->shift[at] = *s;
}

static bool is_peak(const struct ballot *k, size_t r, size_t c)
{
	size_t n = k->columns;
	float v = k->sum[r * n + c];
	for (size_t i = r - 1; i <= r + 1; i++)
		for (size_t j = c - 1; j <= c + 1; j++) {
			float other = k->sum[i * n + j];
			bool before = i < r || (i == r && j < c);
			if (other > v || (before && other == v))
				return false;
		}
	return v > 0;
}

static void take_peaks(const struct ballot *k, float turn, double distance_max_m, struct best *best)
{
	size_t n = k->columns;
	for (size_t r = 2; r + 2 < n; r++)
		for (size_t c = 2; c + 2 < n; c++) {
			float v = k->sum[r * n + c];
			if (best->count == best->max && v <= best->shift[0].votes)
				continue;
			struct plan_shift s = { .turn_rad = turn,
				.x_m = (c + 0.5f) * SHIFT_M - k->half_m,
				.y_m = (r + 0.5f) * SHIFT_M - k->half_m,
				.votes = v };
			if (hypotf(s.x_m, s.y_m) <= distance_max_m && is_peak(k, r, c))
				best_add(best, &s);
		}
}

static int by_votes(const void *a, const void *b)
{
	const struct plan_shift *x = a, *y = b;
	if (x->votes != y->votes)
		return x->votes < y->votes ? 1 : -1;
	if (x->turn_rad != y->turn_rad)
		return x->turn_rad > y->turn_rad ? 1 : -1;
	return x->x_m != y->x_m ? (x->x_m > y->x_m) - (x->x_m < y->x_m)
				: (x->y_m > y->y_m) - (x->y_m < y->y_m);
}

size_t plan_match(const struct plan *a, const struct plan *b, double distance_max_m,
	struct plan_shift *ret, size_t max)
{
	struct ballot k = { .columns = 2 * (uint32_t)ceil(distance_max_m / SHIFT_M) + 8 };
	k.half_m = k.columns * SHIFT_M / 2;
	size_t sheet = (size_t)k.columns * k.columns;
	g_autofree float *votes = g_new(float, CHANNELS *sheet);
	g_autofree float *sum = g_new(float, sheet);
	k.votes = votes;
	k.sum = sum;
	struct best best = { ret, 0, max };
	for (int i = 0; i < TURNS && a->edges && b->edges; i++) {
		float turn = (float)(i * 2 * G_PI / TURNS);
		vote_turn(&k, a, b, turn, a->ground_m - b->ground_m);
		count_votes(&k);
		take_peaks(&k, turn, distance_max_m, &best);
	}
	qsort(ret, best.count, sizeof *ret, by_votes);
	for (size_t i = 0; i < best.count; i++)
		ret[i].z_m = plan_rise(a, b, &ret[i]);
	return best.count;
}
