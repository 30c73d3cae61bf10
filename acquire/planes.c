#include "acquire/planes.h"
#include "firmware-io/files.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <tiffio.h>
#include <unistd.h>

#define ROWS_PER_STRIP 32u
/* Noise does not compress: the fastest level costs a fifth of the default's time and a hundredth in
 * size. */
#define DEFLATE_LEVEL 1

const char *const planes_names[] = { "range.tiff", "intensity.tiff", "cell.tiff", "offset.tiff",
	"colour.tiff", NULL };

enum plane { RANGE, INTENSITY, CELL, OFFSET, COLOUR, PLANES };

struct layout {
	uint16_t bits, samples, format, predictor;
};

static const struct layout layouts[PLANES] = {
	[RANGE] = { 32, 1, SAMPLEFORMAT_IEEEFP, PREDICTOR_FLOATINGPOINT },
	[INTENSITY] = { 16, 1, SAMPLEFORMAT_UINT, PREDICTOR_HORIZONTAL },
	[CELL] = { 8, 1, SAMPLEFORMAT_UINT, PREDICTOR_NONE },
	[OFFSET] = { 16, 2, SAMPLEFORMAT_INT, PREDICTOR_HORIZONTAL },
	[COLOUR] = { 8, 3, SAMPLEFORMAT_UINT, PREDICTOR_HORIZONTAL },
};

static size_t cell_bytes(const struct layout *l)
{
	return l->bits / 8 * l->samples;
}

/* libtiff reports through process-wide handlers: ours keeps the last sentence of this thread. */
static _Thread_local char last_complaint[512];

static void complain(const char *module, const char *format, va_list arguments)
{
	(void)module;
	vsnprintf(last_complaint, sizeof last_complaint, format, arguments);
}

static void catch_complaints(void)
{
	last_complaint[0] = '\0';
	TIFFSetErrorHandler(complain);
	TIFFSetWarningHandler(NULL);
}

static bool fail(GError **error, const char *path, const char *what)
{
	g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_FAILED, "%s: %s%s%s", path, what,
		*last_complaint ? ": " : "", last_complaint);
	return false;
}

/* The bytes of rows [row, row + rows) as the file has them; the offsets' two planes are
 * interleaved. */
static void gather(const panorama *p, enum plane plane, uint32_t row, uint32_t rows, uint8_t *out)
{
	size_t at = panorama_index(p, row, 0), n = (size_t)rows * p->desc.columns;
	int16_t *pairs = (int16_t *)(void *)out;
	switch (plane) {
	case RANGE: memcpy(out, p->range_m + at, n * sizeof(float)); break;
	case INTENSITY: memcpy(out, p->intensity + at, n * sizeof(uint16_t)); break;
	case CELL: memcpy(out, p->cell + at, n); break;
	case COLOUR: memcpy(out, p->rgb + 3 * at, 3 * n); break;
	default:
		for (size_t i = 0; i < n; i++) {
			pairs[2 * i] = p->azimuth_offset[at + i];
			pairs[2 * i + 1] = p->elevation_offset[at + i];
		}
	}
}

static void scatter(panorama *p, enum plane plane, uint32_t row, uint32_t rows, const uint8_t *in)
{
	size_t at = panorama_index(p, row, 0), n = (size_t)rows * p->desc.columns;
	const int16_t *pairs = (const int16_t *)(const void *)in;
	switch (plane) {
	case RANGE: memcpy(p->range_m + at, in, n * sizeof(float)); break;
	case INTENSITY: memcpy(p->intensity + at, in, n * sizeof(uint16_t)); break;
	case CELL: memcpy(p->cell + at, in, n); break;
	case COLOUR: memcpy(p->rgb + 3 * at, in, 3 * n); break;
	default:
		for (size_t i = 0; i < n; i++) {
			p->azimuth_offset[at + i] = pairs[2 * i];
			p->elevation_offset[at + i] = pairs[2 * i + 1];
		}
	}
}

