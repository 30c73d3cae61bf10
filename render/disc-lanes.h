#ifndef RENDER_DISC_LANES_H
#define RENDER_DISC_LANES_H
/* Points of a chunk as discs of their own projected size, eight at a time: for the mask and for coloured points. Where points stand
 * closer than pixels, those of the first ranks stand for all and are wider: the continuous resolution queue, by the test of each
 * point (Xu & Chen 2004, section 7.4). Internal to mask-lanes.c, splat-lanes.c and bench-discs.c. */
#include "render/mask.h"
#include "render/project-lanes.h"
#include <math.h>

/* Points to a square pixel from which on they stand for others. */
#define DISC_CROWD      5.f
#define DISC_CROWD_ROOT __builtin_sqrtf(DISC_CROWD)
/* Discs are at least this wide, so that each covers the pixel that it is in; and at most that, of a picture of FRAME_STYLE_HEIGHT rows and
 * fewer: of larger ones as much wider as these are. */
#define DISC_RADIUS_LEAST 0.72f
#define DISC_RADIUS_MOST  48.f
static inline float disc_radius_most(const frame *f)
{
	return DISC_RADIUS_MOST * fmaxf(f->px, 1);
}
/* Depth over width: discs that are seen at a lower angle are tilted as little as that. */
#define DISC_STEEPEST 40.f

/* Pixels that a disc's box is wider, for what floats are rounded by. */
#define DISC_ROUNDING 1e-3f

/* How the points of one chunk become discs. */
struct disc_pass {
	struct lens lens;
	float turn[3][3]; /* site to camera */
	float disc, radius_least, radius_most;
	bool backs_hidden;
	bool has_planes; /* which points that are marked so are left to */
	bool is_inside; /* all points of the chunk are in the picture, and not before the near plane */
	bool is_crowded; /* points may stand for others */
	uint32_t end;    /* of the points that may be drawn */
	float per_rank;  /* 1 / all points of the chunk */
};

/* The first points of the chunk that may be among those that stand for all. */
static inline uint32_t disc_prefix(const struct lens *l, const struct chunk_view *v)
{
	float spacing_px = v->chunk->spacing_most_m * l->focal_px / LENS_SCALE_M(l, v->near_m);
	float part = spacing_px * spacing_px * DISC_CROWD;
	return part < 1 ? (uint32_t)ceilf(part * (float)v->chunk->count) : v->chunk->count;
}

/* More than floats are rounded by. */
#define DISC_SURELY 1.001f

/* At any of its places, even the farthest, points are wide enough apart. */
static inline bool disc_is_crowded(const struct lens *l, const struct chunk_view *v)
{
	return v->chunk->spacing_least_m * l->focal_px <
	       DISC_SURELY * LENS_SCALE_M(l, v->far_m) * (1 / DISC_CROWD_ROOT);
}

static inline bool disc_is_inside(const struct camera *c, const struct chunk_view *v)
{
	const float size[2] = { (float)c->width, (float)c->height };
	bool inside = v->near_m > DISC_SURELY * (float)c->near_m && v->far_m < (float)c->far_m;
	for (int k = 0; k < 2; k++)
		inside &= v->low_px[k] >= 0 && v->high_px[k] <= size[k];
	return inside;
}

static inline struct disc_pass disc_pass_of(
	const frame *f, const struct chunk_view *v, float disc, float radius_least)
{
	const struct camera *c = &f->camera;
	struct disc_pass p = { .lens = lens_of(c),
		.disc = disc,
		.radius_least = radius_least,
		.radius_most = disc_radius_most(f),
		.backs_hidden = frame_pipeline(f, v->pipeline)->mask.backs == BACKS_HIDDEN,
		.has_planes = frame_has_planes(f, v->pipeline),
		.is_inside = disc_is_inside(c, v),
		.per_rank = 1.f / (float)v->chunk->count };
	p.is_crowded = disc_is_crowded(&p.lens, v);
	p.end = p.has_planes && v->chunk->on_planes == v->chunk->count ? 0
								       : disc_prefix(&p.lens, v);
	const double *row[3] = { c->right, c->down, c->forward };
	for (int k = 0; k < 3; k++)
		for (int n = 0; n < 3; n++)
			p.turn[k][n] = (float)row[k][n];
	return p;
}

