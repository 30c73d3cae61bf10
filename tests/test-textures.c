/* Stroke and paper textures: what each medium is held to, and what becomes of pictures of others.
 */
#include "render/paper-texture.h"
#include "render/stroke-texture.h"
#include <glib/gstdio.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
	LENGTH = STROKE_TEXTURE_LENGTH,
	WIDTH = STROKE_TEXTURE_WIDTH,
	VARIANTS = STROKE_TEXTURE_VARIANTS,
	AREA = LENGTH * WIDTH
};

static char *sum_of(const uint8_t *texel, size_t n)
{
	return g_compute_checksum_for_data(G_CHECKSUM_SHA256, texel, n);
}

static void refuses(GError *error, const char *path, const char *why)
{
	g_assert_nonnull(error);
	g_test_message("%s", error->message);
	g_assert_true(error->domain == G_FILE_ERROR);
	g_assert_nonnull(strstr(error->message, path));
	g_assert_nonnull(strstr(error->message, why));
	g_assert_null(strchr(error->message, '\n'));
}

/* ---- strokes that are made ---- */

/* Mean alpha of each variant; the share of texels that are neither bare nor nearly opaque. */
static const struct look {
	double mean_min, mean_max, half_min, half_max;
} looks[STROKE_KINDS] = {
	[STROKE_GAUSSIAN] = { 0.15, 0.22, 0.3, 0.8 },
	[STROKE_LINE] = { 0.6, 0.72, 0.1, 0.5 },
	[STROKE_DOT] = { 0.55, 0.7, 0.05, 0.3 },
	[STROKE_PENCIL] = { 0.12, 0.25, 0.3, 0.6 },
	[STROKE_INK_PEN] = { 0.35, 0.5, 0, 0.15 },
	[STROKE_CHARCOAL] = { 0.35, 0.5, 0.2, 0.5 },
	[STROKE_BRUSH] = { 0.38, 0.52, 0.2, 0.7 },
	[STROKE_CHALK] = { 0.25, 0.4, 0.2, 0.7 },
	[STROKE_BRISTLES] = { 0.35, 0.55, 0.4, 0.85 },
	[STROKE_DAB] = { 0.35, 0.55, 0.3, 0.7 },
};

static void borders_are_empty(const stroke_texture *t)
{
	for (uint32_t v = 0; v < t->variants; v++) {
		const uint8_t *alpha = stroke_texture_variant(t, v);
		for (int x = 0; x < LENGTH; x++)
			g_assert_true(alpha[x] == 0 && alpha[AREA - LENGTH + x] == 0);
		for (int y = 0; y < WIDTH; y++)
			g_assert_true(
				alpha[y * LENGTH] == 0 && alpha[y * LENGTH + LENGTH - 1] == 0);
	}
}

static double half_tones(const uint8_t *alpha)
{
	int n = 0;
	for (int i = 0; i < AREA; i++)
		n += alpha[i] > 8 && alpha[i] < 210;
	return (double)n / AREA;
}

static double difference(const uint8_t *a, const uint8_t *b)
{
	double sum = 0;
	for (int i = 0; i < AREA; i++)
		sum += abs(a[i] - b[i]);
	return sum / AREA / 255;
}

static void variants_differ(const stroke_texture *t, bool made_by_hand)
{
	for (uint32_t v = 1; v < t->variants; v++)
		for (uint32_t w = 0; w < v; w++) {
			double d = difference(
				stroke_texture_variant(t, v), stroke_texture_variant(t, w));
			if (made_by_hand)
				g_assert_cmpfloat(d, >, 0.02);
			else
				g_assert_cmpfloat(d, ==, 0);
		}
}

