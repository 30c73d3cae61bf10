/* pleinair render as pages of shapes, prints and films, on a small site. */
#include "process/model.h"
#include "render/texels.h"
#include "tests/commands.h"
#include "tests/scene-made.h"
#include <math.h>

static char *folder, *oak;

static char *in_folder(const char *name)
{
	return g_build_filename(folder, name, NULL);
}

static void put_site(void)
{
	g_autofree char *file = g_build_filename(oak, "site.json", NULL),
			*in = g_build_filename(oak, "model", NULL), *path = model_path(oak);
	g_auto(made) m = made_court();
	g_assert_cmpint(g_mkdir_with_parents(in, 0755), ==, 0);
	g_assert_true(g_file_set_contents(file,
		"{\"schema\":1,\"name\":\"Oak\",\"id\":\"6f1f6c8e-1b1e-4c3a-9d55-0c9a3b0a7a11\","
		"\"created\":\"2026-11-23T10:00:00Z\",\"units\":\"metres\"}",
		-1, NULL));
	made_write_to(&m, path);
}

static char *drawn(const char *name, const char *size, const char *more, gsize *ret_length)
{
	g_autofree char *path = in_folder(name);
	char *bytes = NULL;
	g_auto(answer) a = commands_run("render", oak, "--style", "figure-7a", "--size", size, "-o",
		path, "--supersample", "1", more ? more : "--times");
	commands_assert_done(&a);
	g_assert_true(g_file_get_contents(path, &bytes, ret_length, NULL));
	return bytes;
}

/* ---- SVG ---- */

struct svg {
	guint shapes, pictures;
	char *width, *height, *title;
	bool in_title;
};

static void begin(GMarkupParseContext *c, const char *element, const char **names,
	const char **values, gpointer user_data, GError **error)
{
	struct svg *s = user_data;
	(void)c;
	(void)error;
	s->in_title = !strcmp(element, "title");
	s->shapes += !strcmp(element, "path") || !strcmp(element, "line") ||
		     !strcmp(element, "circle") || !strcmp(element, "use") ||
		     !strcmp(element, "ellipse") || !strcmp(element, "polygon");
	s->pictures += !strcmp(element, "image");
	for (; !strcmp(element, "svg") && *names; names++, values++)
		if (!strcmp(*names, "width"))
			s->width = g_strdup(*values);
		else if (!strcmp(*names, "height"))
			s->height = g_strdup(*values);
}

static void text(
	GMarkupParseContext *c, const char *what, gsize length, gpointer user_data, GError **error)
{
	struct svg *s = user_data;
	(void)c;
	(void)error;
	if (s->in_title && !s->title)
		s->title = g_strndup(what, length);
	s->in_title = false;
}

static struct svg read_svg(const char *bytes, gsize length)
{
	static const GMarkupParser parser = { .start_element = begin, .text = text };
	struct svg s = { 0 };
	g_autoptr(GError) error = NULL;
	GMarkupParseContext *c = g_markup_parse_context_new(&parser, 0, &s, NULL);
	g_assert_true(g_markup_parse_context_parse(c, bytes, (gssize)length, &error));
	g_assert_no_error(error);
	g_assert_true(g_markup_parse_context_end_parse(c, &error));
	g_assert_no_error(error);
	g_markup_parse_context_free(c);
	return s;
}

static void svg_clear(struct svg *s)
{
	g_free(s->width);
	g_free(s->height);
	g_free(s->title);
}

