#include "process/cloud-verdict.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Partners: nearer than this many voxels along the surface and across it, with normals like each other's. */
#define ALONG_VOXELS  1.5
#define ACROSS_VOXELS 0.5
#define NORMALS_ALIKE 0.85
/* Neighbouring voxels share points and surface: so many count as one. */
#define CORRELATED 8.0

/* What must be reached; with free space known, and without. */
#define AGREE_MIN         300
#define OVERLAP_MIN_FREE  0.25
#define OVERLAP_MIN_BLIND 0.50
#define SHARE_MIN_BLIND   0.40 /* of the surfaces of each direction */
#define AGREEMENT_MIN     0.90
#define BALANCE_MIN_FREE  0.03
#define BALANCE_MIN_BLIND 0.08
#define HELD_MIN          0.01 /* the worst direction of the scaled normal equations */
#define RIVAL_MAX_FREE    0.85
#define RIVAL_MAX_BLIND   0.70
#define RMS_MAX_VOXELS    0.25
#define DEVIATION_MAX_M   0.05
#define DEVIATION_MAX_RAD (0.5 * G_PI / 180)

/* ---- small matrices ---- */

/* Jacobi: eigenvalues rising in values, vectors in the columns of v. m is used up. */
static void eigen(size_t n, double m[6][6], double values[6], double v[6][6])
{
	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < n; j++)
			v[i][j] = i == j;
	for (int sweep = 0; sweep < 50; sweep++)
		for (size_t p = 0; p < n; p++)
			for (size_t q = p + 1; q < n; q++) {
				if (fabs(m[p][q]) < 1e-300)
					continue;
				double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
				double t = (theta < 0 ? -1 : 1) /
					   (fabs(theta) + sqrt(theta * theta + 1));
				double c = 1 / sqrt(t * t + 1), s = t * c;
				for (size_t k = 0; k < n; k++) {
					double a = m[k][p], b = m[k][q];
					m[k][p] = c * a - s * b;
					m[k][q] = s * a + c * b;
				}
				for (size_t k = 0; k < n; k++) {
					double a = m[p][k], b = m[q][k];
					m[p][k] = c * a - s * b;
					m[q][k] = s * a + c * b;
					a = v[k][p], b = v[k][q];
					v[k][p] = c * a - s * b;
					v[k][q] = s * a + c * b;
				}
			}
	for (size_t i = 0; i < n; i++)
		values[i] = m[i][i];
	for (size_t i = 0; i < n; i++)
		for (size_t j = i + 1; j < n; j++)
			if (values[j] < values[i]) {
				double t = values[i];
				values[i] = values[j];
				values[j] = t;
				for (size_t k = 0; k < n; k++) {
					t = v[k][i];
					v[k][i] = v[k][j];
					v[k][j] = t;
				}
			}
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double ret[3])
{
	ret[0] = a[1] * b[2] - a[2] * b[1];
	ret[1] = a[2] * b[0] - a[0] * b[2];
	ret[2] = a[0] * b[1] - a[1] * b[0];
}

/* ---- agreement ---- */

static double across_m(const struct cloud_partner *t)
{
	double d[3] = { t->b_m[0] - t->a_m[0], t->b_m[1] - t->a_m[1], t->b_m[2] - t->a_m[2] };
	return dot(d, t->a_normal);
}

static bool agrees(const struct cloud_partner *t, double voxel_m)
{
	double d[3] = { t->b_m[0] - t->a_m[0], t->b_m[1] - t->a_m[1], t->b_m[2] - t->a_m[2] };
	return fabs(dot(t->a_normal, t->b_normal)) > NORMALS_ALIKE &&
	       fabs(dot(d, t->a_normal)) < ACROSS_VOXELS * voxel_m &&
	       sqrt(dot(d, d)) < ALONG_VOXELS * voxel_m;
}

/* Sums over the agreeing partners. */
struct sums {
	double n, mean_m[3], reach_m, square_m2, under_6mm;
	double normals[6][6];   /* 3 x 3 of it */
	double equations[6][6]; /* rotation about the mean times reach, then translation */
};

