/* Planes and pictures on disk: what was saved is read back, what was damaged is refused by name. */
#include "acquire/picture.h"
#include "acquire/planes.h"
#include "tests/simulated.h"
#include <glib/gstdio.h>
#include <math.h>
#include <png.h>
#include <string.h>
#include <sys/stat.h>
#include <tiffio.h>
#include <unistd.h>

#define COLUMNS 100u
#define ROWS    70u

static panorama *made(bool colour)
{
	struct panorama_desc desc = panorama_desc_for(COLUMNS, ROWS);
	panorama *p = panorama_new(&desc, NULL);
	g_autoptr(GRand) r = g_rand_new_with_seed(9);
	if (colour)
		p->rgb = g_malloc0((size_t)3 * COLUMNS * ROWS);
	for (size_t i = 0; i < COLUMNS * ROWS; i++) {
		bool has_range = g_rand_boolean(r);
		p->cell[i] = has_range           ? g_rand_boolean(r) ? CELL_MEASURED : CELL_FILLED
			     : g_rand_boolean(r) ? CELL_EMPTY
						 : CELL_NO_RETURN;
		p->range_m[i] = has_range ? (float)g_rand_double_range(r, 0.1, 200) : 0;
		p->intensity[i] = (uint16_t)g_rand_int_range(r, 0, 65536);
		p->azimuth_offset[i] = (int16_t)g_rand_int_range(r, -32767, 32768);
		p->elevation_offset[i] = (int16_t)g_rand_int_range(r, -32767, 32768);
		for (int k = 0; colour && k < 3; k++)
			p->rgb[3 * i + k] = (uint8_t)g_rand_int_range(r, 0, 256);
	}
	return p;
}

static char *plane_path(const char *folder, const char *name)
{
	return g_build_filename(folder, name, NULL);
}

static void assert_same(const panorama *a, const panorama *b)
{
	size_t n = COLUMNS * ROWS;
	g_assert_cmpmem(a->range_m, 4 * n, b->range_m, 4 * n);
	g_assert_cmpmem(a->intensity, 2 * n, b->intensity, 2 * n);
	g_assert_cmpmem(a->cell, n, b->cell, n);
	g_assert_cmpmem(a->azimuth_offset, 2 * n, b->azimuth_offset, 2 * n);
	g_assert_cmpmem(a->elevation_offset, 2 * n, b->elevation_offset, 2 * n);
	g_assert_true((a->rgb != NULL) == (b->rgb != NULL));
	if (a->rgb)
		g_assert_cmpmem(a->rgb, 3 * n, b->rgb, 3 * n);
}

/* With colour, then without into the same folder: what is loaded is what was saved last. */
static void test_round_trip(void)
{
	g_autofree char *folder = simulated_folder();
	for (int colour = 1; colour >= 0; colour--) {
		g_autoptr(GError) error = NULL;
		g_autoptr(panorama) p = made(colour);
		g_assert_true(planes_save(p, folder, &error));
		g_assert_no_error(error);
		g_autoptr(panorama) q = planes_load(folder, &p->desc, &error);
		g_assert_no_error(error);
		assert_same(p, q);
	}
}

/* ---- damage ---- */

static void cut(const char *path)
{
	struct stat s;
	g_assert_cmpint(stat(path, &s), ==, 0);
	g_assert_cmpint(truncate(path, s.st_size * 2 / 3), ==, 0);
}

static void empty(const char *path)
{
	g_assert_cmpint(truncate(path, 0), ==, 0);
}

static void garbage(const char *path)
{
	g_autofree char *bytes = g_malloc(5000);
	g_autoptr(GRand) r = g_rand_new_with_seed(3);
	for (int i = 0; i < 5000; i++)
		bytes[i] = (char)g_rand_int(r);
	g_assert_true(g_file_set_contents(path, bytes, 5000, NULL));
}

/* The compressed data is spoilt, the tags are not. */
static void spoil(const char *path)
{
	g_autofree char *bytes = NULL;
	gsize length;
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	memset(bytes + 40, 0x5a, 200);
	g_assert_true(g_file_set_contents(path, bytes, (gssize)length, NULL));
}

static void folder_instead(const char *path)
{
	g_assert_cmpint(remove(path), ==, 0);
	g_assert_cmpint(g_mkdir(path, 0777), ==, 0);
}

static void gone(const char *path)
{
	g_assert_cmpint(remove(path), ==, 0);
}

struct shape {
	uint32_t width, height, rows_per_strip, tile;
	uint16_t bits, samples, format;
};

