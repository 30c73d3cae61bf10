#ifndef RENDER_PAINT_NEED_H
#define RENDER_PAINT_NEED_H
/* Brush strokes of eight points at a time: which of them, how large, along what. Internal to paint-lanes.c; all is inlined.
 *
 * A point whose rank is the part t of what the view asks for has a stroke of t^-PAINT_POWER times the size of the finest, and at most of
 * the broadest. Where the picture becomes larger, t becomes smaller: the stroke grows, a little faster than the surface that it is on,
 * until it is one of the broadest. Where little is to be seen the last in rank are left out, which are the fine ones; where there are too
 * few points for fine ones, their strokes are the broader for it. */
#include "render/stroke-rows.h"
#include "render/surface-lanes.h"

/* A level way that is shorter than this, as that of floors, gives way to the picture's right. */
#define LEVEL_LEAST 0.15f
#define LEVEL_SURE  0.45f
/* Ways that are across each other turn either way, by what floats are rounded by: upright edges of walls are, to level ways. So they turn
 * one way; sine of twice the angle. */
#define ACROSS_SURE 1e-3f
/* A way that lies less in the plane is none of it. */
#define FOLLOW_LEAST 0.25f

struct paint_lanes {
	vi rgb_detail, way; /* of what is seen of the points (scene-paint.h), bytes and halves */
	vf part;            /* of all strokes that are wanted, those that are here */
	vf along[3], up[3]; /* in the plane of the stroke, as the camera sees it; unit */
	vf wave;            /* -1..1: how strokes around here are turned */
	vf aslant; /* what is left of a stroke's area on the screen; of that its length has */
	vf shorter;
};

/* ---- along what ---- */

/* 1 at whole numbers, -1 between them. */
INLINE vf zigzag(vf x)
{
	vf part = x - floor_of(x);
	return magnitude(part - 0.5f) * 4 - 1;
}

/* The hand turns slowly from place to place of the site; cells of metres. */
INLINE vf wave_at(const struct brush *b, vi point)
{
	const struct scene_chunk *c = b->view->chunk;
	struct lane_places p = gather_places(b->f->scene->place, point);
	vf m[3];
	for (int k = 0; k < 3; k++)
		m[k] = c->centre_m[k] - c->half_m[k] + c->step_m[k] * p.q[k];
	return 0.5f * zigzag(0.11f * m[0] + 0.07f * m[1] + 0.05f * m[2]) +
	       0.5f * zigzag(0.31f * m[1] - 0.23f * m[0] + 0.19f * m[2]);
}

/* The plane that strokes lie in: leaves have none, and face the camera. Tells which lie on surface. */
INLINE vi paint_plane(const struct brush *b, const struct lane_candidates *c, vf ret[3])
{
	bool flat = b->layer->paint->step.lies == LIES_SURFACE;
	vi is_flat = flat ? c->is_flat : (vi){ 0 };
	vf ray[2];
	rays_of(b, c, ray);
	vf unit = 1 / root(ray[0] * ray[0] + ray[1] * ray[1] + 1);
	for (int k = 0; k < 3; k++)
		ret[k] = choose(is_flat, c->normal[k], (k < 2 ? ray[k] : all(1)) * unit);
	return is_flat;
}

/* Around the middle of what they are leaves of. */
INLINE void crown_way(
	const struct brush *b, const struct lane_candidates *c, const vf plane[3], vf ret[3])
{
	vf scale = LENS_SCALE_M(&b->lens, c->depth_m) * (1 / b->lens.focal_px);
	vf from[3] = { (c->x_px - b->lens.middle_x) * scale - b->crown_m[0],
		(c->y_px - b->lens.middle_y) * scale - b->crown_m[1], c->depth_m - b->crown_m[2] };
	cross_lanes(plane, from, ret);
	lay_flat(plane, ret);
}

/* Turns a unit way in the plane towards another one, by part 0..1. Ways have no sign: twice their angles are mixed, so that nothing
 * jumps where they are across each other, but for halves. */
