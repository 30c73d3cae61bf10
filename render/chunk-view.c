#include "render/chunk-view.h"
#include "render/disc-lanes.h"
#include "render/splat.h"
#include "render/stroke.h"
#include <math.h>
#include <string.h>

/* Of the style's pixels: strokes of points beyond the edge of the picture. */
#define STROKES_REACH 64

static void turn(const struct camera *c, const double v[3], double ret[3])
{
	const double *row[3] = { c->right, c->down, c->forward };
	for (int k = 0; k < 3; k++)
		ret[k] = row[k][0] * v[0] + row[k][1] * v[1] + row[k][2] * v[2];
}

/* What the box covers on the screen, from its corners in front of the camera. */
static void bound(const frame *f, const double at[3], double half[3][3], struct chunk_view *v)
{
	const struct camera *c = &f->camera;
	double reach = fabs(half[0][2]) + fabs(half[1][2]) + fabs(half[2][2]);
	v->near_m = (float)fmax(at[2] - reach, c->near_m);
	v->far_m = (float)(at[2] + reach);
	v->low_px[0] = v->low_px[1] = 0;
	v->high_px[0] = (float)c->width;
	v->high_px[1] = (float)c->height;
	if (at[2] - reach < c->near_m && !(c->parallel_m > 0))
		return;
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	for (int corner = 0; corner < 8; corner++) {
		double p[3];
		for (int k = 0; k < 3; k++)
			p[k] = at[k] + (corner & 1 ? 1 : -1) * half[0][k] +
			       (corner & 2 ? 1 : -1) * half[1][k] +
			       (corner & 4 ? 1 : -1) * half[2][k];
		for (int k = 0; k < 2; k++) {
			double px = c->focal_px * p[k] / camera_scale_m(c, p[2]) +
				    (k ? camera_middle_y(c) : camera_middle_x(c));
			low[k] = fmin(low[k], px);
			high[k] = fmax(high[k], px);
		}
	}
	for (int k = 0; k < 2; k++) {
		v->low_px[k] = (float)low[k];
		v->high_px[k] = (float)high[k];
	}
}

/* The largest disc of the chunk's pipeline, in the mask or as coloured points. */
static float disc_margin_px(const frame *f, const struct chunk_view *v)
{
	const struct points_step *points = splat_step(f, v->pipeline);
	float disc = fmaxf(frame_pipeline(f, v->pipeline)->mask.disc, points ? points->size : 0);
	float radius = 0.5f * disc * v->chunk->disc_most_m * (float)f->camera.focal_px /
		       camera_scale_f(&f->camera, v->near_m);
	float least = fmaxf(DISC_RADIUS_LEAST, points ? points->least_px * f->px / 2 : 0);
	/* Those that stand for others are larger, but not much larger than a pixel. */
	return MIN(MAX(radius, least + 2 * disc), MAX(disc_radius_most(f), least)) + 1;
}

