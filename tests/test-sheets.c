/* Segments that are filtered each by itself and put together by depth: what shows where is known, for the scenes are woven. */
#include "tests/gles-here.h"
#include "tests/onnx-made.h"
#include "tests/scene-made.h"
#include <stdlib.h>

#define WIDTH  640u
#define HEIGHT 480u

/* ---- a weave: slats of two segments, one before the other in turns ---- */

#define SLATS   5
#define PITCH_M 1.0
#define SLAT_M  0.6
#define BEFORE  0.15

static const uint8_t red[4] = { 220, 60, 50, 255 }, blue[4] = { 50, 80, 220, 255 };

/* Seen from y < 0; upright ones are of MADE_LEAF and red, those across of MADE_LEAF + 1 and blue. Each crossing has its own depths. */
static double depth_of(bool upright, int column, int row)
{
	bool upright_first = (column + row) % 2 == 0;
	return 205 + (upright == upright_first ? -BEFORE : BEFORE);
}

static made weave(void)
{
	made m = made_new();
	for (int n = 0; n < SLATS; n++)
		for (int k = 0; k < SLATS; k++)
			for (int upright = 0; upright < 2; upright++) {
				int column = upright ? n : k, row = upright ? k : n;
				double x = column * PITCH_M, z = row * PITCH_M,
				       edge = (PITCH_M - SLAT_M) / 2;
				struct made_plane p = { .corner_m = { 100 + x +
									      (upright ? edge : 0),
								depth_of(upright, column, row),
								3 + z + (upright ? 0 : edge) },
					.a_m = { upright ? SLAT_M : PITCH_M, 0, 0 },
					.b_m = { 0, 0, upright ? PITCH_M : SLAT_M },
					.apart_m = 0.006,
					.order = MADE_JITTERED,
					.leaf = (uint16_t)(MADE_LEAF + !upright) };
				memcpy(p.rgba, upright ? red : blue, 4);
				made_add_plane(&m, &p);
			}
	return m;
}

static struct camera before_weave(void)
{
	static const double eye[3] = { 102.5, 199, 5.5 }, target[3] = { 102.5, 205, 5.5 };
	return camera_look_at(eye, target, 44, WIDTH, HEIGHT);
}

/* Whether a slat of this kind is there, if it were so much wider. */
static bool hits(bool upright, const double at[2], double margin_m)
{
	double across = (upright ? at[0] - 100 : at[1] - 3) / PITCH_M, whole = floor(across);
	double along = upright ? at[1] - 3 : at[0] - 100;
	if (along < -margin_m || along > SLATS * PITCH_M + margin_m)
		return false;
	double within = (across - whole) * PITCH_M, edge = (PITCH_M - SLAT_M) / 2;
	return whole >= 0 && whole < SLATS && within > edge - margin_m &&
	       within < PITCH_M - edge + margin_m;
}

enum shown { NOTHING, RED, BLUE, NOT_TOLD };

/* At the weave's middle depth; what lies within margin_m of any border, or of where depths change, is not told. */
static enum shown truth_at(const struct camera *c, uint32_t x, uint32_t y, double margin_m)
{
	double place[2] = { x + 0.5, y + 0.5 }, ray[3], at[2];
	enum shown ret[2];
	int cells[2][2];
	for (int side = 0; side < 2; side++) { /* as if all were near, and far */
		double y_m = 205 + (side ? BEFORE : -BEFORE);
		camera_ray(c, place, ray);
		double t = (y_m - c->eye_m[1]) / ray[1];
		at[0] = c->eye_m[0] + t * ray[0];
		at[1] = c->eye_m[2] + t * ray[2];
		for (int k = 0; k < 2; k++) {
			double cell = (at[k] - (k ? 3 : 100)) / PITCH_M;
			if (fabs(cell - round(cell)) * PITCH_M < margin_m)
				return NOT_TOLD;
		}
		bool in_red = hits(true, at, 0), in_blue = hits(false, at, 0);
		if (in_red != hits(true, at, margin_m) || in_red != hits(true, at, -margin_m) ||
			in_blue != hits(false, at, margin_m) ||
			in_blue != hits(false, at, -margin_m))
			return NOT_TOLD;
		cells[side][0] = (int)floor((at[0] - 100) / PITCH_M);
		cells[side][1] = (int)floor((at[1] - 3) / PITCH_M);
		bool red_first = (cells[side][0] + cells[side][1]) % 2 == 0;
		ret[side] = in_red && (!in_blue || red_first) ? RED : in_blue ? BLUE : NOTHING;
	}
	bool same = ret[0] == ret[1] && memcmp(cells[0], cells[1], sizeof *cells) == 0;
	return same ? ret[0] : NOT_TOLD;
}