struct disc_lanes {
	vf x, y, radius, depth_m;
	/* A place d from the middle is inside where d . d + bend (aside . d)^2 < radius^2: discs that are met aslant are flat. aside is
	 * the normal on the screen. Its depth there is depth_m + slope aside . d. bend and slope are 0 without a normal. */
	vf aside[2], bend, slope;
	vf half[2]; /* of the box around it */
	vf rank;    /* 0 .. 1, of those that are drawn here */
	vi drawn;
};

/* Where discs are seen at no angle there is nothing to tilt. */
#define ASIDE_LEAST 1e-6f

/* Flat as its plane is seen, but not below the least radius. */
INLINE void bend_lanes(const struct disc_pass *p, vf length2, vf along, vf ray2, vf aside2, vi some,
	struct disc_lanes *d)
{
	float narrowest = 1 / (p->radius_least * p->radius_least);
	vf reach = d->radius * d->radius;
	/* 1 / cosine^2 */
	vf flat = least(length2 * ray2 / (along * along), reach * narrowest);
	flat = where(some, most(least(flat, all(1e3f)), all(1)) - 1);
	d->bend = where(some, flat / aside2);
	vf part = reach / (1 + flat);
	for (int k = 0; k < 2; k++)
		d->half[k] = root(part * (1 + d->bend * d->aside[1 - k] * d->aside[1 - k])) +
			     DISC_ROUNDING;
}

/* Its depth no steeper than DISC_STEEPEST, or a third of the distance. */
INLINE void tilt_lanes(
	const struct disc_pass *p, vi packed, float flat_radius, struct disc_lanes *d)
{
	vf site[3], n[3];
	unpack_lanes(packed, site);
	for (int k = 0; k < 3; k++)
		n[k] = p->turn[k][0] * site[0] + p->turn[k][1] * site[1] + p->turn[k][2] * site[2];
	vf right = (d->x - p->lens.middle_x) * (p->lens.fan / p->lens.focal_px),
	   down = (d->y - p->lens.middle_y) * (p->lens.fan / p->lens.focal_px);
	vf along = n[0] * right + n[1] * down + n[2];
	if (p->backs_hidden)
		d->drawn &= along <= 0;
	vf aside2 = n[0] * n[0] + n[1] * n[1], length2 = aside2 + n[2] * n[2];
	vi some = aside2 > ASIDE_LEAST * length2;
	/* depth = n . P / n . ray, or, where rays are parallel, it falls by n right / n ahead. */
	vf steep = most(magnitude(along) * p->lens.focal_px,
		root(aside2) * most(d->radius * 3, all(p->lens.focal_px / DISC_STEEPEST)));
	/* With the sign that along has not. */
	vi turned = ~(vi)along & INT32_MIN;
	d->slope = (vf)((vi)where(some, LENS_SCALE_M(&p->lens, d->depth_m) / steep) ^ turned);
	d->aside[0] = n[0];
	d->aside[1] = n[1];
	if (any((d->radius >= flat_radius) & d->drawn))
		bend_lanes(p, length2, along, right * right + down * down + 1, aside2, some, d);
	else
		d->bend = d->half[0] = d->half[1] = all(0);
}

/* How large they are, and whether their ranks are those of points that stand for others. */
INLINE vi size_lanes(const struct disc_pass *p, vf spacing_px, vf disc_px, struct disc_lanes *d)
{
	vf radius = 0.5f * p->disc * disc_px;
	vi is_drawn = all(0) == all(0);
	if (p->is_crowded) {
		/* The root of the part that is drawn, which is small where spacing is: this is the size of those that are left. */
		vf part = least(spacing_px * DISC_CROWD_ROOT, all(1)), limit = part * part;
		is_drawn = d->rank < limit;
		d->rank = d->rank / limit;
		radius = radius / part;
	}
	d->radius = least(most(radius, all(p->radius_least)), all(p->radius_most));
	return is_drawn;
}

INLINE vi is_in_picture(const struct disc_pass *p, const struct disc_lanes *d)
{
	return (d->depth_m > p->lens.near_m) & (d->depth_m <= p->lens.far_m) & (d->x > -d->radius) &
	       (d->y > -d->radius) & (d->x < p->lens.width + d->radius) &
	       (d->y < p->lens.height + d->radius);
}

