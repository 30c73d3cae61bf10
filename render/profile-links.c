#include "render/profile-links.h"
#include "process/vector3.h"
#include "render/scene-lines.h"
#include "render/stroke.h"
#include <math.h>

/* Length of a link, in pixels of the style. */
#define LINK_PX 3.f
/* Lines are followed so far beyond the picture. */
#define BEYOND_PX 24.f
/* Links of a segment at most: of what comes very near the eye. */
#define LINKS_MOST 4096
/* Where backs are hidden, lines fade from this cosine to the eye on. */
#define TURNED_AWAY 0.1f
/* Lines to a task, so that the order of links does not depend on threads. */
#define TASK_LINES 64

enum { SALT_WOBBLE_X = 1 << 17, SALT_WOBBLE_Y, SALT_PRESSURE, SALT_BEGIN, SALT_END, SALT_FAINT };

struct drawer {
	const frame *f;
	const struct frame_layer *layer;
	const struct profile_step *step;
	const scene_lines *lines;
	struct lens lens;
	float turn[3][3], eye_m[3], px; /* px: of the style's */
	bool hides_backs;
	GArray *to;
};

/* A line as it is followed. */
struct follow {
	const struct scene_line *line;
	uint32_t number;
	bool begins;   /* the next link is the first of a chain that begins where the line does */
	bool is_open;  /* there is a link of the chain already */
	float last[2]; /* where the pen is */
};

/* A place on a line on the screen. */
struct place {
	float x_px, y_px, q; /* q: 1/depth, or of a parallel camera the depth */
	float along_m;
	float outline; /* 0..1: how far surface ends or turns away there */
	float front;   /* 0..1: less where all of it turns away, and backs are hidden */
};

/* ---- chance along a line ---- */

/* -1..1, smooth, of places 1 apart. */
static float noise(uint32_t line, uint32_t salt, float at)
{
	float whole = floorf(at), part = at - whole;
	uint32_t id = line * 0x9E3779B1u ^ (uint32_t)(int32_t)whole * 0x85EBCA77u;
	uint32_t next = line * 0x9E3779B1u ^ ((uint32_t)(int32_t)whole + 1) * 0x85EBCA77u;
	float a = stroke_chance(id, salt), b = stroke_chance(next, salt);
	return 2 * (a + (b - a) * part * part * (3 - 2 * part)) - 1;
}

/* Of about that wave on the screen, wherever the camera is: two octaves of what is fixed to the line, mixed by the scale. */
static float noise_at_scale(uint32_t line, uint32_t salt, float along_m, float per_m)
{
	float octave = log2f(fmaxf(per_m, 1e-6f)), whole = floorf(octave), part = octave - whole;
	float low = noise(line, salt ^ (uint32_t)((int32_t)whole & 63) << 20,
		      ldexpf(along_m, (int)whole)),
	      high = noise(line, salt ^ (uint32_t)(((int32_t)whole + 1) & 63) << 20,
		      ldexpf(along_m, (int)whole + 1));
	return ((1 - part) * low + part * high) / sqrtf((1 - part) * (1 - part) + part * part);
}

/* ---- places ---- */

static void to_camera(const struct drawer *d, const float at_m[3], float ret[3])
{
	float away[3] = { at_m[0] - d->eye_m[0], at_m[1] - d->eye_m[1], at_m[2] - d->eye_m[2] };
	for (int k = 0; k < 3; k++)
		ret[k] = vector3_dot(d->turn[k], away);
}

/* Whether a face shows its front: -1..1, as the cosine to the eye; 0 where it is not known. */
static float facing(const struct drawer *d, const float face[3], const float seen_m[3])
{
	float normal[3], ray[3] = { -seen_m[0] * d->lens.fan, -seen_m[1] * d->lens.fan,
		d->lens.fan > 0 ? -seen_m[2] : -1 };
	for (int k = 0; k < 3; k++)
		normal[k] = vector3_dot(d->turn[k], face);
	float length = vector3_length(ray);
	return length > 0 ? vector3_dot(normal, ray) / length : 0;
}

