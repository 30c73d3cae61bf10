#include "render/view-boxes.h"
#include <math.h>
#include <stdlib.h>

/* Chunks that are enough for views. */
#define CHUNKS_ENOUGH 1024u
/* The first points of a chunk are anywhere in it. */
#define SAMPLE 512u
/* Boxes a side. */
#define SIDE  4
#define CELLS (SIDE * SIDE * SIDE)
/* Of the sample: a box with fewer is what is left at the end of a thing. */
#define SOLID_SAMPLES 4
#define SOLID_CHUNK   (MODEL_CHUNK_POINTS / 8.0)

/* What falls into a cell of a chunk. */
struct cell {
	float low_m[3], high_m[3]; /* from the chunk's centre */
	double facing[3];
	uint32_t samples;
};

static bool is_placed(const struct model_point *p)
{
	return isfinite(p->position_m[0]) && isfinite(p->position_m[1]) &&
	       isfinite(p->position_m[2]);
}

static int cell_of(const struct model_chunk *c, const struct model_point *p)
{
	int cell = 0;
	for (int k = 0; k < 3; k++) {
		float part =
			c->half_size_m[k] > 0 ? (p->position_m[k] / c->half_size_m[k] + 1) / 2 : 0;
		cell = cell * SIDE + (int)fminf(fmaxf(part * SIDE, 0), SIDE - 1);
	}
	return cell;
}

static void add(struct cell *to, const struct model_point *p)
{
	float normal[3], length2 = 0;
	model_unpack_normal(p->normal, normal);
	for (int k = 0; k < 3; k++) {
		to->low_m[k] =
			to->samples ? fminf(to->low_m[k], p->position_m[k]) : p->position_m[k];
		to->high_m[k] =
			to->samples ? fmaxf(to->high_m[k], p->position_m[k]) : p->position_m[k];
		length2 += normal[k] * normal[k];
	}
	for (int k = 0; k < 3 && length2 > 0; k++)
		to->facing[k] += normal[k] / sqrtf(length2);
	to->samples++;
}

static void add_boxes(const struct model_chunk *c, const struct model_point *points, GArray *boxes,
	GArray *facing)
{
	struct cell cells[CELLS] = { 0 };
	uint32_t samples = MIN(c->points, SAMPLE);
	for (uint32_t i = 0; i < samples; i++)
		if (is_placed(&points[i]))
			add(&cells[cell_of(c, &points[i])], &points[i]);
	for (int n = 0; n < CELLS; n++) {
		const struct cell *from = &cells[n];
		struct model_chunk box = { .leaf = c->leaf };
		float mean[3];
		if (!from->samples)
			continue;
		for (int k = 0; k < 3; k++) {
			box.centre_m[k] =
				c->centre_m[k] + ((double)from->low_m[k] + from->high_m[k]) / 2;
			box.half_size_m[k] = (from->high_m[k] - from->low_m[k]) / 2;
			mean[k] = (float)(from->facing[k] / from->samples);
		}
		box.points = (uint32_t)((uint64_t)c->points * from->samples / samples);
		box.points = MAX(box.points, 1);
		g_array_append_val(boxes, box);
		g_array_append_val(facing, mean);
	}
}

/* Smaller boxes instead of the chunks. */
static void divide(view_boxes *b, const model *m)
{
	GArray *boxes = b->own[0] = g_array_new(FALSE, FALSE, sizeof *b->box),
	       *facing = b->own[1] = g_array_new(FALSE, FALSE, sizeof *b->facing);
	for (uint64_t n = 0; n < b->count; n++)
		add_boxes(&b->box[n], model_points(m) + b->box[n].first, boxes, facing);
	b->box = (const struct model_chunk *)(void *)boxes->data;
	b->facing = (const float(*)[3])(void *)facing->data;
	b->count = boxes->len;
	b->solid_points = (double)MODEL_CHUNK_POINTS / SAMPLE * SOLID_SAMPLES;
}

/* ---- walls ---- */

/* Of so many points a normal is looked at, and of those that are as upright as this. */
#define WALL_SAMPLES 200000u
#define UPRIGHT      0.1f
#define DEGREES      90
#define AROUND       3 /* degrees that belong to a peak */

/* What faces headings of one whole degree, a quarter of the circle being all: how much, and its mean part of a degree times that. */
struct degree {
	double points, parts;
};

static void count_walls(const model *m, struct degree ret[DEGREES])
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	uint32_t each = (uint32_t)MAX(WALL_SAMPLES / MAX(chunks, 1), 8);
	for (uint64_t n = 0; n < chunks; n++) {
		uint32_t samples = MIN(each, chunk[n].points);
		for (uint32_t i = 0; i < samples; i++) {
			float v[3];
			model_unpack_normal(model_points(m)[chunk[n].first + i].normal, v);
			float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
			if (!(length > 0) || fabsf(v[2]) > UPRIGHT * length)
				continue;
			double degrees = atan2((double)v[0], (double)v[1]) * 180 / G_PI + 360,
			       points = (double)chunk[n].points / samples;
			struct degree *to = &ret[(int)degrees % DEGREES];
			to->points += points;
			to->parts += points * (degrees - floor(degrees));
		}
	}
}

/* Of the degrees around one, those nearest to it counting most. */
static double peak_at(const struct degree *count, int at)
{
	double sum = 0;
	for (int k = -AROUND; k <= AROUND; k++)
		sum += count[(at + k + DEGREES) % DEGREES].points * (AROUND + 1 - abs(k));
	return sum;
}

/* The mean around the highest peak. */
static double walls_of(const model *m)
{
	struct degree count[DEGREES] = { 0 };
	double sum = 0, points = 0;
	int peak = 0;
	count_walls(m, count);
	for (int n = 1; n < DEGREES; n++)
		if (peak_at(count, n) > peak_at(count, peak))
			peak = n;
	for (int k = -AROUND; k <= AROUND; k++) {
		const struct degree *d = &count[(peak + k + DEGREES) % DEGREES];
		sum += k * d->points + d->parts;
		points += d->points;
	}
	return points > 0 ? (peak + sum / points) * G_PI / 180 : 0;
}

view_boxes *view_boxes_new(const model *m)
{
	g_autoptr(view_boxes) b = g_new0(view_boxes, 1);
	b->box = model_chunks(m, &b->count);
	b->solid_points = SOLID_CHUNK;
	if (b->count <= CHUNKS_ENOUGH)
		divide(b, m);
	b->walls_rad = b->count ? walls_of(m) : 0;
	return b->count ? g_steal_pointer(&b) : NULL;
}

void view_boxes_free(view_boxes *b)
{
	if (!b)
		return;
	for (int n = 0; n < 2; n++)
		if (b->own[n])
			g_array_unref(b->own[n]);
	g_free(b);
}
