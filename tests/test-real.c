/* make real: what nobody here scanned is imported, processed and drawn, every file of it; with PLEINAIR_SLOW=1 (make check-slow) all that
 * lies beside the checkout, else some of it. */
#include "tests/simulated.h"
#include "tests/support.h"
#include <cairo.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const some[] = { "labelled", "outdoor-pairs", "pump" };
#define STYLES 8u

static void run_real(const char *data, const char *folder, int expected, char **ret_said)
{
	g_autofree char *script =
		g_build_filename(g_getenv("PLEINAIR_SOURCE"), "tests", "real.sh", NULL);
	const char *argv[] = { "sh", script, g_getenv("PLEINAIR_BIN"), data, folder, "320x240",
		NULL };
	g_autofree char *out = NULL;
	int status;
	g_assert_true(g_spawn_sync(NULL, (char **)argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, &out,
		ret_said, &status, NULL));
	if (!WIFEXITED(status) || WEXITSTATUS(status) != expected)
		g_error("real.sh: %d\n%s%s", status, out, *ret_said);
}

/* How much the lightness of a picture varies, of 255. */
static double variation(const char *path)
{
	cairo_surface_t *s = cairo_image_surface_create_from_png(path);
	if (cairo_surface_status(s) != CAIRO_STATUS_SUCCESS)
		g_error("%s: %s", path, cairo_status_to_string(cairo_surface_status(s)));
	const unsigned char *bytes = cairo_image_surface_get_data(s);
	int width = cairo_image_surface_get_width(s), height = cairo_image_surface_get_height(s);
	double sum = 0, square = 0, count = (double)width * height;
	g_assert_true(width == 320 && height == 240);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			double light = bytes[(size_t)y * (size_t)cairo_image_surface_get_stride(s) +
					     4 * (size_t)x + 1];
			sum += light;
			square += light * light;
		}
	cairo_surface_destroy(s);
	return sqrt(fmax(square / count - sum / count * sum / count, 0));
}

/* of: "pump-pump" of several places, "pump" where it is the only one. */
static void assert_drawn(const char *folder, const char *of)
{
	for (unsigned n = 1; n <= STYLES; n++) {
		g_autofree char *file = g_strdup_printf("%s-%u.png", of, n),
				*path = g_build_filename(folder, "pictures", file, NULL);
		/* The conformance files of a format have a thousand points on a square kilometre. */
		double least = g_str_has_prefix(of, "ptx-conformance") ? 0 : n == STYLES ? 0.5 : 5;
		double got = variation(path);
		g_test_message("%s: %.1f", file, got);
		if (got < least)
			g_error("%s: lightness varies by %.2f of 255: there is nothing to see",
				file, got);
	}
}

static void test_scans(void)
{
	const char *all = shared_path("data/pump/pump.ptx");
	if (!all) {
		g_test_skip("there are no scans beside the checkout");
		return;
	}
	g_autofree char *of = g_path_get_dirname(all), *shared = g_path_get_dirname(of),
			*folder = simulated_folder(), *said = NULL,
			*data = g_build_filename(folder, "data", NULL),
			*real = g_build_filename(folder, "real", NULL);
	g_autofree char *from = g_canonicalize_filename(shared, NULL);
	g_autoptr(GDir) dir = g_dir_open(from, 0, NULL);
	g_autoptr(GPtrArray) names = g_ptr_array_new_with_free_func(g_free);
	g_assert_cmpint(g_mkdir(data, 0700), ==, 0);
	for (const char *name; (name = g_dir_read_name(dir));)
		for (size_t n = 0; n < G_N_ELEMENTS(some); n++)
			if (g_getenv("PLEINAIR_SLOW") ? n == 0 : g_str_equal(name, some[n])) {
				g_autofree char *at = g_build_filename(from, name, NULL),
						*as = g_build_filename(data, name, NULL);
				g_assert_cmpint(symlink(at, as), ==, 0);
				g_ptr_array_add(names, g_strdup(name));
			}
	run_real(data, real, 0, &said);
	for (guint n = 0; n < names->len; n++) {
		const char *name = names->pdata[n];
		g_autofree char *pictures = g_strdup_printf("%s-%s", name, name);
		assert_drawn(real, pictures);
	}
	g_autofree char *page = g_build_filename(real, "pictures", "index.html", NULL),
			*html = NULL;
	g_assert_true(g_file_get_contents(page, &html, NULL, NULL));
	for (guint n = 0; n < names->len; n++)
		g_assert_nonnull(strstr(html, names->pdata[n]));
	g_assert_nonnull(strstr(html, "155201 points"));
}

/* One that cannot be read does not keep the others from being drawn. */
static void test_bad(void)
{
	g_autofree char *folder = simulated_folder(), *said = NULL, *none = NULL, *empty = NULL,
			*data = g_build_filename(folder, "data", NULL),
			*real = g_build_filename(folder, "real", NULL),
			*good = g_build_filename(data, "a plane.xyz", NULL),
			*bad = g_build_filename(data, "bad.las", NULL);
	g_autoptr(GString) text = g_string_new(NULL);
	run_real(data, real, 1, &none);
	g_assert_nonnull(strstr(none, "there is no folder"));
	g_assert_cmpint(g_mkdir(data, 0700), ==, 0);
	run_real(data, real, 1, &empty);
	g_assert_nonnull(strstr(empty, "there are no scans"));
	for (int n = 0; n < 4000; n++)
		g_string_append_printf(
			text, "%d %d %g\n", n % 80, n / 80, 6 * sin(n % 80 / 6.0) * cos(n / 560.0));
	g_assert_true(g_file_set_contents(good, text->str, -1, NULL));
	g_assert_true(g_file_set_contents(bad, "LASF but no more", -1, NULL));
	run_real(data, real, 1, &said);
	g_assert_nonnull(strstr(said, "bad could not be made"));
	assert_drawn(real, "a-plane");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/real/scans", test_scans);
	g_test_add_func("/real/bad", test_bad);
	return g_test_run();
}