bool chunk_view_find(const frame *f, const struct scene_chunk *c, struct chunk_view *ret)
{
	if (c->is_aside)
		return false;
	double from_eye[3], at[3], half[3][3];
	for (int k = 0; k < 3; k++)
		from_eye[k] = c->centre_m[k] - f->eye_m[k];
	turn(&f->camera, from_eye, at);
	for (int k = 0; k < 3; k++) {
		double edge[3] = { 0 };
		edge[k] = c->half_m[k];
		turn(&f->camera, edge, half[k]);
	}
	double reach = fabs(half[0][2]) + fabs(half[1][2]) + fabs(half[2][2]);
	if (at[2] + reach < f->camera.near_m || at[2] - reach > f->camera.far_m)
		return false;
	*ret = (struct chunk_view){ .chunk = c, .pipeline = f->drawing->pipeline_of[c->leaf] };
	bound(f, at, half, ret);
	ret->margin_px = disc_margin_px(f, ret);
	float part = camera_scale_f(&f->camera, ret->near_m) / ret->near_m;
	float tilted =
		MIN(DISC_STEEPEST * ret->margin_px / (float)f->camera.focal_px * part, 1 / 3.f);
	float moved_m = stroke_moved_most_m(c, 1, 1);
	ret->nearest_m = fminf(ret->near_m * (1 - tilted), ret->near_m - moved_m);
	float moved_px = moved_m * frame_ray_most(f, NULL) * (float)f->camera.focal_px /
			 camera_scale_f(&f->camera, fmaxf(ret->nearest_m, (float)f->camera.near_m));
	float margin = fmaxf(ret->margin_px, moved_px) + STROKES_REACH * f->ink_px;
	if (ret->high_px[0] < -margin || ret->high_px[1] < -margin ||
		ret->low_px[0] > (float)f->camera.width + margin ||
		ret->low_px[1] > (float)f->camera.height + margin)
		return false;
	for (int k = 0; k < 3; k++) {
		ret->base[k] = (float)(at[k] - half[0][k] - half[1][k] - half[2][k]);
		for (int q = 0; q < 3; q++)
			ret->axis[q][k] = (float)(half[q][k] * 2 / 65535);
	}
	return true;
}

/* ---- from near to far ---- */

#define DIGIT_BITS 11
#define DIGITS     3 /* of 32 bits */

/* Above: how near it begins, in the order of its bits; below: the number of its chunk. */
static uint64_t place_of(float near_m, uint32_t chunk)
{
	uint32_t bits;
	memcpy(&bits, &near_m, sizeof bits);
	bits = bits >> 31 ? ~bits : bits | 0x80000000u;
	return (uint64_t)bits << 32 | chunk;
}

/* By some bits of the places; what is equal in them stays as it was. */
static void sort_by_digit(const uint64_t *from, uint64_t *to, uint32_t count, int shift)
{
	uint32_t begin[1 << DIGIT_BITS] = { 0 }, sum = 0;
	const uint32_t all = (1 << DIGIT_BITS) - 1;
	for (uint32_t n = 0; n < count; n++)
		begin[from[n] >> shift & all]++;
	for (uint32_t k = 0; k <= all; k++) {
		uint32_t own = begin[k];
		begin[k] = sum;
		sum += own;
	}
	for (uint32_t n = 0; n < count; n++)
		to[begin[from[n] >> shift & all]++] = from[n];
}

static void sort_places(uint64_t *place, uint64_t *spare, uint32_t count)
{
	uint64_t *from = place, *to = spare;
	for (int digit = 0; digit < DIGITS; digit++) {
		sort_by_digit(from, to, count, 32 + digit * DIGIT_BITS);
		uint64_t *was = from;
		from = to;
		to = was;
	}
	if (from != place)
		memcpy(place, from, count * sizeof *place);
}

#define UNSEEN UINT64_MAX

struct chunk_view *chunk_views_new(const frame *f, uint32_t *ret_count)
{
	const scene *s = f->scene;
	g_autofree struct chunk_view *found = g_new(struct chunk_view, s->chunks + 1);
	g_autofree uint64_t *place = g_new(uint64_t, s->chunks + 1),
			    *spare = g_new(uint64_t, s->chunks + 1);
#pragma omp parallel for schedule(static) if (!f->single_thread)
	for (uint32_t n = 0; n < s->chunks; n++) {
		bool is_seen = chunk_view_find(f, &s->chunk[n], &found[n]);
		place[n] = is_seen ? place_of(found[n].near_m, n) : UNSEEN;
	}
	uint32_t count = 0;
	for (uint32_t n = 0; n < s->chunks; n++)
		if (place[n] != UNSEEN)
			place[count++] = place[n];
	sort_places(place, spare, count);
	struct chunk_view *v = g_new(struct chunk_view, count + 1);
#pragma omp parallel for schedule(static) if (!f->single_thread)
	for (uint32_t n = 0; n < count; n++)
		v[n] = found[place[n] & UINT32_MAX];
	*ret_count = count;
	return v;
}
