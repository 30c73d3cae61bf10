/* Heads that were not put together as drawn: what calibration finds out of a scan against the simulator's truth, and whether a
 * scan with the certificate found is the scan of an aligned head. */
#include "process/certificate.h"
#include "sim/mount.h"
#include "tests/simulated.h"
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#define DEGREE (G_PI / 180)

#define LIDAR_ASKEW                                                                                \
	"lidar_turn_deg=0.3,-0.4,0.25&lidar_shift_mm=8,-6,5&beam_zero_deg=0.5&range_offset_mm=10"
#define CAMERA_ASKEW                                                                               \
	"camera_turn_deg=0.5,-0.3,0.4&camera_shift_mm=4,-3,6&focal_percent=1&centre_px=5,-4&home_" \
	"azimuth_deg=2"

/* Scans and gives back the record; caller frees. */
static char *scan_of(const char *description, const struct preset *preset)
{
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "site", NULL);
	struct scan_options options = { .preset = preset };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	simulated_scan(path, description, &options, NULL, NULL, &result, &partial, &error);
	g_assert_no_error(error);
	return g_build_filename(path, "scans", "0001", "raw.rec", NULL);
}

static struct faces *faces_of(const char *description, const struct preset *preset)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *record = scan_of(description, preset);
	struct faces *f = faces_read(record, NULL, NULL, &error);
	g_assert_no_error(error);
	g_remove(record);
	return f;
}

/* Clockwise seen from above. */
static void turn_z(const double v[3], double rad, double ret[3])
{
	double s = sin(rad), c = cos(rad);
	ret[0] = v[0] * c + v[1] * s;
	ret[1] = v[1] * c - v[0] * s;
	ret[2] = v[2];
}

/* ---- the lidar ---- */

/* A turn about the axis shows in no scan: the truth as it looks from a head whose lidar has none. */
static void lidar_truth(const sim_options *o, double ret[TWO_FACE_MOUNT])
{
	const struct lidar_mount m = lidar_mount_of(o);
	double place[3];
	turn_z(m.translation_m, o->lidar_turn_deg[2] * DEGREE, place);
	ret[TWO_FACE_BEAM_ZERO] = (90 + o->beam_zero_deg + o->lidar_turn_deg[0]) * DEGREE;
	ret[TWO_FACE_TILT] = o->lidar_turn_deg[1] * DEGREE;
	ret[TWO_FACE_X] = place[0];
	ret[TWO_FACE_Y] = place[1];
}

static void check_lidar(const char *description, const struct two_face_result *r)
{
	g_autoptr(sim_options) o = options_parse(description, NULL);
	double truth[TWO_FACE_MOUNT];
	lidar_truth(o, truth);
	g_test_message("%s: two faces %.1f mm apart, then %.2f; noise %.2f", description,
		1e3 * r->error_before_m, 1e3 * r->error_after_m, 1e3 * r->noise_error_m);
	for (int i = TWO_FACE_BEAM_ZERO; i <= TWO_FACE_Y; i++) {
		double off = r->value[i].value - truth[i];
		g_test_message("  %-12s off by %8.4f, said to be known to %.4f %s",
			two_face_name(i), two_face_in_unit(i, off),
			two_face_in_unit(i, r->value[i].deviation), two_face_unit(i));
		g_assert_true(r->value[i].seen);
		g_assert_cmpfloat(fabs(off), <, i <= TWO_FACE_TILT ? 0.01 * DEGREE : 1e-3);
		/* Even walls are not quite, so a little more than chance. */
		g_assert_cmpfloat(fabs(off), <,
			8 * r->value[i].deviation + (i <= TWO_FACE_TILT ? 0.001 * DEGREE : 1e-4));
	}
	g_assert_false(r->value[TWO_FACE_RANGE].seen);
	g_assert_cmpfloat(r->error_after_m, <, 1.5 * r->noise_error_m);
}

