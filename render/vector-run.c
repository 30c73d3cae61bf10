#include "render/vector-run.h"
#include <math.h>

/* Links lie over each other by this much at either end (profile-strokes.c). */
#define LAP_PX 0.5f

/* A run is no shorter than this because of its alpha: where something begins to hide a line that falls within a link or two. */
#define LINKS_LEAST 8u

uint32_t vector_run_length(const struct stroke *stroke, uint32_t first, uint32_t count)
{
	uint32_t end = first + 1;
	while (end < count && stroke[end].copy && stroke[end].point == stroke[first].point)
		end++;
	for (uint32_t n = first + LINKS_LEAST; n + LINKS_LEAST <= end; n++)
		if (fabsf(stroke[n].alpha - stroke[first].alpha) > VECTOR_RUN_ALPHA)
			return n - first;
	return end - first;
}

float vector_run_alpha(const struct stroke *run, uint32_t count)
{
	float sum = 0, length = 0;
	for (uint32_t n = 0; n < count; n++) {
		sum += run[n].alpha * run[n].half_length_px;
		length += run[n].half_length_px;
	}
	return length > 0 ? sum / length : 0;
}

/* Where links meet: how broad the pen is there, and which way it goes. */
struct node {
	float at[2], half_width, along[2];
};

static void place_end(const struct stroke *s, float by, float ret[2])
{
	float reach = by * fmaxf(s->half_length_px - LAP_PX, 0);
	ret[0] = s->x_px + reach * s->along[0];
	ret[1] = s->y_px + reach * s->along[1];
}

static struct node node_between(const struct stroke *before, const struct stroke *behind)
{
	const struct stroke *a = before ? before : behind, *b = behind ? behind : before;
	struct node ret = { .half_width = (a->half_width_px + b->half_width_px) / 2,
		.along = { a->along[0] + b->along[0], a->along[1] + b->along[1] } };
	float length = hypotf(ret.along[0], ret.along[1]);
	place_end(before ? before : behind, before ? 1 : -1, ret.at);
	for (int k = 0; k < 2; k++)
		ret.along[k] = length > 0 ? ret.along[k] / length : a->along[k];
	return ret;
}

/* How far the nodes between two are off what these two alone make. */
static float farthest(const struct node *node, uint32_t from, uint32_t to, uint32_t *ret_at)
{
	float way[2] = { node[to].at[0] - node[from].at[0], node[to].at[1] - node[from].at[1] };
	float length = hypotf(way[0], way[1]), most = 0;
	for (uint32_t n = from + 1; n < to; n++) {
		float x = node[n].at[0] - node[from].at[0], y = node[n].at[1] - node[from].at[1];
		float across = length > 0 ? fabsf(x * way[1] - y * way[0]) / length : hypotf(x, y),
		      part = length > 0 ? (x * way[0] + y * way[1]) / (length * length) : 0;
		float width = node[from].half_width +
			      CLAMP(part, 0, 1) * (node[to].half_width - node[from].half_width);
		float off = across + fabsf(node[n].half_width - width);
		if (off > most) {
			most = off;
			*ret_at = n;
		}
	}
	return most;
}

/* Douglas and Peucker 1973, of places and widths together. */
static void keep(const struct node *node, uint32_t from, uint32_t to, float off_px, bool *is_kept)
{
	uint32_t at = from;
	is_kept[from] = is_kept[to] = true;
	if (farthest(node, from, to, &at) <= off_px)
		return;
	keep(node, from, at, off_px, is_kept);
	keep(node, at, to, off_px, is_kept);
}

static void add_side(const struct node *n, float side, GArray *to)
{
	float at[2] = { n->at[0] - side * n->half_width * n->along[1],
		n->at[1] + side * n->half_width * n->along[0] };
	g_array_append_vals(to, at, 1);
}

void vector_run_outline(const struct stroke *run, uint32_t count, float px, GArray *ret)
{
	g_autofree struct node *node = g_new(struct node, count + 1);
	g_autofree bool *is_kept = g_new0(bool, count + 1);
	for (uint32_t n = 0; n <= count; n++)
		node[n] = node_between(n ? &run[n - 1] : NULL, n < count ? &run[n] : NULL);
	keep(node, 0, count, VECTOR_RUN_OFF_PX * px, is_kept);
	g_array_set_size(ret, 0);
	for (uint32_t n = 0; n <= count; n++)
		if (is_kept[n])
			add_side(&node[n], 1, ret);
	for (uint32_t n = count + 1; n-- > 0;)
		if (is_kept[n])
			add_side(&node[n], -1, ret);
}
