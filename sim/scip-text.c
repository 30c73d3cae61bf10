#include "sim/scip-text.h"
#include <stdarg.h>
#include <string.h>

char scip_line_sum(const char *text, gsize length)
{
	unsigned sum = 0;

	for (gsize i = 0; i < length; i++)
		sum += (guint8)text[i];
	return (char)((sum & 0x3f) + 0x30);
}

void scip_append_number(GString *out, uint32_t value, unsigned characters)
{
	while (characters-- > 0)
		g_string_append_c(out, (char)((value >> 6 * characters & 0x3f) + 0x30));
}

void scip_append_line(GString *out, const char *text, gsize length)
{
	g_string_append_len(out, text, (gssize)length);
	g_string_append_c(out, scip_line_sum(text, length));
	g_string_append_c(out, '\n');
}

void scip_append_property(GString *out, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	g_autofree char *text = g_strdup_vprintf(format, args);

	va_end(args);
	g_string_append_printf(out, "%s;%c\n", text, scip_line_sum(text, strlen(text)));
}

void scip_append_block(GString *out, const char *data, gsize length)
{
	for (gsize at = 0; at < length; at += 64)
		scip_append_line(out, data + at, MIN(64, length - at));
}

const char *scip_parse(const char *line, struct scip_command *ret_command)
{
	const char *semicolon = strchr(line, ';');
	gsize length = semicolon ? (gsize)(semicolon - line) : strlen(line);

	*ret_command = (struct scip_command){ line, line + MIN(length, 2), length - MIN(length, 2),
		semicolon ? semicolon : "" };
	if (length < 2)
		return "0E";
	if (semicolon && strlen(semicolon + 1) > 16)
		return "0G";
	for (const char *c = semicolon ? semicolon + 1 : ""; *c; c++)
		if (!g_ascii_isalnum(*c) && !strchr(" ._+@", *c))
			return "0H";
	return NULL;
}

int scip_decimal(const struct scip_command *command, gsize at, gsize length)
{
	int number = 0;

	if (at + length > command->parameter_length)
		return -1;
	for (gsize i = at; i < at + length; i++) {
		if (!g_ascii_isdigit(command->parameters[i]))
			return -1;
		number = 10 * number + (command->parameters[i] - '0');
	}
	return number;
}
