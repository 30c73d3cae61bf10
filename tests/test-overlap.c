/* Which of two scans' points stay: four stations of a simulated hall, with the true poses and normals, against brute force. */
#include "acquire/scan.h"
#include "process/model.h"
#include "process/overlap.h"
#include "sim/truth.h"
#include "tests/simulated.h"
#include <string.h>

#define STATIONS 4
#define NOISE_M  0.012

struct station {
	range_grid *grid;
	scan_geometry geometry; /* from the truth */
	overlap_scan *scan;
	uint8_t *dropped;
};
static struct station stations[STATIONS];

static void scan_into(const char *path, const char *description)
{
	simulated_draft(path, description);
}

static struct pose pose_of(const truth *t)
{
	struct pose p;
	const struct world_station *s = truth_station(t);
	memcpy(p.translation_m, s->position_m, sizeof p.translation_m);
	memcpy(p.rotation, s->rotation, sizeof p.rotation);
	pose_orthonormalise(&p);
	return p;
}

/* What geometry would be without its own errors. */
static void take_geometry(struct station *s, const truth *t, const panorama *p)
{
	size_t n = range_grid_cells(s->grid);
	struct truth_panorama whole = { p->desc.columns, p->desc.rows, p->desc.elevation_max_rad,
		p->desc.elevation_min_rad };
	g_autofree struct truth_cell *cells = g_new0(struct truth_cell, n);
	int16_t(*normal)[2] = g_malloc(n * sizeof *normal);
	float *flat = g_new0(float, n);
	truth_look_around(t, &whole, cells);
	for (size_t i = 0; i < n; i++)
		model_pack_normal(cells[i].normal, normal[i]);
	s->geometry = (scan_geometry){ .count = n, .normal = normal, .plane_error_m = flat };
}

static void load_station(
	struct station *s, const site *at, uint32_t number, const char *description)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(panorama) p = scan_load(at, number, false, &error);
	g_autoptr(truth) t = truth_new(description, &error);
	g_assert_no_error(error);
	s->grid = range_grid_from_panorama(p);
	take_geometry(s, t, p);
	s->scan = overlap_scan_new(number, s->grid, &s->geometry);
	s->scan->pose = pose_of(t);
}

static void mark(struct station *all, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		g_free(all[i].dropped);
		all[i].dropped = g_malloc0(range_grid_cells(all[i].grid));
		for (uint32_t j = 0; j < count; j++)
			if (i != j)
				overlap_mark(all[i].scan, all[j].scan, NULL, all[i].dropped);
	}
}

static void load_stations(void)
{
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	char *description[STATIONS];
	if (stations[0].grid)
		return;
	for (uint32_t i = 0; i < STATIONS; i++) {
		description[i] = g_strdup_printf(
			"hall?seed=3&ares=720&camera=none&divergence_mrad=0&station=%u", i + 1);
		scan_into(path, description[i]);
	}
	g_autoptr(site) at = site_open(path, NULL);
	for (uint32_t i = 0; i < STATIONS; i++)
		load_station(&stations[i], at, i + 1, description[i]);
	for (uint32_t i = 0; i < STATIONS; i++)
		g_free(description[i]);
	mark(stations, STATIONS);
}

/* ---- points in space ---- */

#define CELL_M 0.4

struct kept {
	double at_m[3];
	uint32_t station;
};

/* Lists of points by cell of space. */
struct space {
	GHashTable *cells;
};

static gint64 cell_key(const double at_m[3], int dx, int dy, int dz)
{
	gint64 x = (gint64)floor(at_m[0] / CELL_M) + dx, y = (gint64)floor(at_m[1] / CELL_M) + dy,
	       z = (gint64)floor(at_m[2] / CELL_M) + dz;
	return (x & 0x1FFFFF) << 42 | (y & 0x1FFFFF) << 21 | (z & 0x1FFFFF);
}

static void free_list(gpointer list)
{
	g_array_unref(list);
}

