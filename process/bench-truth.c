#include "process/bench-truth.h"
#include "firmware-io/files.h"
#include "process/bench-run.h"
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
#define LIGHT_HEADER 16

/* The file that the simulator writes, of so many bytes; what: its options, the second may be NULL; caller frees. */
static char *ask(const char *const what[2], const char *description, uint32_t columns,
	uint32_t rows, const char *path, size_t bytes, GError **error)
{
	g_autofree char *simulator = bench_program("sim");
	g_autofree char *wide = g_strdup_printf("--columns=%u", columns);
	g_autofree char *high = g_strdup_printf("--rows=%u", rows);
	g_autoptr(GSubprocess) p = g_subprocess_new(G_SUBPROCESS_FLAGS_NONE, error, simulator, wide,
		high, "-o", path, description, what[0], what[1], NULL);
	if (!p || !g_subprocess_wait_check(p, NULL, error))
		return NULL;
	size_t length;
	g_autofree char *ret = files_read(path, bytes, &length, error);
	if (ret && length == bytes)
		return g_steal_pointer(&ret);
	if (ret)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"%s: is not the truth of this scan", path);
	return NULL;
}

static bool ask_truth(const char *const what[2], const char *description, uint32_t columns,
	uint32_t rows, const char *path, struct bench_truth_scan *ret, GError **error)
{
	const size_t cells = (size_t)columns * rows;
	g_autofree char *bytes = ask(what, description, columns, rows, path,
		sizeof(struct truth_header) + cells * sizeof(struct bench_truth_cell), error);
	const struct truth_header *h = (const struct truth_header *)bytes;
	if (!bytes)
		return false;
	if (memcmp(h->magic, "PLTRUTH1", 8) || h->columns != columns) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"%s: is not the truth of this scan", path);
		return false;
	}
	memcpy(ret->pose.translation_m, h->position_m, sizeof h->position_m);
	memcpy(ret->pose.rotation, h->rotation, sizeof h->rotation);
	ret->elevation_max_rad = h->elevation_max_rad;
	ret->elevation_min_rad = h->elevation_min_rad;
	ret->columns = columns;
	ret->rows = rows;
	ret->cell = g_memdup2(bytes + sizeof *h, cells * sizeof *ret->cell);
	return true;
}

bool bench_truth_ask(const char *description, uint32_t columns, uint32_t rows, const char *path,
	struct bench_truth_scan *ret, GError **error)
{
	const char *const what[2] = { "--truth", NULL };
	return ask_truth(what, description, columns, rows, path, ret, error);
}

bool bench_truth_ask_behind(const char *description, uint32_t columns, uint32_t rows,
	const char *path, struct bench_truth_scan *ret, GError **error)
{
	const char *const what[2] = { "--truth", "--behind-panes" };
	return ask_truth(what, description, columns, rows, path, ret, error);
}

float *bench_truth_light(
	const char *description, uint32_t columns, uint32_t rows, const char *path, GError **error)
{
	const size_t bytes = (size_t)columns * rows * 3 * sizeof(float);
	const char *const what[2] = { "--light", NULL };
	g_autofree char *light =
		ask(what, description, columns, rows, path, LIGHT_HEADER + bytes, error);
	return light ? g_memdup2(light + LIGHT_HEADER, bytes) : NULL;
}
