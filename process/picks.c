#include "process/picks.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of triples all are tried, up to this many pairs; of more, some that are drawn. */
#define ALL_TRIPLES_MAX 20
#define TRIPLES_DRAWN   4000
/* Who picks in a coarse scan is off by some centimetres; nobody who meant the same point by more than 0.3 m. */
#define AGREE_MIN_M   0.05
#define AGREE_MAX_M   0.30
#define AGREE_THREE_M 0.15 /* of three pairs alone, whose noise cannot be told */
#define AGREE_SIGMAS  2.5
#define ROUNDS_MAX    20
/* Off the line through them, root mean square. */
#define OFF_LINE_MIN_M     0.01
#define OFF_LINE_MIN_SHARE 0.03 /* of how far they reach along it */

G_DEFINE_QUARK(picks - error - quark, picks_error)

void picks_fit_clear(struct picks_fit *fit)
{
	g_clear_pointer(&fit->residual_m, g_free);
	g_clear_pointer(&fit->blunder, g_free);
}

/* ---- small symmetric matrices ---- */

static void turn_rows(double m[4][4], double v[4][4], int n, int p, int q)
{
	double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
	double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
	double c = 1 / sqrt(t * t + 1), s = t * c;
	for (int k = 0; k < n; k++) {
		double a = m[k][p], b = m[k][q];
		m[k][p] = c * a - s * b;
		m[k][q] = s * a + c * b;
	}
	for (int k = 0; k < n; k++) {
		double a = m[p][k], b = m[q][k], x = v[k][p], y = v[k][q];
		m[p][k] = c * a - s * b;
		m[q][k] = s * a + c * b;
		v[k][p] = c * x - s * y;
		v[k][q] = s * x + c * y;
	}
}

/* Jacobi: the eigenvalues come to stand on the diagonal, the vectors in the columns of v. */
static void diagonalise(double m[4][4], double v[4][4], int n)
{
	double size = 0;
	bool still = false;
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++)
			v[i][j] = i == j;
	for (int i = 0; i < n; i++)
		size = fmax(size, fabs(m[i][i]));
	for (int sweep = 0; sweep < 30 && !still; sweep++) {
		still = true;
		for (int p = 0; p < n; p++)
			for (int q = p + 1; q < n; q++)
				if (fabs(m[p][q]) > 1e-17 * size) {
					turn_rows(m, v, n, p, q);
					still = false;
				}
	}
}

/* ---- least squares ---- */

/* The pairs that count. */
struct selection {
	const struct pick *pick;
	const size_t *index;
	size_t count;
};

static void find_middles(const struct selection *s, double ret_a[3], double ret_b[3])
{
	memset(ret_a, 0, 3 * sizeof(double));
	memset(ret_b, 0, 3 * sizeof(double));
	for (size_t i = 0; i < s->count; i++)
		for (int k = 0; k < 3; k++) {
			const struct pick *p = &s->pick[s->index[i]];
			ret_a[k] += p->a_m[k] / (double)s->count;
			ret_b[k] += p->b_m[k] / (double)s->count;
		}
}

/* m[k][l]: sum of b_k * a_l about the middles. */
static void correlate(const struct selection *s, const double middle_a[3], const double middle_b[3],
	double m[3][3])
{
	memset(m, 0, 9 * sizeof(double));
	for (size_t i = 0; i < s->count; i++) {
		const struct pick *p = &s->pick[s->index[i]];
		for (int k = 0; k < 3; k++)
			for (int l = 0; l < 3; l++)
				m[k][l] += (p->b_m[k] - middle_b[k]) * (p->a_m[l] - middle_a[l]);
	}
}

static void rotation_of(const double q[4], double ret[3][3])
{
	double w = q[0], x = q[1], y = q[2], z = q[3];
	const double r[3][3] = {
		{ w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y) },
		{ 2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x) },
		{ 2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z },
	};
	memcpy(ret, r, sizeof r);
}

/* As a quaternion, the eigenvector of the largest eigenvalue (Horn 1987): the same least squares as Arun's, and what comes out
 * is never a reflection. */