static void describe(TIFF *t, const panorama *p, enum plane plane)
{
	const struct layout *l = &layouts[plane];
	TIFFSetField(t, TIFFTAG_IMAGEWIDTH, p->desc.columns);
	TIFFSetField(t, TIFFTAG_IMAGELENGTH, p->desc.rows);
	TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, l->bits);
	TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, l->samples);
	TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, l->format);
	TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
	TIFFSetField(
		t, TIFFTAG_PHOTOMETRIC, plane == COLOUR ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
	TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, ROWS_PER_STRIP);
	TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
	TIFFSetField(t, TIFFTAG_ZIPQUALITY, DEFLATE_LEVEL);
	TIFFSetField(t, TIFFTAG_PREDICTOR, l->predictor);
	TIFFSetField(t, TIFFTAG_SOFTWARE, "pleinair");
	if (plane == OFFSET) {
		uint16_t extra = EXTRASAMPLE_UNSPECIFIED;
		TIFFSetField(t, TIFFTAG_EXTRASAMPLES, 1, &extra);
	}
}

static bool write_strips(TIFF *t, const panorama *p, enum plane plane)
{
	size_t row_bytes = cell_bytes(&layouts[plane]) * p->desc.columns;
	g_autofree uint8_t *strip = g_malloc(row_bytes * ROWS_PER_STRIP);
	for (uint32_t row = 0, n = 0; row < p->desc.rows; row += ROWS_PER_STRIP, n++) {
		uint32_t rows = MIN(ROWS_PER_STRIP, p->desc.rows - row);
		gather(p, plane, row, rows, strip);
		if (TIFFWriteEncodedStrip(t, n, strip, (tmsize_t)(rows * row_bytes)) < 0)
			return false;
	}
	return true;
}

static bool sync_file(const char *path, GError **error)
{
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	bool good = fd >= 0 && fsync(fd) == 0;
	if (!good)
		g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s", path,
			g_strerror(errno));
	if (fd >= 0)
		close(fd);
	return good;
}

static char *plane_path(const char *folder, enum plane plane)
{
	return g_build_filename(folder, planes_names[plane], NULL);
}

/* Where a plane is written before it takes the old one's place. */
static char *fresh_path(const char *folder, enum plane plane)
{
	g_autofree char *name = g_strdup_printf(".%s.new", planes_names[plane]);
	return g_build_filename(folder, name, NULL);
}

static bool write_fresh(const panorama *p, enum plane plane, const char *folder, GError **error)
{
	g_autofree char *path = plane_path(folder, plane), *fresh = fresh_path(folder, plane);
	catch_complaints();
	TIFF *t = TIFFOpen(fresh, "w");
	if (!t)
		return fail(error, path, "cannot be written");
	describe(t, p, plane);
	bool good = write_strips(t, p, plane) && TIFFFlush(t);
	TIFFClose(t);
	/* TIFFClose has no result; what it complains of was not written either. */
	return good && !*last_complaint ? sync_file(fresh, error)
					: fail(error, path, "cannot be written");
}

static bool rename_fresh(const char *folder, int count, GError **error)
{
	for (int i = 0; i < count; i++) {
		g_autofree char *path = plane_path(folder, i), *fresh = fresh_path(folder, i);
		if (rename(fresh, path) < 0)
			return files_fail(error, path, "write");
	}
	return true;
}

static void remove_fresh(const char *folder)
{
	for (int i = 0; i < PLANES; i++) {
		g_autofree char *fresh = fresh_path(folder, i);
		unlink(fresh);
	}
}

static bool remove_colour(const char *folder, GError **error)
{
	g_autofree char *path = plane_path(folder, COLOUR);
	return unlink(path) == 0 || errno == ENOENT || files_fail(error, path, "remove");
}

/* Of planes that were worked on side by side: the first one's is handed on; false: there is one. */
static bool first_error(GError *errors[], int count, GError **error)
{
	bool good = true;
	for (int i = 0; i < count; i++) {
		if (good && errors[i]) {
			g_propagate_error(error, g_steal_pointer(&errors[i]));
			good = false;
		}
		g_clear_error(&errors[i]);
	}
	return good;
}

bool planes_save(const panorama *p, const char *folder, GError **error)
{
	GError *errors[PLANES] = { NULL };
	int count = p->rgb ? PLANES : COLOUR;
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < count; i++)
		write_fresh(p, i, folder, &errors[i]);
	bool good = first_error(errors, count, error) && rename_fresh(folder, count, error) &&
		    (p->rgb || remove_colour(folder, error)) && files_sync_folder(folder, error);
	if (!good)
		remove_fresh(folder);
	return good;
}

