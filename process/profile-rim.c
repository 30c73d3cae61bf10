#include "process/profile-rim.h"
#include "process/normal-equations.h"
#include "process/profile-faces.h"
#include "process/vector3.h"
#include <string.h>

/* The face is fitted as far from its end as this, and points on it lie so near to it. */
#define FACE_M        0.25f
#define FACE_SPACINGS 10.0f
#define NEAR_M        0.012f
#define WIDER_M       0.03f /* where none lie so near */
#define NEAR_COS      -0.3f
#define FACE_FITS     4
#define FACE_POINTS   16
#define FACE_TURN     0.2 /* at most, in both directions */
#define NOISES        2.5
#define NOISE_LEAST_M 0.002
/* The end is looked for so far to both sides of where it was. */
#define BAND_M        0.03f
#define BAND_SPACINGS 2.5f
/* A beam is not on the face when no point is within this part of the way to it. */
#define MISSED_SHARE 0.55
/* Beams that graze the face are too far apart there to tell. */
#define GRAZING_COS 0.08f
/* Nor does a pair of beams as far apart there as a scanner's are head-on so far away; and of ends that none tells, or whose face is not known
 * and whose points are as far apart as beams are at the second distance, nobody can say where they are. */
#define GAP_MOST_AT_M 40.0
#define SPARSE_AT_M   20.0
#define GAPS_LEAST    4u
#define FITS          6
#define HALF_LEAST_M  0.002
/* In the middle of an interval it is a little likelier than near its ends. */
#define MIDDLE_WEIGHT 0.15
/* Before they say otherwise it runs as it did. */
#define SLOPE_WEIGHT 0.01
/* So many of the intervals reach to the line, or nearly, when it is one. */
#define REACH_M     0.006
#define REACH_SHARE 0.33
/* A face that no station sees so many beams of, across, is none, and where it begins another, at least twice as wide, ends. Points so
 * near to a crease's faces are on them, of those as far around. */
#define NARROW_BEAMS    1.3
#define ON_M            0.006f
#define ON_SPACINGS     0.2f
#define AROUND_M        0.1f
#define AROUND_SPACINGS 4.0f

struct rim_point {
	double beside, along;
	uint32_t of; /* of near */
};
struct gap {
	double beside, along, half_m;
};

struct rim {
	const profile_around *all;
	struct profile_frame frame;
	GArray *near;
	double half_m, side;
	double normal[3], off_m, across[3]; /* in the frame; across: in the face, out of it */
	double noise_m;
	float band_m;
	GArray *on; /* of struct rim_point, along */
};

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static const struct profile_near *near_at(const struct rim *r, guint i)
{
	return &g_array_index(r->near, struct profile_near, i);
}

static void place_of(const struct profile_near *p, double ret[3])
{
	ret[0] = (double)p->u;
	ret[1] = (double)p->v;
	ret[2] = (double)p->t;
}

/* ---- the face ---- */

/* Across the piece, in the face. */
static bool set_across(struct rim *r)
{
	double length = hypot(r->normal[0], r->normal[1]);
	if (!(length > 0.5))
		return false;
	r->across[0] = -r->side * r->normal[1] / length;
	r->across[1] = r->side * r->normal[0] / length;
	r->across[2] = 0;
	return true;
}

static bool faces_along(const struct rim *r, const struct profile_near *p)
{
	const float normal[3] = { (float)r->normal[0], (float)r->normal[1], (float)r->normal[2] };
	return vector3_dot(p->normal, normal) >= NEAR_COS;
}

/* To the side on which there are more points. */
static bool find_side(struct rim *r)
{
	uint32_t count[2] = { 0 };
	r->side = 1;
	if (!set_across(r))
		return false;
	for (guint i = 0; i < r->near->len; i++) {
		double at[3];
		place_of(near_at(r, i), at);
		if (fabs(dot(at, r->normal) - r->off_m) < (double)NEAR_M &&
			faces_along(r, near_at(r, i)))
			count[dot(at, r->across) > 0]++;
	}
	r->side = count[1] > count[0] ? -1 : 1;
	return count[0] + count[1] >= FACE_POINTS && set_across(r);
}

