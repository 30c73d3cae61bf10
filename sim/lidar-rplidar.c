#include "sim/lidar-rplidar.h"
#include "sim/rplidar-frames.h"
#include <math.h>
#include <string.h>

#define ANSWER_NS   INT64_C(500000)
#define LEAVES_NS   INT64_C(100000)
#define SPIN_UP_NS  INT64_C(1000000000)
#define BOOT_NS     INT64_C(500000000)
#define REQUEST_MAX 64

struct rplidar {
	struct lidar_body *body;
	guint8 request[REQUEST_MAX];
	gsize length;
	GByteArray *out;
	enum sim_format format; /* of the stream */
	bool streaming, broken;
	bool first;              /* nothing of this stream was sent yet */
	int64_t turning_from_ns; /* INT64_MAX while the motor stands */
	int64_t deaf_until_ns;
};

static void answer(struct rplidar *r, uint8_t type, int64_t now_ns)
{
	g_autoptr(GByteArray) whole = g_byte_array_new();

	rplidar_put_descriptor(whole, type, r->out->len, false);
	g_byte_array_append(whole, r->out->data, r->out->len);
	cable_answer(r->body->cable, now_ns + ANSWER_NS, whole->data, whole->len);
}

static void tell_info(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	const sim_options *o = r->body->options;

	(void)payload;
	rplidar_put_number(r->out, o->lidar->model, 1);
	rplidar_put_number(r->out, 29, 1);
	rplidar_put_number(r->out, 1, 1);
	rplidar_put_number(r->out, 7, 1);
	rplidar_put_number(r->out, o->seed, 8);
	rplidar_put_number(r->out, 0x1234, 8);
	answer(r, 0x04, now_ns);
}

static void tell_health(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	uint64_t health = r->broken ? 2 : r->body->options->health;

	(void)payload;
	rplidar_put_number(r->out, health, 1);
	rplidar_put_number(r->out, health == 2 ? 0x8001 : 0, 2);
	answer(r, 0x06, now_ns);
}

static double beat_us(const struct rplidar *r, bool standard)
{
	const sim_options *o = r->body->options;

	(void)standard; /* one beat: what the world is measured at */
	return o->sample_us;
}

static void tell_rates(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	(void)payload;
	rplidar_put_number(r->out, (uint64_t)lround(beat_us(r, true)), 2);
	rplidar_put_number(r->out, (uint64_t)lround(beat_us(r, false)), 2);
	answer(r, 0x15, now_ns);
}

static void tell_conf(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	const sim_options *o = r->body->options;
	uint32_t type = payload[0] | (uint32_t)payload[1] << 8, mode = payload[4];
	enum sim_format format = mode == 0 ? SIM_STANDARD : o->format;

	rplidar_put_number(r->out, type, 4);
	switch (type) {
	case 0x70: rplidar_put_number(r->out, 2, 2); break;
	case 0x71:
		rplidar_put_number(r->out, (uint64_t)lround(beat_us(r, mode == 0) * 256), 4);
		break;
	case 0x74: rplidar_put_number(r->out, (uint64_t)lround(o->limit_m * 256), 4); break;
	case 0x75: rplidar_put_number(r->out, rplidar_type_of(format), 1); break;
	case 0x7c: rplidar_put_number(r->out, o->format == SIM_STANDARD ? 0 : 1, 2); break;
	case 0x7f:
		g_byte_array_append(
			r->out, (const guint8 *)(mode ? "Typical" : "Standard"), mode ? 8 : 9);
		break;
	default: return; /* a question that it does not know */
	}
	answer(r, 0x20, now_ns);
}

static void tell_board(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	(void)payload;
	rplidar_put_number(r->out, r->body->options->lidar->motor == SIM_MOTOR_PWM, 4);
	answer(r, 0xff, now_ns);
}

static void begin_stream(struct rplidar *r, enum sim_format format, int64_t now_ns)
{
	const struct lidar_make *make = r->body->options->lidar;

	if (r->broken || r->body->options->health == 2)
		return;
	r->format = format;
	r->streaming = r->first = true;
	rplidar_put_descriptor(
		r->out, rplidar_type_of(format), lidar_frame_bytes(make, format), true);
	cable_answer(r->body->cable, now_ns + ANSWER_NS, r->out->data, r->out->len);
}

static void scan(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	(void)payload;
	begin_stream(r, SIM_STANDARD, now_ns);
}

static void scan_express(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	begin_stream(r, payload[0] == 0 ? SIM_EXPRESS : r->body->options->format, now_ns);
}

static void stop(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	(void)payload;
	(void)now_ns;
	r->streaming = false;
}

/* It says so, in words that no protocol knows. */
static void reset(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	static const char hello[] = "RP LIDAR System.\r\nFirmware Ver 1.29, HW Ver 7\r\n";

	(void)payload;
	r->streaming = r->broken = false;
	r->deaf_until_ns = now_ns + BOOT_NS;
	cable_answer(r->body->cable, now_ns + BOOT_NS, hello, strlen(hello));
}

static void turn(struct rplidar *r, enum sim_motor kind, bool on, int64_t now_ns)
{
	if (r->body->options->lidar->motor != kind)
		return;
	if (!on)
		r->turning_from_ns = INT64_MAX;
	else if (r->turning_from_ns == INT64_MAX)
		r->turning_from_ns = now_ns + SPIN_UP_NS;
}

static void set_pwm(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	turn(r, SIM_MOTOR_PWM, payload[0] | payload[1], now_ns);
}

static void set_rpm(struct rplidar *r, const guint8 *payload, int64_t now_ns)
{
	turn(r, SIM_MOTOR_RPM, payload[0] | payload[1], now_ns);
}

