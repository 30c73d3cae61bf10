#include "process/board-lidar.h"
#include "process/normal-equations.h"
#include "process/two-face-patch.h"
#include <math.h>
#include <string.h>

#define DEGREE          (G_PI / 180)
#define STEPS           12
#define BEAMS_MIN       500
#define BOARD_BEAMS_MIN 200
/* Beams further off a board's plane see something else; first wide, then by the noise. */
#define WIDE_M        0.12
#define NARROW_M      0.05
#define HUBER_M       0.02
#define TURN_SEEN_RAD (0.02 * DEGREE)
#define HEIGHT_SEEN_M 2e-3
/* Nearer boards do not fill the view. */
#define REACH_M 8.0

enum { MEET_TURN, MEET_HEIGHT, MEET_RANGE, MEET_UNKNOWNS };

/* A beam that may end on a board, in the scanner's frame. */
struct near_beam {
	double end_m[3], along[3];
};

struct meeting {
	const struct board_desc *desc;
	GArray *boards;
	GArray *beams;               /* of struct near_beam */
	double value[MEET_UNKNOWNS]; /* how boards turn clockwise, rise; how ranges grow */
	double off_m;                /* how far off a plane a beam may be */
	double information[MEET_UNKNOWNS * MEET_UNKNOWNS], gradient[MEET_UNKNOWNS], square;
	uint32_t count;
};

static void take_beam(const double end_m[3], const double along[3], gpointer user_data)
{
	struct meeting *m = user_data;
	struct near_beam b;
	if (end_m[0] * end_m[0] + end_m[1] * end_m[1] + end_m[2] * end_m[2] > REACH_M * REACH_M)
		return;
	memcpy(b.end_m, end_m, sizeof b.end_m);
	memcpy(b.along, along, sizeof b.along);
	g_array_append_val(m->beams, b);
}

/* Where a beam ends on a board's frame, boards being turned and raised as thought; false: beside it. */
static bool meets(
	const struct meeting *m, const struct pose *to_board, const double p[3], double *ret_off)
{
	double x[3], s = m->desc->square_m;
	pose_apply(to_board, p, x);
	*ret_off = x[2];
	return x[0] > -s && x[1] > -s && x[0] < m->desc->columns * s && x[1] < m->desc->rows * s &&
	       fabs(x[2]) < m->off_m;
}

static void add(struct meeting *m, const double by[MEET_UNKNOWNS], double off)
{
	double weight = fabs(off) < HUBER_M ? 1 : HUBER_M / fabs(off);
	for (int i = 0; i < MEET_UNKNOWNS; i++) {
		m->gradient[i] -= weight * by[i] * off;
		for (int j = 0; j < MEET_UNKNOWNS; j++)
			m->information[i * MEET_UNKNOWNS + j] += weight * by[i] * by[j];
	}
	m->square += weight * off * off;
	m->count++;
}

/* The other way round: beams turn back and sink, so that boards stay. */
static void add_board(struct meeting *m, const struct pose *board)
{
	double s = sin(m->value[MEET_TURN]), c = cos(m->value[MEET_TURN]);
	struct pose to_board = pose_inverse(board);
	const double *n = to_board.rotation[2];
	for (guint i = 0; i < m->beams->len; i++) {
		const struct near_beam *b = &g_array_index(m->beams, struct near_beam, i);
		double p[3], q[3], d[3], off;
		for (int k = 0; k < 3; k++)
			p[k] = b->end_m[k] + m->value[MEET_RANGE] * b->along[k];
		q[0] = p[0] * c - p[1] * s, q[1] = p[1] * c + p[0] * s,
		q[2] = p[2] - m->value[MEET_HEIGHT];
		d[0] = b->along[0] * c - b->along[1] * s, d[1] = b->along[1] * c + b->along[0] * s,
		d[2] = b->along[2];
		if (!meets(m, &to_board, q, &off))
			continue;
		const double by[MEET_UNKNOWNS] = { n[1] * q[0] - n[0] * q[1], -n[2],
			n[0] * d[0] + n[1] * d[1] + n[2] * d[2] };
		add(m, by, off);
	}
}

static bool step(struct meeting *m, double *ret_covariance)
{
	double change[MEET_UNKNOWNS];
	memset(m->information, 0, sizeof m->information);
	memset(m->gradient, 0, sizeof m->gradient);
	m->square = 0;
	m->count = 0;
	for (guint i = 0; i < m->boards->len; i++)
		add_board(m, &g_array_index(m->boards, struct pose, i));
	if (m->count < BEAMS_MIN || !normal_equations_solve(m->information, m->gradient,
					    MEET_UNKNOWNS, change, ret_covariance))
		return false;
	for (int i = 0; i < MEET_UNKNOWNS; i++)
		m->value[i] += change[i];
	return true;
}

