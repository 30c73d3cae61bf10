#include "acquire/cli.h"
#include "render/bench-render-private.h"
#include "render/bench-subset.h"
#include <stdio.h>

struct bench {
	const struct bench_render_options *options;
	bench_place *place;
	JsonArray *scenes; /* NULL: printed */
	struct render_strokes strokes;
};

static model *open_part(const bench_place *p, uint64_t points, GError **error)
{
	if (points >= model_count(p->model))
		return model_open(p->path, error);
	g_autofree char *path = g_build_filename(p->work, "part.model", NULL);
	return bench_subset_write(p->model, points, path, error) ? model_open_file(path, error)
								 : NULL;
}

/* Of the last scene. */
static bool measure_strokes(
	struct bench *b, const struct render_scene *s, const model *m, GError **error)
{
	g_autoptr(scene) points = scene_new(m, error);
	return points && render_strokes_measure(&b->strokes, b->place, points,
				 &s->camera[RENDER_CAMERAS - 1].camera, b->options->repeats, error);
}

static bool measure_scene(struct bench *b, const struct render_paper *paper, GError **error)
{
	struct render_scene s = { .paper = paper };
	s.points_of_site = model_count(b->place->model);
	g_autoptr(model) m = open_part(b->place, paper->points, error);
	bool good = m && render_scene_measure(&s, b->place, m, b->options, error);
	if (good && b->scenes)
		json_array_add_object_element(b->scenes, render_scene_to_json(&s));
	else if (good)
		render_print_scene(&s);
	if (good && paper == &render_papers[G_N_ELEMENTS(render_papers) - 1])
		good = measure_strokes(b, &s, m, error);
	render_scene_clear(&s);
	return good;
}

static void print_json(struct bench *b)
{
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "width", b->options->width);
	json_object_set_int_member(o, "height", b->options->height);
	json_object_set_int_member(o, "repeats", b->options->repeats);
	json_object_set_array_member(o, "scenes", b->scenes);
	json_object_set_object_member(o, "strokes", render_strokes_to_json(&b->strokes));
	b->scenes = NULL;
	cli_print_json(o);
}

bool bench_render(const struct bench_render_options *o, GError **error)
{
	g_autoptr(bench_place) p = bench_place_new(&o->place, (double)o->width / o->height, error);
	struct bench b = { o, p, o->json ? json_array_new() : NULL };
	bool good = p;
	if (good && !o->json)
		printf("drawing, %u x %u, the least of %u; Nc, N1, N2 in thousands; * is not what "
		       "it is meant to be\n\n",
			o->width, o->height, o->repeats);
	for (size_t n = 0; good && n < G_N_ELEMENTS(render_papers); n++)
		good = measure_scene(&b, &render_papers[n], error);
	if (good && o->json)
		print_json(&b);
	else if (good)
		render_print_strokes(&b.strokes);
	g_clear_pointer(&b.scenes, json_array_unref);
	return good;
}