/* Each segment's lines are of its own colour, so that it can be told what they are of. */
#define CARTOON(colour)                                                                            \
	"{\"step\":\"points\"},{\"step\":\"bilateral\",\"passes\":1},{\"step\":\"quantise\","      \
	"\"smooth_px\":0},"                                                                        \
	"{\"step\":\"edges\",\"width_px\":12,\"bend_deg\":0,\"segments\":false,\"opacity\":1,"     \
	"\"colour\":"                                                                              \
	"\"" colour "\"}"
#define WOVEN(by)                                                                                  \
	"\"building\":{\"steps\":[" CARTOON("#801010") "]},\"vegetation\":{\"steps\":[" CARTOON(   \
		"#101080") "]},\"picture\":{\"steps\":[{\"step\":\"composite\",\"by\":\"" by       \
			   "\"}]}"

static enum shown shown_at(const struct picture_buffer *p, size_t at)
{
	int r = p->rgba[at][0], b = p->rgba[at][2];
	return abs(r - b) < 40 ? NOTHING : r > b ? RED : BLUE;
}

static gles_draw *on_gles; /* NULL: on the processor */

/* Caller clears it. */
static struct picture_buffer draw_weave(const scene *s, const struct camera *c, const char *nodes)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(drawing) d = made_drawing(nodes);
	g_autoptr(frame) f = made_frame(s, d, c);
	if (!on_gles)
		return made_picture(f);
	struct picture_buffer p = picture_buffer_new(c->width, c->height);
	gles_draw_frame(on_gles, f, &p, NULL, &error);
	g_assert_no_error(error);
	return p;
}

/* The part of the pixels whose truth is told that show another segment. */
static double wrong_part(const scene *s, const char *nodes, const char *name)
{
	struct camera c = before_weave();
	struct picture_buffer p = draw_weave(s, &c, nodes);
	size_t wrong = 0, told = 0;
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			/* Lines are 2.4 pixels to either side, 0.024 m. */
			enum shown truth = truth_at(&c, x, y, 0.035);
			if (truth == NOT_TOLD)
				continue;
			told++;
			wrong += shown_at(&p, (size_t)y * WIDTH + x) != truth;
		}
	g_test_message("%s: %.4f %% of %zu pixels show another segment", name,
		100.0 * (double)wrong / (double)told, told);
	picture_buffer_clear(&p);
	return (double)wrong / (double)told;
}

