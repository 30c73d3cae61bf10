#include "sim/lidar-scip.h"
#include "sim/scip-text.h"
#include <math.h>
#include <string.h>

#define ANSWER_NS    INT64_C(300000)
#define SCAN_NS      INT64_C(1000000) /* from the last beam to the first byte */
#define COMMAND_MAX  96
#define DISTANCE_MIN 23
#define DISTANCE_MAX 200000

struct request {
	char kind[3];   /* MD, MS, ME; GD, GS, GE */
	char range[12]; /* the parameters up to the interval, for the echo */
	char string[18];
	unsigned characters; /* per distance */
	bool intensity;
	uint32_t first, last, cluster, interval;
	bool endless;
	uint32_t remaining;
	uint32_t next_revolution; /* wanted */
};

struct scip {
	struct lidar_body *body;
	GString *line, *out;
	bool laser, adjusting, broken, reboot_asked;
	int bit_rate, slower_percent;
	bool streaming, single;
	struct request stream, one;
};

static uint32_t last_step(const struct scip *s)
{
	return (uint32_t)s->body->options->ares * 3 / 4;
}

static int rpm(const struct scip *s)
{
	return (int)lround(s->body->options->rate_hz * 60 * (100 - s->slower_percent) / 100);
}

/* Echo and status; data lines may follow, then finish(). */
static void begin(struct scip *s, const char *echo, const char *status)
{
	g_string_assign(s->out, echo);
	g_string_append_c(s->out, '\n');
	scip_append_line(s->out, status, 2);
}

static void finish(struct scip *s, int64_t now_ns)
{
	g_string_append_c(s->out, '\n');
	cable_answer(s->body->cable, now_ns + ANSWER_NS, s->out->str, s->out->len);
}

static void answer(struct scip *s, const struct scip_command *c, const char *status, int64_t now_ns)
{
	begin(s, c->line, status);
	finish(s, now_ns);
}

static void tell_version(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	begin(s, c->line, "00");
	scip_append_property(s->out, "VEND:pleinair");
	scip_append_property(s->out, "PROD:PLEINAIR-SIM simulated scanner");
	scip_append_property(s->out, "FIRM:1.0.00(20/Nov./2026)");
	scip_append_property(s->out, "PROT:SCIP 2.0");
	scip_append_property(s->out, "SERI:S%07u", (unsigned)(s->body->options->seed % 10000000));
	finish(s, now_ns);
}

static void tell_parameters(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	unsigned ares = (unsigned)s->body->options->ares;

	begin(s, c->line, "00");
	scip_append_property(s->out, "MODL:PLEINAIR-SIM-200");
	scip_append_property(s->out, "DMIN:%d", DISTANCE_MIN);
	scip_append_property(s->out, "DMAX:%d", DISTANCE_MAX);
	scip_append_property(s->out, "ARES:%u", ares);
	scip_append_property(s->out, "AMIN:0");
	scip_append_property(s->out, "AMAX:%u", ares * 3 / 4);
	scip_append_property(s->out, "AFRT:%u", ares * 3 / 8);
	scip_append_property(s->out, "SCAN:%d", (int)lround(s->body->options->rate_hz * 60));
	finish(s, now_ns);
}

static void tell_state(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	begin(s, c->line, "00");
	scip_append_property(s->out, "MODL:PLEINAIR-SIM-200");
	scip_append_property(s->out, "LASR:%s", s->laser ? "ON" : "OFF");
	scip_append_property(
		s->out, "SCSP:%s(%d[rpm])", s->slower_percent ? "Set" : "Initial", rpm(s));
	scip_append_property(s->out, "MESM:%s", s->streaming ? "Measuring" : "Idle");
	scip_append_property(s->out, "SBPS:%d[bps]", s->bit_rate);
	scip_append_property(s->out, "TIME:%06X", device_clock_ticks(&s->body->clock, now_ns));
	scip_append_property(s->out, "STAT:%s",
		s->broken ? "Error 050 hardware trouble" : "Stable 000 no error");
	finish(s, now_ns);
}

static void stop(struct scip *s)
{
	s->laser = s->streaming = s->single = false;
}

static void laser_on(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	const char *status = s->broken ? "01" : s->laser ? "02" : "00";

	s->laser = !s->broken;
	answer(s, c, status, now_ns);
}

static void quit(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	stop(s);
	answer(s, c, "00", now_ns);
}

