#include "render/filter-tables.h"
#include "render/grain.h"
#include <math.h>
#include <string.h>

/* ---- solid or not ---- */

/* Parts of the surroundings that something is in. A straight border has half of them, a corner a quarter. */
#define SOLID_NOT 0.10f
#define SOLID_ALL 0.24f
/* It is asked for blocks of so many pixels a side. */
#define BLOCK FILTER_SOLID_BLOCK

struct counting {
	const struct filter_image *image;
	struct filter_solid solid;
};

static void count_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct counting *c = data;
	const struct filter_image *i = c->image;
	for (uint32_t y = from; y < end; y++) {
		float *to = c->solid.part + (size_t)y * c->solid.width;
		memset(to, 0, c->solid.width * sizeof *to);
		uint32_t below = MIN((y + 1) * BLOCK, i->height);
		for (uint32_t at_y = y * BLOCK; at_y < below; at_y++) {
			const float *row = i->depth_m + (size_t)at_y * i->width;
			uint32_t x = 0;
			for (; x + BLOCK <= i->width; x += BLOCK) {
				int count = 0;
				for (uint32_t k = 0; k < BLOCK; k++)
					count += row[x + k] < FILTER_FAR;
				to[x / BLOCK] += (float)count;
			}
			for (; x < i->width; x++)
				to[x / BLOCK] += row[x] < FILTER_FAR;
		}
		for (uint32_t x = 0; x < c->solid.width; x++)
			to[x] /= (float)((MIN((x + 1) * BLOCK, i->width) - x * BLOCK) *
					 (below - y * BLOCK));
	}
}

struct filter_solid filter_solidity(struct filter_job *j, uint32_t part)
{
	struct counting c = { &j->image, { (j->image.width + BLOCK - 1) / BLOCK,
						 (j->image.height + BLOCK - 1) / BLOCK, NULL } };
	size_t blocks = (size_t)c.solid.width * c.solid.height;
	/* Counts stand behind what they become. */
	float *whole = filter_room_part(j->room, part, 2 * blocks * sizeof(float));
	c.solid.part = whole + blocks;
	filter_each_rows(j, count_rows, &c, c.solid.height, 16);
	struct filter_blur b = { c.solid.part, whole, false, c.solid.width, c.solid.height, 1, 0,
		NULL };
	filter_blur_run(j, &b, filter_solid_sigma(j->px));
	c.solid.part = whole;
	for (size_t n = 0; n < blocks; n++)
		whole[n] = grain_step(SOLID_NOT, SOLID_ALL, whole[n]);
	return c.solid;
}

void filter_solid_row(const struct filter_solid *s, uint32_t y, float *to, uint32_t pixels)
{
	float at = CLAMP(((float)y + 0.5f) / BLOCK - 0.5f, 0, (float)(s->height - 1));
	uint32_t top = (uint32_t)at;
	float v = at - (float)top;
	const float *a = s->part + (size_t)top * s->width,
		    *b = s->part + (size_t)MIN(top + 1, s->height - 1) * s->width;
	for (uint32_t x = 0; x < s->width; x++) {
		/* Of the blocks on either side and its own. */
		uint32_t of[3] = { x ? x - 1 : 0, x, MIN(x + 1, s->width - 1) };
		float block[3];
		for (int k = 0; k < 3; k++)
			block[k] = a[of[k]] + v * (b[of[k]] - a[of[k]]);
		for (uint32_t k = 0; k < BLOCK && x * BLOCK + k < pixels; k++) {
			float away = ((float)k + 0.5f) / BLOCK - 0.5f,
			      to_other = block[away < 0 ? 0 : 2] - block[1];
			to[x * BLOCK + k] = block[1] + fabsf(away) * to_other;
		}
	}
}

/* ---- calm depths ---- */

struct calming {
	const float *from; /* 1/depth; 0 where nothing is */
	float *to;
	uint32_t width, height;
	bool is_down;
};

/* Of a row, by what is at a distance before and behind. */
static void add_pair(const float *own, const float *before, const float *behind, float *sum,
	float *count, uint32_t pixels)
{
	for (uint32_t x = 0; x < pixels; x++) {
		float most = FILTER_CALM_SAME * own[x], a = before[x] - own[x],
		      b = behind[x] - own[x];
		bool same = a < most && -a < most && b < most && -b < most;
		sum[x] += same ? before[x] + behind[x] : 0;
		count[x] += same ? 2 : 0;
	}
}