static GArray *space_list(struct space *s, const double at_m[3], bool make)
{
	gint64 key = cell_key(at_m, 0, 0, 0);
	GArray *list = g_hash_table_lookup(s->cells, &key);
	if (!list && make) {
		list = g_array_new(FALSE, FALSE, sizeof(struct kept));
		g_hash_table_insert(s->cells, g_memdup2(&key, sizeof key), list);
	}
	return list;
}

static void place(const struct station *s, size_t i, double ret_m[3])
{
	pose_apply(&s->scan->pose,
		(const double[3]){ s->grid->x_m[i], s->grid->y_m[i], s->grid->z_m[i] }, ret_m);
}

/* which: points that are kept, or all. */
static struct space space_new(bool only_kept)
{
	struct space space = { g_hash_table_new_full(
		g_int64_hash, g_int64_equal, g_free, free_list) };
	for (uint32_t k = 0; k < STATIONS; k++)
		for (size_t i = 0; i < range_grid_cells(stations[k].grid); i++) {
			struct kept p = { .station = k };
			if (!(stations[k].grid->range_m[i] > 0) ||
				(only_kept && stations[k].dropped[i]))
				continue;
			place(&stations[k], i, p.at_m);
			g_array_append_val(space_list(&space, p.at_m, true), p);
		}
	return space;
}

