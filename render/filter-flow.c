/* Colours along the flow, and the traces of a brush on them. */
#include "render/filter-solid.h"
#include "render/filter-trace.h"
#include <math.h>
#include <string.h>

void filter_trace_weigh(struct filter_trace *t, float sigma)
{
	float sum = 0;
	t->steps = MIN((int)ceilf(2 * sigma), FILTER_TRACE_MOST);
	for (int n = 0; n <= t->steps; n++) {
		t->weight[n] = expf(-0.5f * (float)(n * n) / (sigma * sigma));
		sum += n ? 2 * t->weight[n] : t->weight[n];
	}
	for (int n = 0; n <= t->steps; n++)
		t->weight[n] /= sum;
}

void filter_trace_run(const struct filter_trace *t)
{
	filter_each_rows(t->j, LANES_OF(t->j->lanes, filter_trace_rows), t, t->j->image.height, 16);
}

void filter_flow(struct filter_job *j, const struct step *s)
{
	const struct flow_step *k = &s->flow;
	struct filter_image *i = &j->image;
	float across = k->across_px * j->px;
	uint8_t(*before)[4] = i->rgba;
	struct filter_trace t = { .j = j, .by = TRACE_MEAN };
	t.flow = filter_flow_find(j, k->tensor_px);
	t.from_rgba = (const uint8_t(*)[4])i->rgba;
	t.to_rgba = i->spare;
	if (across >= 0.3f) {
		/* Into a third picture, for the first one is what the filter acts on. */
		uint8_t(*between)[4] = filter_room_part(j->room, 3, filter_pixels(i) * 4);
		t.is_across = true;
		t.to_rgba = between;
		filter_trace_weigh(&t, across);
		filter_trace_run(&t);
		t.from_rgba = (const uint8_t(*)[4])between;
		t.to_rgba = i->spare;
		t.is_across = false;
	}
	filter_trace_weigh(&t, fmaxf(k->length_px * j->px / 2, 0.5f));
	filter_trace_run(&t);
	g_assert(i->rgba == before);
	filter_finish(j, k->where);
}

/* ---- oil ---- */

struct oiling {
	const struct filter_job *j;
	const struct oil_step *step;
	const float *height; /* of the paint */
};

/* With the paper's relief. */
static float height_at(const struct oiling *o, uint32_t x, uint32_t y)
{
	const struct filter_image *i = &o->j->image;
	return o->height[(size_t)y * i->width + x] + o->step->canvas * filter_relief(o->j, x, y);
}

#define RELIEF 0.45f
#define TONE   0.6f

/* x^16 */
static float glint(float x)
{
	x *= x;
	x *= x;
	x *= x;
	return x * x;
}

/* Light from the left above, as painters have it. */
static void light_rows(const void *data, uint32_t from, uint32_t end)
{
	static const float light[3] = { -0.45f, -0.55f, 0.70f };
	const struct oiling *o = data;
	const struct oil_step *s = o->step;
	const struct filter_image *i = &o->j->image;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float here = height_at(o, x, y),
			      dx = height_at(o, MIN(x + 1, i->width - 1), y) - here,
			      dy = height_at(o, x, MIN(y + 1, i->height - 1)) - here;
			float n[2] = { -RELIEF * s->relief * dx, -RELIEF * s->relief * dy };
			float by_length = 1 / sqrtf(n[0] * n[0] + n[1] * n[1] + 1);
			float facing = (n[0] * light[0] + n[1] * light[1] + light[2]) * by_length;
			/* Bare paper has no paint on it. */
			if (filter_is_bare(i, at)) {
				memcpy(i->spare[at], i->paper, 4);
				continue;
			}
			float diffuse = 1 + TONE * (facing - light[2]);
			/* Where it mirrors the light to the eye, which looks straight at it. */
			float shine = s->shine * glint(fmaxf(2 * facing * by_length - light[2], 0));
			float tone = diffuse * (1 + s->variation * o->height[at]), rgb[3];
			for (int k = 0; k < 3; k++)
				rgb[k] = (float)i->rgba[at][k] * tone + 255 * shine;
			filter_put(i->spare[at], rgb);
		}
}

void filter_oil(struct filter_job *j, const struct step *s)
{
	float width = fmaxf(s->oil.width_px * j->px, 1.2f);
	struct filter_trace t = { .j = j, .by = TRACE_NOISE };
	float *height = filter_room_part(j->room, 4, filter_pixels(&j->image) * sizeof *height);
	t.flow = filter_flow_find(j, s->oil.tensor_px);
	t.from = filter_noise(j, 3, width, 5, filter_calm_depth(j, 5));
	t.to = height;
	filter_trace_weigh(&t, fmaxf(s->oil.length_px * j->px / 2, 1));
	filter_trace_run(&t);
	struct oiling o = { j, &s->oil, height };
	filter_each_rows(j, light_rows, &o, j->image.height, 16);
	filter_swap(&j->image);
}
