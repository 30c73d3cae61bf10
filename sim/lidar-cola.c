#include "sim/lidar-cola.h"
#include "sim/chance.h"
#include "sim/cola-telegram.h"
#include "sim/cola-text.h"
#include <math.h>
#include <string.h>

#define ANSWER_NS   INT64_C(1500000)
#define SCAN_NS     INT64_C(3900000) /* from the last beam to the first byte, and up to 0.3 ms more */
#define COMMAND_MAX 512
#define WORDS_MAX   32
#define REBOOT_S    8

#define OUTPUT_WORDS 12

struct cola {
	struct lidar_body *body;
	GString *command, *out;
	bool in_frame;
	int64_t busy_until_ns;
	unsigned access; /* user level */
	bool streaming, polled, stopped, broken;
	struct cola_output output;
	int64_t range_start, range_stop;
	uint16_t telegrams, jumped;
};

struct words {
	char *at[WORDS_MAX];
	int count;
};

static void finish(struct cola *c, int64_t now_ns)
{
	g_string_prepend_c(c->out, 2);
	g_string_append_c(c->out, 3);
	cable_answer(c->body->cable, now_ns + ANSWER_NS, c->out->str, c->out->len);
	c->busy_until_ns = MAX(c->busy_until_ns, now_ns + ANSWER_NS);
}

static void refuse(struct cola *c, enum cola_error error, int64_t now_ns)
{
	g_string_assign(c->out, "sFA");
	cola_append_number(c->out, error);
	finish(c, now_ns);
}

/* Variables: what sRN NAME answers. */
static void read_ident(struct cola *c, int64_t now_ns)
{
	(void)now_ns;
	const char *ident = c->body->options->ident;

	cola_append_string(c->out, ident ? ident : "TiM571");
	cola_append_string(c->out, "V2.61-17.11.20");
}

static void read_serial(struct cola *c, int64_t now_ns)
{
	g_autofree char *serial =
		g_strdup_printf("%08u", (unsigned)(c->body->options->seed % 100000000));

	(void)now_ns;
	cola_append_string(c->out, serial);
}

static void read_firmware(struct cola *c, int64_t now_ns)
{
	(void)now_ns;
	cola_append_string(c->out, "V2.61");
}

static void read_state(struct cola *c, int64_t now_ns)
{
	(void)now_ns;
	cola_append_number(c->out, c->broken ? 2 : c->access > 0 ? 0 : 1);
}

static void read_hours(struct cola *c, int64_t now_ns)
{
	int64_t tenths = (now_ns - c->body->clock.origin_ns) / INT64_C(360000000000);

	cola_append_number(c->out, (uint32_t)(1676 + tenths));
}

static void read_power_ons(struct cola *c, int64_t now_ns)
{
	(void)now_ns;
	cola_append_number(c->out, 121);
}

static void read_location(struct cola *c, int64_t now_ns)
{
	(void)now_ns;
	cola_append_string(c->out, "not defined");
}

static void read_range(struct cola *c, int64_t now_ns)
{
	(void)now_ns;
	cola_append_number(c->out, 1);
	cola_append_number(c->out, (uint32_t)cola_step_angle(c->body));
	cola_append_number(c->out, (uint32_t)c->range_start);
	cola_append_number(c->out, (uint32_t)c->range_stop);
}

static void read_scan_config(struct cola *c, int64_t now_ns)
{
	(void)now_ns;
	cola_append_number(c->out, (uint32_t)lround(c->body->options->rate_hz * 100));
	cola_append_number(c->out, 1);
	cola_append_number(c->out, (uint32_t)cola_step_angle(c->body));
	cola_append_number(c->out, (uint32_t)COLA_START);
	cola_append_number(c->out, COLA_STOP);
}

static void read_output(struct cola *c, int64_t now_ns)
{
	const int64_t *words = (const int64_t *)&c->output;

	(void)now_ns;
	for (int i = 0; i < OUTPUT_WORDS; i++)
		cola_append_number(c->out, (uint32_t)words[i]);
}

/* Writing: the words behind the name. */
static enum cola_error write_output(struct cola *c, const int64_t *values)
{
	struct cola_output output;

