#include "sim/lidar-ld.h"
#include <math.h>

#define SAMPLES   12
#define LEAVES_NS INT64_C(100000) /* after the last measurement */
#define STAMPS    30000

struct ld {
	struct lidar_body *body;
	GByteArray *out;
};

static void put16(GByteArray *out, uint32_t value)
{
	guint8 bytes[2] = { (guint8)value, (guint8)(value >> 8) };

	g_byte_array_append(out, bytes, 2);
}

/* The division, a bit at a time. */
static guint8 checksum(const guint8 *bytes, gsize length)
{
	unsigned rest = 0;

	for (gsize i = 0; i < length * 8; i++) {
		unsigned bit = bytes[i / 8] >> (7 - i % 8) & 1;

		rest = rest << 1 ^ ((rest >> 7 ^ bit) & 1 ? 0x4d : 0);
		rest &= 0xff;
	}
	return (guint8)rest;
}

static uint32_t hundredths(double turns)
{
	return (uint32_t)lround((turns - floor(turns)) * 36000) % 36000;
}

static uint32_t intensity(const struct echo *echo)
{
	return echo->outcome == ECHO_GOOD
		       ? (uint32_t)CLAMP(lrint(220 * sqrt(fmax((double)echo->strength, 0))), 1, 255)
		       : 0;
}

static void append_packet(struct ld *l, const struct beam_fan *fan, uint32_t first)
{
	const double *turns = l->body->encoder_turns + first;
	const struct mirror *mirror = &l->body->mirror;
	guint start = l->out->len;
	int64_t last_ns = mirror_first_ns(mirror, fan->revolution) +
			  llrint(mirror_beam_period_ns(mirror) * (first + SAMPLES - 1));
	double per_s = (turns[SAMPLES - 1] - turns[0]) * 1e9 /
		       (mirror_beam_period_ns(mirror) * (SAMPLES - 1));

	g_byte_array_append(l->out, (const guint8 *)"\x54\x2c", 2);
	put16(l->out, (uint32_t)lround(360 * per_s));
	put16(l->out, hundredths(turns[0]));
	for (uint32_t i = 0; i < SAMPLES; i++) {
		const struct echo *echo = &fan->echoes[first + i];
		guint8 bright = (guint8)intensity(echo);

		put16(l->out, echo->outcome == ECHO_GOOD
				      ? (uint32_t)MIN(lrint(echo->range_m * 1000), 65535)
				      : 0);
		g_byte_array_append(l->out, &bright, 1);
	}
	put16(l->out, hundredths(turns[SAMPLES - 1]));
	put16(l->out, device_clock_ticks(&l->body->clock, last_ns) % STAMPS);
	guint8 sum = checksum(l->out->data + start, l->out->len - start);

	g_byte_array_append(l->out, &sum, 1);
}

static void send(gpointer self, const struct beam_fan *fan, int64_t now_ns)
{
	struct ld *l = self;

	g_byte_array_set_size(l->out, 0);
	for (uint32_t first = 0; first + SAMPLES <= fan->beams; first += SAMPLES)
		append_packet(l, fan, first);
	cable_telegram(l->body->cable, now_ns + LEAVES_NS, l->out->data, l->out->len);
}

static void receive(gpointer self, int64_t now_ns, const guint8 *bytes, gsize length)
{
	(void)self;
	(void)now_ns;
	(void)bytes;
	(void)length; /* its receive pin is not even connected */
}

static bool always(gpointer self)
{
	(void)self;
	return true;
}

static bool wants(gpointer self, uint32_t portion)
{
	(void)self;
	(void)portion;
	return true;
}

static void skip(gpointer self, uint32_t portion)
{
	(void)self;
	(void)portion;
}

static void fail(gpointer self, int64_t now_ns)
{
	struct ld *l = self;

	cable_silence(l->body->cable, now_ns, NAN);
}

static void jump(gpointer self, uint32_t counts)
{
	(void)self;
	(void)counts; /* there is no scan counter */
}

static void power_on(gpointer self)
{
	(void)self;
}

static gpointer create(struct lidar_body *body)
{
	struct ld *l = g_new0(struct ld, 1);

	l->body = body;
	l->out = g_byte_array_new();
	return l;
}

static void destroy(gpointer self)
{
	struct ld *l = self;

	g_byte_array_unref(l->out);
	g_free(l);
}

const struct lidar_protocol lidar_ld = { .name = "ld",
	.nominal_tick_ns = 1e6,
	.clock_bits = 32,
	.create = create,
	.destroy = destroy,
	.power_on = power_on,
	.receive = receive,
	.is_waiting = always,
	.is_streaming = always,
	.wants = wants,
	.send = send,
	.skip = skip,
	.fail = fail,
	.jump = jump };
