/* The decoder of Slamtec's RPLIDARs: descriptors, answers and six kinds of measurements. */
#include "acquire/decoder.h"
#include "acquire/rplidar-frames.h"
#include "acquire/turn.h"
#include <math.h>
#include <string.h>

/* Nodes of the standard format in a row that make up for the sum that they have not. */
#define NODES_TO_TRUST 8
/* Silence by so much of a turn, beyond what it should be, leaves open how many turns are missing. */
#define TURNS_OF_DOUBT 0.6
/* Standard nodes have angles that are turned by their distance. */
#define NODES_APART_DEG 15
#define STAMPS_TO_TRUST 8
#define NODES_AT_ONCE   RPLIDAR_SAMPLES_MAX

enum state { OUTSIDE, REPLY, STREAM };

struct rplidar {
	decoder base;
	struct turn turn;
	enum state state;
	struct rplidar_descriptor now; /* of the answer or the stream */
	uint8_t *held;                 /* what came and is not taken yet */
	size_t held_length, held_size;
	int64_t arrival_ns;
	bool lost;         /* in a stream: bytes are being passed over */
	double beat_us[2]; /* of standard and of express scans, from GET_SAMPLERATE; 0: not told */
	double mode_beat_us; /* of the mode that was asked for last */
	double byte_ns;      /* on the line */
	/* Of the frame before. */
	bool follows;
	uint8_t before[RPLIDAR_FRAME_BYTES_MAX];
	int64_t before_arrival_ns;
	uint64_t stamp_us;
	unsigned stamps_agree;
	uint32_t span_q6; /* of a capsule */
	bool turn_begins; /* with the next capsule */
	float last_clockwise_rad;
	bool broken; /* nodes were lost since */
	struct rplidar_samples samples;
};

static uint32_t u16(const uint8_t *at)
{
	return at[0] | (uint32_t)at[1] << 8;
}

static uint32_t u32(const uint8_t *at)
{
	return u16(at) | u16(at + 2) << 16;
}

/* Answers */

static const struct {
	uint8_t major; /* from here on */
	const char *series;
	uint32_t baud;
} makes[] = { { 9, "T", 1000000 }, { 7, "S", 1000000 }, { 6, "S1", 256000 }, { 4, "C", 460800 },
	{ 3, "A3", 256000 }, { 2, "A2", 115200 }, { 0, "A1", 115200 } };

static void take_info(struct rplidar *d, const uint8_t *b)
{
	struct lidar_identity *identity = &d->base.identity;
	size_t i = 0;
	while (b[0] >> 4 < makes[i].major)
		i++;
	g_snprintf(identity->model, sizeof identity->model, "RPLIDAR %s (model %02x)",
		makes[i].series, b[0]);
	g_snprintf(identity->firmware, sizeof identity->firmware, "%u.%02u", b[2], b[1]);
	for (int k = 0; k < 15; k++) /* what fits, but for the last byte */
		g_snprintf(identity->serial + 2 * k, 3, "%02X", b[4 + k]);
	d->byte_ns = 10e9 / makes[i].baud;
}

static void take_conf(struct rplidar *d, const uint8_t *b, size_t length)
{
	if (length < 8)
		return;
	if (u32(b) == 0x71)
		d->mode_beat_us = u32(b + 4) / 256.0;
	else if (u32(b) == 0x74)
		d->base.identity.range_max_m = u32(b + 4) / 256.0;
}

static const char *reply_name(uint8_t type)
{
	switch (type) {
	case 0x04: return "info";
	case 0x06: return "health";
	case 0x15: return "samplerate";
	case 0x20: return "conf";
	case 0x21: return "set conf";
	case 0xff: return "board";
	default: return "other";
	}
}

static void take_reply(struct rplidar *d, const uint8_t *b)
{
	char text[2 * RPLIDAR_REPLY_BYTES_MAX + 1] = "";
	size_t length = d->now.length;
	for (size_t i = 0; i < length; i++)
		g_snprintf(text + 2 * i, 3, "%02x", b[i]);
	if (d->now.type == 0x04 && length >= 20)
		take_info(d, b);
	else if (d->now.type == 0x20)
		take_conf(d, b, length);
	else if (d->now.type == 0x15 && length >= 4) {
		d->beat_us[0] = u16(b);
		d->beat_us[1] = u16(b + 2);
	}
	d->base.counts.replies++;
	struct lidar_reply reply = { d->arrival_ns, reply_name(d->now.type), "", text };
	if (d->base.sink.reply)
		d->base.sink.reply(&reply, d->base.sink.user_data);
}

