#include "process/pair.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define CANDIDATES 12
/* Candidates that score less than this share of the first are not worth their time. */
#define SCORE_SHARE 0.45
/* Poses of a scan to itself: how a place repeats. */
#define ALIKE_LOOKED_AT    8
#define ALIKE_MIN_SR       1.0
#define ALIKE_CONFLICT_MAX 0.15
#define SOLUTIONS_MAX      (CANDIDATES + 1 + 4 * PAIR_ALIKES_MOST + 2)
/* Poses nearer than this are one solution, found twice. */
#define APART_M   0.15
#define APART_RAD (0.7 * G_PI / 180)
/* Rivals this near are finished too, so many at most. */
#define CLOSE_THING 0.4
#define FINISHED    5

/* What stands beside the pyramid, about: the plans and views; per surfel, the samples and what is around it. */
#define COARSE_BYTES 2000000u
#define SURFEL_BYTES (sizeof(struct surfel) + 30)
#define NARROW_BYTES (sizeof(struct surfel) + 15)

struct pair_scan {
	coarse_scan *coarse;
	fine_scan *fine, *narrow;
	struct verify_view *view;
	struct pair_alikes alikes;
};

static double cpu_seconds(void)
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- solutions: starts, each refined and measured ---- */

struct solution {
	struct fine_result fine;
	struct verification verification;
	bool measured, finished; /* in full; came to rest */
};

struct search {
	const pair_scan *a, *b;
	struct solution solution[SOLUTIONS_MAX];
	size_t count;
	double fine_s, verify_s;
};

static bool is_same(const struct pose *a, const struct pose *b)
{
	struct pose between = pose_between(a, b);
	return pose_distance_m(&between) < APART_M && pose_angle_rad(&between) < APART_RAD;
}

static bool is_known(const struct search *s, const struct pose *pose)
{
	for (size_t i = 0; i < s->count; i++)
		if (is_same(&s->solution[i].fine.pose, pose))
			return true;
	return false;
}

static void measure(struct search *s, struct solution *to, enum verify_care care)
{
	double before = cpu_seconds();
	verify_measure(s->a->view, s->b->view, &to->fine, care, &to->verification, NULL);
	s->verify_s += cpu_seconds() - before;
}

/* Refines a start, roughly; a solution that is new is measured and added. */
static void try_start(struct search *s, const struct pose *start)
{
	if (s->count == SOLUTIONS_MAX || is_known(s, start))
		return;
	struct solution *next = &s->solution[s->count];
	double before = cpu_seconds();
	bool aligned = fine_align(s->a->fine, s->b->fine, start, FINE_ROUGHLY, &next->fine);
	s->fine_s += cpu_seconds() - before;
	if (!aligned || is_known(s, &next->fine.pose))
		return;
	measure(s, next, VERIFY_ROUGH);
	s->count++;
}

/* What shares too little to tell comes last, however little contradicts it. */
static int by_doubt(const void *x, const void *y)
{
	const struct solution *a = x, *b = y;
	const struct verification *v = &a->verification, *w = &b->verification;
	bool enough = verify_shares_enough(v), other_enough = verify_shares_enough(w);
	if (enough != other_enough)
		return enough ? -1 : 1;
	return (verify_doubt(v) > verify_doubt(w)) - (verify_doubt(v) < verify_doubt(w));
}

/* The likeliest first. */
static void rank(struct search *s)
{
	qsort(s->solution, s->count, sizeof *s->solution, by_doubt);
}

/* ---- one scan ---- */

/* A hall's half turn, a row of equal windows: where the scan comes to rest on itself elsewhere. */
static void find_alikes(pair_scan *s)
{
	struct coarse_candidate c[ALIKE_LOOKED_AT];
	size_t count = coarse_align(s->coarse, s->coarse, NULL, c, ALIKE_LOOKED_AT);
	g_autofree struct search *self = g_new0(struct search, 1);
	self->a = self->b = s;
	for (size_t i = 0; i < count; i++)
		try_start(self, &c[i].pose);
	qsort(self->solution, self->count, sizeof *self->solution, by_doubt);
	for (size_t i = 0; i < self->count && s->alikes.count < PAIR_ALIKES_MOST; i++) {
		const struct verification *v = &self->solution[i].verification;
		if (v->agree_sr >= ALIKE_MIN_SR && verify_contradiction(v) <= ALIKE_CONFLICT_MAX &&
			!is_same(&self->solution[i].fine.pose, &POSE_IDENTITY))
			s->alikes.pose[s->alikes.count++] = self->solution[i].fine.pose;
	}
}

