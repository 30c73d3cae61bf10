#include "process/bench-sites.h"
#include "acquire/cli.h"
#include "acquire/scan.h"
#include "firmware-io/files.h"
#include "process/bench-run.h"
#include <json-glib/json-glib.h>
#include <stdio.h>
#include <unistd.h>

static char *describe(const struct bench_site *s, bool moved)
{
	return g_strdup_printf("%s?seed=%" G_GUINT64_FORMAT "%s%s%s%s", s->scene, (guint64)s->seed,
		s->variant ? "&" : "", s->variant ? s->variant : "", s->variant ? "=1" : "",
		moved ? "&moved=1" : "");
}

/* ---- scanning ---- */

static bool asked_to_stop(const struct run_progress *progress, gpointer user_data)
{
	bool (*stop)(void) = *(bool (**)(void))user_data;
	(void)progress;
	return stop && stop();
}

static bool stopped(bool (*stop)(void), GError **error)
{
	if (!stop || !stop())
		return false;
	g_clear_error(error);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
	return true;
}

static bool scan_one(site *to, const char *device, const struct preset *preset, bool (*stop)(void),
	GError **error)
{
	struct scan_options options = {
		.device = device, .preset = preset, .progress = asked_to_stop, .user_data = &stop
	};
	struct scan_result result;
	uint32_t partial;
	if (!scan_record(to, &options, &result, &partial, error)) {
		stopped(stop, error);
		return false;
	}
	g_autofree char *folder = site_scan_path(to, result.number);
	g_autofree char *record = g_build_filename(folder, "raw.rec", NULL);
	unlink(record);
	return true;
}

/* devices: of char *, one a scan. */
static bool scan_missing(const char *path, const GPtrArray *devices, const struct preset *preset,
	bool (*stop)(void), GError **error)
{
	g_autoptr(site) to = site_open_for_writing(path, error);
	uint32_t partial = 0;
	if (!to || !site_find_partial(to, &partial, error) ||
		(partial && !site_discard_partial(to, partial, error)))
		return false;
	g_autoptr(GArray) there = site_scans(to, error);
	for (guint i = there ? there->len : 0; there && i < devices->len; i++)
		if (!scan_one(to, devices->pdata[i], preset, stop, error))
			return false;
	return there;
}

static bool scan_stations(struct bench_site *s, const char *path, const struct preset *preset,
	bool (*stop)(void), GError **error)
{
	g_autoptr(GPtrArray) devices = g_ptr_array_new_with_free_func(g_free);
	for (uint32_t i = 0; i < s->count; i++) {
		g_autofree char *what = describe(s, s->scans[i].moved);
		g_ptr_array_add(devices, g_strdup_printf("sim:%s&station=%u&camera=none", what,
						 s->scans[i].station));
	}
	return scan_missing(path, devices, preset, stop, error);
}

/* ---- the truth ---- */

static JsonParser *ask_truth(const struct bench_site *s, bool moved, GError **error)
{
	g_autofree char *what = describe(s, moved), *program = bench_program("sim");
	g_autoptr(JsonParser) parser = json_parser_new();
	struct bench_run asked;
	if (!bench_run((const char *[]){ program, "--truth-poses", what, NULL }, &asked, error))
		return NULL;
	g_autofree char *said = asked.output;
	return json_parser_load_from_data(parser, said, -1, error) ? g_steal_pointer(&parser)
								   : NULL;
}

static struct pose read_pose(JsonObject *o)
{
	struct pose p;
	JsonArray *at = json_object_get_array_member(o, "position_m"),
		  *rotation = json_object_get_array_member(o, "rotation");
	for (guint i = 0; i < 3; i++) {
		p.translation_m[i] = json_array_get_double_element(at, i);
		for (guint j = 0; j < 3; j++)
			p.rotation[i][j] = json_array_get_double_element(
				json_array_get_array_element(rotation, i), j);
	}
	return p;
}

static bool place_scans(struct bench_site *s, bool moved, GError **error)
{
	g_autoptr(JsonParser) parser = ask_truth(s, moved, error);
	if (!parser)
		return false;
	JsonArray *stations = json_node_get_array(json_parser_get_root(parser));
	for (uint32_t i = 0; i < s->count; i++) {
		if (s->scans[i].moved != moved)
			continue;
		if (s->scans[i].station > json_array_get_length(stations)) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
				"the scene %s has no station %u", s->scene, s->scans[i].station);
			return false;
		}
		s->scans[i].truth =
			read_pose(json_array_get_object_element(stations, s->scans[i].station - 1));
	}
	return true;
}

/* ---- all of it ---- */

static void list_scans(struct bench_site *s)
{
	s->count = s->stations + s->moved_stations;
	s->scans = g_new0(struct bench_scan, s->count);
	for (uint32_t i = 0; i < s->count; i++) {
		bool moved = i >= s->stations;
		s->scans[i].moved = moved;
		s->scans[i].station = moved ? 2 * (i - s->stations) + 1 : i + 1;
	}
}

