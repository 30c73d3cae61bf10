/* HDR scans by pleinair-acquired: what it predicts of them and refuses, and that a pause keeps what was asked for. */
#include "acquire/scan.h"
#include "tests/acquisition-bench.h"
#include "tests/simulated.h"

#define SCENE "sim:hall?seed=3&ares=360&camera=120x200&divergence_mrad=0&station=%n"

struct bench {
	struct bus_bench bus;
	BusAcquisition1 *service;
	char *folder, *site_path;
	guint finished;
};

static void has_finished(BusAcquisition1 *a, const char *path, guint scan, gpointer user_data)
{
	struct bench *b = user_data;
	(void)a;
	(void)path;
	(void)scan;
	b->finished++;
}

static void set_up(struct bench *b, gconstpointer data)
{
	(void)data;
	b->folder = simulated_folder();
	b->site_path = g_build_filename(b->folder, "oak", NULL);
	bus_bench_begin(&b->bus);
	b->service = acquisition_reach(&b->bus);
	g_signal_connect(b->service, "finished", G_CALLBACK(has_finished), b);
	char *argv[] = { NULL, (char *)"--sites", b->folder, (char *)"--device", (char *)SCENE,
		NULL };
	bus_bench_start(&b->bus, "pleinair-acquired", argv);
	WAIT_FOR(acquisition_is_there(b->service));
}

static void tear_down(struct bench *b, gconstpointer data)
{
	(void)data;
	g_object_unref(b->service);
	bus_bench_end(&b->bus);
	g_free(b->folder);
	g_free(b->site_path);
}

/* Takes value. */
static GError *start(struct bench *b, const char *option, GVariant *value)
{
	GError *error = NULL;
	guint number;
	g_auto(GVariantDict) options = G_VARIANT_DICT_INIT(NULL);
	g_variant_dict_insert_value(&options, option, value);
	bus_acquisition1_call_start_sync(b->service, b->site_path, "draft",
		g_variant_dict_end(&options), &number, NULL, &error);
	return error;
}

static void refusals(struct bench *b, gconstpointer data)
{
	(void)data;
	bus_bench_assert_refused(
		start(b, "hdr", g_variant_new_string("yes")), "Invalid", "'hdr' is true or false");
	bus_bench_assert_refused(
		start(b, "hrd", g_variant_new_boolean(TRUE)), "Invalid", "has no option 'hrd'");
}

static void prediction(struct bench *b, gconstpointer data)
{
	g_autoptr(GVariant) devices = NULL, all = NULL;
	double plain_s = 0, hdr_s = 0;
	guint64 plain = 0, hdr = 0;
	(void)data;
	g_assert_true(bus_acquisition1_call_check_sync(b->service, &devices, NULL, NULL));
	g_assert_true(bus_acquisition1_call_list_presets_sync(b->service, &all, NULL, NULL));
	g_autoptr(GVariant) draft = g_variant_get_child_value(all, 0);
	g_assert_true(g_variant_lookup(draft, "seconds", "d", &plain_s) &&
		      g_variant_lookup(draft, "hdr_seconds", "d", &hdr_s) &&
		      g_variant_lookup(draft, "bytes", "t", &plain) &&
		      g_variant_lookup(draft, "hdr_bytes", "t", &hdr));
	g_assert_cmpfloat(hdr_s, >, plain_s + 15);
	g_assert_cmpuint(hdr, >, plain);
}

/* Of the photos before a pause, and of those that come after it. */
static void pause_keeps_it(struct bench *b, gconstpointer data)
{
	g_autoptr(GError) error = start(b, "hdr", g_variant_new_boolean(TRUE));
	guint number, taken = 0, wanted = 0;
	(void)data;
	g_assert_no_error(error);
	for (; taken < 3; g_main_context_iteration(NULL, TRUE))
		if (bus_acquisition1_get_photos(b->service))
			g_variant_get(
				bus_acquisition1_get_photos(b->service), "(uu)", &taken, &wanted);
	g_assert_true(bus_acquisition1_call_pause_sync(b->service, NULL, NULL));
	WAIT_FOR(!g_strcmp0(bus_acquisition1_get_state(b->service), "paused"));
	bus_acquisition1_call_resume_sync(b->service, b->site_path, FALSE, &number, NULL, &error);
	g_assert_no_error(error);
	WAIT_FOR(b->finished);
	g_autoptr(site) s = site_open(b->site_path, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(scan_hdr_photos(s, number), ==, wanted);
	g_assert_cmpuint(wanted, ==, 18);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
#define ADD(name, test)                                                                            \
	g_test_add("/acquired-hdr/" name, struct bench, NULL, set_up, test, tear_down)
	ADD("refusals", refusals);
	ADD("prediction", prediction);
	ADD("pause-keeps-it", pause_keeps_it);
	return g_test_run();
}