/* 1 where one face is seen and the other turns away, or nothing is known behind the end of one. */
static float outline_of(const struct drawer *d, const struct scene_line *l,
	const struct scene_line_vertex *v, const float seen_m[3])
{
	if (l->kind == PROFILE_END)
		return 1;
	if (l->kind != PROFILE_CREASE)
		return 0;
	float both = facing(d, v->face[0], seen_m) * facing(d, v->face[1], seen_m);
	return CLAMP(0.5f - 20 * both, 0, 1);
}

/* Of what lies on nothing that is known all is front. */
static float front_of(
	const struct drawer *d, const struct scene_line_vertex *v, const float seen_m[3])
{
	float most = -1;
	bool is_known = false;
	for (int side = 0; side < 2; side++)
		if (vector3_length(v->face[side]) > 0) {
			most = fmaxf(most, facing(d, v->face[side], seen_m));
			is_known = true;
		}
	return is_known && d->hides_backs ? CLAMP(most / TURNED_AWAY, 0, 1) : 1;
}

static float scale_at(const struct drawer *d, float depth_m)
{
	return d->lens.focal_px / LENS_SCALE_M(&d->lens, depth_m);
}

static float depth_of(const struct drawer *d, float q)
{
	return d->lens.fan > 0 ? 1 / q : q;
}

static struct place place_of(
	const struct drawer *d, const float seen_m[3], float along_m, float outline, float front)
{
	float scale = scale_at(d, seen_m[2]);
	return (struct place){ d->lens.middle_x + seen_m[0] * scale,
		d->lens.middle_y + seen_m[1] * scale, d->lens.fan > 0 ? 1 / seen_m[2] : seen_m[2],
		along_m, outline, front };
}

/* Between two places, on the screen; what is along the line is as its depths tell. */
static struct place between(
	const struct drawer *d, const struct place *a, const struct place *b, float part)
{
	float q = a->q + part * (b->q - a->q), by = part;
	if (d->lens.fan > 0)
		by = part * b->q / q;
	return (struct place){ a->x_px + part * (b->x_px - a->x_px),
		a->y_px + part * (b->y_px - a->y_px), q,
		a->along_m + by * (b->along_m - a->along_m),
		a->outline + by * (b->outline - a->outline),
		a->front + by * (b->front - a->front) };
}

/* ---- links ---- */

static float step_up(float value, float from, float to)
{
	float part = CLAMP((value - from) / (to - from), 0, 1);
	return part * part * (3 - 2 * part);
}

static float strength_of(const struct drawer *d, const struct scene_line *l, float outline)
{
	static const size_t by_kind[PROFILE_KINDS] = {
		[PROFILE_CREASE] = offsetof(struct profile_step, creases),
		[PROFILE_END] = offsetof(struct profile_step, creases),
		[PROFILE_MARK] = offsetof(struct profile_step, marks),
		[PROFILE_THIN] = offsetof(struct profile_step, thin),
	};
	float own = *(const float *)((const char *)d->step + by_kind[l->kind]);
	return own + outline * (1 - own);
}

/* How much of a line there is at a place: of what is short there, or has no room, nothing. */
static float survives(
	const struct drawer *d, const struct scene_line *l, float px_per_m, float away)
{
	float more = 1 + 3 * d->f->focus.abstraction * away;
	float least_px = d->step->least_px * d->px * more,
	      room_px = d->step->room_px * d->px * more;
	float ret = step_up(l->length_m * px_per_m, 0.7f * least_px, 1.3f * least_px + 1e-3f);
	if (l->apart_m < SCENE_LINES_APART_M)
		ret *= step_up(l->apart_m * px_per_m, 0.6f * room_px, 1.2f * room_px + 1e-3f);
	return ret * step_up(l->confidence, d->step->sure - 0.1f, d->step->sure + 1e-3f);
}

static float alpha_of(
	const struct drawer *d, const struct follow *w, const struct place *p, float away)
{
	const struct ink_step *ink = &d->layer->ink;
	float depth_m = depth_of(d, p->q);
	float alpha = ink->opacity * p->front * strength_of(d, w->line, p->outline) *
		      survives(d, w->line, scale_at(d, depth_m), away);
	alpha *= 1 - ink->opacity_variation * stroke_chance(w->number, SALT_FAINT);
	if (d->f->focus.is_there)
		alpha *= 1 - d->f->focus.amount * away;
	if (ink->fade_m > 0)
		alpha *= exp2f((d->lens.begin_m - depth_m) / ink->fade_m);
	return alpha;
}

