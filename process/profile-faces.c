#include "process/profile-faces.h"
#include "process/normal-equations.h"
#include "process/vector3.h"
#include <string.h>

/* Points next to an edge face roughly as their face does: their normals mix what is around. */
#define ROUGHLY_COS  -0.3f
#define REACH_NOISES 2.2f
#define NOISE_M      0.004f /* at least, where faces waver along an edge */
#define POINTS_LEAST 8u
/* What several stations see is one face when it faces the same way and lies so near; poses are no better. */
#define SAME_COS 0.97f
#define SAME_M   0.005f
/* The piece is turned to run along its faces; so much of it is asked for, 1 sigma, before they say otherwise. */
#define TURNS    1
#define TURN_RAD 0.05
/* Where no station is known it is as if all was seen from so far away. */
#define FAR_M 30.0
/* Of the steps along it in which a face is there. */
#define STEP_M        0.05f
#define STEP_SPACINGS 2.0f
#define STEPS_SHARE   0.35f
/* In a face, beside the piece: a gap of so many spacings ends it. */
#define GAP_SPACINGS 2.5f
/* From the middle of a section to its ends a face that is bent leaves its plane by so much; this many points tell, if it is so many sigmas. */
#define BOW_M      0.008
#define BOW_POINTS 20u
#define BOW_SIGMAS 5.0
/* One in so many of the points are left out by looks that leave some out, by chance. */
#define SHARES 4u
#define HASH   2654435761u
/* So many points tell a section. */
#define POINTS_MOST 3000u
/* Their spacing is that of this part of them, the closest. */
#define CLOSEST_SHARE  0.25f
#define SPACING_STEP_M 0.001f
#define SPACINGS       256

static struct profile_near *near_at(const struct profile_section *s, guint i)
{
	return &g_array_index(s->near, struct profile_near, i);
}

/* ---- the frame of a piece ---- */

/* Across: any two directions, from that of the piece. */
static void set_across(struct profile_frame *f)
{
	int least = 0;
	float aside[3] = { 0 };
	for (int k = 0; k < 3; k++)
		if (fabsf(f->axis[2][k]) < fabsf(f->axis[2][least]))
			least = k;
	aside[least] = 1;
	vector3_cross(f->axis[2], aside, f->axis[0]);
	vector3_unit(f->axis[0]);
	vector3_cross(f->axis[2], f->axis[0], f->axis[1]);
}

void profile_frame_of(const struct profile_piece *p, struct profile_frame *f)
{
	straight_place(&p->line, (p->from_m + p->to_m) / 2, f->at);
	for (int k = 0; k < 3; k++)
		f->axis[2][k] = (float)p->line.along[k];
	set_across(f);
}

/* So that it runs along what was (slope[0], slope[1], 1). */
static void turn_frame(struct profile_section *s, const double slope[2])
{
	struct profile_frame *f = &s->frame, was = *f;
	float turn[3][3];
	for (int k = 0; k < 3; k++)
		f->axis[2][k] +=
			(float)slope[0] * was.axis[0][k] + (float)slope[1] * was.axis[1][k];
	vector3_unit(f->axis[2]);
	set_across(f);
	for (int j = 0; j < 3; j++)
		for (int k = 0; k < 3; k++)
			turn[j][k] = vector3_dot(f->axis[j], was.axis[k]);
	for (guint i = 0; i < s->near->len; i++) {
		struct profile_near *p = near_at(s, i), to = *p;
		const float at[3] = { p->u, p->v, p->t };
		to.u = vector3_dot(turn[0], at);
		to.v = vector3_dot(turn[1], at);
		to.t = vector3_dot(turn[2], at);
		for (int k = 0; k < 3; k++)
			to.normal[k] = vector3_dot(turn[k], p->normal);
		*p = to;
	}
}

/* ---- stations ---- */

