#include "render/gles-scene.h"
#include "render/scene-bend.h"
#include <string.h>

enum { POINT_BYTES = 16, LOOK_BYTES = 8, LIST_BYTES = 4, BEND_BYTES = 2 };
/* Points that are copied at once. */
#define PIECE (1u << 18)

/* ---- slabs ---- */

static uint32_t points_most(const gles_context *c)
{
	int64_t bytes = MIN(c->about.limits.storage_block_bytes, GLES_BLOCK_BYTES);
	return (uint32_t)(bytes / POINT_BYTES);
}

static bool fits(const struct gles_slab *slab, const struct scene_chunk *chunk, uint32_t most)
{
	return chunk->first + chunk->count - slab->first <= most;
}

static void split(gles_scene *g, const scene *s, uint32_t most)
{
	GArray *slabs = g_array_new(FALSE, TRUE, sizeof(struct gles_slab));
	struct gles_slab *last = NULL;
	for (uint32_t n = 0; n < s->chunks; n++) {
		const struct scene_chunk *chunk = &s->chunk[n];
		if (!last || !fits(last, chunk, most)) {
			struct gles_slab next = { .first_chunk = n, .first = chunk->first };
			g_array_append_val(slabs, next);
			last = &g_array_index(slabs, struct gles_slab, slabs->len - 1);
		}
		last->chunks++;
		last->count = chunk->first + chunk->count - last->first;
	}
	g->slabs = slabs->len;
	g->slab = (struct gles_slab *)(void *)g_array_free(slabs, FALSE);
}

uint32_t gles_scene_slab(const gles_scene *g, uint32_t chunk)
{
	uint32_t n = g->slabs - 1;
	while (n > 0 && g->slab[n].first_chunk > chunk)
		n--;
	return n;
}

/* ---- one slab ---- */

static uint32_t pair(uint32_t low, uint32_t high)
{
	return low | high << 16;
}

static void take_points(const scene *s, uint32_t from, uint32_t count, void *to)
{
	uint32_t(*out)[4] = to;
#pragma omp parallel for schedule(static)
	for (uint32_t n = 0; n < count; n++) {
		uint32_t at = from + n;
		out[n][0] = pair(s->q[0][at], s->q[1][at]);
		out[n][1] = pair(s->q[2][at], s->spacing[at]);
		out[n][2] = pair(s->disc[at], pair(s->degree[at], 0) | (uint32_t)s->kind[at] << 8);
		memcpy(&out[n][3], s->normal[at], 4);
	}
}

static void take_looks(const scene *s, uint32_t from, uint32_t count, void *to)
{
	uint32_t(*out)[2] = to;
#pragma omp parallel for schedule(static)
	for (uint32_t n = 0; n < count; n++) {
		memcpy(&out[n][0], s->rgba[from + n], 4);
		memcpy(&out[n][1], s->direction[from + n], 4);
	}
}

static void take_lists(const scene *s, uint32_t from, uint32_t count, void *to)
{
	uint32_t *out = to;
#pragma omp parallel for schedule(static)
	for (uint32_t n = 0; n < count; n++)
		out[n] = pair(s->list[from + n], s->list_spacing[from + n]);
}

static void take_bends(const scene *s, uint32_t from, uint32_t count, void *to)
{
	memcpy(to, scene_bend(s)[from], (size_t)count * BEND_BYTES);
}

static GLuint upload(const struct gles_functions *gl, const scene *s, const struct gles_slab *slab,
	uint32_t bytes, void (*take)(const scene *, uint32_t, uint32_t, void *), void *piece)
{
	GLuint name;
	gl->GenBuffers(1, &name);
	gl->BindBuffer(GL_SHADER_STORAGE_BUFFER, name);
	/* Whole words. */
	gl->BufferData(GL_SHADER_STORAGE_BUFFER, ((GLsizeiptr)slab->count * bytes + 3) / 4 * 4,
		NULL, GL_STATIC_DRAW);
	for (uint32_t at = 0; at < slab->count; at += PIECE) {
		uint32_t count = MIN(PIECE, slab->count - at);
		take(s, slab->first + at, count, piece);
		gl->BufferSubData(GL_SHADER_STORAGE_BUFFER, (GLintptr)at * bytes,
			(GLsizeiptr)count * bytes, piece);
	}
	return name;
}

/* ---- all ---- */

void gles_scene_clear(const gles_context *c, gles_scene *g)
{
	for (uint32_t n = 0; n < g->slabs; n++) {
		GLuint names[] = { g->slab[n].points, g->slab[n].looks, g->slab[n].lists,
			g->slab[n].bends };
		c->gl.DeleteBuffers(G_N_ELEMENTS(names), names);
	}
	g_free(g->slab);
	memset(g, 0, sizeof *g);
}

bool gles_scene_hold(const gles_context *c, gles_scene *g, const scene *s, GError **error)
{
	if (g->serial == s->serial)
		return true;
	gles_scene_clear(c, g);
	split(g, s, points_most(c));
	g_autofree void *piece = g_malloc((size_t)PIECE * POINT_BYTES);
	for (uint32_t n = 0; n < g->slabs; n++) {
		struct gles_slab *slab = &g->slab[n];
		slab->points = upload(&c->gl, s, slab, POINT_BYTES, take_points, piece);
		slab->looks = upload(&c->gl, s, slab, LOOK_BYTES, take_looks, piece);
		slab->lists = upload(&c->gl, s, slab, LIST_BYTES, take_lists, piece);
		if (!gles_context_check(c, "copying the points to the GPU", error))
			return false;
	}
	g->serial = s->serial;
	return true;
}

bool gles_scene_hold_bends(const gles_context *c, gles_scene *g, const scene *s, GError **error)
{
	if (!g->slabs || g->slab[0].bends)
		return true;
	g_autofree void *piece = g_malloc((size_t)PIECE * BEND_BYTES);
	for (uint32_t n = 0; n < g->slabs; n++)
		g->slab[n].bends = upload(&c->gl, s, &g->slab[n], BEND_BYTES, take_bends, piece);
	return gles_context_check(c, "copying curvatures to the GPU", error);
}
