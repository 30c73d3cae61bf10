#include "process/normal-equations.h"
#include "process/profile-extent.h"
#include "process/vector3.h"
#include <string.h>

/* From where faces cut each other to where they end: so many spacings, and this. */
#define MEETS_SPACINGS 1.3f
#define MEETS_M        0.012f
#define JOINT_M        0.015f
#define FITS           4
/* Beyond its last points a face goes on for half a spacing, on the mean. */
#define LAST_SPACINGS     0.45
#define END_STEP_SPACINGS 2.5f
/* What lies farther from what grew is left to what grew there. */
#define MARK_SUPPORT 0.85f /* of what grew, where no face tells of it */
#define OTHER_KIND_M 0.03
/* An edge that was looked at again is the same when it is so near. One that was not found again is left as long as so many times what it
 * was found by. */
#define SAME_M        0.015
#define SAME_SPACINGS 0.5
#define SEEN_PART     2.0
#define SEEN_PAST_M   0.1 /* what may go no farther than it was seen: this, at either end */
#define LEFT_M        0.1
#define NEAR_M        0.04f
#define NEAR_SPACINGS 1.0f
/* Beside an edge others lie as far as faces are known to their ends; of its length they take this part at least, and points bear them out along so
 * much of theirs. */
#define ENDS_SPACINGS  2.5f
#define BESIDE_PART    0.7
#define BESIDE_SUPPORT 0.92f
/* The halves of longer pieces are looked at where these lie between faces that are bent, or were not found again by all of their length. */
#define BENT_LONG_M 2.0f
/* The farthest points of a face that ends lie on a line, in most steps, as far as spacings explain. */
#define STEPS_LEAST    3
#define STEPS_SHARE    0.5
#define NOISE_SPACINGS 0.35
#define NOISE_M        0.003
struct settler {
	const profile_around *all;
	const struct profile_piece *seed;
	struct profile_section section;
	bool is_beside; /* what runs along beside the seed, not the seed itself, is looked for */
	bool is_met[PROFILE_SPANS][2]; /* where a span begins, or ends, it meets another face */
	GArray *ret;                   /* of struct profile_piece */
	bool is_bent;                  /* by a crease that it would make, it is */
	bool is_there;                 /* the piece itself, found again, is known already */
	bool (*is_known)(const struct profile_piece *p, const void *user_data);
	const void *user_data;
};

static const struct profile_near *near_at(const GArray *near, guint i)
{
	return &g_array_index(near, struct profile_near, i);
}

/* ---- an edge ---- */

static void to_site(const struct profile_frame *f, const float at[3], double ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = f->at[k] + (double)(at[0] * f->axis[0][k] + at[1] * f->axis[1][k] +
					     at[2] * f->axis[2][k]);
}

/* Through places across at both ends of the section. */
static struct profile_piece piece_between(
	const struct settler *s, const float low[2], const float high[2])
{
	const struct profile_section *section = &s->section;
	struct profile_piece p = *s->seed;
	p.seen_m = 2 * section->half_m;
	memcpy(p.seen_at, section->frame.at, sizeof p.seen_at);
	p.spacing_m = section->spacing_m;
	p.is_guessed = section->is_guessed;
	double from[3], to[3], length = 0;
	to_site(&section->frame, (float[3]){ low[0], low[1], -section->half_m }, from);
	to_site(&section->frame, (float[3]){ high[0], high[1], section->half_m }, to);
	for (int k = 0; k < 3; k++) {
		p.line.at[k] = from[k];
		p.line.along[k] = to[k] - from[k];
		length += p.line.along[k] * p.line.along[k];
	}
	length = sqrt(length);
	for (int k = 0; k < 3; k++)
		p.line.along[k] /= length;
	p.from_m = 0;
	p.to_m = length;
	memset(p.face, 0, sizeof p.face);
	return p;
}

/* In the section of a face: the place so far beside the piece. */
static void in_face(const struct profile_face *f, float beside_m, float t, float ret[2])
{
	float length = hypotf(f->normal[0], f->normal[1]),
	      n[2] = { f->normal[0] / length, f->normal[1] / length };
	float w = (f->off_m - f->normal[2] * t) / length;
	ret[0] = w * n[0] - beside_m * n[1];
	ret[1] = w * n[1] + beside_m * n[0];
}

static float beside_of(const struct profile_face *f, const float at[2])
{
	struct profile_near n = { .u = at[0], .v = at[1] };
	return profile_beside(&n, f);
}

/* How far two pieces are apart at the middle of the first, and at its ends. */
static double off_from(const struct profile_piece *p, const struct profile_piece *q)
{
	double most = 0;
	for (int n = 0; n < 3; n++) {
		double at[3];
		straight_place(&p->line, p->from_m + n * profile_piece_length(p) / 2, at);
		most = fmax(most, straight_off(&q->line, at));
	}
	return most;
}

