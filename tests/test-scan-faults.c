/* What goes wrong on the wire, on the stage and at the camera: each fault of the simulator's
 * script, what the scan makes of it and what it says. A scan with a fault must end with the same
 * place in its panorama as the scan without. */
#include "acquire/photos.h"
#include "tests/simulated.h"
#include <math.h>
#include <string.h>

#define HALL "hall?seed=3&ares=360&camera=64x96&drift_ppm=80"
#define COLA "hall?seed=3&lidar=cola&beams=271&camera=none&drift_ppm=80"

#define LD      "hall?seed=3&lidar=ld06&camera=none&drift_ppm=80"
#define RPLIDAR "hall?seed=3&lidar=rplidar-a2&camera=none&drift_ppm=80"

static const struct scene {
	const char *path, *description;
	bool good;
	uint64_t lost_min, lost_max; /* revolutions */
	uint32_t jumps, sessions;
	uint64_t bad_telegrams_min, device_errors_min;
	uint32_t slips_min, bad_frames_min;
	const char *says; /* part of the error, where the scan fails */
} scenes[] = {
	{ "/faults/none", HALL, true, .sessions = 1 },
	{ "/faults/scip/drop-1", HALL "&fault=drop@300", true, 1, 1, .sessions = 1 },
	{ "/faults/scip/drop-2-and-10", HALL "&fault=drop@300x2,drop@900x10", true, 12, 12,
		.sessions = 1 },
	{ "/faults/scip/stall", HALL "&fault=stall@500:0.4", true, 10, 20, .sessions = 1 },
	{ "/faults/scip/stall-long", HALL "&fault=stall@500:5", true, .sessions = 1 },
	{ "/faults/scip/stall-for-good", HALL "&fault=stall@500", true, .sessions = 1 },
	{ "/faults/scip/garble", HALL "&fault=garble@200x3", true, 3, 6, .sessions = 1,
		.bad_telegrams_min = 1 },
	{ "/faults/scip/split", HALL "&fault=split@100:5", true, .sessions = 1 },
	{ "/faults/scip/merge", HALL "&fault=merge@100x20", true, .sessions = 1 },
	{ "/faults/scip/error", HALL "&fault=error@700", true, .sessions = 1 },
	{ "/faults/scip/unplug", HALL "&fault=unplug@700:3", true, .sessions = 1 },
	{ "/faults/scip/unplug-twice", HALL "&fault=unplug@300:1,unplug@1200:8", true,
		.sessions = 1 },
	{ "/faults/scip/unplug-for-good", HALL "&fault=unplug@700:3600", false,
		.says = "the lidar is not there" },
	{ "/faults/scip/codes", HALL "&fault=codes@400x5", true, .sessions = 1 },
	{ "/faults/power", HALL "&fault=power@700", false, .says = "power" },
	{ "/faults/stage-fault", HALL "&fault=stagefault@700", false,
		.says = "the pan stage stopped by itself" },
	{ "/faults/stage-slip", HALL "&fault=slip@700:40", true, .sessions = 1, .slips_min = 1 },
	{ "/faults/camera-bad-frame", HALL "&fault=badframe@500x3", true, .sessions = 1,
		.bad_frames_min = 1 },
	{ "/faults/camera-frame-loss", HALL "&fault=frameloss@600:30", true, .sessions = 1 },
	{ "/faults/camera-gone", HALL "&fault=cameragone@600", true, .sessions = 1 },
	{ "/faults/no-lidar", "hall?lidar=none", false, .says = "the lidar is not there" },
	{ "/faults/cola/none", COLA, true, .sessions = 1 },
	{ "/faults/cola/narrow", COLA "&narrow=1", true, .sessions = 1 },
	{ "/faults/cola/drop-3", COLA "&fault=drop@300x3", true, 3, 3, .sessions = 1 },
	{ "/faults/cola/jump", COLA "&fault=jump@300:7", true, .jumps = 1, .sessions = 1 },
	{ "/faults/cola/packets", COLA "&packet=64", true, .sessions = 1 },
	{ "/faults/cola/error", COLA "&fault=error@700", true, .sessions = 1,
		.device_errors_min = 1 },
	{ "/faults/cola/unplug", COLA "&fault=unplug@700:4", true, .sessions = 1 },
	{ "/faults/cola/stall", COLA "&fault=stall@700:6", true, .sessions = 1 },
	{ "/faults/ld/none", LD, true, .sessions = 1 },
	/* Parts of turns are left on either side of a gap. */
	{ "/faults/ld/drop-3", LD "&fault=drop@300x3", true, 2, 3, .sessions = 1 },
	{ "/faults/ld/garble", LD "&fault=garble@200x3", true, .sessions = 1,
		.bad_telegrams_min = 1 },
	{ "/faults/ld/split-and-merge", LD "&fault=split@100:5,merge@600x20", true, .sessions = 1 },
	{ "/faults/ld/stall", LD "&fault=stall@500:0.4", true, 2, 5, .sessions = 1 },
	{ "/faults/ld/stall-for-good", LD "&fault=stall@500", true, .sessions = 1 },
	{ "/faults/ld/error", LD "&fault=error@700", true, .sessions = 1 },
	{ "/faults/ld/unplug", LD "&fault=unplug@700:3", true, .sessions = 1 },
	{ "/faults/rplidar/none", RPLIDAR, true, .sessions = 1 },
	{ "/faults/rplidar/drop-3", RPLIDAR "&fault=drop@300x3", true, 2, 4, .sessions = 1 },
	{ "/faults/rplidar/garble", RPLIDAR "&fault=garble@200x3", true, .sessions = 1,
		.bad_telegrams_min = 1 },
	{ "/faults/rplidar/split-and-merge", RPLIDAR "&fault=split@100:5,merge@600x20", true,
		.sessions = 1 },
	{ "/faults/rplidar/stall-for-good", RPLIDAR "&fault=stall@500", true, .sessions = 1 },
	{ "/faults/rplidar/error", RPLIDAR "&fault=error@700", true, .sessions = 1 },
	{ "/faults/rplidar/unplug", RPLIDAR "&fault=unplug@700:3", true, .sessions = 1 },
};