static void svg_has_shapes(void)
{
	gsize length, less;
	g_autofree char *whole = drawn("a.svg", "200x100mm", "--title=Oak <&> ash", &length);
	g_autofree char *lines = drawn("b.svg", "200x100mm", "--no-paper", &less);
	struct svg s = read_svg(whole, length), t = read_svg(lines, less);
	g_assert_cmpstr(s.width, ==, "200mm");
	g_assert_cmpstr(s.height, ==, "100mm");
	g_assert_cmpstr(s.title, ==, "Oak <&> ash");
	g_assert_cmpuint(s.pictures, ==, 1);
	g_assert_cmpuint(t.pictures, ==, 0);
	g_assert_cmpuint(s.shapes, >, 20);
	g_assert_cmpuint(less, <, length);
	g_assert_cmpuint(less, >, 5000);
	/* Small enough to edit: numbers are whole, and few. */
	guint moves = 0;
	for (const char *at = lines; (at = strchr(at, 'm')); at++)
		moves += g_ascii_isdigit(at[1]) || at[1] == '-';
	g_assert_cmpuint(moves, >, 500);
	g_assert_cmpuint(less, <, 60 * moves);
	/* The same bytes again. */
	g_autofree char *again = drawn("c.svg", "200x100mm", "--title=Oak <&> ash", &less);
	g_assert_cmpmem(whole, length, again, less);
	svg_clear(&s);
	svg_clear(&t);
}

/* ---- as others show it ---- */

#define TILE 23u

static uint8_t *darkness_of(const char *path, uint32_t *ret_width, uint32_t *ret_height)
{
	g_autoptr(GError) error = NULL;
	uint8_t *ink = texels_read_png(path, TEXELS_INK, ret_width, ret_height, &error);
	g_assert_no_error(error);
	return ink;
}

/* How far means of tiles are from those of the other picture, root mean square, of 255. */
static double tiles_apart(const char *one, const char *other)
{
	uint32_t width, height, wide, high;
	g_autofree uint8_t *a = darkness_of(one, &width, &height),
			   *b = darkness_of(other, &wide, &high);
	double squares = 0, tiles = 0;
	g_assert_cmpuint(wide, ==, width);
	g_assert_cmpuint(abs((int)high - (int)height), <=, 1);
	height = MIN(height, high);
	for (uint32_t top = 0; top + TILE <= height; top += TILE)
		for (uint32_t left = 0; left + TILE <= width; left += TILE) {
			double sum = 0;
			for (uint32_t n = 0; n < TILE * TILE; n++) {
				size_t at = (size_t)(top + n / TILE) * width + left + n % TILE;
				sum += a[at] - b[at];
			}
			squares += pow(sum / (TILE * TILE), 2);
			tiles++;
		}
	return sqrt(squares / tiles);
}

static void drawn_in(const char *name, const char *path)
{
	g_auto(answer) a = commands_run("render", oak, "--style", name, "--size", "200x100mm",
		"--view", "overview", "-o", path);
	commands_assert_done(&a);
}

/* to, wide: its options for the picture that it makes, and how wide that is. */
static void shown_by(const char *program, const char *to, const char *wide)
{
	static const char *const styles[] = { "figure-7a", "pencil", "impressionist" };
	g_autofree char *found = g_find_program_in_path(program);
	if (!found) {
		g_autofree char *why = g_strdup_printf("%s is not installed", program);
		g_test_skip(why);
		return;
	}
	g_autofree char *page = in_folder("shown.svg"), *picture = in_folder("shown.png"),
			*shown = in_folder("by.png");
	for (size_t n = 0; n < G_N_ELEMENTS(styles); n++) {
		uint32_t width, height;
		drawn_in(styles[n], page);
		drawn_in(styles[n], picture);
		g_free(darkness_of(picture, &width, &height));
		commands_shell("HOME='%s' G_DEBUG= %s '%s' %s'%s' %s%u >'%s/log' 2>&1", folder,
			program, page, to, shown, wide, width, folder);
		double apart = tiles_apart(picture, shown);
		g_test_message("%s by %s: %.1f of 255", styles[n], program, apart);
		g_assert_cmpfloat(apart, <, 10);
	}
}

static void shown_by_rsvg(void)
{
	shown_by("rsvg-convert", "--output=", "--width=");
}

