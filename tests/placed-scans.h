#ifndef TESTS_PLACED_SCANS_H
#define TESTS_PLACED_SCANS_H
/* Drafts of simulated sites as grids, with where they really stand. Made once per program and description. */
#include "process/pair.h"
#include "tests/simulated.h"
#include <string.h>

struct placed {
	range_grid *grid;
	struct pose pose; /* scanner to site */
};

static inline range_grid *draft_of(const char *description)
{
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	g_autoptr(GError) error = NULL;
	uint32_t number = simulated_draft(path, description);
	g_autoptr(site) s = site_open(path, &error);
	g_autoptr(panorama) p = scan_load(s, number, false, &error);
	g_assert_no_error(error);
	return range_grid_from_panorama(p);
}

/* what: "court?seed=9&station=2"; the lidar is quick and its beams are thin. */
static inline const struct placed *placed_scan(const char *what)
{
	static GHashTable *known;
	if (!known)
		known = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	struct placed *p = g_hash_table_lookup(known, what);
	if (p)
		return p;
	g_autofree char *description =
		g_strconcat(what, "&ares=720&camera=none&divergence_mrad=0", NULL);
	p = g_new(struct placed, 1);
	*p = (struct placed){ draft_of(description), simulated_pose(description) };
	g_hash_table_insert(known, g_strdup(what), p);
	return p;
}

/* All that aligning needs of it. */
static inline const pair_scan *pair_scan_of(const char *what)
{
	static GHashTable *known;
	if (!known)
		known = g_hash_table_new_full(
			g_str_hash, g_str_equal, g_free, (GDestroyNotify)pair_scan_free);
	pair_scan *s = g_hash_table_lookup(known, what);
	if (!s) {
		s = pair_scan_new(placed_scan(what)->grid);
		g_hash_table_insert(known, g_strdup(what), s);
	}
	return s;
}

/* How far a pose between b and a is from the true one. */
static inline struct pose pose_off(
	const struct placed *a, const struct placed *b, const struct pose *pose)
{
	struct pose right = pose_between(&a->pose, &b->pose);
	return pose_between(&right, pose);
}

/* What a scanner sees in a straight corridor without ends, 3 m wide and 2.7 m high, wherever along it it stands. */
static inline range_grid *corridor_grid(void)
{
	enum { COLUMNS = 360, ROWS = 90, CELLS = COLUMNS * ROWS };
	g_autofree double *xyz = g_new0(double, 3 * CELLS);
	g_autofree uint8_t *cell = g_malloc(CELLS);
	g_autoptr(GError) error = NULL;
	for (int i = 0; i < CELLS; i++) {
		double azimuth = (i % COLUMNS + 0.5) * G_PI / 180,
		       elevation = (45 - i / COLUMNS - 0.5) * G_PI / 180;
		double d[3] = { cos(elevation) * sin(azimuth), cos(elevation) * cos(azimuth),
			sin(elevation) };
		double range = fmin(1.5 / fmax(fabs(d[0]), 1e-9),
			(d[2] > 0 ? 1.2 : 1.5) / fmax(fabs(d[2]), 1e-9));
		cell[i] = range < 30 ? CELL_MEASURED : CELL_NO_RETURN;
		for (int k = 0; k < 3; k++)
			xyz[k * CELLS + i] = range < 30 ? range * d[k] : 0;
	}
	struct range_grid_desc desc = { .columns = COLUMNS,
		.rows = ROWS,
		.x_m = xyz,
		.y_m = xyz + CELLS,
		.z_m = xyz + 2 * CELLS,
		.cell = cell };
	range_grid *g = range_grid_new(&desc, &error);
	g_assert_no_error(error);
	return g;
}

#endif
