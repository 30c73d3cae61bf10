#include "process/bench-truth.h"
#include "firmware-io/files.h"
#include <gio/gio.h>
#include <string.h>

const char *const bench_truth_names[BENCH_TRUTH_CLASSES] = { "nothing", "building", "vegetation",
	"terrain", "structure", "water", "vehicle", "person", "furniture" };

struct truth_header {
	char magic[8];
	uint32_t columns, rows;
	double elevation_max_rad, elevation_min_rad, position_m[3], rotation[9];
};
_Static_assert(sizeof(struct truth_header) == 128 && sizeof(struct bench_truth_cell) == 20,
	"the file's own layout");

static char *find_simulator(void)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autofree char *folder = self ? g_path_get_dirname(self) : g_strdup(".");
	char *beside = g_build_filename(folder, "pleinair-sim", NULL);
	if (g_file_test(beside, G_FILE_TEST_IS_EXECUTABLE))
		return beside;
	g_free(beside);
	return g_strdup("pleinair-sim");
}

static bool read_truth(const char *path, uint32_t columns, uint32_t rows,
	struct bench_truth_scan *ret, GError **error)
{
	size_t length, cells = (size_t)columns * rows;
	size_t wanted = sizeof(struct truth_header) + cells * sizeof(struct bench_truth_cell);
	g_autofree char *bytes = files_read(path, wanted, &length, error);
	const struct truth_header *h = (const struct truth_header *)bytes;
	if (!bytes)
		return false;
	if (length != wanted || memcmp(h->magic, "PLTRUTH1", 8) || h->columns != columns) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"%s: is not the truth of this scan", path);
		return false;
	}
	memcpy(ret->pose.translation_m, h->position_m, sizeof h->position_m);
	memcpy(ret->pose.rotation, h->rotation, sizeof h->rotation);
	ret->elevation_max_rad = h->elevation_max_rad;
	ret->elevation_min_rad = h->elevation_min_rad;
	ret->cell = g_memdup2(bytes + sizeof *h, cells * sizeof *ret->cell);
	return true;
}

bool bench_truth_ask(const char *description, uint32_t columns, uint32_t rows, const char *path,
	struct bench_truth_scan *ret, GError **error)
{
	g_autofree char *simulator = find_simulator();
	g_autofree char *wide = g_strdup_printf("--columns=%u", columns);
	g_autofree char *high = g_strdup_printf("--rows=%u", rows);
	g_autoptr(GSubprocess) p = g_subprocess_new(G_SUBPROCESS_FLAGS_NONE, error, simulator,
		"--truth", wide, high, "-o", path, description, NULL);
	return p && g_subprocess_wait_check(p, NULL, error) &&
	       read_truth(path, columns, rows, ret, error);
}
