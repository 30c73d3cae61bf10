#include "sim/cable.h"
#include "sim/chance.h"
#include <math.h>
#include <string.h>

#define OPENING_NS INT64_C(2000000) /* what it takes to open a port */
#define REFUSAL_NS INT64_C(200000)
#define PIECE_NS   INT64_C(50000)   /* between pieces of a telegram, less when there are many */
#define PIECES_NS  INT64_C(2000000) /* at most, for all of them */
#define UNSET_BAUD 9600             /* as kernels open a port */
#define SPIKE_ODDS (1.0 / 400)

struct cable {
	struct cable_desc desc;
	outbox *out;
	uint64_t said; /* units, counts the draws of chance */
	bool open;
	int64_t opened_ns;  /* what leaves earlier is not heard */
	int64_t powered_ns; /* plugged in since; in the future while it is not */
	int64_t silent_until_ns;
	int64_t last_due_ns;
	double cut_s; /* the next telegram is cut by unplugging for so long; 0: no */
	uint32_t garble_left, merge_left;
	uint32_t host_baud;
	int64_t line_free_ns; /* when the last byte is out */
	GByteArray *held;     /* waits to be merged */
};

cable *cable_new(const struct cable_desc *desc, outbox *out)
{
	cable *c = g_new0(cable, 1);

	c->desc = *desc;
	c->out = out;
	c->powered_ns = desc->absent ? INT64_MAX : INT64_MIN;
	c->silent_until_ns = c->line_free_ns = INT64_MIN;
	c->host_baud = UNSET_BAUD;
	c->held = g_byte_array_new();
	return c;
}

void cable_free(cable *c)
{
	if (!c)
		return;
	g_byte_array_unref(c->held);
	g_free(c);
}

void cable_open(cable *c, int64_t now_ns)
{
	if (now_ns < c->powered_ns) {
		outbox_push(c->out, now_ns + REFUSAL_NS, LINK_LIDAR_GONE, NULL);
		return;
	}
	c->open = true;
	c->opened_ns = now_ns + OPENING_NS;
	c->silent_until_ns = INT64_MIN;
	c->last_due_ns = c->opened_ns;
	outbox_push(c->out, c->opened_ns, LINK_LIDAR_OPENED, NULL);
}

void cable_close(cable *c)
{
	c->open = false;
	g_byte_array_set_size(c->held, 0);
	outbox_discard(c->out, LINK_LIDAR_BYTES, INT64_MIN);
	outbox_discard(c->out, LINK_LIDAR_OPENED, INT64_MIN);
}

bool cable_is_open(const cable *c)
{
	return c->open;
}

int64_t cable_powered_ns(const cable *c)
{
	return c->powered_ns;
}

static uint64_t draw(cable *c, uint64_t what)
{
	return chance_hash(c->desc.seed, CHANCE_CABLE, c->said, what);
}

void cable_set_line(cable *c, uint32_t baud)
{
	c->host_baud = baud;
}

bool cable_is_clear(const cable *c)
{
	return c->desc.baud == 0 || c->desc.baud == c->host_baud;
}

/* Ten bits a byte; what is still going out goes first. */
static int64_t through_line(cable *c, int64_t leaves_ns, gsize length)
{
	if (c->desc.baud == 0)
		return leaves_ns;
	double byte_ns = 10e9 / c->desc.baud;
	/* All but the last of several frames were out before. */
	int64_t last_ns = leaves_ns + llrint(byte_ns * (double)MIN(length, c->desc.frame));
	c->line_free_ns = MAX(last_ns,
		c->line_free_ns == INT64_MIN ? last_ns
					     : c->line_free_ns + llrint(byte_ns * (double)length));
	return c->line_free_ns;
}

/* What a receiver at another speed makes of it: bits cut elsewhere, as many as fit its pace. */
static GByteArray *mangled(cable *c, const guint8 *bytes, gsize length)
{
	GByteArray *garbage = g_byte_array_new();
	gsize heard = (gsize)((double)length * fmin(1, (double)c->host_baud / c->desc.baud));

	for (gsize i = 0; i < MAX(heard, 1); i++) {
		guint8 byte = (guint8)chance_hash(c->desc.seed, CHANCE_GARBLE, c->said + 1,
			(uint64_t)bytes[i * length / MAX(heard, 1)] << 32 | i);

		g_byte_array_append(garbage, &byte, 1);
	}
	return garbage;
}

static int64_t arrival(cable *c, int64_t leaves_ns)
{
	double delay = c->desc.latency_ns + c->desc.jitter_ns * chance_exponential(draw(c, 0));

	if (chance_uniform(draw(c, 1)) < SPIKE_ODDS)
		delay += 100 * c->desc.jitter_ns * chance_uniform(draw(c, 2));
	c->said++;
	return MAX(c->last_due_ns, leaves_ns + llrint(delay));
}

