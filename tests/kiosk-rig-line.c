/* Questions and answers, to the program's probe and to weston's fingers. */
#include "tests/kiosk-rig-private.h"
#include <gio/gunixsocketaddress.h>
#include <string.h>

bool rig_line_open(struct rig_line *line, const char *path)
{
	g_autoptr(GSocketAddress) address = g_unix_socket_address_new(path);
	g_autoptr(GSocketClient) client = g_socket_client_new();
	/* No loop may stand still for that long. */
	g_socket_client_set_timeout(client, 60);
	line->connection =
		g_socket_client_connect(client, G_SOCKET_CONNECTABLE(address), NULL, NULL);
	if (!line->connection)
		return false;
	line->input = g_data_input_stream_new(
		g_io_stream_get_input_stream(G_IO_STREAM(line->connection)));
	return true;
}

void rig_line_close(struct rig_line *line)
{
	g_clear_object(&line->input);
	g_clear_object(&line->connection);
}

static bool read_answer(struct rig_line *line, GString *text, GError **error)
{
	for (;;) {
		g_autofree char *said =
			g_data_input_stream_read_line(line->input, NULL, NULL, error);
		if (!said && error && !*error)
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_CLOSED, "the other end has gone");
		if (!said || strcmp(said, "ok") == 0)
			return said;
		if (g_str_has_prefix(said, "error: ")) {
			g_set_error_literal(error, G_IO_ERROR, G_IO_ERROR_FAILED, said + 7);
			return false;
		}
		if (text)
			g_string_append_printf(text, "%s\n", said);
	}
}

bool rig_line_ask(
	struct rig_line *line, const char *questions, int count, GString *text, GError **error)
{
	GOutputStream *output = g_io_stream_get_output_stream(G_IO_STREAM(line->connection));
	if (!g_output_stream_write_all(output, questions, strlen(questions), NULL, NULL, error))
		return false;
	for (int i = 0; i < count; i++)
		if (!read_answer(line, text, error))
			return false;
	return true;
}
