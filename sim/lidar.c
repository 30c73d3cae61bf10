#include "sim/lidar.h"
#include "sim/chance.h"
#include "sim/lidar-cola.h"
#include "sim/lidar-ld.h"
#include "sim/lidar-rplidar.h"
#include "sim/lidar-scip.h"
#include <math.h>
#include <string.h>

/* Motors wander: by so much of their speed, so often. */
#define WANDER    0.004
#define WANDER_HZ 0.37
/* A range that turns a beam about as much as most do. */
#define USUAL_M  6
#define SETTLING 4

struct lidar {
	struct lidar_setup setup;
	const struct lidar_protocol *protocol;
	gpointer self;
	struct lidar_body body;
	struct beam_optics optics;
	struct beam_fan *fan;
	uint32_t next;     /* the first revolution that was not dealt with */
	uint32_t measured; /* beams of it */
	uint32_t drop_left, codes_left, codes_beams;
	/* The beam behind a portion is the first of the next. */
	struct echo ahead;
	double ahead_theta_rad, ahead_turned_rad;
	uint32_t ahead_of; /* that next one */
	bool has_ahead;
	int64_t powered_ns; /* as the cable told last */
};

static double from_seed(const sim_options *o, uint64_t what, double low, double high)
{
	return low + (high - low) * chance_uniform(chance_hash(o->seed, CHANCE_CLOCK, 1, what));
}

static void set_up_clock(lidar *l)
{
	const sim_options *o = l->setup.options;
	double wrap = ldexp(1, (int)l->protocol->clock_bits);

	l->body.clock = (struct device_clock){ .origin_ns = l->setup.now_ns,
		.tick_ns = l->protocol->nominal_tick_ns,
		.bits = l->protocol->clock_bits,
		.drift_ppm = isnan(o->drift_ppm) ? from_seed(o, 0, -50, 50) : o->drift_ppm,
		.start_ticks = o->clock_start == UINT64_MAX ? (uint64_t)from_seed(o, 1, 0, wrap)
							    : o->clock_start };
}

/* A portion is what the mirror's turn is to others; one beam more is measured, which some need. */
static void set_up_portions(lidar *l)
{
	const sim_options *o = l->setup.options;

	l->body.mirror = (struct mirror){ .epoch_ns = l->setup.now_ns,
		.period_ns = device_clock_true_ns(&l->body.clock, o->sample_us * 1e3 * o->portion),
		.beams_per_turn = o->portion,
		.beams = o->portion + 1 };
	l->body.turn_ns = 1e9 / o->rate_hz;
	l->fan = beam_fan_new(o->portion + 1);
	l->fan->theta_rad = g_new0(double, o->portion + 1);
	l->body.encoder_turns = g_new0(double, o->portion + 1);
	l->body.turned_rad = g_new0(double, o->portion + 1);
}

static void set_up_mirror(lidar *l)
{
	const sim_options *o = l->setup.options;

	if (o->portion > 0) {
		set_up_portions(l);
		return;
	}
	bool scip = l->protocol == &lidar_scip;
	double period_ns = device_clock_true_ns(&l->body.clock, 1e9 / o->rate_hz);
	uint32_t beams = (uint32_t)(scip ? o->ares * 3 / 4 + 1 : o->beams);

	l->body.mirror = (struct mirror){
		.epoch_ns = l->setup.now_ns - llrint(period_ns * chance_uniform(chance_hash(o->seed,
									 CHANCE_MIRROR, 0, 0))),
		.period_ns = period_ns,
		.beams_per_turn = scip ? (double)o->ares : (double)(o->beams - 1) * 4 / 3,
		.beams = beams
	};
	l->fan = beam_fan_new(beams);
	l->fan->theta_step_rad = 2 * M_PI / l->body.mirror.beams_per_turn;
	l->fan->first_theta_rad = -M_PI / 4;
}