/* By least squares of what is off it; what is far off counts less. */
static bool fit_face_to(struct rim *r, double near_m)
{
	double reach_m = near_m, x[3] = { 0 };
	const double off_m = r->off_m;
	for (int fit = 0; fit < FACE_FITS; fit++) {
		double information[9] = { 0 }, gradient[3] = { 0 }, weights = 0, squares = 0;
		for (guint i = 0; i < r->near->len; i++) {
			double at[3];
			place_of(near_at(r, i), at);
			double row[3] = { 1, dot(at, r->across), at[2] },
			       off = dot(at, r->normal) - off_m,
			       left = off - x[0] - x[1] * row[1] - x[2] * row[2];
			if (row[1] > 0 || !(fabs(left) < reach_m) || !faces_along(r, near_at(r, i)))
				continue;
			double weight = 1 - left * left / (reach_m * reach_m);
			for (int j = 0; j < 3; j++) {
				gradient[j] += weight * row[j] * off;
				for (int k = 0; k < 3; k++)
					information[3 * j + k] += weight * row[j] * row[k];
			}
			weights += weight;
			squares += weight * left * left;
		}
		information[4] += 1e-3;
		information[8] += 1e-3;
		if (weights < FACE_POINTS ||
			!normal_equations_solve(information, gradient, 3, x, NULL))
			return false;
		r->noise_m = fmax(sqrt(squares / weights), NOISE_LEAST_M);
		reach_m = fmax(3 * r->noise_m, 0.006);
	}
	if (fabs(x[1]) > FACE_TURN || fabs(x[2]) > FACE_TURN)
		return false;
	double length = 0;
	for (int k = 0; k < 3; k++)
		r->normal[k] -= x[1] * r->across[k] + (k == 2 ? x[2] : 0);
	length = sqrt(dot(r->normal, r->normal));
	for (int k = 0; k < 3; k++)
		r->normal[k] /= length;
	r->off_m = (off_m + x[0]) / length;
	return set_across(r);
}

static bool fit_face(struct rim *r)
{
	const struct rim was = *r;
	if (fit_face_to(r, (double)NEAR_M))
		return true;
	*r = was;
	return fit_face_to(r, (double)WIDER_M);
}

/* ---- beams ---- */

struct seen_from {
	double at[3], up[3], beam_rad;
};

static bool station_of(const struct rim *r, uint16_t scan, struct seen_from *ret)
{
	struct profile_station s;
	if (!profile_around_station(r->all, scan, &s) || !(s.beam_rad > 0))
		return false;
	ret->beam_rad = s.beam_rad;
	for (int j = 0; j < 3; j++) {
		ret->at[j] = ret->up[j] = 0;
		for (int k = 0; k < 3; k++) {
			ret->at[j] += (double)r->frame.axis[j][k] * (s.at_m[k] - r->frame.at[k]);
			ret->up[j] += (double)r->frame.axis[j][k] * s.up[k];
		}
	}
	return true;
}

/* Where a beam that goes that way cuts the face: beside and along. false: at too flat an angle. */
static bool cut_face(
	const struct rim *r, const struct seen_from *s, const double way[3], double ret[2])
{
	double facing = dot(way, r->normal), length = sqrt(dot(way, way));
	if (fabs(facing) < (double)GRAZING_COS * length)
		return false;
	double far = (r->off_m - dot(s->at, r->normal)) / facing, at[3];
	for (int k = 0; k < 3; k++)
		at[k] = s->at[k] + far * way[k];
	ret[0] = dot(at, r->across);
	ret[1] = at[2];
	return far > 0;
}