static void sum_up(const struct cloud_evidence *e, struct sums *s)
{
	for (size_t i = 0; i < e->count; i++) {
		const struct cloud_partner *t = &e->partners[i];
		if (!agrees(t, e->voxel_m))
			continue;
		s->n++;
		for (int k = 0; k < 3; k++)
			s->mean_m[k] += (t->b_m[k] - s->mean_m[k]) / s->n;
		double off = across_m(t);
		s->square_m2 += off * off;
		s->under_6mm += fabs(off) < 0.006;
		for (int k = 0; k < 3; k++)
			for (int l = 0; l < 3; l++)
				s->normals[k][l] += t->a_normal[k] * t->a_normal[l];
	}
}

static void arm_of(const struct sums *s, const struct cloud_partner *t, double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = t->b_m[k] - s->mean_m[k];
}

static void sum_equations(const struct cloud_evidence *e, struct sums *s)
{
	double arm[3], turn[3], reach2 = 0;
	for (size_t i = 0; i < e->count; i++)
		if (agrees(&e->partners[i], e->voxel_m)) {
			arm_of(s, &e->partners[i], arm);
			reach2 += dot(arm, arm) / s->n;
		}
	s->reach_m = sqrt(reach2);
	for (size_t i = 0; i < e->count; i++) {
		const struct cloud_partner *t = &e->partners[i];
		if (!agrees(t, e->voxel_m))
			continue;
		arm_of(s, t, arm);
		cross(arm, t->a_normal, turn);
		double row[6] = { turn[0] / s->reach_m, turn[1] / s->reach_m, turn[2] / s->reach_m,
			t->a_normal[0], t->a_normal[1], t->a_normal[2] };
		for (int k = 0; k < 6; k++)
			for (int l = 0; l < 6; l++)
				s->equations[k][l] += row[k] * row[l] / s->n;
	}
}

/* Of the points of b whose normals are nearest to each of three axes the share that agrees; the least of the three. Ground agrees
 * with ground anywhere: what stands on it must, too. */
static double least_share(const struct cloud_evidence *e, double axes[6][6])
{
	double agree[3] = { 0 }, all[3] = { 0 }, least = 1;
	for (size_t i = 0; i < e->count; i++) {
		const struct cloud_partner *t = &e->partners[i];
		int nearest = 0;
		double most = -1;
		for (int k = 0; k < 3; k++) {
			double axis[3] = { axes[0][k], axes[1][k], axes[2][k] },
			       along = fabs(dot(axis, t->b_normal));
			if (along > most)
				most = along, nearest = k;
		}
		all[nearest]++;
		agree[nearest] += agrees(t, e->voxel_m);
	}
	for (int k = 0; k < 3; k++)
		least = fmin(least, all[k] > 0 ? agree[k] / all[k] : 0);
	return least;
}

/* ---- how well the pose is held ---- */

/* From about the mean of the points to about a's origin: t' = t + mean x w, to first order. */
static void move_to_origin(const struct sums *s, const double about_mean[6][6], double ret[6][6])
{
	double j[6][6] = { { 0 } }, half[6][6];
	const double *m = s->mean_m;
	for (int i = 0; i < 6; i++)
		j[i][i] = 1;
	const double skew[3][3] = { { 0, -m[2], m[1] }, { m[2], 0, -m[0] }, { -m[1], m[0], 0 } };
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			j[3 + i][k] = skew[i][k];
	for (int i = 0; i < 6; i++)
		for (int k = 0; k < 6; k++) {
			half[i][k] = 0;
			for (int l = 0; l < 6; l++)
				half[i][k] += j[i][l] * about_mean[l][k];
		}
	for (int i = 0; i < 6; i++)
		for (int k = 0; k < 6; k++) {
			ret[i][k] = 0;
			for (int l = 0; l < 6; l++)
				ret[i][k] += half[i][l] * j[k][l];
		}
}

static double worst(const double c[6][6], size_t first)
{
	double block[6][6] = { { 0 } }, values[6], vectors[6][6];
	for (size_t i = 0; i < 3; i++)
		for (size_t k = 0; k < 3; k++)
			block[i][k] = c[first + i][first + k];
	eigen(3, block, values, vectors);
	return sqrt(fmax(values[2], 0));
}