/* Pixels that a line should be on: beside the border of what lies before, on what lies behind it there. */
static double lines_missed(const scene *s, const char *nodes, const char *name)
{
	struct camera c = before_weave();
	struct picture_buffer p = draw_weave(s, &c, nodes);
	size_t missed = 0, lines = 0;
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			double place[2] = { x + 0.5, y + 0.5 }, ray[3], at[2];
			camera_ray(&c, place, ray);
			double t = (205 - BEFORE - c.eye_m[1]) / ray[1];
			at[0] = c.eye_m[0] + t * ray[0];
			at[1] = c.eye_m[2] + t * ray[2];
			int cell[2] = { (int)floor((at[0] - 100) / PITCH_M),
				(int)floor((at[1] - 3) / PITCH_M) };
			bool red_first = (cell[0] + cell[1]) % 2 == 0;
			double away[2] = { (at[0] - 100 - cell[0] * PITCH_M),
				(at[1] - 3 - cell[1] * PITCH_M) };
			if (cell[0] < 0 || cell[1] < 0 || cell[0] >= SLATS || cell[1] >= SLATS)
				continue;
			/* Of the slat in front, a pixel outside of it, and well within the crossing. */
			double beside = fabs(away[red_first ? 0 : 1] - PITCH_M / 2) - SLAT_M / 2,
			       along = fabs(away[red_first ? 1 : 0] - PITCH_M / 2);
			if (beside < 0.004 || beside > 0.016 || along > SLAT_M / 2 - 0.06)
				continue;
			lines++;
			enum shown is = shown_at(&p, (size_t)y * WIDTH + x);
			const uint8_t *rgb = p.rgba[(size_t)y * WIDTH + x];
			missed += is != (red_first ? RED : BLUE) || rgb[red_first ? 0 : 2] > 190;
		}
	g_test_message("%s: %.2f %% of %zu pixels of lines are missing", name,
		100.0 * (double)missed / (double)lines, lines);
	picture_buffer_clear(&p);
	return (double)missed / (double)lines;
}

static void test_weave(void)
{
	g_auto(made) m = weave();
	made_read(&m);
	g_assert_cmpfloat(wrong_part(m.scene, WOVEN("inpainted-depth"), "inpainted"), <=, 0.001);
	g_assert_cmpfloat(wrong_part(m.scene, WOVEN("layers"), "layers"), >, 0.05);
	double naive = wrong_part(m.scene, WOVEN("depth"), "depth test alone");
	g_assert_cmpfloat(naive, <=, 0.001);
	/* What the depth test alone does wrong is the lines. */
	double missed = lines_missed(m.scene, WOVEN("inpainted-depth"), "inpainted"),
	       missed_naive = lines_missed(m.scene, WOVEN("depth"), "depth test alone");
	g_assert_cmpfloat(missed, <=, 0.1);
	g_assert_cmpfloat(missed_naive, >, 0.5);
}

static void test_weave_gles(void)
{
	on_gles = gles_here_draw();
	if (on_gles)
		test_weave();
	g_clear_pointer(&on_gles, gles_draw_free);
}

/* ---- sheets ---- */

#define COURT_NODES                                                                                \
	"\"site\":{\"steps\":[{\"step\":\"points\"}]},\"vegetation\":{\"add\":["                   \
	"{\"step\":\"kuwahara\"}]}"

static struct camera before_court(void)
{
	static const double eye[3] = { 103, 196, 5 }, target[3] = { 103, 203, 4 };
	return camera_look_at(eye, target, 60, WIDTH, HEIGHT);
}

/* Pipelines whose filters are the same are one sheet. */
static void test_sheets(void)
{
	struct camera c = before_court();
	g_autoptr(drawing) plain = made_drawing(MADE_SITE("{\"step\":\"points\"}"));
	g_autoptr(frame) one = made_frame(made_shared_court(), plain, &c);
	g_assert_false(one->is_filtered);
	g_assert_cmpuint(one->sheets, ==, 1);
	g_autoptr(drawing) two_ways = made_drawing(COURT_NODES);
	g_autoptr(frame) two = made_frame(made_shared_court(), two_ways, &c);
	g_assert_true(two->is_filtered);
	g_assert_cmpuint(two->sheets, ==, 2);
	g_autoptr(drawing) same =
		made_drawing("\"site\":{\"steps\":[{\"step\":\"points\"},{\"step\":\"kuwahara\"}]},"
			     "\"vegetation\":{\"change\":{\"points\":{\"saturation\":0}}}");
	g_autoptr(frame) merged = made_frame(made_shared_court(), same, &c);
	g_assert_cmpuint(same->pipelines->len, ==, 2);
	g_assert_cmpuint(merged->sheets, ==, 1);
}

