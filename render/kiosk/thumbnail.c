#include "render/kiosk/thumbnail.h"
#include "render/drawn-site.h"
#include "render/painter.h"
#include "render/scene-pager.h"
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <stdbool.h>

#define STYLE "figure-1-strokes-hatching"
/* Drawn so much larger, then reduced. */
#define SUPERSAMPLE 2

/* One is drawn at a time: all of them want all of the memory and processors. */
static GMutex drawing_one;

static char *model_stamp(const char *site_path)
{
	g_autofree char *folder = g_build_filename(site_path, "model", NULL);
	GStatBuf info;
	if (g_stat(folder, &info))
		return NULL;
	return g_strdup_printf(
		"%s %lld.%09ld", site_path, (long long)info.st_mtim.tv_sec, info.st_mtim.tv_nsec);
}

static char *cache_path(const char *stamp)
{
	g_autofree char *name = g_compute_checksum_for_string(G_CHECKSUM_SHA256, stamp, -1);
	g_autofree char *file = g_strconcat(name, ".png", NULL);
	g_autofree char *folder =
		g_build_filename(g_get_user_cache_dir(), "pleinair", "thumbnails", NULL);
	g_mkdir_with_parents(folder, 0700);
	return g_build_filename(folder, file, NULL);
}

static view *find_view(const drawn_site *d)
{
	view *v = view_built_in(&d->sources, "walk");
	return v ? v : view_built_in(&d->sources, "overview");
}

static bool draw(const char *site_path, const char *path, GError **error)
{
	g_autoptr(drawn_site) d =
		drawn_site_new(site_path, (double)THUMBNAIL_WIDTH / THUMBNAIL_HEIGHT, error);
	if (!d || !drawn_site_load(d, error))
		return false;
	g_autoptr(drawing) drawn = drawn_site_style(d, STYLE, error);
	g_autoptr(view) v = find_view(d);
	if (!drawn || !v)
		return false;
	struct camera c =
		view_camera(v, THUMBNAIL_WIDTH * SUPERSAMPLE, THUMBNAIL_HEIGHT * SUPERSAMPLE);
	g_autoptr(frame) f = frame_new(d->scene, drawn, &c, error);
	if (!f || !scene_pager_settle_for(d->scene, &c, f->ink_px, error))
		return false;
	struct picture_buffer large = picture_buffer_new(c.width, c.height);
	draw_frame(NULL, f, &large, NULL);
	struct picture_buffer reduced = picture_buffer_reduced(&large, SUPERSAMPLE);
	bool good = picture_buffer_save(&reduced, path, error);
	picture_buffer_clear(&large);
	picture_buffer_clear(&reduced);
	return good;
}

static void work(GTask *task, gpointer source, gpointer data, GCancellable *cancel)
{
	const char *site_path = data;
	g_autoptr(GError) error = NULL;
	g_autofree char *stamp = model_stamp(site_path);
	g_autofree char *path = stamp ? cache_path(stamp) : NULL;
	(void)source;
	(void)cancel;
	g_mutex_lock(&drawing_one);
	bool good =
		path && (g_file_test(path, G_FILE_TEST_EXISTS) || draw(site_path, path, &error));
	g_mutex_unlock(&drawing_one);
	/* A site that cannot be drawn has no picture; why is said where it is opened. */
	g_task_return_pointer(task, good ? g_steal_pointer(&path) : NULL, g_free);
}

static void done(GObject *source, GAsyncResult *result, gpointer user_data)
{
	g_autofree char *path = g_task_propagate_pointer(G_TASK(result), NULL);
	g_autoptr(GtkPicture) picture = user_data;
	(void)source;
	if (path)
		gtk_picture_set_filename(picture, path);
}

void thumbnail_show(const char *site_path, GtkPicture *picture)
{
	GTask *task = g_task_new(NULL, NULL, done, g_object_ref(picture));
	g_task_set_task_data(task, g_strdup(site_path), g_free);
	g_task_run_in_thread(task, work);
	g_object_unref(task);
}