/* Both scans of one seed see the same place: the share of cells whose ranges agree within noise. */
static double agreement(const panorama *a, const panorama *b)
{
	size_t both = 0, same = 0;
	for (size_t i = 0; i < (size_t)a->desc.columns * a->desc.rows; i++)
		if (a->cell[i] == CELL_MEASURED && b->cell[i] == CELL_MEASURED) {
			both++;
			same += fabsf(a->range_m[i] - b->range_m[i]) < 0.1f + 0.03f * b->range_m[i];
		}
	return both ? (double)same / both : 0;
}

static panorama *load(const char *path, uint32_t number)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	g_assert_no_error(error);
	panorama *p = scan_load(s, number, true, &error);
	g_assert_no_error(error);
	return p;
}

/* The scan without any fault, made once for each lidar. */
static const panorama *reference(const char *description)
{
	static const char *const lidars[] = { HALL, COLA, LD, RPLIDAR };
	static panorama *made[G_N_ELEMENTS(lidars)];
	size_t i = G_N_ELEMENTS(lidars) - 1;
	while (i > 0 && !g_str_has_prefix(description, lidars[i]))
		i--;
	if (!made[i]) {
		g_autofree char *folder = simulated_folder(),
				*path = g_build_filename(folder, "site", NULL);
		struct scan_options options = { .preset = preset_find("draft") };
		struct scan_result result;
		uint32_t partial;
		g_assert_true(simulated_scan(
			path, lidars[i], &options, NULL, NULL, &result, &partial, NULL));
		made[i] = load(path, result.number);
	}
	return made[i];
}