static int by_along(const void *a, const void *b)
{
	const struct rim_point *x = a, *y = b;
	if (x->along != y->along)
		return x->along < y->along ? -1 : 1;
	return (x->beside > y->beside) - (x->beside < y->beside);
}

/* The beams that met the face near its end; returns how many graze it. */
static uint32_t gather_on(struct rim *r)
{
	struct seen_from from = { 0 };
	int scan = -1;
	bool is_known = false;
	uint32_t grazing = 0;
	g_array_set_size(r->on, 0);
	for (guint i = 0; i < r->near->len; i++) {
		const struct profile_near *p = near_at(r, i);
		double at[3], way[3], cut[2];
		place_of(p, at);
		if (fabs(dot(at, r->normal) - r->off_m) > NOISES * r->noise_m || !faces_along(r, p))
			continue;
		if (p->scan != scan) {
			scan = p->scan;
			is_known = station_of(r, p->scan, &from);
		}
		for (int k = 0; k < 3; k++)
			way[k] = at[k] - from.at[k];
		if (!is_known)
			continue;
		if (!cut_face(r, &from, way, cut)) {
			grazing++;
			continue;
		}
		if (fabs(cut[0]) > (double)r->band_m)
			continue;
		struct rim_point on = { cut[0], cut[1], i };
		g_array_append_val(r->on, on);
	}
	g_array_sort(r->on, by_along);
	return grazing;
}

/* Whether a point of the face is so near. */
static bool is_met(const struct rim *r, const double at[2], double reach_m)
{
	guint low = 0, high = r->on->len;
	while (low < high) {
		guint middle = (low + high) / 2;
		if (g_array_index(r->on, struct rim_point, middle).along < at[1] - reach_m)
			low = middle + 1;
		else
			high = middle;
	}
	for (guint i = low; i < r->on->len; i++) {
		const struct rim_point *p = &g_array_index(r->on, struct rim_point, i);
		if (p->along > at[1] + reach_m)
			return false;
		if (hypot(p->beside - at[0], p->along - at[1]) < reach_m)
			return true;
	}
	return false;
}

/* The beams beside that of the point, in its row and its column: those that went past the end. */
static void add_gaps(const struct rim *r, const struct rim_point *on, GArray *ret)
{
	const struct profile_near *p = near_at(r, on->of);
	struct seen_from s;
	double at[3], way[3], aside[3], upward[3];
	if (!station_of(r, p->scan, &s))
		return;
	place_of(p, at);
	for (int k = 0; k < 3; k++)
		way[k] = at[k] - s.at[k];
	double far = sqrt(dot(way, way)), rise = dot(s.up, way) / far;
	for (int k = 0; k < 3; k++) {
		aside[k] =
			s.up[(k + 1) % 3] * way[(k + 2) % 3] - s.up[(k + 2) % 3] * way[(k + 1) % 3];
		upward[k] = (s.up[k] * far - rise * way[k]) / sqrt(fmax(1 - rise * rise, 0.01));
	}
	for (int n = 0; n < 4; n++) {
		double next[3], cut[2];
		for (int k = 0; k < 3; k++)
			next[k] = way[k] +
				  (n & 1 ? 1 : -1) * s.beam_rad * (n & 2 ? upward[k] : aside[k]);
		if (!cut_face(r, &s, next, cut))
			continue;
		double apart = hypot(cut[0] - on->beside, cut[1] - on->along);
		if (cut[0] - on->beside < 0.3 * apart || apart > GAP_MOST_AT_M * s.beam_rad ||
			fabs(cut[1]) > r->half_m || is_met(r, cut, MISSED_SHARE * apart))
			continue;
		struct gap gap = { (cut[0] + on->beside) / 2, (cut[1] + on->along) / 2,
			fmax((cut[0] - on->beside) / 2, HALF_LEAST_M) };
		g_array_append_val(ret, gap);
	}
}

/* ---- the line ---- */

