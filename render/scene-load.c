#include "render/scene-load.h"
#include "firmware-io/crc32c.h"
#include "process/model-coarse.h"
#include "render/scene-bend.h"
#include "render/scene-planes.h"
#include <math.h>
#include <string.h>

struct scene_loader {
	scene_taker *taker;
	struct model_point raw[SCENE_TREE_FAN * MODEL_CHUNK_POINTS];
	struct model_point point[MODEL_CHUNK_POINTS];
	uint32_t id[MODEL_CHUNK_POINTS];
	struct model_turn turn[MODEL_CHUNK_POINTS], of_group[MODEL_CHUNK_POINTS];
	uint64_t read;
};

scene_loader *scene_loader_new(void)
{
	scene_loader *l = g_new(scene_loader, 1);
	l->taker = scene_taker_new();
	return l;
}

void scene_loader_free(scene_loader *l)
{
	if (!l)
		return;
	scene_taker_free(l->taker);
	g_free(l);
}

/* ---- reading ---- */

static bool read_points(scene_loader *l, const struct scene_source *from,
	const struct model_point *at, uint32_t count, struct model_point *to, GError **error)
{
	l->read += count * sizeof *to;
	return product_read(model_file(from->model), from->fd, at, count * sizeof *to, to, error);
}

static bool check(const struct scene_source *from, const char *what, uint64_t number,
	const struct model_chunk *c, const struct model_point *p, GError **error)
{
	if (crc32c(0, p, c->points * sizeof *p) == c->crc32c)
		return true;
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: %s %" G_GUINT64_FORMAT ": its points are damaged",
		product_path(model_file(from->model)), what, number);
	return false;
}

/* From the middle of one box to that of another; a place that is none becomes the middle. */
static void move_point(struct model_point *p, const double from_m[3], const double to_m[3])
{
	for (int k = 0; k < 3; k++) {
		float at = (float)(from_m[k] + (double)p->position_m[k] - to_m[k]);
		p->position_m[k] = isfinite(at) ? at : 0;
	}
}

/* ---- each level ---- */

static bool load_chunk(
	scene_loader *l, const struct scene_source *from, uint32_t number, GError **error)
{
	const struct model_chunk *c = from->chunk + number;
	if (!read_points(
		    l, from, model_points(from->model) + c->first, c->points, l->point, error) ||
		!check(from, "chunk", number, c, l->point, error))
		return false;
	for (uint32_t i = 0; i < c->points; i++)
		l->id[i] = (uint32_t)(c->first + i);
	return true;
}

/* The first points of each chunk, in turn. */
static bool load_run(scene_loader *l, const struct scene_source *from, const struct scene_node *n,
	GError **error)
{
	const struct model_chunk *c = from->chunk + n->child;
	uint32_t gives[SCENE_TREE_FAN];
	for (uint32_t k = 0; k < n->children; k++) {
		gives[k] = model_gives(c[k].points, SCENE_TREE_FAN);
		if (!read_points(l, from, model_points(from->model) + c[k].first, gives[k],
			    l->raw + (size_t)k * MODEL_CHUNK_POINTS, error))
			return false;
	}
	uint32_t count = model_turns(gives, n->children, l->turn);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t k = l->turn[i].member, place = l->turn[i].place;
		l->point[i] = l->raw[(size_t)k * MODEL_CHUNK_POINTS + place];
		l->id[i] = (uint32_t)(c[k].first + place);
		move_point(&l->point[i], c[k].centre_m, n->centre_m);
	}
	return true;
}

/* Which points of the model a group has. */
static void find_turns(
	const struct scene_source *from, const struct model_chunk *g, struct model_turn *ret)
{
	const struct model_chunk *c = from->chunk + g->reserved[0];
	uint32_t gives[MODEL_GROUP_CHUNKS];
	for (uint32_t k = 0; k < g->reserved[1]; k++)
		gives[k] = model_gives(c[k].points, MODEL_COARSE_ONE_IN);
	model_turns(gives, g->reserved[1], ret);
}

