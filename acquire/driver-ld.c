/* LDRobot LD06, LD19, STL-27L (DEVICES 2.3): nothing can be said to them; they speak while they
 * turn, and they turn while they have power. */
#include "acquire/driver.h"
#include "acquire/line.h"
#include "acquire/turn.h"

#define MILLISECOND_NS INT64_C(1000000)
/* Two turns at the least, and some for the motor. */
#define LISTEN_NS (1500 * MILLISECOND_NS)
#define LOOK_NS   (50 * MILLISECOND_NS)

/* Only whole turns tell how fast it turns and measures; new ones, for it may have fallen silent. */
static bool turns(struct pump *p, bool *ret_there, GError **error)
{
	int64_t deadline_ns = head_now_ns(p->head) + LISTEN_NS;
	uint64_t before = stream_counts(p->stream)->revolutions;
	do {
		if (!pump_for(p, LOOK_NS, error))
			return false;
		*ret_there = stream_lidar(p->stream)->scan_rate_hz > 0 &&
			     stream_counts(p->stream)->revolutions > before;
	} while (!*ret_there && head_now_ns(p->head) < deadline_ns);
	if (*ret_there || sniff_what(&p->heard) != SNIFFED_LD)
		return true;
	g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
		"the lidar speaks, but its mirror does not turn: is its supply of 5 V strong "
		"enough, and is its PWM pin at ground?");
	return false;
}

static bool prepare(struct pump *p, GError **error)
{
	static const uint32_t speeds_baud[] = { 230400, 921600, 0 };
	return line_find(
		p, &(struct line_search){ .speeds_baud = speeds_baud, .is_there = turns }, error);
}

/* Ranges flow anyway. */
static bool start(struct pump *p, GError **error)
{
	(void)p;
	(void)error;
	return true;
}

static bool stop(struct pump *p, GError **error)
{
	(void)p;
	(void)error;
	return true;
}

/* The delay is that of a serial bridge, behind the packet's own time on the line. */
const struct driver driver_ld = {
	.protocol = "ld",
	.clock = { .ticks_hz = TURN_TICKS_HZ,
		.wrap_bits = 64,
		.delay_ns = MILLISECOND_NS,
		.drift_max_ppm = TURN_DRIFT_MAX_PPM },
	.stamp = STAMP_FIRST_BEAM,
	.bytes_per_beam = 3.9,
	.streams_always = true,
	.prepare = prepare,
	.start = start,
	.stop = stop,
};
