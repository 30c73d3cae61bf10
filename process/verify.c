#include "process/verify.h"
#include "process/verify-compare.h"
#include <string.h>

/* All limits are from simulated courts, streets, bridges and halls: thousands of poses, right and wrong. Right poses with
 * an overlap over a fifth contradict themselves in less than half of what is allowed here, wrong ones in more than twice. */
#define CONFLICT_MAX 0.030
#define DISAGREE_MAX 0.060 /* conflicts and misses together */
#define AGREE_MIN_SR 0.6
#define OVERLAP_MIN  0.15
#define EVIDENCE_SR  0.3
#define BALANCE_MIN  0.02
/* A rival must contradict itself this much more. */
#define RIVAL_RATIO 0.65
/* Contradiction that nobody can rule out: what is shared only little cannot be as sure as what is shared at large. */
#define UNSEEN_SR 0.01
/* Worse than this in its worst direction a pose slides; between, it is right, but not close enough. */
#define SLIDING_M     0.02
#define SLIDING_RAD   (0.2 * G_PI / 180)
#define IMPRECISE_M   1.0e-3
#define IMPRECISE_RAD (0.005 * G_PI / 180)
/* What the surfels may be apart beyond their own noise. */
#define SLACK_M 0.004f

const char *const verdict_names[VERDICTS] = { "accepted", "no-overlap", "conflict", "sliding",
	"ambiguous", "no-solution", "imprecise" };

void verify_map_clear(struct verify_map *m)
{
	g_clear_pointer(&m->cell, g_free);
	g_clear_pointer(&m->distance_m, g_free);
}

/* ---- measuring ---- */