/* In the frame; false: it is not known, and is put where the points face on the whole. */
static bool find_station(const profile_around *all, const struct profile_section *s,
	const uint32_t *which, uint32_t count, double ret[3])
{
	struct profile_station station;
	if (profile_around_station(all, near_at(s, which[0])->scan, &station)) {
		for (int j = 0; j < 3; j++) {
			ret[j] = 0;
			for (int k = 0; k < 3; k++)
				ret[j] += (double)s->frame.axis[j][k] *
					  (station.at_m[k] - s->frame.at[k]);
		}
		return true;
	}
	float sum[3] = { 0 };
	for (uint32_t i = 0; i < count; i++)
		vector3_add(sum, 1, near_at(s, which[i])->normal);
	sum[2] = 0;
	if (!vector3_unit(sum))
		sum[0] = 1;
	for (int k = 0; k < 3; k++)
		ret[k] = FAR_M * (double)sum[k];
	return false;
}

/* ---- faces ---- */

static void middle_of(
	const struct profile_section *s, const uint8_t *part_of, uint8_t part, float ret[3])
{
	float count = 0, sum[3] = { 0 };
	for (guint i = 0; i < s->near->len; i++)
		if (part_of[i] == part) {
			const struct profile_near *p = near_at(s, i);
			const float at[3] = { p->u, p->v, p->t };
			vector3_add(sum, 1, at);
			count++;
		}
	for (int k = 0; k < 3; k++)
		ret[k] = count > 0 ? sum[k] / count : 0;
}

static bool is_same(
	const struct profile_face *f, const struct profile_part *p, const float middle[3])
{
	return vector3_dot(f->normal, p->normal) > SAME_COS &&
	       fabsf(vector3_dot(f->normal, middle) - f->off_m) < SAME_M + p->noise_m / 2;
}

/* Both, by how many points they have. */
static void take_in(struct profile_face *f, const struct profile_part *p)
{
	float share = (float)p->points / (float)(f->points + p->points);
	for (int k = 0; k < 3; k++)
		f->normal[k] += share * (p->normal[k] - f->normal[k]);
	float length = vector3_length(f->normal);
	for (int k = 0; k < 3; k++)
		f->normal[k] /= length;
	f->off_m = (f->off_m + share * (p->off_m - f->off_m)) / length;
	f->noise_m = fmaxf(f->noise_m, p->noise_m);
	f->points += p->points;
	f->along_information += p->along_information;
}

static uint8_t add_part(
	struct profile_section *s, const struct profile_part *p, const float middle[3])
{
	for (uint32_t n = 0; n < s->faces; n++)
		if (is_same(&s->face[n], p, middle)) {
			take_in(&s->face[n], p);
			return (uint8_t)n;
		}
	if (s->faces == PROFILE_FACES)
		return PROFILE_NO_FACE;
	struct profile_face *f = &s->face[s->faces];
	*f = (struct profile_face){ .off_m = p->off_m,
		.noise_m = fmaxf(p->noise_m, NOISE_M),
		.points = p->points,
		.along_information = p->along_information };
	memcpy(f->normal, p->normal, sizeof f->normal);
	return (uint8_t)s->faces++;
}

static void add_view(
	struct profile_section *s, const struct profile_view *view, const uint8_t *part_of)
{
	uint8_t face[PROFILE_VIEW_PARTS];
	for (uint32_t n = 0; n < view->parts; n++) {
		float middle[3];
		middle_of(s, part_of, (uint8_t)n, middle);
		face[n] = add_part(s, &view->part[n], middle);
	}
	for (guint i = 0; i < s->near->len; i++)
		if (part_of[i] != PROFILE_NO_FACE)
			s->face_of[i] = face[part_of[i]];
	for (uint32_t n = 0; n + 1 < view->parts && s->joints < PROFILE_JOINTS; n++)
		if (face[n] != face[n + 1] && face[n] != PROFILE_NO_FACE &&
			face[n + 1] != PROFILE_NO_FACE)
			s->joint[s->joints++] =
				(struct profile_joint){ { face[n], face[n + 1] }, view->border[n] };
}

/* Which of the points are of the scan, less those that the look leaves out; returns how many. */
static uint32_t points_of(const struct profile_section *s, int scan, uint32_t *ret)
{
	uint32_t count = 0;
	for (guint i = 0; i < s->near->len; i++)
		if (near_at(s, i)->scan == scan &&
			!(s->look.left_out && 1 + (i * HASH >> 16) % SHARES == s->look.left_out))
			ret[count++] = i;
	return count;
}