static void write_shape(const char *path, const struct shape *s)
{
	g_autofree uint8_t *bytes = g_malloc0((size_t)1 << 20);
	TIFF *t = TIFFOpen(path, "w");
	TIFFSetField(t, TIFFTAG_IMAGEWIDTH, s->width);
	TIFFSetField(t, TIFFTAG_IMAGELENGTH, s->height);
	TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, s->bits);
	TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, s->samples);
	TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, s->format);
	TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
	TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
	if (s->tile) {
		TIFFSetField(t, TIFFTAG_TILEWIDTH, s->tile);
		TIFFSetField(t, TIFFTAG_TILELENGTH, s->tile);
		for (uint32_t i = 0; i < TIFFNumberOfTiles(t); i++)
			TIFFWriteEncodedTile(t, i, bytes, TIFFTileSize(t));
	} else {
		TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, s->rows_per_strip);
		for (uint32_t i = 0; i < TIFFNumberOfStrips(t); i++)
			TIFFWriteEncodedStrip(t, i, bytes, TIFFVStripSize(t, s->rows_per_strip));
	}
	TIFFClose(t);
}

#define SHAPE(name, ...)                                                                           \
	static void name(const char *path)                                                         \
	{                                                                                          \
		write_shape(path, &(struct shape){ __VA_ARGS__ });                                 \
	}
SHAPE(tiled, COLUMNS, ROWS, 0, 16, 8, 1, SAMPLEFORMAT_UINT)
SHAPE(other_strips, COLUMNS, ROWS, 10, 0, 8, 1, SAMPLEFORMAT_UINT)
SHAPE(one_strip, COLUMNS, ROWS, ROWS, 0, 8, 1, SAMPLEFORMAT_UINT)
SHAPE(wider, COLUMNS + 1, ROWS, 32, 0, 8, 1, SAMPLEFORMAT_UINT)
SHAPE(higher, COLUMNS, ROWS + 1, 32, 0, 8, 1, SAMPLEFORMAT_UINT)
SHAPE(of_16_bits, COLUMNS, ROWS, 32, 0, 16, 1, SAMPLEFORMAT_UINT)
SHAPE(of_3_samples, COLUMNS, ROWS, 32, 0, 8, 3, SAMPLEFORMAT_UINT)
SHAPE(of_signs, COLUMNS, ROWS, 32, 0, 8, 1, SAMPLEFORMAT_INT)

/* Whole files whose cells say other things than their ranges. */
static void save_with(const char *path, size_t i, float range_m, uint8_t cell)
{
	g_autofree char *folder = g_path_get_dirname(path);
	g_autoptr(panorama) p = made(true);
	p->range_m[i] = range_m;
	p->cell[i] = cell;
	g_assert_true(planes_save(p, folder, NULL));
}
#define CELLS(name, range_m, cell)                                                                 \
	static void name(const char *path)                                                         \
	{                                                                                          \
		save_with(path, 1234, range_m, cell);                                              \
	}
CELLS(measured_nothing, 0, CELL_MEASURED)
CELLS(empty_with_range, 5, CELL_EMPTY)
CELLS(sky_with_range, 5, CELL_NO_RETURN)
CELLS(negative_range, -5, CELL_MEASURED)
CELLS(no_number, NAN, CELL_MEASURED)
CELLS(no_number_empty, NAN, CELL_EMPTY)
CELLS(endless, INFINITY, CELL_FILLED)
CELLS(unknown_cell, 0, 4)

static const struct damage {
	const char *path, *file;
	void (*damage)(const char *path);
} damages[] = {
	{ "gone", "range.tiff", gone },
	{ "offsets-gone", "offset.tiff", gone },
	{ "cut", "range.tiff", cut },
	{ "colour-cut", "colour.tiff", cut },
	{ "empty-file", "intensity.tiff", empty },
	{ "garbage", "cell.tiff", garbage },
	{ "spoilt", "range.tiff", spoil },
	{ "spoilt-offsets", "offset.tiff", spoil },
	{ "a-folder", "cell.tiff", folder_instead },
	{ "tiled", "cell.tiff", tiled },
	{ "other-strips", "cell.tiff", other_strips },
	{ "one-strip", "cell.tiff", one_strip },
	{ "wider", "cell.tiff", wider },
	{ "higher", "cell.tiff", higher },
	{ "16-bits", "cell.tiff", of_16_bits },
	{ "3-samples", "cell.tiff", of_3_samples },
	{ "signed", "cell.tiff", of_signs },
	{ "range-of-8-bits", "range.tiff", other_strips },
	{ "measured-nothing", "cell.tiff", measured_nothing },
	{ "empty-with-range", "cell.tiff", empty_with_range },
	{ "sky-with-range", "cell.tiff", sky_with_range },
	{ "negative", "cell.tiff", negative_range },
	{ "no-number", "cell.tiff", no_number },
	{ "no-number-empty", "cell.tiff", no_number_empty },
	{ "endless", "cell.tiff", endless },
	{ "unknown-cell", "cell.tiff", unknown_cell },
};

