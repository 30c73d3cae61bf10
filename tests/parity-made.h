#ifndef TESTS_PARITY_MADE_H
#define TESTS_PARITY_MADE_H
/* A small scene to draw, made of points of chance with a seed: ground, a wall with edges, a tree, a lamp; some points without normals,
 * directions, colours. Each thing is a segment's class. */
#include "process/segments.h"
#include "render/scene-bend.h"
#include "render/scene-list.h"
#include <math.h>

#define CHUNK 4096u

enum { GROUND, WALL, TREE, LAMP, THINGS };
static const struct made_thing {
	int class;
	uint32_t points;
	float centre_m[3], half_m[3];
	uint8_t rgb[3];
	float spacing_m;
} things[THINGS] = {
	[GROUND] = { CLASS_TERRAIN, 4 * CHUNK, { 0, 0, 0 }, { 6, 6, 0.02f }, { 140, 130, 110 },
		0.1f },
	[WALL] = { CLASS_BUILDING, 3 * CHUNK + 77, { 0, 4, 1.5f }, { 4, 0.01f, 1.5f },
		{ 190, 170, 150 }, 0.045f },
	[TREE] = { CLASS_VEGETATION, 2 * CHUNK, { -2, 0, 1.5f }, { 1, 1, 1 }, { 60, 110, 40 },
		0.06f },
	[LAMP] = { CLASS_STRUCTURE, 500, { 1.5f, -1, 1 }, { 0.05f, 0.05f, 1 }, { 40, 40, 50 },
		0.02f },
};

static uint16_t place(GRand *r)
{
	return (uint16_t)g_rand_int_range(r, 0, 65536);
}

static uint8_t kind_of(GRand *r, int thing, const uint16_t q[3])
{
	static const uint8_t kinds[] = { FEATURE_NONE, FEATURE_NONE, FEATURE_DITHER,
		FEATURE_UNDIRECTED };
	if (thing == WALL && (q[2] > 60000 || q[0] < 3000 || q[0] % 16000 < 900))
		return FEATURE_DIRECTED;
	return kinds[g_rand_int_range(r, 0, thing == TREE || thing == LAMP ? 4 : 3)];
}

static void turn_point(scene *s, uint32_t at, int thing, const uint16_t q[3])
{
	float up[3] = { 0, 0, 1 }, wall[3] = { 0, -1, 0 }, along[3] = { 1, 0, 0 }, leaf[3];
	float length = 1e-3f;
	for (int k = 0; k < 3; k++) {
		leaf[k] = (float)q[k] / 32768 - 1;
		length += leaf[k] * leaf[k];
	}
	for (int k = 0; k < 3; k++)
		leaf[k] /= sqrtf(length);
	const float *const normals[] = { up, wall, leaf, leaf };
	s->normal[at][0] = s->normal[at][1] = MODEL_NORMAL_NONE;
	s->direction[at][0] = s->direction[at][1] = MODEL_NORMAL_NONE;
	if (thing != TREE || at % 3 == 0)
		model_pack_normal(normals[thing], s->normal[at]);
	if (s->kind[at] == FEATURE_DIRECTED && at % 50)
		model_pack_normal(q[2] > 60000 ? along : up, s->direction[at]);
}

static void make_point(scene *s, GRand *r, uint32_t at, int thing)
{
	const struct made_thing *t = &things[thing];
	uint16_t q[3] = { place(r), place(r), place(r) };
	for (int k = 0; k < 3; k++)
		s->place[at].q[k] = q[k];
	s->kind[at] = kind_of(r, thing, q);
	turn_point(s, at, thing, q);
	s->place[at].spacing = (uint16_t)(t->spacing_m * 1e4f);
	s->disc[at] = (uint16_t)(s->place[at].spacing * (at % 7 == 0 ? 2 : 1));
	s->degree[at] = (uint8_t)g_rand_int_range(r, 0, 256);
	for (int k = 0; k < 3; k++)
		s->rgba[at][k] = (uint8_t)(t->rgb[k] * (q[(k + 1) % 3] / 8192 % 2 ? 1 : 0.6));
	s->rgba[at][3] = at % 40 ? 255 : 0;
}

static void make_chunk(scene *s, GRand *r, int thing, uint32_t count)
{
	const struct made_thing *t = &things[thing];
	struct scene_chunk *c = &s->chunk[s->chunks++];
	*c = (struct scene_chunk){ .part = 1,
		.first = s->count,
		.count = count,
		.leaf = segment_of_class(t->class),
		.list_ends = c->list_ends,
		.spacing_least_m = t->spacing_m,
		.spacing_most_m = t->spacing_m,
		.disc_most_m = 2 * t->spacing_m };
	for (int k = 0; k < 3; k++) {
		c->centre_m[k] = t->centre_m[k];
		c->half_m[k] = t->half_m[k];
		c->step_m[k] = 2 * t->half_m[k] / 65535;
	}
	for (uint32_t i = 0; i < count; i++)
		make_point(s, r, s->count + i, thing);
	g_autoptr(scene_lister) l = scene_lister_new();
	scene_list_chunk(l, s, c);
	s->count += count;
}

