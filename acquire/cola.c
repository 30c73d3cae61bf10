#include "acquire/cola.h"
#include "acquire/bytes.h"
#include "acquire/cola-scan.h"
#include "acquire/decoder.h"
#include <math.h>

struct cola {
	decoder base;
	int64_t arrival_ns;
	bool inside; /* of a telegram */
	bool has_output_range;
	char *held; /* the beginning of a telegram whose end has not come yet */
	size_t held_length, held_size;
	GString *command, *text; /* of the reply in work */
	struct cola_scan scan;
};

const char *cola_error_text(const char *status)
{
	/* Manual of TiM781, pages 119-120. */
	static const char *const texts[] = { "no error",
		"the user level does not allow this method", "no such method", "no such variable",
		"a value is out of range", "invalid data", "unknown error", "buffer overflow",
		"parameters are missing", "unknown type",
		"the user level does not allow writing this variable",
		"no such command for the name server", "no such CoLa command",
		"the device is busy with another command", "flexible array out of bounds",
		"no such event", "a value has too many digits", "invalid character",
		"no message from the system", "no answer from the system", "internal error",
		"hub address corrupted", "hub address decoding", "too many hub addresses",
		"a space is missing in the hub address", "asynchronous methods are suppressed",
		"complex arrays are not supported" };
	guint64 number = g_ascii_strtoull(status, NULL, 16);
	return number < G_N_ELEMENTS(texts) ? texts[number] : "unknown error";
}

/* Identity */

static void adopt_string(struct cola_cursor *c, char *to, size_t size)
{
	const char *string;
	size_t length;
	if (cola_string(c, &string, &length))
		bytes_copy_name(to, size, string, length);
}

/* step, first and last angle in 1/10000 degree, as LMPoutputRange and LMPscancfg have them. */
static bool adopt_angles(struct cola_cursor *c, struct lidar_identity *identity)
{
	uint32_t step_e4 = cola_hex(c, 8);
	int32_t start_e4 = cola_signed(c), stop_e4 = cola_signed(c);
	double step_deg = cola_true_step_deg(step_e4);
	if (c->bad || step_e4 == 0 || stop_e4 < start_e4)
		return false;
	/* A hundredth of a step more, as the last angle is cut to 1/10000 degree too. */
	double steps = floor(((double)stop_e4 - start_e4) / 1e4 / step_deg + 0.01);
	if (steps >= COLA_VALUES_MAX)
		return false;
	identity->first_angle_rad = cola_angle_rad(start_e4);
	identity->angle_step_rad = step_deg * M_PI / 180;
	identity->beams = (uint32_t)steps + 1;
	return true;
}

/* LMPscancfg tells what the device could measure, LMPoutputRange what it sends. */
static void adopt_scan_config(struct cola *d, struct cola_cursor *c)
{
	struct lidar_identity *identity = &d->base.identity;
	uint32_t rate_e2 = cola_hex(c, 8);
	cola_skip(c, 1); /* sectors */
	if (c->bad)
		return;
	identity->scan_rate_hz = rate_e2 / 100.0;
	if (!d->has_output_range)
		adopt_angles(c, identity);
}

static void adopt_identity(struct cola *d, const char *name, struct cola_cursor *c)
{
	struct lidar_identity *identity = &d->base.identity;
	if (strcmp(name, "DeviceIdent") == 0 || strcmp(name, "0") == 0) {
		adopt_string(c, identity->model, sizeof identity->model);
		adopt_string(c, identity->firmware, sizeof identity->firmware);
	} else if (strcmp(name, "SerialNumber") == 0) {
		adopt_string(c, identity->serial, sizeof identity->serial);
	} else if (strcmp(name, "FirmwareVersion") == 0) {
		adopt_string(c, identity->firmware, sizeof identity->firmware);
	} else if (strcmp(name, "LMPscancfg") == 0) {
		adopt_scan_config(d, c);
	} else if (strcmp(name, "LMPoutputRange") == 0) {
		cola_skip(c, 1); /* sectors */
		d->has_output_range = !c->bad && adopt_angles(c, identity);
	}
}

/* Telegrams */

static bool is_text(const struct cola_cursor *c)
{
	for (const char *at = c->at; at < c->end; at++)
		if ((uint8_t)*at < ' ')
			return false;
	return true;
}

static void give_reply(struct cola *d, const char *status)
{
	struct lidar_reply reply = { d->arrival_ns, d->command->str, status, d->text->str };
	d->base.counts.replies++;
	if (d->base.sink.reply)
		d->base.sink.reply(&reply, d->base.sink.user_data);
}

static bool take_error(struct cola *d, struct cola_cursor *c)
{
	char status[9];
	g_snprintf(status, sizeof status, "%X", cola_hex(c, 8));
	if (!cola_at_end(c))
		return false;
	g_string_assign(d->command, "sFA");
	g_string_truncate(d->text, 0);
	give_reply(d, status);
	return true;
}

