#include "process/next-station.h"
#include <math.h>
#include <string.h>

#define CELLS_MAX 1024
#define BINS      64
#define BIN_M     0.25
/* Of a head on its tripod above the floor, where a floor is not seen below it. */
#define HEAD_M 1.6
/* Heights above the floor that stop the sight of a head, and that nobody can stand in. */
#define WALL_LOW_M  0.6
#define WALL_HIGH_M 2.0
#define WALL_BINS   3
/* A floor may rise and fall so much from one station to the next. */
#define FLOOR_BAND_M 0.75
/* A tripod needs so much room. */
#define CLEARANCE_M 0.7
/* Below a head is what it cannot see. */
#define BLIND_M 2.5
/* Stations further from all others are hard to align, and nearer ones bring little. */
#define APART_MOST_M  12.0
#define APART_LEAST_M 1.5
/* Into the unknown nobody knows how far one sees. */
#define GUESS_M        4.0
#define RAYS           240
#define KNOWN_LEAST    0.45
#define KNOWN_NEEDED   0.25
#define FAR_M          20.0
#define CANDIDATES_MAX 2500

enum cell { UNKNOWN, OPEN, FLOOR, WALL };

struct station_plan {
	double low_m[3], cell_m;
	uint32_t columns, rows;
	/* Of each cell, from the lowest bin: a bin with one point, and one with more, which is no stray one. */
	uint64_t *once, *twice;
};

station_plan *station_plan_new(const double low_m[3], const double high_m[3])
{
	station_plan *p = g_new0(station_plan, 1);
	double wide = fmax(high_m[0] - low_m[0], 1), deep = fmax(high_m[1] - low_m[1], 1);
	memcpy(p->low_m, low_m, sizeof p->low_m);
	p->cell_m = fmax(NEXT_STATION_CELL_M, fmax(wide, deep) / CELLS_MAX);
	p->columns = (uint32_t)ceil(wide / p->cell_m);
	p->rows = (uint32_t)ceil(deep / p->cell_m);
	p->once = g_new0(uint64_t, (size_t)p->columns * p->rows);
	p->twice = g_new0(uint64_t, (size_t)p->columns * p->rows);
	return p;
}

void station_plan_free(station_plan *p)
{
	if (!p)
		return;
	g_free(p->once);
	g_free(p->twice);
	g_free(p);
}

static bool cell_at(const station_plan *p, double x_m, double y_m, size_t *ret)
{
	double x = floor((x_m - p->low_m[0]) / p->cell_m);
	double y = floor((y_m - p->low_m[1]) / p->cell_m);
	if (!(x >= 0 && y >= 0 && x < p->columns && y < p->rows))
		return false;
	*ret = (size_t)y * p->columns + (size_t)x;
	return true;
}

void station_plan_add(station_plan *p, const double position_m[3])
{
	size_t cell;
	double bin = floor((position_m[2] - p->low_m[2]) / BIN_M);
	if (!cell_at(p, position_m[0], position_m[1], &cell) || !(bin >= 0 && bin < BINS))
		return;
	uint64_t bit = UINT64_C(1) << (unsigned)bin;
	p->twice[cell] |= p->once[cell] & bit;
	p->once[cell] |= bit;
}

/* ---- what the cells are ---- */

struct survey {
	const station_plan *plan;
	const double *station_m;
	size_t stations;
	double *floor_m; /* below each station */
	uint8_t *cell;   /* enum cell */
	uint32_t *mark;  /* the last look that counted the cell */
	uint32_t look;
};

static double bin_m(const station_plan *p, unsigned bin)
{
	return p->low_m[2] + (bin + 0.5) * BIN_M;
}