/* Bent in all ways, and not at all; principal directions are those of lines. */
static void bend_points(scene *s, GRand *r)
{
	s->bend = g_new0(struct scene_bend_plane, 1);
	s->bend->k = g_malloc(((size_t)s->count + 16) * sizeof *s->bend->k);
	for (uint32_t n = 0; n < s->count; n++) {
		float k1 = (float)g_rand_double_range(r, -6, 6);
		s->bend->k[n][0] = scene_bend_pack(k1);
		s->bend->k[n][1] = scene_bend_pack(k1 * (float)g_rand_double_range(r, -1, 1));
		float way[3] = { (float)g_rand_double(r), (float)g_rand_double(r), 0.3f };
		if (s->kind[n] < FEATURE_UNDIRECTED && n % 5)
			model_pack_normal(way, s->direction[n]);
	}
	s->bend->made = 1;
}

/* ---- lines ---- */

static void add_vertex(profile_lines *p, double x, double y, double z)
{
	static const float out[3] = { 0, -1, 0 }, up[3] = { 0, 0, 1 };
	struct profile_vertex v = { .at_m = { (float)x, (float)y, (float)z } };
	model_pack_normal(out, v.face[0]);
	model_pack_normal(up, v.face[1]);
	g_array_append_val(p->vertex, v);
}

static void end_line(profile_lines *p, uint32_t first, int kind, int thing, bool is_closed)
{
	struct profile_line l = { first, p->vertex->len - first, .confidence = 0.9f,
		.leaf = (uint16_t)segment_of_class(things[thing].class), .kind = (uint8_t)kind,
		.closed = is_closed };
	for (uint32_t n = first + 1; n < p->vertex->len; n++) {
		const float *a = g_array_index(p->vertex, struct profile_vertex, n - 1).at_m,
			    *b = g_array_index(p->vertex, struct profile_vertex, n).at_m;
		l.length_m += hypotf(hypotf(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
	}
	g_array_append_val(p->line, l);
}

/* Around the wall, on it, behind it; a round one on the ground; the lamp. Some pass the eye of the nearer camera. */
static profile_lines *make_lines(void)
{
	profile_lines *p = profile_lines_new();
	static const double wall[5][2] = { { -4, 0 }, { -4, 3 }, { 4, 3 }, { 4, 0 }, { -4, 0 } };
	uint32_t first = 0;
	p->origin_m[0] = 1000;
	for (int n = 0; n < 5; n++)
		add_vertex(p, wall[n][0], 4, wall[n][1]);
	end_line(p, first, PROFILE_END, WALL, true);
	for (int n = 0; n < 12; n++) {
		first = p->vertex->len;
		add_vertex(p, -4, n % 2 ? 4.6 : 3.98, 0.2 + 0.06 * n * n / 3);
		add_vertex(p, 4, n % 2 ? 4.6 : 3.98, 0.2 + 0.06 * n * n / 3);
		end_line(p, first, n % 3, WALL, false);
	}
	first = p->vertex->len;
	for (int n = 0; n <= 40; n++)
		add_vertex(p, 3 * cos(n * G_PI / 20), 3 * sin(n * G_PI / 20), 0);
	end_line(p, first, PROFILE_CREASE, GROUND, true);
	first = p->vertex->len;
	add_vertex(p, 1.5, -1, 0);
	add_vertex(p, 1.5, -1, 2);
	end_line(p, first, PROFILE_THIN, LAMP, false);
	return p;
}

static inline scene *make_scene(void)
{
	scene *s = scene_alloc(16 * CHUNK, 16);
	GRand *r = g_rand_new_with_seed(7);
	s->count = s->chunks = 0; /* they grow */
	s->origin_m[0] = 1000;
	s->dither_per_m2 = 400;
	s->darkest = 0.1f;
	s->lightest = 0.5f; /* so that there is something to expose for longer */
	s->tone_exponent = 2;
	for (int thing = 0; thing < THINGS; thing++)
		for (uint32_t done = 0; done < things[thing].points; done += CHUNK)
			make_chunk(s, r, thing, MIN(CHUNK, things[thing].points - done));
	bend_points(s, r);
	g_rand_free(r);
	g_autoptr(profile_lines) lines = make_lines();
	scene_set_lines(s, lines);
	return s;
}

#endif