/* Measurements */

/* Half a millisecond is an A1's, which tells nothing else in the standard mode. */
static double beat_us(const struct rplidar *d)
{
	double told = d->beat_us[d->now.format != RPLIDAR_STANDARD];
	if (d->mode_beat_us > 0)
		return d->mode_beat_us;
	return told > 0 ? told : d->now.format == RPLIDAR_STANDARD ? 500 : 250;
}

static void begin(struct rplidar *d, const struct rplidar_descriptor *now)
{
	d->now = *now;
	d->state = now->loops ? STREAM : REPLY;
	if (!now->loops)
		return;
	turn_restart(&d->turn);
	d->turn.sample_ns = beat_us(d) * 1000;
	d->follows = d->lost = d->broken = d->turn_begins = false;
	d->span_q6 = d->stamps_agree = 0;
}

/* How long it is since the frame before: by the device, where it says so and is believed. */
static double waited_ns(struct rplidar *d, const uint8_t *b, double frame_ns)
{
	uint64_t stamp_us, apart_us;
	if (!rplidar_stamp_us(d->now.format, b, &stamp_us))
		return (double)(d->arrival_ns - d->before_arrival_ns);
	apart_us = stamp_us - d->stamp_us;
	if (d->now.format == RPLIDAR_ULTRA_DENSE)
		apart_us &= 0xffffffff;
	bool trusted = d->stamps_agree >= STAMPS_TO_TRUST,
	     agrees = fabs((double)apart_us * 1e3 - frame_ns) < 0.25 * frame_ns;
	d->stamps_agree = agrees ? d->stamps_agree + 1 : trusted ? d->stamps_agree : 0;
	return trusted ? (double)apart_us * 1e3 : (double)(d->arrival_ns - d->before_arrival_ns);
}

static bool is_in_doubt(const struct rplidar *d, double silent_ns)
{
	double turn_ns = d->turn.last_whole ? d->turn.last_whole * d->turn.sample_ns : 1e8;
	return silent_ns > TURNS_OF_DOUBT * turn_ns;
}

static void remember(struct rplidar *d, const uint8_t *b)
{
	memcpy(d->before, b, d->now.length);
	d->before_arrival_ns = d->arrival_ns;
	rplidar_stamp_us(d->now.format, b, &d->stamp_us);
	d->follows = true;
}

static void give_capsule(struct rplidar *d, const uint8_t *next, uint32_t span_q6)
{
	uint32_t start_q6 = rplidar_start_q6(d->now.format, d->before);
	uint32_t count = rplidar_frame_samples(d->now.format), marked = count;
	struct rplidar_samples *s = &d->samples;
	rplidar_decode_capsule(d->now.format, d->before, next, span_q6, s);
	if (d->turn_begins)
		marked = 0;
	else if (start_q6 + span_q6 >= RPLIDAR_TURN_Q6)
		marked = ((RPLIDAR_TURN_Q6 - start_q6) * count + span_q6 - 1) / span_q6;
	/* Where it passes behind the last one, the next capsule's first is the first of a turn. */
	d->turn_begins = next && marked == count && start_q6 + span_q6 >= RPLIDAR_TURN_Q6;
	for (uint32_t i = marked; marked > 0 && i < count; i++)
		s->clockwise_rad[i] -= (float)(2 * G_PI);
	turn_add(&d->turn, &d->base,
		&(struct turn_samples){ s->clockwise_rad, s->range_mm,
			s->has_intensity ? s->intensity : NULL, count, marked,
			d->now.length * d->byte_ns, next ? count : 0 },
		next ? d->arrival_ns : d->before_arrival_ns);
}

/* A capsule can be read once the next one is there. Where some are missing in between, the span of
 * the one before has to do. */
