#ifndef RENDER_STROKE_NEED_H
#define RENDER_STROKE_NEED_H
/* How many strokes are wanted where a point is, and its place among the points that there are (stroke.h): on surface for eight points
 * at a time, along edges for one. Internal to stroke-lanes.c and hatch-lanes.c; all is inlined. */
#include "render/project-lanes.h"
#include "render/stroke-brush.h"

/* A surface seen at a lower cosine counts as seen at this one. */
#define COSINE_LEAST 0.1f
/* Of points without a normal, and of feature points without a line that are drawn alone: most are leaves. They stand any way, but many of
 * them are hidden by others where the mask has none. */
#define COSINE_UNKNOWN 1.f

/* Those of edges are as dense along them; but where a tone is shown they are surface like all other points. */
INLINE bool is_on_edge(const struct brush *b)
{
	return b->kind == FEATURE_DIRECTED && !b->layer->is_queue;
}

/* As dense as all points are, and dithering points no denser than that. */
INLINE bool has_own_spacing(const struct brush *b)
{
	return !(b->layer->together >> b->kind & 1) && !(b->dither_m > 0);
}

INLINE float need_along(const struct brush *b, const struct candidate *c, const struct line *l)
{
	return l->px_per_m * c->spacing_m / (b->layer->ink.spacing_px * STROKE_FADE_MEAN);
}

/* ---- eight points ---- */

/* stroke_fade_octaves() */
INLINE vf octaves_of(vf depth_m)
{
	return least(most(STROKE_FADE_NEAR_M / depth_m, all(1)), all(STROKE_FADE_MOST));
}

/* Where strokes of points at this depth may be. */
INLINE vf nearest_of(const struct brush *b, vf depth_m)
{
	return most(depth_m - b->moved_m, all(b->lens.near_m));
}

struct lane_candidates {
	vi point; /* of the scene; so many as there may be in it fit (scene.h) */
	vi id;    /* scene_id(), of those that are left */
	uint32_t copy;
	vf rank;    /* of its kind in the chunk, then: points to a square metre before it */
	vf most;    /* no rank above it is drawn */
	vf octaves; /* that it fades in over */
	vf last; /* points that there are, to a square metre: so much higher is the rank of the next copy */
	vf wanted, need; /* strokes to a square pixel, to a square metre */
	vf x_px, y_px, depth_m, spacing_m;
	vf normal[3]; /* as the camera sees it; 0 0 0: none */
	vf site_normal[3];
	vi is_flat;
	vi spreads; /* has a patch, in the plane of its normal, that it is moved in and gives copies in: what is flat, and leaves of hatching */
	vf away;    /* 0..1: from the focus */
	unsigned left; /* which of them may be drawn */
};

/* floorf */
INLINE vf floor_of(vf x)
{
	vf whole = __builtin_convertvector(__builtin_convertvector(x, vi), vf);
	return whole - where(whole > x, all(1));
}

/* Of numbers above 0, within 2e-5: ln m = 2 (s + s^3/3 + s^5/5 ..) with s = (m - 1) / (m + 1), and m from 1 to 2. */
INLINE vf log2_of(vf x)
{
	vi exponent = ((vi)x >> 23) - 127;
	vf m = (vf)(((vi)x & 0x7fffff) | 0x3f800000), s = (m - 1) / (m + 1), s2 = s * s;
	vf ln = 2 * s * (1 + s2 * (1 / 3.f + s2 * (1 / 5.f + s2 * (1 / 7.f))));
	return __builtin_convertvector(exponent, vf) + ln * (float)(1 / G_LN2);
}

/* stroke_fade() */
INLINE vf fade_of(vf rank, vf need, vf octaves)
{
	vf fade = least(log2_of(need / rank) / octaves, all(1));
	return where(rank < need, fade);
}

/* What chance knows the points by. */
INLINE void find_ids(const struct brush *b, struct lane_candidates *c)
{
	c->id = b->f->scene->id ? gather(b->f->scene->id, c->point, 4) : c->point;
}

