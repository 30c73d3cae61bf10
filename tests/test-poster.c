/* Pictures that are drawn in windows: each shipped style looks as it does when it is drawn at once, and files come row by row. */
#include "render/picture-writer.h"
#include "render/poster.h"
#include "render/sheet-plan.h"
#include "tests/gles-here.h"
#include "tests/pictures-differ.h"
#include "tests/scene-made.h"
#include <gio/gio.h>
#include <png.h>
#include <tiffio.h>

#define WIDTH  1136u
#define HEIGHT 800u

static struct camera before_court(void)
{
	static const double eye[3] = { 103, 197.5, 5.2 }, target[3] = { 103, 204, 4 };
	return camera_look_at(eye, target, 52, WIDTH, HEIGHT);
}

/* ---- drawing ---- */

struct put {
	struct picture_buffer to;
	uint32_t calls, next;
};

static bool take(void *data, struct picture_buffer *rows, uint32_t from, GError **error)
{
	struct put *p = data;
	(void)error;
	g_assert_cmpuint(from, ==, p->next);
	g_assert_cmpuint(rows->width, ==, p->to.width);
	memcpy(p->to.rgba + (size_t)from * rows->width, rows->rgba,
		(size_t)rows->width * rows->height * 4);
	p->next += rows->height;
	p->calls++;
	return true;
}

/* In windows of so many bytes; 0: at once. */
static struct picture_buffer drawn(
	painter *p, const drawing *d, uint32_t reduce, size_t bytes, uint32_t *ret_calls)
{
	g_autoptr(GError) error = NULL;
	struct camera c = before_court();
	struct put put = { .to = picture_buffer_new(WIDTH / reduce, HEIGHT / reduce) };
	g_autoptr(frame) f = frame_new(made_shared_court(), d, &c, &error);
	g_assert_no_error(error);
	struct poster_desc desc = { .reduce = reduce, .bytes = bytes, .take = take, .data = &put };
	g_assert_true(poster_draw(p, f, &c, &desc, NULL, &error));
	g_assert_no_error(error);
	g_assert_cmpuint(put.next, ==, HEIGHT / reduce);
	*ret_calls = put.calls;
	return put.to;
}

static drawing *drawing_of(const char *name)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(style) s = style_find(name, NULL, &error);
	g_assert_no_error(error);
	g_autoptr(segments) tree = made_tree();
	drawing *d = drawing_new(s, tree, NULL, &error);
	g_assert_no_error(error);
	return d;
}

/* ---- the same picture ---- */

/* Places are rounded more finely in windows: of a million values few differ at all. */
#define MEAN_MOST   0.002 /* of 255 */
#define WITHIN_PART 0.9999

/* So much memory that there are some windows, less wide than the picture where margins allow it. */
#define BYTES ((size_t)9 << 20)

static void assert_same(painter *p, const char *name)
{
	g_autoptr(drawing) d = drawing_of(name);
	uint32_t once, calls;
	struct camera c = before_court();
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
	struct poster_grid g = poster_grid_of(f, &c, BYTES, painter_side_most(p));
	struct picture_buffer whole = drawn(p, d, 1, 0, &once),
			      parts = drawn(p, d, 1, BYTES, &calls);
	struct difference off = differ(&whole, &parts);
	g_test_message("%s: %u x %u windows, margin %u: mean %.4f, %.4f %% within %d, at most %d",
		name, g.columns, g.rows, g.margin_px, off.mean, 100 * off.within, FAR, off.most);
	g_assert_cmpuint(once, ==, 1);
	bool is_same = off.mean <= MEAN_MOST && off.within >= WITHIN_PART;
	if (!is_same)
		save_all(&whole, &parts, name);
	g_assert_true(is_same);
	picture_buffer_clear(&whole);
	picture_buffer_clear(&parts);
}

/* Along the wall, behind the tree, and before it. */
static void draw_lines_too(void)
{
	g_autoptr(profile_lines) p = profile_lines_new();
	for (int n = 0; n < 9; n++)
		made_add_line(p, n % PROFILE_KINDS, 100, 205 - n % 2, 3.1 + 0.25 * n, 106,
			205 - n % 2, 3.2 + 0.2 * n);
	scene_set_lines((scene *)made_shared_court(), p);
}

static void shipped_styles(void)
{
	g_autoptr(painter) p = painter_new(BACKEND_WISH_CPU, NULL);
	g_auto(GStrv) names = style_names(NULL);
	for (char **name = names; *name; name++)
		assert_same(p, *name);
}

/* A style of each kind: strokes, filters, dots that are told by the whole picture, paint. */
static void on_gles(void)
{
	static const char *const names[] = { "figure-7d", "watercolour", "stipple-diffuse",
		"gouache", "construction-lines" };
	g_autoptr(GError) error = NULL;
	if (!gles_here())
		return;
	g_autoptr(painter) p = painter_new(BACKEND_WISH_GLES, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(painter_side_most(p), >=, 2048);
	for (size_t n = 0; n < G_N_ELEMENTS(names); n++)
		assert_same(p, names[n]);
}

/* Reduced as pictures are that were drawn larger. */
static void reduces(void)
{
	g_autoptr(painter) p = painter_new(BACKEND_WISH_CPU, NULL);
	g_autoptr(drawing) d = drawing_of("pencil");
	uint32_t calls;
	struct picture_buffer whole = drawn(p, d, 1, 0, &calls),
			      parts = drawn(p, d, 2, BYTES, &calls),
			      small = picture_buffer_reduced(&whole, 2);
	struct difference off = differ(&small, &parts);
	g_assert_cmpfloat(off.mean, <=, MEAN_MOST);
	picture_buffer_clear(&whole);
	picture_buffer_clear(&parts);
	picture_buffer_clear(&small);
}

/* Memory is bounded: a poster's windows are as large as those of a picture that just needs some. */
static void grids_fit(void)
{
	g_autoptr(drawing) d = drawing_of("watercolour");
	struct camera c = before_court();
	c = camera_scaled(&c, 28);
	struct camera first = camera_window(&c, 0, 0, 1, 1);
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &first);
	struct poster_grid g = poster_grid_of(f, &c, POSTER_BYTES, CAMERA_SIDE_MAX);
	uint64_t covered = 0;
	for (uint32_t row = 0; row < g.rows; row++)
		for (uint32_t column = 0; column < g.columns; column++) {
			struct poster_window w = poster_window_at(&c, &g, 2, column, row);
			covered += (uint64_t)(w.right - w.left) * (w.bottom - w.top);
			g_assert_cmpuint((uint64_t)w.camera.width * w.camera.height, <, 9000000);
			g_assert_cmpuint(w.camera.whole.left % (2 * SHEET_BLOCK), ==, 0);
		}
	g_assert_cmpuint(covered, ==, (uint64_t)c.width * c.height);
}