static void take_capsule(struct rplidar *d, const uint8_t *b)
{
	uint32_t count = rplidar_frame_samples(d->now.format);
	double frame_ns = count * d->turn.sample_ns;
	if (rplidar_begins_anew(d->now.format, b) && d->follows) {
		turn_begin_epoch(&d->turn, &d->base);
		d->follows = d->turn_begins = false;
	}
	if (!d->follows) {
		remember(d, b);
		return;
	}
	uint32_t apart_q6 = (rplidar_start_q6(d->now.format, b) + RPLIDAR_TURN_Q6 -
				    rplidar_start_q6(d->now.format, d->before)) %
			    RPLIDAR_TURN_Q6;
	double capsules = d->span_q6 ? fmax(round((double)apart_q6 / d->span_q6), 1) : 1,
	       silent_ns = waited_ns(d, b, frame_ns) - capsules * frame_ns;
	bool doubt = is_in_doubt(d, silent_ns);
	if (capsules > 1 || doubt) {
		if (d->span_q6)
			give_capsule(d, NULL, d->span_q6);
		if (doubt)
			turn_begin_epoch(&d->turn, &d->base);
		else
			turn_skip(&d->turn, &d->base, (uint64_t)(capsules - 1) * count);
	} else if (apart_q6 > 0) {
		give_capsule(d, b, apart_q6);
		d->span_q6 = apart_q6;
	}
	remember(d, b);
}

static void give_some(struct rplidar *d, uint32_t from, uint32_t to, bool marked, uint32_t after)
{
	struct rplidar_samples *s = &d->samples;
	if (to > from)
		turn_add(&d->turn, &d->base,
			&(struct turn_samples){ s->clockwise_rad + from, s->range_mm + from,
				s->intensity + from, to - from, marked ? 0 : to - from,
				d->now.length * d->byte_ns, after },
			d->arrival_ns);
}

/* The one with which a turn begins goes alone, so that it does not matter how many came with it;
 * after: so many of its frame follow it. */
static void give_nodes(struct rplidar *d, uint32_t from, uint32_t to, bool marked, uint32_t after)
{
	uint32_t rest = from + (marked && to > from);
	if (rest > from)
		give_some(d, from, rest, true, after);
	give_some(d, rest, to, false, 0);
}

static void take_hq(struct rplidar *d, const uint8_t *b)
{
	struct rplidar_samples *s = &d->samples;
	double frame_ns = RPLIDAR_SAMPLES_MAX * d->turn.sample_ns;
	uint32_t from = 0;
	bool marked = false;
	if (d->follows) {
		double silent = (waited_ns(d, b, frame_ns) - frame_ns) / frame_ns;
		if (is_in_doubt(d, silent * frame_ns))
			turn_begin_epoch(&d->turn, &d->base);
		else if (d->stamps_agree >= STAMPS_TO_TRUST && silent > 0.5)
			turn_skip(
				&d->turn, &d->base, (uint64_t)round(silent) * RPLIDAR_SAMPLES_MAX);
	}
	for (uint32_t i = 0; i < RPLIDAR_SAMPLES_MAX; i++) {
		bool starts = rplidar_decode_hq(b + RPLIDAR_HQ_NODES_AT + i * RPLIDAR_HQ_NODE_BYTES,
			&s->clockwise_rad[i], &s->range_mm[i], &s->intensity[i]);
		if (!starts)
			continue;
		give_nodes(d, from, i, marked, RPLIDAR_SAMPLES_MAX - 1 - from);
		from = i;
		marked = true;
	}
	give_nodes(d, from, RPLIDAR_SAMPLES_MAX, marked, RPLIDAR_SAMPLES_MAX - 1 - from);
	remember(d, b);
}

static float apart_rad(float from, float to)
{
	float apart = to - from;
	return apart < (float)(-G_PI / 4) ? apart + (float)(2 * G_PI) : apart;
}

static bool leaps(float apart)
{
	return apart > NODES_APART_DEG * (float)(G_PI / 180);
}

/* Where nodes were lost, or the angle leaps, that tells how many are missing. */
static void bridge_nodes(struct rplidar *d, float clockwise_rad)
{
	double silent_ns =
		(double)(d->arrival_ns - d->before_arrival_ns) - NODES_AT_ONCE * d->turn.sample_ns;
	double step = 2 * G_PI / MAX(d->turn.last_whole, 1);
	float apart = apart_rad(d->last_clockwise_rad, clockwise_rad);
	bool broken = d->broken || leaps(apart);
	if (is_in_doubt(d, silent_ns) || (broken && !d->turn.last_whole))
		turn_begin_epoch(&d->turn, &d->base);
	else if (broken && (double)apart > 1.5 * step)
		turn_skip(&d->turn, &d->base, (uint64_t)round((double)apart / step) - 1);
}

