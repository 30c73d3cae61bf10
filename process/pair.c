#include "process/pair.h"
#include "process/verify-compare.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define CANDIDATES 16
/* Poses nearer than this are one solution, found twice. */
#define APART_M   0.10
#define APART_RAD (0.5 * G_PI / 180)

struct pair_scan {
	coarse_scan *coarse;
	fine_scan *fine;
	struct verify_view *view;
};

pair_scan *pair_scan_new(const range_grid *g)
{
	pair_scan *s = g_new0(pair_scan, 1);
	s->coarse = coarse_scan_new(g);
	s->fine = fine_scan_new(g);
	s->view = verify_view_new(g, fine_scan_pyramid(s->fine));
	return s;
}

void pair_scan_free(pair_scan *s)
{
	if (!s)
		return;
	coarse_scan_free(s->coarse);
	verify_view_free(s->view);
	fine_scan_free(s->fine);
	g_free(s);
}

static double cpu_seconds(void)
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- solutions: candidates, each refined and compared ---- */

struct solution {
	struct fine_result fine;
	struct verification verification;
};

static bool is_known(const struct solution *s, size_t count, const struct pose *pose)
{
	for (size_t i = 0; i < count; i++) {
		struct pose between = pose_between(&s[i].fine.pose, pose);
		if (pose_distance_m(&between) < APART_M && pose_angle_rad(&between) < APART_RAD)
			return true;
	}
	return false;
}

/* Refines a start; a solution that is new is compared and added. */
static size_t add_solution(const pair_scan *a, const pair_scan *b, const struct pose *start,
	enum fine_reach reach, struct solution *s, size_t count, struct pair_result *times)
{
	struct fine_result fine;
	double t0 = cpu_seconds();
	bool aligned = fine_align(a->fine, b->fine, start, reach, &fine);
	double t1 = cpu_seconds();
	times->fine_s += t1 - t0;
	if (!aligned || is_known(s, count, &fine.pose))
		return count;
	s[count].fine = fine;
	verify_measure(a->view, b->view, &fine, &s[count].verification, NULL);
	times->verify_s += cpu_seconds() - t1;
	return count + 1;
}

static size_t find_solutions(const pair_scan *a, const pair_scan *b, const struct pair_options *o,
	struct solution *s, struct pair_result *times)
{
	struct coarse_candidate candidate[CANDIDATES];
	struct coarse_options options = { .not_level = o && o->not_level };
	size_t count = 0;
	if (o && o->start)
		count = add_solution(a, b, o->start, FINE_FROM_NEAR, s, count, times);
	double t0 = cpu_seconds();
	size_t candidates = coarse_align(a->coarse, b->coarse, &options, candidate, CANDIDATES);
	times->coarse_s = cpu_seconds() - t0;
	for (size_t i = 0; i < candidates; i++)
		count = add_solution(a, b, &candidate[i].pose, FINE_FROM_COARSE, s, count, times);
	return count;
}

/* ---- the verdict ---- */

static int by_contradiction(const void *x, const void *y)
{
	double a = verify_contradiction(&((const struct solution *)x)->verification),
	       b = verify_contradiction(&((const struct solution *)y)->verification);
	return (a > b) - (a < b);
}

/* The likeliest first; those that share next to nothing cannot speak against another. */
static size_t rank(struct solution *s, size_t count)
{
	size_t kept = 0;
	for (size_t i = 0; i < count; i++)
		if (verify_is_evidence(&s[i].verification))
			s[kept++] = s[i];
	if (!kept)
		kept = MIN(count, 1);
	qsort(s, kept, sizeof *s, by_contradiction);
	return kept;
}

void pair_align(const pair_scan *a, const pair_scan *b, const struct pair_options *options,
	struct pair_result *ret)
{
	struct solution s[CANDIDATES + 1];
	*ret = (struct pair_result){ .pose = POSE_IDENTITY };
	size_t count = rank(s, find_solutions(a, b, options, s, ret));
	if (!count) {
		verify_no_solution(&ret->verification);
		return;
	}
	ret->fine = s[0].fine;
	ret->pose = s[0].fine.pose;
	ret->verification = s[0].verification;
	verify_judge(&ret->verification, &ret->fine, count > 1 ? &s[1].verification : NULL);
}

void pair_verify(const pair_scan *a, const pair_scan *b, const struct fine_result *fine,
	struct verification *ret, struct verify_map *ret_map)
{
	verify_measure(a->view, b->view, fine, ret, ret_map);
	verify_judge(ret, fine, NULL);
}
