#include "process/two-face-patch.h"
#include "process/normal-equations.h"
#include <math.h>
#include <string.h>

#define DEGREE     (G_PI / 180)
#define PATCH_RAD  (2.4 * DEGREE)
#define COLUMNS    150u
#define ROWS       58u
#define LOWEST_RAD (-55 * DEGREE)
/* A surface is one when it is so much wider than it is rough. */
#define WIDER 4.0

int patch_compare_doubles(gconstpointer a, gconstpointer b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* ---- placing ---- */

struct placing {
	const struct two_face_place *place;
	double turned[3][3]; /* the lidar's rotation by its tilt */
	/* Of the beams of the last fan, in the head's frame: direction, and by beam zero and tilt. */
	double first_angle_rad, angle_step_rad;
	GArray *fan; /* of struct fan_beam */
};
struct fan_beam {
	double along[3], by_zero[3], by_tilt[3];
	bool front;
};

/* Of R = Rz Ry Rx, by the middle angle. */
static void turn_by_tilt(const double r[3][3], double ret[3][3])
{
	const double h = 1e-5;
	double degrees[3], more[3][3], less[3][3];
	two_face_angles(r, degrees);
	degrees[1] += h / DEGREE;
	calibration_rotation(degrees, more);
	degrees[1] -= 2 * h / DEGREE;
	calibration_rotation(degrees, less);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			ret[i][j] = (more[i][j] - less[i][j]) / (2 * h);
}

static struct fan_beam fan_beam_of(const struct placing *p, double angle_rad)
{
	const struct lidar_calibration *l = &p->place->lidar;
	double theta = l->beam_zero_rad + l->beam_direction * angle_rad, c = cos(theta),
	       s = sin(theta);
	struct fan_beam b = { .front = c > 0 };
	for (int k = 0; k < 3; k++) {
		b.along[k] = l->rotation[k][1] * c + l->rotation[k][2] * s;
		b.by_zero[k] = l->rotation[k][2] * c - l->rotation[k][1] * s;
		b.by_tilt[k] = p->turned[k][1] * c + p->turned[k][2] * s;
	}
	return b;
}

static void tabulate(struct placing *p, const struct face_line *line)
{
	if (p->fan->len == line->beams && p->first_angle_rad == line->first_angle_rad &&
		p->angle_step_rad == line->angle_step_rad)
		return;
	g_array_set_size(p->fan, 0);
	p->first_angle_rad = line->first_angle_rad;
	p->angle_step_rad = line->angle_step_rad;
	for (uint32_t i = 0; i < line->beams; i++) {
		struct fan_beam b =
			fan_beam_of(p, line->first_angle_rad + i * line->angle_step_rad);
		g_array_append_val(p->fan, b);
	}
}

/* The head's x and y as the stage has turned them, clockwise. */
static void turn_head(double s, double c, const double v[3], double ret[3])
{
	ret[0] = v[0] * c + v[1] * s;
	ret[1] = v[1] * c - v[0] * s;
	ret[2] = v[2];
}

static struct face_patch *patch_at(struct face_patches *p, const double x[3])
{
	double azimuth = atan2(x[0], x[1]), elevation = atan2(x[2], hypot(x[0], x[1]));
	double column = (azimuth + G_PI) / PATCH_RAD, row = (elevation - LOWEST_RAD) / PATCH_RAD;
	if (!(row >= 0 && row < ROWS))
		return NULL;
	return &p->patch[(uint32_t)row * COLUMNS + MIN((uint32_t)column, COLUMNS - 1)];
}

static void add_beam(struct patch_sum *sum, const double origin[3], const double x[3],
	const double by[TWO_FACE_UNKNOWNS][3])
{
	double d[3] = { x[0] - origin[0], x[1] - origin[1], x[2] - origin[2] };
	sum->n += 1;
	for (int k = 0; k < 3; k++)
		sum->x[k] += d[k];
	sum->xx[0] += d[0] * d[0], sum->xx[1] += d[0] * d[1], sum->xx[2] += d[0] * d[2];
	sum->xx[3] += d[1] * d[1], sum->xx[4] += d[1] * d[2], sum->xx[5] += d[2] * d[2];
	for (int i = 0; i < TWO_FACE_UNKNOWNS; i++)
		for (int k = 0; k < 3; k++)
			sum->by[i][k] += by[i][k];
}

/* Where the front really was: stamps come late, and the head lags behind its motor on the way back. */
static double front_at(const struct two_face_place *at, const struct face_line *line, uint32_t i)
{
	return line->front_rad + i * line->front_step_rad - at->delay_s * line->pace_rad_s +
	       (line->pace_rad_s < 0 ? at->slack_rad : 0);
}

static void place_beam(struct face_patches *patches, const struct placing *p,
	const struct face_line *line, uint32_t i, double range_m)
{
	const struct fan_beam *b = &g_array_index(p->fan, struct fan_beam, i);
	const struct two_face_place *at = p->place;
	double r = range_m + at->lidar.range_offset_m, head[3], zero[3], tilt[3], x[3],
	       by[TWO_FACE_UNKNOWNS][3] = { { 0 } };
	bool back = line->pace_rad_s < 0;
	double front = front_at(at, line, i), s = sin(front), c = cos(front);
	for (int k = 0; k < 3; k++) {
		head[k] = b->along[k] * r + at->lidar.translation_m[k];
		zero[k] = b->by_zero[k] * r;
		tilt[k] = b->by_tilt[k] * r;
	}
	turn_head(s, c, head, x);
	struct face_patch *patch = patch_at(patches, x);
	if (!patch)
		return;
	turn_head(s, c, zero, by[TWO_FACE_BEAM_ZERO]);
	turn_head(s, c, tilt, by[TWO_FACE_TILT]);
	turn_head(s, c, b->along, by[TWO_FACE_RANGE]);
	by[TWO_FACE_X][0] = c, by[TWO_FACE_X][1] = -s;
	by[TWO_FACE_Y][0] = s, by[TWO_FACE_Y][1] = c;
	/* Clockwise, x grows by y. */
	by[TWO_FACE_DELAY][0] = -line->pace_rad_s * x[1],
	by[TWO_FACE_DELAY][1] = line->pace_rad_s * x[0];
	if (back)
		by[TWO_FACE_SLACK][0] = x[1], by[TWO_FACE_SLACK][1] = -x[0];
	int group = (back ? 2 : 0) + (b->front ? 0 : 1);
	if (patch->origin_m[0] == 0)
		memcpy(patch->origin_m, x, sizeof x);
	add_beam(&patch->sum[group], patch->origin_m, x, by);
}

/* ---- planes ---- */

/* Sums of squares about the group's own mean. */
static void add_scatter(const struct patch_sum *sum, double scatter[9])
{
	static const int at[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			scatter[3 * i + j] += sum->xx[at[i][j]] - sum->x[i] * sum->x[j] / sum->n;
}

static bool find_plane(const struct face_patch *p, struct patch_plane *ret)
{
	double scatter[9] = { 0 }, values[3], vectors[9], n = 0;
	for (int g = 0; g < PATCH_GROUPS; g++)
		if (p->sum[g].n >= PATCH_BEAMS_MIN) {
			add_scatter(&p->sum[g], scatter);
			n += p->sum[g].n;
		}
	if (n < 2 * PATCH_BEAMS_MIN)
		return false;
	normal_equations_eigen(scatter, 3, values, vectors);
	if (!(values[1] > WIDER * WIDER * fmax(values[2], 0)))
		return false;
	memcpy(ret->normal, vectors + 6, sizeof ret->normal);
	ret->tilt_variance = fmax(values[2], 0) / (n * values[1]);
	return true;
}

/* ---- the whole ---- */

face_patches *face_patches_new(
	const struct faces *f, const struct two_face_place *place, uint32_t every)
{
	face_patches *patches = g_new0(face_patches, 1);
	g_autoptr(GArray) fan = g_array_new(FALSE, FALSE, sizeof(struct fan_beam));
	struct placing p = { .place = place, .fan = fan };
	patches->count = COLUMNS * ROWS;
	patches->patch = g_new0(struct face_patch, patches->count);
	turn_by_tilt(place->lidar.rotation, p.turned);
	for (guint n = 0; n < f->lines->len; n++) {
		const struct face_line *line = &g_array_index(f->lines, struct face_line, n);
		const float *range = &g_array_index(f->range_m, float, line->first);
		tabulate(&p, line);
		for (uint32_t i = n % every; i < line->beams; i += every)
			if (range[i] > 0)
				place_beam(patches, &p, line, i, range[i]);
	}
	for (uint32_t i = 0; i < patches->count; i++)
		patches->patch[i].is_plane =
			find_plane(&patches->patch[i], &patches->patch[i].plane);
	return patches;
}

void face_beams_place(const struct faces *f, const struct two_face_place *place,
	face_beam_func taken, gpointer user_data)
{
	g_autoptr(GArray) fan = g_array_new(FALSE, FALSE, sizeof(struct fan_beam));
	struct placing p = { .place = place, .fan = fan };
	for (guint n = 0; n < f->lines->len; n++) {
		const struct face_line *line = &g_array_index(f->lines, struct face_line, n);
		const float *range = &g_array_index(f->range_m, float, line->first);
		tabulate(&p, line);
		for (uint32_t i = 0; i < line->beams; i++) {
			const struct fan_beam *b = &g_array_index(fan, struct fan_beam, i);
			double head[3], end[3], along[3], front = front_at(place, line, i);
			if (!(range[i] > 0))
				continue;
			for (int k = 0; k < 3; k++)
				head[k] = b->along[k] * (range[i] + place->lidar.range_offset_m) +
					  place->lidar.translation_m[k];
			turn_head(sin(front), cos(front), head, end);
			turn_head(sin(front), cos(front), b->along, along);
			taken(end, along, user_data);
		}
	}
}

void face_patches_free(face_patches *p)
{
	if (!p)
		return;
	g_free(p->patch);
	g_free(p);
}

bool patch_group_of(const struct face_patch *p, int group, struct patch_group *ret)
{
	const struct patch_sum *sum = &p->sum[group];
	const double *normal = p->plane.normal;
	double scatter[9] = { 0 }, along = 0;
	if (!p->is_plane || sum->n < PATCH_BEAMS_MIN)
		return false;
	add_scatter(sum, scatter);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			along += normal[i] * scatter[3 * i + j] * normal[j];
	*ret = (struct patch_group){ .count = sum->n, .rms_m = sqrt(fmax(along, 0) / sum->n) };
	for (int k = 0; k < 3; k++) {
		ret->mean_m[k] = p->origin_m[k] + sum->x[k] / sum->n;
		for (int i = 0; i < TWO_FACE_UNKNOWNS; i++)
			ret->by[i][k] = sum->by[i][k] / sum->n;
	}
	return true;
}