static float node_angle(const uint8_t *b)
{
	return (float)(u16(b + 1) >> 1) * (float)(G_PI / 11520);
}

enum wholeness { WHOLE, CUT, OPEN };

/* Nodes have no sum, so one that was cut by STOP would swallow the beginning of the answer. OPEN:
 * too few bytes to tell. */
static enum wholeness wholeness_of(const uint8_t *b, size_t length)
{
	struct rplidar_descriptor d;
	for (size_t at = 1; at < RPLIDAR_NODE_BYTES; at++) {
		if (b[at] != 0xa5 || (length > at + 1 && b[at + 1] != 0x5a))
			continue;
		if (length < at + RPLIDAR_DESCRIPTOR_BYTES)
			return OPEN;
		if (rplidar_is_descriptor(b + at, &d))
			return CUT;
	}
	return WHOLE;
}

/* Nodes in a row, as many as there are. */
static size_t take_nodes(struct rplidar *d, const uint8_t *at, size_t length)
{
	struct rplidar_samples *s = &d->samples;
	uint32_t n = 0;
	bool marked = false;
	const uint8_t *b = at;
	float last = 0;
	if (d->follows)
		bridge_nodes(d, node_angle(b));
	d->broken = false;
	for (; length >= RPLIDAR_NODE_BYTES && rplidar_is_node(b) && n < NODES_AT_ONCE &&
		wholeness_of(b, length) == WHOLE;
		b += RPLIDAR_NODE_BYTES, length -= RPLIDAR_NODE_BYTES) {
		float angle = node_angle(b);
		if (b > at && leaps(apart_rad(last, angle)))
			break;
		last = angle;
		if (b[0] & 1) {
			give_nodes(d, 0, n, marked, 0);
			n = 0;
			marked = true;
		}
		s->clockwise_rad[n] = angle;
		s->range_mm[n] = (u16(b + 3) + 2) >> 2;
		s->intensity[n++] = b[0] >> 2;
	}
	give_nodes(d, 0, n, marked, 0);
	if (n > 0) {
		d->last_clockwise_rad = last;
		d->before_arrival_ns = d->arrival_ns;
		d->follows = true;
	}
	return (size_t)(b - at);
}

/* Bytes */

/* A stream that is stopped is cut anywhere, and an answer follows. */
static bool holds_descriptor(const uint8_t *at, size_t length)
{
	struct rplidar_descriptor d;
	const uint8_t *end = at + length, *found = at + 1;
	while (end - found >= RPLIDAR_DESCRIPTOR_BYTES &&
		(found = memchr(found, 0xa5, (size_t)(end - found) - RPLIDAR_DESCRIPTOR_BYTES + 1)))
		if (rplidar_is_descriptor(found, &d))
			return true;
		else
			found++;
	return false;
}

/* Passes over a byte of a stream; of those in a row the first counts as a bad telegram. */
static size_t refuse(struct rplidar *d)
{
	bool first = !d->lost;
	d->lost = d->broken = true;
	if (d->now.format == RPLIDAR_STANDARD)
		d->base.counts.malformed += first;
	else
		d->base.counts.bad_sums += first;
	d->base.counts.skipped_bytes++;
	return 1;
}

/* In a stream, what begins here: bytes taken, 0 for too few to tell. */
static size_t find_nodes(struct rplidar *d, const uint8_t *at, size_t length)
{
	size_t nodes = 0, seen = MIN(length, NODES_TO_TRUST * RPLIDAR_NODE_BYTES);
	if (holds_descriptor(at, seen))
		return refuse(d);
	for (; nodes < NODES_TO_TRUST; nodes++) {
		if (length < (nodes + 1) * RPLIDAR_NODE_BYTES)
			return 0;
		if (!rplidar_is_node(at + nodes * RPLIDAR_NODE_BYTES))
			return refuse(d);
	}
	enum wholeness whole = wholeness_of(at, length);
	if (whole != WHOLE)
		return whole == OPEN ? 0 : refuse(d);
	d->lost = false;
	return take_nodes(d, at, length);
}