static float away_at(const struct drawer *d, const struct place *p)
{
	float depth_m = depth_of(d, p->q), metres = 1 / scale_at(d, depth_m);
	float at_m[3] = { (p->x_px - d->lens.middle_x) * metres,
		(p->y_px - d->lens.middle_y) * metres, depth_m };
	return frame_away(&d->f->focus, at_m, d->layer->is_focus);
}

static float half_width_of(const struct drawer *d, const struct follow *w, const struct place *p)
{
	float px_per_m = scale_at(d, depth_of(d, p->q));
	float by = 1 + p->outline * (d->step->outlines - 1);
	by *= 1 + 0.6f * d->step->pressure *
			  noise_at_scale(w->number, SALT_PRESSURE, p->along_m,
				  px_per_m / (1.7f * d->step->wave_px * d->px));
	return 0.5f * by * d->layer->ink.width_px;
}

/* Whether what is hidden has a dot at a place. */
static bool is_dot(const struct drawer *d, const struct place *p)
{
	float per_m = scale_at(d, depth_of(d, p->q)) / (d->step->dash_px * d->px);
	float at = ldexpf(p->along_m, (int)floorf(log2f(fmaxf(per_m, 1e-6f))));
	return at - floorf(at) < 0.5f;
}

/* Where the pen is: beside the line by how the hand wobbles. */
static void pen_at(
	const struct drawer *d, const struct follow *w, const struct place *p, float ret[2])
{
	float per_m = scale_at(d, depth_of(d, p->q)) / (d->step->wave_px * d->px),
	      by_px = d->step->wobble_px * d->px;
	ret[0] = p->x_px + by_px * noise_at_scale(w->number, SALT_WOBBLE_X, p->along_m, per_m);
	ret[1] = p->y_px + by_px * noise_at_scale(w->number, SALT_WOBBLE_Y, p->along_m, per_m);
}

/* From where the pen is to beside that place; seen: where it is to be seen whether the link is. */
static void link_to(
	struct drawer *d, struct follow *w, const struct place *seen, const struct place *to)
{
	float at[2], away = away_at(d, seen), alpha = alpha_of(d, w, seen, away);
	pen_at(d, w, to, at);
	struct profile_link l = { .x_px = (w->last[0] + at[0]) / 2,
		.y_px = (w->last[1] + at[1]) / 2,
		.end = { (at[0] - w->last[0]) / 2, (at[1] - w->last[1]) / 2 },
		.see_px = { seen->x_px, seen->y_px },
		.depth_m = depth_of(d, seen->q),
		.half_width_px = half_width_of(d, w, seen),
		.alpha = alpha,
		.line = w->number };
	if (d->step->hidden > 0 && is_dot(d, seen))
		l.hidden_alpha = alpha * d->step->hidden;
	if (!w->is_open)
		l.flags = LINK_FIRST | (w->begins ? LINK_BEGINS : 0);
	w->is_open = true;
	w->begins = false;
	w->last[0] = at[0];
	w->last[1] = at[1];
	g_array_append_val(d->to, l);
}

static void begin_at(const struct drawer *d, struct follow *w, const struct place *p)
{
	if (!w->is_open)
		pen_at(d, w, p, w->last);
}

static void end_chain(struct drawer *d, struct follow *w, bool ends)
{
	if (w->is_open)
		g_array_index(d->to, struct profile_link, d->to->len - 1).flags |=
			LINK_LAST | (ends ? LINK_ENDS : 0);
	w->is_open = false;
	w->begins = false;
}

static void draw_between(
	struct drawer *d, struct follow *w, const struct place *a, const struct place *b)
{
	float length_px = hypotf(b->x_px - a->x_px, b->y_px - a->y_px);
	uint32_t count = (uint32_t)CLAMP(ceilf(length_px / (LINK_PX * d->px)), 1, LINKS_MOST);
	begin_at(d, w, a);
	for (uint32_t n = 0; n < count; n++) {
		struct place seen = between(d, a, b, ((float)n + 0.5f) / (float)count),
			     to = between(d, a, b, ((float)n + 1) / (float)count);
		link_to(d, w, &seen, &to);
	}
}

/* ---- what is in the picture ---- */

