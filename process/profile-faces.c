#include "process/profile-faces.h"
#include "process/normal-equations.h"
#include "process/vector3.h"
#include <limits.h>
#include <string.h>

/* Rows of points are looked for in so many directions across, and by how far they pass the piece. */
#define WAYS      36
#define OFF_M     0.01f
#define OFFS      80
#define VOTERS    800u
#define PEAKS     3
#define BINS_MOST 256
/* Ranges waver by about this; a face has what lies within so much of it. */
#define NOISE_M       0.008
#define NOISE_LEAST_M 0.002
#define REACH_NOISES  2.2
#define FITS          3
#define ROUNDS        2 /* of sharing points out among faces */
#define POINTS_LEAST  8u
#define POINTS_PART   0.025f
/* Points next to an edge face roughly as their face does: their normals mix what is around. */
#define ROUGHLY_COS 0.4f
/* Of the steps along it in which a face is there. */
#define STEP_M        0.05f
#define STEP_SPACINGS 2.0f
#define STEPS_SHARE   0.35f
/* In a face, beside the piece: a gap of so many spacings ends it; narrower it is none. */
#define GAP_SPACINGS       2.5f
#define NARROWEST_M        0.03f
#define NARROWEST_SPACINGS 1.4f
/* So many points tell a section. */
#define POINTS_MOST 2000u

static const struct profile_near *near_at(const struct profile_section *s, guint i)
{
	return &g_array_index(s->near, struct profile_near, i);
}

/* ---- the frame of a piece ---- */

void profile_frame_of(const struct profile_piece *p, struct profile_frame *f)
{
	int least = 0;
	straight_place(&p->line, (p->from_m + p->to_m) / 2, f->at);
	for (int k = 0; k < 3; k++) {
		f->axis[2][k] = (float)p->line.along[k];
		if (fabs(p->line.along[k]) < fabs(p->line.along[least]))
			least = k;
	}
	float aside[3] = { 0 };
	aside[least] = 1;
	vector3_cross(f->axis[2], aside, f->axis[0]);
	vector3_unit(f->axis[0]);
	vector3_cross(f->axis[2], f->axis[0], f->axis[1]);
}

/* ---- a row of points ---- */

/* Across: w along way, beside perpendicular to it. */
static float w_of(const struct profile_near *p, const float way[2])
{
	return p->u * way[0] + p->v * way[1];
}

static float beside_of(const struct profile_near *p, const float way[2])
{
	return p->v * way[0] - p->u * way[1];
}

/* It does not face across what runs that way. */
static bool may_face(const struct profile_near *p, const float way[2])
{
	float along = p->normal[0] * way[0] + p->normal[1] * way[1];
	return (p->normal[0] == 0 && p->normal[1] == 0 && p->normal[2] == 0) ||
	       fabsf(along) >= ROUGHLY_COS;
}

/* A row: w = x0 + x1 s + x2 t in its part beside the piece. */
struct row {
	float way[2];
	double x[3], noise_m;
	float from_m, to_m;
	uint32_t count;
};

static double off_of(const struct row *r, const struct profile_near *p)
{
	return (double)w_of(p, r->way) - r->x[0] - r->x[1] * (double)beside_of(p, r->way) -
	       r->x[2] * (double)p->t;
}