static void set_speed(struct scip *s, int slower_percent, int64_t now_ns)
{
	double nominal_ns = 1e9 / s->body->options->rate_hz * 100 / (100 - slower_percent);

	if (slower_percent == s->slower_percent)
		return;
	s->slower_percent = slower_percent;
	mirror_set_period(
		&s->body->mirror, now_ns, device_clock_true_ns(&s->body->clock, nominal_ns));
}

static void reset(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	stop(s);
	s->adjusting = s->broken = false;
	if (c->line[1] == 'S') { /* RT leaves the motor and the timer alone */
		set_speed(s, 0, now_ns);
		s->body->clock.origin_ns = now_ns;
		s->body->clock.start_ticks = 0;
	}
	answer(s, c, "00", now_ns);
}

static void reboot(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	bool asked = s->reboot_asked;

	answer(s, c, asked ? "00" : "01", now_ns);
	s->reboot_asked = !asked;
	if (asked)
		s->body->reboot_s = 1;
}

static void adjust_time(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	switch (scip_decimal(c, 0, 1)) {
	case 0:
		answer(s, c, s->adjusting ? "02" : "00", now_ns);
		stop(s);
		s->adjusting = true;
		break;
	case 1:
		begin(s, c->line, s->adjusting ? "00" : "04");
		if (s->adjusting) {
			g_autoptr(GString) digits = g_string_new(NULL);

			scip_append_number(digits, device_clock_ticks(&s->body->clock, now_ns), 4);
			scip_append_line(s->out, digits->str, digits->len);
		}
		finish(s, now_ns);
		break;
	case 2:
		answer(s, c, s->adjusting ? "00" : "03", now_ns);
		s->adjusting = false;
		break;
	default: answer(s, c, "01", now_ns);
	}
}

static void set_bit_rate(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	static const int rates[] = { 19200, 57600, 115200, 250000, 500000, 750000 };
	int rate = scip_decimal(c, 0, 6);
	const char *status = rate < 0 ? "01" : "02";

	for (gsize i = 0; i < G_N_ELEMENTS(rates); i++)
		if (rates[i] == rate)
			status = rate == s->bit_rate ? "03" : "00";
	if (strcmp(status, "00") == 0)
		s->bit_rate = rate;
	answer(s, c, status, now_ns);
}

static void change_speed(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	int slower = scip_decimal(c, 0, 2);

	if (slower == 99)
		slower = 0;
	const char *status = slower < 0 ? "01" : slower > 10 ? "02" : "00";

	if (slower >= 0 && slower <= 10 && slower == s->slower_percent)
		status = "03";
	if (strcmp(status, "00") == 0)
		set_speed(s, slower, now_ns);
	answer(s, c, status, now_ns);
}

/* NULL or the status that refuses the request. */
static const char *parse_request(
	const struct scip *s, const struct scip_command *c, bool stream, struct request *r)
{
	int first = scip_decimal(c, 0, 4), last = scip_decimal(c, 4, 4),
	    cluster = scip_decimal(c, 8, 2);
	int interval = stream ? scip_decimal(c, 10, 1) : 0,
	    count = stream ? scip_decimal(c, 11, 2) : 1;

	if (first < 0)
		return "01";
	if (last < 0)
		return "02";
	if (cluster < 0)
		return "03";
	if ((uint32_t)last > last_step(s))
		return "04";
	if (last < first)
		return "05";
	if (interval < 0)
		return "06";
	if (count < 0)
		return "07";
	*r = (struct request){ .characters = c->line[1] == 'S' ? 2 : 3,
		.intensity = c->line[1] == 'E',
		.first = (uint32_t)first,
		.last = (uint32_t)last,
		.cluster = (uint32_t)MAX(cluster, 1),
		.interval = (uint32_t)interval,
		.endless = stream && count == 0,
		.remaining = (uint32_t)count };
	memcpy(r->kind, c->line, 2);
	memcpy(r->range, c->parameters, stream ? 11 : 10);
	g_strlcpy(r->string, c->string, sizeof r->string);
	return NULL;
}

static void start_stream(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	struct request request;
	const char *refusal = parse_request(s, c, true, &request);

	if (!refusal && s->broken)
		refusal = "50";
	answer(s, c, refusal ? refusal : "00", now_ns);
	if (refusal)
		return;
	s->stream = request;
	s->streaming = s->laser = true;
}