	memcpy(&output, values, sizeof output);
	if ((output.remission | output.wide | output.name | output.comment | output.time) & ~1 ||
		(output.wide && c->body->options->narrow) || output.unit != 0 ||
		output.position != 0 || output.every < 1 || output.every > 50000)
		return COLA_OUT_OF_RANGE;
	c->output = output;
	return COLA_OK;
}

static enum cola_error write_range(struct cola *c, const int64_t *values)
{
	/* Negative angles come as two's complement of 32 bits or with a sign. */
	int64_t start = (int32_t)values[2], stop = (int32_t)values[3];

	if (values[0] != 1 || values[1] != cola_step_angle(c->body) || start < COLA_START ||
		stop > COLA_STOP || start > stop)
		return COLA_OUT_OF_RANGE;
	c->range_start = start;
	c->range_stop = stop;
	return COLA_OK;
}

static enum cola_error write_dialect(struct cola *c, const int64_t *values)
{
	(void)c;
	return values[0] == 0 ? COLA_OK : COLA_OUT_OF_RANGE; /* CoLa-B is not spoken here */
}

static enum cola_error write_filter(struct cola *c, const int64_t *values)
{
	(void)c;
	return values[0] == 0 || values[0] == 1 ? COLA_OK
						: COLA_OUT_OF_RANGE; /* taken, without effect */
}

struct variable {
	const char *name;
	void (*read)(struct cola *c, int64_t now_ns);
	enum cola_error (*write)(struct cola *c, const int64_t *values);
	int values; /* that a write takes */
};

static const struct variable variables[] = {
	{ "DeviceIdent", read_ident },
	{ "SerialNumber", read_serial },
	{ "FirmwareVersion", read_firmware },
	{ "SCdevicestate", read_state },
	{ "ODoprh", read_hours },
	{ "ODpwrc", read_power_ons },
	{ "LocationName", read_location },
	{ "LMPoutputRange", read_range, write_range, 4 },
	{ "LMPscancfg", read_scan_config },
	{ "LMDscandatacfg", read_output, write_output, OUTPUT_WORDS },
	{ "EIHstCola", NULL, write_dialect, 1 },
	{ "LFPparticle", NULL, write_filter, 2 },
	{ "LFPmeanfilter", NULL, write_filter, 2 },
};

static const struct variable *find_variable(const char *name)
{
	for (gsize i = 0; i < G_N_ELEMENTS(variables); i++)
		if (strcmp(variables[i].name, name) == 0)
			return &variables[i];
	return NULL;
}

static enum cola_error parse_values(
	const struct words *w, int first, int count, int64_t *ret_values)
{
	if (w->count - first < count)
		return COLA_TOO_FEW;
	for (int i = 0; i < count; i++)
		if (!cola_parse_number(w->at[first + i], &ret_values[i]))
			return COLA_BAD_NUMBER;
	return COLA_OK;
}

static enum cola_error read_variable(struct cola *c, const struct words *w, int64_t now_ns)
{
	const struct variable *variable = find_variable(w->at[1]);

	if (strcmp(w->at[1], "LMDscandata") == 0) {
		c->polled = true; /* answered with the next scan */
		return COLA_OK;
	}
	if (!variable || !variable->read)
		return COLA_VARIABLE_UNKNOWN;
	g_string_printf(c->out, "sRA %s", w->at[1]);
	variable->read(c, now_ns);
	finish(c, now_ns);
	return COLA_OK;
}

static enum cola_error write_variable(struct cola *c, const struct words *w, int64_t now_ns)
{
	const struct variable *variable = find_variable(w->at[1]);
	int64_t values[OUTPUT_WORDS];

	if (!variable)
		return COLA_VARIABLE_UNKNOWN;
	if (!variable->write || c->access < 2)
		return COLA_WRITE_DENIED;
	enum cola_error error = parse_values(w, 2, variable->values, values);

	if (!error)
		error = variable->write(c, values);
	if (error)
		return error;
	g_string_printf(c->out, "sWA %s", w->at[1]);
	finish(c, now_ns);
	return COLA_OK;
}