/* Filters that change nothing leave the picture as it was, however many sheets there are. */
static void test_nothing(void)
{
	static const char *const nodes[] = {
		MADE_SITE("{\"step\":\"points\"},{\"step\":\"grade\"}"),
		MADE_SITE(
			"{\"step\":\"points\"}") ",\"vegetation\":{\"add\":[{\"step\":\"grade\"}]}",
		MADE_SITE(
			"{\"step\":\"points\"}") ",\"picture\":{\"steps\":[{\"step\":\"grade\"}]}",
		MADE_SITE("{\"step\":\"points\"},{\"step\":\"warp\",\"amplitude_px\":0}"),
	};
	struct camera c = before_court();
	g_autoptr(drawing) plain = made_drawing(MADE_SITE("{\"step\":\"points\"}"));
	g_autoptr(frame) f = made_frame(made_shared_court(), plain, &c);
	struct picture_buffer wanted = made_picture(f);
	for (size_t n = 0; n < G_N_ELEMENTS(nodes); n++) {
		g_autoptr(drawing) d = made_drawing(nodes[n]);
		g_autoptr(frame) filtered = made_frame(made_shared_court(), d, &c);
		g_assert_true(filtered->is_filtered);
		struct picture_buffer is = made_picture(filtered);
		size_t off = 0;
		for (size_t at = 0; at < (size_t)WIDTH * HEIGHT; at++)
			for (int k = 0; k < 3; k++)
				off += abs(is.rgba[at][k] - wanted.rgba[at][k]) > 1;
		g_test_message("%zu of %u channels differ", off, 3 * WIDTH * HEIGHT);
		/* Of two sheets, points at borders are not mixed with what is behind them. */
		g_assert_cmpuint(off, <=, n == 1 ? 3 * WIDTH * HEIGHT / 100 : 0);
		picture_buffer_clear(&is);
	}
	picture_buffer_clear(&wanted);
}

/* Strokes that lie over are not filtered: alone they are drawn as without filters. */
static void test_over(void)
{
#define LINES "{\"step\":\"lines\",\"points\":\"surface\",\"copies\":1,\"over\":true}"
	struct camera c = before_court();
	g_autoptr(drawing) plain = made_drawing(MADE_SITE(LINES));
	g_autoptr(drawing) blurred = made_drawing(MADE_SITE(
		LINES) ",\"picture\":{\"steps\":[{\"step\":\"gaussian\",\"sigma_px\":20}]}");
	g_autoptr(frame) a = made_frame(made_shared_court(), plain, &c);
	g_autoptr(frame) b = made_frame(made_shared_court(), blurred, &c);
	struct picture_buffer p = made_picture(a), q = made_picture(b);
	made_assert_same(&p, &q);
	picture_buffer_clear(&p);
	picture_buffer_clear(&q);
}

/* The same bytes again, on one thread, with the memory of another frame, for every step of pictures at once. */
static void test_same(void)
{
	struct camera c = before_court();
	g_autoptr(drawing) d =
		made_drawing(MADE_SITE("{\"step\":\"points\"},{\"step\":\"edl\"},{\"step\":"
				       "\"gaps\"},{\"step\":\"bilateral\"},"
				       "{\"step\":\"quantise\"},{\"step\":\"edges\",\"wobble_px\":"
				       "2}") ",\"vegetation\":{\"add\":[{\"step\":\"warp\"}]},"
					     "\"picture\":{\"steps\":["
					     "{\"step\":\"watercolour\"},{\"step\":\"occlusion\"},{"
					     "\"step\":\"oil\"}]}");
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
	struct picture_buffer first = made_picture(f), again = made_picture(f);
	made_assert_same(&first, &again);
	f->single_thread = true;
	draw_room *room = draw_room_new();
	draw_frame(room, f, &again, NULL);
	draw_frame(room, f, &again, NULL);
	made_assert_same(&first, &again);
	draw_room_free(room);
	picture_buffer_clear(&first);
	picture_buffer_clear(&again);
}

/* ---- focus ---- */