static struct pose fit(const struct selection *s)
{
	double a[3], b[3], m[3][3], v[4][4], q[4];
	struct pose pose;
	find_middles(s, a, b);
	correlate(s, a, b, m);
	double n[4][4] = {
		{ m[0][0] + m[1][1] + m[2][2], m[1][2] - m[2][1], m[2][0] - m[0][2],
			m[0][1] - m[1][0] },
		{ 0, m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[2][0] + m[0][2] },
		{ 0, 0, m[1][1] - m[0][0] - m[2][2], m[1][2] + m[2][1] },
		{ 0, 0, 0, m[2][2] - m[0][0] - m[1][1] },
	};
	int largest = 0;
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < i; j++)
			n[i][j] = n[j][i];
	diagonalise(n, v, 4);
	for (int i = 1; i < 4; i++)
		largest = n[i][i] > n[largest][largest] ? i : largest;
	for (int i = 0; i < 4; i++)
		q[i] = v[i][largest];
	rotation_of(q, pose.rotation);
	for (int i = 0; i < 3; i++)
		pose.translation_m[i] = a[i] - pose.rotation[i][0] * b[0] -
					pose.rotation[i][1] * b[1] - pose.rotation[i][2] * b[2];
	pose_orthonormalise(&pose);
	return pose;
}

static double distance_m(const double p[3], const double q[3])
{
	return hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
}

static double residual_m(const struct pose *pose, const struct pick *p)
{
	double at[3];
	pose_apply(pose, p->b_m, at);
	return distance_m(at, p->a_m);
}

/* ---- points on a line ---- */

static int falling(const void *x, const void *y)
{
	double a = *(const double *)x, b = *(const double *)y;
	return (a < b) - (a > b);
}

static bool is_line(const struct selection *s, bool of_b)
{
	double a[3], b[3], m[4][4] = { { 0 } }, v[4][4], value[3];
	find_middles(s, a, b);
	const double *middle = of_b ? b : a;
	for (size_t i = 0; i < s->count; i++) {
		const struct pick *p = &s->pick[s->index[i]];
		const double *at = of_b ? p->b_m : p->a_m;
		for (int k = 0; k < 3; k++)
			for (int l = 0; l < 3; l++)
				m[k][l] += (at[k] - middle[k]) * (at[l] - middle[l]) /
					   (double)s->count;
	}
	diagonalise(m, v, 3);
	for (int k = 0; k < 3; k++)
		value[k] = sqrt(fmax(m[k][k], 0));
	qsort(value, 3, sizeof *value, falling);
	return hypot(value[1], value[2]) < fmax(OFF_LINE_MIN_M, OFF_LINE_MIN_SHARE * value[0]);
}

static bool is_degenerate(const struct selection *s)
{
	return is_line(s, false) || is_line(s, true);
}

/* ---- triples ---- */

struct consensus {
	const struct pick *pick;
	size_t count, majority;
	double *residual_m; /* of a try, for sorting */
	struct pose best;
	double best_m; /* within this of it are more than half of all pairs */
	bool found;
};

static int rising(const void *x, const void *y)
{
	return falling(y, x);
}

static void try_triple(struct consensus *c, size_t i, size_t j, size_t k)
{
	const size_t index[3] = { i, j, k };
	struct selection s = { c->pick, index, 3 };
	if (is_degenerate(&s))
		return;
	struct pose pose = fit(&s);
	for (size_t n = 0; n < c->count; n++)
		c->residual_m[n] = residual_m(&pose, &c->pick[n]);
	qsort(c->residual_m, c->count, sizeof(double), rising);
	if (c->found && c->residual_m[c->majority - 1] >= c->best_m)
		return;
	c->found = true;
	c->best = pose;
	c->best_m = c->residual_m[c->majority - 1];
}

static void try_all(struct consensus *c)
{
	for (size_t i = 0; i < c->count; i++)
		for (size_t j = i + 1; j < c->count; j++)
			for (size_t k = j + 1; k < c->count; k++)
				try_triple(c, i, j, k);
}

static void try_some(struct consensus *c)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(1);
	int count = (int)MIN(c->count, G_MAXINT32);
	for (int n = 0; n < TRIPLES_DRAWN; n++) {
		size_t i = (size_t)g_rand_int_range(chance, 0, count),
		       j = (size_t)g_rand_int_range(chance, 0, count),
		       k = (size_t)g_rand_int_range(chance, 0, count);
		if (i != j && j != k && i != k)
			try_triple(c, i, j, k);
	}
}