static uint32_t set_access(struct cola *c, const struct words *w)
{
	static const struct {
		int64_t level, password;
	} keys[] = { { 2, 0xb21ace26 }, { 3, 0xf4724744 }, { 4, 0x81be23aa } };
	int64_t values[2];

	if (parse_values(w, 2, 2, values) != COLA_OK)
		return 0;
	for (gsize i = 0; i < G_N_ELEMENTS(keys); i++)
		if (keys[i].level == values[0] && keys[i].password == values[1]) {
			c->access = (unsigned)values[0];
			return 1;
		}
	return 0;
}

static uint32_t run(struct cola *c, const struct words *w)
{
	(void)w;
	c->access = 0;
	return 1;
}

static uint32_t start_measuring(struct cola *c, const struct words *w)
{
	(void)w;
	c->stopped = false;
	return 0;
}

static uint32_t stop_measuring(struct cola *c, const struct words *w)
{
	(void)w;
	c->stopped = true;
	return 0;
}

static uint32_t save(struct cola *c, const struct words *w)
{
	(void)c;
	(void)w;
	return 1;
}

static uint32_t reboot(struct cola *c, const struct words *w)
{
	(void)w;
	c->body->reboot_s = REBOOT_S;
	return 0;
}

struct method {
	const char *name;
	uint32_t (*call)(struct cola *c, const struct words *w);
	bool needs_login, silent; /* silent: no result */
};

static const struct method methods[] = {
	{ "SetAccessMode", set_access },
	{ "Run", run },
	{ "LMCstartmeas", start_measuring },
	{ "LMCstopmeas", stop_measuring },
	{ "mEEwriteall", save, .needs_login = true },
	{ "mSCreboot", reboot, .needs_login = true, .silent = true },
};

static enum cola_error call_method(struct cola *c, const struct words *w, int64_t now_ns)
{
	for (gsize i = 0; i < G_N_ELEMENTS(methods); i++) {
		const struct method *method = &methods[i];

		if (strcmp(method->name, w->at[1]) != 0)
			continue;
		if (method->needs_login && c->access < 2)
			return COLA_METHOD_DENIED;
		uint32_t result = method->call(c, w);

		g_string_printf(c->out, "sAN %s", method->name);
		if (!method->silent)
			cola_append_number(c->out, result);
		finish(c, now_ns);
		return COLA_OK;
	}
	return COLA_METHOD_UNKNOWN;
}

static enum cola_error subscribe(struct cola *c, const struct words *w, int64_t now_ns)
{
	int64_t on;
	enum cola_error error = parse_values(w, 2, 1, &on);

	if (strcmp(w->at[1], "LMDscandata") != 0)
		return COLA_EVENT_UNKNOWN;
	if (error || on & ~1)
		return error ? error : COLA_OUT_OF_RANGE;
	c->streaming = on;
	g_string_printf(c->out, "sEA LMDscandata %d", (int)on);
	finish(c, now_ns);
	return COLA_OK;
}

static void split(char *command, struct words *ret_words)
{
	char *rest = NULL;

	ret_words->count = 0;
	for (char *word = strtok_r(command, " ", &rest); word && ret_words->count < WORDS_MAX;
		word = strtok_r(NULL, " ", &rest))
		ret_words->at[ret_words->count++] = word;
}

static enum cola_error dispatch(struct cola *c, const struct words *w, int64_t now_ns)
{
	static const struct {
		const char *word;
		enum cola_error (*obey)(struct cola *c, const struct words *w, int64_t now_ns);
	} rows[] = { { "sRN", read_variable }, { "sWN", write_variable }, { "sMN", call_method },
		{ "sEN", subscribe } };

	for (gsize i = 0; w->count > 0 && i < G_N_ELEMENTS(rows); i++)
		if (strcmp(rows[i].word, w->at[0]) == 0)
			return w->count > 1 ? rows[i].obey(c, w, now_ns) : COLA_TOO_FEW;
	return COLA_COMMAND_UNKNOWN;
}

static void obey(struct cola *c, char *command, int64_t now_ns)
{
	struct words words;

	if (now_ns < c->busy_until_ns) {
		refuse(c, COLA_BUSY, now_ns);
		return;
	}
	if (strcmp(command, "sRI0") == 0 || strcmp(command, "sRI 0") == 0) {
		g_string_assign(c->out, "sRA 0");
		read_ident(c, now_ns);
		finish(c, now_ns);
		return;
	}
	split(command, &words);
	enum cola_error error = dispatch(c, &words, now_ns);

	if (error)
		refuse(c, error, now_ns);
}