/* A line through the gaps, x[0] + x[1] along: what is near the middle of most, then what is inside of them. */
static bool fit_gaps(const struct rim *r, const GArray *gaps, double x[2])
{
	double reach_m = (double)r->band_m;
	for (int fit = 0; fit < FITS; fit++) {
		double information[4] = { 0 }, gradient[2] = { 0 }, weights = 0, squares = 0;
		for (guint n = 0; n < gaps->len; n++) {
			const struct gap *g = &g_array_index(gaps, struct gap, n);
			double row[2] = { 1, g->along }, off = g->beside - x[0] - x[1] * g->along,
			       past = fmax(fabs(off) - g->half_m, 0);
			if (past > reach_m)
				continue;
			double weight = (1 - past * past / (reach_m * reach_m)) /
					(g->half_m * g->half_m),
			       to = g->beside;
			/* Inside of an interval all places are nearly as good. */
			if (fit >= FITS / 2 && past > 0)
				to -= copysign(g->half_m, off);
			else if (fit >= FITS / 2)
				weight *= MIDDLE_WEIGHT;
			for (int j = 0; j < 2; j++) {
				gradient[j] += weight * row[j] * to;
				for (int k = 0; k < 2; k++)
					information[2 * j + k] += weight * row[j] * row[k];
			}
			weights += weight;
			squares += weight * past * past;
		}
		information[3] += SLOPE_WEIGHT * weights * r->half_m * r->half_m;
		if (!(weights > 0) || !normal_equations_solve(information, gradient, 2, x, NULL))
			return false;
		reach_m = fmax(2.5 * sqrt(squares / weights), 0.01);
	}
	return true;
}

static bool is_borne_out(const GArray *gaps, const double x[2])
{
	uint32_t some = 0;
	for (guint n = 0; n < gaps->len; n++) {
		const struct gap *g = &g_array_index(gaps, struct gap, n);
		some += fabs(g->beside - x[0] - x[1] * g->along) < g->half_m + REACH_M;
	}
	return some >= GAPS_LEAST && some >= REACH_SHARE * gaps->len;
}

/* From one place in the frame to the other. */
static void set_line(const struct rim *r, double at[2][3], struct profile_piece *p)
{
	double end[2][3], length = 0;
	for (int n = 0; n < 2; n++)
		for (int k = 0; k < 3; k++) {
			end[n][k] = r->frame.at[k];
			for (int j = 0; j < 3; j++)
				end[n][k] += at[n][j] * (double)r->frame.axis[j][k];
		}
	for (int k = 0; k < 3; k++)
		length += (end[1][k] - end[0][k]) * (end[1][k] - end[0][k]);
	length = sqrt(length);
	for (int k = 0; k < 3; k++) {
		p->line.at[k] = end[0][k];
		p->line.along[k] = (end[1][k] - end[0][k]) / length;
	}
	p->from_m = 0;
	p->to_m = length;
}

static void set_face(const struct rim *r, float ret[3])
{
	for (int k = 0; k < 3; k++) {
		ret[k] = 0;
		for (int j = 0; j < 3; j++)
			ret[k] += (float)r->normal[j] * r->frame.axis[j][k];
	}
}

static bool begin_face(struct rim *r, const float normal[3])
{
	for (int k = 0; k < 3; k++)
		r->normal[k] = (double)vector3_dot(normal, r->frame.axis[k]);
	r->off_m = 0;
	return find_side(r) && fit_face(r);
}

/* Whether points are farther apart than beams of any of their stations are at SPARSE_AT_M; false: nobody knows. */
static bool is_sparse(const struct rim *r, const struct profile_piece *p)
{
	struct seen_from s = { 0 };
	double most_rad = 0;
	int scan = -1;
	for (guint i = 0; i < r->near->len; i++) {
		const struct profile_near *n = near_at(r, i);
		if (n->scan != scan && !station_of(r, n->scan, &s))
			return false;
		scan = n->scan;
		most_rad = fmax(most_rad, s.beam_rad);
	}
	return scan >= 0 && (double)p->spacing_m > SPARSE_AT_M * most_rad;
}