static void set_up_optics(lidar *l)
{
	const sim_options *o = l->setup.options;

	l->optics = (struct beam_optics){ .mount = lidar_mount_of(o),
		.world = l->setup.world,
		.station = l->setup.station,
		.half_divergence_rad = o->divergence_mrad * 0.5e-3,
		.noise_m = o->noise_mm * 1e-3,
		.limit_m = o->limit_m,
		.dropouts = o->dropouts,
		.threaded =
			o->speed == 0 &&
			l->fan->beams > 200, /* in real time, waiting for a late thread is worse */
		.seed = o->seed };
}

static const struct lidar_protocol *protocol_of(const char *name)
{
	static const struct lidar_protocol *const protocols[] = { &lidar_scip, &lidar_cola,
		&lidar_ld, &lidar_rplidar };
	gsize i = 0;

	while (strcmp(protocols[i]->name, name) != 0)
		i++;
	return protocols[i];
}

lidar *lidar_new(const struct lidar_setup *setup)
{
	const sim_options *o = setup->options;
	lidar *l = g_new0(lidar, 1);

	l->setup = *setup;
	l->protocol = protocol_of(o->lidar->protocol);
	l->body.options = o;
	l->body.cable =
		cable_new(&(struct cable_desc){ .seed = o->seed,
				  .latency_ns = o->latency_ms * 1e6,
				  .jitter_ns = o->jitter_ms * 1e6,
				  .packet = o->packet,
				  .absent = o->lidar->absent,
				  .baud = (uint32_t)o->baud,
				  .frame = o->baud ? lidar_frame_bytes(o->lidar, o->format) : 0 },
			setup->out);
	set_up_clock(l);
	set_up_mirror(l);
	set_up_optics(l);
	l->powered_ns = cable_powered_ns(l->body.cable);
	l->self = l->protocol->create(&l->body);
	return l;
}

void lidar_free(lidar *l)
{
	if (!l)
		return;
	l->protocol->destroy(l->self);
	cable_free(l->body.cable);
	beam_fan_free(l->fan);
	g_free(l->body.encoder_turns);
	g_free(l->body.turned_rad);
	g_free(l);
}

/* A lidar that was without power begins anew: settings, counters and clock. */
static void notice_power_on(lidar *l, int64_t now_ns)
{
	int64_t powered_ns = cable_powered_ns(l->body.cable);

	if (powered_ns == l->powered_ns || powered_ns > now_ns)
		return;
	l->powered_ns = powered_ns;
	l->body.clock.origin_ns = powered_ns;
	l->body.clock.start_ticks = 0;
	l->body.revolution_at_power_on = mirror_after(&l->body.mirror, powered_ns);
	l->protocol->power_on(l->self);
}

static void begin_revolution(lidar *l, uint32_t revolution)
{
	l->next = revolution;
	l->measured = 0;
}

void lidar_open(lidar *l, int64_t now_ns)
{
	notice_power_on(l, now_ns);
	cable_open(l->body.cable, now_ns);
	begin_revolution(l, mirror_after(&l->body.mirror, now_ns));
}

void lidar_close(lidar *l)
{
	cable_close(l->body.cable);
}

void lidar_set_line(lidar *l, int64_t now_ns, const struct link_line *line)
{
	cable_set_line(l->body.cable, line->baud);
	if (l->protocol->set_dtr)
		l->protocol->set_dtr(l->self, now_ns, line->dtr);
}

void lidar_write(lidar *l, int64_t now_ns, const guint8 *bytes, gsize length)
{
	if (!cable_is_open(l->body.cable) || !cable_is_clear(l->body.cable))
		return;
	bool waited = l->protocol->is_waiting(l->self);

	l->protocol->receive(l->self, now_ns, bytes, length);
	if (!waited || mirror_first_ns(&l->body.mirror, l->next) < l->body.mirror.epoch_ns)
		begin_revolution(l, mirror_after(&l->body.mirror, now_ns));
	if (l->body.reboot_s > 0) {
		cable_unplug(l->body.cable, now_ns, l->body.reboot_s);
		l->body.reboot_s = 0;
	}
}

int64_t lidar_next_ns(const lidar *l)
{
	if (!cable_is_open(l->body.cable) || !l->protocol->is_waiting(l->self))
		return INT64_MAX;
	return mirror_last_ns(&l->body.mirror, l->next) + l->setup.settle_ns;
}

