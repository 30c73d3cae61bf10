#include "process/profile-view.h"
#include "process/vector3.h"
#include <string.h>

/* The sweep is cut into so many bins at most, so many a spacing. */
#define BINS             128
#define BINS_PER_SPACING 4
/* Ranges waver by about this, or less; so far off a part, in noises, beams are of none. */
#define NOISE_LEAST_M 0.0012
#define NOISE_M       0.008
#define NOISE_MOST_M  0.016
#define NOISE_SHARE   0.3 /* of windows, the calmest, which no border runs through */
/* Where even the best of the plane fits around, one in so many, leaves more, they waver as it says: what is told in steps is calm between two. */
#define ERROR_SHARE   4
#define WINDOW_POINTS 12
#define OUT_NOISES    3.5f
/* What a part costs, in squares of noises: its plane and its border, by the logarithm of the points; what a beam costs that is of none. */
#define PART_COST       8.0
#define PART_PARAMETERS 4
/* Where beams come from is not known corners look rounded: parts cost more, and are so many bins wide. */
#define GUESSED_COST      120.0
#define GUESSED_WIDTH     BINS_PER_SPACING
#define GUESSED_NONE_COST 30.0
#define NONE_COST         7.0
#define POINTS_LEAST      8.0
/* Between a near face and one behind it beams meet both, and what they tell lies on a slope so steep, as narrow as a beam. */
#define STEEP 4.0
/* Of a part that is narrower than this, in spacings, where narrow ones are taken for flat. */
#define NARROW_SPACINGS 2
#define NARROW_SLOPE    1.25
/* The slope of a part must be told as well as this; where two meet they differ by so much more. */
#define SLOPE_ERROR  0.3
#define SLOPE_NOISES 3.0
/* A part slants along the piece by so much, 1 sigma, before its points say otherwise. */
#define ALONG_SLOPE 0.1
/* Parts that meet do so within so many bins of where one ends and the other begins, and turn by more than noise explains. */
#define MEET_BINS   2.0f
#define MEET_NOISES 3.0f
#define APART_COS   0.94f
/* What stands so much farther away ends in a shadow. */
#define SHADOW_M 0.015f

struct beam {
	float x, y,
		q; /* where it crosses the picture plane; how much nearer than the piece it was stopped, by inverse depth */
	uint32_t point;
	uint8_t bin;
	bool is_out;
};

struct sums {
	double n, x, y, q, xx, xy, yy, xq, yq, qq;
};

struct span {
	int from, to;   /* bins */
	double a, b, c; /* q = a + b x + c y */
	double noise2, points, xx, yy;
};

struct sweep {
	const GArray *near;
	double from[3], depth_m, to[2], y0;
	float bin_m, radius_m;
	int bins;
	bool is_guessed, is_narrow_flat;
	uint32_t beams;
	struct beam *beam;
	double noise_m; /* of q */
	struct sums sum[BINS + 1];
	struct span span[PROFILE_VIEW_PARTS];
	uint32_t spans;
};

/* ---- beams ---- */

/* x and y on a plane through the piece, facing the station; q in metres as depth is, but from its inverse. */
static void set_beam(const struct sweep *s, uint32_t point, struct beam *ret)
{
	const struct profile_near *p = &g_array_index(s->near, struct profile_near, point);
	double u = (double)p->u - s->from[0], v = (double)p->v - s->from[1],
	       t = (double)p->t - s->from[2];
	double depth = u * s->to[0] + v * s->to[1], aside = v * s->to[0] - u * s->to[1],
	       scale = s->depth_m / depth;
	ret->x = (float)(aside * scale);
	ret->y = (float)(t * scale - s->y0);
	ret->q = (float)((scale - 1) * s->depth_m);
	ret->point = point;
	ret->bin = (uint8_t)CLAMP((int)((ret->x + s->radius_m) / s->bin_m), 0, s->bins - 1);
	ret->is_out = false;
}

static void add_beam(struct sums *s, const struct beam *b)
{
	double x = (double)b->x, y = (double)b->y, q = (double)b->q;
	s->n += 1;
	s->x += x;
	s->y += y;
	s->q += q;
	s->xx += x * x;
	s->xy += x * y;
	s->yy += y * y;
	s->xq += x * q;
	s->yq += y * q;
	s->qq += q * q;
}

static struct sums between(const struct sweep *s, int from, int to)
{
	const struct sums *a = &s->sum[from], *b = &s->sum[to];
	return (struct sums){ b->n - a->n, b->x - a->x, b->y - a->y, b->q - a->q, b->xx - a->xx,
		b->xy - a->xy, b->yy - a->yy, b->xq - a->xq, b->yq - a->yq, b->qq - a->qq };
}