/* ---- who stops, and who cannot be drawn in windows ---- */

static bool stop_at_once(void *data, double part, GError **error)
{
	(void)data;
	g_assert_cmpfloat(part, <, 1);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
	return false;
}

static void stops(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(painter) p = painter_new(BACKEND_WISH_CPU, NULL);
	g_autoptr(drawing) d = drawing_of("pencil");
	struct camera c = before_court();
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
	struct poster_desc desc = { .bytes = BYTES, .take = take, .going = stop_at_once };
	g_assert_false(poster_draw(p, f, &c, &desc, NULL, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
}

/* ---- files ---- */

static char *written(const char *folder, const char *name, const struct picture_buffer *p)
{
	g_autoptr(GError) error = NULL;
	char *path = g_build_filename(folder, name, NULL);
	g_autoptr(picture_writer) w = picture_writer_new(path, p->width, p->height, 254, &error);
	g_assert_no_error(error);
	for (uint32_t y = 0; y < p->height; y += 7) {
		struct picture_buffer rows = { p->width, MIN(7, p->height - y),
			p->rgba + (size_t)y * p->width };
		g_assert_true(picture_writer_add(w, &rows, &error));
		g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
	}
	g_assert_true(picture_writer_finish(w, &error));
	g_assert_no_error(error);
	return path;
}

static struct picture_buffer coloured(void)
{
	struct picture_buffer p = picture_buffer_new(37, 30);
	for (uint32_t i = 0; i < p.width * p.height; i++)
		for (uint32_t k = 0; k < 4; k++)
			p.rgba[i][k] = (uint8_t)(i * (k + 3));
	return p;
}

static void png_is_written(const char *folder)
{
	struct picture_buffer p = coloured();
	g_autofree char *path = written(folder, "a.png", &p);
	png_image image = { .version = PNG_IMAGE_VERSION };
	g_assert_true(png_image_begin_read_from_file(&image, path));
	image.format = PNG_FORMAT_RGB;
	g_autofree uint8_t *rgb = g_malloc(PNG_IMAGE_SIZE(image));
	g_assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
	g_assert_cmpuint(image.width, ==, p.width);
	for (size_t i = 0; i < (size_t)p.width * p.height; i++)
		g_assert_cmpmem(rgb + 3 * i, 3, p.rgba[i], 3);
	picture_buffer_clear(&p);
}

static void tiff_is_written(const char *folder)
{
	struct picture_buffer p = coloured();
	g_autofree char *path = written(folder, "a.tif", &p);
	TIFF *t = TIFFOpen(path, "r");
	g_autofree uint8_t *row = g_malloc(3 * p.width);
	float dpi;
	g_assert_nonnull(t);
	g_assert_true(TIFFGetField(t, TIFFTAG_XRESOLUTION, &dpi));
	g_assert_cmpfloat(dpi, ==, 254);
	for (uint32_t y = 0; y < p.height; y++) {
		g_assert_cmpint(TIFFReadScanline(t, row, y, 0), ==, 1);
		for (uint32_t x = 0; x < p.width; x++)
			g_assert_cmpmem(row + 3 * x, 3, p.rgba[y * p.width + x], 3);
	}
	TIFFClose(t);
	picture_buffer_clear(&p);
}

static void files_are_whole(void)
{
	g_autofree char *folder = g_dir_make_tmp("pleinair-poster-XXXXXX", NULL),
			*path = g_build_filename(folder, "b.png", NULL);
	g_autoptr(GError) error = NULL;
	png_is_written(folder);
	tiff_is_written(folder);
	/* One that is not finished is none. */
	struct picture_buffer p = coloured();
	picture_writer *w = picture_writer_new(path, p.width, p.height + 1, 0, &error);
	g_assert_true(picture_writer_add(w, &p, &error));
	picture_writer_free(w);
	g_autoptr(GPtrArray) names = files_names(folder, &error);
	g_assert_cmpuint(names->len, ==, 2);
	g_assert_null(picture_writer_new("/nowhere/a.png", 2, 2, 0, &error));
	g_assert_nonnull(strstr(error->message, "/nowhere/a.png"));
	picture_buffer_clear(&p);
	files_remove_tree(folder, NULL);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	draw_lines_too();
	g_test_add_func("/poster/shipped-styles", shipped_styles);
	g_test_add_func("/poster/gles", on_gles);
	g_test_add_func("/poster/reduces", reduces);
	g_test_add_func("/poster/grids-fit", grids_fit);
	g_test_add_func("/poster/stops", stops);
	g_test_add_func("/poster/files", files_are_whole);
	return g_test_run();
}