pair_scan *pair_scan_new_known(const range_grid *g, const struct pair_alikes *known)
{
	pair_scan *s = g_new0(pair_scan, 1);
	s->coarse = coarse_scan_new(g);
	s->fine = fine_scan_new(g);
	s->narrow = fine_scan_new_narrow(g);
	s->view = verify_view_new(g, fine_scan_pyramid(s->fine));
	if (known)
		s->alikes = *known;
	else
		find_alikes(s);
	return s;
}

pair_scan *pair_scan_new(const range_grid *g)
{
	return pair_scan_new_known(g, NULL);
}

struct pair_alikes pair_scan_alikes(const pair_scan *s)
{
	return s->alikes;
}

void pair_scan_free(pair_scan *s)
{
	if (!s)
		return;
	coarse_scan_free(s->coarse);
	verify_view_free(s->view);
	fine_scan_free(s->fine);
	fine_scan_free(s->narrow);
	g_free(s);
}

static uint64_t bytes_of(const pyramid *p, size_t each)
{
	uint64_t bytes = 0;
	for (int i = 0; i < PYRAMID_LEVELS; i++)
		bytes += (uint64_t)p->level[i].columns * p->level[i].rows * each;
	return bytes;
}

uint64_t pair_scan_bytes(const pair_scan *s)
{
	return sizeof *s + COARSE_BYTES + bytes_of(fine_scan_pyramid(s->fine), SURFEL_BYTES) +
	       bytes_of(fine_scan_pyramid(s->narrow), NARROW_BYTES);
}

/* As closely as both scans allow. What does not come to rest near where it was stays as it was. */
static void align_closely(const pair_scan *a, const pair_scan *b, struct fine_result *fine)
{
	struct fine_result closer;
	if (fine_align(a->narrow, b->narrow, &fine->pose, FINE_CLOSELY, &closer) &&
		closer.converged && is_same(&fine->pose, &closer.pose))
		*fine = closer;
}

/* ---- the pair ---- */

static void try_candidates(struct search *s, const struct pair_options *o, double *ret_coarse_s)
{
	struct coarse_candidate c[CANDIDATES];
	struct coarse_options options = { .not_level = o && o->not_level };
	double before = cpu_seconds();
	size_t count = coarse_align(s->a->coarse, s->b->coarse, &options, c, CANDIDATES);
	*ret_coarse_s = cpu_seconds() - before;
	if (o && o->start)
		try_start(s, o->start);
	for (size_t i = 0; i < count && c[i].score >= SCORE_SHARE * c[0].score; i++)
		try_start(s, &c[i].pose);
}

/* Wherever either scan is like itself, the pair may be turned or shifted so. */
static void try_rivals(struct search *s)
{
	struct pose best = s->solution[0].fine.pose;
	for (int side = 0; side < 2; side++) {
		const pair_scan *scan = side ? s->b : s->a;
		for (size_t i = 0; i < scan->alikes.count; i++) {
			struct pose back = pose_inverse(&scan->alikes.pose[i]);
			struct pose one = side ? pose_compose(&best, &scan->alikes.pose[i])
					       : pose_compose(&scan->alikes.pose[i], &best);
			struct pose other =
				side ? pose_compose(&best, &back) : pose_compose(&back, &best);
			try_start(s, &one);
			try_start(s, &other);
		}
	}
}

/* What slides on from where it was roughly gets another try from there. */
static void finish(struct search *s, struct solution *solution)
{
	double before = cpu_seconds();
	solution->finished = false;
	for (int pass = 0; pass < 2 && !solution->finished; pass++) {
		struct pose rough = solution->fine.pose;
		if (!fine_align(s->a->fine, s->b->fine, &rough, FINE_FROM_ROUGH, &solution->fine))
			break;
		solution->finished = is_same(&rough, &solution->fine.pose);
	}
	s->fine_s += cpu_seconds() - before;
	measure(s, solution, VERIFY_FULL);
	solution->measured = true;
}

static void polish(struct search *s, struct solution *solution)
{
	double before = cpu_seconds();
	align_closely(s->a, s->b, &solution->fine);
	s->fine_s += cpu_seconds() - before;
	measure(s, solution, VERIFY_FULL);
}

static double rivalry(const struct search *s, size_t i)
{
	const struct solution *best = &s->solution[0], *other = &s->solution[i];
	return is_same(&best->fine.pose, &other->fine.pose)
		       ? 0
		       : verify_rivalry(&best->verification, &other->verification);
}