/* The lowest surface within a few metres, where it is as low as a tripod is high. */
static double floor_below(const station_plan *p, const double head_m[3])
{
	int reach = (int)ceil(BLIND_M * 1.6 / p->cell_m);
	unsigned votes[BINS] = { 0 };
	for (int dy = -reach; dy <= reach; dy++)
		for (int dx = -reach; dx <= reach; dx++) {
			size_t cell;
			if (!cell_at(p, head_m[0] + dx * p->cell_m, head_m[1] + dy * p->cell_m,
				    &cell) ||
				!p->once[cell])
				continue;
			votes[__builtin_ctzll(p->twice[cell] ? p->twice[cell] : p->once[cell])]++;
		}
	double best_m = head_m[2] - HEAD_M;
	unsigned most = 3;
	for (unsigned bin = 0; bin < BINS; bin++) {
		double below_m = head_m[2] - bin_m(p, bin);
		if (votes[bin] > most && below_m > 0.8 && below_m < 3) {
			most = votes[bin];
			best_m = bin_m(p, bin);
		}
	}
	return best_m;
}

static double floor_near(const struct survey *s, double x_m, double y_m, double *ret_distance_m)
{
	double best = INFINITY, floor_m = 0;
	for (size_t i = 0; i < s->stations; i++) {
		double d = hypot(x_m - s->station_m[3 * i], y_m - s->station_m[3 * i + 1]);
		if (d < best) {
			best = d;
			floor_m = s->floor_m[i];
		}
	}
	*ret_distance_m = best;
	return floor_m;
}

static uint64_t bins_between(const station_plan *p, double low_m, double high_m)
{
	double from = floor((low_m - p->low_m[2]) / BIN_M);
	double to = floor((high_m - p->low_m[2]) / BIN_M);
	uint64_t bits = 0;
	for (double b = fmax(from, 0); b <= to && b < BINS; b++)
		bits |= UINT64_C(1) << (unsigned)b;
	return bits;
}

static enum cell cell_is(const station_plan *p, size_t cell, double floor_m)
{
	uint64_t walls = bins_between(p, floor_m + WALL_LOW_M, floor_m + WALL_HIGH_M);
	if (__builtin_popcountll(p->once[cell] & walls) >= WALL_BINS)
		return WALL;
	if (p->once[cell] & bins_between(p, floor_m - FLOOR_BAND_M, floor_m + FLOOR_BAND_M / 2))
		return FLOOR;
	return p->once[cell] ? OPEN : UNKNOWN;
}

/* Beams lie metres apart on a floor that is far away; what lies between two of them was seen. */
static void close_gaps(struct survey *s)
{
	const station_plan *p = s->plan;
	g_autofree uint8_t *was = g_memdup2(s->cell, (size_t)p->columns * p->rows);
	for (uint32_t y = 1; y + 1 < p->rows; y++)
		for (uint32_t x = 1; x + 1 < p->columns; x++) {
			const uint8_t *c = was + (size_t)y * p->columns + x;
			int floors = 0, known = 0;
			if (*c != UNKNOWN)
				continue;
			for (int k = 0; k < 9; k++) {
				uint8_t other = c[(k / 3 - 1) * (int)p->columns + k % 3 - 1];
				known += other != UNKNOWN;
				floors += other == FLOOR;
			}
			if (known >= 3)
				s->cell[(size_t)y * p->columns + x] = floors ? FLOOR : OPEN;
		}
}

static void name_cells(struct survey *s)
{
	const station_plan *p = s->plan;
	for (size_t i = 0; i < s->stations; i++)
		s->floor_m[i] = floor_below(p, s->station_m + 3 * i);
	for (uint32_t y = 0; y < p->rows; y++)
		for (uint32_t x = 0; x < p->columns; x++) {
			size_t cell = (size_t)y * p->columns + x;
			double distance_m;
			double floor_m = floor_near(s, p->low_m[0] + (x + 0.5) * p->cell_m,
				p->low_m[1] + (y + 0.5) * p->cell_m, &distance_m);
			s->cell[cell] = (uint8_t)cell_is(p, cell, floor_m);
			if (s->cell[cell] == UNKNOWN && distance_m < BLIND_M)
				s->cell[cell] = FLOOR;
		}
	close_gaps(s);
	close_gaps(s);
}

/* ---- looking from a place ---- */

