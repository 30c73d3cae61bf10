/* compare-scans SITE-A SITE-B: compares the first scans of two sites, made of the same place with the same head, cell by cell, and prints how many are
 * equal.
 *
 * Two scans never cast the same beams, and each calls the instant at which it saw its home slot azimuth zero: one that is told of the slot later
 * is turned by a little, as a whole. That angle is found first, and told. Then each measured beam of the first is looked up in the second: it
 * is equal when its range is within TOLERANCE of the range there, or of what lies within a cell around, where a surface is seen edge-on or
 * ends. What one has and the other has not is never equal. Cells are counted apart beside which, in one of both, a surface ends: there a beam
 * that is half a cell beside hits another surface, in two scans of one process too. */
#include "acquire/scan.h"
#include <math.h>
#include <stdio.h>

#define TOLERANCE_M 0.01
#define TURN_MAX    (3.0 * G_PI / 180)
#define TURN_STEP   (0.01 * G_PI / 180)
#define EDGE        0.1 /* of the range, within two cells around */
#define SPARSE      17  /* every so manieth cell finds the angle */

struct tally {
	uint64_t cells, within, equal, missing, inner, inner_equal;
};

static panorama *load(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(path, &error);
	panorama *p = s ? scan_load(s, 1, true, &error) : NULL;
	if (!p)
		g_printerr("compare-scans: %s\n", error->message);
	return p;
}

static float range_at(const panorama *p, int row, int column)
{
	int n = (int)p->desc.columns;
	return p->range_m[(size_t)row * n + (size_t)((column + n) % n)];
}

static bool is_at_edge(const panorama *p, int row, int column)
{
	float least = INFINITY, most = 0;
	for (int r = MAX(row - 2, 0); r <= MIN(row + 2, (int)p->desc.rows - 1); r++)
		for (int c = column - 2; c <= column + 2; c++) {
			least = fminf(least, range_at(p, r, c));
			most = fmaxf(most, range_at(p, r, c));
		}
	return most - least > EDGE * least;
}

static bool is_among(const panorama *p, int row, int column, float range_m)
{
	float least = INFINITY, most = 0;
	for (int r = MAX(row - 1, 0); r <= MIN(row + 1, (int)p->desc.rows - 1); r++)
		for (int c = column - 1; c <= column + 1; c++)
			if (range_at(p, r, c) > 0) {
				least = fminf(least, range_at(p, r, c));
				most = fmaxf(most, range_at(p, r, c));
			}
	return range_m >= least - TOLERANCE_M && range_m <= most + TOLERANCE_M;
}

static void compare_cell(
	const panorama *a, const panorama *b, size_t i, double turn_rad, struct tally *t)
{
	int row = (int)(i / a->desc.columns);
	double across =
		(double)(i % a->desc.columns) + 0.5 + a->azimuth_offset[i] / PANORAMA_OFFSET_ONE;
	int column = (int)floor(across + turn_rad / a->column_rad);
	float range_m = a->range_m[i], there_m = range_at(b, row, column);
	if (range_m <= 0)
		return;
	t->cells++;
	t->missing += there_m <= 0;
	t->within += there_m > 0 && fabsf(there_m - range_m) <= TOLERANCE_M;
	bool equal = there_m > 0 && is_among(b, row, column, range_m),
	     inner = !is_at_edge(a, row, (int)(i % a->desc.columns)) && !is_at_edge(b, row, column);
	t->equal += equal;
	t->inner += inner;
	t->inner_equal += inner && equal;
}

static struct tally compare(const panorama *a, const panorama *b, double turn_rad, size_t every)
{
	struct tally t = { 0 };
	for (size_t i = 0; i < (size_t)a->desc.columns * a->desc.rows; i += every)
		compare_cell(a, b, i, turn_rad, &t);
	return t;
}

/* The angle that most cells agree about. */
static double find_turn(const panorama *a, const panorama *b)
{
	uint64_t most = 0;
	double best = 0;
	for (double turn = -TURN_MAX; turn <= TURN_MAX; turn += TURN_STEP) {
		struct tally t = compare(a, b, turn, SPARSE);
		if (t.within > most) {
			most = t.within;
			best = turn;
		}
	}
	return best;
}

int main(int argc, char **argv)
{
	g_autoptr(panorama) a = argc == 3 ? load(argv[1]) : NULL, b = a ? load(argv[2]) : NULL;
	if (!b || a->desc.columns != b->desc.columns || a->desc.rows != b->desc.rows)
		return 1;
	double turn = find_turn(a, b);
	struct tally t = compare(a, b, turn, 1);
	double all = (double)MAX(t.cells, 1);
	double inner = 100 * (double)t.inner_equal / (double)MAX(t.inner, 1);
	printf("%.2f %% of %lu cells that no edge is beside are equal, %.2f %% of all %lu (%.2f %% "
	       "within "
	       "10 mm in the cell itself, %.2f %% not in the second), turned by %.2f degrees\n",
		inner, (unsigned long)t.inner, 100 * (double)t.equal / all, (unsigned long)t.cells,
		100 * (double)t.within / all, 100 * (double)t.missing / all, turn * 180 / G_PI);
	return 0;
}