static void hold(const struct sums *s, struct cloud_align_result *ret)
{
	double m[6][6], values[6], v[6][6], c[6][6] = { { 0 } };
	memcpy(m, s->equations, sizeof m);
	eigen(6, m, values, v);
	memcpy(ret->fine.information_eigenvalues, values, sizeof values);
	double sigma2 = s->square_m2 / s->n * CORRELATED / s->n;
	for (int i = 0; i < 6; i++)
		for (int k = 0; k < 6; k++) {
			for (int l = 0; l < 6; l++)
				c[i][k] += v[i][l] * v[k][l] / fmax(values[l], 1e-9) * sigma2;
			c[i][k] /= (i < 3 ? s->reach_m : 1) * (k < 3 ? s->reach_m : 1);
		}
	ret->verification.deviation_rad = worst(c, 0);
	ret->verification.deviation_m = worst(c, 3);
	move_to_origin(s, c, ret->fine.covariance);
}

/* ---- free space ---- */

/* The nearest that was measured about a direction: nothing seen nearer than that was in the way. */
static bool nearest_about(const range_grid *g, const double p[3], float *ret_near, float *ret_far)
{
	int64_t at = range_lattice_find(&g->lattice, p[0], p[1], p[2]);
	*ret_near = G_MAXFLOAT;
	*ret_far = 0;
	if (at < 0)
		return false;
	uint32_t centre = g->lattice.cell ? g->lattice.cell[at] : (uint32_t)at;
	if (centre == RANGE_GRID_NONE || !(g->range_m[centre] > 0))
		return false;
	int64_t row = centre / g->columns, column = centre % g->columns;
	for (int64_t r = MAX(row - 1, 0); r <= MIN(row + 1, (int64_t)g->rows - 1); r++)
		for (int64_t k = column - 2; k <= column + 2; k++) {
			int64_t c = (k + g->columns) % g->columns;
			float range = g->range_m[r * g->columns + c];
			if (!(range > 0))
				continue;
			*ret_near = MIN(*ret_near, range);
			*ret_far = MAX(*ret_far, range);
		}
	return true;
}

static double solid_angle_sr(const range_grid *g, size_t i)
{
	double level = hypot(g->x_m[i], g->y_m[i]) / g->range_m[i];
	return g->column_rad * g->row_rad * level;
}

/* The points of one sweep as the other saw that place. */
static void look(const range_grid *from, const range_grid *into, const struct pose *pose,
	struct verification *v)
{
	for (size_t i = 0; i < range_grid_cells(from); i++) {
		float near, far;
		if (!(from->range_m[i] > 0))
			continue;
		double p[3] = { from->x_m[i], from->y_m[i], from->z_m[i] },
		       sr = solid_angle_sr(from, i);
		pose_apply(pose, p, p);
		double range = sqrt(dot(p, p)), slack = 0.15 + 0.02 * range;
		if (!nearest_about(into, p, &near, &far))
			v->outside_sr += sr;
		else if (range < near - slack)
			v->conflict_sr += sr;
		else if (range > far + slack)
			v->occluded_sr += sr;
		else
			v->agree_sr += sr;
	}
}

static void look_both_ways(const struct cloud_evidence *e, struct cloud_align_result *ret)
{
	struct verification *v = &ret->verification;
	struct pose back = pose_inverse(&ret->pose);
	ret->free_space = e->grid_a && e->grid_b;
	if (!ret->free_space)
		return;
	look(e->grid_b, e->grid_a, &ret->pose, v);
	look(e->grid_a, e->grid_b, &back, v);
	v->agreement = v->agree_sr / fmax(v->agree_sr + v->conflict_sr, 1e-9);
}

/* ---- the verdict ---- */

