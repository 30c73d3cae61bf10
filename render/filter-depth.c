/* Filters that ask how deep things are: swaying, shade in corners, eye-dome lighting of a whole picture. */
#include "render/edl.h"
#include "render/filter-tables.h"
#include "render/grain.h"
#include <math.h>
#include <string.h>

/* ---- swaying ---- */

struct swaying {
	const struct filter_job *j;
	const struct filter_image *image;
	struct warp_wave by;
	float *depth_m, (*normal)[3];
	uint16_t *leaf;
	uint8_t *grey;
};

/* Of the four pixels around some are of something, some of nothing. */
static bool is_border(const struct filter_image *i, float x, float y)
{
	uint32_t left = (uint32_t)CLAMP(x, 0, (float)(i->width - 1)),
		 top = (uint32_t)CLAMP(y, 0, (float)(i->height - 1)),
		 right = MIN(left + 1, i->width - 1), below = MIN(top + 1, i->height - 1);
	const float *upper = i->depth_m + (size_t)top * i->width,
		    *lower = i->depth_m + (size_t)below * i->width;
	int there = (upper[left] < FILTER_FAR) + (upper[right] < FILTER_FAR) +
		    (lower[left] < FILTER_FAR) + (lower[right] < FILTER_FAR);
	return there && there < 4;
}

static void sway_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct swaying *s = data;
	const struct filter_image *i = s->image;
	uint32_t left = filter_whole_left(s->j), top = filter_whole_top(s->j);
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			float at[2] = { (float)(x + left), (float)(y + top) };
			float by = s->by.amplitude * sinf(at[0] * s->by.wave[0] +
							     at[1] * s->by.wave[1] + s->by.phase);
			float from_x = (float)x - by * s->by.way[0],
			      from_y = (float)y - by * s->by.way[1], rgb[3];
			size_t to = (size_t)y * i->width + x;
			size_t near =
				(size_t)CLAMP(from_y + 0.5f, 0, (float)(i->height - 1)) * i->width +
				(size_t)CLAMP(from_x + 0.5f, 0, (float)(i->width - 1));
			/* Between things there is nothing: depths are of the nearest pixel, and so are colours beside bare paper. */
			s->depth_m[to] = i->depth_m[near];
			filter_colour_between(i, from_x, from_y, rgb);
			filter_put(i->spare[to], rgb);
			if (is_border(i, from_x, from_y))
				memcpy(i->spare[to], i->rgba[near], 4);
			if (i->normal)
				memcpy(s->normal[to], i->normal[near], sizeof *s->normal);
			if (i->leaf)
				s->leaf[to] = i->leaf[near];
			if (i->grey_before)
				s->grey[to] = i->grey_before[near];
		}
}

struct warp_wave warp_wave_of(const struct warp_step *s, float px, double time_s)
{
	float turn = s->angle_deg * (float)(G_PI / 180),
	      way = s->direction_deg * (float)(G_PI / 180),
	      by_length = (float)(2 * G_PI) / (s->wavelength_px * px);
	return (struct warp_wave){ .wave = { cosf(turn) * by_length, -sinf(turn) * by_length },
		.way = { cosf(way), -sinf(way) },
		.amplitude = s->amplitude_px * px,
		.phase = (float)(-2 * G_PI * fmod(time_s / (double)s->period_s, 1)) };
}

void filter_warp(struct filter_job *j, const struct step *s)
{
	struct filter_image *i = &j->image;
	size_t pixels = filter_pixels(i);
	struct swaying sway = { .j = j,
		.image = i,
		.by = warp_wave_of(&s->warp, j->px, j->time_s),
		.depth_m = filter_room_part(j->room, 0, pixels * sizeof(float)),
		.normal = filter_room_part(j->room, 1, pixels * 3 * sizeof(float)),
		.leaf = filter_room_part(j->room, 2, pixels * sizeof(uint16_t)),
		.grey = filter_room_part(j->room, 3, pixels) };
	filter_each_rows(j, sway_rows, &sway, i->height, 16);
	memcpy(i->depth_m, sway.depth_m, pixels * sizeof(float));
	if (i->normal)
		memcpy(i->normal, sway.normal, pixels * sizeof *i->normal);
	if (i->leaf)
		memcpy(i->leaf, sway.leaf, pixels * sizeof *i->leaf);
	if (i->grey_before)
		memcpy(i->grey_before, sway.grey, pixels);
	filter_swap(i);
}

/* ---- shade in corners ---- */

struct shading {
	const struct filter_job *j;
	const struct occlusion_step *step;
	const struct edl_step *edl;
	float *shade, *smooth;
	float way[OCCLUSION_TURNS][OCCLUSION_RING][2];
	float reach[OCCLUSION_RING]; /* 0..1, how far */
	int ring[EDL_AROUND][2];     /* of eye-dome lighting, in pixels */
};

/* Surface before a pixel hides the sky from this part of the radius on: what is plane hides nothing. */
#define BEFORE_LEAST 0.08f

