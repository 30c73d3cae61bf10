#include "render/kiosk/picture-load.h"
#include <gio/gio.h>

struct wanted {
	char *path;
	int width, height;
};

static void wanted_free(gpointer data)
{
	struct wanted *w = data;
	g_free(w->path);
	g_free(w);
}

static void read_file(GTask *task, gpointer source, gpointer data, GCancellable *cancellable)
{
	const struct wanted *w = data;
	GError *error = NULL;
	int width, height;
	(void)source;
	(void)cancellable;
	/* Small ones stay as they are. */
	bool large = !gdk_pixbuf_get_file_info(w->path, &width, &height) || width > w->width ||
		     height > w->height;
	GdkPixbuf *p = large ? gdk_pixbuf_new_from_file_at_scale(
				       w->path, w->width, w->height, TRUE, &error)
			     : gdk_pixbuf_new_from_file(w->path, &error);
	if (p)
		g_task_return_pointer(task, p, g_object_unref);
	else
		g_task_return_error(task, error);
}

static void was_read(GObject *source, GAsyncResult *result, gpointer user_data)
{
	const char *path = ((struct wanted *)g_task_get_task_data(G_TASK(result)))->path;
	g_autoptr(GError) error = NULL;
	g_autoptr(GdkPixbuf) p = g_task_propagate_pointer(G_TASK(result), &error);
	(void)user_data;
	if (g_strcmp0(path, g_object_get_data(source, "wanted")))
		return;
	g_autoptr(GdkTexture) texture = p ? gdk_texture_new_for_pixbuf(p) : NULL;
	gtk_picture_set_paintable(GTK_PICTURE(source), texture ? GDK_PAINTABLE(texture) : NULL);
}

void picture_load(GtkWidget *picture, const char *path, int width, int height)
{
	struct wanted *w = g_new0(struct wanted, 1);
	*w = (struct wanted){ g_strdup(path), width, height };
	g_object_set_data_full(G_OBJECT(picture), "wanted", g_strdup(path), g_free);
	g_autoptr(GTask) task = g_task_new(picture, NULL, was_read, NULL);
	g_task_set_task_data(task, w, wanted_free);
	g_task_run_in_thread(task, read_file);
}