static bool cut_off(float from, float step, float low, float high, float part[2])
{
	if (step == 0)
		return from >= low && from <= high;
	float a = (low - from) / step, b = (high - from) / step;
	part[0] = fmaxf(part[0], fminf(a, b));
	part[1] = fminf(part[1], fmaxf(a, b));
	return part[0] < part[1];
}

/* The part that is in the picture, or a little beside it. */
static bool in_picture(
	const struct drawer *d, const struct place *a, const struct place *b, float part[2])
{
	float beyond = BEYOND_PX * d->px;
	part[0] = 0;
	part[1] = 1;
	return cut_off(a->x_px, b->x_px - a->x_px, -beyond, d->lens.width + beyond, part) &&
	       cut_off(a->y_px, b->y_px - a->y_px, -beyond, d->lens.height + beyond, part);
}

/* The same in depth, before there are places; false: nothing of it is left. */
static bool in_depth(const struct drawer *d, float a_m, float b_m, float part[2])
{
	part[0] = 0;
	part[1] = 1;
	return cut_off(a_m, b_m - a_m, d->lens.near_m, d->lens.far_m, part);
}

static struct place place_on(const struct drawer *d, const struct scene_line *l,
	const struct scene_line_vertex *v, const float a_m[3], const float b_m[3], float part)
{
	float at_m[3];
	for (int k = 0; k < 3; k++)
		at_m[k] = a_m[k] + part * (b_m[k] - a_m[k]);
	float from = outline_of(d, l, v, a_m), to = outline_of(d, l, v + 1, b_m);
	float front = front_of(d, v, a_m), front_to = front_of(d, v + 1, b_m);
	return place_of(d, at_m, v->along_m + part * (v[1].along_m - v->along_m),
		from + part * (to - from), front + part * (front_to - front));
}

/* A little further than the line goes, as draughtsmen do at corners; by: from the second place to the first. */
static void overshoot(struct drawer *d, struct follow *w, const struct place *end,
	const struct place *inner, uint32_t salt, struct place *ret)
{
	float px = d->step->overshoot_px * d->px * (0.4f + 1.2f * stroke_chance(w->number, salt));
	float x = end->x_px - inner->x_px, y = end->y_px - inner->y_px, length = hypotf(x, y);
	float by = length > 0 ? px / length : 0;
	*ret = *end;
	ret->x_px += by * x;
	ret->y_px += by * y;
	ret->along_m += (salt == SALT_BEGIN ? -px : px) / scale_at(d, depth_of(d, end->q));
}

static void follow_segment(struct drawer *d, struct follow *w, uint32_t n)
{
	const struct scene_line *l = w->line;
	const struct scene_line_vertex *v = &d->lines->vertex[l->first + n];
	float a_m[3], b_m[3], deep[2], part[2];
	to_camera(d, v->at_m, a_m);
	to_camera(d, v[1].at_m, b_m);
	if (!in_depth(d, a_m[2], b_m[2], deep)) {
		end_chain(d, w, false);
		return;
	}
	struct place a = place_on(d, l, v, a_m, b_m, deep[0]),
		     b = place_on(d, l, v, a_m, b_m, deep[1]);
	if (!in_picture(d, &a, &b, part)) {
		end_chain(d, w, false);
		return;
	}
	bool has_first = deep[0] <= 0 && part[0] <= 0, has_last = deep[1] >= 1 && part[1] >= 1;
	struct place from = between(d, &a, &b, part[0]), to = between(d, &a, &b, part[1]), more;
	bool is_begin = n == 0 && has_first && !l->closed,
	     is_end = n + 2 == l->count && has_last && !l->closed;
	if (!has_first)
		end_chain(d, w, false);
	w->begins = is_begin;
	if (is_begin && d->step->overshoot_px > 0) {
		overshoot(d, w, &from, &to, SALT_BEGIN, &more);
		draw_between(d, w, &more, &from);
	}
	draw_between(d, w, &from, &to);
	if (is_end && d->step->overshoot_px > 0) {
		overshoot(d, w, &to, &from, SALT_END, &more);
		draw_between(d, w, &to, &more);
	}
	if (!has_last || n + 2 == l->count)
		end_chain(d, w, is_end);
}

