#include "process/profile-extent.h"
#include "process/vector3.h"
#include <string.h>

/* Next to an edge, within so many spacings, a part of the steps has feature points; of the points at the end of a face not more lie at the
 * end of a shadow. */
#define BY_SPACINGS    1.5f
#define MARK_SPACINGS  0.5f /* next to a mark */
#define BY_M           0.01f
#define REACH_SPACINGS 2.2f
#define FEATURES_SHARE 0.35f
#define MARKS          (FEATURE_COLOUR_EDGE | FEATURE_INTENSITY_EDGE | FEATURE_SILHOUETTE)
/* Along an edge one looks for it in steps of this, with no larger gap between; for the feature points beside it in larger ones. */
#define STEP_M               0.08f
#define STEP_SPACINGS        3.0f
#define GAP_M                0.25f
#define GAP_SPACINGS         7.0f
#define FEATURE_GAP_M        0.4f
#define FEATURE_GAP_SPACINGS 8.0f
/* Only so much farther than the section does it tell where an edge is. */
#define FARTHER 3.0f
#define AHEAD_M 0.3f
/* Beyond the end of a face there are at most so many points as inside. Of the face are those on it; where nobody knows where it was seen from
 * also those so near to it, in spacings, for there a face seems to end wherever a surface bends. */
#define BEYOND_SHARE    0.3f
#define BEYOND_GUESSED  0.1f
#define BEYOND_SPACINGS 2.5f
/* Of the steps of an edge that are borne out. */
#define SUPPORT_LEAST 0.75f
/* And at least so long, in spacings. */
#define LONG_SPACINGS 8.0f
/* Edges are looked at closely in steps of this. Good ones count for them, others against them, less so where there are no points; when
 * those against them are ahead by so much, it is another edge that begins behind them. Measured on the court: coarser steps and
 * larger gaps leave more on no edge, smaller ones take more of edges away. */
#define CLOSE_M            0.015f
#define CLOSE_SPACINGS     1.0f
#define CLOSE_GAP_M        0.3f
#define CLOSE_GAP_SPACINGS 4.0f
#define CLOSE_UNKNOWN      0.3f
/* And points are on its faces when they are so near to them, 1 sigma: edges are known no better. */
#define CLOSE_NOISE_M        0.004f
#define CLOSE_NOISE_SPACINGS 0.25f
/* On which side of its end a face is tells what is so near. */
#define SIDE_M 0.1f

/* ---- faces ---- */

struct profile_plane profile_plane_of(
	const struct profile_frame *f, const struct profile_face *face)
{
	struct profile_plane p = { .off_m = (double)face->off_m, .noise_m = face->noise_m };
	for (int k = 0; k < 3; k++)
		p.normal[k] = face->normal[0] * f->axis[0][k] + face->normal[1] * f->axis[1][k] +
			      face->normal[2] * f->axis[2][k];
	for (int k = 0; k < 3; k++)
		p.off_m += (double)p.normal[k] * f->at[k];
	return p;
}

/* The other way around. */
static struct profile_face face_in(const struct profile_frame *f, const struct profile_plane *p)
{
	struct profile_face face = { .noise_m = p->noise_m };
	double off_m = p->off_m;
	for (int k = 0; k < 3; k++) {
		face.normal[k] = vector3_dot(p->normal, f->axis[k]);
		off_m -= (double)p->normal[k] * f->at[k];
	}
	face.off_m = (float)off_m;
	return face;
}

/* ---- along an edge ---- */

struct step {
	uint32_t of[2], beyond, other, features, shadows, marks;
};

/* The steps of an edge, from its piece's middle on. */
#define STEPS_MOST 2048
struct walk {
	const profile_around *all;
	GArray *near; /* of struct profile_near */
	float step_m;
	struct profile_frame frame;
	struct profile_face face[2];
	int faces, side; /* side: a face of which alone ends, to 1 or -1 */
	int most;        /* steps to either side, where the edge is still known by its section */
	int from,
		to; /* steps that were counted: from .. to - 1, of those of all from -STEPS_MOST to STEPS_MOST */
	struct step *step; /* of number 0; before it those of less */
};

/* Whether the face may go on in the point, which lies beyond its end. */
static bool is_near_face(
	const struct profile_piece *p, const struct profile_near *n, const struct profile_face *f)
{
	const float at[3] = { n->u, n->v, n->t };
	return profile_is_of(n, f) ||
	       (p->is_guessed && fabsf(vector3_dot(at, f->normal) - f->off_m) <
					 BEYOND_SPACINGS * p->spacing_m);
}

