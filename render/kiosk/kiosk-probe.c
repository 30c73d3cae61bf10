#include "render/kiosk/kiosk-probe.h"
#include "render/kiosk/probe-widgets.h"
#include <gio/gio.h>
#include <gio/gunixsocketaddress.h>
#include <glib/gstdio.h>
#include <string.h>

static GSocketService *service;
static GHashTable *states; /* key -> value; NULL: nobody asks */
static guint64 frame_count;

static void on_after_paint(void)
{
	if (!frame_count++)
		kiosk_probe_set("first-frame", "%" G_GINT64_FORMAT, g_get_monotonic_time());
}

static void on_map(GtkWidget *window)
{
	GdkFrameClock *clock = gtk_widget_get_frame_clock(window);
	g_signal_handlers_disconnect_by_func(clock, on_after_paint, NULL);
	g_signal_connect(clock, "after-paint", G_CALLBACK(on_after_paint), NULL);
}

static void on_windows(GListModel *windows, guint position, guint removed, guint added)
{
	(void)removed;
	for (guint i = position; i < position + added; i++) {
		g_autoptr(GtkWidget) window = g_list_model_get_item(windows, i);
		g_signal_connect(window, "map", G_CALLBACK(on_map), NULL);
		if (gtk_widget_get_mapped(window))
			on_map(window);
	}
}

static void tell_states(GString *answer)
{
	g_autoptr(GList) keys = g_list_sort(g_hash_table_get_keys(states), (GCompareFunc)strcmp);
	for (GList *key = keys; key; key = key->next)
		g_string_append_printf(answer, "%s=%s\n", (char *)key->data,
			(char *)g_hash_table_lookup(states, key->data));
}

static bool tell_of_widget(GString *answer, const char *question, const char *name)
{
	GtkWidget *widget = probe_widget(name);
	if (!widget)
		return false;
	if (strcmp(question, "find") == 0) {
		probe_tell_place(widget, answer);
		g_string_append_c(answer, '\n');
		return true;
	}
	g_autofree char *text = probe_text(widget);
	g_autoptr(GString) line = g_string_new(text);
	g_string_replace(line, "\n", "\\n", 0);
	g_string_append_printf(answer, "%s\n", line->str);
	return true;
}

static void answer_question(const char *line, GString *answer)
{
	g_auto(GStrv) words = g_strsplit(line, " ", 2);
	const char *question = words[0] ? words[0] : "", *name = words[0] ? words[1] : NULL;
	if (name && (strcmp(question, "find") == 0 || strcmp(question, "text") == 0)) {
		if (!tell_of_widget(answer, question, name))
			g_string_printf(answer, "error: no widget '%s' is shown\n", name);
	} else if (strcmp(line, "list") == 0) {
		probe_tell_all(answer);
	} else if (strcmp(line, "controls") == 0) {
		probe_tell_controls(answer);
	} else if (strcmp(line, "focus") == 0) {
		g_string_append_printf(answer, "%s\n", probe_focus());
	} else if (strcmp(line, "state") == 0) {
		tell_states(answer);
	} else if (strcmp(line, "frames") == 0) {
		g_string_append_printf(answer, "%" G_GUINT64_FORMAT "\n", frame_count);
	} else {
		g_string_printf(answer, "error: '%s' is not understood\n", line);
	}
	if (!g_str_has_prefix(answer->str, "error: "))
		g_string_append(answer, "ok\n");
}

static void read_question(GDataInputStream *input, GSocketConnection *connection);

static void on_question(GObject *object, GAsyncResult *result, gpointer data)
{
	g_autoptr(GSocketConnection) connection = data;
	GDataInputStream *input = G_DATA_INPUT_STREAM(object);
	g_autofree char *line =
		g_data_input_stream_read_line_finish_utf8(input, result, NULL, NULL);
	if (!line || !states)
		return;
	g_autoptr(GString) answer = g_string_new(NULL);
	answer_question(line, answer);
	if (g_output_stream_write_all(g_io_stream_get_output_stream(G_IO_STREAM(connection)),
		    answer->str, answer->len, NULL, NULL, NULL))
		read_question(input, connection);
}

static void read_question(GDataInputStream *input, GSocketConnection *connection)
{
	g_data_input_stream_read_line_async(
		input, G_PRIORITY_DEFAULT, NULL, on_question, g_object_ref(connection));
}

static gboolean on_incoming(GSocketService *s, GSocketConnection *connection)
{
	(void)s;
	g_autoptr(GDataInputStream) input =
		g_data_input_stream_new(g_io_stream_get_input_stream(G_IO_STREAM(connection)));
	read_question(input, connection);
	return TRUE;
}

bool kiosk_probe_start(GError **error)
{
	const char *path = g_getenv("PLEINAIR_KIOSK_PROBE");
	if (!path || !*path)
		return true;
	/* What a program that was killed has left. */
	g_unlink(path);
	g_autoptr(GSocketAddress) address = g_unix_socket_address_new(path);
	g_autoptr(GSocketService) new_service = g_socket_service_new();
	if (!g_socket_listener_add_address(G_SOCKET_LISTENER(new_service), address,
		    G_SOCKET_TYPE_STREAM, G_SOCKET_PROTOCOL_DEFAULT, NULL, NULL, error))
		return g_prefix_error(error, "probe %s: ", path), false;
	g_signal_connect(new_service, "incoming", G_CALLBACK(on_incoming), NULL);
	service = g_steal_pointer(&new_service);
	states = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
	GListModel *windows = gtk_window_get_toplevels();
	g_signal_connect(windows, "items-changed", G_CALLBACK(on_windows), NULL);
	on_windows(windows, 0, 0, g_list_model_get_n_items(windows));
	return true;
}

void kiosk_probe_stop(void)
{
	if (!service)
		return;
	g_signal_handlers_disconnect_by_func(gtk_window_get_toplevels(), on_windows, NULL);
	g_socket_listener_close(G_SOCKET_LISTENER(service));
	g_clear_object(&service);
	g_clear_pointer(&states, g_hash_table_unref);
}

void kiosk_probe_set(const char *key, const char *format, ...)
{
	if (!states)
		return;
	if (!format) {
		g_hash_table_remove(states, key);
		return;
	}
	va_list arguments;
	va_start(arguments, format);
	g_hash_table_replace(states, g_strdup(key), g_strdup_vprintf(format, arguments));
	va_end(arguments);
}
