/* compare-scans SITE-A SITE-B: compares the first scans of two sites, which were made of the same place with the same head, cell by cell, and prints
 * how many are equal. Two scans never cast the same beams: each beam goes to the cell that it meets, and a cell's beams lie somewhere else in it each
 * time. So a cell is equal when its range is within TOLERANCE of the other's, or of what the other has within a cell around it: where a surface is seen
 * edge-on, or ends. What one has and the other has not is never equal. */
#include "acquire/scan.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define TOLERANCE_M 0.01

static panorama *load(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open_existing(path, &error);
	panorama *p = s ? scan_load(s, 1, true, &error) : NULL;
	if (!p)
		g_printerr("compare-scans: %s\n", error->message);
	return p;
}

static float at(const panorama *p, int column, int row)
{
	int n = (int)p->desc.columns;
	return p->range_m[(size_t)row * n + (size_t)((column + n) % n)];
}

static bool is_measured(const panorama *p, int column, int row)
{
	return at(p, column, row) > 0;
}

/* Within what the other has around there. */
static bool is_near(const panorama *other, int column, int row, float range_m)
{
	float least = INFINITY, most = 0;
	for (int r = MAX(row - 1, 0); r <= MIN(row + 1, (int)other->desc.rows - 1); r++)
		for (int c = column - 1; c <= column + 1; c++)
			if (is_measured(other, c, r)) {
				least = fminf(least, at(other, c, r));
				most = fmaxf(most, at(other, c, r));
			}
	return range_m >= least - TOLERANCE_M && range_m <= most + TOLERANCE_M;
}

int main(int argc, char **argv)
{
	g_autoptr(panorama) a = argc == 3 ? load(argv[1]) : NULL, b = a ? load(argv[2]) : NULL;
	if (!b || a->desc.columns != b->desc.columns || a->desc.rows != b->desc.rows)
		return 1;
	uint64_t both = 0, only_a = 0, only_b = 0, within = 0, equal = 0;
	for (int row = 0; row < (int)a->desc.rows; row++)
		for (int column = 0; column < (int)a->desc.columns; column++) {
			bool in_a = is_measured(a, column, row), in_b = is_measured(b, column, row);
			only_a += in_a && !in_b;
			only_b += in_b && !in_a;
			if (!in_a || !in_b)
				continue;
			both++;
			bool same = fabsf(at(a, column, row) - at(b, column, row)) <= TOLERANCE_M;
			within += same;
			equal += same || is_near(b, column, row, at(a, column, row));
		}
	uint64_t all = both + only_a + only_b;
	printf("%.4f %% of %lu cells are equal; %.2f %% within 10 mm in the cell itself, %lu only "
	       "in the first, %lu only in the second\n",
		100.0 * (double)equal / (double)MAX(all, 1), (unsigned long)all,
		100.0 * (double)within / (double)MAX(all, 1), (unsigned long)only_a,
		(unsigned long)only_b);
	return 0;
}