static bool take_reply(struct cola *d, const char *type, struct cola_cursor *c)
{
	const char *name;
	size_t length;
	if (!cola_word(c, 64, &name, &length) || !is_text(c))
		return false;
	g_string_truncate(d->command, 0);
	g_string_append_len(d->command, type, 4);
	g_string_append_len(d->command, name, (gssize)length);
	g_string_truncate(d->text, 0);
	g_string_append_len(d->text, c->at, c->end - c->at);
	if (memcmp(type, "sRA", 3) == 0)
		adopt_identity(d, d->command->str + 4, c);
	give_reply(d, "");
	return true;
}

static bool take_scan(struct cola *d, struct cola_cursor *c)
{
	struct scanline line;
	if (!cola_scan_parse(&d->scan, c, &line))
		return false;
	line.arrival_ns = d->arrival_ns;
	d->base.counts.scanlines++;
	d->base.sink.scanline(&line, d->base.sink.user_data);
	return true;
}

static bool is_answer(const char *type)
{
	static const char types[][5] = { "sRA ", "sWA ", "sAN ", "sMA ", "sEA ", "sSN " };
	for (size_t i = 0; i < G_N_ELEMENTS(types); i++)
		if (memcmp(type, types[i], 4) == 0)
			return true;
	return false;
}

static bool take_telegram(struct cola *d, const char *text, size_t length)
{
	static const char scan_name[] = "LMDscandata ";
	const size_t name_length = sizeof scan_name - 1;
	if (length < 4)
		return false;
	struct cola_cursor c = cola_cursor_of(text + 4, length - 4);
	if (memcmp(text, "sFA ", 4) == 0)
		return take_error(d, &c);
	if (!is_answer(text))
		return false;
	bool is_scan = (memcmp(text, "sSN ", 4) == 0 || memcmp(text, "sRA ", 4) == 0) &&
		       length - 4 >= name_length && memcmp(c.at, scan_name, name_length) == 0;
	c.at += is_scan ? name_length : 0;
	return is_scan ? take_scan(d, &c) : take_reply(d, text, &c);
}

/* Bytes */

static void hold(struct cola *d, const char *bytes, size_t length)
{
	if (d->held_length + length > d->held_size) {
		d->held_size = MAX(d->held_length + length, 2 * d->held_size);
		d->held = g_realloc(d->held, d->held_size);
	}
	memcpy(d->held + d->held_length, bytes, length);
	d->held_length += length;
}

static const char *find_start(struct cola *d, const char *at, const char *end)
{
	const char *start = memchr(at, COLA_STX, (size_t)(end - at));
	d->inside = start != NULL;
	d->held_length = 0;
	d->base.counts.skipped_bytes += (uint64_t)((start ? start : end) - at);
	return start ? start + 1 : end;
}

static void end_telegram(struct cola *d, const char *text, size_t length)
{
	d->inside = false;
	if (d->held_length > 0) {
		hold(d, text, length);
		text = d->held;
		length = d->held_length;
	}
	if (!take_telegram(d, text, length))
		d->base.counts.malformed++;
	d->held_length = 0;
}

/* Up to the end of the telegram, or to another STX: then its end was lost. */
static const char *find_end(struct cola *d, const char *at, const char *end)
{
	size_t room = COLA_TELEGRAM_BYTES_MAX - d->held_length;
	const char *limit = (size_t)(end - at) > room ? at + room + 1 : end;
	const char *mark = bytes_find_either(at, limit, COLA_STX, COLA_ETX);
	if (mark == limit && (size_t)(limit - at) <= room) {
		hold(d, at, (size_t)(limit - at));
		return end;
	}
	if (mark != limit && *mark == COLA_ETX) {
		end_telegram(d, at, (size_t)(mark - at));
		return mark + 1;
	}
	d->base.counts.malformed++;
	d->inside = false;
	return mark; /* an STX, or what is beyond the limit, is for find_start */
}

static void cola_feed(decoder *base, const void *bytes, size_t length, int64_t arrival_ns)
{
	struct cola *d = (struct cola *)base;
	const char *at = bytes, *end = at + length;
	d->arrival_ns = arrival_ns;
	while (at < end)
		at = d->inside ? find_end(d, at, end) : find_start(d, at, end);
}

static decoder *cola_create(void)
{
	struct cola *d = g_new0(struct cola, 1);
	d->command = g_string_new(NULL);
	d->text = g_string_new(NULL);
	return &d->base;
}

static void cola_destroy(decoder *base)
{
	struct cola *d = (struct cola *)base;
	cola_scan_clear(&d->scan);
	g_string_free(d->command, TRUE);
	g_string_free(d->text, TRUE);
	g_free(d->held);
	g_free(d);
}

const struct decoder_ops decoder_cola = { "cola", cola_create, cola_feed, cola_destroy };