/* Distance of the nearest point, up to CELL_M; of another station than not. */
static double nearest_m(const struct space *s, const double at_m[3], uint32_t not_station)
{
	double best = CELL_M * CELL_M;
	for (int k = 0; k < 27; k++) {
		gint64 key = cell_key(at_m, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
		const GArray *list = g_hash_table_lookup(s->cells, &key);
		for (guint i = 0; list && i < list->len; i++) {
			const struct kept *p = &g_array_index(list, struct kept, i);
			double x = p->at_m[0] - at_m[0], y = p->at_m[1] - at_m[1],
			       z = p->at_m[2] - at_m[2];
			if (p->station != not_station)
				best = fmin(best, x * x + y * y + z * z);
		}
	}
	return sqrt(best);
}

/* ---- tests ---- */

/* Distance of neighbours on the surface: the beams' own, longer where it lies aslant. */
static double spacing_m(const struct station *s, size_t i)
{
	float n[3];
	model_unpack_normal(s->geometry.normal[i], n);
	double cosine =
		fabs(n[0] * s->grid->x_m[i] + n[1] * s->grid->y_m[i] + n[2] * s->grid->z_m[i]) /
		s->grid->range_m[i];
	return range_grid_point_size_m(s->grid, i) / fmax(cosine, 0.2);
}

static void test_no_holes(void)
{
	load_stations();
	struct space kept = space_new(true);
	uint64_t dropped = 0, all = 0, far = 0, very_far = 0;
	for (uint32_t k = 0; k < STATIONS; k++)
		for (size_t i = 0; i < range_grid_cells(stations[k].grid); i++) {
			double at_m[3];
			all += stations[k].grid->range_m[i] > 0;
			if (!stations[k].dropped[i])
				continue;
			dropped++;
			place(&stations[k], i, at_m);
			double patch = spacing_m(&stations[k], i);
			double d = nearest_m(&kept, at_m, STATIONS);
			far += d > patch + 3 * NOISE_M;
			very_far += d > 2 * patch + 5 * NOISE_M;
		}
	g_test_message("%" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT
		       " points dropped; %" G_GUINT64_FORMAT
		       " with nothing kept within a patch, %" G_GUINT64_FORMAT " within two",
		dropped, all, far, very_far);
	g_hash_table_unref(kept.cells);
	g_assert_cmpuint(dropped, >, all / 8);
	g_assert_cmpuint(far, <=, dropped / 1000);
	g_assert_cmpuint(very_far, <=, dropped / 20000);
}

/* In cells of space that several stations saw: what is kept against what the best of them has. */
static void test_density(void)
{
	load_stations();
	struct space kept = space_new(true), all = space_new(false);
	GHashTableIter iter;
	gpointer key, value;
	double best_sum = 0, kept_sum = 0, all_sum = 0;
	uint64_t cells = 0, thin = 0;
	g_hash_table_iter_init(&iter, all.cells);
	while (g_hash_table_iter_next(&iter, &key, &value)) {
		const GArray *list = value, *left = g_hash_table_lookup(kept.cells, key);
		uint32_t of[STATIONS] = { 0 }, best = 0, several = 0;
		for (guint i = 0; i < list->len; i++)
			of[g_array_index(list, struct kept, i).station]++;
		for (uint32_t k = 0; k < STATIONS; k++) {
			best = MAX(best, of[k]);
			several += of[k] >= 5;
		}
		if (several < 2)
			continue;
		cells++;
		best_sum += best;
		all_sum += list->len;
		kept_sum += left ? left->len : 0;
		thin += (left ? left->len : 0) < 0.5 * best;
	}
	g_test_message("%" G_GUINT64_FORMAT
		       " cells seen by several: the best has %.0f, all %.0f, kept %.0f; "
		       "%" G_GUINT64_FORMAT " have less than half of the best",
		cells, best_sum, all_sum, kept_sum, thin);
	g_hash_table_unref(kept.cells);
	g_hash_table_unref(all.cells);
	g_assert_cmpfloat(all_sum, >, 1.3 * best_sum);
	g_assert_cmpfloat(kept_sum, >, 0.9 * best_sum);
	g_assert_cmpfloat(kept_sum, <, 1.15 * best_sum);
	g_assert_cmpuint(thin, <=, cells / 200);
}

/* Scanned twice from the same place: the points of the higher number go, all of them, and none of the lower. */
static void test_same_twice(void)
{
	load_stations();
	const struct station *s = &stations[0];
	size_t n = range_grid_cells(s->grid);
	g_autoptr(overlap_scan) a = overlap_scan_new(7, s->grid, &s->geometry);
	g_autoptr(overlap_scan) b = overlap_scan_new(8, s->grid, NULL);
	g_autofree uint8_t *of_a = g_malloc0(n), *of_b = g_malloc0(n);
	a->pose = b->pose = s->scan->pose;
	overlap_mark(a, b, NULL, of_a);
	overlap_mark(b, a, NULL, of_b);
	size_t a_drops = 0, b_stays = 0;
	for (size_t i = 0; i < n; i++) {
		a_drops += of_a[i];
		b_stays += s->grid->range_m[i] > 0 && !of_b[i];
	}
	/* But for beams that round into the next cell. */
	g_assert_cmpuint(a_drops, <=, n / 2000);
	g_assert_cmpuint(b_stays, <=, n / 2000);
}

/* A wall that faces the scanner, distance_m away, 3 m wide and high. */
static range_grid *wall_grid(double distance_m)
{
	enum { SIDE = 300 };
	struct panorama_desc desc = { 2000, SIDE, -0.5, 0.5 };
	g_autoptr(panorama) p = panorama_new(&desc, NULL);
	for (uint32_t row = 0; row < SIDE; row++)
		for (uint32_t column = 0; column < 2000; column++) {
			double azimuth = (column + 0.5) * 2 * G_PI / 2000;
			float elevation = (float)(0.5 - (row + 0.5) / SIDE);
			float range = (float)(distance_m / (cos(azimuth) * cos(elevation)));
			double across = distance_m * tan(azimuth), up = range * sin(elevation);
			if (cos(azimuth) < 0.1 || fabs(across) > 1.5 || fabs(up) > 1.5)
				range = 0;
			uint16_t intensity = 1;
			panorama_add(p, &azimuth, &elevation, &range, &intensity, 1);
		}
	return range_grid_from_panorama(p);
}

static scan_geometry *flat_geometry(const range_grid *g)
{
	size_t n = range_grid_cells(g);
	int16_t(*normal)[2] = g_malloc(n * sizeof *normal);
	for (size_t i = 0; i < n; i++)
		model_pack_normal((float[3]){ 0, -1, 0 }, normal[i]);
	scan_geometry *s = g_new0(scan_geometry, 1);
	*s = (scan_geometry){ .count = n, .normal = normal, .plane_error_m = g_new0(float, n) };
	return s;
}

static void free_flat(scan_geometry *g)
{
	g_free((void *)g->normal);
	g_free((void *)g->plane_error_m);
	g_free(g);
}

/* a in front of the wall, b nearer; either on the same side, or on the other side of a board of this thickness. */
static size_t share_dropped(double thickness_m, bool other_side)
{
	g_autoptr(range_grid) far = wall_grid(6), near = wall_grid(3);
	scan_geometry *of_far = flat_geometry(far), *of_near = flat_geometry(near);
	g_autoptr(overlap_scan) a = overlap_scan_new(1, far, of_far);
	g_autoptr(overlap_scan) b = overlap_scan_new(2, near, of_near);
	b->pose.translation_m[1] = 3;
	if (other_side)
		b->pose = pose_from_yaw(G_PI, (const double[3]){ 0, 9 + thickness_m, 0 });
	g_autofree uint8_t *dropped = g_malloc0(range_grid_cells(far));
	size_t count = 0;
	overlap_mark(a, b, NULL, dropped);
	for (size_t i = 0; i < range_grid_cells(far); i++)
		count += dropped[i];
	size_t percent = 100 * count / range_grid_count(far);
	free_flat(of_far);
	free_flat(of_near);
	return percent;
}

static void test_board(void)
{
	g_assert_cmpuint(share_dropped(0, false), >=, 97); /* all but the rim */
	g_assert_cmpuint(share_dropped(0.03, true), ==, 0);
}

/* Where the beams of one scan are lost, the other fills in. */
static void test_gap(void)
{
	g_autoptr(range_grid) far = wall_grid(6), near = wall_grid(3);
	g_autoptr(overlap_scan) a = overlap_scan_new(1, far, NULL);
	struct pose ahead = POSE_IDENTITY;
	ahead.translation_m[1] = 3;
	for (size_t i = 0; i < range_grid_cells(near); i++)
		if (fabsf(near->x_m[i]) < 0.2f && near->range_m[i] > 0) {
			near->x_m[i] = near->y_m[i] = near->z_m[i] = near->range_m[i] = 0;
			near->cell[i] = CELL_EMPTY;
		}
	g_autoptr(overlap_scan) b = overlap_scan_new(2, near, NULL);
	b->pose = ahead;
	g_autofree uint8_t *dropped = g_malloc0(range_grid_cells(far));
	overlap_mark(a, b, NULL, dropped);
	for (size_t i = 0; i < range_grid_cells(far); i++) {
		if (!(far->range_m[i] > 0) || fabsf(far->z_m[i]) > 1.3f)
			continue;
		if (fabsf(far->x_m[i]) < 0.18f)
			g_assert_cmpuint(dropped[i], ==, 0);
		else if (fabsf(far->x_m[i]) > 0.22f && fabsf(far->x_m[i]) < 1.4f)
			g_assert_cmpuint(dropped[i], ==, 1);
	}
}

static void free_stations(void)
{
	for (uint32_t i = 0; i < STATIONS; i++) {
		range_grid_free(stations[i].grid);
		overlap_scan_free(stations[i].scan);
		g_free((void *)stations[i].geometry.normal);
		g_free((void *)stations[i].geometry.plane_error_m);
		g_free(stations[i].dropped);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/overlap/no-holes", test_no_holes);
	g_test_add_func("/overlap/density", test_density);
	g_test_add_func("/overlap/same-twice", test_same_twice);
	g_test_add_func("/overlap/board", test_board);
	g_test_add_func("/overlap/gap", test_gap);
	int status = g_test_run();
	free_stations();
	return status;
}