/* How far a pair may be off: by the scatter of the better half (Rousseeuw and Leroy 1987, with their correction for few). */
static double limit_of(const struct consensus *c)
{
	if (c->count == 3)
		return AGREE_THREE_M;
	double few = 1 + 5 / (double)(c->count - 3);
	return CLAMP(AGREE_SIGMAS * 1.4826 * few * c->best_m, AGREE_MIN_M, AGREE_MAX_M);
}

/* ---- the whole ---- */

static bool judge(const struct consensus *c, double limit_m, struct picks_fit *ret)
{
	bool changed = false;
	ret->blunders = 0;
	for (size_t i = 0; i < c->count; i++) {
		ret->residual_m[i] = residual_m(&ret->pose, &c->pick[i]);
		bool blunder = ret->residual_m[i] > limit_m;
		changed |= blunder != ret->blunder[i];
		ret->blunder[i] = blunder;
		ret->blunders += blunder;
	}
	return changed;
}

static struct selection select_good(
	const struct consensus *c, const struct picks_fit *r, size_t *index)
{
	struct selection s = { c->pick, index, 0 };
	for (size_t i = 0; i < c->count; i++)
		if (!r->blunder[i])
			index[s.count++] = i;
	return s;
}

static double rms_of(const struct selection *s, const struct picks_fit *r)
{
	double sum = 0;
	for (size_t i = 0; i < s->count; i++)
		sum += r->residual_m[s->index[i]] * r->residual_m[s->index[i]];
	return sqrt(sum / (double)s->count);
}

static bool refuse_line(GError **error)
{
	g_set_error(error, PICKS_ERROR, PICKS_ERROR_DEGENERATE,
		"the picked points are on a line, which leaves the turn about it open; pick one "
		"well beside it");
	return false;
}

static bool refuse_disagreement(const struct consensus *c, size_t agreeing, GError **error)
{
	if (agreeing < 3)
		g_set_error(error, PICKS_ERROR, PICKS_ERROR_DISAGREE,
			"no three of the %zu pairs agree with each other", c->count);
	else
		g_set_error(error, PICKS_ERROR, PICKS_ERROR_DISAGREE,
			"only %zu of the %zu pairs agree with each other; more than half must",
			agreeing, c->count);
	return false;
}

/* Least squares of the pairs that agree, until they stay the same. */
static bool refine(const struct consensus *c, struct picks_fit *ret, GError **error)
{
	g_autofree size_t *index = g_new(size_t, c->count);
	double limit_m = limit_of(c);
	struct selection s;
	bool changed = true;
	ret->pose = c->best;
	judge(c, limit_m, ret);
	for (int round = 0; changed && round < ROUNDS_MAX; round++) {
		s = select_good(c, ret, index);
		if (s.count < c->majority) {
			return refuse_disagreement(c, s.count, error);
		}
		if (is_degenerate(&s))
			return refuse_line(error);
		ret->pose = fit(&s);
		changed = judge(c, limit_m, ret);
	}
	s = select_good(c, ret, index);
	ret->rms_m = s.count ? rms_of(&s, ret) : 0;
	return true;
}

bool picks_fit(const struct pick *picks, size_t count, struct picks_fit *ret, GError **error)
{
	*ret = (struct picks_fit){ .pose = POSE_IDENTITY };
	if (count < 3) {
		g_set_error(error, PICKS_ERROR, PICKS_ERROR_FEW,
			"%zu %s of points; at least three are needed", count,
			count == 1 ? "pair" : "pairs");
		return false;
	}
	g_autofree double *residual = g_new(double, count);
	struct consensus c = { .pick = picks,
		.count = count,
		.majority = MAX(count / 2 + 1, 3),
		.residual_m = residual };
	if (count <= ALL_TRIPLES_MAX)
		try_all(&c);
	else
		try_some(&c);
	if (!c.found)
		return refuse_line(error);
	ret->residual_m = g_new0(double, count);
	ret->blunder = g_new0(bool, count);
	if (refine(&c, ret, error))
		return true;
	picks_fit_clear(ret);
	return false;
}