static int by_size(const void *a, const void *b)
{
	const float *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

/* Its longest part without gaps, among points that are free or its own; by bins of a quarter of a spacing. */
static bool find_part(const struct profile_section *s, struct row *r, uint8_t own)
{
	const float bin_m = fmaxf(s->spacing_m / 4, 2 * s->radius_m / BINS_MOST);
	const int bins = MIN((int)(2 * s->radius_m / bin_m) + 1, BINS_MOST),
		  gap = (int)(GAP_SPACINGS * s->spacing_m / bin_m);
	uint16_t count[BINS_MOST] = { 0 };
	r->count = 0;
	for (guint i = 0; i < s->near->len; i++) {
		const struct profile_near *p = near_at(s, i);
		if ((s->face_of[i] == PROFILE_NO_FACE || s->face_of[i] == own) &&
			may_face(p, r->way) && fabs(off_of(r, p)) < REACH_NOISES * r->noise_m)
			count[CLAMP((int)((beside_of(p, r->way) + s->radius_m) / bin_m), 0,
				bins - 1)]++;
	}
	uint32_t sum = 0;
	for (int from = 0, last = -2 * BINS_MOST, n = 0; n <= bins; n++) {
		if (n < bins && !count[n])
			continue;
		if (n == bins || n - last > gap) {
			if (sum > r->count) {
				r->count = sum;
				r->from_m = (float)from * bin_m - s->radius_m;
				r->to_m = (float)(last + 1) * bin_m - s->radius_m;
			}
			sum = 0;
			from = n;
		}
		if (n < bins)
			sum += count[n];
		last = n;
	}
	return r->count >= POINTS_LEAST &&
	       r->to_m - r->from_m >= fmaxf(NARROWEST_M, NARROWEST_SPACINGS * s->spacing_m);
}

static bool fit_row(const struct profile_section *s, struct row *r, uint8_t own)
{
	double information[9] = { 0 }, gradient[3] = { 0 }, squares = 0, weights = 0;
	for (guint i = 0; i < s->near->len; i++) {
		const struct profile_near *p = near_at(s, i);
		double beside = (double)beside_of(p, r->way), row[3] = { 1, beside, (double)p->t };
		double part = off_of(r, p) / (REACH_NOISES * r->noise_m);
		if ((s->face_of[i] != PROFILE_NO_FACE && s->face_of[i] != own) ||
			!may_face(p, r->way) || fabs(part) > 1 || beside < (double)r->from_m ||
			beside > (double)r->to_m)
			continue;
		double weight = (1 - part * part) * (1 - part * part);
		for (int j = 0; j < 3; j++) {
			gradient[j] += weight * row[j] * (double)w_of(p, r->way);
			for (int k = 0; k < 3; k++)
				information[3 * j + k] += weight * row[j] * row[k];
		}
		squares += weight * off_of(r, p) * off_of(r, p);
		weights += weight;
	}
	/* Of few points it is held to run along the piece. */
	information[4] += 1e-4;
	information[8] += 1e-2;
	/* Weights leave out what is far off, so what they tell of the noise is too little by a third. */
	if (weights < POINTS_LEAST / 2.0 ||
		!normal_equations_solve(information, gradient, 3, r->x, NULL))
		return false;
	r->noise_m = CLAMP(1.4 * sqrt(squares / weights), NOISE_LEAST_M, 1.5 * NOISE_M);
	return true;
}

/* ---- faces ---- */

struct votes {
	uint16_t count[WAYS][OFFS];
};

static void vote(const struct profile_section *s, struct votes *v)
{
	guint step = s->near->len / VOTERS + 1;
	memset(v, 0, sizeof *v);
	for (int b = 0; b < WAYS; b++) {
		const float turn = (float)b * (float)G_PI / WAYS,
			    way[2] = { cosf(turn), sinf(turn) };
		for (guint i = 0; i < s->near->len; i += step) {
			const struct profile_near *p = near_at(s, i);
			int off = (int)floorf(w_of(p, way) / OFF_M) + OFFS / 2;
			if (s->face_of[i] == PROFILE_NO_FACE && off >= 0 && off < OFFS &&
				may_face(p, way))
				v->count[b][off]++;
		}
	}
}

/* The fullest row, which is then none of the next. */
static bool take_peak(struct votes *v, struct row *ret)
{
	uint32_t most = 2;
	int way = 0, off = 0;
	for (int b = 0; b < WAYS; b++)
		for (int o = 1; o + 1 < OFFS; o++) {
			uint32_t sum =
				v->count[b][o - 1] + 2u * v->count[b][o] + v->count[b][o + 1];
			if (sum > most) {
				most = sum;
				way = b;
				off = o;
			}
		}
	if (most == 2)
		return false;
	for (int d = -1; d <= 1; d++)
		for (int o = MAX(off - 2, 0); o <= MIN(off + 2, OFFS - 1); o++)
			v->count[(way + d + WAYS) % WAYS][o] = 0;
	float turn = (float)way * (float)G_PI / WAYS;
	*ret = (struct row){ .way = { cosf(turn), sinf(turn) },
		.x = { ((double)(off - OFFS / 2) + 0.5) * (double)OFF_M, 0, 0 },
		.noise_m = NOISE_M };
	return true;
}

/* The one of the fullest rows that has the most points without gaps. */
static bool find_row(const struct profile_section *s, struct votes *v, struct row *ret)
{
	struct row row;
	ret->count = 0;
	vote(s, v);
	for (int n = 0; n < PEAKS && take_peak(v, &row); n++) {
		bool good = find_part(s, &row, PROFILE_NO_FACE);
		for (int fit = 0; good && fit < FITS; fit++)
			good = fit_row(s, &row, PROFILE_NO_FACE) &&
			       find_part(s, &row, PROFILE_NO_FACE);
		if (good && row.count > ret->count)
			*ret = row;
	}
	return ret->count >= MAX(POINTS_LEAST, (uint32_t)(POINTS_PART * (float)s->near->len));
}

static void take_points(struct profile_section *s, const struct row *r, uint8_t number)
{
	for (guint i = 0; i < s->near->len; i++) {
		const struct profile_near *p = near_at(s, i);
		float beside = beside_of(p, r->way);
		if (s->face_of[i] == PROFILE_NO_FACE && may_face(p, r->way) &&
			beside >= r->from_m && beside <= r->to_m &&
			fabs(off_of(r, p)) < REACH_NOISES * r->noise_m)
			s->face_of[i] = number;
	}
}

/* How far a point is from a row that ends. */
static double away_of(const struct row *r, const struct profile_near *p)
{
	float beside = beside_of(p, r->way);
	double past = (double)fmaxf(fmaxf(r->from_m - beside, beside - r->to_m), 0);
	return hypot(off_of(r, p), past);
}

/* Near a corner points are of the face that they are nearest to, whichever was found first. */
static void share_out(struct profile_section *s, const struct row *rows)
{
	for (guint i = 0; i < s->near->len; i++) {
		const struct profile_near *p = near_at(s, i);
		double least = INFINITY;
		s->face_of[i] = PROFILE_NO_FACE;
		for (uint32_t f = 0; f < s->faces; f++) {
			double away = away_of(&rows[f], p);
			if (away < least && away < 1.2 * REACH_NOISES * rows[f].noise_m &&
				may_face(p, rows[f].way)) {
				least = away;
				s->face_of[i] = (uint8_t)f;
			}
		}
	}
}

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

/* Towards where its points face, on the whole. */
static struct profile_face face_of_row(
	const struct profile_section *s, const struct row *r, uint8_t number)
{
	struct profile_face f = { .noise_m = (float)r->noise_m };
	float beside[2] = { -r->way[1], r->way[0] }, sum = 0;
	for (int k = 0; k < 2; k++)
		f.normal[k] = r->way[k] - (float)r->x[1] * beside[k];
	f.normal[2] = -(float)r->x[2];
	float length = vector3_length(f.normal);
	for (guint i = 0; i < s->near->len; i++)
		if (s->face_of[i] == number)
			sum += vector3_dot(near_at(s, i)->normal, f.normal);
	for (int k = 0; k < 3; k++)
		f.normal[k] /= sum < 0 ? -length : length;
	f.off_m = (float)r->x[0] / (sum < 0 ? -length : length);
	return f;
}

static void find_faces(struct profile_section *s)
{
	g_autofree struct votes *votes = g_new(struct votes, 1);
	struct row rows[PROFILE_FACES];
	while (s->faces < PROFILE_FACES && find_row(s, votes, &rows[s->faces])) {
		take_points(s, &rows[s->faces], (uint8_t)s->faces);
		s->faces++;
	}
	for (int n = 0; n < ROUNDS; n++) {
		share_out(s, rows);
		for (uint32_t f = 0; f < s->faces; f++)
			if (fit_row(s, &rows[f], (uint8_t)f))
				find_part(s, &rows[f], (uint8_t)f);
	}
	share_out(s, rows);
	for (uint32_t f = 0; f < s->faces; f++)
		s->face[f] = face_of_row(s, &rows[f], (uint8_t)f);
}

bool profile_is_of(const struct profile_near *p, const struct profile_face *f)
{
	float at[3] = { p->u, p->v, p->t };
	return vector3_dot(p->normal, f->normal) >= ROUGHLY_COS &&
	       fabsf(vector3_dot(at, f->normal) - f->off_m) < (float)REACH_NOISES * f->noise_m;
}

float profile_beside(const struct profile_near *p, const struct profile_face *f)
{
	return (p->v * f->normal[0] - p->u * f->normal[1]) / hypotf(f->normal[0], f->normal[1]);
}

/* ---- where faces begin and end ---- */

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

static void thin_out(struct profile_section *s)
{
	guint step = s->near->len / POINTS_MOST + 1, kept = 0;
	for (guint i = 0; i < s->near->len && step > 1; i += step)
		g_array_index(s->near, struct profile_near, kept++) = *near_at(s, i);
	if (step > 1)
		g_array_set_size(s->near, kept);
}

void profile_section_look(
	const profile_around *all, const struct profile_piece *p, struct profile_section *s)
{
	profile_frame_of(p, &s->frame);
	s->half_m = (float)profile_piece_length(p) / 2;
	s->spacing_m = p->spacing_m;
	s->radius_m = CLAMP(PROFILE_RADIUS_SPACINGS * p->spacing_m, PROFILE_RADIUS_LEAST_M,
		PROFILE_RADIUS_MOST_M);
	s->faces = s->spans = 0;
	profile_around_look(
		all, &s->frame, -(double)s->half_m, (double)s->half_m, s->radius_m, s->near);
	thin_out(s);
	g_free(s->face_of);
	s->face_of = g_malloc(s->near->len + 1);
	memset(s->face_of, PROFILE_NO_FACE, s->near->len + 1);
	find_faces(s);
	for (uint32_t f = 0; f < s->faces; f++)
		find_spans(s, (uint8_t)f);
}

void profile_section_clear(struct profile_section *s)
{
	g_array_unref(s->near);
	g_free(s->face_of);
}
