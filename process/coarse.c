#include "process/coarse.h"
#include "process/coarse-check.h"
#include "process/coarse-upright.h"
#include "process/coarse-view.h"
#include "process/plan.h"
#include <stdlib.h>
#include <string.h>

#define DISTANCE_MAX_M    40.0
#define SHIFTS            1200  /* that the votes propose */
#define QUICK             160   /* samples that judge them */
#define LOOKED_AT         250   /* that are refined */
#define TILT_TURNED_RAD   0.05f /* levelled by walls and ground */
#define SCORE_MIN         0.05  /* below, nothing speaks for a candidate */
#define CONFLICT          3.0
#define DOUBT             0.02
#define UPRIGHTS          3
#define UNLIKELY          0.3 /* product of both scans' scores, relative to their best */
#define QUICK_TOLERANCE_M 0.5f
#define TOLERANCE_M       0.12f
#define APART_M           0.5
#define APART_RAD         (3 * G_PI / 180)

/* Many candidates are looked at with few samples, few with all. At first b hardly leans from what it was levelled to, so that
 * a poor start is not led into the ground. */
static const struct sieve {
	size_t refined_with, judged_with; /* samples */
	size_t keep;
	float tolerance_m;
	struct coarse_refining refining;
} sieves[] = {
	{ 300, 300, 40, 0.25f, { 4, 1.2f, 0.5f, 0.02f } },
	{ 900, G_MAXSIZE, 40, TOLERANCE_M, { 5, 0.6f, 0.2f, 0.05f } },
};

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

/* Both ways. What was seen through speaks against a pose more firmly than agreement speaks for it: walls agree wherever
 * they are slid along themselves. */
static double score_of(const coarse_scan *a, const coarse_scan *b, const struct pose *pose,
	size_t samples, float tolerance)
{
	struct coarse_fit fit = { 0 };
	struct pose back = pose_inverse(pose);
	coarse_check(a->view, b->sample, MIN(samples, b->samples), pose, tolerance, &fit);
	coarse_check(b->view, a->sample, MIN(samples, a->samples), &back, tolerance, &fit);
	if (!(fit.total > 0))
		return 0;
	return fit.agree / (fit.agree + CONFLICT * fit.conflict + DOUBT * fit.total);
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

/* One search: the scans with the samples that it uses, and what is asked for. */
struct search {
	const coarse_scan *a, *b;
	bool not_level;
	double distance_max_m;
	size_t max;
};

/* What votes and a quick look propose, with two plans; sorted. ret has room for SHIFTS. */
static size_t propose(const struct search *s, const struct plan *plan_a, const struct plan *plan_b,
	struct coarse_candidate *ret)
{
	g_autofree struct plan_shift *shift = g_new(struct plan_shift, SHIFTS);
	size_t count = plan_match(plan_a, plan_b, s->distance_max_m, shift, SHIFTS);
	for (size_t i = 0; i < count; i++) {
		ret[i].pose = plan_shift_pose(plan_a, plan_b, &shift[i]);
		ret[i].score = score_of(s->a, s->b, &ret[i].pose, QUICK, QUICK_TOLERANCE_M);
	}
	qsort(ret, count, sizeof *ret, by_score);
	return keep_distinct(ret, count, LOOKED_AT);
}

static void refine(const struct search *s, const struct sieve *sieve, struct coarse_candidate *c)
{
	struct coarse_refining how = sieve->refining;
	if (s->not_level)
		how.tilt_sigma_rad = TILT_TURNED_RAD;
	size_t samples = MIN(s->b->samples, sieve->refined_with);
	coarse_refine(s->a->view, s->b->sample, samples, &how, &c->pose);
	pose_orthonormalise(&c->pose);
	c->score = score_of(s->a, s->b, &c->pose, sieve->judged_with, sieve->tolerance_m);
	if (!(pose_distance_m(&c->pose) <= s->distance_max_m)) /* it was led astray */
		c->score = 0;
}

static size_t drop_hopeless(const struct coarse_candidate *c, size_t count)
{
	while (count && !(c[count - 1].score > SCORE_MIN))
		count--;
	return count;
}

/* Refines what was proposed, and keeps the best. */
static size_t choose(const struct search *s, struct coarse_candidate *c, size_t count)
{
	for (size_t k = 0; k < G_N_ELEMENTS(sieves); k++) {
		for (size_t i = 0; i < count; i++)
			refine(s, &sieves[k], &c[i]);
		qsort(c, count, sizeof *c, by_score);
		count = keep_distinct(c, drop_hopeless(c, count), sieves[k].keep);
	}
	return MIN(count, s->max);
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
static size_t propose_turned(const struct search *s, const struct turned *a, const struct turned *b,
	struct coarse_candidate *ret)
{
	size_t count = 0;
	for (size_t i = 0; i < a->count; i++)
		for (size_t k = 0; k < b->count; k++) {
			if (a->score[i] * b->score[k] < UNLIKELY)
				continue;
			count += propose(s, a->plan[i], b->plan[k], ret + count);
			qsort(ret, count, sizeof *ret, by_score);
			count = keep_distinct(ret, count, LOOKED_AT);
		}
	return count;
}

static size_t align_turned(const struct search *asked, struct coarse_candidate *c)
{
	struct turned a = turned_of(asked->a), b = turned_of(asked->b);
	struct search s = *asked;
	s.a = &a.scan;
	s.b = &b.scan;
	size_t count = choose(&s, c, propose_turned(&s, &a, &b, c));
	turned_clear(&a);
	turned_clear(&b);
	return count;
}

size_t coarse_align(const coarse_scan *a, const coarse_scan *b,
	const struct coarse_options *options, struct coarse_candidate *ret, size_t max)
{
	struct search s = { a, b, false, DISTANCE_MAX_M, max };
	if (options) {
		s.not_level = options->not_level;
		s.distance_max_m =
			options->distance_max_m > 0 ? options->distance_max_m : DISTANCE_MAX_M;
	}
	g_autofree struct coarse_candidate *c = g_new(struct coarse_candidate, SHIFTS + LOOKED_AT);
	size_t count =
		s.not_level ? align_turned(&s, c) : choose(&s, c, propose(&s, a->plan, b->plan, c));
	memcpy(ret, c, count * sizeof *c);
	return count;
}