static void deliver(cable *c, int64_t leaves_ns, const guint8 *bytes, gsize length)
{
	int64_t due_ns = arrival(c, through_line(c, leaves_ns, length));
	gsize piece = c->desc.packet ? c->desc.packet : MAX(length, 1);
	gsize pieces = (length + piece - 1) / piece;
	int64_t apart_ns = MIN(PIECE_NS, PIECES_NS / (int64_t)MAX(pieces, 1));

	for (gsize at = 0; at < length; at += piece, due_ns += apart_ns) {
		GByteArray *payload = g_byte_array_new();

		g_byte_array_append(payload, bytes + at, (guint)MIN(piece, length - at));
		outbox_push(c->out, due_ns, LINK_LIDAR_BYTES, payload);
		c->last_due_ns = due_ns;
	}
}

static bool is_heard(const cable *c, int64_t leaves_ns)
{
	return c->open && leaves_ns >= c->opened_ns && leaves_ns >= c->powered_ns &&
	       leaves_ns >= c->silent_until_ns;
}

static void say(cable *c, int64_t leaves_ns, const guint8 *bytes, gsize length)
{
	if (!is_heard(c, leaves_ns))
		return;
	g_byte_array_append(c->held, bytes, (guint)length);
	if (cable_is_clear(c)) {
		deliver(c, leaves_ns, c->held->data, c->held->len);
	} else {
		g_autoptr(GByteArray) garbage = mangled(c, c->held->data, c->held->len);

		deliver(c, leaves_ns, garbage->data, garbage->len);
	}
	g_byte_array_set_size(c->held, 0);
}

void cable_answer(cable *c, int64_t leaves_ns, const void *bytes, gsize length)
{
	say(c, leaves_ns, bytes, length);
}

/* Flips a bit, inserts or loses a few bytes, somewhere. */
static void damage(cable *c, GByteArray *bytes)
{
	uint64_t h = chance_hash(c->desc.seed, CHANCE_GARBLE, c->said, 0);
	guint at = (guint)((h >> 16) % bytes->len), few = 1 + (h >> 8 & 3);

	if (h % 3 == 0) {
		bytes->data[at] ^= (guint8)(1u << (h >> 12 & 7));
	} else if (h % 3 == 1) {
		g_byte_array_remove_range(bytes, at, MIN(few, bytes->len - at));
	} else {
		g_byte_array_set_size(bytes, bytes->len + few);
		memmove(bytes->data + at + few, bytes->data + at, bytes->len - at - few);
	}
}

void cable_unplug(cable *c, int64_t now_ns, double seconds)
{
	if (c->open)
		outbox_push(
			c->out, MAX(now_ns, c->last_due_ns) + REFUSAL_NS, LINK_LIDAR_GONE, NULL);
	c->open = false;
	c->powered_ns = now_ns + llrint(seconds * 1e9);
	g_byte_array_set_size(c->held, 0);
}

void cable_unplug_in_telegram(cable *c, double seconds)
{
	c->cut_s = seconds;
}

void cable_telegram(cable *c, int64_t leaves_ns, const void *bytes, gsize length)
{
	g_autoptr(GByteArray) telegram = g_byte_array_new();
	double cut_s = c->cut_s;

	if (!is_heard(c, leaves_ns) || length == 0)
		return;
	g_byte_array_append(telegram, bytes, (guint)length);
	if (c->garble_left > 0) {
		c->garble_left--;
		damage(c, telegram);
	}
	if (cut_s > 0)
		g_byte_array_set_size(telegram, telegram->len / 2);
	if (c->merge_left > 0 && c->held->len == 0 && !(cut_s > 0)) {
		c->merge_left--;
		g_byte_array_append(c->held, telegram->data, telegram->len);
		return;
	}
	say(c, leaves_ns, telegram->data, telegram->len);
	if (cut_s > 0) {
		cable_unplug(c, leaves_ns, cut_s);
		c->cut_s = 0;
	}
}

void cable_silence(cable *c, int64_t now_ns, double seconds)
{
	c->silent_until_ns = isnan(seconds) ? INT64_MAX : now_ns + llrint(seconds * 1e9);
}

void cable_garble(cable *c, uint32_t telegrams)
{
	c->garble_left = telegrams;
}

void cable_merge(cable *c, uint32_t telegrams)
{
	c->merge_left = telegrams;
}

void cable_split(cable *c, gsize bytes)
{
	c->desc.packet = bytes;
}