INLINE void mix_ways(const vf plane[3], vf way[3], const vf other[3], vf part)
{
	vf up[3];
	cross_lanes(plane, way, up);
	vf a = dot_lanes(other, way), b = dot_lanes(other, up);
	vf cosine = 1 + part * (a * a - b * b - 1), sine = part * 2 * a * b;
	cosine /= most(root(cosine * cosine + sine * sine), all(1e-6f));
	vf along = root(most(0.5f + 0.5f * cosine, all(0))),
	   across = root(most(0.5f - 0.5f * cosine, all(0)));
	across = choose(sine < -ACROSS_SURE, -across, across);
	for (int k = 0; k < 3; k++)
		way[k] = along * way[k] + across * up[k];
}

/* Level ways of walls and roofs; of floors the picture's right. */
INLINE void level_way(const struct brush *b, const vf plane[3], vf ret[3])
{
	vf level[3], site_up[3] = { all(b->turn[0][2]), all(b->turn[1][2]), all(b->turn[2][2]) };
	ret[0] = all(1);
	ret[1] = ret[2] = all(0);
	lay_flat(plane, ret);
	cross_lanes(site_up, plane, level);
	vf length = root(dot_lanes(level, level));
	for (int k = 0; k < 3; k++)
		level[k] /= most(length, all(1e-3f));
	mix_ways(plane, ret, level,
		clamp01((length - LEVEL_LEAST) * (1 / (LEVEL_SURE - LEVEL_LEAST))));
}

/* Towards the way that the point's surroundings have. */
INLINE void follow_way(
	const struct brush *b, const vf plane[3], const struct paint_lanes *p, vf ret[3])
{
	vf site[3], own[3];
	vi some = unit_lanes(p->way, site);
	for (int k = 0; k < 3; k++)
		own[k] = turn_lanes(b, k, site);
	vf left = lay_flat(plane, own), clear = clamp01((left - FOLLOW_LEAST) * (1 / FOLLOW_LEAST));
	mix_ways(plane, ret, own, where(some, clear * b->layer->paint->step.follow));
}

INLINE void find_way(const struct brush *b, const struct lane_candidates *c, struct paint_lanes *p)
{
	vf plane[3], crown[3];
	vi lies = paint_plane(b, c, plane);
	level_way(b, plane, p->along);
	if (bits(~c->is_flat) & c->left) {
		crown_way(b, c, plane, crown);
		for (int k = 0; k < 3; k++)
			p->along[k] = choose(c->is_flat, p->along[k], crown[k]);
	}
	follow_way(b, plane, p, p->along);
	cross_lanes(plane, p->along, p->up);
	p->wave = where(c->is_flat, wave_at(b, c->point));
	vf part = least(way_on_screen(b, c, p->along).part, all(1)),
	   area = choose(lies, least(magnitude(along_of(b, c)), all(1)), all(1));
	p->aslant = most(area, all(PAINT_NARROWEST));
	p->shorter = most(part, p->aslant);
}

/* ---- how many ---- */

/* Points to a square metre that are wanted at most, of one to a square pixel. Leaves those that are seen from the front where backs are
 * hidden. */
INLINE vf paint_per_px(const struct brush *b, struct lane_candidates *c)
{
	vf nearest_m = nearest_of(b, c->depth_m),
	   px_per_m = b->lens.focal_px / LENS_SCALE_M(&b->lens, nearest_m);
	vf turned = b->moved_m * b->ray_most / nearest_m, along = along_of(b, c);
	if (hides_backs(b))
		c->left &= bits(along <= turned);
	return px_per_m * px_per_m * STROKE_FADE_MORE(octaves_of(nearest_m)) *
	       least(cosine_of(b, c, magnitude(along) + turned), all(b->ray_most));
}