static void test_lidar(gconstpointer data)
{
	const char *description = data;
	g_autoptr(GError) error = NULL;
	struct two_face_result r;
	g_autoptr(faces) f = faces_of(description, &preset_calibration);
	two_face_solve(f, &r, &error);
	g_assert_no_error(error);
	check_lidar(description, &r);
}

/* A plain scan shows the second face on its way home. */
static void test_way_home(void)
{
	const char *description = "hall?seed=3&ares=1440&camera=64x112&" LIDAR_ASKEW;
	g_autoptr(GError) error = NULL;
	struct two_face_result r;
	g_autoptr(faces) f = faces_of(description, preset_find("draft"));
	two_face_solve(f, &r, &error);
	g_assert_no_error(error);
	check_lidar(description, &r);
}

/* Half a turn alone, without what is seen before and behind it. */
static void test_one_face(void)
{
	g_autoptr(GError) error = NULL;
	struct two_face_result r;
	g_autoptr(faces) f = faces_of("hall?seed=3&ares=720&camera=none", preset_find("draft"));
	for (guint i = f->lines->len; i-- > 0;) {
		double front = g_array_index(f->lines, struct face_line, i).front_rad;
		if (front < 0.1 || front > G_PI - 0.1)
			g_array_remove_index_fast(f->lines, i);
	}
	g_assert_false(two_face_solve(f, &r, &error));
	g_assert_nonnull(strstr(error->message, "even places in common"));
}

/* ---- the camera ---- */

/* As it looks from a head whose lidar is neither turned about the axis nor raised. */
static void camera_truth(const sim_options *o, struct pose *ret)
{
	const struct camera_mount m = camera_mount_of(o);
	double back = o->lidar_turn_deg[2] * DEGREE;
	turn_z(m.translation_m, back, ret->translation_m);
	ret->translation_m[2] -= o->lidar_shift_mm[2] * 1e-3;
	for (int i = 0; i < 3; i++)
		turn_z(m.rotation[i], back, ret->rotation[i]);
}

struct bounds {
	double degrees, mm, focal_percent, range_mm;
};

static void check_camera(const char *description, const struct board_result *r, struct bounds most)
{
	g_autoptr(sim_options) o = options_parse(description, NULL);
	struct lens lens = lens_of(o);
	struct pose truth = POSE_IDENTITY, found = POSE_IDENTITY;
	double twist[6];
	camera_truth(o, &truth);
	memcpy(found.rotation, r->camera.rotation, sizeof found.rotation);
	memcpy(found.translation_m, r->camera.translation_m, sizeof found.translation_m);
	pose_difference(&truth, &found, twist);
	g_test_message("%s: %u boards in %u views, %.2f px, then %.3f", description, r->boards,
		r->views, r->first_rms_px, r->rms_px);
	g_test_message("  turned by %.4f %.4f %.4f degrees, shifted by %.2f %.2f %.2f mm",
		twist[0] / DEGREE, twist[1] / DEGREE, twist[2] / DEGREE,
		1e3 * (found.translation_m[0] - truth.translation_m[0]),
		1e3 * (found.translation_m[1] - truth.translation_m[1]),
		1e3 * (found.translation_m[2] - truth.translation_m[2]));
	g_test_message(
		"  focal lengths off by %.4f %.4f %%, centre by %.2f %.2f px, range by %.2f mm",
		100 * (r->camera.fx / lens.focal_px - 1), 100 * (r->camera.fy / lens.focal_px - 1),
		r->camera.cx - lens.cx, r->camera.cy - lens.cy,
		1e3 * r->range_offset_m - o->range_offset_mm);
	g_test_message("  said to be known: turn to %.4f %.4f %.4f degrees, place to %.2f %.2f "
		       "%.2f mm, focal lengths to "
		       "%.4f %.4f %%, centre to %.2f %.2f px",
		r->deviation[BOARD_TURN_X] / DEGREE, r->deviation[BOARD_TURN_Y] / DEGREE,
		r->deviation[BOARD_TURN_Z] / DEGREE, 1e3 * r->deviation[BOARD_X],
		1e3 * r->deviation[BOARD_Y], 1e3 * r->deviation[BOARD_Z],
		100 * r->deviation[BOARD_FX] / lens.focal_px,
		100 * r->deviation[BOARD_FY] / lens.focal_px, r->deviation[BOARD_CX],
		r->deviation[BOARD_CY]);
	g_assert_true(r->met);
	for (int i = 0; i < 3; i++) {
		g_assert_cmpfloat(fabs(twist[i]), <, most.degrees * DEGREE);
		g_assert_cmpfloat(
			fabs(found.translation_m[i] - truth.translation_m[i]), <, most.mm * 1e-3);
	}
	g_assert_cmpfloat(fabs(r->camera.fx / lens.focal_px - 1), <, most.focal_percent / 100);
	g_assert_cmpfloat(fabs(r->camera.fy / lens.focal_px - 1), <, most.focal_percent / 100);
	g_assert_cmpfloat(fabs(1e3 * r->range_offset_m - o->range_offset_mm), <, most.range_mm);
}