static enum verdict choose(
	const struct cloud_align_result *r, double n, double least, double voxel_m)
{
	const struct verification *v = &r->verification;
	bool free = r->free_space;
	if (n < AGREE_MIN || v->overlap < (free ? OVERLAP_MIN_FREE : OVERLAP_MIN_BLIND))
		return VERDICT_NO_OVERLAP;
	if (!free && least < SHARE_MIN_BLIND)
		return VERDICT_CONFLICT;
	if (free && v->agreement < AGREEMENT_MIN)
		return VERDICT_CONFLICT;
	if (v->balance < (free ? BALANCE_MIN_FREE : BALANCE_MIN_BLIND) ||
		r->fine.information_eigenvalues[0] < HELD_MIN)
		return VERDICT_SLIDING;
	if (v->rival_score > (free ? RIVAL_MAX_FREE : RIVAL_MAX_BLIND))
		return VERDICT_AMBIGUOUS;
	if (v->rms_m > RMS_MAX_VOXELS * voxel_m || v->deviation_m > DEVIATION_MAX_M ||
		v->deviation_rad > DEVIATION_MAX_RAD)
		return VERDICT_IMPRECISE;
	return VERDICT_ACCEPTED;
}

static void explain(struct cloud_align_result *r, double least)
{
	struct verification *v = &r->verification;
	const char *blind = r->free_space ? ""
					  : "; by agreement alone, as nobody knows from where "
					    "they were seen";
	char *into = v->reason;
	size_t room = sizeof v->reason;
	switch (v->verdict) {
	case VERDICT_ACCEPTED:
		snprintf(into, room, "%.0f %% of the surfaces agree within %.0f mm (rms)%s",
			100 * v->overlap, 1000 * v->rms_m, blind);
		break;
	case VERDICT_NO_OVERLAP:
		snprintf(into, room, "only %.0f %% of the surfaces agree%s", 100 * v->overlap,
			blind);
		break;
	case VERDICT_CONFLICT:
		if (!r->free_space)
			snprintf(into, room,
				"of the surfaces of one direction only %.0f %% agree%s",
				100 * least, blind);
		else
			snprintf(into, room,
				"%.0f %% of what both saw stands where the other saw through",
				100 * (1 - v->agreement));
		break;
	case VERDICT_SLIDING:
		snprintf(into, room,
			"what they share holds only some directions (balance %.2f, weakest %.3f)%s",
			v->balance, r->fine.information_eigenvalues[0], blind);
		break;
	case VERDICT_AMBIGUOUS:
		snprintf(into, room, "another pose fits %.0f %% as well%s", 100 * v->rival_score,
			blind);
		break;
	default:
		snprintf(into, room, "they fit, but only within %.0f mm (rms) and %.0f mm of place",
			1000 * v->rms_m, 1000 * v->deviation_m);
	}
}

void cloud_verdict(const struct cloud_evidence *e, struct cloud_align_result *ret)
{
	struct sums s = { 0 };
	struct verification *v = &ret->verification;
	double values[6] = { 0 }, vectors[6][6];
	*v = (struct verification){ .agreement = 1, .rival_score = e->rival_score };
	sum_up(e, &s);
	if (s.n < 10)
		return cloud_verdict_none(ret, "hardly a surface of one is near one of the other");
	sum_equations(e, &s);
	eigen(3, s.normals, values, vectors);
	v->overlap = fmin(s.n / fmax((double)MIN(e->count, e->points_of_a), 1), 1);
	v->rms_m = sqrt(s.square_m2 / s.n);
	v->under_6mm = s.under_6mm / s.n;
	v->balance = 3 * values[0] / s.n;
	hold(&s, ret);
	look_both_ways(e, ret);
	ret->fine.rms_m = v->rms_m;
	ret->fine.pairs = (uint32_t)s.n;
	ret->fine.inlier_share = s.n / (double)e->count;
	double least = least_share(e, vectors);
	v->verdict = choose(ret, s.n, least, e->voxel_m);
	explain(ret, least);
}

void cloud_verdict_none(struct cloud_align_result *ret, const char *why)
{
	ret->verification = (struct verification){ .verdict = VERDICT_NO_SOLUTION };
	snprintf(
		ret->verification.reason, sizeof ret->verification.reason, "nothing fits: %s", why);
}
