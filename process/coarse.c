#include "process/coarse.h"
#include "process/coarse-check.h"
#include "process/coarse-upright.h"
#include "process/coarse-view.h"
#include "process/plan.h"
#include <stdlib.h>
#include <string.h>

#define DISTANCE_MAX_M    40.0
#define SHIFTS            1200 /* that the votes propose */
#define QUICK             160  /* samples that judge them */
#define LOOKED_AT         80   /* that are refined */
#define MIDDLE            500  /* samples that refine them */
#define UPRIGHTS          3
#define UNLIKELY          0.3 /* product of both scans' scores, relative to their best */
#define QUICK_TOLERANCE_M 0.5f
#define TOLERANCE_M       0.12f
#define APART_M           0.5
#define APART_RAD         (3 * G_PI / 180)

/* Levelled to half a degree; found by walls and ground. */
static const struct coarse_refining refining_level = { 8, 1.2f, 0.25f, 0.01f };
static const struct coarse_refining refining_turned = { 12, 1.2f, 0.25f, 0.05f };

struct coarse_scan {
	struct coarse_view *view;
	struct coarse_sample *sample;
	size_t samples;
	struct coarse_sample *even; /* whatever way they face */
	size_t evens;
	struct plan *plan; /* as levelled */
};

coarse_scan *coarse_scan_new(const range_grid *g)
{
	coarse_scan *s = g_new0(coarse_scan, 1);
	s->view = coarse_view_new(g);
	s->sample = coarse_samples_new(s->view, (double[3]){ 0, 0, 1 }, &s->samples);
	s->even = coarse_samples_new(s->view, (double[3]){ 0 }, &s->evens);
	s->plan = plan_new(s->view, &POSE_IDENTITY);
	return s;
}

void coarse_scan_free(coarse_scan *s)
{
	if (!s)
		return;
	coarse_view_free(s->view);
	plan_free(s->plan);
	g_free(s->sample);
	g_free(s->even);
	g_free(s);
}

/* Both ways. */
static double score_of(const coarse_scan *a, const coarse_scan *b, const struct pose *pose,
	size_t samples, float tolerance)
{
	struct coarse_fit fit = { 0 };
	struct pose back = pose_inverse(pose);
	coarse_check(a->view, b->sample, MIN(samples, b->samples), pose, tolerance, &fit);
	coarse_check(b->view, a->sample, MIN(samples, a->samples), &back, tolerance, &fit);
	if (!(fit.total > 0))
		return 0;
	double judged = fit.agree + fit.conflict;
	return fit.agree / (judged + 0.1 * fit.total);
}

static int by_score(const void *a, const void *b)
{
	const struct coarse_candidate *x = a, *y = b;
	if (x->score != y->score)
		return x->score < y->score ? 1 : -1;
	for (int i = 0; i < 3; i++)
		if (x->pose.translation_m[i] != y->pose.translation_m[i])
			return x->pose.translation_m[i] > y->pose.translation_m[i] ? 1 : -1;
	return 0;
}

static bool is_near(const struct pose *a, const struct pose *b)
{
	struct pose between = pose_between(a, b);
	return pose_distance_m(&between) < APART_M && pose_angle_rad(&between) < APART_RAD;
}

/* Keeps the first of those that are near each other. */
static size_t keep_distinct(struct coarse_candidate *c, size_t count, size_t max)
{
	size_t kept = 0;
	for (size_t i = 0; i < count && kept < max; i++) {
		bool known = false;
		for (size_t k = 0; k < kept && !known; k++)
			known = is_near(&c[k].pose, &c[i].pose);
		if (!known)
			c[kept++] = c[i];
	}
	return kept;
}

/* What votes and a quick look propose, with two plans; appended and sorted. */
static size_t propose(const coarse_scan *a, const coarse_scan *b, const struct plan *plan_a,
	const struct plan *plan_b, double distance_max_m, struct coarse_candidate *ret)
{
	g_autofree struct plan_shift *shift = g_new(struct plan_shift, SHIFTS);
	size_t count = plan_match(plan_a, plan_b, distance_max_m, shift, SHIFTS);
	for (size_t i = 0; i < count; i++) {
		ret[i].pose = plan_shift_pose(plan_a, plan_b, &shift[i]);
		ret[i].score = score_of(a, b, &ret[i].pose, QUICK, QUICK_TOLERANCE_M);
	}
	qsort(ret, count, sizeof *ret, by_score);
	return keep_distinct(ret, count, LOOKED_AT);
}

