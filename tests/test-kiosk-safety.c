/* What a person does at the screen when the scanner stops for safety: the emergency stop ends a scan with its sentence, nothing goes on before Reset was
 * pressed, and then the scan becomes whole. And the scanner is looked at, away from any scan. */
#include "acquire/scan.h"
#include "tests/commands.h"
#include "tests/kiosk-rig.h"
#include "tests/simulated.h"

#define SCENE "hall?seed=3&ares=1584&camera=180x320&divergence_mrad=0"

static const double limit_s = 60;

/* A scanner beside the program, so that it can be another one when the program asks again. */
struct bench {
	rig *rig;
	char *folder, *socket;
	GSubprocess *head;
};

static void end_head(struct bench *b)
{
	if (!b->head)
		return;
	g_subprocess_force_exit(b->head);
	g_subprocess_wait(b->head, NULL, NULL);
	g_clear_object(&b->head);
	g_remove(b->socket);
}

static void begin_head(struct bench *b, const char *description)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *program = commands_program("pleinair-sim"),
			*listen = g_strconcat("--listen=", b->socket, NULL);
	end_head(b);
	b->head = g_subprocess_new(
		G_SUBPROCESS_FLAGS_NONE, &error, program, listen, description, NULL);
	g_assert_no_error(error);
	while (!g_file_test(b->socket, G_FILE_TEST_EXISTS))
		g_usleep(10000);
}

static void begin(struct bench *b, const char *description)
{
	g_autofree char *program = commands_program("pleinair-kiosk");
	b->folder = simulated_folder();
	g_autofree char *sites = g_build_filename(b->folder, "sites", NULL);
	b->socket = g_build_filename(b->folder, "head", NULL);
	g_autofree char *device = g_strconcat("sim:", b->socket, NULL);
	g_assert_cmpint(g_mkdir(sites, 0755), ==, 0);
	begin_head(b, description);
	const char *const arguments[] = { "--device", device, "--size", "1280x800", sites, NULL };
	b->rig = rig_new(&(struct rig_desc){
		.program = program, .arguments = arguments, .width = 1280, .height = 800 });
}

static void end(struct bench *b)
{
	rig_free(b->rig);
	end_head(b);
	g_free(b->socket);
	g_free(b->folder);
}

static void make_site(struct bench *b)
{
	rig_tap(b->rig, "new-site");
	rig_tap(b->rig, "new-site-yes");
	rig_wait_for(b->rig, "scan-start", limit_s);
}

static guint whole_scans(const struct bench *b)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(b->folder, "sites", "Site 1", NULL);
	g_autoptr(site) s = site_open(path, &error);
	g_assert_no_error(error);
	g_autoptr(GArray) scans = site_scans(s, &error);
	g_assert_no_error(error);
	for (guint i = 0; i < scans->len; i++)
		panorama_free(scan_load(s, g_array_index(scans, uint32_t, i), true, &error));
	g_assert_no_error(error);
	return scans->len;
}

static void emergency_stop(void)
{
	struct bench b = { 0 };
	struct rig_place go_on;
	begin(&b, SCENE "&fault=estop@1500:1");
	make_site(&b);
	rig_tap(b.rig, "preset-draft");
	rig_tap(b.rig, "scan-start");
	rig_wait_words(b.rig, "scan-fault", "The emergency stop is pressed", limit_s);
	rig_wait_words(b.rig, "scan-advice", "press Reset", limit_s);
	rig_wait_for(b.rig, "scan-reset", limit_s);
	/* It is said once, and nothing goes on before. */
	rig_wait_gone(b.rig, "toast-text", limit_s);
	g_assert_true(rig_find(b.rig, "scan-go-on", &go_on));
	g_assert_false(go_on.sensitive);
	rig_keep_shot(b.rig, "safety-stopped");
	/* The same on the screen that tells how all is. */
	rig_tap(b.rig, "status");
	rig_wait_words(b.rig, "health-fault", "The emergency stop is pressed", limit_s);
	rig_wait_for(b.rig, "health-reset", limit_s);
	rig_keep_shot(b.rig, "safety-health");
	rig_tap(b.rig, "back");
	/* Pressed again, it would stop the rest as well: this one is not. */
	begin_head(&b, SCENE);
	rig_tap(b.rig, "scan-reset");
	rig_wait_gone(b.rig, "scan-reset", limit_s);
	rig_wait_for(b.rig, "scan-go-on", limit_s);
	g_assert_cmpuint(whole_scans(&b), ==, 0);
	rig_keep_shot(b.rig, "safety-reset");
	rig_tap(b.rig, "scan-go-on");
	rig_wait_for(b.rig, "scan-start", limit_s);
	g_assert_cmpuint(whole_scans(&b), ==, 1);
	rig_keep_shot(b.rig, "safety-whole");
	end(&b);
}

/* How the head is, and whether it still sits as it was calibrated. */
static void look_at_the_scanner(void)
{
	struct bench b = { 0 };
	begin(&b, SCENE);
	rig_tap(b.rig, "status");
	rig_tap(b.rig, "health-check");
	rig_wait_for(b.rig, "device-camera", limit_s);
	rig_tap(b.rig, "health-calibration");
	rig_wait_words(b.rig, "health-calibration-says", "Scan a place first", limit_s);
	rig_keep_shot(b.rig, "safety-checked");
	rig_tap(b.rig, "back");
	make_site(&b);
	rig_tap(b.rig, "preset-draft");
	rig_wait_for(b.rig, "preset-hdr", limit_s);
	rig_keep_shot(b.rig, "safety-hdr");
	rig_tap(b.rig, "preset-hdr");
	rig_keep_shot(b.rig, "safety-hdr-chosen");
	rig_tap(b.rig, "scan-start");
	rig_wait_for(b.rig, "scan-panorama", limit_s);
	rig_wait_gone(b.rig, "scan-panorama", limit_s);
	rig_wait_for(b.rig, "scan-start", limit_s);
	g_assert_cmpuint(whole_scans(&b), ==, 1);
	rig_keep_shot(b.rig, "safety-scanned");
	rig_tap(b.rig, "status");
	rig_tap(b.rig, "health-calibration");
	rig_wait_words(b.rig, "health-calibration-says", "Good: both faces", limit_s);
	rig_keep_shot(b.rig, "safety-calibration");
	end(&b);
}

int main(int argc, char **argv)
{
	if (!rig_tests_begin(&argc, &argv))
		return 0;
	g_test_add_func("/kiosk-safety/emergency-stop", emergency_stop);
	g_test_add_func("/kiosk-safety/look-at-the-scanner", look_at_the_scanner);
	return g_test_run();
}