static uint32_t id_in_group(
	const struct scene_source *from, const struct model_chunk *g, const struct model_turn *turn)
{
	const struct model_chunk *c = from->chunk + g->reserved[0];
	return (uint32_t)(c[turn->member].first + turn->place);
}

static bool read_group(scene_loader *l, const struct scene_source *from, uint64_t number,
	struct model_point *to, GError **error)
{
	const struct model_chunk *g = &from->group[number];
	return read_points(l, from, model_in_short(from->model).point + g->first, g->points, to,
		       error) &&
	       check(from, "group", number, g, to, error);
}

static bool load_group(scene_loader *l, const struct scene_source *from, uint64_t number,
	const struct scene_node *n, GError **error)
{
	const struct model_chunk *g = &from->group[number];
	if (!read_group(l, from, number, l->point, error))
		return false;
	find_turns(from, g, l->of_group);
	for (uint32_t i = 0; i < g->points; i++) {
		l->id[i] = id_in_group(from, g, &l->of_group[i]);
		move_point(&l->point[i], g->centre_m, n->centre_m);
	}
	return true;
}

static bool load_top(scene_loader *l, const struct scene_source *from, uint64_t first_group,
	const struct scene_node *n, GError **error)
{
	const struct model_chunk *g = &from->group[first_group];
	uint32_t gives[SCENE_TREE_FAN];
	for (uint32_t k = 0; k < n->children; k++) {
		gives[k] = model_gives(g[k].points, SCENE_TREE_FAN);
		if (!read_group(l, from, first_group + k, l->raw + (size_t)k * MODEL_CHUNK_POINTS,
			    error))
			return false;
	}
	uint32_t count = model_turns(gives, n->children, l->turn);
	for (uint32_t k = 0; k < n->children; k++) {
		find_turns(from, &g[k], l->of_group);
		for (uint32_t i = 0; i < count; i++) {
			uint32_t place = l->turn[i].place;
			if (l->turn[i].member != k)
				continue;
			l->point[i] = l->raw[(size_t)k * MODEL_CHUNK_POINTS + place];
			l->id[i] = id_in_group(from, &g[k], &l->of_group[place]);
			move_point(&l->point[i], g[k].centre_m, n->centre_m);
		}
	}
	return true;
}

static bool load_points(
	scene_loader *l, const struct scene_source *from, uint32_t number, GError **error)
{
	const scene_tree *t = from->tree;
	const struct scene_node *n = &t->node[number];
	switch (n->level) {
	case 0: return load_chunk(l, from, n->child, error);
	case 1: return load_run(l, from, n, error);
	case 2: return load_group(l, from, number - t->first[2], n, error);
	default: return load_top(l, from, n->child - t->first[2], n, error);
	}
}

/* ---- all of it ---- */

bool scene_load(scene_loader *l, const struct scene_source *from, uint32_t node, scene *s,
	struct scene_chunk *c, const struct scene_grey *grey, uint64_t *ret_read, GError **error)
{
	const struct scene_node *n = &from->tree->node[node];
	struct model_chunk box = { .points = n->points, .leaf = n->leaf };
	l->read = 0;
	bool good = load_points(l, from, node, error);
	*ret_read = l->read;
	if (!good)
		return false;
	memcpy(box.centre_m, n->centre_m, sizeof box.centre_m);
	memcpy(box.half_size_m, n->half_m, sizeof box.half_size_m);
	scene_place_chunk(s, c, &box);
	c->part = n->part;
	scene_take(l->taker, s, c, l->point, grey);
	memcpy(s->id + c->first, l->id, c->count * sizeof *l->id);
	scene_planes_mark(s, c);
	const uint8_t *of_half = scene_bend_halves();
	for (uint32_t i = 0; i < c->count; i++) {
		s->bend->k[c->first + i][0] = of_half[l->point[i].k1];
		s->bend->k[c->first + i][1] = of_half[l->point[i].k2];
	}
	return true;
}