/* What is next to the edge in each step. */
static void count_steps(const struct profile_piece *p, const struct walk *w, int from, int to)
{
	float reach_m = REACH_SPACINGS * p->spacing_m + BY_M,
	      by_m = (p->kind == PROFILE_MARK ? MARK_SPACINGS : BY_SPACINGS) * p->spacing_m + BY_M;
	profile_around_look(w->all, &w->frame, (double)((float)from * w->step_m),
		(double)((float)to * w->step_m), reach_m, 1, w->near);
	for (guint i = 0; i < w->near->len; i++) {
		const struct profile_near *n = &g_array_index(w->near, struct profile_near, i);
		struct step *step = &w->step[CLAMP((int)floorf(n->t / w->step_m), from, to - 1)];
		bool is_of = false;
		for (int f = 0; f < w->faces; f++) {
			bool is_beyond =
				w->faces == 1 && profile_beside(n, &w->face[f]) * (float)w->side >
							 1.2f * p->spacing_m;
			is_of |= profile_is_of(n, &w->face[f]);
			if (is_beyond)
				step->beyond += is_near_face(p, n, &w->face[f]);
			else
				step->of[f] += profile_is_of(n, &w->face[f]);
		}
		if (n->u * n->u + n->v * n->v <= by_m * by_m) {
			step->other += !is_of;
			step->features += n->is_feature;
			step->marks += n->is_feature && n->flags & MARKS;
			step->shadows += is_of && n->flags & FEATURE_BEHIND;
		}
	}
}

static bool is_good(const struct profile_piece *p, const struct step *s)
{
	if (p->kind == PROFILE_MARK)
		return s->marks;
	if (p->kind == PROFILE_CREASE)
		return s->of[0] && s->of[1] && s->other <= s->of[0] + s->of[1];
	float share = p->is_guessed ? BEYOND_GUESSED : BEYOND_SHARE;
	return s->of[0] && (float)s->beyond <= share * (float)s->of[0] &&
	       s->shadows * 2 <= s->of[0];
}

struct run {
	int from, to; /* steps that are part of it: from .. to - 1 */
	uint32_t good, features;
};

/* The longest run of good steps without large gaps. */
static struct run longest_run(const struct profile_piece *p, const struct walk *w)
{
	int gap = (int)ceilf(fmaxf(GAP_M, GAP_SPACINGS * p->spacing_m) / w->step_m),
	    feature_gap = (int)ceilf(
		    fmaxf(FEATURE_GAP_M, FEATURE_GAP_SPACINGS * p->spacing_m) / w->step_m);
	struct run best = { 0 }, run = { 0 };
	int last_good = INT32_MIN / 2, last_feature = INT32_MIN / 2;
	for (int n = w->from; n <= w->to; n++) {
		bool good = n < w->to && is_good(p, &w->step[n]);
		if (n < w->to && w->step[n].features)
			last_feature = n;
		if (n == w->to || n - last_good > gap || n - last_feature > feature_gap) {
			run.to = last_good + 1;
			if (run.good && run.to - run.from > best.to - best.from)
				best = run;
			run = (struct run){ n, n, 0, 0 };
		}
		if (good && last_feature > n - feature_gap) {
			if (!run.good)
				run.from = n;
			run.good++;
			run.features += w->step[n].features > 0;
			last_good = n;
		}
	}
	return best;
}

/* Ahead, at an end, by as much as it is long. false: it goes no further. */
static bool walk_on(const struct profile_piece *p, struct walk *w, const struct run *run)
{
	int more = w->to - w->from,
	    near = (int)ceilf(fmaxf(GAP_M, GAP_SPACINGS * p->spacing_m) / w->step_m),
	    from = run->from <= w->from + near ? MAX(w->from - more, -w->most) : w->from,
	    to = run->to >= w->to - near ? MIN(w->to + more, w->most) : w->to;
	if (from == w->from && to == w->to)
		return false;
	if (from < w->from)
		count_steps(p, w, from, w->from);
	if (to > w->to)
		count_steps(p, w, w->to, to);
	w->from = from;
	w->to = to;
	return true;
}

bool profile_extent_find(const profile_around *all, struct profile_piece *p,
	const struct profile_plane *plane, int side)
{
	g_autofree struct step *steps = g_new0(struct step, 2 * STEPS_MOST);
	g_autoptr(GArray) near = g_array_new(FALSE, FALSE, sizeof(struct profile_near));
	struct walk w = { .all = all,
		.near = near,
		.step_m = fmaxf(STEP_M, STEP_SPACINGS * p->spacing_m),
		.faces = 1 + (p->kind == PROFILE_CREASE),
		.side = side,
		.step = steps + STEPS_MOST };
	double middle_m = (p->from_m + p->to_m) / 2;
	struct run run;
	profile_frame_of(p, &w.frame);
	for (int f = 0; f < w.faces; f++)
		w.face[f] = face_in(&w.frame, &plane[f]);
	w.to = MIN((int)ceil(profile_piece_length(p) / 2 / (double)w.step_m), STEPS_MOST);
	w.from = -w.to;
	w.most = MIN(
		MAX((int)(FARTHER * (float)w.to), w.to + (int)(AHEAD_M / w.step_m)), STEPS_MOST);
	count_steps(p, &w, w.from, w.to);
	do {
		run = longest_run(p, &w);
		if (run.to - run.from < 2)
			return false;
	} while (walk_on(p, &w, &run));
	p->from_m = middle_m + (double)((float)run.from * w.step_m);
	p->to_m = middle_m + (double)((float)run.to * w.step_m);
	p->support = (float)run.good / (float)(run.to - run.from);
	return p->support >= SUPPORT_LEAST &&
	       (float)run.features >= FEATURES_SHARE * (float)(run.to - run.from) &&
	       profile_piece_length(p) >= (double)(LONG_SPACINGS * p->spacing_m);
}