static void test_stroke(gconstpointer data)
{
	enum stroke_kind kind = GPOINTER_TO_INT(data);
	g_autoptr(GError) error = NULL;
	g_autoptr(stroke_texture) t = stroke_texture_new(stroke_texture_kinds[kind].name, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(t->name, ==, stroke_texture_kinds[kind].name);
	g_assert_true(t->length == LENGTH && t->width == WIDTH && t->variants == VARIANTS);
	borders_are_empty(t);
	variants_differ(t, kind >= STROKE_PENCIL);
	for (uint32_t v = 0; v < VARIANTS; v++) {
		const uint8_t *alpha = stroke_texture_variant(t, v);
		double half = half_tones(alpha);
		g_test_message("mean alpha %.3f, half-tones %.3f", t->mean_alpha[v], half);
		g_assert_cmpfloat_with_epsilon(
			t->mean_alpha[v], texels_mean(alpha, AREA) / 255, 1e-9);
		g_assert_cmpfloat(t->mean_alpha[v], >=, looks[kind].mean_min);
		g_assert_cmpfloat(t->mean_alpha[v], <=, looks[kind].mean_max);
		g_assert_cmpfloat(half, >=, looks[kind].half_min);
		g_assert_cmpfloat(half, <=, looks[kind].half_max);
	}
	g_autoptr(stroke_texture) again = stroke_texture_new(t->name, NULL);
	g_autofree char *first = sum_of(t->alpha, AREA * VARIANTS),
			*second = sum_of(again->alpha, AREA * VARIANTS);
	g_assert_cmpstr(first, ==, second);
}

/* The mean over some columns, in all variants. */
static double columns_mean(const stroke_texture *t, int from, int to)
{
	double sum = 0;
	for (int y = 0; y < WIDTH * VARIANTS; y++)
		for (int x = from; x < to; x++)
			sum += t->alpha[y * LENGTH + x];
	return sum / (WIDTH * VARIANTS) / (to - from) / 255;
}

static double ends_mean(const stroke_texture *t, int texels)
{
	return (columns_mean(t, 0, texels) + columns_mean(t, LENGTH - texels, LENGTH)) / 2;
}

/* What people tell media by: how strokes begin and end. */
static void test_ends(void)
{
	g_autoptr(stroke_texture) pencil = stroke_texture_new("pencil", NULL),
				  ink = stroke_texture_new("ink-pen", NULL),
				  brush = stroke_texture_new("brush", NULL),
				  chalk = stroke_texture_new("chalk", NULL);
	double pencil_middle = columns_mean(pencil, 96, 160),
	       chalk_middle = columns_mean(chalk, 96, 160);
	g_assert_cmpfloat(ends_mean(pencil, 24), <, 0.3 * pencil_middle);
	g_assert_cmpfloat(ends_mean(chalk, 24), >, 0.6 * chalk_middle);
	g_assert_cmpfloat(
		columns_mean(ink, 8, 40), >, 2 * columns_mean(ink, LENGTH - 40, LENGTH - 8));
	g_assert_cmpfloat(
		columns_mean(brush, 20, 60), >, 2 * columns_mean(brush, LENGTH - 60, LENGTH - 20));
}

static void test_unknown_stroke(void)
{
	g_autoptr(GError) error = NULL;
	g_assert_null(stroke_texture_new("crayon", &error));
	refuses(error, "'crayon'", "bristles, dab, or");
	for (enum stroke_kind k = 0; k < STROKE_KINDS; k++)
		g_assert_nonnull(strstr(error->message, stroke_texture_kinds[k].name));
	g_clear_error(&error);
	g_assert_null(stroke_texture_new("", &error));
	refuses(error, "''", "there is no stroke texture");
}

/* ---- scaled ---- */

static const uint32_t sizes[][2] = { { 60, 12 }, { 60, 10 }, { 40, 5 }, { 33, 7 }, { 10, 1 },
	{ 10, 2 }, { 25, 1 }, { 128, 16 }, { 255, 31 }, { 32, 32 }, { 300, 50 }, { 1, 9 } };

static void test_scaled(void)
{
	for (enum stroke_kind k = 0; k < STROKE_KINDS; k++) {
		g_autoptr(stroke_texture) t =
			stroke_texture_new(stroke_texture_kinds[k].name, NULL);
		for (size_t i = 0; i < G_N_ELEMENTS(sizes); i++) {
			uint32_t length = sizes[i][0], width = sizes[i][1];
			g_autoptr(stroke_texture) s = stroke_texture_scaled(t, length, width);
			g_assert_cmpstr(s->name, ==, t->name);
			g_assert_true(s->length == length && s->width == width);
			g_assert_cmpuint(s->variants, ==, VARIANTS);
			for (uint32_t v = 0; v < VARIANTS; v++) {
				const uint8_t *alpha = stroke_texture_variant(s, v);
				double mean = texels_mean(alpha, (size_t)length * width) / 255;
				g_assert_cmpfloat_with_epsilon(s->mean_alpha[v], mean, 1e-9);
				g_assert_cmpfloat_with_epsilon(
					mean, t->mean_alpha[v], 0.01 * t->mean_alpha[v]);
			}
		}
		g_autoptr(stroke_texture) same = stroke_texture_scaled(t, LENGTH, WIDTH);
		g_assert_cmpmem(same->alpha, AREA * VARIANTS, t->alpha, AREA * VARIANTS);
	}
}

/* 5 x 3 to 2 x 2 by hand; the texel at the right top covers only zeros. */
static void test_area(void)
{
	static const uint8_t in[3 * 5] = { 200, 100, 0, 0, 0, 200, 100, 0, 0, 0, 40, 40, 40, 40,
		40 };
	uint8_t out[4], same[15], one;
	texels_scale(in, 5, 3, out, 2, 2);
	/* Left top: (200 + 100 + 0 / 2) / 2.5; below: a third of that and two of 40. */
	g_assert_cmpuint(out[0], ==, 120);
	g_assert_cmpuint(out[1], ==, 0);
	g_assert_cmpuint(out[2], ==, 67); /* 66.67 */
	g_assert_cmpuint(out[3], ==, 26); /* 26.67 less what was rounded up before */
	texels_scale(in, 5, 3, same, 5, 3);
	g_assert_cmpmem(same, sizeof same, in, sizeof in);
	texels_scale(in, 5, 3, &one, 1, 1);
	g_assert_cmpuint(one, ==, 53);
}

/* ---- pictures ---- */

struct files {
	char *folder, *path;
};

static void files_up(struct files *f, gconstpointer data)
{
	(void)data;
	f->folder = g_dir_make_tmp("test-textures-XXXXXX", NULL);
	g_assert_nonnull(f->folder);
	f->path = g_build_filename(f->folder, "own.png", NULL);
}

static void files_down(struct files *f, gconstpointer data)
{
	(void)data;
	g_remove(f->path);
	g_assert_cmpint(g_rmdir(f->folder), ==, 0);
	g_free(f->path);
	g_free(f->folder);
}

static void write_png(
	const char *path, const void *pixels, uint32_t width, uint32_t height, uint32_t format)
{
	png_image image = {
		.version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = format
	};
	g_assert_true(png_image_write_to_file(&image, path, 0, pixels, 0, NULL));
}

/* Black at the left; at the right half black, all of it half transparent. */
static void test_ink_of_picture(struct files *f, gconstpointer data)
{
	(void)data;
	uint8_t pixel[10][20][4];
	for (int y = 0; y < 10; y++)
		for (int x = 0; x < 20; x++) {
			uint8_t light = x < 10 ? 0 : 127;
			memcpy(pixel[y][x],
				((const uint8_t[]){ light, light, light, x < 10 ? 255 : 128 }), 4);
		}
	write_png(f->path, pixel, 20, 10, PNG_FORMAT_RGBA);
	g_autoptr(GError) error = NULL;
	g_autoptr(stroke_texture) t = stroke_texture_new(f->path, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(t->name, ==, f->path);
	g_assert_true(t->length == LENGTH && t->width == WIDTH && t->variants == VARIANTS);
	borders_are_empty(t);
	const uint8_t *drawn = stroke_texture_variant(t, 0), *along = stroke_texture_variant(t, 2);
	g_assert_cmpuint(drawn[16 * LENGTH + 1], ==, 255);
	g_assert_cmpuint(drawn[16 * LENGTH + 127], ==, 255);
	g_assert_cmpint(abs(drawn[16 * LENGTH + 128] - 64), <=, 1);
	g_assert_cmpint(abs(along[16 * LENGTH + 127] - 64), <=, 1);
	g_assert_cmpuint(along[16 * LENGTH + 128], ==, 255);
	for (uint32_t v = 1; v < VARIANTS; v++)
		g_assert_cmpfloat_with_epsilon(t->mean_alpha[v], t->mean_alpha[0], 1e-9);
}

static void append_bytes(png_structp png, png_bytep bytes, size_t n)
{
	g_string_append_len(png_get_io_ptr(png), (const char *)bytes, (gssize)n);
}

/* One grey pixel of 16 bits, without a word on what they mean, which libpng's simple functions do
 * not write. */
static void write_16_bits(const char *path, uint8_t high)
{
	g_autoptr(GString) bytes = g_string_new(NULL);
	png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
	png_infop info = png_create_info_struct(png);
	uint8_t pixel[2] = { high, 0 };
	png_set_write_fn(png, bytes, append_bytes, NULL);
	png_set_IHDR(png, info, 1, 1, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
		PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	png_write_info(png, info);
	png_write_row(png, pixel);
	png_write_end(png, info);
	png_destroy_write_struct(&png, &info);
	g_assert_true(g_file_set_contents(path, bytes->str, (gssize)bytes->len, NULL));
}

/* Other kinds of PNG: grey, colours, 16 bits; and of one pixel. */
static void test_kinds_of_picture(struct files *f, gconstpointer data)
{
	(void)data;
	static const uint8_t grey[4] = { 64, 64, 64, 64 }, red[3] = { 255, 0, 0 };
	write_png(f->path, grey, 2, 2, PNG_FORMAT_GRAY);
	g_autoptr(stroke_texture) t = stroke_texture_new(f->path, NULL);
	g_assert_cmpuint(t->alpha[5 * LENGTH + 5], ==, 191);
	write_png(f->path, red, 1, 1, PNG_FORMAT_RGB);
	g_autoptr(stroke_texture) one = stroke_texture_new(f->path, NULL);
	g_assert_cmpuint(one->alpha[5 * LENGTH + 5], >, 100);
	g_assert_cmpuint(one->alpha[5 * LENGTH + 5], <, 200);
	write_16_bits(f->path, 64);
	g_autoptr(stroke_texture) deep = stroke_texture_new(f->path, NULL);
	g_assert_cmpint(abs(deep->alpha[5 * LENGTH + 5] - 191), <=, 1);
}

static void test_no_picture(struct files *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_assert_null(stroke_texture_new(f->path, &error));
	refuses(error, f->path, "there is no such file");
	g_assert_cmpint(error->code, ==, G_FILE_ERROR_NOENT);
	g_clear_error(&error);
	g_assert_null(stroke_texture_new(f->folder, &error));
	refuses(error, f->folder, "is not a file");
	g_clear_error(&error);
	g_assert_null(stroke_texture_new("nowhere.png", &error));
	refuses(error, "nowhere.png", "there is no such file");
	g_clear_error(&error);
	g_assert_true(g_file_set_contents(f->path, "ink, but in words\n", -1, NULL));
	g_assert_null(stroke_texture_new(f->path, &error));
	refuses(error, f->path, "cannot be read as a PNG");
	g_clear_error(&error);
	g_assert_true(g_file_set_contents(f->path, "", 0, NULL));
	g_assert_null(stroke_texture_new(f->path, &error));
	refuses(error, f->path, "cannot be read as a PNG");
}

static void test_absurd_picture(struct files *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_autofree uint8_t *pixel = g_malloc0(TEXELS_SIDE_MAX + 1);
	write_png(f->path, pixel, TEXELS_SIDE_MAX + 1, 1, PNG_FORMAT_GRAY);
	g_assert_null(stroke_texture_new(f->path, &error));
	refuses(error, f->path, "has 4097 x 1 pixels");
	g_clear_error(&error);
	write_png(f->path, pixel, 1, TEXELS_SIDE_MAX + 1, PNG_FORMAT_GRAY);
	g_assert_null(stroke_texture_new(f->path, &error));
	refuses(error, f->path, "has 1 x 4097 pixels");
	g_clear_error(&error);
	write_png(f->path, pixel, TEXELS_SIDE_MAX, 1, PNG_FORMAT_GRAY);
	g_autoptr(stroke_texture) t = stroke_texture_new(f->path, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(t->alpha[5 * LENGTH + 5], ==, 255);
	memset(pixel, 255, TEXELS_SIDE_MAX);
	write_png(f->path, pixel, 64, 64, PNG_FORMAT_GRAY);
	g_assert_null(stroke_texture_new(f->path, &error));
	refuses(error, f->path, "has no ink");
}

/* A byte flipped anywhere, and the end missing: either it can be read or there is a sentence. */
static void test_broken_picture(struct files *f, gconstpointer data)
{
	(void)data;
	uint8_t pixel[8 * 32];
	for (size_t i = 0; i < sizeof pixel; i++)
		pixel[i] = (uint8_t)(i * i);
	write_png(f->path, pixel, 32, 8, PNG_FORMAT_GRAY);
	g_autofree char *bytes = NULL;
	gsize size;
	g_assert_true(g_file_get_contents(f->path, &bytes, &size, NULL));
	int refused = 0;
	for (gsize i = 0; i < size; i++)
		for (int cut = 0; cut < 2; cut++) {
			bytes[i] ^= cut ? 0 : 0x21;
			FILE *file = fopen(f->path, "wb");
			fwrite(bytes, 1, cut ? i : size, file);
			fclose(file);
			bytes[i] ^= cut ? 0 : 0x21;
			g_autoptr(GError) error = NULL;
			g_autoptr(stroke_texture) t = stroke_texture_new(f->path, &error);
			g_assert_true(!t == !!error);
			refused += !t;
		}
	g_test_message("%d of %zu are refused", refused, 2 * size);
	g_assert_cmpint(refused, >, (int)size);
}

/* ---- papers ---- */

enum { SIDE = PAPER_TEXTURE_SIDE, PAPER = SIDE * SIDE };

static double deviation_of(const paper_texture *p)
{
	double sum = 0;
	for (int i = 0; i < PAPER; i++)
		sum += (p->height[i] - 128.0) * (p->height[i] - 128.0);
	return sqrt(sum / PAPER);
}

/* How rough it is from one line of texels to the next, which of the last is the first; down: rows.
 */
static double step_after(const paper_texture *p, int line, bool down)
{
	double sum = 0;
	int next = (line + 1) % SIDE;
	for (int i = 0; i < SIDE; i++) {
		int d = down ? p->height[line * SIDE + i] - p->height[next * SIDE + i]
			     : p->height[i * SIDE + line] - p->height[i * SIDE + next];
		sum += d * d;
	}
	return sqrt(sum / SIDE);
}

static void no_seam(const paper_texture *p, bool down)
{
	double least = HUGE_VAL, most = 0, seam = step_after(p, SIDE - 1, down);
	for (int line = 0; line < SIDE - 1; line++) {
		double step = step_after(p, line, down);
		least = MIN(least, step);
		most = MAX(most, step);
	}
	g_test_message("%s: %.2f over the seam, %.2f to %.2f inside", down ? "rows" : "columns",
		seam, least, most);
	g_assert_cmpfloat(seam, >=, 0.95 * least);
	g_assert_cmpfloat(seam, <=, 1.05 * most);
}

/* What is made beyond the edge is what is made at the other one. */
static void repeats(const struct paper_texture_kind *kind, float over_x, float over_y)
{
	enum { STRIP = 6 };
	double sum = 0;
	for (int i = 0; i < STRIP * SIDE; i++) {
		float near = (float)(i % STRIP) + 0.5f, far = (float)(i / STRIP) + 0.5f;
		float x = over_x > 0 ? near : far, y = over_x > 0 ? far : near;
		float d = kind->make(x + over_x, y + over_y) - kind->make(x, y);
		sum += d * d;
	}
	g_assert_cmpfloat(sqrt(sum / (STRIP * SIDE)), <, 0.02);
}

static void test_paper(gconstpointer data)
{
	const struct paper_texture_kind *kind = &paper_texture_kinds[GPOINTER_TO_INT(data)];
	g_autoptr(GError) error = NULL;
	g_autoptr(paper_texture) p = paper_texture_new(kind->name, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(p->name, ==, kind->name);
	g_assert_cmpuint(p->side, ==, SIDE);
	double deviation = deviation_of(p);
	g_test_message("deviation %.1f", deviation);
	g_assert_cmpfloat_with_epsilon(texels_mean(p->height, PAPER), PAPER_TEXTURE_MEAN, 0.05);
	g_assert_cmpfloat_with_epsilon(deviation, kind->deviation, 0.1 * kind->deviation);
	no_seam(p, false);
	no_seam(p, true);
	repeats(kind, SIDE, 0);
	repeats(kind, 0, SIDE);
	g_autoptr(paper_texture) again = paper_texture_new(kind->name, NULL);
	g_autofree char *first = sum_of(p->height, PAPER), *second = sum_of(again->height, PAPER);
	g_assert_cmpstr(first, ==, second);
}

static void test_unknown_paper(void)
{
	g_autoptr(GError) error = NULL;
	g_assert_null(paper_texture_new("papyrus", &error));
	refuses(error, "'papyrus'", "smooth, cartridge, rough, laid, canvas, or");
}

/* Light is high, and the mean becomes that of a plane. */
static void test_picture_of_paper(struct files *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_assert_null(paper_texture_new(f->path, &error));
	refuses(error, f->path, "there is no such file");
	uint8_t pixel[2][4] = { { 200, 240, 240, 240 }, { 200, 240, 240, 240 } };
	write_png(f->path, pixel, 4, 2, PNG_FORMAT_GRAY);
	g_autoptr(GError) unreadable = NULL;
	g_autoptr(paper_texture) p = paper_texture_new(f->path, &unreadable);
	g_assert_no_error(unreadable);
	g_assert_cmpfloat_with_epsilon(texels_mean(p->height, PAPER), PAPER_TEXTURE_MEAN, 0.5);
	g_assert_cmpint(p->height[300], ==, p->height[0] + 40);
}

/* A picture of two extremes cannot be shifted to the mean; it is brought as near as it goes. */
static void test_extreme_paper(struct files *f, gconstpointer data)
{
	(void)data;
	uint8_t pixel[8] = { 255, 0, 0, 0, 0, 0, 0, 0 };
	write_png(f->path, pixel, 8, 1, PNG_FORMAT_GRAY);
	g_autoptr(paper_texture) p = paper_texture_new(f->path, NULL);
	g_assert_cmpfloat_with_epsilon(texels_mean(p->height, PAPER), PAPER_TEXTURE_MEAN, 1);
	g_assert_cmpuint(p->height[0], ==, 255);
}

/* A user waits for them when a program starts. */
static void test_time(void)
{
	gint64 from = g_get_monotonic_time();
	for (int k = 0; k < STROKE_KINDS; k++)
		stroke_texture_free(stroke_texture_new(stroke_texture_kinds[k].name, NULL));
	for (int k = 0; k < PAPER_KINDS; k++)
		paper_texture_free(paper_texture_new(paper_texture_kinds[k].name, NULL));
	double seconds = (double)(g_get_monotonic_time() - from) / 1e6;
	g_test_message("all of them take %.3f s", seconds);
	/* Ten times what it takes, for sanitizers and busy processors. */
	g_assert_cmpfloat(seconds, <, 3);
}

static void add_kinds(void)
{
	for (int k = 0; k < STROKE_KINDS; k++) {
		g_autofree char *path =
			g_strdup_printf("/textures/stroke/%s", stroke_texture_kinds[k].name);
		g_test_add_data_func(path, GINT_TO_POINTER(k), test_stroke);
	}
	for (int k = 0; k < PAPER_KINDS; k++) {
		g_autofree char *path =
			g_strdup_printf("/textures/paper/%s", paper_texture_kinds[k].name);
		g_test_add_data_func(path, GINT_TO_POINTER(k), test_paper);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	add_kinds();
	g_test_add_func("/textures/stroke-ends", test_ends);
	g_test_add_func("/textures/unknown-stroke", test_unknown_stroke);
	g_test_add_func("/textures/scaled", test_scaled);
	g_test_add_func("/textures/area", test_area);
#define ADD_FILE(name, test)                                                                       \
	g_test_add("/textures/picture/" name, struct files, NULL, files_up, test, files_down)
	ADD_FILE("ink", test_ink_of_picture);
	ADD_FILE("kinds", test_kinds_of_picture);
	ADD_FILE("none", test_no_picture);
	ADD_FILE("absurd", test_absurd_picture);
	ADD_FILE("broken", test_broken_picture);
	ADD_FILE("paper", test_picture_of_paper);
	ADD_FILE("extreme-paper", test_extreme_paper);
	g_test_add_func("/textures/unknown-paper", test_unknown_paper);
	g_test_add_func("/textures/time", test_time);
	return g_test_run();
}
