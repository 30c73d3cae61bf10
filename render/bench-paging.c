#include "render/bench-paging.h"
#include "acquire/cli.h"
#include "render/bench-flight.h"
#include "render/painter.h"
#include "render/scene-pager.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* As pictures are while they move (kiosk/artist.c). */
#define SCALE   0.5
#define COARSER 0.85
#define STILLS  3

struct still {
	double complete_s;
	uint64_t points, bytes;
	bool is_whole;
};

struct bench {
	const struct bench_paging_options *options;
	bench_place *place; /* of a site that is there */
	char *path;
	struct bench_town town; /* all 0: none was made */
	model *model;
	segments *tree;
	scene *scene;
	drawing *drawing;
	painter *painter;
	frame *frame;
	struct bench_flight flight;
	double opened_s, first_s, flown_s;
	GArray *frame_s; /* of double */
	double missing, missing_worst, turn_worst_s;
	uint64_t points;
	struct still still[STILLS];
};

static double now_s(void)
{
	return 1e-6 * (double)g_get_monotonic_time();
}

/* ---- the site ---- */

static bool make_town(struct bench *b, GError **error)
{
	const struct bench_paging_options *o = b->options;
	b->place = bench_place_new(&o->place, 1, error);
	if (!b->place)
		return false;
	b->path = bench_place_town(b->place, o->million_points, &b->town, error);
	return b->path;
}

static bool find_site(struct bench *b, GError **error)
{
	if (!b->options->place.site)
		return make_town(b, error);
	b->path = g_strdup(b->options->place.site);
	return true;
}

static bool open_scene(struct bench *b, GError **error)
{
	double began_s = now_s();
	b->model = model_open(b->path, error);
	b->scene =
		b->model ? scene_new_within(b->model, NULL, b->options->memory_bytes, error) : NULL;
	b->opened_s = now_s() - began_s;
	return b->scene;
}

static bool open_all(struct bench *b, GError **error)
{
	enum backend_wish wish;
	b->tree = segments_load(b->path, error);
	g_autoptr(style) s = b->tree ? style_find(b->options->style, b->path, error) : NULL;
	b->drawing = s ? drawing_new(s, b->tree, NULL, error) : NULL;
	if (!b->drawing || !backend_wish_parse(b->options->backend, &wish, error))
		return false;
	b->painter = painter_new(wish, error);
	return b->painter;
}