/* Of planes of the scene. */
INLINE vf gather_u8(const uint8_t *x, vi at)
{
	return __builtin_convertvector(gather(x, at, sizeof *x) & UINT8_MAX, vf);
}

INLINE vf gather_u16(const uint16_t *x, vi at)
{
	return __builtin_convertvector(gather(x, at, sizeof *x) & UINT16_MAX, vf);
}

/* scene_lightness() */
INLINE vi lightness_of(vi rgba)
{
	vi light = 77 * (rgba & 255) + 150 * (rgba >> 8 & 255) + 29 * (rgba >> 16 & 255) + 128;
	vi has_colour = (rgba >> 24 & 255) != 0;
	return (light >> 8 & has_colour) | (128 & ~has_colour);
}

/* stroke_chance() */
INLINE vf lanes_chance(vi point, uint32_t salt)
{
	vu x = (vu)point * 0x9E3779B9u ^ salt * 0x85EBCA6Bu;
	x ^= x >> 16;
	x *= 0x7feb352du;
	x ^= x >> 15;
	x *= 0x846ca68bu;
	x ^= x >> 16;
	return __builtin_convertvector((vi)(x >> 8), vf) * (1.f / (1 << 24));
}

/* -1 .. 1 */
INLINE vf lanes_around_zero(vi point, uint32_t salt)
{
	return 2 * lanes_chance(point, salt) - 1;
}

/* Of all points where dithering points are, to a square metre: c->spacing_m is how far apart these are alone. */
INLINE vf per_m2_of(const struct brush *b, const struct lane_candidates *c)
{
	const scene *s = b->f->scene;
	vi word = gather(&s->place->q[2], c->point, sizeof *s->place);
	vf spacing_m = __builtin_convertvector((vi)((vu)word >> 16), vf) * s->unit_m;
	return 1 / (spacing_m * spacing_m);
}

/* Where a tone is shown all other points come after the dithering points, in one queue with them; copies come after all points. */
INLINE void find_place(const struct brush *b, vi lightness, struct lane_candidates *c)
{
	vf per_m2 = 1 / (c->spacing_m * c->spacing_m);
	c->last = per_m2;
	if (b->layer->is_queue) {
		if (b->kind == FEATURE_DITHER)
			c->last = per_m2_of(b, c);
		vf there = least(
			(vf)gather(b->layer->dithering_per_m2, lightness, 4) * b->view->chunk->part,
			c->last);
		c->rank = b->kind == FEATURE_DITHER ? c->rank * there
						    : there + c->rank * (c->last - there);
	} else
		c->rank *= per_m2;
}

INLINE vf turn_lanes(const struct brush *b, int k, const vf v[3])
{
	return b->turn[k][0] * v[0] + b->turn[k][1] * v[1] + b->turn[k][2] * v[2];
}

/* Of length 1; 0 0 0 where there is none, which is not among those that are returned. */
INLINE vi unit_lanes(vi packed, vf n[3])
{
	unpack_lanes(packed, n);
	vi some = (packed << 16 >> 16) != INT16_MIN;
	vf unit = where(some, 1 / root(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]));
	for (int k = 0; k < 3; k++)
		n[k] *= unit;
	return some;
}

INLINE void find_normals(const struct brush *b, vi packed, struct lane_candidates *c)
{
	vi some = unit_lanes(packed, c->site_normal);
	for (int k = 0; k < 3; k++)
		c->normal[k] = turn_lanes(b, k, c->site_normal);
	c->is_flat = c->spreads = frame_layer_has_surface(b->layer, b->kind) ? some : (vi){ 0 };
}

INLINE vi has_no_normal(const struct lane_candidates *c)
{
	return (c->normal[0] == 0) & (c->normal[1] == 0) & (c->normal[2] == 0);
}

/* Where they are seen, at the depth of 1. */
INLINE void seen_at(const struct brush *b, const struct lane_candidates *c, vf ret[2])
{
	ret[0] = (c->x_px - b->lens.middle_x) * (1 / b->lens.focal_px);
	ret[1] = (c->y_px - b->lens.middle_y) * (1 / b->lens.focal_px);
}