bool lidar_passes(const lidar *l, double *ret_from_rad, double *ret_to_rad)
{
	int64_t last_ns = mirror_last_ns(&l->body.mirror, l->next);

	if (!l->protocol->is_streaming(l->self))
		return false;
	*ret_from_rad = stage_azimuth_rad(l->setup.stage, last_ns, -l->body.mirror.period_ns);
	*ret_to_rad = stage_azimuth_rad(l->setup.stage, last_ns, 0);
	return true;
}

/* A fault of a revolution takes as many portions as there are in one. */
static uint32_t portions_of_turn(const lidar *l)
{
	return l->fan->theta_rad ? (uint32_t)lround(l->body.turn_ns / l->body.mirror.period_ns) : 1;
}

void lidar_strike(lidar *l, int64_t now_ns, const struct fault *fault)
{
	cable *c = l->body.cable;

	switch (fault->kind) {
	case FAULT_DROP: l->drop_left = fault->count * portions_of_turn(l); break;
	case FAULT_STALL: cable_silence(c, now_ns, fault->param); break;
	case FAULT_GARBLE: cable_garble(c, fault->count); break;
	case FAULT_SPLIT: cable_split(c, (gsize)fault->param); break;
	case FAULT_MERGE: cable_merge(c, fault->count); break;
	case FAULT_JUMP: l->protocol->jump(l->self, (uint32_t)fault->param); break;
	case FAULT_ERROR: l->protocol->fail(l->self, now_ns); break;
	case FAULT_UNPLUG: cable_unplug_in_telegram(c, fault->param); break;
	case FAULT_CODES:
		l->codes_left = fault->count;
		l->codes_beams = (uint32_t)fault->param;
		break;
	default: g_assert_not_reached();
	}
}

/* Turns of the encoder since power-on. */
static double encoder_turns(const lidar *l, int64_t base_ns, double after_ns)
{
	double since_ns =
		l->setup.options->stuck ? 0 : (double)(base_ns - l->setup.now_ns) + after_ns;
	double wander = 2 * M_PI * WANDER_HZ * since_ns * 1e-9;

	return since_ns / l->body.turn_ns +
	       WANDER * 1e9 / l->body.turn_ns / (2 * M_PI * WANDER_HZ) * sin(wander);
}

static void point_beam(lidar *l, uint32_t i, double turned_rad)
{
	l->body.turned_rad[i] = turned_rad;
	l->fan->theta_rad[i] = M_PI / 2 - 2 * M_PI * l->body.encoder_turns[i] + turned_rad;
}

/* Where a beam of such a lidar goes depends on what it reads there. What does not agree with itself
 * after a few tries, at edges, is no echo. */
static void settle_beams(lidar *l)
{
	struct beam_fan *fan = l->fan;

	for (int tries = 0; tries < SETTLING; tries++) {
		uint32_t changed = 0;

		for (uint32_t i = 0; i < fan->beams; i++) {
			double turned = l->protocol->turned_rad(l->self, fan->echoes[i].range_m);

			if (fan->echoes[i].outcome != ECHO_GOOD || turned == l->body.turned_rad[i])
				continue;
			changed++;
			point_beam(l, i, turned);
			if (tries == SETTLING - 1)
				fan->echoes[i].outcome = ECHO_WEAK;
		}
		if (!changed || tries == SETTLING - 1)
			return;
		beam_measure(&l->optics, fan, 0, fan->beams);
	}
}

static void measure_portion(lidar *l)
{
	struct beam_fan *fan = l->fan;
	uint32_t known = l->has_ahead && l->ahead_of == l->next;
	int64_t first_ns = mirror_first_ns(&l->body.mirror, l->next);
	double period_ns = mirror_beam_period_ns(&l->body.mirror);

	fan->revolution = l->next;
	for (uint32_t i = 0; i < fan->beams; i++) {
		fan->azimuth_rad[i] = stage_azimuth_rad(l->setup.stage, first_ns, i * period_ns);
		l->body.encoder_turns[i] = encoder_turns(l, first_ns, i * period_ns);
		point_beam(l, i,
			l->protocol->turned_rad ? l->protocol->turned_rad(l->self, USUAL_M) : 0);
	}
	beam_measure(&l->optics, fan, 0, fan->beams);
	if (l->protocol->turned_rad)
		settle_beams(l);
	if (known) {
		fan->echoes[0] = l->ahead;
		fan->theta_rad[0] = l->ahead_theta_rad;
		l->body.turned_rad[0] = l->ahead_turned_rad;
	}
	l->ahead = fan->echoes[fan->beams - 1];
	l->ahead_theta_rad = fan->theta_rad[fan->beams - 1];
	l->ahead_turned_rad = l->body.turned_rad[fan->beams - 1];
	l->ahead_of = l->next + 1;
	l->has_ahead = true;
	l->measured = fan->beams;
}