/* ---- closely ---- */

static bool is_empty(const struct profile_piece *p, const struct step *s)
{
	uint32_t beside = s->of[0] + s->of[1] + s->other;
	return p->kind == PROFILE_CREASE ? beside < 2 : beside == 0;
}

/* The faces of the edge pass through it. */
static void set_faces(const struct profile_piece *p, struct walk *w)
{
	w->faces = p->kind == PROFILE_CREASE ? 2 : p->kind == PROFILE_END;
	for (int f = 0; f < w->faces; f++) {
		struct profile_plane plane = { .noise_m = CLOSE_NOISE_M +
							  CLOSE_NOISE_SPACINGS * p->spacing_m };
		for (int k = 0; k < 3; k++) {
			plane.normal[k] = p->face[f][k];
			plane.off_m += (double)p->face[f][k] * w->frame.at[k];
		}
		w->face[f] = face_in(&w->frame, &plane);
	}
}

/* Away from where more of its points are. */
static int side_of(const struct walk *w, double half_m)
{
	int sum = 0;
	profile_around_look(w->all, &w->frame, -half_m, half_m, SIDE_M, 1, w->near);
	for (guint i = 0; i < w->near->len; i++) {
		const struct profile_near *n = &g_array_index(w->near, struct profile_near, i);
		if (profile_is_of(n, &w->face[0]))
			sum += profile_beside(n, &w->face[0]) > 0 ? 1 : -1;
	}
	return sum > 0 ? -1 : 1;
}

/* Steps from .. to - 1 of the edge, if that is long enough. */
static void add_part(const struct profile_piece *p, const struct walk *w, const struct run *run,
	double length_least_m, GArray *ret)
{
	struct profile_piece part = *p;
	double middle_m = (p->from_m + p->to_m) / 2;
	part.from_m = fmax(p->from_m, middle_m + (double)((float)run->from * w->step_m));
	part.to_m = fmin(p->to_m, middle_m + (double)((float)run->to * w->step_m));
	if (run->to > run->from && profile_piece_length(&part) >= length_least_m)
		g_array_append_val(ret, part);
}

/* What counts for an edge and against it, from step to step: an edge ends where the sum was the highest. */
static void add_parts(
	const struct profile_piece *p, const struct walk *w, double length_least_m, GArray *ret)
{
	float drop = fmaxf(CLOSE_GAP_M, CLOSE_GAP_SPACINGS * p->spacing_m) / w->step_m, sum = 0,
	      most = 0;
	struct run run = { w->from, w->from, 0, 0 };
	for (int n = w->from; n < w->to; n++) {
		const struct step *s = &w->step[n];
		if (most - sum > drop) {
			add_part(p, w, &run, length_least_m, ret);
			run = (struct run){ n, n, 0, 0 };
			sum = most = 0;
		}
		sum += is_good(p, s) ? 1 : is_empty(p, s) ? -CLOSE_UNKNOWN : -1;
		if (sum > most) {
			most = sum;
			run.to = n + 1;
		} else if (most <= 0) {
			sum = 0;
			run.from = run.to = n + 1;
		}
	}
	add_part(p, w, &run, length_least_m, ret);
}

void profile_extent_cut(const profile_around *all, const struct profile_piece *p,
	double length_least_m, GArray *ret)
{
	if (p->kind == PROFILE_THIN) {
		g_array_append_val(ret, *p);
		return;
	}
	g_autoptr(GArray) near = g_array_new(FALSE, FALSE, sizeof(struct profile_near));
	struct walk w = {
		.all = all, .near = near, .step_m = fmaxf(CLOSE_M, CLOSE_SPACINGS * p->spacing_m)
	};
	double half_m = profile_piece_length(p) / 2;
	w.to = (int)ceil(half_m / (double)w.step_m);
	w.from = -w.to;
	g_autofree struct step *steps = g_new0(struct step, 2 * (gsize)w.to + 1);
	w.step = steps + w.to;
	profile_frame_of(p, &w.frame);
	set_faces(p, &w);
	if (w.faces == 1)
		w.side = side_of(&w, half_m);
	count_steps(p, &w, w.from, w.to);
	add_parts(p, &w, length_least_m, ret);
}
