/* Hokuyo SCIP 2.0 (DEVICES 2.2): the dialogue. */
#include "acquire/driver.h"
#include "acquire/line.h"
#include "acquire/pump.h"
#include "acquire/scip.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MILLISECOND_NS INT64_C(1000000)
#define ANSWER_NS      (1000 * MILLISECOND_NS)
/* Enough exchanges that their bounds on the offset, cut by the 1 ms ticks in different phases,
 * close to some 0.1 ms. */
#define CLOCK_EXCHANGES 24

static pump_reply *ask(struct pump *p, const char *command, GError **error)
{
	g_autofree char *line = g_strconcat(command, "\n", NULL);
	pump_clear(p);
	return pump_send(p, line, strlen(line), error) ? pump_answer(p, command, ANSWER_NS, error)
						       : NULL;
}

/* Asks; statuses other than 00 and the benign ones ("02 04") are refusals. */
static bool order(struct pump *p, const char *command, const char *benign, GError **error)
{
	g_autoptr(pump_reply) r = ask(p, command, error);
	if (!r)
		return false;
	if (strcmp(r->status, "00") == 0 || (strlen(r->status) == 2 && strstr(benign, r->status)))
		return true;
	g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED, "the lidar refuses '%s' with status %s",
		command, r->status);
	return false;
}

/* A device may be streaming, comparing clocks or half-way through a line: QT gets it out of the
 * first, TM2 out of the second, an empty line out of the third. */
static bool wake(struct pump *p, GError **error)
{
	static const char *const means[] = { "\n", "TM2\n", "SCIP2.0\n" };
	for (size_t i = 0; i < G_N_ELEMENTS(means); i++) {
		g_autoptr(GError) silent = NULL;
		if (!pump_send(p, means[i], strlen(means[i]), error) ||
			!pump_for(p, 140 * MILLISECOND_NS, error))
			return false;
		if (order(p, "QT", "", &silent))
			return true;
		if (!g_error_matches(silent, PUMP_ERROR, PUMP_ERROR_NO_ANSWER) &&
			!g_error_matches(silent, PUMP_ERROR, PUMP_ERROR_REFUSED)) {
			g_propagate_error(error, g_steal_pointer(&silent));
			return false;
		}
	}
	return line_complain(p,
		"the lidar is silent: is it a Hokuyo (SCIP) device, and does it have power?",
		error);
}

/* The state in the device's own words, NULL when it is well. */
static bool ask_state(struct pump *p, char **ret_complaint, GError **error)
{
	static const char *const healthy[] = { "no error", "works well", "working normally" };
	g_autoptr(pump_reply) r = ask(p, "II", error);
	if (!r)
		return false;
	const char *state = strstr(r->text, "STAT:");
	*ret_complaint = g_strdup(state ? state + strlen("STAT:") : "no state");
	for (size_t i = 0; state && i < G_N_ELEMENTS(healthy); i++)
		if (strstr(state, healthy[i]))
			g_clear_pointer(ret_complaint, g_free);
	return true;
}

/* A device that is not well may be so again after a reset. */
static bool check_health(struct pump *p, GError **error)
{
	g_autofree char *complaint = NULL, *still = NULL;
	if (!ask_state(p, &complaint, error))
		return false;
	if (!complaint)
		return true;
	/* RS sets the device's timer back as well: opening anew tells the clock model so. */
	if (!order(p, "RS", "", error) || !pump_open_lidar(p, error) ||
		!pump_for(p, 1000 * MILLISECOND_NS, error) || !ask_state(p, &still, error))
		return false;
	if (still)
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
			"the lidar says that it is not well: %s", still);
	return !still;
}

/* Questions at uneven distances, so that they meet the millisecond ticks in all phases. */
static bool compare_clocks(struct pump *p, GError **error)
{
	if (!order(p, "TM0", "02", error))
		return false;
	for (int i = 0; i < CLOCK_EXCHANGES; i++)
		if (!order(p, "TM1", "", error) ||
			!pump_for(p, (3 + (i * 7) % 10) * MILLISECOND_NS + i * 137000, error))
			return false;
	return order(p, "TM2", "03", error);
}

static bool prepare(struct pump *p, GError **error)
{
	return wake(p, error) && order(p, "VV", "", error) && order(p, "PP", "", error) &&
	       check_health(p, error) && compare_clocks(p, error);
}

static long parameter(const char *text, const char *key)
{
	const char *at = strstr(text, key);
	return at ? strtol(at + strlen(key), NULL, 10) : -1;
}

/* Ranges with intensity where the device has it, ranges alone otherwise. */
static bool start(struct pump *p, GError **error)
{
	g_autoptr(pump_reply) r = ask(p, "PP", error);
	if (!r)
		return false;
	long first = parameter(r->text, "AMIN:"), last = parameter(r->text, "AMAX:");
	if (first < 0 || last <= first || last > 9999) {
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
			"the lidar tells no sensible range of angles: %s", r->text);
		return false;
	}
	if (!order(p, "BM", "02", error)) {
		g_prefix_error(error, "the laser does not come on: ");
		return false;
	}
	g_autofree char *with = g_strdup_printf("ME%04ld%04ld00000", first, last);
	g_autofree char *without = g_strdup_printf("MD%04ld%04ld00000", first, last);
	g_autoptr(GError) refused = NULL;
	if (order(p, with, "99", &refused))
		return true;
	if (g_error_matches(refused, PUMP_ERROR, PUMP_ERROR_REFUSED))
		return order(p, without, "99", error);
	g_propagate_error(error, g_steal_pointer(&refused));
	return false;
}

static bool stop(struct pump *p, GError **error)
{
	return order(p, "QT", "", error);
}

/* TM1 answers with the time in four characters of six bits. */
static bool clock_reply(const struct lidar_reply *reply, uint64_t *ret_ticks)
{
	uint32_t ms;
	if (strcmp(reply->command, "TM1") != 0 || strcmp(reply->status, "00") != 0 ||
		strlen(reply->text) != 4 || !scip_number(reply->text, 4, &ms))
		return false;
	*ret_ticks = ms;
	return true;
}

static bool asks_clock(const void *bytes, size_t length)
{
	return length == 4 && memcmp(bytes, "TM1\n", 4) == 0;
}

/* The delay, for a device that refuses to compare clocks: the sweep of three quarters of a turn at
 * 40 Hz and some 2 ms. */
const struct driver driver_scip = {
	.protocol = "scip",
	.clock = { .ticks_hz = 1000,
		.wrap_bits = 24,
		.delay_ns = 21 * MILLISECOND_NS,
		.truncates = true },
	.stamp = STAMP_FIRST_BEAM,
	.bytes_per_beam = 6.2,
	.prepare = prepare,
	.start = start,
	.stop = stop,
	.clock_reply = clock_reply,
	.asks_clock = asks_clock,
};