static void sum_up(struct sweep *s)
{
	memset(s->sum, 0, sizeof s->sum);
	for (uint32_t i = 0; i < s->beams; i++)
		if (!s->beam[i].is_out)
			add_beam(&s->sum[s->beam[i].bin + 1], &s->beam[i]);
	for (int n = 0; n < s->bins; n++) {
		double *to = (double *)&s->sum[n + 1];
		const double *from = (const double *)&s->sum[n];
		for (size_t k = 0; k < sizeof(struct sums) / sizeof(double); k++)
			to[k] += from[k];
	}
}

/* ---- a part ---- */

/* The plane of some bins; returns the squares that it leaves. */
static double fit(const struct sums *s, double noise_m, struct span *ret)
{
	double xx = s->xx - s->x * s->x / s->n + 1e-9, xy = s->xy - s->x * s->y / s->n,
	       yy = s->yy - s->y * s->y / s->n, xq = s->xq - s->x * s->q / s->n,
	       yq = s->yq - s->y * s->q / s->n, qq = s->qq - s->q * s->q / s->n;
	double held = yy + noise_m * noise_m / (ALONG_SLOPE * ALONG_SLOPE),
	       det = xx * held - xy * xy;
	double b = (xq * held - yq * xy) / det, c = (yq * xx - xq * xy) / det;
	if (ret) {
		ret->a = (s->q - b * s->x - c * s->y) / s->n;
		ret->b = b;
		ret->c = c;
		ret->points = s->n;
		ret->xx = xx;
		ret->yy = yy;
	}
	return fmax(qq - b * xq - c * yq, 0);
}

/* What would stand there were they in order; they change places (Wirth 1976, after Hoare's FIND). */
static double nth_least(double *of, int count, int nth)
{
	for (int low = 0, high = count - 1; low < high;) {
		const double pivot = of[nth];
		int i = low, j = high;
		while (i <= j) {
			while (of[i] < pivot)
				i++;
			while (of[j] > pivot)
				j--;
			if (i <= j) {
				double swap = of[i];
				of[i++] = of[j];
				of[j--] = swap;
			}
		}
		if (j < nth)
			low = i;
		if (i > nth)
			high = j;
	}
	return of[nth];
}

/* Of what plane fits leave, how far off the plane it is known to waver. */
static double least_noise_m(const struct sweep *s)
{
	g_autofree double *error = g_new(double, s->beams + 1);
	int some = 0;
	for (uint32_t i = 0; i < s->beams; i++) {
		float m = g_array_index(s->near, struct profile_near, s->beam[i].point).error_m;
		if (isfinite(m))
			error[some++] = (double)m;
	}
	return some ? nth_least(error, some, some / ERROR_SHARE) : 0;
}

/* What is left in the calmest of windows some beams wide. */
static double find_noise(const struct sweep *s)
{
	const double left_m = least_noise_m(s),
		     least_m = left_m > NOISE_MOST_M ? left_m : NOISE_LEAST_M;
	double left[BINS];
	int some = 0;
	for (int n = 0; n + BINS_PER_SPACING + 1 <= s->bins; n++) {
		struct sums sums = between(s, n, n + BINS_PER_SPACING + 1);
		if (sums.n >= WINDOW_POINTS)
			left[some++] = sqrt(fit(&sums, NOISE_M, NULL) / (sums.n - 3));
	}
	if (!some)
		return fmax(NOISE_M, least_m);
	return fmax(fmin(nth_least(left, some, (int)(NOISE_SHARE * some)), NOISE_MOST_M), least_m);
}

/* ---- all parts ---- */

struct best {
	double cost;
	int from; /* of the part that ends here; -1: the bin before is of none */
};

/* Whether a part so many bins wide may slope like that. */
static bool may_slope(const struct sweep *s, int bins, double slope)
{
	if (s->is_narrow_flat && bins < NARROW_SPACINGS * BINS_PER_SPACING)
		return fabs(slope) <= NARROW_SLOPE;
	return bins >= BINS_PER_SPACING || fabs(slope) < STEEP;
}

struct search {
	double part_cost, scale;
	double least
		[BINS]; /* of a part that begins there, up to where it was last tried, and of all before it */
	struct best best[BINS + 1];
};