static const struct {
	uint8_t command, length; /* of the payload, at least */
	bool while_streaming;
	void (*obey)(struct rplidar *r, const guint8 *payload, int64_t now_ns);
} requests[] = {
	{ 0x20, 0, false, scan },
	{ 0x21, 0, false, scan },
	{ 0x25, 0, true, stop },
	{ 0x40, 0, true, reset },
	{ 0x50, 0, false, tell_info },
	{ 0x52, 0, false, tell_health },
	{ 0x59, 0, false, tell_rates },
	{ 0x82, 5, false, scan_express },
	{ 0x84, 4, false, tell_conf },
	{ 0xa8, 2, true, set_rpm },
	{ 0xf0, 2, true, set_pwm },
	{ 0xff, 4, false, tell_board },
};

static void obey(struct rplidar *r, int64_t now_ns)
{
	guint8 payload[REQUEST_MAX] = { 0 };
	bool has_payload = r->request[1] & 0x80;
	gsize length = has_payload ? r->request[2] : 0;

	if (now_ns < r->deaf_until_ns)
		return;
	memcpy(payload, r->request + 3, length);
	g_byte_array_set_size(r->out, 0);
	for (gsize i = 0; i < G_N_ELEMENTS(requests); i++)
		if (requests[i].command == r->request[1] && length >= requests[i].length &&
			(!r->streaming || requests[i].while_streaming))
			requests[i].obey(r, payload, now_ns);
}

/* How long the request will be, as far as one can tell by now. */
static gsize wanted(const struct rplidar *r)
{
	if (r->length < 2 || !(r->request[1] & 0x80))
		return 2;
	return r->length < 3 ? 3 : 4u + r->request[2];
}

static bool sum_is_right(const struct rplidar *r)
{
	guint8 sum = 0;

	for (gsize i = 0; i < r->length; i++)
		sum ^= r->request[i];
	return !(r->request[1] & 0x80) || sum == 0;
}

static void receive(gpointer self, int64_t now_ns, const guint8 *bytes, gsize length)
{
	struct rplidar *r = self;

	for (gsize i = 0; i < length; i++) {
		if (r->length == 0 && bytes[i] != 0xa5)
			continue;
		r->request[r->length++] = bytes[i];
		if (wanted(r) > REQUEST_MAX) {
			r->length = 0;
			continue;
		}
		if (r->length < wanted(r))
			continue;
		if (sum_is_right(r))
			obey(r, now_ns);
		r->length = 0;
	}
}

static void send(gpointer self, const struct beam_fan *fan, int64_t now_ns)
{
	struct rplidar *r = self;
	const struct mirror *mirror = &r->body->mirror;
	int64_t first_ns = mirror_first_ns(mirror, fan->revolution);

	if (first_ns < r->turning_from_ns)
		return;
	g_byte_array_set_size(r->out, 0);
	rplidar_put_portion(r->out, r->format,
		&(struct rplidar_portion){ .echoes = fan->echoes,
			.turns = r->body->encoder_turns,
			.turned_rad = r->body->turned_rad,
			.beams = fan->beams - 1,
			.first = r->first,
			.stamp_us = device_clock_ticks(&r->body->clock, first_ns),
			.beat_us = r->body->options->sample_us });
	r->first = false;
	cable_telegram(r->body->cable, now_ns + LEAVES_NS, r->out->data, r->out->len);
}

static bool is_streaming(gpointer self)
{
	const struct rplidar *r = self;

	return r->streaming && !r->body->options->stuck;
}

static bool wants(gpointer self, uint32_t portion)
{
	(void)portion;
	return is_streaming(self);
}

static void skip(gpointer self, uint32_t portion)
{
	(void)self;
	(void)portion;
}

static void fail(gpointer self, int64_t now_ns)
{
	struct rplidar *r = self;

	(void)now_ns;
	r->broken = true;
	r->streaming = false;
}

static void jump(gpointer self, uint32_t counts)
{
	(void)self;
	(void)counts; /* there is no scan counter */
}

static void set_dtr(gpointer self, int64_t now_ns, bool asserted)
{
	turn(self, SIM_MOTOR_DTR, !asserted, now_ns);
}

static double turned_rad(gpointer self, double range_m)
{
	const struct rplidar *r = self;

	return rplidar_turned_rad(r->format, range_m);
}

static void power_on(gpointer self)
{
	struct rplidar *r = self;
	enum sim_motor motor = r->body->options->lidar->motor;

	r->length = 0;
	r->streaming = r->broken = false;
	r->deaf_until_ns = INT64_MIN;
	r->turning_from_ns = motor == SIM_MOTOR_RPM ? INT64_MIN : INT64_MAX;
}

static gpointer create(struct lidar_body *body)
{
	struct rplidar *r = g_new0(struct rplidar, 1);

	r->body = body;
	r->out = g_byte_array_new();
	power_on(r);
	return r;
}

static void destroy(gpointer self)
{
	struct rplidar *r = self;

	g_byte_array_unref(r->out);
	g_free(r);
}

const struct lidar_protocol lidar_rplidar = { .name = "rplidar",
	.nominal_tick_ns = 1e3,
	.clock_bits = 32,
	.create = create,
	.destroy = destroy,
	.power_on = power_on,
	.receive = receive,
	.is_waiting = is_streaming,
	.is_streaming = is_streaming,
	.wants = wants,
	.send = send,
	.skip = skip,
	.fail = fail,
	.jump = jump,
	.set_dtr = set_dtr,
	.turned_rad = turned_rad };