static void test_damage(gconstpointer data)
{
	const struct damage *d = data;
	g_autofree char *folder = simulated_folder(), *path = plane_path(folder, d->file);
	g_autoptr(panorama) p = made(true);
	g_autoptr(GError) error = NULL;
	g_assert_true(planes_save(p, folder, NULL));
	d->damage(path);
	g_autoptr(panorama) q = planes_load(folder, &p->desc, &error);
	g_test_message("%s", error ? error->message : "taken");
	g_assert_null(q);
	g_assert_nonnull(error);
	g_assert_nonnull(strstr(error->message, d->file));
	g_assert_null(strchr(error->message, '\n'));
}

static void test_unwritable(void)
{
	g_autofree char *folder = simulated_folder(), *none = plane_path(folder, "not-there");
	g_autoptr(panorama) p = made(true);
	g_autoptr(GError) error = NULL;
	g_assert_false(planes_save(p, none, &error));
	g_assert_nonnull(error);
	g_assert_nonnull(strstr(error->message, "range.tiff"));
}

/* ---- pictures ---- */

static uint8_t *read_png(const char *path)
{
	png_image image = { .version = PNG_IMAGE_VERSION };
	g_assert_true(png_image_begin_read_from_file(&image, path));
	g_assert_cmpuint(image.width, ==, COLUMNS);
	g_assert_cmpuint(image.height, ==, ROWS);
	image.format = PNG_FORMAT_RGB;
	uint8_t *rgb = g_malloc(PNG_IMAGE_SIZE(image));
	g_assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
	return rgb;
}

static uint8_t *saved(const panorama *p, enum picture kind)
{
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, picture_names[kind], NULL);
	g_autoptr(GError) error = NULL;
	g_assert_true(picture_save(p, kind, path, &error));
	g_assert_no_error(error);
	return read_png(path);
}

static void assert_rgb(const uint8_t *picture, size_t i, int r, int g, int b)
{
	g_assert_cmpint(picture[3 * i], ==, r);
	g_assert_cmpint(picture[3 * i + 1], ==, g);
	g_assert_cmpint(picture[3 * i + 2], ==, b);
}

static void test_cells_picture(void)
{
	g_autoptr(panorama) p = made(true);
	static const uint8_t wanted[][3] = { [CELL_EMPTY] = { 0, 0, 0 },
		[CELL_MEASURED] = { 255, 255, 255 },
		[CELL_FILLED] = { 240, 140, 30 },
		[CELL_NO_RETURN] = { 60, 100, 200 } };
	g_autofree uint8_t *cells = saved(p, PICTURE_CELLS), *colour = saved(p, PICTURE_COLOUR);
	for (size_t i = 0; i < COLUMNS * ROWS; i++) {
		const uint8_t *w = wanted[p->cell[i]];
		assert_rgb(cells, i, w[0], w[1], w[2]);
		assert_rgb(colour, i, p->rgb[3 * i], p->rgb[3 * i + 1], p->rgb[3 * i + 2]);
	}
}

/* Near is red, far is blue, what has no range is black. */
static void test_range_picture(void)
{
	g_autoptr(panorama) p = made(false);
	for (size_t i = 0; i < COLUMNS * ROWS; i++) {
		p->cell[i] = i < COLUMNS ? CELL_NO_RETURN : CELL_MEASURED;
		p->range_m[i] = i < COLUMNS        ? 0
				: i < 10 * COLUMNS ? 1
				: i < 20 * COLUMNS ? 10
						   : 100;
	}
	g_autofree uint8_t *range = saved(p, PICTURE_RANGE);
	assert_rgb(range, 5, 0, 0, 0);
	assert_rgb(range, 5 * COLUMNS, 122, 4, 3);
	assert_rgb(range, 15 * COLUMNS, 150, 250, 80); /* half way in the logarithm */
	assert_rgb(range, 50 * COLUMNS, 48, 18, 59);
}

