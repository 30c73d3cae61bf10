#include "process/verify.h"
#include "process/fine-equations.h"
#include "process/verify-compare.h"
#include <string.h>

const char *const verdict_names[VERDICTS] = { "accepted", "no-overlap", "conflict", "sliding",
	"ambiguous", "no-solution", "imprecise" };

void verify_map_clear(struct verify_map *m)
{
	g_clear_pointer(&m->cell, g_free);
	g_clear_pointer(&m->distance_m, g_free);
}

static const struct comparing cares[] = {
	[VERIFY_ROUGH] = { .slack_m = 0.010f, .slack_rad = 0.0005f, .stride = 2 },
	[VERIFY_FULL] = { .slack_m = 0.004f, .slack_rad = 0.00005f, .stride = 1 },
};

static double determinant3(const double m[3][3])
{
	return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
	       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
	       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* Of a symmetric matrix, the largest (sign 1) or the smallest (sign -1), by the cosine formula. */
static double extreme_eigenvalue(const double m[3][3], int sign)
{
	double mean = (m[0][0] + m[1][1] + m[2][2]) / 3, spread = 0, b[3][3];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			b[i][j] = m[i][j] - (i == j ? mean : 0);
			spread += b[i][j] * b[i][j];
		}
	double p = sqrt(spread / 6);
	if (!(p > 0))
		return mean;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			b[i][j] /= p;
	double phi = acos(CLAMP(determinant3(b) / 2, -1, 1)) / 3;
	return mean + 2 * p * cos(sign > 0 ? phi : phi + 2 * G_PI / 3);
}

/* 1 sigma in the worst direction of rows * covariance * rows^T. */
static double worst_deviation(const double rows[3][6], const double covariance[6][6])
{
	double moved[3][3] = { 0 };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			for (int k = 0; k < 6; k++)
				for (int l = 0; l < 6; l++)
					moved[i][j] += rows[i][k] * covariance[k][l] * rows[j][l];
	return sqrt(fmax(extreme_eigenvalue(moved, 1), 0));
}

/* A turn about a's origin also moves b. */
static void set_deviations(struct verification *v, const struct fine_result *fine)
{
	const double *t = fine->pose.translation_m;
	const double turned[3][6] = { { 1 }, { 0, 1 }, { 0, 0, 1 } };
	const double moved[3][6] = { { 0, t[2], -t[1], 1, 0, 0 }, { -t[2], 0, t[0], 0, 1, 0 },
		{ t[1], -t[0], 0, 0, 0, 1 } };
	v->deviation_rad = worst_deviation(turned, fine->covariance);
	v->deviation_m = worst_deviation(moved, fine->covariance);
}

/* One step of least squares; none where a direction is open. */
static void set_rest(struct verification *v, struct pull *pull, const struct pose *pose)
{
	double twist[6];
	for (int i = 0; i < 6; i++)
		for (int k = 0; k < i; k++)
			pull->matrix[i][k] = pull->matrix[k][i];
	if (!equations_solve(pull->matrix, pull->right, twist))
		return;
	struct pose moved = pose_perturb(pose, twist), off = pose_between(pose, &moved);
	v->rest_rad = pose_angle_rad(&off);
	v->rest_m = pose_distance_m(&off);
}

static double balance_of(const struct comparison *c)
{
	double mean[3][3], trace = c->facing[0][0] + c->facing[1][1] + c->facing[2][2];
	if (!(trace > 0))
		return 0;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			mean[i][j] = c->facing[i][j] / trace;
	return fmax(3 * extreme_eigenvalue(mean, -1), 0);
}

static double share(double part, double rest)
{
	return part + rest > 0 ? part / (part + rest) : 0;
}

static void fill(struct verification *v, const struct comparison *c, const struct fine_result *fine)
{
	const double *sr = c->sr;
	double agree = sr[COMPARED_AGREE], against = sr[COMPARED_THROUGH] + sr[COMPARED_MISSED];
	*v = (struct verification){ .agree_sr = agree,
		.occluded_sr = sr[COMPARED_HIDDEN],
		.conflict_sr = sr[COMPARED_THROUGH],
		.outside_sr = sr[COMPARED_OUTSIDE],
		.together_sr = c->together_sr,
		.thing_sr = c->thing_sr,
		.thing_together_sr = c->thing_together_sr,
		.missed_sr = sr[COMPARED_MISSED],
		.void_sr = sr[COMPARED_VOID],
		.overlap = share(agree, against + sr[COMPARED_HIDDEN]),
		.agreement = share(agree, against),
		.rms_m = c->even_sr > 0 ? sqrt(c->squares / c->even_sr) : 0,
		.under_6mm = c->even_sr > 0 ? c->under_6mm / c->even_sr : 0,
		.balance = balance_of(c) };
	set_deviations(v, fine);
}

/* ---- the map ---- */

static void make_map(struct verify_map *m, const struct verify_view *b)
{
	size_t n = (size_t)b->columns * b->rows;
	*m = (struct verify_map){ b->columns, b->rows, g_new0(uint8_t, n), g_new0(float, n) };
}

static void name_cells(struct verify_map *m)
{
	static const uint8_t names[COMPARED_KINDS] = { [COMPARED_NONE] = VERIFY_NONE,
		[COMPARED_AGREE] = VERIFY_AGREE,
		[COMPARED_HIDDEN] = VERIFY_OCCLUDED,
		[COMPARED_THROUGH] = VERIFY_CONFLICT,
		[COMPARED_VOID] = VERIFY_NONE,
		[COMPARED_MISSED] = VERIFY_CONFLICT,
		[COMPARED_OUTSIDE] = VERIFY_OUTSIDE };
	for (size_t i = 0; i < (size_t)m->columns * m->rows; i++)
		m->cell[i] = names[m->cell[i]];
}

void verify_measure(const struct verify_view *a, const struct verify_view *b,
	const struct fine_result *fine, enum verify_care care, struct verification *ret,
	struct verify_map *ret_map)
{
	struct comparison c = { 0 };
	struct pose back = pose_inverse(&fine->pose);
	struct comparing forth = cares[care];
	struct pull pull = { 0 };
	forth.ret_pull = &pull;
	if (ret_map) {
		make_map(ret_map, b);
		forth.ret_kind = ret_map->cell;
		forth.ret_distance_m = ret_map->distance_m;
	}
	verify_compare(b, a, &fine->pose, &forth, &c);
	verify_compare(a, b, &back, &cares[care], &c);
	fill(ret, &c, fine);
	ret->beams = fmin(a->beams, b->beams);
	set_rest(ret, &pull, &fine->pose);
	if (ret_map)
		name_cells(ret_map);
}