/* scene_paint_rgb() */
INLINE vi seen_rgb(vi look)
{
	return SCENE_PAINT_OF_FIVE(look & 31) | SCENE_PAINT_OF_SIX(look >> 5 & 63) << 8 |
	       SCENE_PAINT_OF_FIVE(look >> 11 & 31) << 16;
}

/* scene_paint_way() */
INLINE vi seen_way(vi look)
{
	vi first = look << 8 >> 24, second = look >> 24;
	vi way = (first * SCENE_PAINT_WAY_FACTOR & UINT16_MAX) | second * SCENE_PAINT_WAY_FACTOR
									 << 16;
	vi none = first == SCENE_PAINT_NO_WAY;
	return (way & ~none) | (none & (MODEL_NORMAL_NONE & UINT16_MAX));
}

/* What is the same for all copies of the points. What is quickly told comes first. */
INLINE void find_paint(const struct brush *b, struct lane_candidates *c, struct paint_lanes *p)
{
	const struct frame_paint *paint = b->layer->paint;
	const scene *s = b->f->scene;
	vi look = gather(paint->seen->look, c->point, 4),
	   detail = gather(paint->seen->detail, c->point, 1) & UINT8_MAX;
	p->rgb_detail = seen_rgb(look) | detail << 24;
	p->way = seen_way(look);
	p->part = (vf)gather(paint->part, detail, 4);
	c->last = 1 / (c->spacing_m * c->spacing_m);
	c->rank *= c->last;
	c->wanted = p->part * b->layer->wanted_per_px[0];
	find_normals(b, gather(s->normal, c->point, 4), c);
	if (scene_paint_chunk_of(paint->seen, s, b->view->chunk)->is_leafy)
		c->is_flat &= (gather(s->kind, c->point, 1) & UINT8_MAX) != FEATURE_UNDIRECTED;
	else
		c->is_flat = ~has_no_normal(c);
	c->spreads = c->is_flat;
	c->wanted *= choose(c->is_flat, all(1), all(PAINT_LEAVES));
	vf per_px = paint_per_px(b, c);
	c->left &= bits(c->rank * PAINT_NARROWEST < c->wanted * per_px);
	if (!c->left)
		return;
	find_way(b, c, p);
	c->wanted /= p->aslant;
	c->most = c->wanted * per_px;
	c->left &= bits(c->rank < c->most);
}

/* ---- how large ---- */

/* As parts of the broadest: by the place in the queue of all that are wanted. Details are no broad strokes, which would wipe them out. */
INLINE vf paint_size(
	const struct brush *b, const struct lane_candidates *c, const struct paint_lanes *p)
{
	const struct paint_step *step = &b->layer->paint->step;
	vf all_need = c->need / p->part;
	vf detail = __builtin_convertvector(p->rgb_detail >> 24 & 255, vf) * (1 / 255.f);
	vf broadest = 1 - PAINT_DETAIL_SMALLER * step->detail * (1 - step->fine) * detail;
	vf half_power = root(all_need / c->rank); /* and half of that more: PAINT_POWER */
	return least(most(step->fine * half_power * root(half_power), all(step->fine)), broadest);
}

/* Half the size that strokes have at least: that of the disc by which their points hide others, where nothing else would be drawn; but
 * no more than the most. */
INLINE vf paint_least(const struct brush *b, const struct lane_candidates *c, float most_px)
{
	float disc = frame_pipeline(b->f, b->layer->pipeline)->mask.disc;
	vf disc_px = disc_sizes(gather_u16(b->f->scene->disc, c->point)) *
		     (PAINT_DISC * disc * b->f->scene->unit_m * b->lens.focal_px) /
		     LENS_SCALE_M(&b->lens, c->depth_m);
	return least(disc_px, all(most_px));
}

/* Where there are too few points for broad ones to cover all. */
INLINE vf paint_growth(
	const struct brush *b, const struct lane_candidates *c, const struct paint_lanes *p)
{
	struct lane_candidates broad = *c;
	broad.need = c->need * b->layer->paint->broad / p->part;
	return growth_of(b, &broad);
}

#endif