static void start_single(struct scip *s, const struct scip_command *c, int64_t now_ns)
{
	struct request request;
	const char *refusal = parse_request(s, c, false, &request);

	if (!refusal && s->broken)
		refusal = "50";
	if (!refusal && !s->laser)
		refusal = "10";
	if (refusal) {
		answer(s, c, refusal, now_ns);
		return;
	}
	s->one = request;
	s->single = true;
}

struct command_row {
	char name[3];
	gsize parameters; /* characters it takes */
	void (*obey)(struct scip *s, const struct scip_command *c, int64_t now_ns);
	bool while_adjusting; /* other commands are unknown then */
};

static const struct command_row commands[] = {
	{ "VV", 0, tell_version },
	{ "PP", 0, tell_parameters },
	{ "II", 0, tell_state },
	{ "BM", 0, laser_on },
	{ "QT", 0, quit },
	{ "RS", 0, reset, true },
	{ "RT", 0, reset, true },
	{ "RB", 0, reboot, true },
	{ "TM", 1, adjust_time, true },
	{ "SS", 6, set_bit_rate },
	{ "CR", 2, change_speed },
	{ "MD", 13, start_stream },
	{ "MS", 13, start_stream },
	{ "ME", 13, start_stream },
	{ "GD", 10, start_single },
	{ "GS", 10, start_single },
	{ "GE", 10, start_single },
};

static const struct command_row *find_command(const struct scip *s, const char *line)
{
	for (gsize i = 0; i < G_N_ELEMENTS(commands); i++)
		if (strncmp(commands[i].name, line, 2) == 0)
			return s->adjusting && !commands[i].while_adjusting ? NULL : &commands[i];
	return NULL;
}

static void obey(struct scip *s, const char *line, int64_t now_ns)
{
	struct scip_command command;
	const char *refusal = scip_parse(line, &command);
	const struct command_row *row = find_command(s, line);

	if (!refusal && !row)
		refusal = "0E";
	if (!refusal && command.parameter_length < row->parameters)
		refusal = "0C";
	if (!refusal && command.parameter_length > row->parameters)
		refusal = "0D";
	if (strncmp(line, "RB", 2) != 0)
		s->reboot_asked = false;
	if (refusal)
		answer(s, &command, refusal, now_ns);
	else
		row->obey(s, &command, now_ns);
}

static void receive(gpointer self, int64_t now_ns, const guint8 *bytes, gsize length)
{
	struct scip *s = self;

	for (gsize i = 0; i < length; i++) {
		if (bytes[i] != '\n' && bytes[i] != '\r') {
			if (s->line->len < COMMAND_MAX)
				g_string_append_c(s->line, bytes[i] ? (char)bytes[i] : '?');
			continue;
		}
		if (s->line->len > 0) /* an empty line is nothing, and so CR LF is one end */
			obey(s, s->line->str, now_ns);
		g_string_set_size(s->line, 0);
	}
}

static uint32_t distance(const struct echo *echo, unsigned characters)
{
	uint32_t mm = (uint32_t)lrint(echo->range_m * 1000);

	if (echo->outcome == ECHO_WEAK)
		return 1;
	if (echo->outcome == ECHO_MIRRORED)
		return 19;
	if (echo->outcome == ECHO_NONE)
		return 0;
	if (mm < DISTANCE_MIN)
		return 7;
	return MIN(mm, characters == 2 ? 4095u : 262143u);
}

static uint32_t intensity(const struct echo *echo)
{
	double tens = echo->range_m / 10;

	if (echo->outcome != ECHO_GOOD)
		return 0;
	return (uint32_t)CLAMP(
		lrint(60000 * (double)echo->strength / (1 + tens * tens)), 1, 262143);
}

/* The nearest of a cluster speaks for it; a code does when nothing was measured. */
static void append_cluster(
	GString *data, const struct request *r, const struct beam_fan *fan, uint32_t first)
{
	uint32_t last = MIN(first + r->cluster - 1, r->last), best = first;
	uint32_t best_mm = distance(&fan->echoes[first], r->characters);

	for (uint32_t i = first + 1; i <= last; i++) {
		uint32_t mm = distance(&fan->echoes[i], r->characters);

		if (mm >= DISTANCE_MIN && (best_mm < DISTANCE_MIN || mm < best_mm)) {
			best = i;
			best_mm = mm;
		}
	}
	scip_append_number(data, best_mm, r->characters);
	if (r->intensity)
		scip_append_number(data, intensity(&fan->echoes[best]), 3);
}

