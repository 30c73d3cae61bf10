#include "tests/simulated.h"
#include "sim/options.h"
#include "sim/truth.h"
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

struct simulated {
	GThread *thread;
	char *description;
	struct sim_head_options options;
	int fd;
	head *head;
};

static GHashTable *worlds; /* "scene seed" -> world; used by the test's main thread only */

static const world *shared_world(const char *description)
{
	g_autoptr(sim_options) o = options_parse(description, NULL);
	if (!o)
		return NULL;
	if (!worlds)
		worlds = g_hash_table_new_full(
			g_str_hash, g_str_equal, g_free, (GDestroyNotify)world_free);
	struct world_variant variant = options_variant(o);
	g_autofree char *key =
		g_strdup_printf("%s %" G_GUINT64_FORMAT " %" G_GUINT64_FORMAT " %d %d", o->scene,
			(guint64)o->seed, (guint64)o->moved, o->symmetric, o->repeated);
	world *w = g_hash_table_lookup(worlds, key);
	if (!w && (w = world_new(o->scene, o->seed, &variant, NULL)))
		g_hash_table_insert(worlds, g_steal_pointer(&key), w);
	return w;
}

static gpointer serve(gpointer data)
{
	simulated *s = data;
	g_autoptr(GError) error = NULL;
	if (!sim_head_serve(s->fd, &s->options, &error))
		g_test_message("simulator: %s", error ? error->message : "?");
	return NULL;
}

simulated *simulated_start(const char *description, sim_truth_func told, gpointer truth_data)
{
	int ends[2];
	g_autoptr(GError) error = NULL;
	simulated *s = g_new0(simulated, 1);
	s->description = g_strdup(description);
	g_assert_cmpint(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), ==, 0);
	s->fd = ends[1];
	s->options = (struct sim_head_options){ .description = s->description,
		.world = shared_world(description),
		.truth = told,
		.truth_data = truth_data };
	s->thread = g_thread_new("simulator", serve, s);
	s->head = head_open_link(ends[0], &error);
	g_assert_no_error(error);
	return s;
}

head *simulated_take_head(simulated *s)
{
	return g_steal_pointer(&s->head);
}

void simulated_stop(simulated *s)
{
	head_close(s->head);
	g_thread_join(s->thread);
	g_free(s->description);
	g_free(s);
}

static GPtrArray *folders;

static void remove_folders(void)
{
	for (guint i = 0; i < folders->len; i++) {
		g_autofree char *command =
			g_strdup_printf("rm -rf '%s'", (char *)folders->pdata[i]);
		if (system(command))
			g_printerr("could not remove %s\n", (char *)folders->pdata[i]);
	}
	g_ptr_array_unref(folders);
	g_clear_pointer(&worlds, g_hash_table_unref);
}

char *simulated_folder(void)
{
	char *path = g_dir_make_tmp("pleinair-test-XXXXXX", NULL);
	g_assert_nonnull(path);
	if (!folders) {
		folders = g_ptr_array_new_with_free_func(g_free);
		atexit(remove_folders);
	}
	g_ptr_array_add(folders, g_strdup(path));
	return path;
}

bool simulated_scan(const char *site_path, const char *description,
	const struct scan_options *options, sim_truth_func told, gpointer truth_data,
	struct scan_result *ret_result, uint32_t *ret_partial, GError **ret_error)
{
	g_autofree char *uri = g_strconcat("sim:", description, NULL);
	struct scan_options o = *options;
	g_autoptr(site) at = site_open_for_writing(site_path, ret_error);
	if (!at)
		return false;
	simulated *s = simulated_start(description, told, truth_data);
	o.device = uri;
	o.head = simulated_take_head(s);
	bool good = scan_record(at, &o, ret_result, ret_partial, ret_error);
	simulated_stop(s);
	return good;
}

uint32_t simulated_draft(const char *site_path, const char *description)
{
	struct scan_options options = { .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	simulated_scan(site_path, description, &options, NULL, NULL, &result, &partial, &error);
	g_assert_no_error(error);
	return result.number;
}

struct pose simulated_pose(const char *description)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(truth) t = truth_new(description, &error);
	g_assert_no_error(error);
	const struct world_station *at = truth_station(t);
	struct pose ret;
	memcpy(ret.translation_m, at->position_m, sizeof ret.translation_m);
	memcpy(ret.rotation, at->rotation, sizeof ret.rotation);
	pose_orthonormalise(&ret);
	return ret;
}
