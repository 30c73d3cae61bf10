/* Slamtec RPLIDAR A, C and S (DEVICES 2.4): the dialogue. */
#include "acquire/driver.h"
#include "acquire/line.h"
#include "acquire/marks.h"
#include "acquire/rplidar-frames.h"
#include "acquire/turn.h"
#include <stdlib.h>
#include <string.h>

#define MILLISECOND_NS INT64_C(1000000)
#define ANSWER_NS      (400 * MILLISECOND_NS)
#define DRAIN_NS       (60 * MILLISECOND_NS)
#define RESET_NS       (2000 * MILLISECOND_NS)
/* From rest to a speed that holds. */
#define SPIN_UP_NS (8000 * MILLISECOND_NS)

#define SYNC             0xa5
#define SCAN             0x20
#define STOP             0x25
#define RESET            0x40
#define GET_INFO         0x50
#define GET_HEALTH       0x52
#define GET_SAMPLERATE   0x59
#define EXPRESS_SCAN     0x82
#define GET_CONF         0x84
#define MOTOR_RPM        0xa8
#define MOTOR_PWM        0xf0
#define GET_BOARD        0xff
#define CONF_ANSWER_TYPE 0x75
#define CONF_TYPICAL     0x7c
#define CONF_BEAT        0x71
#define CONF_DISTANCE    0x74

#define STANDARD_RPM 600
#define STANDARD_PWM 660
#define HEALTH_ERROR 2
/* The upper half of the model says the series. */
#define MAJOR_A2 2
#define MAJOR_C  4

static bool request(struct pump *p, uint8_t command, GError **error)
{
	return pump_send(p, (uint8_t[]){ SYNC, command }, 2, error);
}

static bool request_with(
	struct pump *p, uint8_t command, const uint8_t *payload, uint8_t length, GError **error)
{
	uint8_t bytes[3 + 8 + 1] = { SYNC, command, length }, sum = 0;
	memcpy(bytes + 3, payload, length);
	for (int i = 0; i < 3 + length; i++)
		sum ^= bytes[i];
	bytes[3 + length] = sum;
	return pump_send(p, bytes, 4u + length, error);
}

static bool is_no_answer(const GError *e)
{
	return g_error_matches(e, PUMP_ERROR, PUMP_ERROR_NO_ANSWER);
}

/* An answer that may not come, from a device that does not know the question: then *ret is NULL. */
static bool take_answer(struct pump *p, const char *name, pump_reply **ret, GError **error)
{
	g_autoptr(GError) silent = NULL;
	*ret = pump_answer(p, name, ANSWER_NS, &silent);
	if (*ret || is_no_answer(silent))
		return true;
	g_propagate_error(error, g_steal_pointer(&silent));
	return false;
}

static bool ask(struct pump *p, uint8_t command, const char *name, pump_reply **ret, GError **error)
{
	pump_clear(p);
	return request(p, command, error) && take_answer(p, name, ret, error);
}

/* The bytes of an answer stand there in hex. */
static uint32_t number_at(const pump_reply *r, size_t at, size_t bytes)
{
	uint32_t value = 0;
	if (strlen(r->text) < 2 * (at + bytes))
		return 0;
	for (size_t i = bytes; i-- > 0;) {
		const char *digits = r->text + 2 * (at + i);
		value = value << 8 | (uint32_t)(g_ascii_xdigit_value(digits[0]) << 4 |
						g_ascii_xdigit_value(digits[1]));
	}
	return value;
}

/* What a scan mode is like; false in *ret_known where the firmware has no modes (before 1.24). */
static bool ask_conf(struct pump *p, uint32_t type, uint32_t mode, size_t bytes, uint32_t *ret,
	bool *ret_known, GError **error)
{
	uint8_t payload[6] = { (uint8_t)type, 0, 0, 0, (uint8_t)mode, (uint8_t)(mode >> 8) };
	g_autoptr(pump_reply) r = NULL;
	pump_clear(p);
	if (!request_with(p, GET_CONF, payload, type == CONF_TYPICAL ? 4 : 6, error) ||
		!take_answer(p, "conf", &r, error))
		return false;
	*ret_known = r && number_at(r, 0, 4) == type && strlen(r->text) >= 2 * (4 + bytes);
	*ret = *ret_known ? number_at(r, 4, bytes) : 0;
	return true;
}

/* A device that streams says more before it falls silent. */
static bool stop_and_drain(struct pump *p, GError **error)
{
	return request(p, STOP, error) && pump_for(p, DRAIN_NS, error);
}

static bool answers(struct pump *p, bool *ret_there, GError **error)
{
	for (int tries = 0; tries < 2 && !*ret_there; tries++) {
		g_autoptr(pump_reply) r = NULL;
		if (!stop_and_drain(p, error) || !ask(p, GET_INFO, "info", &r, error))
			return false;
		*ret_there = r != NULL;
	}
	return true;
}

static bool ask_health(struct pump *p, uint32_t *ret_status, uint32_t *ret_code, GError **error)
{
	g_autoptr(pump_reply) r = NULL;
	if (!ask(p, GET_HEALTH, "health", &r, error))
		return false;
	*ret_status = r ? number_at(r, 0, 1) : 0;
	*ret_code = r ? number_at(r, 1, 2) : 0;
	return true;
}

/* A device that protects itself may be well after a reset. What it says while it starts, or at
 * another speed, goes by. */
