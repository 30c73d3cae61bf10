#include "process/fine.h"
#include "process/fine-pairs.h"
#include <stdlib.h>
#include <string.h>

/* From wide cells and a wide kernel to narrow ones. Within a stage the slack falls with each step, by a third at most, until
 * it is at its end. The last stage is for narrow cells, whose normals at edges differ most; those that hold a reveal or a
 * sill, and are uneven by it, lie on other parts of it for each scan, whole columns of them. */
static const struct fine_stage {
	double pitch_m;
	double slack_first_m, slack_last_m;
	uint32_t steps_max;
	uint32_t stride; /* of the cells that are looked for in the other scan */
	float cosine_min;
	bool around;
	float sigma_max_m; /* of the cells that count */
} stages[] = {
	{ 1.0, 0.80, 0.20, 16, 1, 0.60f, true, INFINITY },
	{ 0.5, 0.20, 0.06, 10, 1, 0.75f, true, INFINITY },
	{ 0.25, 0.06, 0.015, 8, 2, 0.85f, false, INFINITY },
	{ 0.10, 0.010, 0.001, 8, 2, 0.92f, false, INFINITY },
	{ 0.10, 0.001, 0.001, 8, 1, 0.92f, false, INFINITY },
	{ 0.10, 0.001, 0.001, 8, 1, 0.985f, false, 0.012f },
};
#define STAGES G_N_ELEMENTS(stages)
#define NARROW (STAGES - 1)
#define FINEST (STAGES - 2)

#define KERNEL_SCALE 2.5 /* where the weight is a quarter */
/* A pose where more than this stands where the other scan saw through is not the one that was looked for. From afar more
 * doubt is due: the next bay of a vaulted hall fits with 4 %. */
#define THROUGH_MAX_COARSE 0.03
#define THROUGH_MAX_NEAR   0.10

/* Which stages. */
static const struct {
	size_t first, last;
	double through_max;
} reaches[] = {
	[FINE_FROM_COARSE] = { 0, FINEST, THROUGH_MAX_COARSE },
	[FINE_FROM_NEAR] = { 1, FINEST, THROUGH_MAX_NEAR },
	[FINE_ROUGHLY] = { 1, 2, THROUGH_MAX_COARSE },
	[FINE_FROM_ROUGH] = { 3, FINEST, THROUGH_MAX_COARSE },
	[FINE_CLOSELY] = { NARROW, NARROW, THROUGH_MAX_NEAR },
};

#define PAIRS_MIN 100
/* Cells that are uneven by more than so many times the noise of a range do not hold the pose. */
#define EVEN_NOISES 1.6f
/* What is shared beyond a tile (one plane's points are in the planes of all its neighbours, and in many pairs), as measured:
 * against exact truth the normalised error is 1.4 to 3 without it. */
#define COVARIANCE_FACTOR 2.0
#define STILL_RAD         (0.0005 * G_PI / 180)
#define STILL_M           0.05e-3
#define SLACK_FACTOR      0.67

/* Widths are for a scene seen from this far, as sites are, or farther; of a smaller scene they are smaller. */
#define SCENE_M     4.0
#define SCENE_MIN_M 0.2

struct fine_scan {
	pyramid *pyramid;
	double scale; /* of the stages' pitches */
	struct sample *samples[STAGES];
	size_t count[STAGES];
};

/* ---- what is looked for ---- */

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* From the median of the ranges, of a level that is quickly read. */
static double scale_of(const pyramid *p)
{
	const struct pyramid_level *l = &p->level[2];
	size_t cells = (size_t)l->columns * l->rows, count = 0;
	g_autofree float *range = g_new(float, cells);
	for (size_t i = 0; i < cells; i++)
		if (l->surfel[i].range_m > 0)
			range[count++] = l->surfel[i].range_m;
	if (!count)
		return 1;
	qsort(range, count, sizeof *range, by_value);
	return CLAMP(range[count / 2], SCENE_MIN_M, SCENE_M) / SCENE_M;
}

/* Scanners that measure less closely have no cells that are more even. */
static float sigma_max_m(const pyramid *p, const struct fine_stage *stage)
{
	return fmaxf(stage->sigma_max_m, EVEN_NOISES * (float)p->noise_m);
}