static void find_camera(const char *description, struct bounds most)
{
	const struct board_desc desc = { 9, 6, 0.06 };
	g_autoptr(GError) error = NULL;
	struct two_face_result lidar;
	struct board_result r;
	g_autoptr(faces) f = faces_of(description, &preset_calibration);
	two_face_solve(f, &lidar, &error);
	g_assert_no_error(error);
	board_camera_solve(f, &desc, &lidar, NULL, NULL, &r, &error);
	g_assert_no_error(error);
	check_camera(description, &r, most);
}

static void test_camera(gconstpointer data)
{
	find_camera(data, (struct bounds){ 0.01, 1, 0.1, 1 });
}

/* With half the pixels. */
static void test_small_camera(void)
{
	find_camera("range?seed=1&ares=1440&camera=360x640&" LIDAR_ASKEW "&" CAMERA_ASKEW,
		(struct bounds){ 0.05, 2, 0.2, 1.5 });
}

/* ---- and back ---- */

static panorama *panorama_of(const char *description)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *record = scan_of(description, preset_find("draft"));
	struct develop_options o = { .desc = panorama_desc_for(750, 198) };
	panorama *p = develop_record(record, &o, NULL, &error);
	g_assert_no_error(error);
	return p;
}

static int by_size(gconstpointer a, gconstpointer b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* The middle of how far ranges differ. A head that begins elsewhere has other noise. */
static double typical_difference_m(const panorama *a, const panorama *b)
{
	g_autoptr(GArray) off = g_array_new(FALSE, FALSE, sizeof(double));
	for (size_t i = 0; i < (size_t)a->desc.columns * a->desc.rows; i++) {
		double d = fabs((double)a->range_m[i] - (double)b->range_m[i]);
		if (a->cell[i] == CELL_MEASURED && b->cell[i] == CELL_MEASURED)
			g_array_append_val(off, d);
	}
	g_assert_cmpuint(off->len, >, a->desc.columns * a->desc.rows / 2);
	g_array_sort(off, by_size);
	return g_array_index(off, double, off->len / 2);
}

static void test_certificate_makes_good(void)
{
	const char *askew =
		"hall?seed=3&ares=1440&camera=none&beam_zero_deg=0.6&lidar_turn_deg=0,-0.4,0&lidar_"
		"shift_mm=9,-7,0";
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "head.json", NULL), *kept = NULL,
			*with = g_strdup_printf("%s&certificate=%s", askew, path);
	g_autoptr(GError) error = NULL;
	struct two_face_result r;
	g_autoptr(faces) f = faces_of(askew, &preset_calibration);
	two_face_solve(f, &r, &error);
	g_assert_no_error(error);
	const struct measured m = { f, &r, NULL, "a test" };
	g_assert_true(certificate_save(&m, path, &kept, &error));
	g_assert_null(kept);
	g_assert_true(certificate_save(&m, path, &kept, &error));
	g_assert_true(
		g_str_has_suffix(kept, "head.json.1") && g_file_test(kept, G_FILE_TEST_EXISTS));
	g_autoptr(panorama) aligned = panorama_of("hall?seed=3&ares=1440&camera=none"),
			    other = panorama_of("hall?seed=3&ares=1440&camera=none&home_deg=200"),
			    good = panorama_of(with), bad = panorama_of(askew);
	double of_noise = typical_difference_m(aligned, other),
	       of_good = typical_difference_m(aligned, good),
	       of_bad = typical_difference_m(aligned, bad);
	g_test_message(
		"ranges differ by %.2f mm, without the certificate %.2f; by noise alone %.2f",
		1e3 * of_good, 1e3 * of_bad, 1e3 * of_noise);
	g_assert_cmpfloat(of_bad, >, 3 * of_good);
	g_assert_cmpfloat(of_good, <, 1.2 * of_noise);
}