/* Of all but the first, the one that comes nearest to it. */
static const struct solution *find_rival(const struct search *s)
{
	const struct solution *rival = NULL;
	double nearest = 0;
	for (size_t i = 1; i < s->count; i++)
		if (rivalry(s, i) > nearest) {
			nearest = rivalry(s, i);
			rival = &s->solution[i];
		}
	return rival;
}

/* The likeliest in full, and its rivals where it is a close thing: seen so, another may be the likeliest. */
static void finish_likely(struct search *s)
{
	size_t count = 1;
	for (size_t i = 1; i < s->count && count < FINISHED; i++)
		if (rivalry(s, i) > CLOSE_THING) {
			struct solution close = s->solution[i];
			s->solution[i] = s->solution[count];
			s->solution[count++] = close;
		}
	for (size_t i = 0; i < count; i++)
		finish(s, &s->solution[i]);
	qsort(s->solution, count, sizeof *s->solution, by_doubt);
}

/* The rival that counts. What was measured roughly only is finished before it may count: poses off by centimetres let a wall
 * pass that is not there. */
static const struct solution *finish_rival(struct search *s)
{
	const struct solution *rival = find_rival(s);
	for (size_t k = 0; k < FINISHED && rival && !rival->measured &&
			   rivalry(s, (size_t)(rival - s->solution)) >= 1;
		k++) {
		finish(s, &s->solution[rival - s->solution]);
		rival = find_rival(s);
	}
	return rival;
}

static void decide(struct search *s, struct pair_result *ret)
{
	finish_likely(s);
	const struct solution *rival = finish_rival(s);
	struct solution *best = &s->solution[0];
	if (best->finished)
		polish(s, best);
	ret->fine = best->fine;
	ret->pose = best->fine.pose;
	ret->verification = best->verification;
	if (best->finished)
		verify_judge(&ret->verification, rival ? &rival->verification : NULL);
	else
		verify_no_solution(&ret->verification);
}

void pair_align(const pair_scan *a, const pair_scan *b, const struct pair_options *options,
	struct pair_result *ret)
{
	g_autofree struct search *s = g_new0(struct search, 1);
	*ret = (struct pair_result){ .pose = POSE_IDENTITY };
	s->a = a;
	s->b = b;
	try_candidates(s, options, &ret->coarse_s);
	rank(s);
	for (int pass = 0; pass < 2 && s->count; pass++) {
		struct pose best = s->solution[0].fine.pose;
		try_rivals(s);
		rank(s);
		if (is_same(&best, &s->solution[0].fine.pose))
			break;
	}
	if (s->count)
		decide(s, ret);
	else
		verify_no_solution(&ret->verification);
	ret->fine_s = s->fine_s;
	ret->verify_s = s->verify_s;
}

/* The pose that is kept though it could be refined: what that would change is taken for noise. */
static void keep_pose(struct fine_result *fine, const struct pose *kept)
{
	double twist[6];
	pose_difference(kept, &fine->pose, twist);
	fine->pose = *kept;
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			fine->covariance[i][j] += twist[i] * twist[j];
}

void pair_near(const pair_scan *a, const pair_scan *b, const struct pose *start, bool refine,
	const struct verification *rival, struct pair_result *ret)
{
	double begin = cpu_seconds();
	*ret = (struct pair_result){ .pose = *start };
	bool good = fine_align(a->fine, b->fine, start, FINE_FROM_NEAR, &ret->fine);
	if (good)
		align_closely(a, b, &ret->fine);
	double middle = cpu_seconds();
	ret->fine_s = middle - begin;
	if (!good) {
		verify_no_solution(&ret->verification);
		return;
	}
	struct fine_result fine = ret->fine;
	if (!refine)
		ret->fine.pose = *start;
	verify_measure(a->view, b->view, &ret->fine, VERIFY_FULL, &ret->verification, NULL);
	verify_judge(&ret->verification, rival);
	if (!refine) {
		ret->fine = fine;
		keep_pose(&ret->fine, start);
	}
	ret->pose = ret->fine.pose;
	ret->verify_s = cpu_seconds() - middle;
}

void pair_verify(const pair_scan *a, const pair_scan *b, const struct fine_result *fine,
	struct verification *ret, struct verify_map *ret_map)
{
	verify_measure(a->view, b->view, fine, VERIFY_FULL, ret, ret_map);
	verify_judge(ret, NULL);
}
