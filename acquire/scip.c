/* The SCIP 2.0 decoder: a line at a time; nothing of a telegram is kept but its digits.
 *
 *   echo LF  status sum LF  { line sum LF }  LF        LF may be CR or CRLF
 *
 * Where a line does not fit, the telegram is refused, and the decoder waits for the next line that
 * may be an echo with a true status line behind it; so a cut telegram never takes the following one
 * with it. */
#include "acquire/scip.h"
#include "acquire/bytes.h"
#include "acquire/decoder.h"
#include "acquire/scip-echo.h"
#include "acquire/scip-identity.h"
#include <math.h>

enum {
	LINE_CHARS_MAX = 1024,
	TEXT_CHARS_MAX = 16384, /* of a reply; the longest known (II, VV) have a few hundred */
	ECHOES_MAX = 4,         /* of a step; devices send up to 3 */
};

enum state { OUTSIDE, REPLY, SCAN_TIME, SCAN_VALUES, SCAN_END, REFUSED };

enum verdict { TAKEN, BAD_SUM, MALFORMED };

struct scip {
	decoder base;
	enum state state;
	int64_t arrival_ns;
	char line[LINE_CHARS_MAX]; /* the beginning of a line whose end has not come yet */
	size_t line_length;        /* may exceed what line holds; such a line is never good */
	bool after_cr;
	struct scip_echo echo;     /* of the line before, where it may be one */
	struct scip_echo telegram; /* of the telegram in work */
	char status[3];
	struct scip_parameters parameters; /* steps_per_turn is 0 until they are known */
	char *text;                        /* of a reply */
	size_t text_length;
	uint32_t time_ms, steps;
	uint8_t *digits;
	size_t digits_length, digits_size;
	uint32_t *range_mm;
	uint16_t *intensity;
	uint32_t steps_size;
};

static void refuse(struct scip *s, enum verdict why)
{
	if (why == BAD_SUM)
		s->base.counts.bad_sums++;
	else
		s->base.counts.malformed++;
	s->state = REFUSED;
}

/* Replies */

/* The sum leaves out the ';' before it; some firmware counts it in. In the time of TM1 a ';' is a
 * digit. */
static enum verdict take_text(struct scip *s, const char *line, size_t length)
{
	if (length < 2 || length > LINE_CHARS_MAX || s->text_length + length >= TEXT_CHARS_MAX)
		return MALFORMED;
	size_t chars = length - 1;
	char sum = line[chars];
	bool good = sum == scip_sum(line, chars);
	if (line[chars - 1] == ';' && !g_str_has_prefix(s->telegram.command, "TM")) {
		chars--;
		good = good || sum == scip_sum(line, chars);
	}
	if (!good)
		return BAD_SUM;
	for (size_t i = 0; i < chars; i++)
		if (!g_ascii_isprint(line[i]))
			return MALFORMED;
	if (s->text_length > 0)
		s->text[s->text_length++] = '\n';
	memcpy(s->text + s->text_length, line, chars);
	s->text_length += chars;
	return TAKEN;
}

static void finish_reply(struct scip *s)
{
	struct lidar_reply reply = { s->arrival_ns, s->telegram.command, s->status, s->text };
	s->text[s->text_length] = '\0';
	if (strcmp(s->status, "00") == 0) {
		if (strcmp(reply.command, "VV") == 0)
			scip_adopt_version(s->text, &s->base.identity);
		else if (strcmp(reply.command, "PP") == 0 &&
			 !scip_adopt_parameters(s->text, &s->parameters, &s->base.identity))
			s->base.counts.malformed++;
	}
	s->base.counts.replies++;
	if (s->base.sink.reply)
		s->base.sink.reply(&reply, s->base.sink.user_data);
}

/* Scans */

/* Room for all digits that the echo promises, and for one block too many. */
static void reserve(struct scip *s)
{
	const struct scip_layout *layout = &s->telegram.scan->layout;
	size_t chars = layout->distance_chars + (layout->intensity ? 3u : 0u);
	size_t digits =
		s->steps * (layout->echoes ? (chars + 1) * ECHOES_MAX : chars) + SCIP_BLOCK_CHARS;
	if (digits > s->digits_size) {
		s->digits = g_realloc(s->digits, digits);
		s->digits_size = digits;
	}
	if (s->steps > s->steps_size) {
		s->range_mm = g_renew(uint32_t, s->range_mm, s->steps);
		s->intensity = g_renew(uint16_t, s->intensity, s->steps);
		s->steps_size = s->steps;
	}
	s->digits_length = 0;
}