static enum profile_rim fit_rim(struct rim *r, struct profile_piece *p)
{
	double x[2] = { 0 }, at[2][3];
	if (!begin_face(r, p->face[0]))
		return is_sparse(r, p) ? PROFILE_RIM_NONE : PROFILE_RIM_UNKNOWN;
	uint32_t grazing = gather_on(r);
	if (r->on->len < GAPS_LEAST)
		return grazing < GAPS_LEAST ? PROFILE_RIM_UNKNOWN : PROFILE_RIM_NONE;
	g_autoptr(GArray) gaps = g_array_new(FALSE, FALSE, sizeof(struct gap));
	for (guint n = 0; n < r->on->len; n++)
		add_gaps(r, &g_array_index(r->on, struct rim_point, n), gaps);
	if (gaps->len < GAPS_LEAST || !fit_gaps(r, gaps, x) ||
		fabs(x[0]) + fabs(x[1]) * r->half_m > (double)r->band_m || !is_borne_out(gaps, x))
		return PROFILE_RIM_NONE;
	for (int n = 0; n < 2; n++) {
		double t = n ? r->half_m : -r->half_m, flat = hypot(r->normal[0], r->normal[1]),
		       up = (r->off_m - r->normal[2] * t) / flat;
		for (int k = 0; k < 2; k++)
			at[n][k] = up * r->normal[k] / flat + (x[0] + x[1] * t) * r->across[k];
		at[n][2] = t;
	}
	set_line(r, at, p);
	set_face(r, p->face[0]);
	return PROFILE_RIM_FITTED;
}

/* ---- creases ---- */

/* A face of a crease in the frame of that; both go through its origin. */
struct crease_face {
	float normal[3], across[3];
	float on_m;
};

static struct crease_face crease_face_of(const struct rim *r, const float normal[3], float on_m)
{
	struct crease_face b = { .on_m = on_m };
	for (int k = 0; k < 3; k++)
		b.normal[k] = vector3_dot(normal, r->frame.axis[k]);
	b.across[0] = -b.normal[1];
	b.across[1] = b.normal[0];
	vector3_unit(b.across);
	return b;
}

/* On the face, and not on the other; how far beside the crease. */
static bool is_on_alone(const struct profile_near *p, const struct crease_face *face,
	const struct crease_face *other, float *ret_beside_m)
{
	const float at[3] = { p->u, p->v, p->t };
	*ret_beside_m = vector3_dot(at, face->across);
	return fabsf(vector3_dot(at, face->normal)) < face->on_m &&
	       fabsf(vector3_dot(at, other->normal)) >= other->on_m &&
	       vector3_dot(p->normal, face->normal) >= NEAR_COS;
}

/* How many beams beside that through the crease it was, as its station sees it. */
static double beams_from(const struct seen_from *s, const struct profile_near *p)
{
	double depth = hypot(s->at[0], s->at[1]), to[2] = { -s->at[0] / depth, -s->at[1] / depth },
	       u = (double)p->u - s->at[0], v = (double)p->v - s->at[1];
	return (v * to[0] - u * to[1]) / (u * to[0] + v * to[1]) * depth / hypot(depth, s->at[2]) /
	       s->beam_rad;
}

struct width {
	double least, most;
	uint32_t points;
};

