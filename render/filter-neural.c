#include "render/filter-planes.h"
#include "render/frame-nets.h"
#include <math.h>

/* Sides that networks halve a few times. */
#define MULTIPLE 8u

struct shrinking {
	const struct filter_image *image;
	uint32_t width, height;
	float *plane; /* three of them, one after the other; 0..255 */
	float amount;
};

/* Means of the pixels of each of its own. */
static void shrink_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct shrinking *s = data;
	const struct filter_image *i = s->image;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < s->width; x++) {
			uint32_t top = (uint32_t)((uint64_t)y * i->height / s->height),
				 left = (uint32_t)((uint64_t)x * i->width / s->width),
				 below = MAX((uint32_t)((uint64_t)(y + 1) * i->height / s->height),
					 top + 1),
				 right = MAX((uint32_t)((uint64_t)(x + 1) * i->width / s->width),
					 left + 1);
			uint32_t sum[3] = { 0 }, count = (below - top) * (right - left);
			for (uint32_t b = top; b < below; b++)
				for (uint32_t a = left; a < right; a++)
					for (int k = 0; k < 3; k++)
						sum[k] += i->rgba[(size_t)b * i->width + a][k];
			for (uint32_t k = 0; k < 3; k++)
				s->plane[((size_t)k * s->height + y) * s->width + x] =
					(float)sum[k] / (float)count;
		}
}

static void enlarge_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct shrinking *s = data;
	const struct filter_image *i = s->image;
	float across = (float)s->width / (float)i->width,
	      down = (float)s->height / (float)i->height;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float rgb[3];
			for (uint32_t k = 0; k < 3; k++) {
				float is = filter_between(
					s->plane + (size_t)k * s->width * s->height, s->width,
					s->height, ((float)x + 0.5f) * across - 0.5f,
					((float)y + 0.5f) * down - 0.5f);
				rgb[k] = (float)i->rgba[at][k] +
					 s->amount * (CLAMP(is, 0, 255) - (float)i->rgba[at][k]);
			}
			filter_put(i->spare[at], rgb);
		}
}

static uint32_t side_of(float px)
{
	return MAX((uint32_t)(px / MULTIPLE + 0.5f), 1) * MULTIPLE;
}

void filter_neural(struct filter_job *j, const struct step *s)
{
	const struct neural_step *k = &s->neural;
	const struct filter_image *i = &j->image;
	semantic_net *net = frame_nets_find(j->f->nets, k->model);
	g_autoptr(GError) error = NULL;
	float scale = fminf(k->side_px / (float)MAX(i->width, i->height), 1);
	struct shrinking in = { i, side_of((float)i->width * scale),
		side_of((float)i->height * scale), NULL, k->amount };
	if (!net)
		return;
	size_t pixels = (size_t)in.width * in.height;
	in.plane = filter_room_part(j->room, 0, 3 * pixels * sizeof(float));
	float *answer = filter_room_part(j->room, 1, 3 * pixels * sizeof(float));
	filter_each_rows(j, shrink_rows, &in, in.height, 16);
	if (!semantic_net_run(net, in.plane, 3, in.width, in.height, 3, answer, k->model, &error)) {
		g_warning("%s", error->message); /* it was tried, with another size */
		return;
	}
	in.plane = answer;
	filter_each_rows(j, enlarge_rows, &in, i->height, 16);
	filter_finish(j, k->where);
}