/* Of depth 1. */
INLINE void rays_of(const struct brush *b, const struct lane_candidates *c, vf ret[2])
{
	seen_at(b, c, ret);
	for (int k = 0; k < 2; k++)
		ret[k] *= b->lens.fan;
}

/* -1 .. 1: where a copy lies in the patch of each point, along one of its axes; itself anywhere. */
INLINE vf place_in_patch(const struct lane_candidates *c, uint32_t salt, float step)
{
	float steps = (float)c->copy * step;
	vf at = lanes_chance(c->id, salt) + (steps - (float)(int)steps);
	return 2 * (at - where(at >= 1, all(1))) - 1;
}

/* Strokes that each point gives at most. */
INLINE vf copies_of(const struct brush *b, const struct lane_candidates *c)
{
	vf leaves = choose(c->spreads, all((float)MIN(b->copies, LEAVES_COPIES)), all(1));
	return choose(c->is_flat, all((float)b->copies), leaves);
}

/* On to the next stroke of each point: leaves those that may give one. */
INLINE void next_copy(struct lane_candidates *c, vf copies)
{
	c->copy++;
	c->rank += c->last;
	c->left &= bits((c->rank < c->most) & ((float)c->copy < copies));
}

/* Moves points in their planes, inside the patches that they stand for. */
INLINE void scatter(const struct brush *b, struct lane_candidates *c)
{
	/* Two axes of the plane (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"), which do not turn with the camera. */
	const vf *n = c->site_normal;
	vf sign = choose(n[2] >= 0, all(1), all(-1)), s = -1 / (sign + n[2]), t = n[0] * n[1] * s;
	vf axis[2][3] = { { 1 + sign * n[0] * n[0] * s, sign * t, -sign * n[0] },
		{ t, sign + n[1] * n[1] * s, -n[1] } };
	vf reach_m = disc_sizes(gather_u16(b->f->scene->disc, c->point)) *
		     (stroke_reach(b->layer->ink.scatter, c->copy) * b->f->scene->unit_m);
	vf by[2] = { reach_m * place_in_patch(c, SALT_ACROSS, COPY_ACROSS),
		reach_m * place_in_patch(c, SALT_DOWN, COPY_DOWN) };
	vf seen[2], moved[3], at[3], deep = LENS_SCALE_M(&b->lens, c->depth_m);
	seen_at(b, c, seen);
	for (int k = 0; k < 3; k++)
		moved[k] = by[0] * axis[0][k] + by[1] * axis[1][k];
	for (int k = 0; k < 3; k++)
		at[k] = (k < 2 ? seen[k] * deep : c->depth_m) + turn_lanes(b, k, moved);
	vi moves = c->spreads & (at[2] >= b->lens.near_m);
	vf scale = b->lens.focal_px / LENS_SCALE_M(&b->lens, at[2]);
	c->depth_m = choose(moves, at[2], c->depth_m);
	c->x_px = choose(moves, b->lens.middle_x + at[0] * scale, c->x_px);
	c->y_px = choose(moves, b->lens.middle_y + at[1] * scale, c->y_px);
}

/* frame_diffuse() */
INLINE vf diffuse_of(const struct brush *b, const struct lane_candidates *c)
{
	const float *from = b->f->light.from;
	return 0.5f +
	       0.5f * (c->normal[0] * from[0] + c->normal[1] * from[1] + c->normal[2] * from[2]);
}

/* Strokes to a square pixel that points of this lightness want in the light. */
INLINE vf wanted_of(const struct brush *b, const struct lane_candidates *c, vi lightness)
{
	const float *wanted = b->layer->wanted_per_px;
	float amount = b->f->light.amount;
	if (b->layer->lit == LIT_OMITTED)
		return (vf)gather(wanted, lightness, 4) * (1 - amount * diffuse_of(b, c));
	if (b->layer->lit == LIT_TONE)
		lightness = __builtin_convertvector(__builtin_convertvector(lightness, vf) *
							    (1 - amount * (1 - diffuse_of(b, c))),
			vi);
	return (vf)gather(wanted, lightness, 4);
}