/* A scan with what may be up in it. Its samples are chosen anew, by the likeliest. */
struct turned {
	coarse_scan scan;
	struct plan *plan[UPRIGHTS];
	double score[UPRIGHTS];
	size_t count;
};

static struct turned turned_of(const coarse_scan *s)
{
	struct coarse_upright found[UPRIGHTS];
	struct turned t = { .scan = *s };
	t.count = coarse_upright_find(s->even, s->evens, found, UPRIGHTS);
	for (size_t i = 0; i < t.count; i++) {
		t.plan[i] = plan_new(s->view, &found[i].level);
		t.score[i] = found[i].score / found[0].score;
	}
	const double *up = found[0].level.rotation[2];
	t.scan.sample = coarse_samples_new(s->view, up, &t.scan.samples);
	return t;
}

static void turned_clear(struct turned *t)
{
	for (size_t i = 0; i < t->count; i++)
		plan_free(t->plan[i]);
	g_free(t->scan.sample);
}

/* Every direction that may be up in a, with every one in b. */
static size_t propose_turned(const struct turned *a, const struct turned *b, double distance_max_m,
	struct coarse_candidate *ret)
{
	size_t count = 0;
	for (size_t i = 0; i < a->count; i++)
		for (size_t k = 0; k < b->count; k++) {
			if (a->score[i] * b->score[k] < UNLIKELY)
				continue;
			count += propose(&a->scan, &b->scan, a->plan[i], b->plan[k], distance_max_m,
				ret + count);
			qsort(ret, count, sizeof *ret, by_score);
			count = keep_distinct(ret, count, LOOKED_AT);
		}
	return count;
}

/* Refines what was proposed, and keeps the best. */
static size_t choose(const coarse_scan *a, const coarse_scan *b, const struct coarse_refining *how,
	struct coarse_candidate *c, size_t count, size_t max)
{
	for (size_t i = 0; i < count; i++) {
		coarse_refine(a->view, b->sample, MIN(b->samples, MIDDLE), how, &c[i].pose);
		pose_orthonormalise(&c[i].pose);
		c[i].score = score_of(a, b, &c[i].pose, G_MAXSIZE, TOLERANCE_M);
	}
	qsort(c, count, sizeof *c, by_score);
	return keep_distinct(c, count, max);
}

static size_t align_level(const coarse_scan *a, const coarse_scan *b, double distance_max_m,
	struct coarse_candidate *c, size_t max)
{
	size_t count = propose(a, b, a->plan, b->plan, distance_max_m, c);
	return choose(a, b, &refining_level, c, count, max);
}

static size_t align_turned(const coarse_scan *a, const coarse_scan *b, double distance_max_m,
	struct coarse_candidate *c, size_t max)
{
	struct turned turned_a = turned_of(a), turned_b = turned_of(b);
	size_t count = propose_turned(&turned_a, &turned_b, distance_max_m, c);
	count = choose(&turned_a.scan, &turned_b.scan, &refining_turned, c, count, max);
	turned_clear(&turned_a);
	turned_clear(&turned_b);
	return count;
}

size_t coarse_align(const coarse_scan *a, const coarse_scan *b,
	const struct coarse_options *options, struct coarse_candidate *ret, size_t max)
{
	double distance_max_m =
		options && options->distance_max_m > 0 ? options->distance_max_m : DISTANCE_MAX_M;
	g_autofree struct coarse_candidate *c = g_new(struct coarse_candidate, SHIFTS + LOOKED_AT);
	size_t count = (options && options->not_level ? align_turned : align_level)(
		a, b, distance_max_m, c, MIN(max, LOOKED_AT));
	memcpy(ret, c, count * sizeof *c);
	return count;
}