static void calm_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct calming *c = data;
	g_autofree float *sum = g_new(float, 2 * (size_t)c->width);
	float *count = sum + c->width;
	for (uint32_t y = from; y < end; y++) {
		const float *own = c->from + (size_t)y * c->width;
		for (uint32_t x = 0; x < c->width; x++) {
			sum[x] = own[x];
			count[x] = 1;
		}
		for (uint32_t k = 1; k <= FILTER_CALM_REACH; k++) {
			size_t away = c->is_down ? (size_t)k * c->width : k;
			if (!c->is_down && c->width > 2 * k)
				add_pair(own + k, own, own + 2 * away, sum + k, count + k,
					c->width - 2 * k);
			if (c->is_down && y >= k && y + k < c->height)
				add_pair(own, own - away, own + away, sum, count, c->width);
		}
		float *to = c->to + (size_t)y * c->width;
		for (uint32_t x = 0; x < c->width; x++)
			to[x] = sum[x] / count[x];
	}
}

struct turning {
	const float *from;
	float *to;
	size_t width;
	float nothing, instead; /* where nothing is: before, and then */
};

static void turn_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct turning *t = data;
	for (size_t at = from * t->width; at < end * t->width; at++)
		t->to[at] = t->from[at] == t->nothing ? t->instead : 1 / t->from[at];
}

const float *filter_calm_depth(struct filter_job *j, uint32_t part)
{
	const struct filter_image *i = &j->image;
	size_t bytes = filter_pixels(i) * sizeof(float);
	float *one = filter_room_part(j->room, part, bytes),
	      *other = filter_room_part(j->room, part + 1, bytes);
	struct turning t = { i->depth_m, one, i->width, FILTER_FAR, 0 };
	struct calming c = { one, other, i->width, i->height, false };
	filter_each_rows(j, turn_rows, &t, i->height, 64);
	filter_each_rows(j, calm_rows, &c, i->height, 32);
	c = (struct calming){ other, one, i->width, i->height, true };
	filter_each_rows(j, calm_rows, &c, i->height, 32);
	t = (struct turning){ one, other, i->width, 0, FILTER_FAR };
	filter_each_rows(j, turn_rows, &t, i->height, 64);
	return other;
}

/* ---- noise ---- */

void filter_noise_look(struct filter_noise_job *n, const frame *f)
{
	for (int k = 0; k < 3; k++)
		for (int o = 0; o < FILTER_NOISE_OCTAVES; o++) {
			double at = ldexp(f->eye_m[k], -(o + FILTER_NOISE_LOWEST)),
			       whole = floor(at);
			n->cell[k][o] = (int32_t)(uint32_t)(int64_t)whole;
			n->within[k][o] = (float)(at - whole);
		}
}

const float *filter_noise(
	struct filter_job *j, uint32_t part, float grain_px, uint32_t seed, const float *calm_m)
{
	struct filter_noise_job n = { .j = j,
		.grain_px = fmaxf(grain_px, 1),
		.seed = seed,
		.depth_m = calm_m,
		.to = filter_room_part(j->room, part, filter_pixels(&j->image) * sizeof(float)) };
	filter_noise_look(&n, j->f);
	filter_each_rows(j, LANES_OF(j->lanes, filter_noise_rows), &n, j->image.height, 16);
	return n.to;
}

/* ---- waves ---- */

/* Directions of neighbours are far from each other, and none is along an axis of the site. */
#define WAVES_TURN   2.4
#define WAVES_CLIMB  1.7
#define WAVES_BEHIND 0.37

void filter_waves_look(struct filter_waves_job *w, const frame *f)
{
	for (int n = 0; n < FILTER_WAVES; n++) {
		int octave = n + FILTER_WAVES_LOWEST;
		double turn = WAVES_TURN * octave, climb = WAVES_CLIMB * octave,
		       way[3] = { cos(turn) * cos(climb), sin(turn) * cos(climb), sin(climb) },
		       behind = WAVES_BEHIND * octave;
		for (int k = 0; k < 3; k++) {
			w->way[n][k] = (float)way[k];
			behind += ldexp(way[k] * f->eye_m[k], -octave);
		}
		w->length_m[n] = ldexpf(1, octave);
		w->at_eye[n] = (float)(behind - floor(behind));
	}
}

const float *filter_waves(
	struct filter_job *j, uint32_t part, float shortest_px, const float *calm_m)
{
	struct filter_waves_job w = { .j = j,
		.shortest_px = shortest_px,
		.depth_m = calm_m,
		.to = filter_room_part(j->room, part, filter_pixels(&j->image) * sizeof(float)) };
	filter_waves_look(&w, j->f);
	filter_each_rows(j, LANES_OF(j->lanes, filter_waves_rows), &w, j->image.height, 16);
	return w.to;
}