static bool check_health(struct pump *p, GError **error)
{
	uint32_t status, code;
	bool there = false;
	if (!ask_health(p, &status, &code, error))
		return false;
	if (status != HEALTH_ERROR)
		return true;
	if (!request(p, RESET, error) || !pump_for(p, RESET_NS, error) ||
		!answers(p, &there, error) || !ask_health(p, &status, &code, error))
		return false;
	if (there && status != HEALTH_ERROR)
		return true;
	g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
		"the lidar says that it is broken (health 2, error %04x), after a reset too: turn "
		"its power off and on; if that does not help it needs repair",
		code);
	return false;
}

static bool turn_motor_by_dtr(struct pump *p, bool on, GError **error)
{
	struct wire_line line = { .baud = p->line.baud, .dtr = !on };
	return wire_set_line(p->head->lidar, &line, error);
}

/* The motor: of an A1 it hangs on DTR; an A2 or A3 has it on a board of its own; others turn by
 * themselves and can be told how fast. */
static bool turn_motor(struct pump *p, bool on, GError **error)
{
	uint32_t rpm = on ? STANDARD_RPM : 0, pwm = on ? STANDARD_PWM : 0;
	uint8_t none[4] = { 0 };
	g_autoptr(pump_reply) info = NULL, board = NULL;
	if (!ask(p, GET_INFO, "info", &info, error) || !info)
		return info || !(error && *error);
	uint32_t major = number_at(info, 0, 1) >> 4;
	if (major >= MAJOR_C)
		return request_with(
			p, MOTOR_RPM, (uint8_t[]){ (uint8_t)rpm, (uint8_t)(rpm >> 8) }, 2, error);
	if (major < MAJOR_A2)
		return turn_motor_by_dtr(p, on, error);
	pump_clear(p);
	if (!request_with(p, GET_BOARD, none, 4, error) || !take_answer(p, "board", &board, error))
		return false;
	return !board || !(number_at(board, 0, 4) & 1) ||
	       request_with(
		       p, MOTOR_PWM, (uint8_t[]){ (uint8_t)pwm, (uint8_t)(pwm >> 8) }, 2, error);
}

/* The mode that the device itself finds the best for most places, where its format is known. */
static bool request_scan(struct pump *p, GError **error)
{
	uint32_t mode, type, ignored;
	bool known;
	g_autoptr(pump_reply) rates = NULL;
	if (!ask_conf(p, CONF_TYPICAL, 0, 2, &mode, &known, error))
		return false;
	if (!known)
		return ask(p, GET_SAMPLERATE, "samplerate", &rates, error) &&
		       request(p, SCAN, error);
	if (!ask_conf(p, CONF_ANSWER_TYPE, mode, 1, &type, &known, error) ||
		!ask_conf(p, CONF_DISTANCE, mode, 4, &ignored, &known, error))
		return false;
	bool express = false;
	for (int f = RPLIDAR_EXPRESS; f < RPLIDAR_FORMATS; f++)
		express |= rplidar_answer_type((enum rplidar_format)f) == type;
	if (!ask_conf(p, CONF_BEAT, express ? mode : 0, 4, &ignored, &known, error))
		return false;
	return express ? request_with(p, EXPRESS_SCAN, (uint8_t[]){ (uint8_t)mode, 0, 0, 0, 0 }, 5,
				 error)
		       : request(p, SCAN, error);
}

/* Until whole turns come. */
static bool await_turns(struct pump *p, GError **error)
{
	int64_t deadline_ns = head_now_ns(p->head) + SPIN_UP_NS;
	uint64_t before = stream_counts(p->stream)->revolutions;
	while (head_now_ns(p->head) < deadline_ns) {
		if (!pump_for(p, 50 * MILLISECOND_NS, error))
			return false;
		if (stream_counts(p->stream)->revolutions >= before + 3)
			return true;
	}
	g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
		"the lidar answers, but its mirror does not turn: does its motor have power, and "
		"does nothing hold it?");
	return false;
}

static bool start(struct pump *p, GError **error)
{
	return turn_motor(p, true, error) && request_scan(p, error) && await_turns(p, error);
}

static bool stop(struct pump *p, GError **error)
{
	return stop_and_drain(p, error) && turn_motor(p, false, error);
}

/* Scans for a moment: only turns tell how fast it turns. The motor is left on. */
static bool prepare(struct pump *p, GError **error)
{
	static const uint32_t speeds_baud[] = { 115200, 256000, 460800, 1000000, 0 };
	g_autofree char *pause = mark_pause_text();
	return line_find(p,
		       &(struct line_search){ .speeds_baud = speeds_baud, .is_there = answers },
		       error) &&
	       check_health(p, error) && start(p, error) && stop_and_drain(p, error) &&
	       pump_mark(p, pause, error);
}

/* The delay is that of a serial bridge, behind the frame's own time on the line. */
const struct driver driver_rplidar = {
	.protocol = "rplidar",
	.clock = { .ticks_hz = TURN_TICKS_HZ,
		.wrap_bits = 64,
		.delay_ns = MILLISECOND_NS,
		.drift_max_ppm = TURN_DRIFT_MAX_PPM },
	.stamp = STAMP_FIRST_BEAM,
	.bytes_per_beam = 2.4,
	.prepare = prepare,
	.start = start,
	.stop = stop,
};
