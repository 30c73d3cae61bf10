#include "acquire/sniff.h"
#include "acquire/cola.h"
#include "acquire/ld.h"
#include "acquire/rplidar-frames.h"
#include "acquire/scip-echo.h"
#include <glib.h>
#include <string.h>

/* Nodes of RPLIDAR in a row whose check bits, each half likely, are right. */
#define NODES_MIN 24

void sniff_feed(struct sniff *s, const void *bytes, size_t length)
{
	const uint8_t *from = bytes;
	s->total += length;
	if (length > SNIFF_BYTES) {
		from += length - SNIFF_BYTES;
		length = SNIFF_BYTES;
	}
	size_t keep = MIN(s->length, SNIFF_BYTES - length);
	memmove(s->bytes, s->bytes + s->length - keep, keep);
	memcpy(s->bytes + keep, from, length);
	s->length = (uint32_t)(keep + length);
}

static bool has_ld(const uint8_t *at, const uint8_t *end)
{
	for (; end - at >= LD_PACKET_BYTES; at++)
		if (ld_is_packet(at))
			return true;
	return false;
}

static bool has_nodes(const uint8_t *at, const uint8_t *end)
{
	unsigned nodes = 0;
	if (end - at < NODES_MIN * RPLIDAR_NODE_BYTES)
		return false;
	while (nodes < NODES_MIN && rplidar_is_node(at + nodes * RPLIDAR_NODE_BYTES))
		nodes++;
	return nodes == NODES_MIN;
}

/* The sum of one has but eight bits. */
static bool has_two_frames(enum rplidar_format format, const uint8_t *at, const uint8_t *end)
{
	size_t bytes = rplidar_frame_bytes(format);
	return (size_t)(end - at) >= 2 * bytes && rplidar_is_frame(format, at) &&
	       rplidar_is_frame(format, at + bytes) && rplidar_has_content(format, at);
}

static bool has_rplidar(const uint8_t *at, const uint8_t *end)
{
	for (; end - at >= RPLIDAR_DESCRIPTOR_BYTES; at++) {
		struct rplidar_descriptor d;
		if (rplidar_is_descriptor(at, &d) || has_nodes(at, end))
			return true;
		for (int f = RPLIDAR_EXPRESS; f < RPLIDAR_FORMATS; f++)
			if (has_two_frames((enum rplidar_format)f, at, end))
				return true;
	}
	return false;
}

/* STX, "s", the kind of an answer, a space and a name. */
static bool has_cola(const char *at, const char *end)
{
	static const char kinds[][3] = { "RA", "SN", "AN", "EA", "WA", "FA", "MA" };
	for (; end - at >= 8 && (at = memchr(at, COLA_STX, (size_t)(end - at - 7))); at++)
		for (size_t k = 0; at[1] == 's' && at[4] == ' ' && k < G_N_ELEMENTS(kinds); k++)
			if (memcmp(at + 2, kinds[k], 2) == 0 && g_ascii_isalnum(at[5]))
				return true;
	return false;
}

static bool has_cola_b(const char *at, const char *end)
{
	static const char mark[] = "\x02\x02\x02\x02";
	for (; end - at >= 12; at++)
		if (memcmp(at, mark, 4) == 0 && at[4] == 0 && at[8] == 's' &&
			g_ascii_isupper(at[9]) && g_ascii_isupper(at[10]))
			return true;
	return false;
}

/* An echo, and a status with a true sum behind it. */
static bool has_scip(const char *at, const char *end)
{
	struct scip_echo before = { .kind = SCIP_ECHO_NONE };
	for (const char *line_end; at < end && (line_end = memchr(at, '\n', (size_t)(end - at)));
		at = line_end + 1) {
		size_t length = (size_t)(line_end - at);
		if (before.kind >= SCIP_ECHO_COMMAND && scip_is_status(at, length))
			return true;
		before.kind = SCIP_ECHO_NONE;
		if (length < 64)
			scip_echo_parse(at, length, &before);
	}
	return false;
}

enum sniffed sniff_what(const struct sniff *s)
{
	const uint8_t *bytes = s->bytes, *end = bytes + s->length;
	const char *text = (const char *)bytes, *text_end = (const char *)end;
	if (has_ld(bytes, end))
		return SNIFFED_LD;
	if (has_cola(text, text_end))
		return SNIFFED_COLA;
	if (has_cola_b(text, text_end))
		return SNIFFED_COLA_B;
	if (has_scip(text, text_end))
		return SNIFFED_SCIP;
	if (has_rplidar(bytes, end))
		return SNIFFED_RPLIDAR;
	return s->total ? SNIFFED_GARBAGE : SNIFFED_NOTHING;
}

static const struct {
	const char *protocol, *name, *scheme;
} kinds[] = {
	[SNIFFED_SCIP] = { "scip", "a Hokuyo lidar (SCIP)", "scip:" },
	[SNIFFED_COLA] = { "cola", "a SICK lidar (CoLa-A)", "tim:" },
	[SNIFFED_COLA_B] = { "", "a SICK lidar that is set to CoLa-B", "tim:" },
	[SNIFFED_LD] = { "ld", "an LDRobot lidar (LD06, LD19, STL-27L)", "ld:" },
	[SNIFFED_RPLIDAR] = { "rplidar", "a Slamtec RPLIDAR", "rplidar:" },
};

const char *sniff_name(enum sniffed what)
{
	return kinds[what].name;
}

const char *sniff_scheme(enum sniffed what)
{
	return kinds[what].scheme;
}

enum sniffed sniff_of_protocol(const char *protocol)
{
	for (size_t i = SNIFFED_SCIP; i < G_N_ELEMENTS(kinds); i++)
		if (strcmp(kinds[i].protocol, protocol) == 0)
			return (enum sniffed)i;
	return SNIFFED_GARBAGE;
}
