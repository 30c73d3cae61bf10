#include "render/bench-place.h"
#include "firmware-io/files.h"
#include "process/bench-run.h"
#include "process/bench-sites.h"
#include "process/site-lines.h"

#define SCENE "court"

/* What is there already is neither scanned nor processed again. */
static bool make_site(bench_place *p, const struct bench_place_options *o, GError **error)
{
	const struct preset *preset = preset_find(o->preset ? o->preset : "fine");
	struct bench_scene court = { .name = SCENE, .seed = o->seed };
	g_autofree char *name =
		g_strdup_printf(SCENE "-%" G_GUINT64_FORMAT "-%s", (guint64)o->seed, preset->name);
	g_autofree char *program = bench_program("process");
	p->path = g_build_filename(o->keep ? o->keep : p->work, name, NULL);
	struct bench_run run = { 0 };
	bool good = (!o->keep || files_make_folder(o->keep, error)) &&
		    bench_scene_scan(&court, p->path, preset, error) &&
		    bench_run((const char *[]){ program, p->path, NULL }, &run, error);
	g_free(run.output);
	return good;
}

static bool open_site(bench_place *p, double aspect, GError **error)
{
	p->site = site_open(p->path, error);
	p->model = p->site ? model_open(p->path, error) : NULL;
	p->stations = p->model ? view_stations(p->site, p->model, error) : NULL;
	if (!p->stations)
		return false;
	p->sources = (struct view_sources){ .site = p->site,
		.stations = (const struct view_station *)(void *)p->stations->data,
		.station_count = p->stations->len,
		.aspect = aspect };
	p->sources.boxes = p->boxes = view_boxes_new(p->model);
	return segments_load_any(p->path, &p->tree, error);
}

bench_place *bench_place_new(const struct bench_place_options *o, double aspect, GError **error)
{
	g_autoptr(bench_place) p = g_new0(bench_place, 1);
	p->work = g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	if (!p->work)
		return NULL;
	p->keep = g_strdup(o->keep);
	if (o->site)
		p->path = g_strdup(o->site);
	else if (!make_site(p, o, error))
		return NULL;
	return open_site(p, aspect, error) ? g_steal_pointer(&p) : NULL;
}

void bench_place_free(bench_place *p)
{
	if (!p)
		return;
	if (p->stations)
		g_array_unref(p->stations);
	segments_free(p->tree);
	view_boxes_free(p->boxes);
	model_free(p->model);
	site_free(p->site);
	if (p->work)
		files_remove_tree(p->work, NULL);
	g_free(p->work);
	g_free(p->keep);
	g_free(p->path);
	g_free(p);
}

char *bench_place_town(
	const bench_place *p, double million_points, struct bench_town *ret, GError **error)
{
	g_autofree char *name = g_strdup_printf("town-%.10g", million_points),
			*path = g_build_filename(p->keep ? p->keep : p->work, name, NULL),
			*file = model_path(path);
	if (!g_file_test(file, G_FILE_TEST_EXISTS) &&
		!bench_town_write(p->path, path, (uint64_t)(million_points * 1e6), ret, error))
		return NULL;
	return g_steal_pointer(&path);
}

scene *bench_place_scene(const bench_place *p, GError **error)
{
	g_autofree uint8_t *leaf_class = p->tree ? segments_classes(p->tree) : NULL;
	g_autoptr(scene) s = scene_new_within(p->model, leaf_class, G_MAXUINT64, error);
	g_autoptr(profile_lines) lines = s ? site_lines_load(p->path, NULL) : NULL;
	if (lines)
		scene_set_lines(s, lines);
	return g_steal_pointer(&s);
}

drawing *bench_place_drawing(const bench_place *p, const char *style_name, GError **error)
{
	g_autoptr(style) s = style_find(style_name, p->path, error);
	return s ? drawing_new(s, p->tree, NULL, error) : NULL;
}