/* False for a scan that cannot be: its steps have no angles yet, or are more than a turn. */
static bool begin_scan(struct scip *s)
{
	const struct scip_echo *t = &s->telegram;
	if (s->parameters.steps_per_turn == 0 || t->start > t->end ||
		t->end - t->start > s->parameters.steps_per_turn)
		return false;
	s->steps = (t->end - t->start) / t->cluster + 1;
	reserve(s);
	return true;
}

static enum verdict take_time(struct scip *s, const char *line, size_t length)
{
	if (length != 5)
		return MALFORMED;
	s->state = SCAN_VALUES;
	return line[4] == scip_sum(line, 4) && scip_number(line, 4, &s->time_ms) ? TAKEN : BAD_SUM;
}

static enum verdict take_values(struct scip *s, const char *line, size_t length)
{
	if (length > SCIP_BLOCK_CHARS + 1 || s->digits_length + SCIP_BLOCK_CHARS > s->digits_size)
		return MALFORMED;
	if (!scip_take_block(
		    line, length, s->telegram.scan->layout.echoes, s->digits + s->digits_length))
		return BAD_SUM;
	s->digits_length += length - 1;
	if (length <= SCIP_BLOCK_CHARS)
		s->state = SCAN_END;
	return TAKEN;
}

static void finish_scan(struct scip *s)
{
	const struct scip_echo *t = &s->telegram;
	const struct scip_parameters *p = &s->parameters;
	if (!scip_decode_steps(s->digits, s->digits_length, &t->scan->layout, s->steps, s->range_mm,
		    s->intensity)) {
		refuse(s, MALFORMED);
		return;
	}
	double step_rad = 2 * M_PI / p->steps_per_turn;
	struct scanline line = {
		.arrival_ns = s->arrival_ns,
		.ticks = s->time_ms,
		.sent_ticks = s->time_ms,
		/* A cluster stands for its middle. */
		.first_angle_rad = (t->start + (t->cluster - 1) / 2.0 - p->front_step) * step_rad,
		.angle_step_rad = t->cluster * step_rad,
		.scan_rate_hz = p->turns_per_minute / 60.0,
		.beams = s->steps,
		.range_mm = s->range_mm,
		.intensity = t->scan->layout.intensity ? s->intensity : NULL,
		.range_min_mm = p->range_min_mm,
	};
	s->base.counts.scanlines++;
	s->base.sink.scanline(&line, s->base.sink.user_data);
}

/* Telegrams */

static void begin_telegram(
	struct scip *s, const struct scip_echo *echo, const char *status, size_t length)
{
	if (s->state == OUTSIDE)
		s->base.counts.skipped_bytes += echo->junk;
	else if (s->state != REFUSED)
		refuse(s, MALFORMED); /* cut off */
	s->telegram = *echo;
	memcpy(s->status, status, MIN(length, 2));
	s->status[MIN(length, 2)] = '\0';
	s->text_length = 0;
	s->state = REPLY;
	if (echo->kind == SCIP_ECHO_SCAN && strcmp(s->status, echo->scan->data_status) == 0) {
		s->state = SCAN_TIME;
		if (!begin_scan(s))
			refuse(s, MALFORMED);
	} else if (strcmp(s->status, "99") == 0) {
		refuse(s, MALFORMED); /* a scan whose echo is not right */
	}
}

static enum verdict take_line(struct scip *s, const char *line, size_t length)
{
	switch (s->state) {
	case REPLY: return take_text(s, line, length);
	case SCAN_TIME: return take_time(s, line, length);
	case SCAN_VALUES: return take_values(s, line, length);
	default: return MALFORMED; /* SCAN_END: nothing may follow a short line of values */
	}
}

/* A line outside telegrams. What comes after a certain echo should have been its status; any other
 * line may be an echo itself, and is not counted before the next one says. */
static void skip_line(struct scip *s, const struct scip_echo *before, size_t length)
{
	if (before->kind >= SCIP_ECHO_COMMAND) {
		refuse(s, length == 3 ? BAD_SUM : MALFORMED);
		return;
	}
	if (before->kind == SCIP_ECHO_OTHER)
		s->base.counts.skipped_bytes += before->bytes;
	if (s->echo.kind == SCIP_ECHO_NONE)
		s->base.counts.skipped_bytes += length + 1;
}