/* The segment in focus is as it is, all else is in patches; and the other way round. */
static void test_focus_on_segment(void)
{
	struct camera c = before_court();
	g_autoptr(GError) error = NULL;
	g_autoptr(segments) tree = made_tree();
	g_autofree char *text =
		g_strdup_printf("{\"schema\":1,\"paper\":{\"grain\":0},\"focus\":{\"on\":"
				"\"segment\",\"filters\":1,\"segment\":%d},"
				"\"segments\":{\"site\":{\"steps\":[{\"step\":\"points\"}]},"
				"\"picture\":{\"steps\":[{\"step\":\"kuwahara\",\"radius_px\":12,"
				"\"where\":\"away\"}]}}}",
			MADE_LEAF + 1);
	g_autoptr(style) s = style_parse(text, -1, "made.json", &error);
	g_assert_no_error(error);
	g_autoptr(drawing) d = drawing_new(s, tree, NULL, &error);
	g_assert_no_error(error);
	g_autoptr(drawing) plain = made_drawing(MADE_SITE("{\"step\":\"points\"}"));
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
	g_autoptr(frame) as_it_is = made_frame(made_shared_court(), plain, &c);
	struct picture_buffer p = made_picture(f), q = made_picture(as_it_is);
	uint32_t count;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	g_autoptr(visibility_mask) m = visibility_mask_new(f, views, count);
	size_t in_focus = 0, changed_in = 0, changed_out = 0;
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			size_t at = (size_t)y * WIDTH + x;
			int32_t key = mask_key(m, (int32_t)x, (int32_t)y);
			bool changed = memcmp(p.rgba[at], q.rgba[at], 3) != 0;
			if (key < MASK_EMPTY && frame_pipeline(f, key & 255)->is_focus) {
				in_focus++;
				changed_in += changed;
			} else {
				changed_out += changed;
			}
		}
	g_assert_cmpuint(in_focus, >, 1000);
	g_assert_cmpuint(changed_in, ==, 0);
	g_assert_cmpuint(changed_out, >, 1000);
	picture_buffer_clear(&p);
	picture_buffer_clear(&q);
}

/* ---- time ---- */

static void test_time(void)
{
	struct camera c = before_court();
	g_autoptr(drawing) d = made_drawing(
		MADE_SITE("{\"step\":\"points\"}") ",\"vegetation\":{\"add\":[{\"step\":\"warp\","
						   "\"period_s\":2}]}");
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
	struct picture_buffer first = made_picture(f);
	f->time_s = 2;
	struct picture_buffer later = made_picture(f);
	made_assert_same(&first, &later);
	f->time_s = 0.5;
	picture_buffer_clear(&later);
	later = made_picture(f);
	g_assert_cmpint(memcmp(first.rgba, later.rgba, (size_t)WIDTH * HEIGHT * 4), !=, 0);
	picture_buffer_clear(&first);
	picture_buffer_clear(&later);
}

/* ---- a network of one's own ---- */

/* Reads the file of a network that makes negatives: 255 - v. */
static char *write_net(uint64_t classes)
{
	static const float weight[16] = { -1, 0, 0, 0, -1, 0, 0, 0, -1 },
			   bias[4] = { 255, 255, 255 };
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = g_dir_make_tmp("test-sheets-XXXXXX", &error);
	g_assert_no_error(error);
	GByteArray *graph = g_byte_array_new();
	put_convolution(graph, 0, 1, 3, classes, 1, 1, weight, bias);
	g_autoptr(GByteArray) onnx = model_of(graph, 3, classes, 1, 0, 0);
	char *path = g_build_filename(folder, "negative.onnx", NULL);
	g_file_set_contents(path, (const char *)onnx->data, (gssize)onnx->len, &error);
	g_assert_no_error(error);
	return path;
}

static void remove_net(const char *path)
{
	g_autofree char *folder = g_path_get_dirname(path);
	files_remove_tree(folder, NULL);
}

static char *neural_nodes(const char *path)
{
	return g_strdup_printf(
		MADE_SITE(
			"{\"step\":\"points\"}") ",\"picture\":{\"steps\":[{\"step\":"
						 "\"neural\",\"side_px\":4096,\"model\":\"%s\"}]}",
		path);
}