static bool is_same(const struct profile_piece *p, double off_m)
{
	return off_m < SAME_M + SAME_SPACINGS * (double)p->spacing_m;
}

/* As far across as faces are known to their ends. */
static float known_m(const struct settler *s)
{
	return s->section.radius_m - ENDS_SPACINGS * s->section.spacing_m;
}

/* Whether it is where edges are looked for. */
static bool is_within(const struct settler *s, const struct profile_piece *p)
{
	double at[3];
	straight_place(&p->line, (p->from_m + p->to_m) / 2, at);
	return straight_off(&s->seed->line, at) <=
	       (double)(s->is_beside ? known_m(s) : NEAR_M + NEAR_SPACINGS * p->spacing_m);
}

/* No more of an edge than what it was found by, and a little: farther on nothing bears it out. */
static void cut_to_seen(struct profile_piece *p, double part, double past_m)
{
	double middle = straight_along(&p->line, p->seen_at),
	       half_m = part * (double)p->seen_m / 2 + past_m;
	p->from_m = fmax(p->from_m, middle - half_m);
	p->to_m = fmin(p->to_m, middle + half_m);
}

static bool runs_along(struct profile_piece *p)
{
	cut_to_seen(p, 1, SEEN_PAST_M);
	return p->support >= BESIDE_SUPPORT &&
	       profile_piece_length(p) >= BESIDE_PART * (double)p->seen_m;
}

static void keep(
	struct settler *s, struct profile_piece *p, const struct profile_plane *plane, int side)
{
	for (int f = 0; f < 1 + (p->kind == PROFILE_CREASE); f++)
		memcpy(p->face[f], plane[f].normal, sizeof p->face[f]);
	if (!is_within(s, p))
		return;
	if (s->is_known && s->is_known(p, s->user_data))
		s->is_there |= is_same(s->seed, off_from(s->seed, p));
	else if (profile_extent_find(s->all, p, plane, side) && (!s->is_beside || runs_along(p)))
		g_array_append_val(s->ret, *p);
}

/* ---- creases ---- */

/* Where two faces cut each other, at a place along. */
static bool cut_at(
	const struct profile_face *f, const struct profile_face *g, float t, float ret[2])
{
	float a = f->off_m - f->normal[2] * t, b = g->off_m - g->normal[2] * t;
	float det = f->normal[0] * g->normal[1] - f->normal[1] * g->normal[0];
	if (fabsf(det) < 0.3f)
		return false;
	ret[0] = (a * g->normal[1] - b * f->normal[1]) / det;
	ret[1] = (f->normal[0] * b - g->normal[0] * a) / det;
	return true;
}

static float meets_m(const struct settler *s)
{
	return MEETS_SPACINGS * s->section.spacing_m + MEETS_M;
}

/* The span of the face that reaches there; -1: none does. *ret_at_end: 0, 1, or -1 amid it. */
static int span_at(const struct settler *s, uint32_t face, float beside_m, int *ret_at_end)
{
	float reach = meets_m(s);
	for (uint32_t n = 0; n < s->section.spans; n++) {
		const struct profile_span *span = &s->section.span[n];
		if (span->face != face || beside_m < span->from_m - reach ||
			beside_m > span->to_m + reach)
			continue;
		*ret_at_end = fabsf(beside_m - span->from_m) <= reach ? 0
			      : fabsf(beside_m - span->to_m) <= reach ? 1
								      : -1;
		return (int)n;
	}
	return -1;
}

/* Whether a station sees them meet there. */
static bool are_joined(const struct settler *s, uint32_t a, uint32_t b, const float at[2])
{
	for (uint32_t n = 0; n < s->section.joints; n++) {
		const struct profile_joint *j = &s->section.joint[n];
		if (j->border.is_crease &&
			((j->face[0] == a && j->face[1] == b) ||
				(j->face[0] == b && j->face[1] == a)) &&
			hypotf(at[0] - j->border.at[0][0], at[1] - j->border.at[0][1]) < JOINT_M)
			return true;
	}
	return false;
}

/* What ends in the shadow of something in front of it has no edge there. */
static void leave_shadows(struct settler *s)
{
	for (uint32_t n = 0; n < s->section.joints; n++) {
		const struct profile_joint *j = &s->section.joint[n];
		for (int side = 0; side < 2; side++) {
			int end = -1;
			float beside =
				beside_of(&s->section.face[j->face[side]], j->border.at[side]);
			int span = span_at(s, j->face[side], beside, &end);
			if (j->border.is_shadow[side] && span >= 0 && end >= 0)
				s->is_met[span][end] = true;
		}
	}
}

static bool are_bent(const struct profile_section *s, uint32_t a, uint32_t b)
{
	return 2 * s->half_m > BENT_LONG_M &&
	       (profile_section_is_bent(s, a) || profile_section_is_bent(s, b));
}

