#include "sim/cola-telegram.h"
#include "sim/cola-text.h"
#include <math.h>

int cola_step_angle(const struct lidar_body *body)
{
	return (COLA_STOP - COLA_START) / (int)(body->mirror.beams - 1);
}

static float scale(const struct cola_telegram *t)
{
	return t->body->options->limit_m > 131 ? 4 : t->body->options->limit_m > 65.5 ? 2 : 1;
}

static uint32_t distance(const struct cola_telegram *t, const struct echo *echo)
{
	uint32_t units = (uint32_t)lrint(echo->range_m * 1000 / (double)scale(t));

	switch (echo->outcome) {
	case ECHO_NONE: return 0;
	case ECHO_WEAK: return 1;
	case ECHO_MIRRORED: return 2;
	default: return units < 16 ? 0 : MIN(units, 65535u);
	}
}

static uint32_t remission(const struct cola_telegram *t, const struct echo *echo)
{
	double tens = echo->range_m / 10, received = (double)echo->strength / (1 + tens * tens);

	if (echo->outcome != ECHO_GOOD)
		return 0;
	if (t->output->wide)
		return (uint32_t)CLAMP(lrint(65535 * received), 1, 65535);
	return (uint32_t)CLAMP(lrint(255 * sqrt(fmax(received, 0))), 1, 255);
}

static void append_channel(GString *out, const struct cola_telegram *t, const char *name,
	float factor, const struct beam_fan *fan,
	uint32_t (*value)(const struct cola_telegram *t, const struct echo *echo))
{
	int step = cola_step_angle(t->body);
	double exact_step = 2700000.0 / (fan->beams - 1);
	uint32_t first = (uint32_t)ceil((double)(t->range_start - COLA_START) / exact_step - 0.01);
	uint32_t last = (uint32_t)floor((double)(t->range_stop - COLA_START) / exact_step + 0.01);

	last = CLAMP(last, first, fan->beams - 1);
	cola_append_word(out, name);
	cola_append_real(out, factor);
	cola_append_real(out, 0);
	cola_append_number(out, (uint32_t)(COLA_START + (int)lround(first * exact_step)));
	cola_append_number(out, (uint32_t)step);
	cola_append_number(out, last - first + 1);
	for (uint32_t i = first; i <= last; i++)
		cola_append_number(out, value(t, &fan->echoes[i]));
}

static void append_header(GString *out, const struct cola_telegram *t, int64_t end_ns)
{
	const struct device_clock *clock = &t->body->clock;
	double measurements_hz = t->body->options->rate_hz * t->body->mirror.beams_per_turn;

	g_string_append(out, " 1 1");
	cola_append_number(out, (uint32_t)(t->body->options->seed % 100000000));
	g_string_append(out, t->broken ? " 0 1" : " 0 0");
	cola_append_number(out, t->telegram_counter);
	cola_append_number(out, t->scan_counter);
	cola_append_number(out, device_clock_ticks(clock, end_ns));
	cola_append_number(out, device_clock_ticks(clock, t->leaves_ns));
	g_string_append(out, " 0 0 1 0 0");
	cola_append_number(out, (uint32_t)lround(t->body->options->rate_hz * 100));
	cola_append_number(out, (uint32_t)lround(measurements_hz / 100));
	g_string_append(out, " 0");
}

/* Position, name, comment, time and event. The clock of the calendar was never set. */
static void append_tail(GString *out, const struct cola_telegram *t)
{
	g_string_append(out, " 0");
	g_string_append(out, t->output->name ? " 1" : " 0");
	if (t->output->name)
		cola_append_string(out, "not defined");
	g_string_append(out, t->output->comment ? " 1" : " 0");
	if (t->output->comment)
		cola_append_string(out, "no comment");
	g_string_append(out, t->output->time ? " 1 7B2 1 1 0 0 0 0 0" : " 0 0");
}

void cola_append_telegram(
	GString *out, const char *word, const struct cola_telegram *t, const struct beam_fan *fan)
{
	const struct cola_output *output = t->output;

	g_string_append_printf(out, "%s LMDscandata", word);
	append_header(out, t, mirror_last_ns(&t->body->mirror, fan->revolution));
	cola_append_number(out, output->remission && output->wide ? 2 : 1);
	append_channel(out, t, "DIST1", scale(t), fan, distance);
	if (output->remission && !output->wide)
		cola_append_number(out, 1);
	if (output->remission)
		append_channel(out, t, "RSSI1", 1, fan, remission);
	if (!output->remission || output->wide)
		cola_append_number(out, 0);
	append_tail(out, t);
}
