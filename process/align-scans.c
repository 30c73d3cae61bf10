#include "process/align-scans.h"
#include "process/cloud-align.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

/* To be raised when a pair may come out otherwise than before. */
#define ALIGN_METHOD 1

/* Clouds are thinned to voxels anyhow, grids need no more than this to meet one. */
#define CLOUD_POINTS_MAX 2000000u
#define GRID_POINTS_MAX  200000u
#define CLOUD_POINTS_MIN 100u /* as cloud_align has it */
/* A result further from its start is another solution. */
#define NEAR_M   0.5
#define NEAR_RAD (4 * G_PI / 180)
/* A given pose of a cloud that is refined by more is not the one that was checked. */
#define GIVEN_M   0.1
#define GIVEN_RAD (0.5 * G_PI / 180)
/* What a start is good to that could not be refined. */
#define START_SIGMA_M   0.05
#define START_SIGMA_RAD (0.5 * G_PI / 180)

struct align_scan {
	uint32_t number;
	enum scan_kind kind;
	char *fingerprint;
	pair_scan *pair;    /* NULL: a cloud */
	double (*point)[3]; /* of all its points, some */
	size_t count;
	double middle_m
		[3]; /* of these: where poses are compared, a cloud's origin may be far off */
};

/* ---- one scan ---- */

static void add_point(align_scan *s, double x, double y, double z)
{
	if (!isfinite(x) || !isfinite(y) || !isfinite(z))
		return;
	s->point[s->count][0] = x;
	s->point[s->count][1] = y;
	s->point[s->count++][2] = z;
}

/* Whole rows and columns, so that it still is a grid. */
static void take_of_grid(align_scan *s, const range_grid *g)
{
	uint32_t each = (uint32_t)ceil(sqrt((double)range_grid_cells(g) / GRID_POINTS_MAX));
	each = MAX(each, 1);
	size_t most = (size_t)(g->rows / each + 1) * (g->columns / each + 1);
	s->point = g_malloc_n(most, sizeof *s->point);
	for (uint32_t row = 0; row < g->rows; row += each)
		for (uint32_t column = 0; column < g->columns; column += each) {
			size_t i = (size_t)row * g->columns + column;
			if (g->range_m[i] > 0)
				add_point(s, g->x_m[i], g->y_m[i], g->z_m[i]);
		}
}

static uint32_t next_random(uint32_t *state) /* xorshift (Marsaglia 2003) */
{
	*state ^= *state << 13;
	*state ^= *state >> 17;
	return *state ^= *state << 5;
}

/* Drawn at random where there are too many: every tenth, say, might be always the same beam of a lidar. */
static void take_of_points(align_scan *s, const points *p)
{
	double share = fmin(1, (double)CLOUD_POINTS_MAX / fmax(1, (double)p->count));
	uint32_t state = 2463534242u;
	size_t most = share < 1 ? CLOUD_POINTS_MAX : p->count;
	s->point = g_malloc_n(most + 1, sizeof *s->point);
	for (uint64_t i = 0; i < p->count && s->count < most; i++) {
		const struct point_record *r = &p->record[i];
		if (share == 1 || next_random(&state) < share * (double)G_MAXUINT32)
			add_point(s, r->x_m, r->y_m, r->z_m);
	}
	s->point = g_realloc_n(s->point, s->count + 1, sizeof *s->point);
}

static void find_middle(align_scan *s)
{
	for (size_t i = 0; i < s->count; i++)
		for (int k = 0; k < 3; k++)
			s->middle_m[k] += (s->point[i][k] - s->middle_m[k]) / (double)(i + 1);
}

align_scan *align_scan_new(const scan_data *d, GError **error)
{
	return align_scan_new_known(d, NULL, error);
}

align_scan *align_scan_new_known(
	const scan_data *d, const struct pair_alikes *known, GError **error)
{
	if (!d->grid && !d->points) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"scan %04u was loaded without its points", d->number);
		return NULL;
	}
	align_scan *s = g_new0(align_scan, 1);
	s->number = d->number;
	s->kind = d->kind;
	s->fingerprint = g_strdup(d->fingerprint);
	if (d->grid) {
		s->pair = pair_scan_new_known(d->grid, known);
		take_of_grid(s, d->grid);
	} else {
		take_of_points(s, d->points);
	}
	find_middle(s);
	return s;
}

void align_scan_free(align_scan *s)
{
	if (!s)
		return;
	pair_scan_free(s->pair);
	g_free(s->point);
	g_free(s->fingerprint);
	g_free(s);
}

uint32_t align_scan_number(const align_scan *s)
{
	return s->number;
}

const char *align_scan_fingerprint(const align_scan *s)
{
	return s->fingerprint;
}

bool align_scan_alikes(const align_scan *s, struct pair_alikes *ret)
{
	if (s->pair)
		*ret = pair_scan_alikes(s->pair);
	return s->pair;
}