static void take_level(const pyramid *p, int level, const struct fine_stage *stage, double pitch_m,
	struct sample *to, size_t *count)
{
	float most_m = sigma_max_m(p, stage);
	const struct pyramid_level *l = &p->level[level];
	for (uint32_t r = 0; r < l->rows; r += stage->stride)
		for (uint32_t c = (r / stage->stride) % stage->stride; c < l->columns;
			c += stage->stride) {
			const struct surfel *s = &l->surfel[(size_t)r * l->columns + c];
			if (!(s->sigma_m > 0 && s->sigma_m < most_m) ||
				pairing_level(p, pitch_m, s->range_m) != level)
				continue;
			struct sample *sample = &to[(*count)++];
			memcpy(sample->point_m, s->point_m, sizeof sample->point_m);
			memcpy(sample->normal, s->normal, sizeof sample->normal);
			sample->sigma_m = s->sigma_m;
		}
}

static void take_samples(fine_scan *s, size_t stage)
{
	const pyramid *p = s->pyramid;
	size_t cells = 0;
	for (int l = 0; l < PYRAMID_LEVELS; l++)
		cells += (size_t)(p->level[l].columns / stages[stage].stride + 1) *
			 (p->level[l].rows / stages[stage].stride + 1);
	struct sample *samples = g_new(struct sample, cells);
	for (int l = 0; l < PYRAMID_LEVELS; l++)
		take_level(p, l, &stages[stage], s->scale * stages[stage].pitch_m, samples,
			&s->count[stage]);
	s->samples[stage] = g_renew(struct sample, samples, s->count[stage]);
}

static fine_scan *make_scan(pyramid *p, size_t first_stage, size_t last_stage)
{
	fine_scan *s = g_new0(fine_scan, 1);
	s->pyramid = p;
	s->scale = scale_of(s->pyramid);
	for (size_t k = first_stage; k <= last_stage; k++)
		take_samples(s, k);
	return s;
}

fine_scan *fine_scan_new(const range_grid *g)
{
	return make_scan(pyramid_new(g), 0, FINEST);
}

fine_scan *fine_scan_new_narrow(const range_grid *g)
{
	return make_scan(pyramid_new_narrow(g), NARROW, NARROW);
}

void fine_scan_free(fine_scan *s)
{
	if (!s)
		return;
	pyramid_free(s->pyramid);
	for (size_t k = 0; k < STAGES; k++)
		g_free(s->samples[k]);
	g_free(s);
}

const pyramid *fine_scan_pyramid(const fine_scan *s)
{
	return s->pyramid;
}

/* ---- steps ---- */

/* Of the samples of a scan: what they are looked for in has cells of the same width. */
static struct pairing pairing_of(const fine_scan *of, size_t stage, double slack_m)
{
	const struct fine_stage *s = &stages[stage];
	return (struct pairing){ .pitch_m = of->scale * s->pitch_m,
		.slack_m = slack_m,
		.scale = KERNEL_SCALE,
		.cosine_min = s->cosine_min,
		.sigma_max_m = sigma_max_m(of->pyramid, s),
		.around = s->around };
}

/* What else a sum can tell; NULL: not asked for. */
struct findings {
	float *residual; /* of b's samples */
	struct pairs_look look;
	double (*tile)[6];
};

static void sum_both_ways(const fine_scan *a, const fine_scan *b, size_t stage, double slack_m,
	const struct pose *pose, struct equations *ret, struct findings *ret_findings)
{
	struct findings none = { 0 }, *f = ret_findings ? ret_findings : &none;
	struct pairing of_a = pairing_of(a, stage, slack_m), of_b = pairing_of(b, stage, slack_m);
	*ret = (struct equations){ 0 };
	pairs_sum(&of_b, b->samples[stage], b->count[stage], a->pyramid, pose, true, ret,
		f->residual, &f->look, f->tile);
	pairs_sum(&of_a, a->samples[stage], a->count[stage], b->pyramid, pose, false, ret, NULL,
		NULL, f->tile);
	equations_mirror(ret);
}

struct step {
	double turn_rad, move_m;
};