static int by_value(const void *a, const void *b)
{
	const double *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

/* ---- frames ---- */

static struct scene_look look_of(const struct bench *b, const struct camera *c, bool is_moving)
{
	return (struct scene_look){ .camera = c,
		.ink_px = b->frame->ink_px,
		.is_moving = is_moving,
		.is_quiet = is_moving && painter_takes_processor(b->painter) };
}

static bool draw(struct bench *b, const struct camera *c, struct picture_buffer *to,
	struct scene_turned *ret, GError **error)
{
	*ret = (struct scene_turned){ 0 };
	if (b->scene->pager) {
		struct scene_look look = look_of(b, c, true);
		double began_s = now_s();
		scene_pager_turn(b->scene->pager, &look, ret);
		b->turn_worst_s = fmax(b->turn_worst_s, now_s() - began_s);
	}
	return frame_move(b->frame, c, error) &&
	       painter_draw(b->painter, b->frame, to, NULL, error);
}

static bool fly(struct bench *b, GError **error)
{
	uint32_t width = (uint32_t)lround(b->options->width * SCALE),
		 height = (uint32_t)lround(b->options->height * SCALE);
	struct camera c = bench_flight_camera(&b->flight, 0, width, height);
	struct picture_buffer to = picture_buffer_new(width, height);
	double began_s = now_s(), at = 0;
	bool good = true;
	b->frame = frame_new_coarse(b->scene, b->drawing, &c, pow(SCALE, -COARSER), error);
	for (; b->frame && good && at < 1; at = (now_s() - began_s) / b->options->seconds) {
		struct scene_turned turned;
		double frame_began_s = now_s();
		c = bench_flight_camera(&b->flight, at, width, height);
		good = draw(b, &c, &to, &turned, error);
		double frame_s = now_s() - frame_began_s;
		if (b->scene->pager)
			scene_pager_let_read(b->scene->pager);
		double all = (double)(turned.points + turned.points_missing);
		double missing = all > 0 ? (double)turned.points_missing / all : 0;
		if (!b->frame_s->len)
			b->first_s = now_s() - began_s;
		g_array_append_val(b->frame_s, frame_s);
		b->missing += missing;
		b->missing_worst = fmax(b->missing_worst, missing);
		b->points += turned.points;
		if (cli_interrupted())
			break;
	}
	b->flown_s = now_s() - began_s;
	picture_buffer_clear(&to);
	return b->frame && good;
}

static bool stand_still(struct bench *b, GError **error)
{
	for (int n = 0; n < STILLS && b->scene->pager; n++) {
		struct camera c = bench_flight_camera(&b->flight, (double)n / (STILLS - 1),
			b->options->width, b->options->height);
		struct scene_look look = look_of(b, &c, false);
		struct scene_turned turned;
		uint64_t read = scene_pager_sums(b->scene->pager).bytes_read;
		double began_s = now_s();
		if (!scene_pager_settle(b->scene->pager, &look, error))
			return false;
		b->still[n].complete_s = now_s() - began_s;
		scene_pager_turn(b->scene->pager, &look, &turned);
		b->still[n].points = turned.points;
		b->still[n].is_whole = turned.is_whole;
		b->still[n].bytes = scene_pager_sums(b->scene->pager).bytes_read - read;
	}
	return true;
}

/* ---- figures ---- */

/* Of /proc/self/status, in bytes. */
static double status_of(const char *key)
{
	g_autofree char *text = NULL;
	if (!g_file_get_contents("/proc/self/status", &text, NULL, NULL))
		return 0;
	const char *at = strstr(text, key);
	return at ? 1024 * g_ascii_strtod(at + strlen(key) + 1, NULL) : 0;
}

static double frame_at(const struct bench *b, double part)
{
	guint n = (guint)(part * (b->frame_s->len - 1) + 0.5);
	return 1e3 * g_array_index(b->frame_s, double, n);
}

#define GIB (1.0 / (1 << 30))

static void print_text(struct bench *b)
{
	const struct bench_paging_options *o = b->options;
	printf("paging: %.1f million points, %ux%u of %ux%u, %s, %s\n",
		1e-6 * (double)model_count(b->model), b->frame->camera.width,
		b->frame->camera.height, o->width, o->height, o->style, painter_name(b->painter));
	if (b->town.points)
		printf("  %-10s a town of %u x %u blocks, made in %.0f s\n", "site", b->town.across,
			b->town.down, b->town.seconds);
	printf("  %-10s %.2f s, %.2f s with the first frame  (reach: <= 2)\n", "open", b->opened_s,
		b->opened_s + b->first_s);
	printf("  %-10s median %.1f ms, 95 %% %.1f ms, worst %.1f ms of %u in %.1f s  (reach: <= "
	       "100)\n",
		"frames", frame_at(b, 0.5), frame_at(b, 0.95), frame_at(b, 1), b->frame_s->len,
		b->flown_s);
	if (b->scene->pager) {
		struct scene_pager_sums sums = scene_pager_sums(b->scene->pager);
		printf("  %-10s %.2f million points in view, %.2f %% missing, %.2f %% at worst; "
		       "choosing them took %.1f ms at worst\n",
			"", 1e-6 * (double)b->points / b->frame_s->len,
			100 * b->missing / b->frame_s->len, 100 * b->missing_worst,
			1e3 * b->turn_worst_s);
		for (int n = 0; n < STILLS; n++)
			printf("  %-10s complete after %.2f s: %.2f million points%s, %.2f GiB "
			       "read\n",
				n ? "" : "still", b->still[n].complete_s,
				1e-6 * (double)b->still[n].points,
				b->still[n].is_whole ? ", all that are in view" : "",
				(double)b->still[n].bytes * GIB);
		printf("  %-10s %.2f GiB in all, %" G_GUINT64_FORMAT " nodes\n", "read",
			(double)sums.bytes_read * GIB, sums.nodes_read);
	}
	printf("  %-10s %.2f GiB at most, %.2f GiB its own; points may take %.2f GiB  (reach: <= "
	       "4)\n",
		"memory", status_of("VmHWM:") * GIB, status_of("RssAnon:") * GIB,
		(double)scene_bytes(b->scene) * GIB);
}

static void print_json(struct bench *b)
{
	JsonObject *j = json_object_new();
	json_object_set_int_member(j, "points", (gint64)model_count(b->model));
	json_object_set_string_member(j, "style", b->options->style);
	json_object_set_string_member(j, "backend", painter_name(b->painter));
	json_object_set_int_member(j, "width", b->frame->camera.width);
	json_object_set_int_member(j, "height", b->frame->camera.height);
	json_object_set_double_member(j, "open_s", b->opened_s);
	json_object_set_double_member(j, "first_frame_s", b->opened_s + b->first_s);
	json_object_set_int_member(j, "frames", b->frame_s->len);
	json_object_set_double_member(j, "frame_median_ms", frame_at(b, 0.5));
	json_object_set_double_member(j, "frame_95_ms", frame_at(b, 0.95));
	json_object_set_double_member(j, "frame_worst_ms", frame_at(b, 1));
	json_object_set_double_member(j, "turn_worst_ms", 1e3 * b->turn_worst_s);
	json_object_set_double_member(j, "missing", b->missing / b->frame_s->len);
	json_object_set_double_member(j, "peak_bytes", status_of("VmHWM:"));
	json_object_set_int_member(j, "points_bytes", (gint64)scene_bytes(b->scene));
	JsonArray *stills = json_array_new();
	for (int n = 0; n < STILLS && b->scene->pager; n++) {
		JsonObject *s = json_object_new();
		json_object_set_double_member(s, "complete_s", b->still[n].complete_s);
		json_object_set_int_member(s, "points", (gint64)b->still[n].points);
		json_object_set_int_member(s, "bytes_read", (gint64)b->still[n].bytes);
		json_object_set_boolean_member(s, "is_whole", b->still[n].is_whole);
		json_array_add_object_element(stills, s);
	}
	json_object_set_array_member(j, "stills", stills);
	if (b->scene->pager)
		json_object_set_int_member(
			j, "bytes_read", (gint64)scene_pager_sums(b->scene->pager).bytes_read);
	cli_print_json(j);
}

static void bench_clear(struct bench *b)
{
	frame_free(b->frame);
	painter_free(b->painter);
	drawing_free(b->drawing);
	scene_free(b->scene);
	segments_free(b->tree);
	model_free(b->model);
	bench_place_free(b->place);
	g_array_unref(b->frame_s);
	g_free(b->path);
}

bool bench_paging(const struct bench_paging_options *options, GError **error)
{
	struct bench b = { .options = options,
		.frame_s = g_array_new(FALSE, FALSE, sizeof(double)) };
	cli_catch_interrupts();
	bool good = find_site(&b, error) && open_scene(&b, error) && open_all(&b, error);
	if (good) {
		b.flight = bench_flight_over(b.model, options->seconds);
		good = fly(&b, error) && stand_still(&b, error);
	}
	if (good) {
		g_array_sort(b.frame_s, by_value);
		if (options->json)
			print_json(&b);
		else
			print_text(&b);
	}
	bench_clear(&b);
	return good;
}
