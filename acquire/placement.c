#include "acquire/placement.h"
#include <math.h>
#include <string.h>

/* The stage turns by less than a step between so few beams: its angle is interpolated across them.
 */
#define BEAMS_PER_KNOT 64u

/* A pass goes at a little under one column a turn. */
#define COLUMNS_PER_TURN_MAX 1.5

/* A mirror that takes longer is none; sums of times stay fit to be added. */
#define SWEEP_MAX_NS 1e12

struct placement {
	struct calibration calibration;
	/* Of the beams' directions in the head frame, for the last geometry seen. */
	uint32_t beams, room;
	double first_angle_rad, angle_step_rad;
	double (*direction)[3];
	double *head_azimuth_rad;
	float *head_elevation_rad;
	/* Results. */
	double *azimuth_rad;
	float *elevation_rad, *range_m;
	uint16_t *intensity;
	bool offset; /* the lidar's origin is not on the axis: directions depend on range */
};

placement *placement_new(const struct calibration *calibration)
{
	placement *p = g_new0(placement, 1);
	p->calibration = *calibration;
	for (int i = 0; i < 3; i++)
		p->offset |= calibration->lidar.translation_m[i] != 0;
	return p;
}

void placement_free(placement *p)
{
	if (!p)
		return;
	g_free(p->direction);
	g_free(p->head_azimuth_rad);
	g_free(p->head_elevation_rad);
	g_free(p->azimuth_rad);
	g_free(p->elevation_rad);
	g_free(p->range_m);
	g_free(p->intensity);
	g_free(p);
}

void placement_sweep(const struct scanline *line, enum stamp_instant stamp, int64_t stamp_ns,
	int64_t *ret_first_ns, int64_t *ret_last_ns)
{
	double sweep_ns = line->beam_s > 0 ? (line->beams - 1) * line->beam_s * 1e9
					   : (line->beams - 1) * fabs(line->angle_step_rad) /
						     (2 * G_PI * line->scan_rate_hz) * 1e9;
	sweep_ns = fmin(sweep_ns, SWEEP_MAX_NS);
	*ret_first_ns = stamp_ns - (stamp == STAMP_LAST_BEAM ? llround(sweep_ns) : 0);
	*ret_last_ns = *ret_first_ns + llround(sweep_ns);
}

static void grow(placement *p, uint32_t beams)
{
	p->room = beams;
	p->direction = g_realloc_n(p->direction, beams, sizeof *p->direction);
	p->head_azimuth_rad = g_renew(double, p->head_azimuth_rad, beams);
	p->head_elevation_rad = g_renew(float, p->head_elevation_rad, beams);
	p->azimuth_rad = g_renew(double, p->azimuth_rad, beams);
	p->elevation_rad = g_renew(float, p->elevation_rad, beams);
	p->range_m = g_renew(float, p->range_m, beams);
	p->intensity = g_renew(uint16_t, p->intensity, beams);
}

static void tabulate(placement *p, const struct scanline *line)
{
	const struct lidar_calibration *l = &p->calibration.lidar;
	if (line->beams > p->room)
		grow(p, line->beams);
	for (uint32_t i = 0; i < line->beams; i++) {
		double angle = line->angle_rad ? (double)line->angle_rad[i]
					       : line->first_angle_rad + i * line->angle_step_rad;
		double theta = l->beam_zero_rad + l->beam_direction * angle;
		double *d = p->direction[i];
		for (int k = 0; k < 3; k++)
			d[k] = l->rotation[k][1] * cos(theta) + l->rotation[k][2] * sin(theta);
		p->head_azimuth_rad[i] = atan2(d[0], d[1]);
		p->head_elevation_rad[i] = asin(CLAMP(d[2], -1.0, 1.0));
	}
	p->beams = line->angle_rad ? 0 : line->beams; /* angles of their own serve one line */
	p->first_angle_rad = line->first_angle_rad;
	p->angle_step_rad = line->angle_step_rad;
}

static void place_off_axis(placement *p, uint32_t i, double front_rad)
{
	double v[3], *d = p->direction[i];
	for (int k = 0; k < 3; k++)
		v[k] = d[k] * p->range_m[i] + p->calibration.lidar.translation_m[k];
	p->azimuth_rad[i] = front_rad + atan2(v[0], v[1]);
	p->elevation_rad[i] = atan2(v[2], hypot(v[0], v[1]));
	p->range_m[i] = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double wrap(double angle_rad)
{
	angle_rad -= floor(angle_rad / (2 * G_PI)) * (2 * G_PI);
	return angle_rad < 2 * G_PI ? angle_rad : 0;
}

static void place_beam(placement *p, const struct scanline *line, uint32_t i, double front_rad)
{
	bool hit = scanline_has_range(line, i);
	p->range_m[i] = hit ? line->range_mm[i] * 1e-3 + p->calibration.lidar.range_offset_m : 0;
	p->intensity[i] = line->intensity ? line->intensity[i] : 0;
	p->azimuth_rad[i] = front_rad + p->head_azimuth_rad[i];
	p->elevation_rad[i] = p->head_elevation_rad[i];
	if (hit && p->offset)
		place_off_axis(p, i, front_rad);
	p->azimuth_rad[i] = wrap(p->azimuth_rad[i]);
}

void placement_place(placement *p, const struct scanline *line, const stage_track *track,
	int64_t first_ns, int64_t last_ns, struct placed_line *ret)
{
	if (line->beams != p->beams || line->first_angle_rad != p->first_angle_rad ||
		line->angle_step_rad != p->angle_step_rad)
		tabulate(p, line);
	double zero = p->calibration.stage.azimuth_zero_rad,
	       front = stage_track_angle_rad(track, first_ns);
	*ret = (struct placed_line){ .beams = line->beams,
		.elevation_rad = p->elevation_rad,
		.azimuth_rad = p->azimuth_rad,
		.range_m = p->range_m,
		.intensity = p->intensity,
		.front_first_rad = front,
		.suspect = stage_track_is_suspect(track, first_ns) ||
			   stage_track_is_suspect(track, last_ns) };
	double beam_ns = line->beams > 1 ? (double)(last_ns - first_ns) / (line->beams - 1) : 0;
	for (uint32_t from = 0; from < line->beams; from += BEAMS_PER_KNOT) {
		uint32_t to = MIN(from + BEAMS_PER_KNOT, line->beams),
			 knot = MIN(to, line->beams - 1);
		double next = stage_track_angle_rad(track, first_ns + llround(beam_ns * knot));
		double turn_a_beam = (next - front) / MAX(knot - from, 1);
		for (uint32_t i = from; i < to; i++)
			place_beam(p, line, i, zero + front + turn_a_beam * (i - from));
		front = next;
	}
	ret->front_last_rad = front;
	double sweep_turns = (double)(last_ns - first_ns) * 1e-9 * line->scan_rate_hz;
	ret->turn_rad = sweep_turns > 0 ? (front - ret->front_first_rad) / sweep_turns : 0;
}

bool placement_is_usable(const struct placed_line *placed, uint32_t columns)
{
	return !placed->suspect &&
	       fabs(placed->turn_rad) <= COLUMNS_PER_TURN_MAX * 2 * G_PI / columns;
}
