#include "acquire/cola-scan.h"
#include <glib.h>
#include <math.h>
#include <string.h>

struct channel {
	char name[6];
	float scale, offset;
	int32_t start_e4;
	uint32_t step_e4, count;
};

struct channels {
	struct channel range, intensity; /* count 0 while there is none */
};

double cola_true_step_deg(uint32_t step_e4)
{
	double parts = round(step_e4 * 24.0 / 1e4);
	double step_deg = parts / 24;
	return parts >= 1 && fabs(step_deg * 1e4 - step_e4) < 1 ? step_deg : step_e4 / 1e4;
}

double cola_angle_rad(int32_t angle_e4)
{
	return (angle_e4 / 1e4 - 90) * M_PI / 180;
}

static void reserve(struct cola_scan *scan, uint32_t count)
{
	if (count <= scan->size)
		return;
	scan->raw = g_renew(uint16_t, scan->raw, count);
	scan->intensity = g_renew(uint16_t, scan->intensity, count);
	scan->other = g_renew(uint16_t, scan->other, count);
	scan->range_mm = g_renew(uint32_t, scan->range_mm, count);
	scan->size = count;
}

/* Names have a letter that no number has (DIST1, RSSI1, ANGL1, VANGL). */
static bool is_channel_name(const char *word, size_t length)
{
	return length >= 4 && length <= 5 && (g_ascii_isupper(word[0]) && word[3] > 'F');
}

static bool parse_channel(
	struct cola_scan *scan, struct cola_cursor *c, unsigned digits_max, struct channels *all)
{
	struct channel channel = { .name = "" };
	const char *name;
	size_t length;
	if (!cola_word(c, 5, &name, &length) || !is_channel_name(name, length))
		return false;
	memcpy(channel.name, name, length);
	channel.scale = cola_real(c);
	channel.offset = cola_real(c);
	channel.start_e4 = cola_signed(c);
	channel.step_e4 = cola_hex(c, 8);
	channel.count = cola_hex(c, 8);
	/* A value takes two characters, so a count beyond the telegram costs no memory. */
	if (c->bad || channel.count > COLA_VALUES_MAX ||
		channel.count / 2 > (size_t)(c->end - c->at))
		return false;
	reserve(scan, channel.count);
	bool is_range = strcmp(channel.name, "DIST1") == 0;
	bool is_intensity = strcmp(channel.name, "RSSI1") == 0;
	uint16_t *values = scan->other;
	if (is_range) {
		values = scan->raw;
		all->range = channel;
	} else if (is_intensity) {
		values = scan->intensity;
		all->intensity = channel;
	}
	cola_values(c, channel.count, digits_max, values);
	return !c->bad;
}

/* Scan frequency, measurement frequency, encoders, number of 16-bit channels. The measurement
 * frequency is not to be trusted: a TiM561 sends a ninth of it. */
static bool parse_rates(
	struct cola_cursor *c, uint32_t encoders_max, uint32_t *rate_e2, uint32_t *channels)
{
	*rate_e2 = cola_hex(c, 8);
	cola_hex(c, 8);
	uint32_t encoders = cola_hex(c, 4);
	if (encoders > encoders_max)
		return false;
	cola_skip(c, 2 * encoders);
	*channels = cola_hex(c, 4);
	return !c->bad && (*channels == 0 || (c->end - c->at >= 4 && is_channel_name(c->at, 4)));
}

static bool parse_flag(struct cola_cursor *c)
{
	uint32_t flag = cola_hex(c, 4);
	c->bad = c->bad || flag > 1;
	return !c->bad && flag;
}

/* Position, name, comment, time, event: each a flag and, where it is 1, its tokens. */
static bool parse_tail(struct cola_cursor *c)
{
	const char *string;
	size_t length;
	if (parse_flag(c))
		cola_skip(c, 7); /* x, y, z, three rotations, kind of rotation */
	if (parse_flag(c))
		cola_string(c, &string, &length);
	if (parse_flag(c))
		cola_string(c, &string, &length);
	if (parse_flag(c))
		cola_skip(c, 7); /* year to microsecond */
	if (parse_flag(c)) {
		cola_word(c, 16, &string, &length); /* its kind */
		cola_skip(c, 3);                    /* encoder, time, angle */
	}
	return cola_at_end(c);
}