static void shown_by_inkscape(void)
{
	shown_by("inkscape", "--export-type=png --export-filename=", "--export-width=");
}

/* ---- PDF, prints ---- */

static void pdf_has_its_paper(void)
{
	gsize length;
	g_autofree char *pdf = drawn("a.pdf", "A4-landscape", NULL, &length);
	g_assert_true(g_str_has_prefix(pdf, "%PDF-1."));
	const char *box = memmem(pdf, length, "/MediaBox", 9);
	double x, y, wide, high;
	g_assert_nonnull(box);
	g_assert_cmpint(
		sscanf(strchr(box, '[') + 1, "%lf %lf %lf %lf", &x, &y, &wide, &high), ==, 4);
	/* In points, of which 72 are an inch. */
	g_assert_cmpfloat(fabs(wide - 297 / 25.4 * 72), <, 0.5);
	g_assert_cmpfloat(fabs(high - 210 / 25.4 * 72), <, 0.5);
	g_assert_nonnull(memmem(pdf + length - 16, 16, "%%EOF", 5));
}

static uint32_t big_endian(const char *at)
{
	const guint8 *b = (const guint8 *)at;
	return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static void print_knows_its_size(void)
{
	gsize length;
	g_autofree char *png = drawn("a.png", "A7", "--dpi=100", &length);
	g_assert_cmpuint(big_endian(png + 16), ==, lround(74 / 25.4 * 100));
	g_assert_cmpuint(big_endian(png + 20), ==, lround(105 / 25.4 * 100));
	const char *density = NULL;
	for (gsize i = 0; i + 17 < length && !density; i++)
		if (!memcmp(png + i, "pHYs", 4))
			density = png + i + 4;
	g_assert_nonnull(density);
	/* So that whole pixels fill the sheet. */
	g_assert_cmpuint(big_endian(density), ==, lround(291 / 0.074));
	g_assert_cmpuint(big_endian(density + 4), ==, big_endian(density));
}

/* ---- films ---- */

static void film_is_one(void)
{
	g_autofree char *path = in_folder("a.mp4"), *ffmpeg = g_find_program_in_path("ffmpeg"),
			*bytes = NULL;
	gsize length;
	if (!ffmpeg) {
		g_test_skip("there is no ffmpeg");
		return;
	}
	g_auto(answer) a = commands_run("render", oak, "--path", "orbit:2", "--seconds", "0.4",
		"--size", "320x200", "--supersample", "1", "-o", path, "--json");
	commands_assert_done(&a);
	g_autoptr(JsonNode) n = commands_json(&a);
	g_assert_cmpint(json_object_get_int_member(json_node_get_object(n), "frames"), ==, 10);
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	g_assert_cmpmem(bytes + 4, 4, "ftyp", 4);
}

/* Nothing half, and one sentence. */
static void film_without_ffmpeg(void)
{
	g_autofree char *path = in_folder("b.mp4"), *was = g_strdup(g_getenv("PATH"));
	g_setenv("PATH", "/nowhere", TRUE);
	g_auto(answer) a = commands_run("render", oak, "--path", "orbit:2:3", "--size", "320x200",
		"--supersample", "1", "-o", path);
	g_setenv("PATH", was, TRUE);
	commands_assert_refused(&a, 1, "ffmpeg");
	g_autofree char *names = commands_names(folder);
	g_assert_null(strstr(names, "b.mp4"));
}

/* ---- scales ---- */

static void page_has_its_scale(void)
{
	g_autofree char *path = in_folder("s.svg"), *text = NULL;
	g_auto(answer) a = commands_run("render", oak, "--view", "section:100,202:106,202",
		"--scale", "1:50", "--size", "A4-landscape", "-o", path, "--json", "--supersample",
		"1", "--save-view", "hall");
	commands_assert_done(&a);
	g_autoptr(JsonNode) n = commands_json(&a);
	JsonObject *o = json_node_get_object(n);
	g_assert_cmpfloat(json_object_get_double_member(o, "scale"), ==, 50);
	g_assert_true(g_file_get_contents(path, &text, NULL, NULL));
	g_assert_nonnull(strstr(text, "id=\"legend\""));
	g_assert_nonnull(strstr(text, ">1:50</text>"));
	g_assert_nonnull(strstr(text, ">2026-11-23</text>"));
	g_assert_nonnull(strstr(text, "inkscape:label=\"cut"));
	/* Its saved view has one too, chosen; and the edge can be left out. */
	g_auto(answer) b = commands_run("render", oak, "--view", "hall", "--size", "A5-landscape",
		"-o", path, "--supersample", "1", "--no-frame");
	commands_assert_done(&b);
	g_assert_nonnull(strstr(b.out, "1:50 on 210 x 148 mm"));
	g_autofree char *bare = NULL;
	g_assert_true(g_file_get_contents(path, &bare, NULL, NULL));
	g_assert_null(strstr(bare, "legend"));
}

static void scale_refusals(void)
{
	static const struct {
		const char *view, *option, *value, *names;
		int status;
	} cases[] = {
		{ "plan", "--scale", "50", "--scale is 1:N", 2 },
		{ "plan", "--scale", "1:0", "--scale is 1:N", 2 },
		{ "plan", "--scale", "1:10", "view 'plan' does not fit", 1 },
		{ "walk", "--scale", "1:50", "view 'walk' has perspective", 1 },
		{ "plan", "--cut", "0.05", "view 'plan' cuts nothing", 1 },
		{ "plan:1", "--cut", "99", "--cut goes from 0 to 10 m", 2 },
		{ "plan:x", "--time", "0", "what follows plan: is how many metres", 1 },
		{ "section:1,2", "--time", "0", "a section is two places", 1 },
		{ "plan", "--path", "orbit", "the camera moves in perspective", 1 },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
		g_autofree char *path = in_folder("r.pdf");
		g_auto(answer) a = commands_run("render", oak, "--view", cases[i].view,
			cases[i].option, cases[i].value, "--size", "A4", "-o", path);
		commands_assert_refused(&a, cases[i].status, cases[i].names);
		g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
	}
}

static void refusals(void)
{
	static const struct {
		const char *size, *output, *names;
	} cases[] = { { "A9", "x.png", "A9" }, { "0x0mm", "x.png", "0x0mm" },
		{ "640x400", "x.bmp", "x.bmp" } };
	for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
		g_autofree char *path = in_folder(cases[i].output);
		g_auto(answer) a = commands_run("render", oak, "--size", cases[i].size, "-o", path);
		commands_assert_refused(&a, 2, cases[i].names);
		g_assert_false(g_file_test(path, G_FILE_TEST_EXISTS));
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	folder = g_dir_make_tmp("pleinair-page-XXXXXX", NULL);
	oak = in_folder("oak");
	put_site();
	g_test_add_func("/render-page/svg-has-shapes", svg_has_shapes);
	g_test_add_func("/render-page/shown-by/rsvg-convert", shown_by_rsvg);
	g_test_add_func("/render-page/shown-by/inkscape", shown_by_inkscape);
	g_test_add_func("/render-page/pdf-has-its-paper", pdf_has_its_paper);
	g_test_add_func("/render-page/print-knows-its-size", print_knows_its_size);
	g_test_add_func("/render-page/scale", page_has_its_scale);
	g_test_add_func("/render-page/scale/refusals", scale_refusals);
	g_test_add_func("/render-page/film-is-one", film_is_one);
	g_test_add_func("/render-page/film-without-ffmpeg", film_without_ffmpeg);
	g_test_add_func("/render-page/refusals", refusals);
	int status = g_test_run();
	commands_shell("rm -rf '%s'", folder);
	g_free(oak);
	g_free(folder);
	return status;
}
