#ifndef TESTS_COLLECT_H
#define TESTS_COLLECT_H
/* A sink that remembers what a decoder gave out: the last scanline and reply, and a hash over all
 * of them, which does not depend on how the bytes were cut into feeds. For tests and fuzz targets.
 */
#include "acquire/decoder.h"
#include <string.h>

struct collected {
	unsigned scanlines, replies;
	uint64_t hash;
	struct scanline line; /* the last; range_mm and intensity point below */
	GArray *range_mm, *intensity, *angle_rad;
	GString *command, *status, *text; /* of the last reply */
};

static inline void collect_hash(struct collected *c, const void *bytes, size_t length)
{
	const uint8_t *at = bytes;
	for (size_t i = 0; i < length; i++)
		c->hash = (c->hash ^ at[i]) * UINT64_C(0x100000001b3);
}

#define COLLECT_HASH(c, value) collect_hash(c, &(value), sizeof(value))

static inline void collect_scanline(const struct scanline *line, gpointer user_data)
{
	struct collected *c = user_data;
	c->scanlines++;
	c->line = *line;
	g_array_set_size(c->range_mm, 0);
	g_array_append_vals(c->range_mm, line->range_mm, line->beams);
	c->line.range_mm = (const uint32_t *)(void *)c->range_mm->data;
	collect_hash(c, line->range_mm, line->beams * sizeof(uint32_t));
	if (line->intensity) {
		g_array_set_size(c->intensity, 0);
		g_array_append_vals(c->intensity, line->intensity, line->beams);
		c->line.intensity = (const uint16_t *)(void *)c->intensity->data;
		collect_hash(c, line->intensity, line->beams * sizeof(uint16_t));
	}
	COLLECT_HASH(c, line->ticks);
	COLLECT_HASH(c, line->sent_ticks);
	COLLECT_HASH(c, line->counter);
	COLLECT_HASH(c, line->device_error);
	COLLECT_HASH(c, line->first_angle_rad);
	COLLECT_HASH(c, line->angle_step_rad);
	COLLECT_HASH(c, line->scan_rate_hz);
	COLLECT_HASH(c, line->beams);
	COLLECT_HASH(c, line->range_min_mm);
	COLLECT_HASH(c, line->beam_s);
	COLLECT_HASH(c, line->epoch);
	if (line->angle_rad) {
		g_array_set_size(c->angle_rad, 0);
		g_array_append_vals(c->angle_rad, line->angle_rad, line->beams);
		c->line.angle_rad = (const float *)(void *)c->angle_rad->data;
		collect_hash(c, line->angle_rad, line->beams * sizeof(float));
	}
}

static inline void collect_reply(const struct lidar_reply *reply, gpointer user_data)
{
	struct collected *c = user_data;
	c->replies++;
	g_string_assign(c->command, reply->command);
	g_string_assign(c->status, reply->status);
	g_string_assign(c->text, reply->text);
	collect_hash(c, reply->command, strlen(reply->command) + 1);
	collect_hash(c, reply->status, strlen(reply->status) + 1);
	collect_hash(c, reply->text, strlen(reply->text) + 1);
}

static inline struct collected *collected_new(void)
{
	struct collected *c = g_new0(struct collected, 1);
	c->hash = UINT64_C(0xcbf29ce484222325);
	c->range_mm = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	c->intensity = g_array_new(FALSE, FALSE, sizeof(uint16_t));
	c->angle_rad = g_array_new(FALSE, FALSE, sizeof(float));
	c->command = g_string_new(NULL);
	c->status = g_string_new(NULL);
	c->text = g_string_new(NULL);
	return c;
}

static inline void collected_free(struct collected *c)
{
	g_array_free(c->range_mm, TRUE);
	g_array_free(c->intensity, TRUE);
	g_array_free(c->angle_rad, TRUE);
	g_string_free(c->command, TRUE);
	g_string_free(c->status, TRUE);
	g_string_free(c->text, TRUE);
	g_free(c);
}

static inline decoder *collected_decoder(struct collected *c, const char *protocol)
{
	struct decoder_sink sink = { collect_scanline, collect_reply, c };
	return decoder_new(protocol, &sink);
}

#endif