/* Nearer than the scale at which it would be too short it cannot be, so far as its ends tell. */
static bool may_be_seen(const struct drawer *d, const struct scene_line *l)
{
	float nearest_m = INFINITY;
	for (uint32_t n = 0; n < l->count; n++) {
		float at_m[3];
		to_camera(d, d->lines->vertex[l->first + n].at_m, at_m);
		nearest_m = fminf(nearest_m, at_m[2]);
	}
	nearest_m = fmaxf(nearest_m, d->lens.near_m);
	return nearest_m <= d->lens.far_m && survives(d, l, scale_at(d, nearest_m), 0) > 0;
}

static void draw_line(struct drawer *d, uint32_t n)
{
	struct follow w = { .line = &d->lines->line[n], .number = n };
	if (d->f->drawing->pipeline_of[w.line->leaf] != d->layer->pipeline ||
		!may_be_seen(d, w.line))
		return;
	for (uint32_t k = 0; k + 1 < w.line->count; k++)
		follow_segment(d, &w, k);
}

/* ---- all ---- */

uint32_t profile_lift(const struct frame_layer *l)
{
	float links = l->step->profile.taper_px / LINK_PX;
	return (uint32_t)CLAMP(links + 0.5f, 0, PROFILE_LIFT_MOST);
}

static struct drawer drawer_of(const frame *f, const struct frame_layer *l)
{
	struct drawer d = { f, l, &l->step->profile, f->scene->lines, lens_of(&f->camera) };
	const double *row[3] = { f->camera.right, f->camera.down, f->camera.forward };
	for (int k = 0; k < 3; k++) {
		d.eye_m[k] = (float)f->eye_m[k];
		for (int n = 0; n < 3; n++)
			d.turn[k][n] = (float)row[k][n];
	}
	d.px = f->ink_px;
	d.hides_backs = frame_pipeline(f, l->pipeline)->mask.backs == BACKS_HIDDEN;
	return d;
}

static bool is_near_window(const struct camera *c, const struct profile_link *l, float beyond)
{
	return l->see_px[0] >= -beyond && l->see_px[0] <= (float)c->width + beyond &&
	       l->see_px[1] >= -beyond && l->see_px[1] <= (float)c->height + beyond;
}

/* What a window shows of the links of the whole picture, which are the same in all windows. */
static void crop(const frame *f, GArray *links)
{
	const struct camera *c = &f->camera;
	struct profile_link *link = (struct profile_link *)(void *)links->data;
	float left = (float)c->whole.left, top = (float)c->whole.top;
	guint kept = 0;
	bool is_cut = false; /* the one before is not kept */
	for (guint n = 0; n < links->len; n++) {
		struct profile_link l = link[n];
		l.x_px -= left;
		l.y_px -= top;
		l.see_px[0] -= left;
		l.see_px[1] -= top;
		bool is_kept = is_near_window(c, &l, BEYOND_PX * f->ink_px);
		if (!is_kept && !is_cut && kept && !(l.flags & LINK_FIRST))
			link[kept - 1].flags |= LINK_LAST;
		if (is_kept && is_cut)
			l.flags |= LINK_FIRST;
		if (is_kept)
			link[kept++] = l;
		is_cut = !is_kept;
	}
	g_array_set_size(links, kept);
}

GArray *profile_links_new(const frame *f, const struct frame_layer *l)
{
	GArray *all = g_array_new(FALSE, FALSE, sizeof(struct profile_link));
	uint32_t lines = f->scene->lines ? f->scene->lines->lines : 0,
		 tasks = (lines + TASK_LINES - 1) / TASK_LINES;
	g_autofree GArray **part = g_new0(GArray *, tasks + 1);
	frame whole = frame_of_whole(f);
#pragma omp parallel for schedule(dynamic, 1) if (!f->single_thread)
	for (uint32_t task = 0; task < tasks; task++) {
		struct drawer d = drawer_of(&whole, l);
		d.to = part[task] = g_array_new(FALSE, FALSE, sizeof(struct profile_link));
		for (uint32_t n = task * TASK_LINES; n < MIN((task + 1) * TASK_LINES, lines); n++)
			draw_line(&d, n);
	}
	for (uint32_t task = 0; task < tasks; task++) {
		g_array_append_vals(all, part[task]->data, part[task]->len);
		g_array_unref(part[task]);
	}
	if (camera_is_window(&f->camera))
		crop(f, all);
	return all;
}