static void try_part(const struct sweep *s, int from, int to, struct search *ret)
{
	struct best *best = &ret->best[to];
	struct sums sums = between(s, from, to);
	if (sums.n < POINTS_LEAST || s->sum[from + 1].n == s->sum[from].n ||
		(s->is_guessed && to - from < GUESSED_WIDTH))
		return;
	struct span span;
	double cost =
		ret->best[from].cost + ret->part_cost + fit(&sums, s->noise_m, &span) * ret->scale;
	ret->least[from] = cost;
	if (cost < best->cost && span.xx * SLOPE_ERROR * SLOPE_ERROR > s->noise_m * s->noise_m &&
		may_slope(s, to - from, span.b))
		*best = (struct best){ cost, from };
}

/* What a part leaves grows with its bins, so that one which cost too much up to the bin before needs no fit: most do. */
static void find_best(const struct sweep *s, struct search *ret)
{
	const double none_cost = s->is_guessed ? GUESSED_NONE_COST : NONE_COST;
	struct best *best = ret->best;
	ret->part_cost = (s->is_guessed ? GUESSED_COST : PART_COST) +
			 PART_PARAMETERS * log(fmax(s->sum[s->bins].n, 2.0));
	ret->scale = 1 / (s->noise_m * s->noise_m);
	best[0] = (struct best){ 0, -1 };
	for (int to = 1; to <= s->bins; to++) {
		double none = s->sum[to].n - s->sum[to - 1].n;
		ret->least[to - 1] = best[to - 1].cost + ret->part_cost;
		best[to] = (struct best){ best[to - 1].cost + none_cost * none, -1 };
		/* What was best up to there is likely best now. */
		if (best[to - 1].from >= 0)
			try_part(s, best[to - 1].from, to, ret);
		for (int from = to - 1; from >= 0; from--)
			if (ret->least[from] < best[to].cost)
				try_part(s, from, to, ret);
	}
}

static void find_parts(struct sweep *s)
{
	struct search search;
	const struct best *best = search.best;
	find_best(s, &search);
	s->spans = 0;
	for (int to = s->bins; to > 0;) {
		int from = best[to].from;
		if (from >= 0 && s->spans < PROFILE_VIEW_PARTS) {
			struct span *p = &s->span[s->spans++];
			struct sums sums = between(s, from, to);
			*p = (struct span){ .from = from, .to = to };
			p->noise2 = fit(&sums, s->noise_m, p) / fmax(sums.n - 3, 1);
		}
		to = from >= 0 ? from : to - 1;
	}
	for (uint32_t n = 0; n < s->spans / 2; n++) {
		struct span swap = s->span[n];
		s->span[n] = s->span[s->spans - 1 - n];
		s->span[s->spans - 1 - n] = swap;
	}
}

static float off_of(const struct span *p, const struct beam *b)
{
	return b->q - (float)(p->a + p->b * (double)b->x + p->c * (double)b->y);
}

static int span_of(const struct sweep *s, const struct beam *b)
{
	for (uint32_t n = 0; n < s->spans; n++)
		if (b->bin >= s->span[n].from && b->bin < s->span[n].to)
			return (int)n;
	return -1;
}

static void leave_out(struct sweep *s)
{
	for (uint32_t i = 0; i < s->beams; i++) {
		int n = span_of(s, &s->beam[i]);
		s->beam[i].is_out = n < 0 ? false
					  : fabsf(off_of(&s->span[n], &s->beam[i])) >
						    OUT_NOISES * (float)s->noise_m;
	}
}

/* Anew without the bins at borders, which may hold some of what is beside. */
static void fit_inside(struct sweep *s)
{
	for (uint32_t n = 0; n < s->spans; n++) {
		struct span *p = &s->span[n];
		if (p->to - p->from < 4)
			continue;
		struct sums sums = between(s, p->from + 1, p->to - 1);
		if (sums.n >= 2 * POINTS_LEAST && sums.n > 0.4 * p->points)
			p->noise2 = fit(&sums, s->noise_m, p) / (sums.n - 3);
	}
}

/* ---- what comes of it ---- */

/* Next to a border a beam is of the part that it fits best. */
static void share_out(const struct sweep *s, uint8_t *part_of)
{
	for (uint32_t i = 0; i < s->beams; i++) {
		const struct beam *b = &s->beam[i];
		float least = OUT_NOISES * (float)s->noise_m;
		for (uint32_t n = 0; n < s->spans; n++) {
			const struct span *p = &s->span[n];
			float off = fabsf(off_of(p, b));
			if (b->bin >= p->from - 1 && b->bin < p->to + 1 && off < least) {
				least = off;
				part_of[b->point] = (uint8_t)n;
			}
		}
	}
}