/* Places on a spiral around it that lie before it, by how much of the radius. */
static void shade_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct shading *s = data;
	const struct filter_image *i = &s->j->image;
	const struct camera *c = &s->j->f->camera;
	float focal = (float)c->focal_px, radius_m = s->step->radius_m;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float here = i->depth_m[at], sum = 0;
			s->shade[at] = 1;
			if (here >= FILTER_FAR)
				continue;
			float reach = fminf(radius_m * focal / camera_scale_f(c, here),
				OCCLUSION_REACH_MOST_PX * s->j->px);
			/* Pairs on both sides: what is as far before as the other is behind is a slope. */
			const float(*way)[2] = s->way[(x & 3) | (y & 3) << 2];
			for (int n = 0; n < OCCLUSION_RING; n++) {
				float away = reach * s->reach[n];
				int dx = (int)lrintf(way[n][0] * away),
				    dy = (int)lrintf(way[n][1] * away);
				float both = 0;
				for (int side = -1; side <= 1; side += 2) {
					int px = CLAMP((int)x + side * dx, 0, (int)i->width - 1),
					    py = CLAMP((int)y + side * dy, 0, (int)i->height - 1);
					float there =
						i->depth_m[(size_t)py * i->width + (size_t)px];
					float before =
						there >= FILTER_FAR ? -radius_m : here - there;
					/* What stands farther before it is another thing, with air between. */
					if (before > radius_m)
						before = fmaxf(2 * radius_m - before, 0);
					both += fmaxf(before, -radius_m);
				}
				float part = both / (2 * radius_m) -
					     BEFORE_LEAST * away / fmaxf(reach, 1);
				sum += part > 0 ? fminf(part * 4, 1) : 0;
			}
			s->shade[at] = expf(-1.6f * s->step->strength * sum / OCCLUSION_RING);
		}
}

static void darken_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct shading *s = data;
	const struct filter_image *i = &s->j->image;
	for (size_t at = (size_t)from * i->width; at < (size_t)end * i->width; at++) {
		float rgb[3];
		for (int k = 0; k < 3; k++)
			rgb[k] = (float)i->rgba[at][k] *
				 (i->depth_m[at] < FILTER_FAR ? s->smooth[at] : 1);
		filter_put(i->spare[at], rgb);
	}
}

/* A spiral, turned a little for each of sixteen pixels that lie together. */
void occlusion_ways(float ret[OCCLUSION_TURNS][OCCLUSION_RING][2])
{
	for (uint32_t k = 0; k < OCCLUSION_TURNS; k++)
		for (int n = 0; n < OCCLUSION_RING; n++) {
			float angle = (float)G_PI * ((float)n + grain_unit(k & 3, k >> 2, 21)) /
				      OCCLUSION_RING;
			ret[k][n][0] = cosf(angle);
			ret[k][n][1] = sinf(angle);
		}
}

void filter_occlusion(struct filter_job *j, const struct step *step)
{
	size_t bytes = filter_pixels(&j->image) * sizeof(float);
	struct shading s = { .j = j,
		.step = &step->occlusion,
		.shade = filter_room_part(j->room, 0, bytes),
		.smooth = filter_room_part(j->room, 1, bytes) };
	occlusion_ways(s.way);
	for (int n = 0; n < OCCLUSION_RING; n++)
		s.reach[n] = ((float)(n * 5 % OCCLUSION_RING) + 1) / OCCLUSION_RING;
	filter_each_rows(j, shade_rows, &s, j->image.height, 16);
	struct filter_blur b = { s.shade, s.smooth, false, j->image.width, j->image.height, 1, 0,
		NULL };
	filter_blur_run(j, &b, 2);
	filter_each_rows(j, darken_rows, &s, j->image.height, 32);
	filter_swap(&j->image);
}

/* ---- eye-dome lighting (edl.h) ---- */

static void log_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct shading *s = data;
	const struct filter_image *i = &s->j->image;
	float far_m = (float)s->j->f->camera.far_m;
	for (size_t at = (size_t)from * i->width; at < (size_t)end * i->width; at++)
		s->shade[at] = log2f(fminf(i->depth_m[at], far_m));
}

static void dome_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct shading *s = data;
	const struct filter_image *i = &s->j->image;
	float radius = edl_radius(s->edl->radius_px * s->j->px);
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float here = s->shade[at], than[EDL_AROUND];
			float apart = frame_apart_px(s->j->f, i->depth_m[at]) / radius;
			for (int n = 0; n < EDL_AROUND; n++) {
				int at_x = CLAMP((int)x + s->ring[n][0], 0, (int)i->width - 1),
				    at_y = CLAMP((int)y + s->ring[n][1], 0, (int)i->height - 1);
				than[n] = here - s->shade[(size_t)at_y * i->width + (size_t)at_x];
			}
			s->smooth[at] = edl_light(s->edl->strength, edl_deeper(than, apart));
		}
}

void filter_edl(struct filter_job *j, const struct step *step)
{
	struct shading s = { .j = j,
		.edl = &step->edl,
		.smooth = filter_room_part(j->room, 0, filter_pixels(&j->image) * sizeof(float)),
		.shade = filter_room_part(j->room, 1, filter_pixels(&j->image) * sizeof(float)) };
	edl_ring(step->edl.radius_px * j->px, s.ring);
	filter_each_rows(j, log_rows, &s, j->image.height, 64);
	filter_each_rows(j, dome_rows, &s, j->image.height, 16);
	filter_each_rows(j, darken_rows, &s, j->image.height, 32);
	filter_swap(&j->image);
}