static void end_telegram(struct scip *s)
{
	switch (s->state) {
	case OUTSIDE:
		if (s->echo.kind != SCIP_ECHO_NONE)
			s->base.counts.skipped_bytes += s->echo.bytes;
		break;
	case REPLY: finish_reply(s); break;
	case SCAN_TIME: refuse(s, MALFORMED); break;
	case SCAN_VALUES:
	case SCAN_END: finish_scan(s); break;
	case REFUSED: break;
	}
	s->echo.kind = SCIP_ECHO_NONE;
	s->state = OUTSIDE;
}

static bool begins_here(
	const struct scip *s, const struct scip_echo *echo, const char *line, size_t length)
{
	if (scip_is_status(line, length))
		return echo->kind >= SCIP_ECHO_COMMAND ||
		       (echo->kind == SCIP_ECHO_OTHER && s->state == OUTSIDE);
	/* A device that still speaks SCIP 1.1 answers with one character and no sum. */
	return echo->kind >= SCIP_ECHO_COMMAND && s->state == OUTSIDE && length == 1 &&
	       (*line == 'E' || *line == '0');
}

static void end_line(struct scip *s, const char *line, size_t length)
{
	if (length == 0) {
		end_telegram(s);
		return;
	}
	struct scip_echo before = s->echo;
	s->echo.kind = SCIP_ECHO_NONE;
	if (begins_here(s, &before, line, length)) {
		begin_telegram(s, &before, line, length);
		return;
	}
	enum verdict verdict =
		s->state == OUTSIDE || s->state == REFUSED ? MALFORMED : take_line(s, line, length);
	if (length <= LINE_CHARS_MAX)
		scip_echo_parse(line, length, &s->echo);
	if (s->state == OUTSIDE)
		skip_line(s, &before, length);
	else if (verdict != TAKEN && s->state != REFUSED)
		refuse(s, verdict);
}

/* Bytes */

/* Whole lines of values straight from what came: their alphabet has no line end, so the sixty-sixth
 * byte decides. The last of them may still be the rest of a cut line with an echo behind it, the
 * sum right by chance. */
static const char *take_blocks(struct scip *s, const char *start, const char *end)
{
	const ptrdiff_t line_length = SCIP_BLOCK_CHARS + 1;
	const char *at = start;
	while (!s->after_cr && end - at > line_length &&
		(at[line_length] == '\n' || at[line_length] == '\r') &&
		take_values(s, at, (size_t)line_length) == TAKEN) {
		s->after_cr = at[line_length] == '\r';
		at += line_length + 1;
	}
	if (at > start)
		scip_echo_parse(at - line_length - 1, (size_t)line_length, &s->echo);
	return at;
}

static void keep(struct scip *s, const char *bytes, size_t length)
{
	if (s->line_length < sizeof s->line)
		memcpy(s->line + s->line_length, bytes,
			MIN(length, sizeof s->line - s->line_length));
	s->line_length += length;
}

/* One line, or the beginning of one. */
static const char *take_bytes(struct scip *s, const char *at, const char *end)
{
	const char *line_end = bytes_find_either(at, end, '\n', '\r');
	size_t length = (size_t)(line_end - at);
	if (s->line_length > 0 || line_end == end) {
		keep(s, at, length);
		if (line_end == end)
			return end;
		at = s->line;
		length = s->line_length;
	}
	s->line_length = 0;
	end_line(s, at, length);
	s->after_cr = *line_end == '\r';
	return line_end + 1;
}

static void scip_feed(decoder *d, const void *bytes, size_t length, int64_t arrival_ns)
{
	struct scip *s = (struct scip *)d;
	const char *at = bytes, *end = at + length;
	s->arrival_ns = arrival_ns;
	while (at < end) {
		if (s->after_cr) {
			at += *at == '\n';
			s->after_cr = false;
		} else if (s->state == SCAN_VALUES && s->line_length == 0) {
			const char *after = take_blocks(s, at, end);
			at = after > at ? after : take_bytes(s, at, end);
		} else {
			at = take_bytes(s, at, end);
		}
	}
}

static decoder *scip_create(void)
{
	struct scip *s = g_new0(struct scip, 1);
	s->text = g_malloc(TEXT_CHARS_MAX + 1);
	return &s->base;
}

static void scip_destroy(decoder *d)
{
	struct scip *s = (struct scip *)d;
	g_free(s->text);
	g_free(s->digits);
	g_free(s->range_mm);
	g_free(s->intensity);
	g_free(s);
}

const struct decoder_ops decoder_scip = { "scip", scip_create, scip_feed, scip_destroy };