static bool take_step(const struct equations *e, struct pose *pose, struct step *ret)
{
	double twist[6];
	if (e->pairs < PAIRS_MIN || !equations_solve(e->matrix, e->right, twist))
		return false;
	*pose = pose_perturb(pose, twist);
	ret->turn_rad = sqrt(twist[0] * twist[0] + twist[1] * twist[1] + twist[2] * twist[2]);
	ret->move_m = sqrt(twist[3] * twist[3] + twist[4] * twist[4] + twist[5] * twist[5]);
	return isfinite(ret->turn_rad) && isfinite(ret->move_m);
}

static bool run_stage(const fine_scan *a, const fine_scan *b, size_t k, struct pose *pose,
	struct fine_result *ret)
{
	const struct fine_stage *s = &stages[k];
	double slack = s->slack_first_m;
	for (uint32_t i = 0; i < s->steps_max; i++) {
		struct equations e;
		struct step step;
		sum_both_ways(a, b, k, slack, pose, &e, NULL);
		if (!take_step(&e, pose, &step))
			return false;
		ret->iterations++;
		bool last = slack <= s->slack_last_m;
		ret->converged = last && step.turn_rad < STILL_RAD && step.move_m < STILL_M;
		if (ret->converged)
			return true;
		if (last && k < FINEST &&
			step.turn_rad * 10 + step.move_m < fmin(slack / 4, 0.3e-3))
			return true;
		slack = fmax(slack * SLACK_FACTOR, s->slack_last_m);
	}
	return true;
}

/* ---- what came of it ---- */

/* Residuals next to each other go together (a wall that is not even, a bush, a person), so the squares that the covariance is
 * made of are those of sums over tiles of the view: inverse(H) * sum of g * g^T * inverse(H), g of a tile. */
static bool covariance_of(const struct equations *e, double (*tile)[6], double ret[6][6])
{
	double inverse[6][6], middle[6][6] = { 0 }, half[6][6] = { 0 };
	if (!equations_invert(e->slope, inverse) && !equations_invert(e->matrix, inverse))
		return false;
	for (size_t t = 0; t < PAIRS_TILES; t++)
		for (int i = 0; i < 6; i++)
			for (int j = 0; j < 6; j++)
				middle[i][j] += tile[t][i] * tile[t][j];
	memset(ret, 0, sizeof(double[6][6]));
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			for (int k = 0; k < 6; k++)
				half[i][j] += inverse[i][k] * middle[k][j];
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			for (int k = 0; k < 6; k++)
				ret[i][j] += COVARIANCE_FACTOR * half[i][k] * inverse[k][j];
	return true;
}

static size_t count_within(const float *residual, size_t count, double gate)
{
	size_t within = 0;
	for (size_t i = 0; i < count; i++)
		within += fabsf(residual[i]) <= gate; /* not of NAN */
	return within;
}

static bool judge(const fine_scan *a, const fine_scan *b, size_t last, struct fine_result *ret)
{
	struct equations e;
	double scaled[6][6];
	g_autofree float *residual = g_new(float, b->count[last] + 1);
	g_autofree double(*tile)[6] = g_malloc0(PAIRS_TILES * sizeof *tile);
	struct findings f = { .residual = residual, .tile = tile };
	sum_both_ways(a, b, last, stages[last].slack_last_m, &ret->pose, &e, &f);
	size_t within = count_within(residual, b->count[last], KERNEL_SCALE);
	ret->pairs = e.pairs;
	ret->rms_m = e.weight > 0 ? sqrt(e.distance2_m2 / e.weight) : 0;
	ret->inlier_share = f.look.seen ? (double)within / f.look.seen : 0;
	ret->through_share =
		within ? (double)f.look.seen_through / (f.look.seen_through + within) : 1;
	equations_scale(&e, scaled);
	equations_eigenvalues(scaled, ret->information_eigenvalues);
	return e.pairs >= PAIRS_MIN && covariance_of(&e, tile, ret->covariance);
}

bool fine_align(const fine_scan *a, const fine_scan *b, const struct pose *start,
	enum fine_reach reach, struct fine_result *ret)
{
	*ret = (struct fine_result){ .pose = *start };
	bool good = true;
	size_t last = reaches[reach].last;
	for (size_t k = reaches[reach].first; k <= last && good; k++)
		good = run_stage(a, b, k, &ret->pose, ret);
	pose_orthonormalise(&ret->pose);
	good = judge(a, b, last, ret) && good;
	ret->converged &=
		good && last >= FINEST && ret->through_share <= reaches[reach].through_max;
	return good;
}