bool align_scan_is_cloud(const align_scan *s)
{
	return !s->pair;
}

uint64_t align_scan_bytes(const align_scan *s)
{
	return sizeof *s + s->count * sizeof *s->point + (s->pair ? pair_scan_bytes(s->pair) : 0);
}

/* ---- poses ---- */

struct apart {
	double m, rad;
};

/* How two poses of b differ, in the middle of it. */
static struct apart apart(const align_scan *b, const struct pose *x, const struct pose *y)
{
	struct pose d = pose_between(x, y);
	double p[3], q[3];
	pose_apply(x, b->middle_m, p);
	pose_apply(y, b->middle_m, q);
	return (struct apart){ hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]),
		pose_angle_rad(&d) };
}

static bool is_near(const align_scan *b, const struct pose *x, const struct pose *y)
{
	struct apart d = apart(b, x, y);
	return d.m <= NEAR_M && d.rad <= NEAR_RAD;
}

static void set_start_covariance(double ret[6][6])
{
	memset(ret, 0, 36 * sizeof(double));
	for (int i = 0; i < 6; i++)
		ret[i][i] = pow(i < 3 ? START_SIGMA_RAD : START_SIGMA_M, 2);
}

/* The pose is kept though a refinement would move it: as if that were noise. */
static void add_difference(
	double covariance[6][6], const struct pose *kept, const struct pose *refined)
{
	double twist[6];
	pose_difference(kept, refined, twist);
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			covariance[i][j] += twist[i] * twist[j];
}

static void take(struct edge *e, const struct pose *pose, const struct fine_result *fine,
	const struct verification *v)
{
	e->verification = *v;
	if (v->verdict == VERDICT_NO_SOLUTION)
		return;
	e->pose = *pose;
	memcpy(e->covariance, fine->covariance, sizeof e->covariance);
}

/* ---- two grids ---- */

/* Whether it may be that the scanners were not upright: then something else would be right. */
static bool may_tilt(const align_scan *a, const align_scan *b, const struct verification *v)
{
	bool foreign = a->kind == SCAN_ORDERED || b->kind == SCAN_ORDERED;
	return foreign && (v->verdict == VERDICT_NO_SOLUTION || v->verdict == VERDICT_NO_OVERLAP ||
				  v->verdict == VERDICT_CONFLICT);
}

/* A person should know that there is one that fits. */
static void mention_other(struct verification *v, const struct apart *d)
{
	size_t length = strlen(v->reason);
	g_snprintf(v->reason + length, sizeof v->reason - length,
		" Another pose, %.2f m and %.1f degrees away, fits.", d->m, d->rad * 180 / G_PI);
}

/* The search ended elsewhere than the start: what is at the start has that as its rival. */
static void stay_at_start(
	const align_scan *a, const align_scan *b, const struct pose *start, struct pair_result *r)
{
	struct pair_result other = *r;
	const struct verification *rival = &other.verification;
	if (rival->verdict == VERDICT_NO_SOLUTION)
		rival = NULL;
	pair_near(a->pair, b->pair, start, true, rival, r);
	if (!is_near(b, start, &r->pose))
		pair_near(a->pair, b->pair, start, false, rival, r);
	struct apart d = apart(b, start, &other.pose);
	if (rival && rival->verdict == VERDICT_ACCEPTED &&
		r->verification.verdict != VERDICT_ACCEPTED)
		mention_other(&r->verification, &d);
}

static void align_grids(
	const align_scan *a, const align_scan *b, const struct pose *start, struct edge *e)
{
	struct pair_options options = { .start = start };
	struct pair_result r, tilted;
	pair_align(a->pair, b->pair, &options, &r);
	if (may_tilt(a, b, &r.verification)) {
		options.not_level = true;
		pair_align(a->pair, b->pair, &options, &tilted);
		if (tilted.verification.verdict == VERDICT_ACCEPTED)
			r = tilted;
	}
	if (start && !is_near(b, start, &r.pose))
		stay_at_start(a, b, start, &r);
	take(e, &r.pose, &r.fine, &r.verification);
}

/* ---- clouds ---- */

static struct cloud_view view_of(const align_scan *s)
{
	return (struct cloud_view){
		.first = s->point, .count = s->count, .has_viewpoint = s->pair != NULL
	};
}

static void refuse(struct edge *e, enum verdict verdict, const char *format, ...)
	G_GNUC_PRINTF(3, 4);
static void refuse(struct edge *e, enum verdict verdict, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	e->verification.verdict = verdict;
	g_vsnprintf(e->verification.reason, sizeof e->verification.reason, format, arguments);
	va_end(arguments);
}

static bool has_points(const align_scan *a, const align_scan *b, struct edge *e)
{
	if (a->count >= CLOUD_POINTS_MIN && b->count >= CLOUD_POINTS_MIN)
		return true;
	e->verification = (struct verification){ 0 };
	refuse(e, VERDICT_NO_SOLUTION, "Scan %u has too few points to compare.",
		a->count < CLOUD_POINTS_MIN ? a->number : b->number);
	return false;
}