/* Two faces that a station sees meet; or that both end there, and meet nothing else. */
static void add_crease(struct settler *s, uint32_t a, uint32_t b, bool is_joined)
{
	const struct profile_section *section = &s->section;
	const struct profile_face *f = &section->face[a], *g = &section->face[b];
	float low[2], middle[2], high[2];
	if (vector3_dot(f->normal, g->normal) > PROFILE_APART_COS || !cut_at(f, g, 0, middle) ||
		!cut_at(f, g, -section->half_m, low) || !cut_at(f, g, section->half_m, high) ||
		hypotf(middle[0], middle[1]) > section->radius_m ||
		are_joined(s, a, b, middle) != is_joined)
		return;
	if (are_bent(section, a, b)) {
		s->is_bent = true;
		return;
	}
	int ends[2] = { -1, -1 }, span[2] = { span_at(s, a, beside_of(f, middle), &ends[0]),
		span_at(s, b, beside_of(g, middle), &ends[1]) };
	for (int n = 0; n < 2 && !is_joined; n++)
		if (span[n] < 0 || ends[n] < 0 || s->is_met[span[n]][ends[n]])
			return;
	for (int n = 0; n < 2; n++)
		if (span[n] >= 0 && ends[n] >= 0)
			s->is_met[span[n]][ends[n]] = true;
	struct profile_piece p = piece_between(s, low, high);
	const struct profile_plane planes[2] = { profile_plane_of(&section->frame, f),
		profile_plane_of(&section->frame, g) };
	p.kind = PROFILE_CREASE;
	keep(s, &p, planes, 0);
}

/* ---- ends ---- */

/* The farthest points of the span in each step along, and a line through them that is near to most. */
static bool fit_end(
	const struct settler *s, const struct profile_span *span, int end, double ret[2])
{
	const struct profile_section *section = &s->section;
	const struct profile_face *f = &section->face[span->face];
	const float side = end ? 1 : -1, last_m = side * (end ? span->to_m : span->from_m),
		    spacing_m = section->spacing_m;
	float step_m = fmaxf(0.03f, END_STEP_SPACINGS * spacing_m);
	uint32_t steps = MAX((uint32_t)ceilf(2 * section->half_m / step_m), 1);
	g_autofree float *last = g_new(float, steps);
	for (uint32_t n = 0; n < steps; n++)
		last[n] = -INFINITY;
	for (guint i = 0; i < section->near->len; i++) {
		const struct profile_near *p = near_at(section->near, i);
		uint32_t n = MIN((uint32_t)fmaxf((p->t + section->half_m) / step_m, 0), steps - 1);
		float beside = side * profile_beside(p, f);
		if (section->face_of[i] == span->face && beside <= last_m &&
			beside > last_m - 3 * spacing_m - 0.02f)
			last[n] = fmaxf(last[n], beside);
	}
	double x[2] = { (double)(last_m - spacing_m / 2), 0 },
	       reach_m = 2 * (double)spacing_m + 0.02, noise = 0;
	for (int fit = 0; fit < FITS; fit++) {
		double information[4] = { 0 }, gradient[2] = { 0 }, weights = 0, squares = 0;
		for (uint32_t n = 0; n < steps; n++) {
			double row[2] = { 1,
				((double)n + 0.5) * (double)step_m - (double)section->half_m };
			double off = (double)last[n] - x[0] - x[1] * row[1];
			if (!(fabs(off) < reach_m))
				continue;
			double weight = 1 - off * off / (reach_m * reach_m);
			for (int j = 0; j < 2; j++) {
				gradient[j] += weight * row[j] * (double)last[n];
				for (int k = 0; k < 2; k++)
					information[2 * j + k] += weight * row[j] * row[k];
			}
			weights += weight;
			squares += weight * off * off;
		}
		information[3] += 1e-4;
		if (weights < STEPS_LEAST || weights < STEPS_SHARE * steps ||
			!normal_equations_solve(information, gradient, 2, x, NULL))
			return false;
		noise = sqrt(squares / weights);
		reach_m = fmax(2.5 * noise, 0.5 * (double)spacing_m + 0.002);
	}
	ret[0] = (double)side * (x[0] + LAST_SPACINGS * (double)spacing_m);
	ret[1] = (double)side * x[1];
	return noise <= NOISE_M + NOISE_SPACINGS * (double)spacing_m;
}

