#include "sim/beam.h"
#include "sim/chance.h"
#include <math.h>
#include <string.h>

#define PANES       4
#define MELT_M      0.4  /* two surfaces nearer than half the pulse length give one echo */
#define SAME_M      0.01 /* off the axis' plane by less: the same surface */
#define AXIS_WEIGHT 0.4
#define EDGE_WEIGHT 0.15
#define STRONG      0.01 /* signal, as strength at 30 m, from which the noise is as asked for */
#define SURE        4e-3 /* never missed from here */
#define LOST        6e-4 /* always missed below */

struct beam_touch {
	double range_m;
	double direction[3]; /* of the ray, in the world */
	float normal[3];
	float strength;
	uint8_t outcome;
};

struct sample {
	double range_m, weight, strength;
};

struct echo_sum {
	double power, range_power, strength;
};

void beam_direction(double azimuth_rad, double theta_rad, double ret_direction[3])
{
	ret_direction[0] = cos(theta_rad) * sin(azimuth_rad);
	ret_direction[1] = cos(theta_rad) * cos(azimuth_rad);
	ret_direction[2] = sin(theta_rad);
}

struct beam_fan *beam_fan_new(uint32_t beams)
{
	struct beam_fan *fan = g_new0(struct beam_fan, 1);

	fan->beams = beams;
	fan->azimuth_rad = g_new0(double, beams);
	fan->echoes = g_new0(struct echo, beams);
	fan->axis = g_new0(struct beam_touch, beams);
	return fan;
}

void beam_fan_free(struct beam_fan *fan)
{
	if (!fan)
		return;
	g_free(fan->azimuth_rad);
	g_free(fan->theta_rad);
	g_free(fan->echoes);
	g_free(fan->axis);
	g_free(fan);
}