static bool load_scans(struct bench_site *s, const char *path, bool (*stop)(void), GError **error)
{
	g_autoptr(site) from = site_open(path, error);
	if (!from)
		return false;
	for (uint32_t i = 0; i < s->count; i++) {
		if (stopped(stop, error))
			return false;
		g_autoptr(panorama) p = scan_load(from, i + 1, false, error);
		if (!p)
			return false;
		g_autoptr(range_grid) grid = range_grid_from_panorama(p);
		s->scans[i].scan = pair_scan_new(grid);
	}
	return true;
}

static char *site_path_in(
	const struct bench_site *s, const char *folder, const struct preset *preset)
{
	g_autofree char *name = g_strdup_printf("%s-%s%s%" G_GUINT64_FORMAT "-%s-grey", s->scene,
		s->variant ? s->variant : "", s->variant ? "-" : "", (guint64)s->seed,
		preset->name);
	return g_build_filename(folder, name, NULL);
}

bool bench_site_make(struct bench_site *s, const char *folder, const struct preset *preset,
	bool (*stop)(void), GError **error)
{
	g_autofree char *path = site_path_in(s, folder, preset);
	list_scans(s);
	return scan_stations(s, path, preset, stop, error) && place_scans(s, false, error) &&
	       (!s->moved_stations || place_scans(s, true, error)) &&
	       load_scans(s, path, stop, error);
}

range_grid *bench_site_grid(const struct bench_site *s, const char *folder,
	const struct preset *preset, const struct bench_scan *scan, GError **error)
{
	g_autofree char *path = site_path_in(s, folder, preset);
	g_autoptr(site) from = site_open(path, error);
	g_autoptr(panorama) p =
		from ? scan_load(from, (uint32_t)(scan - s->scans) + 1, false, error) : NULL;
	return p ? range_grid_from_panorama(p) : NULL;
}

void bench_site_clear(struct bench_site *s)
{
	for (uint32_t i = 0; i < s->count; i++)
		pair_scan_free(s->scans[i].scan);
	g_free(s->scans);
	s->scans = NULL;
	s->count = 0;
}

/* ---- scenes ---- */

static const char *const scenes[] = { "court", "street", "bridge", NULL };

char *bench_scene_station(const struct bench_scene *s, uint32_t station)
{
	return g_strdup_printf(
		"%s?seed=%" G_GUINT64_FORMAT "&station=%u", s->name, s->seed, station);
}

/* A site of the same scans, and of nothing that was computed from them. */
static bool copy_site(const char *from, const char *to, GError **error)
{
	g_autofree char *folder = g_canonicalize_filename(from, NULL);
	g_autofree char *scans = g_build_filename(folder, "scans", NULL);
	g_autofree char *own_scans = g_build_filename(to, "scans", NULL);
	g_autofree char *about = g_build_filename(from, "site.json", NULL);
	g_autofree char *own_about = g_build_filename(to, "site.json", NULL);
	g_autofree char *text = NULL;
	size_t length;
	return files_make_folder(to, error) &&
	       (symlink(scans, own_scans) == 0 || files_fail(error, own_scans, "link")) &&
	       g_file_get_contents(about, &text, &length, error) &&
	       files_write(own_about, text, length, error);
}

bool bench_scene_scan(
	const struct bench_scene *s, const char *path, const struct preset *preset, GError **error)
{
	g_autoptr(GPtrArray) devices = g_ptr_array_new_with_free_func(g_free);
	for (uint32_t k = 1; k <= BENCH_STATIONS; k++) {
		g_autofree char *what = bench_scene_station(s, k);
		g_ptr_array_add(devices, g_strconcat("sim:", what, NULL));
	}
	return scan_missing(path, devices, preset, NULL, error);
}

static bool measure_scene(
	const char *scene, const struct bench_scenes *all, const char *work, GError **error)
{
	const struct preset *preset = preset_find(all->preset ? all->preset : "standard");
	g_autofree char *name = g_strdup_printf(
		"%s-%" G_GUINT64_FORMAT "-%s", scene, (guint64)all->seed, preset->name);
	g_autofree char *scans = g_build_filename(all->keep ? all->keep : work, name, NULL);
	g_autofree char *copy = g_build_filename(work, "copy", NULL);
	struct bench_scene s = { scene, all->seed, copy, work };
	if (!bench_scene_scan(&s, scans, preset, error) || !copy_site(scans, copy, error))
		return false;
	bool good = all->measure(&s, all->user_data, error);
	return files_remove_tree(copy, good ? error : NULL) && good;
}

bool bench_scenes_measure(const struct bench_scenes *all, GError **error)
{
	g_autofree char *work = g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	bool good = work && (!all->keep || files_make_folder(all->keep, error));
	for (size_t i = 0; good && scenes[i]; i++)
		good = measure_scene(scenes[i], all, work, error);
	if (work && !files_remove_tree(work, good ? error : NULL))
		good = false;
	return good;
}

bool bench_scenes_say(const struct bench_scenes *all, const char *const *heading, JsonObject *json,
	GError **error)
{
	for (int i = 0; !json && heading[i]; i++)
		puts(heading[i]);
	bool good = bench_scenes_measure(all, error);
	if (json && good)
		cli_print_json(json);
	else if (json)
		json_object_unref(json);
	return good;
}
