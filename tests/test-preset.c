/* What a preset is said to take, against what it took: by the clock of the head and the bytes on
 * the disk. */
#include "acquire/planes.h"
#include "tests/simulated.h"
#include <math.h>
#include <string.h>
#include <sys/stat.h>

struct taken {
	double seconds;
	uint64_t bytes;
	struct prediction predicted;
};

static void keep_prediction(
	const struct prediction *predicted, const struct lidar_identity *lidar, gpointer user_data)
{
	struct taken *t = user_data;
	(void)lidar;
	t->predicted = *predicted;
}

static uint64_t size_of(const char *folder, const char *name)
{
	g_autofree char *path = g_build_filename(folder, name, NULL);
	struct stat s;
	return stat(path, &s) == 0 ? (uint64_t)s.st_size : 0;
}

/* From the session's header to the end: waking, homing, passes, photos, going home. */
static double seconds_of(const char *folder)
{
	g_autofree char *path = g_build_filename(folder, "raw.rec", NULL);
	g_autoptr(record_reader) r = record_open(path, NULL);
	struct record_entry e;
	int64_t first_ns = -1, last_ns = 0;
	while (record_next(r, &e, NULL) == RECORD_ENTRY) {
		first_ns = first_ns < 0 ? e.time_ns : first_ns;
		last_ns = e.time_ns;
	}
	return (double)(last_ns - first_ns) * 1e-9;
}

static const struct scene {
	const char *path, *preset, *description;
	double bytes_slack; /* 0: a quarter */
	bool hdr;
} scenes[] = {
	{ "/preset/draft", "draft", "hall?seed=4&ares=1584&camera=48x80&home_deg=180" },
	{ "/preset/standard", "standard", "hall?seed=4&ares=1584&camera=48x80&home_deg=180" },
	{ "/preset/fine", "fine", "hall?seed=4&ares=800&camera=48x80&home_deg=180" },
	{ "/preset/draft-without-camera", "draft",
		"hall?seed=4&ares=800&camera=none&home_deg=180" },
	{ "/preset/draft-cola", "draft", "hall?seed=4&lidar=cola&camera=none&home_deg=180",
		/* A beam of CoLa takes half as much again on the wire, and the prediction is not
		 * told the protocol. */
		0.25 },
	{ "/preset/draft-ld", "draft", "hall?seed=4&lidar=stl27l&camera=48x80&home_deg=180" },
	{ "/preset/draft-ld-hdr", "draft", "hall?seed=4&lidar=ld19&camera=48x80&home_deg=180",
		.hdr = true },
	{ "/preset/draft-rplidar", "draft",
		"hall?seed=4&lidar=rplidar-s2&camera=48x80&home_deg=180" },
	{ "/preset/draft-near-home", "draft", "hall?seed=4&ares=800&camera=48x80&home_deg=20" },
	{ "/preset/draft-far-from-home", "draft",
		"hall?seed=4&ares=800&camera=48x80&home_deg=340" },
	{ "/preset/draft-hdr", "draft", "hall?seed=4&ares=800&camera=120x160&home_deg=180",
		.hdr = true },
	{ "/preset/standard-hdr", "standard",
		"hall?seed=4&ares=1584&camera=48x80&home_deg=180&fps=30", .hdr = true },
	{ "/preset/draft-large-photos", "draft",
		"hall?seed=4&ares=800&camera=120x160&home_deg=180" },
};

static void scan(const struct scene *s, struct taken *ret)
{
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "site", NULL),
			*made = g_build_filename(path, "scans", "0001", NULL);
	struct scan_options options = { .preset = preset_find(s->preset),
		.hdr = s->hdr,
		.predicted = keep_prediction,
		.user_data = ret };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	g_assert_true(simulated_scan(
		path, s->description, &options, NULL, NULL, &result, &partial, &error));
	g_assert_no_error(error);
	ret->seconds = seconds_of(made);
	ret->bytes = size_of(made, "raw.rec");
	for (int i = 0; planes_names[i]; i++)
		ret->bytes += size_of(made, planes_names[i]);
	g_assert_cmpuint(result.counts.measured, <=, ret->predicted.points);
}

static void test_scene(gconstpointer data)
{
	const struct scene *s = data;
	struct taken t = { 0 };
	scan(s, &t);
	g_test_message("%.1f s predicted, %.1f taken; %.2f MB predicted, %.2f taken",
		t.predicted.seconds, t.seconds, (double)t.predicted.bytes * 1e-6,
		(double)t.bytes * 1e-6);
	g_assert_cmpfloat(fabs(t.predicted.seconds / t.seconds - 1), <, 0.25);
	g_assert_cmpfloat(fabs((double)t.predicted.bytes / (double)t.bytes - 1),
		<, s->bytes_slack> 0 ? s->bytes_slack : 0.25);
}

/* The pace meets every column by a revolution, at any rate that a lidar may tell. */
static void test_pace(void)
{
	static const double rates_hz[] = { 1, 5, 15, 25, 40, 50, 200 };
	for (const struct preset *p = presets; p->name; p++)
		for (size_t i = 0; i < G_N_ELEMENTS(rates_hz); i++) {
			struct stage_pace pace = preset_pace(p, rates_hz[i]);
			double columns_a_turn =
				pace.scan_rad_s / rates_hz[i] * p->columns / (2 * G_PI);
			g_assert_cmpfloat(columns_a_turn, <, 1);
			g_assert_cmpfloat(pace.scan_rad_s, >, 0);
			g_assert_cmpfloat(pace.scan_rad_s, <=, 30.001 * G_PI / 180);
			/* At speed when the first column comes. */
			g_assert_cmpfloat(pace.run_up_rad, >=,
				pace.scan_rad_s * pace.scan_rad_s / (2 * pace.acceleration_rad_s2));
		}
}

static void test_names(void)
{
	static const char *const names[] = { "draft", "standard", "fine" };
	for (size_t i = 0; i < G_N_ELEMENTS(names); i++) {
		g_assert_true(preset_find(names[i]) == &presets[i]);
		g_assert_cmpuint(presets[i].columns * 198, ==, presets[i].rows * 750);
	}
	g_assert_null(presets[3].name);
	g_assert_null(preset_find("finest"));
	g_assert_null(preset_find(""));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(scenes); i++)
		g_test_add_data_func(scenes[i].path, &scenes[i], test_scene);
	g_test_add_func("/preset/pace", test_pace);
	g_test_add_func("/preset/names", test_names);
	return g_test_run();
}
