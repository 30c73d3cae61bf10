#include "acquire/scip-echo.h"
#include <glib.h>
#include <string.h>

/* Single scans answer 00 with the data, streams acknowledge with 00 and send their data with 99. */
static const struct scip_scan_command scan_commands[] = {
	{ "GD", "00", 10, { .distance_chars = 3 } },
	{ "GS", "00", 10, { .distance_chars = 2 } },
	{ "GE", "00", 10, { .distance_chars = 3, .intensity = true } },
	{ "HD", "00", 10, { .distance_chars = 3, .echoes = true } },
	{ "HE", "00", 10, { .distance_chars = 3, .intensity = true, .echoes = true } },
	{ "MD", "99", 13, { .distance_chars = 3 } },
	{ "MS", "99", 13, { .distance_chars = 2 } },
	{ "ME", "99", 13, { .distance_chars = 3, .intensity = true } },
	{ "ND", "99", 13, { .distance_chars = 3, .echoes = true } },
	{ "NE", "99", 13, { .distance_chars = 3, .intensity = true, .echoes = true } },
};

static const struct {
	char name[8];
	uint8_t digits;
} commands[] = {
	{ "VV", 0 },
	{ "PP", 0 },
	{ "II", 0 },
	{ "BM", 0 },
	{ "QT", 0 },
	{ "RS", 0 },
	{ "RT", 0 },
	{ "RB", 0 },
	{ "TM", 1 },
	{ "SS", 6 },
	{ "CR", 2 },
	{ "SCIP2.0", 0 },
};

static bool all_digits(const char *text, size_t length)
{
	for (size_t i = 0; i < length; i++)
		if (!g_ascii_isdigit(text[i]))
			return false;
	return true;
}

static uint32_t decimal(const char *text, size_t length)
{
	uint32_t value = 0;
	for (size_t i = 0; i < length; i++)
		value = value * 10 + (uint32_t)(text[i] - '0');
	return value;
}

/* The command stands at the end of the line. */
static bool parse_scan(const char *line, size_t length, struct scip_echo *echo)
{
	for (size_t i = 0; i < G_N_ELEMENTS(scan_commands); i++) {
		const struct scip_scan_command *scan = &scan_commands[i];
		size_t command_length = 2 + scan->parameter_digits;
		if (length < command_length)
			continue;
		const char *command = line + length - command_length;
		if (memcmp(command, scan->name, 2) != 0 ||
			!all_digits(command + 2, scan->parameter_digits))
			continue;
		echo->scan = scan;
		echo->start = decimal(command + 2, 4);
		echo->end = decimal(command + 6, 4);
		echo->cluster = MAX(decimal(command + 10, 2), 1);
		echo->junk = length - command_length;
		return true;
	}
	return false;
}

static bool is_command(const char *line, size_t length)
{
	for (size_t i = 0; i < G_N_ELEMENTS(commands); i++) {
		size_t name_length = strlen(commands[i].name);
		if (length == name_length + commands[i].digits &&
			memcmp(line, commands[i].name, name_length) == 0 &&
			all_digits(line + name_length, commands[i].digits))
			return true;
	}
	return false;
}

static bool is_other(const char *line, size_t length)
{
	if (length < 2 || !(g_ascii_isupper(line[0]) || line[0] == '%'))
		return false;
	for (size_t i = 0; i < length; i++)
		if (!g_ascii_isprint(line[i]))
			return false;
	return true;
}

void scip_echo_parse(const char *line, size_t length, struct scip_echo *ret)
{
	/* The string after the last ';' is the host's own, where that ';' does not belong to
	 * garbage before the command. */
	const char *string = parse_scan(line, length, ret) ? NULL : memrchr(line, ';', length);
	size_t head = string ? (size_t)(string - line) : length;
	ret->bytes = length + 1;
	ret->junk = 0;
	ret->kind = SCIP_ECHO_NONE;
	if (parse_scan(line, head, ret))
		ret->kind = SCIP_ECHO_SCAN;
	else if (head >= sizeof ret->command)
		return;
	else if (is_command(line, head))
		ret->kind = SCIP_ECHO_COMMAND;
	else if (is_other(line, head))
		ret->kind = SCIP_ECHO_OTHER;
	else
		return;
	memcpy(ret->command, line + ret->junk, head - ret->junk);
	ret->command[head - ret->junk] = '\0';
}

bool scip_is_status(const char *line, size_t length)
{
	return length == 3 && g_ascii_isalnum(line[0]) && g_ascii_isalnum(line[1]) &&
	       line[2] == scip_sum(line, 2);
}
