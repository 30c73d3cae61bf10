#include "process/line-grow.h"
#include "process/vector3.h"
#include <string.h>

/* Around a seed, those of no direction must be so many to tell one. */
#define SEED_PLACES 6
#define NEARBY_MOST 400
/* So many of these are tried as the way ahead, those that are not too near. */
#define TRIES     24
#define FAR_SHARE 0.4f
/* It is fitted anew when it is so much longer than at the last time. */
#define LONGER 1.2

struct line_grower {
	char *places;
	size_t stride;
	struct cloud_view view;
	struct cloud_cells cells;
	double gap_m, turn_cos;
	/* Of the line that grows. */
	struct line_run run;
	struct line_sums sums;
	double middle[3]; /* sums are of what is around it */
};

line_grower *line_grower_new(
	void *places, uint32_t count, size_t stride, double gap_m, double turn_cos)
{
	line_grower *g = g_new0(line_grower, 1);
	g->places = places;
	g->stride = stride;
	g->gap_m = gap_m;
	g->turn_cos = turn_cos;
	g->view = (struct cloud_view){ .first = places, .count = count, .stride = stride };
	g->run.found = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	cloud_cells_init(&g->cells, &g->view, (float)LINE_GROW_REACH_M, NULL);
	return g;
}

void line_grower_free(line_grower *g)
{
	if (!g)
		return;
	cloud_cells_clear(&g->cells);
	g_array_unref(g->run.found);
	g_free(g);
}

void line_grower_visit(const line_grower *g, const double at[3], double radius_m,
	void (*visit)(uint32_t place, const float off[3], void *data), void *data)
{
	cloud_cells_visit(&g->cells, at, (float)radius_m, UINT32_MAX, visit, data);
}

static struct line_place *place_at(const line_grower *g, uint32_t i)
{
	return (struct line_place *)(void *)(g->places + (size_t)i * g->stride);
}

static bool has_way(const struct line_place *p)
{
	return p->along[0] != 0 || p->along[1] != 0 || p->along[2] != 0;
}

static void add_sum(line_grower *g, const struct line_place *p)
{
	double off[3];
	for (int k = 0; k < 3; k++)
		off[k] = p->at[k] - g->middle[k];
	line_sums_add(&g->sums, off, (double)p->weight);
}

/* Anew through all that was found; the ends stay where they are. */
static void fit(line_grower *g)
{
	struct line_run *r = &g->run;
	struct straight line;
	double from[3], to[3];
	if (!line_sums_fit(&g->sums, &line, NULL))
		return;
	for (int k = 0; k < 3; k++)
		line.at[k] += g->middle[k];
	straight_place(&r->line, r->from_m, from);
	straight_place(&r->line, r->to_m, to);
	r->line = line;
	r->from_m = straight_along(&line, from);
	r->to_m = straight_along(&line, to);
	if (r->from_m > r->to_m) {
		double swap = r->from_m;
		r->from_m = r->to_m;
		r->to_m = swap;
	}
}

/* Those of no direction around a seed. */
struct nearby {
	line_grower *grower;
	uint32_t count;
	float off[NEARBY_MOST][3];
};

static void add_nearby(uint32_t i, const float off[3], void *data)
{
	struct nearby *n = data;
	const struct line_place *p = place_at(n->grower, i);
	if (n->count < NEARBY_MOST && !p->is_used && !has_way(p))
		memcpy(n->off[n->count++], off, sizeof n->off[0]);
}

static uint32_t count_along(const struct nearby *n, const float along[3], float within_m)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < n->count; i++) {
		float at = vector3_dot(n->off[i], along);
		count += vector3_dot(n->off[i], n->off[i]) - at * at <= within_m * within_m;
	}
	return count;
}

/* The way in which most of those around lie in a row with the seed. */
static bool find_way(const struct nearby *n, double seed_m, float within_m, float ret[3])
{
	uint32_t most = SEED_PLACES - 1, step = n->count / TRIES + 1;
	float far_m = FAR_SHARE * (float)seed_m;
	for (uint32_t i = 0; i < n->count; i += step) {
		float along[3] = { n->off[i][0], n->off[i][1], n->off[i][2] };
		if (vector3_length(along) < far_m || !vector3_unit(along))
			continue;
		uint32_t count = count_along(n, along, within_m);
		if (count > most) {
			most = count;
			memcpy(ret, along, sizeof along);
		}
	}
	return most >= SEED_PLACES;
}

static bool begin(line_grower *g, const struct line_place *seed, double seed_m)
{
	struct straight *line = &g->run.line;
	float along[3];
	memcpy(g->middle, seed->at, sizeof g->middle);
	memset(&g->sums, 0, sizeof g->sums);
	memcpy(along, seed->along, sizeof along);
	if (!has_way(seed)) {
		struct nearby n = { .grower = g };
		double radius_m = fmin(seed_m, LINE_GROW_REACH_M);
		line_grower_visit(g, seed->at, radius_m, add_nearby, &n);
		if (!find_way(&n, radius_m, seed->within_m, along))
			return false;
	}
	for (int k = 0; k < 3; k++) {
		line->at[k] = seed->at[k];
		line->along[k] = (double)along[k];
	}
	return true;
}

static void take(uint32_t i, const float off[3], void *data)
{
	line_grower *g = data;
	struct line_run *r = &g->run;
	struct line_place *p = place_at(g, i);
	double cosine = 0, at;
	(void)off;
	for (int k = 0; k < 3; k++)
		cosine += (double)p->along[k] * r->line.along[k];
	if (p->is_used || (has_way(p) && fabs(cosine) < g->turn_cos) ||
		straight_off(&r->line, p->at) > (double)p->within_m)
		return;
	at = straight_along(&r->line, p->at);
	if (at < r->from_m - g->gap_m || at > r->to_m + g->gap_m)
		return;
	p->is_used = true;
	add_sum(g, p);
	g_array_append_val(r->found, i);
	r->from_m = fmin(r->from_m, at);
	r->to_m = fmax(r->to_m, at);
}

bool line_grower_grow(line_grower *g, uint32_t seed, double seed_m, struct line_run *ret)
{
	struct line_run *r = &g->run;
	struct line_place *p = place_at(g, seed);
	double fitted_m = 0;
	g_array_set_size(r->found, 0);
	if (!begin(g, p, seed_m)) {
		p->is_used = true;
		return false;
	}
	r->from_m = r->to_m = straight_along(&r->line, p->at);
	for (double before = -1; r->to_m - r->from_m > before;) {
		before = r->to_m - r->from_m;
		for (int end = 0; end < 2; end++) {
			double at[3];
			straight_place(&r->line, end ? r->to_m : r->from_m, at);
			line_grower_visit(g, at, LINE_GROW_REACH_M, take, g);
		}
		if (r->to_m - r->from_m > LONGER * fitted_m) {
			fitted_m = r->to_m - r->from_m;
			fit(g);
		}
	}
	p->is_used = true;
	fit(g);
	*ret = *r;
	return true;
}