/* How many beams wide the face is to the station that sees the most of it; infinity: nobody knows. */
static double beams_across(
	const struct rim *r, const struct crease_face *face, const struct crease_face *other)
{
	g_autoptr(GArray) widths = g_array_new(FALSE, TRUE, sizeof(struct width));
	float beside_m;
	struct seen_from from = { 0 };
	int side = 0, scan = -1;
	double most = 0;
	for (guint i = 0; i < r->near->len; i++)
		if (is_on_alone(near_at(r, i), face, other, &beside_m))
			side += beside_m > 0 ? 1 : -1;
	for (guint i = 0; i < r->near->len; i++) {
		const struct profile_near *p = near_at(r, i);
		if (!is_on_alone(p, face, other, &beside_m) || beside_m * (float)side < 0)
			continue;
		if (p->scan != scan && !station_of(r, p->scan, &from))
			return INFINITY;
		scan = p->scan;
		double beams = beams_from(&from, p);
		if (p->scan >= widths->len)
			g_array_set_size(widths, p->scan + 1u);
		struct width *w = &g_array_index(widths, struct width, p->scan);
		w->least = w->points ? fmin(w->least, beams) : beams;
		w->most = w->points ? fmax(w->most, beams) : beams;
		w->points++;
	}
	for (guint n = 0; n < widths->len; n++) {
		const struct width *w = &g_array_index(widths, struct width, n);
		if (w->points >= GAPS_LEAST)
			most = fmax(most, w->most - w->least);
	}
	return most;
}

/* The face that ends there, when the other one is hardly there; -1: both are, or neither. */
static int face_that_ends(const struct rim *r, const struct profile_piece *p)
{
	float on_m = ON_M + ON_SPACINGS * p->spacing_m;
	const struct crease_face face[2] = { crease_face_of(r, p->face[0], on_m),
		crease_face_of(r, p->face[1], on_m) };
	double beams[2] = { beams_across(r, &face[0], &face[1]),
		beams_across(r, &face[1], &face[0]) };
	int wide = beams[0] < beams[1];
	return beams[1 - wide] <= NARROW_BEAMS && beams[wide] >= 2 * NARROW_BEAMS ? wide : -1;
}

/* ---- all of it ---- */

static void begin(
	struct rim *r, const profile_around *all, const struct profile_piece *p, float radius_m)
{
	*r = (struct rim){ .all = all,
		.half_m = profile_piece_length(p) / 2,
		.band_m = BAND_M + BAND_SPACINGS * p->spacing_m };
	profile_frame_of(p, &r->frame);
	r->near = g_array_new(FALSE, FALSE, sizeof(struct profile_near));
	r->on = g_array_new(FALSE, FALSE, sizeof(struct rim_point));
	profile_around_look(
		all, &r->frame, -r->half_m, r->half_m, fmaxf(radius_m, r->band_m), 1, r->near);
}

static void end(struct rim *r)
{
	g_array_unref(r->near);
	g_array_unref(r->on);
}

static enum profile_rim fit_end(const profile_around *all, struct profile_piece *p)
{
	struct rim r;
	begin(&r, all, p, fminf(FACE_M, FACE_SPACINGS * p->spacing_m));
	enum profile_rim told = fit_rim(&r, p);
	end(&r);
	return told;
}

static enum profile_rim fit_crease(const profile_around *all, struct profile_piece *p)
{
	struct rim r;
	begin(&r, all, p, AROUND_M + AROUND_SPACINGS * p->spacing_m);
	int wide = face_that_ends(&r, p);
	end(&r);
	if (wide < 0)
		return PROFILE_RIM_UNKNOWN;
	struct profile_piece q = *p;
	q.kind = PROFILE_END;
	memcpy(q.face[0], p->face[wide], sizeof q.face[0]);
	memset(q.face[1], 0, sizeof q.face[1]);
	if (fit_end(all, &q) != PROFILE_RIM_FITTED)
		return PROFILE_RIM_UNKNOWN;
	*p = q;
	return PROFILE_RIM_FITTED;
}

enum profile_rim profile_rim_fit(const profile_around *all, struct profile_piece *p)
{
	return p->kind == PROFILE_END      ? fit_end(all, p)
	       : p->kind == PROFILE_CREASE ? fit_crease(all, p)
					   : PROFILE_RIM_UNKNOWN;
}