/* ---- when it is known ---- */

static void add_end(struct board_plane *p, double scatter[9], const double end[3],
	const double along[3], const double origin[3])
{
	p->beams++;
	for (int i = 0; i < 3; i++) {
		p->mean_m[i] += end[i] - origin[i];
		p->along[i] += along[i];
		for (int j = 0; j < 3; j++)
			scatter[3 * i + j] += (end[i] - origin[i]) * (end[j] - origin[j]);
	}
}

/* Beams on a board that stands where it was found. */
static struct board_plane plane_of(const struct meeting *m, const struct pose *board)
{
	struct board_plane p = { 0 };
	double scatter[9] = { 0 }, values[3], vectors[9], off;
	struct pose to_board = pose_inverse(board);
	for (guint i = 0; i < m->beams->len; i++) {
		const struct near_beam *b = &g_array_index(m->beams, struct near_beam, i);
		double end[3];
		for (int k = 0; k < 3; k++)
			end[k] = b->end_m[k] + m->value[MEET_RANGE] * b->along[k];
		if (meets(m, &to_board, end, &off))
			add_end(&p, scatter, end, b->along, board->translation_m);
	}
	if (p.beams < BOARD_BEAMS_MIN)
		return (struct board_plane){ 0 };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			scatter[3 * i + j] -= p.mean_m[i] * p.mean_m[j] / p.beams;
	normal_equations_eigen(scatter, 3, values, vectors);
	memcpy(p.across, vectors, sizeof p.across);
	memcpy(p.spread2_m2, values, sizeof p.spread2_m2);
	for (int k = 0; k < 3; k++) {
		p.mean_m[k] = board->translation_m[k] + p.mean_m[k] / p.beams;
		p.along[k] /= p.beams;
	}
	return p;
}

static void move_boards(const struct meeting *m, GArray *planes)
{
	const double up[3] = { 0, 0, m->value[MEET_HEIGHT] };
	struct pose moved = pose_from_yaw(m->value[MEET_TURN], up);
	for (guint i = 0; i < m->boards->len; i++) {
		struct pose *board = &g_array_index(m->boards, struct pose, i);
		*board = pose_compose(&moved, board);
		struct board_plane plane = plane_of(m, board);
		g_array_append_val(planes, plane);
	}
}

/* As the boards turn and rise, so does who saw them. */
static void move_camera(struct camera_calibration *c, double turn_rad, double height_m)
{
	double s = sin(turn_rad), k = cos(turn_rad), t[3];
	memcpy(t, c->translation_m, sizeof t);
	c->translation_m[0] = t[0] * k + t[1] * s;
	c->translation_m[1] = t[1] * k - t[0] * s;
	c->translation_m[2] = t[2] + height_m;
	for (int i = 0; i < 3; i++) {
		double x = c->rotation[i][0], y = c->rotation[i][1];
		c->rotation[i][0] = x * k + y * s;
		c->rotation[i][1] = y * k - x * s;
	}
}

static void finish(
	const struct meeting *m, const double *covariance, struct board_result *ret, GArray *planes)
{
	double variance = m->square / m->count;
	double turn = sqrt(variance * covariance[0]), height = sqrt(variance * covariance[4]);
	ret->beams = m->count;
	ret->plane_rms_m = sqrt(variance);
	if (turn > TURN_SEEN_RAD || height > HEIGHT_SEEN_M)
		return;
	ret->met = true;
	ret->range_offset_m += m->value[MEET_RANGE];
	ret->range_deviation_m = sqrt(variance * covariance[8]);
	ret->deviation[BOARD_TURN_Z] = turn;
	ret->deviation[BOARD_Z] = height;
	move_camera(&ret->camera, m->value[MEET_TURN], m->value[MEET_HEIGHT]);
	move_boards(m, planes);
}

void board_lidar_meet(const struct faces *f, const struct board_desc *desc, GArray *boards,
	const struct two_face_result *lidar, struct board_result *ret, GArray *planes)
{
	g_autoptr(GArray) beams = g_array_new(FALSE, FALSE, sizeof(struct near_beam));
	struct meeting m = { .desc = desc, .boards = boards, .beams = beams, .off_m = WIDE_M };
	struct two_face_place place = { lidar->lidar, lidar->value[TWO_FACE_DELAY].value,
		lidar->value[TWO_FACE_SLACK].value };
	double covariance[MEET_UNKNOWNS * MEET_UNKNOWNS];
	ret->range_offset_m = lidar->lidar.range_offset_m;
	face_beams_place(f, &place, take_beam, &m);
	for (int i = 0; i < STEPS; i++) {
		m.off_m = i < STEPS / 3 ? WIDE_M : NARROW_M;
		if (!step(&m, covariance))
			return;
	}
	finish(&m, covariance, ret, planes);
}