static void check_whole(const struct scene *t, const char *path, const struct scan_result *r)
{
	g_autoptr(panorama) p = load(path, r->number);
	double agrees = agreement(p, reference(t->description));
	g_test_message("%" G_GUINT64_FORMAT " lost, %u jumps, %" G_GUINT64_FORMAT
		       " bad telegrams, %u slips, %u missing, %.2f %% agree",
		r->report.lost_revolutions, r->report.counter_jumps, r->report.bad_telegrams,
		r->report.suspect_intervals, r->missing_columns, 100 * agrees);
	g_assert_cmpuint(r->missing_columns, ==, 0);
	g_assert_cmpfloat(agrees, >, 0.97);
	g_assert_cmpuint(r->report.counter_jumps, ==, t->jumps);
	g_assert_cmpuint(r->report.sessions, ==, t->sessions);
	g_assert_cmpuint(r->report.bad_telegrams, >=, t->bad_telegrams_min);
	g_assert_cmpuint(r->report.device_errors, >=, t->device_errors_min);
	g_assert_cmpuint(r->report.suspect_intervals, >=, t->slips_min);
	g_assert_cmpuint(r->report.bad_frames, >=, t->bad_frames_min);
	if (t->lost_max) {
		g_assert_cmpuint(r->report.lost_revolutions, >=, t->lost_min);
		g_assert_cmpuint(r->report.lost_revolutions, <=, t->lost_max);
	}
}

/* What was seen before the fault is kept, and the scan goes on from there when the fault is mended.
 */
static void check_partial(const struct scene *t, const char *path, uint32_t partial)
{
	g_autofree char *mended = g_strndup(t->description, strcspn(t->description, "&"));
	struct scan_options options = { .resume = true };
	struct scan_result result;
	g_autoptr(GError) error = NULL;
	if (strstr(t->description, "lidar=none")) {
		g_assert_cmpuint(partial, ==, 0);
		return;
	}
	g_assert_cmpuint(partial, ==, 1);
	g_assert_true(simulated_scan(path, HALL, &options, NULL, NULL, &result, &partial, &error));
	g_assert_no_error(error);
	g_assert_cmpuint(result.report.sessions, ==, 2);
	g_assert_cmpuint(result.missing_columns, ==, 0);
	g_autoptr(panorama) p = load(path, result.number);
	g_assert_cmpfloat(agreement(p, reference(HALL)), >, 0.97);
}

static void test_scene(gconstpointer data)
{
	const struct scene *t = data;
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "site", NULL);
	struct scan_options options = { .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	bool good = simulated_scan(
		path, t->description, &options, NULL, NULL, &result, &partial, &error);
	if (error)
		g_test_message("%s", error->message);
	g_assert_cmpint(good, ==, t->good);
	if (good) {
		check_whole(t, path, &result);
		return;
	}
	g_assert_nonnull(strstr(error->message, t->says));
	check_partial(t, path, partial);
}

/* A disk that is too full is refused before the stage moves, and nothing is left behind. */
static void test_no_space(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder();
	g_assert_true(scan_check_space(folder, 1000, NULL));
	g_assert_false(scan_check_space(folder, UINT64_MAX / 2, &error));
	g_assert_nonnull(strstr(error->message, "not enough space"));
}

static bool stop_half_way(const struct run_progress *p, gpointer user_data)
{
	(void)user_data;
	return p->column_fraction > 0.5;
}

static void test_stopped_and_discarded(void)
{
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "site", NULL);
	struct scan_options options = { .preset = preset_find("draft"), .progress = stop_half_way };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL, again = NULL;
	g_assert_false(simulated_scan(path, HALL, &options, NULL, NULL, &result, &partial, &error));
	g_assert_error(error, PUMP_ERROR, PUMP_ERROR_STOPPED);
	g_assert_cmpuint(partial, ==, 1);
	options.progress = NULL;
	g_assert_false(simulated_scan(path, HALL, &options, NULL, NULL, &result, &partial, &again));
	g_assert_nonnull(strstr(again->message, "was begun and not finished"));
	g_autoptr(site) s = site_open_for_writing(path, NULL);
	g_assert_true(site_discard_partial(s, 1, NULL));
	g_clear_pointer(&s, site_free);
	g_assert_true(simulated_scan(path, HALL, &options, NULL, NULL, &result, &partial, NULL));
	g_assert_cmpuint(result.report.sessions, ==, 1);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(scenes); i++)
		g_test_add_data_func(scenes[i].path, &scenes[i], test_scene);
	g_test_add_func("/faults/no-space", test_no_space);
	g_test_add_func("/faults/stopped-and-discarded", test_stopped_and_discarded);
	return g_test_run();
}