static void send_scan(struct scip *s, const struct request *r, const char *echo, const char *status,
	const struct beam_fan *fan, int64_t now_ns)
{
	g_autoptr(GString) data = g_string_sized_new((gsize)fan->beams * 6);
	int64_t first_ns = mirror_first_ns(&s->body->mirror, fan->revolution);

	begin(s, echo, status);
	scip_append_number(data, device_clock_ticks(&s->body->clock, first_ns), 4);
	scip_append_line(s->out, data->str, data->len);
	g_string_set_size(data, 0);
	for (uint32_t i = r->first; i <= r->last; i += r->cluster)
		append_cluster(data, r, fan, i);
	scip_append_block(s->out, data->str, data->len);
	g_string_append_c(s->out, '\n');
	cable_telegram(s->body->cable, now_ns + SCAN_NS, s->out->str, s->out->len);
}

/* Counts a revolution of the stream, sent or lost. */
static void count_down(struct scip *s, uint32_t revolution)
{
	struct request *r = &s->stream;

	r->next_revolution = revolution + r->interval + 1;
	if (!r->endless && --r->remaining == 0)
		s->streaming = false;
}

static bool stream_wants(const struct scip *s, uint32_t revolution)
{
	return s->streaming && (int32_t)(revolution - s->stream.next_revolution) >= 0;
}

static bool wants(gpointer self, uint32_t revolution)
{
	const struct scip *s = self;

	return s->single || stream_wants(s, revolution);
}

static void send(gpointer self, const struct beam_fan *fan, int64_t now_ns)
{
	struct scip *s = self;
	struct request *r = &s->stream;

	if (s->single) {
		g_autofree char *echo =
			g_strdup_printf("%s%s%s", s->one.kind, s->one.range, s->one.string);

		send_scan(s, &s->one, echo, "00", fan, now_ns);
		s->single = false;
	}
	if (stream_wants(s, fan->revolution)) {
		count_down(s, fan->revolution);
		g_autofree char *echo =
			g_strdup_printf("%s%s%02u%s", r->kind, r->range, r->remaining, r->string);

		send_scan(s, r, echo, "99", fan, now_ns);
	}
}

static void skip(gpointer self, uint32_t revolution)
{
	struct scip *s = self;

	if (stream_wants(s, revolution))
		count_down(s, revolution);
}

static bool is_waiting(gpointer self)
{
	const struct scip *s = self;

	return s->streaming || s->single;
}

static bool is_streaming(gpointer self)
{
	const struct scip *s = self;

	return s->streaming;
}

static void fail(gpointer self, int64_t now_ns)
{
	struct scip *s = self;
	g_autofree char *echo = g_strdup_printf("%s%s%02u%s", s->stream.kind, s->stream.range,
		s->stream.remaining, s->stream.string);

	if (s->streaming) {
		begin(s, echo, "50");
		finish(s, now_ns);
	}
	stop(s);
	s->broken = true;
}

static void jump(gpointer self, uint32_t counts)
{
	(void)self;
	(void)counts; /* there is no scan counter to go wrong */
}

static void power_on(gpointer self)
{
	struct scip *s = self;

	stop(s);
	s->adjusting = s->broken = s->reboot_asked = false;
	s->bit_rate = 115200;
	set_speed(s, 0, s->body->clock.origin_ns);
	g_string_set_size(s->line, 0);
}

static gpointer create(struct lidar_body *body)
{
	struct scip *s = g_new0(struct scip, 1);

	s->body = body;
	s->line = g_string_new(NULL);
	s->out = g_string_new(NULL);
	power_on(s);
	return s;
}

static void destroy(gpointer self)
{
	struct scip *s = self;

	g_string_free(s->line, TRUE);
	g_string_free(s->out, TRUE);
	g_free(s);
}

const struct lidar_protocol lidar_scip = { .name = "scip",
	.nominal_tick_ns = 1e6,
	.clock_bits = 24,
	.create = create,
	.destroy = destroy,
	.power_on = power_on,
	.receive = receive,
	.is_waiting = is_waiting,
	.is_streaming = is_streaming,
	.wants = wants,
	.send = send,
	.skip = skip,
	.fail = fail,
	.jump = jump };