static void test_intensity_picture(void)
{
	g_autoptr(panorama) p = made(false);
	for (size_t i = 0; i < COLUMNS * ROWS; i++) {
		bool sky = i < COLUMNS;
		p->cell[i] = sky ? CELL_NO_RETURN : CELL_MEASURED;
		p->range_m[i] = sky ? 0 : 10;
		p->intensity[i] = (uint16_t)(i / COLUMNS * 100);
	}
	g_autofree uint8_t *grey = saved(p, PICTURE_INTENSITY);
	int last = -1;
	for (size_t row = 1; row < ROWS; row++) {
		const uint8_t *pixel = grey + 3 * row * COLUMNS;
		g_assert_cmpint(pixel[0], >=, last);
		g_assert_true(pixel[0] == pixel[1] && pixel[1] == pixel[2]);
		last = pixel[0];
	}
	assert_rgb(grey, 5, 0, 0, 0);
	assert_rgb(grey, COLUMNS, 0, 0, 0);
	g_assert_cmpint(last, ==, 255);
}

/* All cells alike, at the ends of what there is: one even tone, not noise. */
static void test_even_pictures(void)
{
	static const struct {
		float range_m;
		uint16_t intensity;
	} all[] = { { 1, 0 }, { 200, 65535 }, { 0.05f, 3 }, { 900000, 65535 } };
	for (size_t k = 0; k < G_N_ELEMENTS(all); k++) {
		g_autoptr(panorama) p = made(false);
		for (size_t i = 0; i < COLUMNS * ROWS; i++) {
			p->cell[i] = CELL_MEASURED;
			p->range_m[i] = all[k].range_m;
			p->intensity[i] = all[k].intensity;
		}
		g_autofree uint8_t *range = saved(p, PICTURE_RANGE);
		g_autofree uint8_t *grey = saved(p, PICTURE_INTENSITY);
		assert_rgb(range, 77, 122, 4, 3);
		assert_rgb(grey, 77, 0, 0, 0);
	}
}

static void test_empty_pictures(void)
{
	struct panorama_desc desc = panorama_desc_for(COLUMNS, ROWS);
	g_autoptr(panorama) p = panorama_new(&desc, NULL);
	g_autofree uint8_t *range = saved(p, PICTURE_RANGE), *grey = saved(p, PICTURE_INTENSITY),
			   *cells = saved(p, PICTURE_CELLS);
	for (size_t i = 0; i < COLUMNS * ROWS; i++) {
		assert_rgb(range, i, 0, 0, 0);
		assert_rgb(grey, i, 0, 0, 0);
		assert_rgb(cells, i, 0, 0, 0);
	}
}

static guint files_in(const char *folder)
{
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	guint n = 0;
	while (g_dir_read_name(dir))
		n++;
	return n;
}

static void test_picture_refused(void)
{
	g_autofree char *folder = simulated_folder(), *path = plane_path(folder, "a.png"),
			*beyond = g_build_filename(folder, "none", "a.png", NULL);
	g_autoptr(panorama) p = made(false);
	g_autoptr(GError) no_colour = NULL, no_folder = NULL, in_the_way = NULL;
	g_assert_false(picture_save(p, PICTURE_COLOUR, path, &no_colour));
	g_assert_nonnull(strstr(no_colour->message, "a.png"));
	g_assert_false(picture_save(p, PICTURE_CELLS, beyond, &no_folder));
	g_assert_nonnull(strstr(no_folder->message, "a.png"));
	g_assert_cmpuint(files_in(folder), ==, 0);
	/* A folder stands where the picture should go. */
	g_assert_cmpint(g_mkdir(path, 0777), ==, 0);
	g_assert_false(picture_save(p, PICTURE_CELLS, path, &in_the_way));
	g_assert_nonnull(strstr(in_the_way->message, "a.png"));
	g_assert_cmpuint(files_in(folder), ==, 1);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/planes/round-trip", test_round_trip);
	for (size_t i = 0; i < G_N_ELEMENTS(damages); i++) {
		g_autofree char *path = g_strconcat("/planes/damage/", damages[i].path, NULL);
		g_test_add_data_func(path, &damages[i], test_damage);
	}
	g_test_add_func("/planes/unwritable", test_unwritable);
	g_test_add_func("/picture/cells", test_cells_picture);
	g_test_add_func("/picture/range", test_range_picture);
	g_test_add_func("/picture/intensity", test_intensity_picture);
	g_test_add_func("/picture/even", test_even_pictures);
	g_test_add_func("/picture/empty", test_empty_pictures);
	g_test_add_func("/picture/refused", test_picture_refused);
	return g_test_run();
}