static void look_along(
	struct survey *s, double x_m, double y_m, double angle, uint32_t *fresh, uint32_t *known)
{
	const station_plan *p = s->plan;
	double step_m = p->cell_m * 0.5, guessed_m = 0;
	double dx = cos(angle) * step_m, dy = sin(angle) * step_m;
	for (double gone_m = 0; gone_m < NEXT_STATION_RANGE_M; gone_m += step_m) {
		size_t cell;
		x_m += dx;
		y_m += dy;
		if (!cell_at(p, x_m, y_m, &cell))
			return;
		bool again = s->mark[cell] == s->look;
		s->mark[cell] = s->look;
		if (s->cell[cell] == UNKNOWN) {
			guessed_m += step_m;
			*fresh += !again;
			if (guessed_m > GUESS_M)
				return;
			continue;
		}
		*known += !again;
		if (s->cell[cell] == WALL)
			return;
	}
}

static void look_from(struct survey *s, double x_m, double y_m, struct next_station *ret)
{
	uint32_t fresh = 0, known = 0;
	s->look++;
	for (int i = 0; i < RAYS; i++)
		look_along(s, x_m, y_m, 2 * G_PI * i / RAYS, &fresh, &known);
	ret->x_m = x_m;
	ret->y_m = y_m;
	ret->new_m2 = fresh * s->plan->cell_m * s->plan->cell_m;
	ret->known_share = known / fmax(fresh + known, 1);
}

static bool has_room(const struct survey *s, double x_m, double y_m)
{
	const station_plan *p = s->plan;
	int reach = (int)ceil(CLEARANCE_M / p->cell_m);
	for (int dy = -reach; dy <= reach; dy++)
		for (int dx = -reach; dx <= reach; dx++) {
			size_t cell;
			if (!cell_at(p, x_m + dx * p->cell_m, y_m + dy * p->cell_m, &cell) ||
				s->cell[cell] != FLOOR)
				return false;
		}
	return true;
}

/* Little that is known costs more than little that is new, for a scan that does not fit brings nothing. Far is a long way to carry a
 * tripod, and scans from nearby look alike. */
static double worth(const struct next_station *n, double distance_m)
{
	return n->new_m2 * fmin(1, n->known_share / KNOWN_LEAST) *
	       (n->known_share >= KNOWN_NEEDED) * exp(-distance_m / FAR_M);
}

static bool find_best(struct survey *s, struct next_station *ret)
{
	const station_plan *p = s->plan;
	double cells = (double)p->columns * p->rows, most = 0;
	uint32_t step = (uint32_t)fmax(2, ceil(sqrt(cells / CANDIDATES_MAX / 4)));
	for (uint32_t y = 0; y < p->rows; y += step)
		for (uint32_t x = 0; x < p->columns; x += step) {
			struct next_station n;
			double x_m = p->low_m[0] + (x + 0.5) * p->cell_m, distance_m;
			double y_m = p->low_m[1] + (y + 0.5) * p->cell_m;
			if (s->cell[(size_t)y * p->columns + x] != FLOOR)
				continue;
			floor_near(s, x_m, y_m, &distance_m);
			if (distance_m < APART_LEAST_M || distance_m > APART_MOST_M ||
				!has_room(s, x_m, y_m))
				continue;
			look_from(s, x_m, y_m, &n);
			double w = n.new_m2 >= NEXT_STATION_LEAST_M2 ? worth(&n, distance_m) : 0;
			if (w > most) {
				most = w;
				*ret = n;
			}
		}
	return most > 0;
}

bool next_station_find(
	const station_plan *p, const double *station_m, size_t stations, struct next_station *ret)
{
	size_t cells = (size_t)p->columns * p->rows;
	g_autofree double *floors = g_new0(double, stations);
	g_autofree uint8_t *cell = g_new0(uint8_t, cells);
	g_autofree uint32_t *mark = g_new0(uint32_t, cells);
	struct survey s = { p, station_m, stations, floors, cell, mark, 0 };
	if (!stations)
		return false;
	name_cells(&s);
	return find_best(&s, ret);
}