/* Too far apart to be chance, and the value is what the head has. */
static void test_certificate_text(void)
{
	g_autoptr(GError) error = NULL;
	struct two_face_result r;
	g_autoptr(faces) f =
		faces_of("hall?seed=3&ares=720&camera=16x16&" LIDAR_ASKEW, &preset_calibration);
	two_face_solve(f, &r, &error);
	g_assert_no_error(error);
	g_autofree char *text =
		certificate_text(&(struct measured){ f, &r, NULL, "a test" }, &error);
	struct calibration c;
	g_assert_true(calibration_parse(text, "made", &c, &error));
	g_assert_cmpfloat(fabs(c.lidar.beam_zero_rad - r.value[TWO_FACE_BEAM_ZERO].value), <, 1e-9);
	g_assert_cmpfloat(fabs(c.lidar.translation_m[0] - r.value[TWO_FACE_X].value), <, 1e-9);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			g_assert_cmpfloat(
				fabs(c.lidar.rotation[i][j] - r.lidar.rotation[i][j]), <, 1e-9);
	g_assert_true(c.has_camera);
	g_assert_nonnull(strstr(text, "\"measured\""));
}

static void add_slow(const char *seed)
{
	static const char *const scenes[] = { "hall", "court", "bridge", "street", "range" };
	for (size_t i = 0; i < G_N_ELEMENTS(scenes); i++) {
		g_autofree char *path = g_strdup_printf("/calibrate/lidar/%s/%s", scenes[i], seed);
		g_test_add_data_func_full(path,
			g_strdup_printf("%s?seed=%s&camera=none&" LIDAR_ASKEW, scenes[i], seed),
			test_lidar, g_free);
	}
	g_autofree char *path = g_strdup_printf("/calibrate/camera/range/%s", seed);
	g_test_add_data_func_full(path,
		g_strdup_printf("range?seed=%s&" LIDAR_ASKEW "&" CAMERA_ASKEW, seed), test_camera,
		g_free);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_data_func("/calibrate/lidar/quick",
		"hall?seed=3&ares=1440&camera=none&" LIDAR_ASKEW, test_lidar);
	g_test_add_func("/calibrate/lidar/way-home", test_way_home);
	g_test_add_func("/calibrate/lidar/one-face", test_one_face);
	g_test_add_func("/calibrate/camera/quick", test_small_camera);
	g_test_add_func("/calibrate/certificate/text", test_certificate_text);
	g_test_add_func("/calibrate/certificate/makes-good", test_certificate_makes_good);
	/* Minutes of it; PLEINAIR_SEEDS="4 5 6": other heads in other noise. */
	const char *seeds = g_getenv("PLEINAIR_SEEDS");
	g_auto(GStrv) seed = g_strsplit(seeds ? seeds : "1 2 3", " ", -1);
	for (char **at = seed; g_getenv("PLEINAIR_SLOW") && *at; at++)
		add_slow(*at);
	return g_test_run();
}