static struct profile_part part_of_span(const struct sweep *s, const struct span *p)
{
	struct profile_part part = { .points = (uint32_t)p->points };
	/* n . (place - station) = depth^2, of depth, aside and along. */
	double n[3] = { s->depth_m + p->a - p->c * s->y0, p->b * s->depth_m, p->c * s->depth_m };
	double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	double normal[3] = { n[0] * s->to[0] - n[1] * s->to[1], n[0] * s->to[1] + n[1] * s->to[0],
		n[2] };
	double off = s->depth_m * s->depth_m / length;
	for (int k = 0; k < 3; k++) {
		part.normal[k] = (float)(-normal[k] / length);
		off += normal[k] / length * s->from[k];
	}
	part.off_m = (float)-off;
	part.noise_m = (float)fmax(sqrt(p->noise2) * s->depth_m / length, NOISE_LEAST_M);
	double slope = s->noise_m * s->depth_m / length;
	part.along_information = (float)(p->yy / (slope * slope));
	return part;
}

/* The place in the section where a beam that crosses at x meets the plane of the part. */
static void place_at(const struct sweep *s, const struct span *p, float x, float ret[2])
{
	double q = p->a + p->b * (double)x, depth = s->depth_m / (1 + q / s->depth_m),
	       aside = (double)x * depth / s->depth_m;
	ret[0] = (float)(s->from[0] + depth * s->to[0] - aside * s->to[1]);
	ret[1] = (float)(s->from[1] + depth * s->to[1] + aside * s->to[0]);
}

static float x_of(const struct sweep *s, int bin)
{
	return (float)bin * s->bin_m - s->radius_m;
}

static void set_border(const struct sweep *s, uint32_t n, struct profile_view *ret)
{
	const struct span *a = &s->span[n], *b = &s->span[n + 1];
	struct profile_border *border = &ret->border[n];
	float last = x_of(s, a->to), first = x_of(s, b->from);
	double cross = fabs(a->b - b->b) > 1e-6 ? (b->a - a->a) / (a->b - b->b) : INFINITY;
	double error = MEET_NOISES * s->noise_m / fmax(fabs(a->b - b->b), 1e-6) *
		       sqrt(1 / a->points + 1 / b->points);
	double reach = (double)(MEET_BINS * s->bin_m) + fmin(error, 0.03);
	place_at(s, a, last, border->at[0]);
	place_at(s, b, first, border->at[1]);
	double step = (b->a + b->b * (double)first) - (a->a + a->b * (double)last);
	double turn = SLOPE_NOISES * s->noise_m * sqrt(1 / a->xx + 1 / b->xx);
	border->is_crease = fabs(a->b - b->b) > turn && cross > (double)last - reach &&
			    cross < (double)first + reach;
	if (border->is_crease)
		place_at(s, a, (float)cross, border->at[0]);
	border->is_shadow[0] = !border->is_crease && step > (double)SHADOW_M;
	border->is_shadow[1] = !border->is_crease && step < -(double)SHADOW_M;
}

static bool begin(
	struct sweep *s, const struct profile_viewer *viewer, const uint32_t *which, uint32_t count)
{
	s->depth_m = hypot(viewer->from[0], viewer->from[1]);
	if (s->depth_m < 2 * (double)viewer->radius_m || count < POINTS_LEAST)
		return false;
	s->is_guessed = viewer->is_guessed;
	s->is_narrow_flat = viewer->is_narrow_flat;
	memcpy(s->from, viewer->from, sizeof s->from);
	for (int k = 0; k < 2; k++)
		s->to[k] = -s->from[k] / s->depth_m;
	s->y0 = -s->from[2];
	s->radius_m = viewer->radius_m * 1.1f;
	s->bin_m = fmaxf(viewer->spacing_m / BINS_PER_SPACING, 2 * s->radius_m / BINS);
	s->bins = MIN((int)ceilf(2 * s->radius_m / s->bin_m), BINS);
	s->beam = g_new(struct beam, count);
	s->beams = count;
	for (uint32_t i = 0; i < count; i++)
		set_beam(s, which[i], &s->beam[i]);
	return true;
}

void profile_view_look(const GArray *near, const uint32_t *which, uint32_t count,
	const struct profile_viewer *viewer, uint8_t *part_of, struct profile_view *ret)
{
	struct sweep s = { .near = near };
	ret->parts = 0;
	if (!begin(&s, viewer, which, count))
		return;
	sum_up(&s);
	s.noise_m = find_noise(&s);
	find_parts(&s);
	leave_out(&s);
	sum_up(&s);
	find_parts(&s);
	fit_inside(&s);
	share_out(&s, part_of);
	ret->parts = s.spans;
	for (uint32_t n = 0; n < s.spans; n++)
		ret->part[n] = part_of_span(&s, &s.span[n]);
	for (uint32_t n = 0; n + 1 < s.spans; n++)
		set_border(&s, n, ret);
	g_free(s.beam);
}