static void receive(gpointer self, int64_t now_ns, const guint8 *bytes, gsize length)
{
	struct cola *c = self;

	for (gsize i = 0; i < length; i++) {
		if (bytes[i] == 2) {
			c->in_frame = true;
			g_string_set_size(c->command, 0);
		} else if (bytes[i] == 3 && c->in_frame) {
			c->in_frame = false;
			obey(c, c->command->str, now_ns);
		} else if (c->in_frame && c->command->len < COMMAND_MAX) {
			g_string_append_c(c->command, bytes[i] ? (char)bytes[i] : '?');
		}
	}
}

static void send_telegram(
	struct cola *c, const char *word, const struct beam_fan *fan, int64_t leaves_ns)
{
	uint32_t turns = fan->revolution - c->body->revolution_at_power_on;
	struct cola_telegram telegram = { .body = c->body,
		.output = &c->output,
		.range_start = c->range_start,
		.range_stop = c->range_stop,
		.broken = c->broken,
		.telegram_counter = ++c->telegrams,
		.scan_counter = (uint16_t)(turns + c->jumped),
		.leaves_ns = leaves_ns };

	g_string_assign(c->out, "\2");
	cola_append_telegram(c->out, word, &telegram, fan);
	g_string_append_c(c->out, 3);
	cable_telegram(c->body->cable, leaves_ns, c->out->str, c->out->len);
}

static bool stream_wants(const struct cola *c, uint32_t revolution)
{
	return c->streaming && !c->stopped &&
	       (revolution - c->body->revolution_at_power_on) % (uint32_t)c->output.every == 0;
}

static bool wants(gpointer self, uint32_t revolution)
{
	const struct cola *c = self;

	return c->polled || stream_wants(c, revolution);
}

static void send(gpointer self, const struct beam_fan *fan, int64_t now_ns)
{
	struct cola *c = self;
	uint64_t h = chance_hash(c->body->options->seed, CHANCE_CABLE, fan->revolution, 7);
	int64_t leaves_ns = now_ns + SCAN_NS + llrint(3e5 * chance_uniform(h));

	if (c->polled)
		send_telegram(c, "sRA", fan, leaves_ns);
	c->polled = false;
	if (stream_wants(c, fan->revolution))
		send_telegram(c, "sSN", fan, leaves_ns);
}

static void skip(gpointer self, uint32_t revolution)
{
	struct cola *c = self;

	if (stream_wants(c, revolution))
		c->telegrams++;
}

static bool is_waiting(gpointer self)
{
	const struct cola *c = self;

	return c->polled || (c->streaming && !c->stopped);
}

static bool is_streaming(gpointer self)
{
	const struct cola *c = self;

	return c->streaming && !c->stopped;
}

static void fail(gpointer self, int64_t now_ns)
{
	struct cola *c = self;

	(void)now_ns;
	c->broken = true;
}

static void jump(gpointer self, uint32_t counts)
{
	struct cola *c = self;

	c->jumped += (uint16_t)counts;
}

static void power_on(gpointer self)
{
	struct cola *c = self;

	c->access = 0;
	c->in_frame = c->streaming = c->polled = c->stopped = c->broken = false;
	c->busy_until_ns = INT64_MIN;
	c->output = (struct cola_output){ .low_channels = 1, .every = 1 };
	c->range_start = COLA_START;
	c->range_stop = COLA_STOP;
	c->telegrams = c->jumped = 0;
}

static gpointer create(struct lidar_body *body)
{
	struct cola *c = g_new0(struct cola, 1);
	uint64_t h = chance_hash(body->options->seed, CHANCE_CLOCK, 2, 0);

	c->body = body;
	c->command = g_string_new(NULL);
	c->out = g_string_new(NULL);
	power_on(c);
	c->telegrams = (uint16_t)h; /* it has been running for a while */
	c->jumped = (uint16_t)(h >> 16);
	return c;
}

static void destroy(gpointer self)
{
	struct cola *c = self;

	g_string_free(c->command, TRUE);
	g_string_free(c->out, TRUE);
	g_free(c);
}

const struct lidar_protocol lidar_cola = { .name = "cola",
	.nominal_tick_ns = 1e3,
	.clock_bits = 32,
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