static bool has_layout(TIFF *t, const panorama *p, enum plane plane)
{
	const struct layout *l = &layouts[plane];
	uint32_t width = 0, height = 0, strip = 0;
	uint16_t bits = 0, samples = 0, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG,
		 compression = COMPRESSION_NONE;
	TIFFGetField(t, TIFFTAG_IMAGEWIDTH, &width);
	TIFFGetField(t, TIFFTAG_IMAGELENGTH, &height);
	TIFFGetFieldDefaulted(t, TIFFTAG_BITSPERSAMPLE, &bits);
	TIFFGetFieldDefaulted(t, TIFFTAG_SAMPLESPERPIXEL, &samples);
	TIFFGetFieldDefaulted(t, TIFFTAG_SAMPLEFORMAT, &format);
	TIFFGetFieldDefaulted(t, TIFFTAG_PLANARCONFIG, &planar);
	TIFFGetFieldDefaulted(t, TIFFTAG_ROWSPERSTRIP, &strip);
	TIFFGetFieldDefaulted(t, TIFFTAG_COMPRESSION, &compression);
	return width == p->desc.columns && height == p->desc.rows && bits == l->bits &&
	       samples == l->samples && format == l->format && planar == PLANARCONFIG_CONTIG &&
	       compression == COMPRESSION_ADOBE_DEFLATE && !TIFFIsTiled(t) &&
	       strip == ROWS_PER_STRIP;
}

static bool read_strips(TIFF *t, panorama *p, enum plane plane)
{
	size_t row_bytes = cell_bytes(&layouts[plane]) * p->desc.columns;
	g_autofree uint8_t *strip = g_malloc(row_bytes * ROWS_PER_STRIP);
	for (uint32_t row = 0, n = 0; row < p->desc.rows; row += ROWS_PER_STRIP, n++) {
		uint32_t rows = MIN(ROWS_PER_STRIP, p->desc.rows - row);
		tmsize_t want = (tmsize_t)(rows * row_bytes);
		if (TIFFReadEncodedStrip(t, n, strip, want) != want)
			return false;
		scatter(p, plane, row, rows, strip);
	}
	return true;
}

static bool load_plane(panorama *p, enum plane plane, const char *folder, GError **error)
{
	g_autofree char *path = plane_path(folder, plane);
	int fd = files_open_plain(path, NULL, error);
	if (fd < 0)
		return false;
	catch_complaints();
	TIFF *t = TIFFFdOpen(fd, path, "r");
	if (!t) {
		close(fd);
		return fail(error, path, "cannot be read");
	}
	bool fits = has_layout(t, p, plane), good = fits && read_strips(t, p, plane);
	TIFFClose(t);
	if (!fits)
		return fail(error, path,
			"is not the plane of this scan: its size or type differs from scan.json");
	return good || fail(error, path, "is damaged");
}

/* What the planes may say is checked once here, so that nobody has to again. */
static bool check_cells(const panorama *p, const char *folder, GError **error)
{
	for (size_t i = 0; i < (size_t)p->desc.columns * p->desc.rows; i++) {
		bool has_range = p->range_m[i] > 0 && p->range_m[i] < 1e6f;
		bool wants_range = p->cell[i] == CELL_MEASURED || p->cell[i] == CELL_FILLED;
		if (p->cell[i] <= CELL_NO_RETURN && has_range == wants_range &&
			(has_range || p->range_m[i] == 0))
			continue;
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"%s%c%s: row %zu, column %zu: range %g contradicts %u in %s", folder,
			G_DIR_SEPARATOR, planes_names[RANGE], i / p->desc.columns,
			i % p->desc.columns, (double)p->range_m[i], p->cell[i], planes_names[CELL]);
		return false;
	}
	return true;
}

panorama *planes_load(const char *folder, const struct panorama_desc *desc, GError **error)
{
	g_autoptr(panorama) p = panorama_new(desc, error);
	g_autofree char *colour = plane_path(folder, COLOUR);
	if (!p)
		return NULL;
	if (g_file_test(colour, G_FILE_TEST_EXISTS))
		p->rgb = g_malloc0((size_t)desc->columns * desc->rows * 3);
	GError *errors[PLANES] = { NULL };
	int count = p->rgb ? PLANES : COLOUR;
#pragma omp parallel for schedule(dynamic, 1)
	for (int i = 0; i < count; i++)
		load_plane(p, i, folder, &errors[i]);
	if (!first_error(errors, count, error))
		return NULL;
	return check_cells(p, folder, error) ? g_steal_pointer(&p) : NULL;
}