static double dot(const float a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A pane met head-on answers itself, met at a slant lets half of the light through and back, and met
 * beyond this mirrors so much away that nothing is heard. */
#define GLASS_MIRRORS_BEYOND (50 * M_PI / 180)

/* What one surface does to the beam; true when its way ends here. */
static bool meet(const struct surface *s, double cosine, double *through, struct beam_touch *touch)
{
	if (s->optics == WORLD_GLASS && cosine < cos(GLASS_MIRRORS_BEYOND)) {
		touch->strength = 0;
		touch->outcome = ECHO_MIRRORED;
		return true;
	}
	if (s->optics == WORLD_GLASS && cosine < cos(8 * M_PI / 180)) {
		*through *= 0.5;
		return false;
	}
	if (s->optics == WORLD_GLASS)
		touch->strength = (float)(0.8 * *through);
	else if (s->optics == WORLD_WATER_SURFACE)
		touch->strength = cosine < cos(10 * M_PI / 180) ? 0 : (float)(0.03 * *through);
	else
		touch->strength = (float)(s->reflectivity * cosine * *through);
	touch->outcome = touch->strength > 0 ? ECHO_GOOD : ECHO_MIRRORED;
	return true;
}

static void trace(const struct beam_optics *o, const double from[3], const double direction[3],
	struct beam_touch *touch)
{
	double gone_m = 0, through = 1;

	*touch = (struct beam_touch){ .outcome = ECHO_NONE };
	memcpy(touch->direction, direction, sizeof touch->direction);
	for (int pane = 0; pane <= PANES; pane++) {
		struct surface s;
		double origin[3];

		for (int k = 0; k < 3; k++)
			origin[k] = from[k] + gone_m * direction[k];
		if (!world_cast(o->world, origin, direction, o->limit_m - gone_m, &s))
			break;
		touch->range_m = gone_m + s.range_m;
		memcpy(touch->normal, s.normal, sizeof touch->normal);
		if (meet(&s, fabs(dot(s.normal, direction)), &through, touch))
			return;
		gone_m = touch->range_m + 1e-3;
	}
	touch->outcome = through < 1 ? ECHO_MIRRORED : ECHO_NONE;
}

/* Do both rays end on one surface? Its plane at the axis' end tells where the other should. */
static bool same_surface(const struct beam_touch *axis, const struct beam_touch *other)
{
	if (axis->outcome != ECHO_GOOD || other->outcome != ECHO_GOOD)
		return axis->outcome == other->outcome;
	double facing = dot(axis->normal, other->direction);

	if (fabs(facing) < 1e-6)
		return false;
	double expected_m = axis->range_m * dot(axis->normal, axis->direction) / facing;

	return fabs(other->range_m - expected_m) < SAME_M + 1e-3 * fabs(expected_m - axis->range_m);
}

static void to_world(const struct beam_optics *o, const double v[3], double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = o->station.rotation[k][0] * v[0] + o->station.rotation[k][1] * v[1] +
			 o->station.rotation[k][2] * v[2];
}

/* What is fixed to the head, as the stage has turned it. */
static void turn_head(
	const struct beam_optics *o, double azimuth_rad, const double v[3], double ret[3])
{
	double s = sin(azimuth_rad + o->mount.home_rad), c = cos(azimuth_rad + o->mount.home_rad);

	ret[0] = v[1] * s + v[0] * c;
	ret[1] = v[1] * c - v[0] * s;
	ret[2] = v[2];
}

static void mounted(const struct lidar_mount *m, const double v[3], double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = m->rotation[k][0] * v[0] + m->rotation[k][1] * v[1] +
			 m->rotation[k][2] * v[2];
}

/* Casts a ray whose direction in the lidar's own frame is known. */
static void trace_at(const struct beam_optics *o, double azimuth_rad, const double lidar[3],
	struct beam_touch *touch)
{
	double head[3], scanner[3], direction[3], from[3];

	turn_head(o, azimuth_rad, o->mount.translation_m, scanner);
	to_world(o, scanner, from);
	for (int k = 0; k < 3; k++)
		from[k] += o->station.position_m[k];
	mounted(&o->mount, lidar, head);
	turn_head(o, azimuth_rad, head, scanner);
	to_world(o, scanner, direction);
	trace(o, from, direction, touch);
}

static void trace_axis(const struct beam_optics *o, const struct beam_fan *fan, uint32_t i,
	struct beam_touch *touch)
{
	double theta = beam_theta_rad(fan, i) + o->mount.beam_zero_rad;

	trace_at(o, fan->azimuth_rad[i], (const double[3]){ 0, cos(theta), sin(theta) }, touch);
}

/* A ray at the edge of the beam, `side` across its plane and `along` within it. */
static void trace_edge(const struct beam_optics *o, const struct beam_fan *fan, uint32_t i,
	int side, int along, struct beam_touch *touch)
{
	double theta =
		beam_theta_rad(fan, i) + along * o->half_divergence_rad + o->mount.beam_zero_rad;
	double lidar[3] = { side * o->half_divergence_rad, cos(theta), sin(theta) };

	for (int k = 0; k < 3; k++)
		lidar[k] /= sqrt(1 + side * side * o->half_divergence_rad * o->half_divergence_rad);
	trace_at(o, fan->azimuth_rad[i], lidar, touch);
}

static struct sample as_sample(
	const struct beam_touch *touch, const struct beam_touch *axis, double weight)
{
	struct sample sample = { touch->range_m, weight, touch->strength };

	if (same_surface(axis, touch))
		sample.range_m = axis->range_m;
	return sample;
}

static void sort(struct sample *samples, int count)
{
	for (int i = 1; i < count; i++)
		for (int j = i; j > 0 && samples[j].range_m < samples[j - 1].range_m; j--) {
			struct sample t = samples[j];

			samples[j] = samples[j - 1];
			samples[j - 1] = t;
		}
}

/* The strongest group of samples; strength 0 when there are none. */
static void melt(struct sample *samples, int count, double *ret_range_m, double *ret_strength)
{
	struct echo_sum best = { 0 }, sum = { 0 };

	sort(samples, count);
	for (int i = 0; i < count; i++) {
		const struct sample *s = &samples[i];
		double power = s->weight * s->strength / (s->range_m * s->range_m + 1e-6);

		if (i > 0 && s->range_m - samples[i - 1].range_m > MELT_M)
			sum = (struct echo_sum){ 0 };
		sum.power += power;
		sum.range_power += power * s->range_m;
		sum.strength += s->weight * s->strength;
		if (sum.power > best.power)
			best = sum;
	}
	*ret_strength = best.strength;
	*ret_range_m = best.power > 0 ? best.range_power / best.power : 0;
}

static bool lies_flat(const struct beam_fan *fan, uint32_t i, uint32_t to)
{
	return (i == 0 || same_surface(&fan->axis[i], &fan->axis[i - 1])) && i + 1 < to &&
	       same_surface(&fan->axis[i], &fan->axis[i + 1]);
}

static void receive(const struct beam_optics *o, const struct beam_fan *fan, uint32_t i,
	uint32_t to, double *ret_range_m, double *ret_strength)
{
	static const int8_t edges[4][2] = { { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 } };
	const struct beam_touch *axis = &fan->axis[i];
	struct sample samples[5];
	bool smooth = true;
	int count = 0;

	*ret_range_m = axis->range_m;
	*ret_strength = axis->outcome == ECHO_GOOD ? axis->strength : 0;
	if (o->half_divergence_rad <= 0)
		return;
	if (axis->outcome == ECHO_GOOD)
		samples[count++] = as_sample(axis, axis, AXIS_WEIGHT);
	for (int k = 0; k < 4; k++) {
		struct beam_touch edge;

		/* Most beams lie flat on something; then the two rays within the fan's plane tell
		 * nothing that the neighbours do not. */
		if (k == 2 && smooth && lies_flat(fan, i, to))
			return;
		trace_edge(o, fan, i, edges[k][0], edges[k][1], &edge);
		smooth &= same_surface(axis, &edge);
		if (edge.outcome == ECHO_GOOD)
			samples[count++] = as_sample(&edge, axis, EDGE_WEIGHT);
	}
	if (!smooth)
		melt(samples, count, ret_range_m, ret_strength);
}

static double smoothstep(double low, double high, double x)
{
	double t = CLAMP((x - low) / (high - low), 0, 1);

	return t * t * (3 - 2 * t);
}

static void detect(const struct beam_optics *o, const struct beam_fan *fan, uint32_t i, uint32_t to)
{
	const struct beam_touch *axis = &fan->axis[i];
	struct echo *echo = &fan->echoes[i];
	double range_m, strength;

	receive(o, fan, i, to, &range_m, &strength);
	double signal = strength * (30 * 30) / (range_m * range_m + 1e-6);
	double weak = signal < STRONG && signal > 0 ? fmin(2.5, sqrt(STRONG / signal)) : 1;

	*echo = (struct echo){ .strength = (float)strength,
		.true_range_m = axis->outcome == ECHO_GOOD ? axis->range_m : 0 };
	if (strength <= 0) {
		echo->outcome = axis->outcome == ECHO_GOOD ? ECHO_WEAK : axis->outcome;
		return;
	}
	if (o->dropouts && chance_uniform(chance_hash(o->seed, CHANCE_DROPOUT, fan->revolution,
				   i)) >= smoothstep(LOST, SURE, signal)) {
		echo->outcome = ECHO_WEAK;
		return;
	}
	double noise = chance_gauss(chance_hash(o->seed, CHANCE_RANGE, fan->revolution, i));

	echo->range_m = fmax(0, range_m - o->mount.range_offset_m + o->noise_m * weak * noise);
	echo->strength *= (float)(1 + 0.02 * chance_gauss(chance_hash(o->seed, CHANCE_INTENSITY,
						     fan->revolution, i)));
}

void beam_measure(
	const struct beam_optics *optics, struct beam_fan *fan, uint32_t from, uint32_t to)
{
#pragma omp parallel if (optics->threaded)
	{
#pragma omp for schedule(dynamic, 32)
		for (uint32_t i = from; i < to; i++)
			trace_axis(optics, fan, i, &fan->axis[i]);
#pragma omp for schedule(dynamic, 32)
		for (uint32_t i = from; i < to; i++)
			detect(optics, fan, i, to);
	}
}