static double determinant3(const double m[3][3])
{
	return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
	       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
	       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* Eigenvalues of a symmetric matrix, the largest (sign 1) or the smallest (sign -1), by the cosine formula. */
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

static double worst_deviation(const double covariance[6][6], int from)
{
	double block[3][3];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			block[i][j] = covariance[from + i][from + j];
	return sqrt(fmax(extreme_eigenvalue(block, 1), 0));
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

static struct verify_map map_for(const struct verify_view *b)
{
	size_t n = (size_t)b->columns * b->rows;
	return (struct verify_map){ b->columns, b->rows, g_new0(uint8_t, n), g_new0(float, n) };
}

static void name_cells(struct verify_map *m)
{
	static const uint8_t names[COMPARED_KINDS] = { [COMPARED_NONE] = VERIFY_NONE,
		[COMPARED_AGREE] = VERIFY_AGREE,
		[COMPARED_HIDDEN] = VERIFY_OCCLUDED,
		[COMPARED_THROUGH] = VERIFY_CONFLICT,
		[COMPARED_VOID] = VERIFY_VOID,
		[COMPARED_MISSED] = VERIFY_MISSED,
		[COMPARED_OUTSIDE] = VERIFY_OUTSIDE };
	for (size_t i = 0; i < (size_t)m->columns * m->rows; i++)
		m->cell[i] = names[m->cell[i]];
}

static void fill(struct verification *v, const struct comparison *c, const struct fine_result *fine)
{
	const double *sr = c->sr;
	double looked = sr[COMPARED_AGREE] + sr[COMPARED_HIDDEN] + sr[COMPARED_THROUGH] +
			sr[COMPARED_MISSED],
	       told = sr[COMPARED_AGREE] + sr[COMPARED_THROUGH] + sr[COMPARED_MISSED];
	*v = (struct verification){ .agree_sr = sr[COMPARED_AGREE],
		.occluded_sr = sr[COMPARED_HIDDEN],
		.conflict_sr = sr[COMPARED_THROUGH],
		.void_sr = sr[COMPARED_VOID],
		.missed_sr = sr[COMPARED_MISSED],
		.outside_sr = sr[COMPARED_OUTSIDE],
		.overlap = looked > 0 ? sr[COMPARED_AGREE] / looked : 0,
		.agreement = told > 0 ? sr[COMPARED_AGREE] / told : 0,
		.rms_m = c->weights > 0 ? sqrt(c->squares / c->weights) : 0,
		.under_6mm = c->weights > 0 ? c->under_6mm / c->weights : 0,
		.balance = balance_of(c),
		.deviation_m = worst_deviation(fine->covariance, 3),
		.deviation_rad = worst_deviation(fine->covariance, 0) };
}

void verify_measure(const struct verify_view *a, const struct verify_view *b,
	const struct fine_result *fine, struct verification *ret, struct verify_map *ret_map)
{
	struct comparison c = { 0 };
	struct pose back = pose_inverse(&fine->pose);
	struct verify_map map = { 0 };
	if (ret_map)
		map = map_for(b);
	verify_compare(b, a, &fine->pose, SLACK_M, &c, map.cell, map.distance_m);
	verify_compare(a, b, &back, SLACK_M, &c, NULL, NULL);
	fill(ret, &c, fine);
	if (ret_map) {
		name_cells(&map);
		*ret_map = map;
	}
}

/* ---- judging ---- */

double verify_contradiction(const struct verification *v)
{
	return (v->conflict_sr + UNSEEN_SR) / (v->agree_sr + v->conflict_sr + UNSEEN_SR);
}

bool verify_is_evidence(const struct verification *v)
{
	return v->agree_sr >= EVIDENCE_SR;
}

static void say(struct verification *v, enum verdict verdict, const char *format, ...)
	G_GNUC_PRINTF(3, 4);
static void say(struct verification *v, enum verdict verdict, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	v->verdict = verdict;
	g_vsnprintf(v->reason, sizeof v->reason, format, args);
	va_end(args);
}

void verify_no_solution(struct verification *ret)
{
	*ret = (struct verification){ 0 };
	say(ret, VERDICT_NO_SOLUTION, "No pose was found in which the two scans share a surface.");
}

static bool shares_enough(struct verification *v)
{
	if (v->agree_sr >= AGREE_MIN_SR && v->overlap >= OVERLAP_MIN)
		return true;
	say(v, VERDICT_NO_OVERLAP,
		"The best pose has only %.2f sr of surface in common, %.0f %% of what both looked "
		"at: too little to tell.",
		v->agree_sr, 100 * v->overlap);
	return false;
}

static bool agrees(struct verification *v, const struct fine_result *fine)
{
	double conflict = verify_contradiction(v);
	if (conflict > CONFLICT_MAX || 1 - v->agreement > DISAGREE_MAX) {
		say(v, VERDICT_CONFLICT,
			"In the best pose %.1f %% of what both looked at contradicts it: one scan "
			"saw "
			"through what the other saw, or missed it by centimetres.",
			100 * (1 - v->agreement));
		return false;
	}
	return true;
	say(v, VERDICT_CONFLICT,
		"The surfaces do not come to rest on each other (%.0f %% of them fit).",
		100 * fine->inlier_share);
	return false;
}

static bool is_held(struct verification *v)
{
	if (v->deviation_m <= SLIDING_M && v->deviation_rad <= SLIDING_RAD &&
		v->balance >= BALANCE_MIN)
		return true;
	say(v, VERDICT_SLIDING,
		"What the scans share leaves a direction open: %.0f mm and %.2f degrees of play, "
		"balance of directions %.2f.",
		1000 * v->deviation_m, v->deviation_rad * 180 / G_PI, v->balance);
	return false;
}

static bool is_alone(struct verification *v, const struct verification *rival)
{
	if (!rival)
		return true;
	v->rival_score = verify_contradiction(v) / verify_contradiction(rival);
	if (v->rival_score <= RIVAL_RATIO)
		return true;
	say(v, VERDICT_AMBIGUOUS,
		"Another pose fits about as well: %.2f %% of contradictions here, %.2f %% there.",
		100 * verify_contradiction(v), 100 * verify_contradiction(rival));
	return false;
}

static bool is_precise(struct verification *v)
{
	if (v->deviation_m <= IMPRECISE_M && v->deviation_rad <= IMPRECISE_RAD)
		return true;
	say(v, VERDICT_IMPRECISE,
		"It fits, but only to %.1f mm and %.3f degrees (1 sigma): too little is shared.",
		1000 * v->deviation_m, v->deviation_rad * 180 / G_PI);
	return false;
}

void verify_judge(
	struct verification *v, const struct fine_result *fine, const struct verification *rival)
{
	v->rival_score = 0;
	if (shares_enough(v) && agrees(v, fine) && is_held(v) && is_alone(v, rival) &&
		is_precise(v))
		say(v, VERDICT_ACCEPTED,
			"%.0f %% of what both looked at agrees, %.1f %% contradicts; held to %.1f "
			"mm and "
			"%.3f degrees.",
			100 * v->overlap, 100 * (1 - v->agreement), 1000 * v->deviation_m,
			v->deviation_rad * 180 / G_PI);
}