static void test_neural(void)
{
	struct camera c = before_court();
	g_autofree char *path = write_net(3), *nodes = neural_nodes(path);
	g_autoptr(drawing) d = made_drawing(nodes);
	g_autoptr(drawing) plain = made_drawing(MADE_SITE("{\"step\":\"points\"}"));
	g_autoptr(frame) f = made_frame(made_shared_court(), d, &c);
	frame *g = made_frame(made_shared_court(), plain, &c);
	struct picture_buffer p = made_picture(f), q = made_picture(g);
	size_t off = 0;
	for (size_t at = 0; at < (size_t)WIDTH * HEIGHT; at++)
		for (int k = 0; k < 3; k++)
			off += abs(p.rgba[at][k] + q.rgba[at][k] - 255) > 1;
	g_assert_cmpuint(off, ==, 0);
	/* What a GPU drew the processor runs the network on, and nothing else differs. */
	g_autoptr(gles_draw) gl = gles_here_draw();
	g_autoptr(GError) error = NULL;
	if (gl)
		gles_draw_frame(gl, f, &q, NULL, &error);
	g_assert_no_error(error);
	for (size_t at = 0; gl && at < (size_t)WIDTH * HEIGHT; at++)
		for (int k = 0; k < 3; k++)
			off += abs(p.rgba[at][k] - q.rgba[at][k]) > 1;
	g_assert_cmpuint(off, <, WIDTH * HEIGHT / 1000);
	picture_buffer_clear(&p);
	picture_buffer_clear(&q);
	frame_free(g);
	remove_net(path);
}

/* One sentence for what is none: no file, no network, none that makes a picture of a picture. */
static void test_neural_wrong(void)
{
	struct camera c = before_court();
	g_autofree char *two = write_net(2);
	g_autofree char *folder = g_path_get_dirname(two);
	g_autofree char *bad = g_build_filename(folder, "bad.onnx", NULL),
			*none = g_build_filename(folder, "none.onnx", NULL);
	g_assert_true(g_file_set_contents(bad, "no network", -1, NULL));
	const char *const paths[] = { two, bad, none };
	for (size_t n = 0; n < G_N_ELEMENTS(paths); n++) {
		g_autoptr(GError) error = NULL;
		g_autofree char *nodes = neural_nodes(paths[n]);
		g_autoptr(drawing) d = made_drawing(nodes);
		g_assert_null(frame_new(made_shared_court(), d, &c, &error));
		g_assert_nonnull(error);
		g_assert_nonnull(strstr(error->message, paths[n]));
		g_assert_null(strchr(error->message, '\n'));
	}
	g_autoptr(GError) error = NULL;
	g_autoptr(drawing) d = made_drawing(MADE_SITE("{\"step\":\"neural\"}"));
	g_assert_null(frame_new(made_shared_court(), d, &c, &error));
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_FIELD);
	remove_net(two);
}

/* What draws points has no place in the picture's steps. */
static void test_picture_wrong(void)
{
	g_autoptr(GError) error = NULL;
	g_assert_null(style_parse(
		"{\"schema\":1,\"segments\":{\"picture\":{\"steps\":[{\"step\":\"points\"}]}}}", -1,
		"made.json", &error));
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_FIELD);
	g_assert_nonnull(strstr(error->message, "segments.picture"));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/sheets/weave", test_weave);
	g_test_add_func("/sheets/weave-gles", test_weave_gles);
	g_test_add_func("/sheets/sheets", test_sheets);
	g_test_add_func("/sheets/nothing", test_nothing);
	g_test_add_func("/sheets/over", test_over);
	g_test_add_func("/sheets/same", test_same);
	g_test_add_func("/sheets/focus-on-segment", test_focus_on_segment);
	g_test_add_func("/sheets/time", test_time);
	g_test_add_func("/sheets/neural", test_neural);
	g_test_add_func("/sheets/neural-wrong", test_neural_wrong);
	g_test_add_func("/sheets/picture-wrong", test_picture_wrong);
	int status = g_test_run();
	gles_context_free(gles_here_context);
	return status;
}