static void measure(lidar *l, uint32_t to)
{
	if (l->fan->theta_rad) {
		measure_portion(l);
		return;
	}
	int64_t first_ns = mirror_first_ns(&l->body.mirror, l->next);
	double period_ns = mirror_beam_period_ns(&l->body.mirror);

	l->fan->revolution = l->next;
	for (uint32_t i = l->measured; i < to; i++)
		l->fan->azimuth_rad[i] = stage_azimuth_rad(l->setup.stage, first_ns, i * period_ns);
	beam_measure(&l->optics, l->fan, l->measured, to);
	l->measured = to;
}

static void tell_truth(lidar *l)
{
	const struct beam_fan *fan = l->fan;
	uint32_t beams = fan->theta_rad ? fan->beams - 1 : fan->beams;
	g_autofree double *azimuth = g_new(double, beams);
	g_autofree double *theta = g_new(double, beams);
	g_autofree double *range = g_new(double, beams);

	for (uint32_t i = 0; i < beams; i++) {
		theta[i] = beam_theta_rad(fan, i);
		azimuth[i] =
			fan->azimuth_rad[i] - 2 * M_PI * floor(fan->azimuth_rad[i] / (2 * M_PI));
		range[i] = fan->echoes[i].true_range_m;
	}
	l->setup.truth(&(struct sim_truth_revolution){ .revolution = l->next,
			       .beams = beams,
			       .first_beam_host_ns = mirror_first_ns(&l->body.mirror, l->next),
			       .beam_period_ns = mirror_beam_period_ns(&l->body.mirror),
			       .azimuth_rad = azimuth,
			       .theta_rad = theta,
			       .range_m = range },
		l->setup.truth_data);
}

static void blank_a_stretch(lidar *l)
{
	uint64_t h = chance_hash(l->setup.options->seed, CHANCE_CODE, l->next, 0);
	uint32_t beams = MIN(l->codes_beams, l->fan->beams);
	uint32_t first = (uint32_t)(h % (l->fan->beams - beams + 1));

	l->codes_left--;
	for (uint32_t i = first; i < first + beams; i++) {
		l->fan->echoes[i].outcome = ECHO_WEAK;
		l->fan->echoes[i].range_m = 0;
	}
}

void lidar_run(lidar *l, int64_t now_ns)
{
	uint32_t revolution = l->next;

	if (!l->protocol->is_waiting(l->self) || !l->protocol->wants(l->self, revolution)) {
		begin_revolution(l, revolution + 1);
		return;
	}
	if (l->drop_left > 0) {
		l->drop_left--;
		l->protocol->skip(l->self, revolution);
	} else {
		measure(l, l->fan->beams);
		if (l->codes_left > 0)
			blank_a_stretch(l);
		if (l->setup.truth)
			tell_truth(l);
		l->protocol->send(l->self, l->fan, now_ns);
	}
	begin_revolution(l, revolution + 1);
}

bool lidar_prepare(lidar *l, int64_t now_ns, uint32_t beams)
{
	if (l->fan->theta_rad || lidar_next_ns(l) == INT64_MAX ||
		!l->protocol->wants(l->self, l->next))
		return false;
	double passed = (double)(now_ns - mirror_first_ns(&l->body.mirror, l->next));
	double swept = CLAMP(passed / mirror_beam_period_ns(&l->body.mirror), 0, l->fan->beams);

	if (swept < l->measured + beams)
		return false;
	measure(l, l->measured + beams);
	return true;
}