/* The search ended elsewhere than the start: what is at the start has that as its rival. */
static bool stay_near(const align_scan *a, const align_scan *b, const struct pose *start,
	struct edge *e, GError **error)
{
	struct cloud_view va = view_of(a), vb = view_of(b);
	struct edge other = *e;
	struct cloud_align_result r;
	if (!cloud_align_near(&va, &vb, start, &r, error))
		return false;
	take(e, &r.pose, &r.fine, &r.verification);
	struct apart d = apart(b, &e->pose, &other.pose);
	if (other.verification.verdict == VERDICT_ACCEPTED && !is_near(b, &e->pose, &other.pose))
		refuse(e, VERDICT_AMBIGUOUS, "Another pose, %.2f m and %.1f degrees away, fits.",
			d.m, d.rad * 180 / G_PI);
	return true;
}

static bool align_clouds(const align_scan *a, const align_scan *b, const struct pose *start,
	struct edge *e, GError **error)
{
	struct cloud_view va = view_of(a), vb = view_of(b);
	struct cloud_align_options options = { .start = start };
	struct cloud_align_result r;
	if (!has_points(a, b, e))
		return true;
	if (!cloud_align(&va, &vb, &options, &r, error))
		return false;
	take(e, &r.pose, &r.fine, &r.verification);
	return !start || is_near(b, start, &r.pose) || stay_near(a, b, start, e, error);
}

/* ---- edges ---- */

static struct edge begin(
	const align_scan *a, const align_scan *b, enum edge_origin origin, const struct pose *start)
{
	struct edge e = { .a = a->number,
		.b = b->number,
		.origin = origin,
		.pose = start ? *start : POSE_IDENTITY };
	set_start_covariance(e.covariance);
	return e;
}

/* The start itself, where what came out is another pose or none. */
static void fall_back(struct edge *e, const align_scan *b, const struct pose *start)
{
	if (!start ||
		(e->verification.verdict != VERDICT_NO_SOLUTION && is_near(b, start, &e->pose)))
		return;
	e->pose = *start;
	set_start_covariance(e->covariance);
	if (e->verification.verdict == VERDICT_ACCEPTED)
		refuse(e, VERDICT_NO_SOLUTION, "Nothing fits near the pose that it began with.");
}

bool align_scans(const align_scan *a, const align_scan *b, const struct pose *start,
	enum edge_origin origin, struct edge *ret, GError **error)
{
	*ret = begin(a, b, origin, start);
	if (a->pair && b->pair)
		align_grids(a, b, start, ret);
	else if (!align_clouds(a, b, start, ret, error))
		return false;
	fall_back(ret, b, start);
	ret->inputs = align_inputs(a->fingerprint, b->fingerprint, origin);
	return true;
}

static void check_grids(
	const align_scan *a, const align_scan *b, const struct pose *given, struct edge *e)
{
	struct pair_result r;
	pair_near(a->pair, b->pair, given, false, NULL, &r);
	take(e, &r.pose, &r.fine, &r.verification);
}

static bool check_clouds(const align_scan *a, const align_scan *b, const struct pose *given,
	struct edge *e, GError **error)
{
	struct cloud_view va = view_of(a), vb = view_of(b);
	struct cloud_align_result r;
	if (!has_points(a, b, e))
		return true;
	if (!cloud_align_near(&va, &vb, given, &r, error))
		return false;
	take(e, &r.pose, &r.fine, &r.verification);
	struct apart off = apart(b, given, &r.pose);
	e->pose = *given;
	add_difference(e->covariance, given, &r.pose);
	if (r.verification.verdict == VERDICT_ACCEPTED && (off.m > GIVEN_M || off.rad > GIVEN_RAD))
		refuse(e, VERDICT_CONFLICT,
			"The pose that came with the files is %.2f m and %.2f degrees from where "
			"the clouds fit.",
			off.m, off.rad * 180 / G_PI);
	return true;
}

bool align_scans_check(const align_scan *a, const align_scan *b, const struct pose *given,
	struct edge *ret, GError **error)
{
	*ret = begin(a, b, EDGE_GIVEN, given);
	if (a->pair && b->pair)
		check_grids(a, b, given, ret);
	else if (!check_clouds(a, b, given, ret, error))
		return false;
	ret->inputs = align_inputs(a->fingerprint, b->fingerprint, EDGE_GIVEN);
	return true;
}

char *align_inputs(const char *fingerprint_a, const char *fingerprint_b, enum edge_origin origin)
{
	static const char *const names[] = { "automatic", "picked", "given" };
	return g_strdup_printf(
		"method %d, %s, %s, %s", ALIGN_METHOD, names[origin], fingerprint_a, fingerprint_b);
}