/* The next one by its number; INT32_MAX: none. */
static int next_scan(const struct profile_section *s, int scan)
{
	int next = INT32_MAX;
	for (guint i = 0; i < s->near->len; i++)
		if (near_at(s, i)->scan > scan)
			next = MIN(next, near_at(s, i)->scan);
	return next;
}

/* Scan after scan, by their numbers. */
static void find_faces(const profile_around *all, struct profile_section *s)
{
	g_autofree uint32_t *which = g_new(uint32_t, s->near->len + 1);
	g_autofree uint8_t *part_of = g_malloc(s->near->len + 1);
	s->faces = s->joints = 0;
	s->is_guessed = false;
	memset(s->face_of, PROFILE_NO_FACE, s->near->len + 1);
	for (int scan = next_scan(s, -1); scan != INT32_MAX; scan = next_scan(s, scan)) {
		uint32_t count = points_of(s, scan, which);
		if (!count)
			continue;
		struct profile_viewer viewer = { .is_narrow_flat = s->look.is_narrow_flat,
			.radius_m = s->radius_m,
			.spacing_m = s->spacing_m };
		struct profile_view view;
		viewer.is_guessed = !find_station(all, s, which, count, viewer.from);
		s->is_guessed |= viewer.is_guessed;
		memset(part_of, PROFILE_NO_FACE, s->near->len + 1);
		profile_view_look(s->near, which, count, &viewer, part_of, &view);
		add_view(s, &view, part_of);
	}
}

/* How the piece must turn so that it runs along all faces. */
static bool find_turn(const struct profile_section *s, double ret[2])
{
	double information[4] = { 1 / (TURN_RAD * TURN_RAD), 0, 0, 1 / (TURN_RAD * TURN_RAD) },
	       gradient[2] = { 0 };
	for (uint32_t n = 0; n < s->faces; n++) {
		const struct profile_face *f = &s->face[n];
		for (int j = 0; j < 2; j++) {
			double weight = (double)(f->along_information * f->normal[j]);
			gradient[j] -= weight * (double)f->normal[2];
			for (int k = 0; k < 2; k++)
				information[2 * j + k] += weight * (double)f->normal[k];
		}
	}
	return normal_equations_solve(information, gradient, 2, ret, NULL) &&
	       hypot(ret[0], ret[1]) < 5 * TURN_RAD;
}

bool profile_is_of(const struct profile_near *p, const struct profile_face *f)
{
	float at[3] = { p->u, p->v, p->t };
	return vector3_dot(p->normal, f->normal) >= ROUGHLY_COS &&
	       fabsf(vector3_dot(at, f->normal) - f->off_m) < REACH_NOISES * f->noise_m;
}

float profile_beside(const struct profile_near *p, const struct profile_face *f)
{
	return (p->v * f->normal[0] - p->u * f->normal[1]) / hypotf(f->normal[0], f->normal[1]);
}

/* A parabola through its points tells. */
bool profile_section_is_bent(const struct profile_section *s, uint32_t face)
{
	const struct profile_face *f = &s->face[face];
	double information[9] = { 0 }, gradient[3] = { 0 }, x[3], covariance[9], left = 0;
	uint32_t points = 0;
	for (guint i = 0; i < s->near->len; i++) {
		const struct profile_near *p = near_at(s, i);
		const float at[3] = { p->u, p->v, p->t };
		if (s->face_of[i] != face)
			continue;
		const double t = (double)(p->t / s->half_m), row[3] = { 1, t, t * t },
			     off = (double)(vector3_dot(at, f->normal) - f->off_m);
		for (int j = 0; j < 3; j++) {
			gradient[j] += row[j] * off;
			for (int k = 0; k < 3; k++)
				information[3 * j + k] += row[j] * row[k];
		}
		left += off * off;
		points++;
	}
	if (points < BOW_POINTS || !normal_equations_solve(information, gradient, 3, x, covariance))
		return false;
	for (int k = 0; k < 3; k++)
		left -= x[k] * gradient[k];
	double sigma = sqrt(fmax(left, 0) / (points - 3) * covariance[8]);
	return fabs(x[2]) > BOW_M && fabs(x[2]) > BOW_SIGMAS * sigma;
}

