#include "process/coarse.h"
#include "process/coarse-check.h"
#include "process/coarse-view.h"
#include "process/plan.h"
#include <stdlib.h>
#include <string.h>

#define DISTANCE_MAX_M 40.0
#define SHIFTS         1200 /* that the votes propose */
#define QUICK          160  /* samples that judge them */
#define LOOKED_AT      80   /* that are refined */
#define MIDDLE         500  /* samples that refine them */
#define APART_M        0.5
#define APART_RAD      (3 * G_PI / 180)

struct coarse_scan {
	struct coarse_view *view;
	struct coarse_sample *sample;
	size_t samples;
	struct plan *plan; /* as levelled */
};

coarse_scan *coarse_scan_new(const range_grid *g)
{
	coarse_scan *s = g_new0(coarse_scan, 1);
	s->view = coarse_view_new(g);
	s->sample = coarse_samples_new(s->view, (double[3]){ 0, 0, 1 }, &s->samples);
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

static size_t propose(const coarse_scan *a, const coarse_scan *b, const struct plan *plan_a,
	const struct plan *plan_b, double distance_max_m, struct coarse_candidate *ret)
{
	g_autofree struct plan_shift *shift = g_new(struct plan_shift, SHIFTS);
	size_t count = plan_match(plan_a, plan_b, distance_max_m, shift, SHIFTS);
	for (size_t i = 0; i < count; i++) {
		ret[i].pose = plan_shift_pose(plan_a, plan_b, &shift[i]);
		ret[i].score = score_of(a, b, &ret[i].pose, QUICK, 0.5f);
	}
	qsort(ret, count, sizeof *ret, by_score);
	return keep_distinct(ret, count, LOOKED_AT);
}

static void refine(const coarse_scan *a, const coarse_scan *b, struct coarse_candidate *c)
{
	struct coarse_refining how = {
		.steps = 8, .gate_from_m = 1.2f, .gate_to_m = 0.25f, .tilt_sigma_rad = 0.01f
	};
	coarse_refine(a->view, b->sample, MIN(b->samples, MIDDLE), &how, &c->pose);
	pose_orthonormalise(&c->pose);
	c->score = score_of(a, b, &c->pose, G_MAXSIZE, 0.12f);
}

size_t coarse_align(const coarse_scan *a, const coarse_scan *b,
	const struct coarse_options *options, struct coarse_candidate *ret, size_t max)
{
	double distance_max_m =
		options && options->distance_max_m > 0 ? options->distance_max_m : DISTANCE_MAX_M;
	g_autofree struct coarse_candidate *c = g_new(struct coarse_candidate, SHIFTS);
	size_t count = propose(a, b, a->plan, b->plan, distance_max_m, c);
	for (size_t i = 0; i < count; i++)
		refine(a, b, &c[i]);
	qsort(c, count, sizeof *c, by_score);
	count = keep_distinct(c, count, MIN(max, SHIFTS));
	memcpy(ret, c, count * sizeof *c);
	return count;
}
