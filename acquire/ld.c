/* The decoder of LDRobot's lidars. */
#include "acquire/ld.h"
#include "acquire/decoder.h"
#include "acquire/turn.h"
#include <math.h>
#include <string.h>

#define SPEED_AT 2
#define START_AT 4
#define DATA_AT  6
#define END_AT   42
#define STAMP_AT 44

#define TURN_E2   36000 /* hundredths of a degree */
#define DEGREE_E2 ((float)(G_PI / 18000))
/* A gap of more turns than this is not bridged by their length: motors wander. */
#define TURNS_MISSING_MAX 1.5

struct ld {
	decoder base;
	struct turn turn;
	uint8_t held[LD_PACKET_BYTES]; /* the beginning of a packet whose end has not come yet */
	unsigned held_length;
	bool lost; /* bytes are being passed over */
	/* Of the last packet. */
	bool follows;
	uint32_t end_e2, step_e2x11, stamp_ms;
	int64_t arrival_ns;
	double speed_sum; /* degrees a second, over the packets of this turn */
	uint32_t speeds;
	double beat_hz; /* as the last turn had it; it must be the same twice */
};

/* Four bytes at a time: tables[k] is what a byte does that has k more behind it. */
static uint8_t tables[4][256];

static void make_tables(void)
{
	static gsize made;
	if (!g_once_init_enter(&made))
		return;
	for (int i = 0; i < 256; i++) {
		uint8_t crc = (uint8_t)i;
		for (int bit = 0; bit < 8; bit++)
			crc = (uint8_t)(crc << 1 ^ (crc & 0x80 ? 0x4d : 0));
		tables[0][i] = crc;
	}
	for (int k = 1; k < 4; k++)
		for (int i = 0; i < 256; i++)
			tables[k][i] = tables[0][tables[k - 1][i]];
	g_once_init_leave(&made, 1);
}

uint8_t ld_crc(const uint8_t *b, unsigned length)
{
	uint8_t crc = 0;
	make_tables();
	for (; length >= 4; length -= 4, b += 4)
		crc = tables[3][crc ^ b[0]] ^ tables[2][b[1]] ^ tables[1][b[2]] ^ tables[0][b[3]];
	for (; length > 0; length--)
		crc = tables[0][crc ^ *b++];
	return crc;
}

bool ld_is_packet(const uint8_t *bytes)
{
	return bytes[0] == LD_HEADER && bytes[1] == LD_VERSION &&
	       ld_crc(bytes, LD_PACKET_BYTES - 1) == bytes[LD_PACKET_BYTES - 1];
}

static uint32_t u16(const uint8_t *at)
{
	return at[0] | (uint32_t)at[1] << 8;
}

/* How many measurements a second, of those that devices have; another kind's own, to a hundredth. */
static double known_beat(double hz)
{
	static const double beats_hz[] = { 2300, 4500, 5000, 21600 };
	double best = 0;
	for (size_t i = 0; i < G_N_ELEMENTS(beats_hz); i++)
		if (fabs(log(beats_hz[i] / hz)) < (best > 0 ? fabs(log(best / hz)) : 0.08))
			best = beats_hz[i];
	double digit = pow(10, floor(log10(hz)) - 1);
	return best > 0 ? best : round(hz / digit) * digit;
}

static void name_model(struct ld *d)
{
	bool fast = d->beat_hz > 10000;
	g_strlcpy(d->base.identity.model, fast ? "STL-27L" : "LD06/LD19",
		sizeof d->base.identity.model);
	d->base.identity.range_max_m = fast ? 25 : 12;
}

/* Once a turn is whole, its number of measurements and its speed tell the beat. */
static void learn_beat(struct ld *d)
{
	if (d->turn.sample_ns <= 0 && d->turn.last_whole && d->speeds) {
		double hz =
			known_beat(fmax(d->turn.last_whole * d->speed_sum / d->speeds / 360, 1));
		if (hz == d->beat_hz) {
			d->turn.sample_ns = 1e9 / hz;
			name_model(d);
		}
		d->beat_hz = hz;
	}
	d->speed_sum = d->speeds = 0;
}

/* Milliseconds from stamp to stamp; the arrivals tell how often it wrapped. */
static double stamps_apart_ms(const struct ld *d, uint32_t stamp_ms, int64_t arrival_ns)
{
	double apart = (stamp_ms + LD_STAMP_WRAP - d->stamp_ms) % LD_STAMP_WRAP,
	       waited = (double)(arrival_ns - d->arrival_ns) * 1e-6;
	return apart + LD_STAMP_WRAP * fmax(round((waited - apart) / LD_STAMP_WRAP), 0);
}

/* Packets follow each other without a gap in their angles. Where there is one, it tells how many
 * measurements are missing, more or fewer than whole turns, which the stamps tell. */
static bool skip_gap(struct ld *d, const uint8_t *p, int64_t arrival_ns)
{
	double step_e2 =
		d->turn.last_whole ? (double)TURN_E2 / d->turn.last_whole : d->step_e2x11 / 11.0;
	if (!d->follows || d->step_e2x11 < 11)
		return false;
	double gap_e2 = remainder((double)u16(p + START_AT) - d->end_e2, TURN_E2),
	       missing = round(gap_e2 / step_e2) - 1;
	if (d->turn.sample_ns <= 0 || !d->turn.last_whole) {
		if (fabs(missing) > LD_SAMPLES / 2)
			turn_begin_epoch(&d->turn, &d->base);
		return fabs(missing) > LD_SAMPLES / 2;
	}
	double beat_ms = d->turn.sample_ns * 1e-6, beams = d->turn.last_whole,
	       apart_ms = stamps_apart_ms(d, u16(p + STAMP_AT), arrival_ns),
	       turns = round((apart_ms / beat_ms - LD_SAMPLES - missing) / beams);
	/* Packets are lost as a whole. */
	missing = LD_SAMPLES * round((missing + beams * fmax(turns, 0)) / LD_SAMPLES);
	if (missing < LD_SAMPLES)
		return false;
	if (missing > TURNS_MISSING_MAX * beams)
		turn_begin_epoch(&d->turn, &d->base);
	else
		turn_skip(&d->turn, &d->base, (uint64_t)missing);
	return true;
}