/* ---- where faces begin and end ---- */

/* The part of the steps along the piece in which the face has points. */
static float share_of(const struct profile_section *s, uint8_t number)
{
	float step_m = fmaxf(STEP_M, STEP_SPACINGS * s->spacing_m);
	uint32_t steps = MAX((uint32_t)ceilf(2 * s->half_m / step_m), 1), some = 0;
	g_autofree uint8_t *is_there = g_malloc0(steps);
	for (guint i = 0; i < s->near->len; i++)
		if (s->face_of[i] == number)
			is_there[CLAMP((int)((near_at(s, i)->t + s->half_m) / step_m), 0,
				(int)steps - 1)] = 1;
	for (uint32_t n = 0; n < steps; n++)
		some += is_there[n];
	return (float)some / (float)steps;
}

static int by_size(const void *a, const void *b)
{
	const float *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

static void find_spans(struct profile_section *s, uint8_t number)
{
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(float));
	float gap_m = GAP_SPACINGS * s->spacing_m;
	if (share_of(s, number) < STEPS_SHARE)
		return;
	for (guint i = 0; i < s->near->len; i++)
		if (s->face_of[i] == number) {
			float beside = profile_beside(near_at(s, i), &s->face[number]);
			g_array_append_val(all, beside);
		}
	g_array_sort(all, by_size);
	for (guint from = 0, n = 1; n <= all->len; n++) {
		float end = g_array_index(all, float, n - 1);
		if (n < all->len && g_array_index(all, float, n) - end <= gap_m)
			continue;
		if (n - from >= POINTS_LEAST && s->spans < PROFILE_SPANS)
			s->span[s->spans++] = (struct profile_span){ number,
				g_array_index(all, float, from), end };
		from = n;
	}
}

/* Of a long piece some layers across tell enough. */
static uint32_t step_of(const struct profile_section *s)
{
	float points = 4 * s->half_m * s->radius_m / (s->spacing_m * s->spacing_m);
	return MAX((uint32_t)(points / (float)POINTS_MOST), 1);
}

/* Of the points around those that lie the closest tell how far apart beams are: others are of faces aslant. */
static float find_spacing(const struct profile_section *s)
{
	uint32_t count[SPACINGS] = { 0 }, sum = 0;
	int n = 0;
	for (guint i = 0; i < s->near->len; i++)
		count[CLAMP((int)(near_at(s, i)->spacing_m / SPACING_STEP_M), 0, SPACINGS - 1)]++;
	for (; n + 1 < SPACINGS && sum + count[n] < CLOSEST_SHARE * (float)s->near->len; n++)
		sum += count[n];
	return ((float)n + 0.5f) * SPACING_STEP_M;
}

void profile_section_look(
	const profile_around *all, const struct profile_piece *p, struct profile_section *s)
{
	profile_frame_of(p, &s->frame);
	s->half_m = (float)profile_piece_length(p) / 2;
	s->spacing_m = p->spacing_m;
	s->radius_m = CLAMP(PROFILE_RADIUS_SPACINGS * p->spacing_m, PROFILE_RADIUS_LEAST_M,
		PROFILE_RADIUS_MOST_M);
	s->spans = 0;
	profile_around_look(all, &s->frame, -(double)s->half_m, (double)s->half_m, s->radius_m,
		step_of(s), s->near);
	if (s->near->len)
		s->spacing_m = find_spacing(s);
	g_free(s->face_of);
	s->face_of = g_malloc(s->near->len + 1);
	find_faces(all, s);
	double slope[2];
	for (int n = 0; n < TURNS && find_turn(s, slope); n++) {
		turn_frame(s, slope);
		find_faces(all, s);
	}
	for (uint32_t f = 0; f < s->faces; f++)
		find_spans(s, (uint8_t)f);
}

void profile_section_clear(struct profile_section *s)
{
	g_array_unref(s->near);
	g_free(s->face_of);
}