/* frame_away() of where they are */
INLINE vf away_of(const struct brush *b, const struct lane_candidates *c)
{
	const struct frame_focus *focus = &b->f->focus;
	bool is_place = focus->on == FOCUS_PLACE;
	vf seen[2], deep = is_place ? LENS_SCALE_M(&b->lens, c->depth_m) : all(1);
	if (!focus->is_there)
		return all(0);
	if (focus->on == FOCUS_SEGMENT)
		return all(b->layer->is_focus ? 0 : 1);
	seen_at(b, c, seen);
	vf right = seen[0] * deep - focus->at_m[0], down = seen[1] * deep - focus->at_m[1],
	   ahead = (is_place ? c->depth_m : all(1)) - focus->at_m[2];
	vf part = clamp01((root(right * right + down * down + ahead * ahead) - focus->radius_m) *
			  focus->per_m);
	return part * part * (3 - 2 * part);
}

/* So much larger strokes are for being away from the focus. */
INLINE vf enlarged(const struct brush *b, const struct lane_candidates *c)
{
	return 1 + b->f->focus.abstraction * c->away;
}

/* Of the angle that a surface is seen at, times how much longer the ray is than the depth: a square metre of it covers so many
 * (focal length / depth)^2. along: the normal along the ray. */
INLINE vf cosine_of(const struct brush *b, const struct lane_candidates *c, vf along)
{
	if (b->kind == FEATURE_UNDIRECTED && !b->layer->is_queue)
		return all(COSINE_UNKNOWN);
	vi unknown = has_no_normal(c);
	if (frame_layer_is_whole(b->layer)) /* leaves have normals, but are no surface */
		unknown |= ~c->is_flat;
	return choose(unknown, all(COSINE_UNKNOWN), most(magnitude(along), all(COSINE_LEAST)));
}

INLINE vf along_of(const struct brush *b, const struct lane_candidates *c)
{
	vf ray[2];
	rays_of(b, c, ray);
	return c->normal[0] * ray[0] + c->normal[1] * ray[1] + c->normal[2];
}

/* What is the same for all copies of the points, and how many of them may be wanted. */
INLINE void find_wanted(const struct brush *b, struct lane_candidates *c)
{
	vi lightness = lightness_of(gather(b->f->scene->rgba, c->point, 4));
	vf nearest_m = nearest_of(b, c->depth_m),
	   px_per_m = b->lens.focal_px / LENS_SCALE_M(&b->lens, nearest_m);
	bool lit = b->layer->lit == LIT_TONE || b->layer->lit == LIT_OMITTED;
	if (lit)
		find_normals(b, gather(b->f->scene->normal, c->point, 4), c);
	c->wanted = wanted_of(b, c, lightness);
	find_place(b, lightness, c);
	c->most = c->wanted * px_per_m * px_per_m * STROKE_FADE_MORE(octaves_of(nearest_m));
	c->left &= bits(c->rank < c->most * b->ray_most);
	if (!c->left)
		return;
	if (!lit)
		find_normals(b, gather(b->f->scene->normal, c->point, 4), c);
	/* Moved they are seen at another angle. */
	vf turned = b->moved_m * b->ray_most / nearest_m;
	c->most *= least(cosine_of(b, c, magnitude(along_of(b, c)) + turned), all(b->ray_most));
	c->left &= bits(c->rank < c->most);
}

/* Leaves those that are wanted where they are, and seen from the front where backs are hidden. Their need is known then, and they are
 * where they are drawn. */
INLINE void find_need(const struct brush *b, bool backs_hidden, struct lane_candidates *c)
{
	if (b->layer->ink.scatter > 0)
		scatter(b, c);
	vf along = along_of(b, c), px_per_m = b->lens.focal_px / LENS_SCALE_M(&b->lens, c->depth_m);
	c->away = away_of(b, c);
	c->need = c->wanted * px_per_m * px_per_m * cosine_of(b, c, along) /
		  (enlarged(b, c) * enlarged(b, c));
	c->octaves = octaves_of(c->depth_m);
	c->left &= bits(c->rank < c->need * STROKE_FADE_MORE(c->octaves));
	if (backs_hidden)
		c->left &= bits(along <= 0);
}

#endif