/* Codes stay as they are. A scaled range that would look like a code is none. */
static void scale_ranges(const struct cola_scan *scan, const struct channel *channel)
{
	const uint16_t *raw = scan->raw;
	uint32_t *range_mm = scan->range_mm, count = channel->count;
	if (channel->scale == 1 && channel->offset == 0) {
		for (uint32_t i = 0; i < count; i++)
			range_mm[i] = raw[i];
		return;
	}
	for (uint32_t i = 0; i < count; i++) {
		float scaled = raw[i] * channel->scale + channel->offset + 0.5f;
		uint32_t range = scaled >= COLA_RANGE_MIN_RAW ? (uint32_t)scaled : 0;
		range_mm[i] = raw[i] < COLA_RANGE_MIN_RAW ? raw[i] : range;
	}
}

static bool has_sane_scale(const struct channel *channel)
{
	return channel->scale > 0 && channel->scale <= 1000 && fabsf(channel->offset) <= 1e6f;
}

/* The first TiM310 send one token more in front of the scan frequency. A number that a fault cut in
 * two gives one more as well, hence the doubts: they have no encoders, and send at once. */
static bool parse_old_rates(
	struct cola_cursor *c, const struct scanline *line, uint32_t *rate_e2, uint32_t *channels)
{
	uint32_t age_us = (uint32_t)(line->sent_ticks - line->ticks);
	cola_skip(c, 1);
	return parse_rates(c, 0, rate_e2, channels) && age_us < 1000000;
}

/* Everything up to the channels. */
static bool parse_head(struct cola_cursor *c, struct scanline *ret, uint32_t *channels)
{
	uint32_t rate_e2;
	cola_skip(c, 3); /* version, device number, serial number */
	uint32_t status_high = cola_hex(c, 2), status_low = cola_hex(c, 2);
	cola_hex(c, 4); /* telegram counter */
	ret->counter = cola_hex(c, 4);
	ret->ticks = cola_hex(c, 8);
	ret->sent_ticks = cola_hex(c, 8);
	for (int i = 0; i < 4; i++)
		cola_hex(c, 2); /* inputs and outputs */
	cola_hex(c, 8);         /* reserved */
	/* Status 2 is a warning of dirt on the window: the ranges still hold. */
	ret->device_error = status_high != 0 || (status_low != 0 && status_low != 2);
	struct cola_cursor rates = *c;
	if (!parse_rates(c, COLA_VALUES_MAX, &rate_e2, channels)) {
		*c = rates;
		if (!parse_old_rates(c, ret, &rate_e2, channels))
			return false;
	}
	ret->scan_rate_hz = rate_e2 / 100.0;
	return true;
}

static bool parse_channels(
	struct cola_scan *scan, struct cola_cursor *c, uint32_t wide, struct channels *all)
{
	for (uint32_t i = 0; i < wide; i++)
		if (!parse_channel(scan, c, 4, all))
			return false;
	uint32_t narrow = cola_hex(c, 4);
	for (uint32_t i = 0; i < narrow; i++)
		if (!parse_channel(scan, c, 2, all))
			return false;
	return !c->bad;
}

bool cola_scan_parse(struct cola_scan *scan, struct cola_cursor *c, struct scanline *ret)
{
	struct channels all = { 0 };
	uint32_t wide;
	*ret = (struct scanline){ 0 };
	if (!parse_head(c, ret, &wide) || !parse_channels(scan, c, wide, &all) || !parse_tail(c))
		return false;
	if (all.range.count == 0 || !has_sane_scale(&all.range))
		return false;
	scale_ranges(scan, &all.range);
	ret->first_angle_rad = cola_angle_rad(all.range.start_e4);
	ret->angle_step_rad = cola_true_step_deg(all.range.step_e4) * M_PI / 180;
	ret->beams = all.range.count;
	ret->range_mm = scan->range_mm;
	ret->intensity = all.intensity.count == all.range.count ? scan->intensity : NULL;
	ret->range_min_mm = COLA_RANGE_MIN_RAW;
	return true;
}

void cola_scan_clear(struct cola_scan *scan)
{
	g_free(scan->raw);
	g_free(scan->intensity);
	g_free(scan->other);
	g_free(scan->range_mm);
}