static double transmission_ns(const struct ld *d)
{
	return LD_PACKET_BYTES * 10 * 1e9 / (d->beat_hz > 10000 ? 921600 : 230400);
}

/* The measurement with which a turn begins, where its angle passes a whole one; LD_SAMPLES: none.
 * The packet before may have ended just before it. */
static uint32_t beginning(const struct ld *d, uint32_t start_e2, bool joins)
{
	uint32_t span_e2 = d->step_e2x11;
	if (joins && start_e2 < d->end_e2 && d->end_e2 - start_e2 > TURN_E2 / 2)
		return 0;
	return start_e2 + span_e2 >= TURN_E2 ? ((TURN_E2 - start_e2) * 11 + span_e2 - 1) / span_e2
					     : LD_SAMPLES;
}

static void take_samples(
	struct ld *d, const uint8_t *p, uint32_t start_e2, bool joins, int64_t arrival_ns)
{
	float angle[LD_SAMPLES], step = (float)d->step_e2x11 / 11;
	uint32_t range[LD_SAMPLES];
	uint16_t intensity[LD_SAMPLES];
	for (int i = 0; i < LD_SAMPLES; i++) {
		angle[i] = ((float)start_e2 + step * (float)i) * DEGREE_E2;
		range[i] = u16(p + DATA_AT + 3 * i);
		intensity[i] = p[DATA_AT + 3 * i + 2];
	}
	uint32_t begins = beginning(d, start_e2, joins);
	for (uint32_t i = begins; begins > 0 && i < LD_SAMPLES; i++)
		angle[i] -= (float)(2 * G_PI);
	turn_add(&d->turn, &d->base,
		&(struct turn_samples){
			angle, range, intensity, LD_SAMPLES, begins, transmission_ns(d) },
		arrival_ns);
	d->speed_sum += u16(p + SPEED_AT);
	d->speeds++;
	if (begins < LD_SAMPLES)
		learn_beat(d);
}

static void take_packet(struct ld *d, const uint8_t *p, int64_t arrival_ns)
{
	uint32_t start_e2 = u16(p + START_AT) % TURN_E2, end_e2 = u16(p + END_AT) % TURN_E2;
	bool joins = !skip_gap(d, p, arrival_ns) && d->follows;
	d->step_e2x11 = (end_e2 + TURN_E2 - start_e2) % TURN_E2;
	take_samples(d, p, start_e2, joins, arrival_ns);
	d->end_e2 = end_e2;
	d->stamp_ms = u16(p + STAMP_AT) % LD_STAMP_WRAP;
	d->arrival_ns = arrival_ns;
	d->follows = true;
	d->lost = false;
}

/* What may be the beginning of a packet, or the end. */
static const uint8_t *find_header(const uint8_t *at, const uint8_t *end)
{
	while ((at = memchr(at, LD_HEADER, (size_t)(end - at))) && at + 1 < end &&
		at[1] != LD_VERSION)
		at++;
	return at ? at : end;
}

/* Takes whole packets; returns where the rest begins, which may be the beginning of one. */
static const uint8_t *take_bytes(
	struct ld *d, const uint8_t *at, const uint8_t *end, int64_t arrival_ns)
{
	for (;;) {
		const uint8_t *start = at < end ? find_header(at, end) : end;
		d->base.counts.skipped_bytes += (uint64_t)(start - at);
		if (end - start < LD_PACKET_BYTES)
			return start;
		at = start;
		if (ld_is_packet(at)) {
			take_packet(d, at, arrival_ns);
			at += LD_PACKET_BYTES;
			continue;
		}
		d->base.counts.bad_sums += !d->lost;
		d->lost = true;
		d->base.counts.skipped_bytes++;
		at++;
	}
}

static void ld_feed(decoder *base, const void *bytes, size_t length, int64_t arrival_ns)
{
	struct ld *d = (struct ld *)base;
	const uint8_t *at = bytes, *end = at + length;
	/* Two packets' room: whatever is held ends within the second. */
	while (d->held_length > 0 && at < end) {
		uint8_t joined[2 * LD_PACKET_BYTES];
		size_t more = MIN((size_t)(end - at), sizeof joined - d->held_length);
		memcpy(joined, d->held, d->held_length);
		memcpy(joined + d->held_length, at, more);
		const uint8_t *joined_end = joined + d->held_length + more,
			      *rest = take_bytes(d, joined, joined_end, arrival_ns);
		if (rest >= joined + d->held_length && more < (size_t)(end - at)) {
			at += rest - (joined + d->held_length);
			d->held_length = 0;
			break;
		}
		at += more;
		d->held_length = (unsigned)(joined_end - rest);
		memmove(d->held, rest, d->held_length);
	}
	if (at == end)
		return;
	const uint8_t *rest = take_bytes(d, at, end, arrival_ns);
	d->held_length = (unsigned)(end - rest);
	memcpy(d->held, rest, d->held_length);
}

static decoder *ld_create(void)
{
	make_tables();
	struct ld *d = g_new0(struct ld, 1);
	return &d->base;
}

static void ld_destroy(decoder *base)
{
	struct ld *d = (struct ld *)base;
	turn_clear(&d->turn);
	g_free(d);
}

const struct decoder_ops decoder_ld = { "ld", ld_create, ld_feed, ld_destroy };