static size_t take_frame(struct rplidar *d, const uint8_t *at, size_t length)
{
	if (d->now.format == RPLIDAR_STANDARD) {
		if (d->lost)
			return find_nodes(d, at, length);
		if (length < RPLIDAR_NODE_BYTES)
			return 0;
		enum wholeness whole = rplidar_is_node(at) ? wholeness_of(at, length) : CUT;
		if (whole == OPEN)
			return 0;
		return whole == WHOLE ? take_nodes(d, at, length) : refuse(d);
	}
	bool begins = d->now.format == RPLIDAR_HQ ? at[0] == 0xa5
						  : at[0] >> 4 == 0xa && at[1] >> 4 == 0x5;
	size_t seen = MIN(length, d->now.length);
	if (!begins || holds_descriptor(at, seen))
		return refuse(d);
	if (length < d->now.length)
		return 0;
	if (!rplidar_is_frame(d->now.format, at))
		return refuse(d);
	d->lost = false;
	if (d->now.format == RPLIDAR_HQ)
		take_hq(d, at);
	else
		take_capsule(d, at);
	return d->now.length;
}

static size_t skip_to_mark(struct rplidar *d, const uint8_t *at, size_t length)
{
	const uint8_t *mark = memchr(at + 1, 0xa5, length - 1);
	size_t skipped = mark ? (size_t)(mark - at) : length;
	d->base.counts.skipped_bytes += skipped;
	return skipped;
}

static size_t take_one(struct rplidar *d, const uint8_t *at, size_t length)
{
	struct rplidar_descriptor next;
	if (d->state == REPLY) {
		if (length < d->now.length)
			return 0;
		take_reply(d, at);
		d->state = OUTSIDE;
		return d->now.length;
	}
	bool may_be = at[0] == 0xa5 && (length < 2 || at[1] == 0x5a);
	if (may_be && length < RPLIDAR_DESCRIPTOR_BYTES)
		return 0;
	if (may_be && rplidar_is_descriptor(at, &next)) {
		begin(d, &next);
		return RPLIDAR_DESCRIPTOR_BYTES;
	}
	if (d->state == STREAM)
		return length < 2 ? 0 : take_frame(d, at, length);
	return skip_to_mark(d, at, length);
}

static const uint8_t *take_all(struct rplidar *d, const uint8_t *at, const uint8_t *end)
{
	for (size_t n; at < end && (n = take_one(d, at, (size_t)(end - at))); at += n)
		;
	return at;
}

static void hold(struct rplidar *d, const uint8_t *bytes, size_t length)
{
	if (length == 0)
		return;
	if (d->held_length + length > d->held_size) {
		d->held_size = MAX(d->held_length + length, 2 * d->held_size);
		d->held = g_realloc(d->held, d->held_size);
	}
	memcpy(d->held + d->held_length, bytes, length);
	d->held_length += length;
}

static void rplidar_feed(decoder *base, const void *bytes, size_t length, int64_t arrival_ns)
{
	struct rplidar *d = (struct rplidar *)base;
	d->arrival_ns = arrival_ns;
	if (d->held_length == 0) {
		const uint8_t *end = (const uint8_t *)bytes + length,
			      *rest = take_all(d, bytes, end);
		hold(d, rest, (size_t)(end - rest));
		return;
	}
	hold(d, bytes, length);
	const uint8_t *rest = take_all(d, d->held, d->held + d->held_length);
	size_t left = d->held_length - (size_t)(rest - d->held);
	memmove(d->held, rest, left);
	d->held_length = left;
}

static decoder *rplidar_create(void)
{
	struct rplidar *d = g_new0(struct rplidar, 1);
	d->byte_ns = 10e9 / 115200;
	return &d->base;
}

static void rplidar_destroy(decoder *base)
{
	struct rplidar *d = (struct rplidar *)base;
	turn_clear(&d->turn);
	g_free(d->held);
	g_free(d);
}

const struct decoder_ops decoder_rplidar = { "rplidar", rplidar_create, rplidar_feed,
	rplidar_destroy };