static void add_end(struct settler *s, const struct profile_span *span, int end)
{
	const struct profile_section *section = &s->section;
	const struct profile_face *f = &section->face[span->face];
	double x[2];
	float low[2], middle[2], high[2];
	in_face(f, end ? span->to_m : span->from_m, 0, middle);
	if (hypotf(middle[0], middle[1]) > known_m(s) || !fit_end(s, span, end, x))
		return;
	in_face(f, (float)(x[0] - x[1] * (double)section->half_m), -section->half_m, low);
	in_face(f, (float)(x[0] + x[1] * (double)section->half_m), section->half_m, high);
	struct profile_piece p = piece_between(s, low, high);
	const struct profile_plane plane = profile_plane_of(&section->frame, f);
	p.kind = PROFILE_END;
	keep(s, &p, &plane, end ? 1 : -1);
}

/* ---- all of it ---- */

static void find_edges(struct settler *s)
{
	memset(s->is_met, 0, sizeof s->is_met);
	profile_section_look(s->all, s->seed, &s->section);
	for (int joined = 1; joined >= 0; joined--) {
		for (uint32_t a = 0; a < s->section.faces; a++)
			for (uint32_t b = a + 1; b < s->section.faces; b++)
				add_crease(s, a, b, joined);
		leave_shadows(s);
	}
	for (uint32_t n = 0; n < s->section.spans; n++)
		for (int end = 0; end < 2; end++)
			if (!s->is_met[n][end])
				add_end(s, &s->section.span[n], end);
}

/* Of an edge that was looked at again, the edge itself: the one that is the nearest, of its kind if there is one. false: it was not found,
 * and may be by its halves. */
static bool keep_same(const struct settler *s, const struct profile_piece *seed, GArray *ret)
{
	double least = INFINITY;
	struct profile_piece best = { 0 };
	for (guint n = 0; n < ret->len; n++) {
		const struct profile_piece *q = &g_array_index(ret, struct profile_piece, n);
		double off = off_from(seed, q) + (q->kind == seed->kind ? 0 : OTHER_KIND_M);
		if (off < least) {
			least = off;
			best = *q;
		}
	}
	g_array_set_size(ret, 0);
	if (is_same(seed, least))
		g_array_append_val(ret, best);
	else if (!s->is_there) {
		if (profile_piece_length(seed) > (double)BENT_LONG_M)
			return false;
		best = *seed;
		cut_to_seen(&best, SEEN_PART, 0);
		if (profile_piece_length(&best) > LEFT_M)
			g_array_append_val(ret, best);
	}
	return true;
}

static void begin(struct settler *s, const struct profile_look *look)
{
	s->section.look = *look;
	s->section.near = g_array_new(FALSE, FALSE, sizeof(struct profile_near));
}

/* Each as a piece of its own, which goes no farther: beyond it what is bent is elsewhere. */
static void settle_halves(const struct settler *whole, GArray *ret)
{
	const struct profile_piece *seed = whole->seed;
	for (int n = 0; n < 2; n++) {
		struct profile_piece half = *seed;
		g_autoptr(GArray) found = g_array_new(FALSE, FALSE, sizeof half);
		*(n ? &half.from_m : &half.to_m) = (seed->from_m + seed->to_m) / 2;
		profile_piece_settle(whole->all, &half, &whole->section.look, whole->is_known,
			whole->user_data, found);
		for (guint k = 0; k < found->len; k++) {
			struct profile_piece *p = &g_array_index(found, struct profile_piece, k);
			if (p->seen_m > 0)
				cut_to_seen(p, 1, SEEN_PAST_M);
			if (p->to_m > p->from_m)
				g_array_append_val(ret, *p);
		}
	}
}

void profile_piece_settle(const profile_around *all, const struct profile_piece *seed,
	const struct profile_look *look,
	bool (*is_known)(const struct profile_piece *p, const void *user_data),
	const void *user_data, GArray *ret)
{
	const bool is_again = seed->seen_m > 0;
	struct settler s = {
		.all = all, .seed = seed, .ret = ret, .is_known = is_known, .user_data = user_data
	};
	begin(&s, look);
	find_edges(&s);
	if (s.is_bent) {
		if (is_again)
			g_array_set_size(ret, 0);
		settle_halves(&s, ret);
	} else {
		if (ret->len == 0 && seed->is_directed && seed->support > MARK_SUPPORT) {
			struct profile_piece p = *seed;
			p.kind = s.section.faces ? PROFILE_MARK : PROFILE_THIN;
			g_array_append_val(ret, p);
		}
		if (is_again && !keep_same(&s, seed, ret))
			settle_halves(&s, ret);
	}
	profile_section_clear(&s.section);
}

void profile_piece_look_beside(const profile_around *all, const struct profile_piece *edge,
	const struct profile_look *look,
	bool (*is_known)(const struct profile_piece *p, const void *user_data),
	const void *user_data, GArray *ret)
{
	struct settler s = { .all = all,
		.seed = edge,
		.is_beside = true,
		.ret = ret,
		.is_known = is_known,
		.user_data = user_data };
	begin(&s, look);
	find_edges(&s);
	profile_section_clear(&s.section);
}