/* All but normals: whether any of them is drawn. */
INLINE bool disc_lanes_place(const scene *s, const struct disc_pass *p, const struct chunk_view *v,
	uint32_t i, struct disc_lanes *d)
{
	uint32_t at = v->chunk->first + i;
	vf disc = load_u16(s->disc + at);
	vi on_plane = disc >= (float)SCENE_DISC_PLANE;
	if (p->has_planes && !any(~on_plane)) {
		d->drawn = on_plane ^ on_plane;
		return false;
	}
	disc = disc_sizes(disc);
	struct lane_places places = load_places(s->place + at);
	struct lane_points l = project_lanes(v, places.q, &p->lens);
	vf unit_px = l.px_per_m * s->unit_m;
	d->x = l.x_px;
	d->y = l.y_px;
	d->depth_m = l.depth_m;
	d->rank = ((float)i + 0.5f + lane_number) * p->per_rank;
	d->drawn = size_lanes(p, places.spacing * unit_px, disc * unit_px, d);
	if (p->has_planes)
		d->drawn &= ~on_plane;
	if (!p->is_inside)
		d->drawn &= is_in_picture(p, d);
	if (p->end - i < LANES)
		d->drawn &= lane_number < (float)(p->end - i);
	return any(d->drawn);
}

INLINE vi disc_normals(const scene *s, const struct chunk_view *v, uint32_t i)
{
	return *(const vi_loose *)(const void *)(s->normal + v->chunk->first + i);
}

/* Of drawn, and of x, y, depth, radius and rank: the rest only where some are drawn, and those with less than flat_radius have no
 * bend and half. */
INLINE void disc_lanes_find(const scene *s, const struct disc_pass *p, const struct chunk_view *v,
	uint32_t i, float flat_radius, struct disc_lanes *d)
{
	if (disc_lanes_place(s, p, v, i, d))
		tilt_lanes(p, disc_normals(s, v, i), flat_radius, d);
}

/* One of them, as it is drawn pixel by pixel: what splat-lanes.c and surface-pass-lanes.c share. */
struct disc_one {
	float x, y, radius, half[2], squash[2], tilt[2], depth_m;
};

INLINE struct disc_one disc_lanes_one(const struct disc_lanes *d, int k)
{
	float squash = sqrtf(d->bend[k]), slope = d->slope[k],
	      aside[2] = { d->aside[0][k], d->aside[1][k] };
	return (struct disc_one){ d->x[k], d->y[k], d->radius[k], { d->half[0][k], d->half[1][k] },
		{ squash * aside[0], squash * aside[1] }, { slope * aside[0], slope * aside[1] },
		d->depth_m[k] };
}

/* Of eight pixels so far from its middle: 1 there to 0 at its border and beyond. */
INLINE vf disc_one_weight(const struct disc_one *s, vf dx, float dy)
{
	float steep = 1 / (s->radius * s->radius);
	vf across = s->squash[0] * dx + s->squash[1] * dy;
	return most(1 - (dx * dx + dy * dy + across * across) * steep, all(0));
}

INLINE vf disc_one_depth(const struct disc_one *s, vf dx, float dy)
{
	return s->depth_m + s->tilt[0] * dx + s->tilt[1] * dy;
}

/* Whether the mask has them of that pipeline, and no nearer. */
INLINE vi disc_one_shows(vi key, int32_t pipeline, vf depth_m)
{
	return ((key & ((1 << MASK_PIPELINE_BITS) - 1)) == pipeline) & ((vf)key >= depth_m);
}

/* Pixels that it may cover, of rows from .. end of a picture so wide. */
struct disc_reach {
	int top, bottom, left, right;
};

INLINE struct disc_reach disc_one_reach(
	const struct disc_one *s, uint32_t from, uint32_t end, uint32_t width)
{
	return (struct disc_reach){ MAX((int)floorf(s->y - s->half[1]), (int)from),
		MIN((int)floorf(s->y + s->half[1]), (int)end - 1),
		MAX((int)floorf(s->x - s->half[0]), 0),
		MIN((int)floorf(s->x + s->half[0]), (int)width - 1) };
}

#endif
