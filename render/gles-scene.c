#include "render/gles-scene.h"
#include "render/scene-bend.h"
#include "render/scene-list.h"
#include "render/scene-pager.h"
#include "render/scene-paint.h"
#include <string.h>

enum { POINT_BYTES = 16, LOOK_BYTES = 8, LIST_BYTES = 4, BEND_BYTES = 2, PAINT_BYTES = 8 };
/* Points that are copied at once. */
#define PIECE (1u << 18)
/* Points that are not worth more threads. */
#define FEW (1u << 14)

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
			struct gles_slab next = { .first = chunk->first };
			g_array_append_val(slabs, next);
			last = &g_array_index(slabs, struct gles_slab, slabs->len - 1);
		}
		last->count = chunk->first + chunk->count - last->first;
	}
	g->slabs = slabs->len;
	g->slab = (struct gles_slab *)(void *)g_array_free(slabs, FALSE);
}

/* A power of two of points each, which no chunk stands across (scene-pager.h). */
static void split_memory(gles_scene *g, const scene *s, uint32_t most)
{
	uint32_t all = scene_pager_points(s->pager), each = SCENE_PAGER_WITHIN;
	while (2 * each <= most && each < all)
		each *= 2;
	g->slabs = (all + each - 1) / each;
	g->slab = g_new0(struct gles_slab, g->slabs);
	for (uint32_t n = 0; n < g->slabs; n++)
		g->slab[n] = (struct gles_slab){ .first = n * each, .count = each };
	g->held = g_new0(uint32_t, all / SCENE_PAGER_ALIGNED + 1);
}

uint32_t gles_scene_slab(const gles_scene *g, const struct scene_chunk *c)
{
	uint32_t n = g->slabs - 1;
	while (n > 0 && g->slab[n].first > c->first)
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
#pragma omp parallel for schedule(static) if (count > FEW)
	for (uint32_t n = 0; n < count; n++) {
		uint32_t at = from + n;
		memcpy(out[n], &s->place[at], 8);
		out[n][2] = pair(s->disc[at], pair(s->degree[at], 0) | (uint32_t)s->kind[at] << 8);
		memcpy(&out[n][3], s->normal[at], 4);
	}
}

static void take_looks(const scene *s, uint32_t from, uint32_t count, void *to)
{
	uint32_t(*out)[2] = to;
#pragma omp parallel for schedule(static) if (count > FEW)
	for (uint32_t n = 0; n < count; n++) {
		memcpy(&out[n][0], s->rgba[from + n], 4);
		memcpy(&out[n][1], s->direction[from + n], 4);
	}
}

static void take_bends(const scene *s, uint32_t from, uint32_t count, void *to)
{
	memcpy(to, scene_bend(s)[from], (size_t)count * BEND_BYTES);
}

static void take_paint(const scene *s, uint32_t from, uint32_t count, void *to)
{
	const scene_paint *seen = scene_paint_of(s);
	uint8_t(*out)[PAINT_BYTES] = to;
#pragma omp parallel for schedule(static) if (count > FEW)
	for (uint32_t n = 0; n < count; n++) {
		int16_t way[2];
		scene_paint_rgb(seen->look[from + n], out[n]);
		out[n][3] = seen->detail[from + n];
		scene_paint_way(seen->look[from + n], way);
		memcpy(out[n] + 4, way, sizeof way);
	}
}

/* Of a chunk: shaders look at each kind in the order of ranks. */
static void take_list(const scene *s, const struct scene_chunk *c, uint32_t *to)
{
	for (int kind = 0; kind < FEATURE_KINDS; kind++) {
		uint32_t from = kind ? c->kind_end[kind - 1] : 0;
		for (uint32_t n = from; n < c->kind_end[kind]; n++) {
			uint32_t entry = s->list[c->first + n];
			to[from + scene_list_rank(entry)] = entry;
		}
	}
}

typedef void take_part(const scene *s, uint32_t from, uint32_t count, void *to);

static GLuint make_buffer(const struct gles_functions *gl, uint32_t count, uint32_t bytes)
{
	GLuint name;
	gl->GenBuffers(1, &name);
	gl->BindBuffer(GL_SHADER_STORAGE_BUFFER, name);
	/* Whole words. */
	gl->BufferData(GL_SHADER_STORAGE_BUFFER, ((GLsizeiptr)count * bytes + 3) / 4 * 4, NULL,
		GL_STATIC_DRAW);
	return name;
}

/* Between frames, whose pictures are there: nothing reads the buffer meanwhile (gles-buffer.h). Points of the scene, into the buffer of the slab that they are in. */
static void put(const struct gles_functions *gl, const scene *s, const struct gles_slab *slab,
	GLuint name, uint32_t from, uint32_t points, uint32_t bytes, take_part *take, void *piece)
{
	gl->BindBuffer(GL_SHADER_STORAGE_BUFFER, name);
	for (uint32_t at = 0; at < points; at += PIECE) {
		uint32_t count = MIN(PIECE, points - at);
		take(s, from + at, count, piece);
		gl->BufferSubData(GL_SHADER_STORAGE_BUFFER,
			(GLintptr)(from - slab->first + at) * bytes, (GLsizeiptr)count * bytes,
			piece);
	}
}

static void put_list(const struct gles_functions *gl, const scene *s, const struct gles_slab *slab,
	const struct scene_chunk *c, uint32_t *piece)
{
	take_list(s, c, piece);
	gl->BindBuffer(GL_SHADER_STORAGE_BUFFER, slab->lists);
	gl->BufferSubData(GL_SHADER_STORAGE_BUFFER, (GLintptr)(c->first - slab->first) * LIST_BYTES,
		(GLsizeiptr)c->count * LIST_BYTES, piece);
}

static GLuint upload(const struct gles_functions *gl, const scene *s, const struct gles_slab *slab,
	uint32_t bytes, take_part *take, void *piece)
{
	GLuint name = make_buffer(gl, slab->count, bytes);
	put(gl, s, slab, name, slab->first, slab->count, bytes, take, piece);
	return name;
}

/* ---- with a pager ---- */

static void put_paint(const struct gles_functions *gl, const scene *s, struct gles_slab *slab,
	const struct scene_chunk *c, void *piece)
{
	if (!slab->paint)
		slab->paint = make_buffer(gl, slab->count, PAINT_BYTES);
	put(gl, s, slab, slab->paint, c->first, c->count, PAINT_BYTES, take_paint, piece);
}

static void put_chunk(const struct gles_functions *gl, const scene *s, struct gles_slab *slab,
	const struct scene_chunk *c, void *piece)
{
	const struct {
		GLuint *name;
		uint32_t bytes;
		take_part *take;
	} part[] = { { &slab->points, POINT_BYTES, take_points },
		{ &slab->looks, LOOK_BYTES, take_looks },
		{ &slab->bends, BEND_BYTES, take_bends } };
	for (size_t n = 0; n < G_N_ELEMENTS(part); n++) {
		if (!*part[n].name)
			*part[n].name = make_buffer(gl, slab->count, part[n].bytes);
		put(gl, s, slab, *part[n].name, c->first, c->count, part[n].bytes, part[n].take,
			piece);
	}
	if (!slab->lists)
		slab->lists = make_buffer(gl, slab->count, LIST_BYTES);
	put_list(gl, s, slab, c, piece);
}

static bool follow(const gles_context *c, gles_scene *g, const scene *s, GError **error)
{
	g_autofree void *piece = g_malloc((size_t)PIECE * POINT_BYTES);
	for (uint32_t n = 0; n < s->chunks; n++) {
		const struct scene_chunk *chunk = &s->chunk[n];
		uint32_t *held = &g->held[chunk->first / SCENE_PAGER_ALIGNED];
		if (*held == chunk->stamp)
			continue;
		put_chunk(&c->gl, s, &g->slab[gles_scene_slab(g, chunk)], chunk, piece);
		if (g->is_painted)
			put_paint(&c->gl, s, &g->slab[gles_scene_slab(g, chunk)], chunk, piece);
		*held = chunk->stamp;
	}
	g->turn = s->turn;
	return gles_context_check(c, "copying the points to the GPU", error);
}

static bool hold_paged(const gles_context *c, gles_scene *g, const scene *s, GError **error)
{
	if (g->serial != s->serial) {
		gles_scene_clear(c, g);
		split_memory(g, s, points_most(c));
	} else if (g->turn == s->turn)
		return true;
	bool good = follow(c, g, s, error);
	g->serial = good ? s->serial : 0;
	return good;
}

/* ---- all ---- */

void gles_scene_clear(const gles_context *c, gles_scene *g)
{
	for (uint32_t n = 0; n < g->slabs; n++) {
		GLuint names[] = { g->slab[n].points, g->slab[n].looks, g->slab[n].lists,
			g->slab[n].bends, g->slab[n].paint };
		c->gl.DeleteBuffers(G_N_ELEMENTS(names), names);
	}
	g_free(g->slab);
	g_free(g->held);
	memset(g, 0, sizeof *g);
}

static void forget_paint(const gles_context *c, gles_scene *g)
{
	for (uint32_t n = 0; n < g->slabs; n++) {
		c->gl.DeleteBuffers(1, &g->slab[n].paint);
		g->slab[n].paint = 0;
	}
	g->is_painted = false;
}

bool gles_scene_hold(const gles_context *c, gles_scene *g, const scene *s, GError **error)
{
	if (g->is_painted && !scene_paint_is_there(s))
		forget_paint(c, g);
	if (s->pager)
		return hold_paged(c, g, s, error);
	if (g->serial == s->serial)
		return true;
	gles_scene_clear(c, g);
	split(g, s, points_most(c));
	g_autofree void *piece = g_malloc((size_t)PIECE * POINT_BYTES);
	for (uint32_t n = 0; n < g->slabs; n++) {
		struct gles_slab *slab = &g->slab[n];
		slab->points = upload(&c->gl, s, slab, POINT_BYTES, take_points, piece);
		slab->looks = upload(&c->gl, s, slab, LOOK_BYTES, take_looks, piece);
		slab->lists = make_buffer(&c->gl, slab->count, LIST_BYTES);
		if (!gles_context_check(c, "copying the points to the GPU", error))
			return false;
	}
	for (uint32_t n = 0; n < s->chunks; n++)
		put_list(
			&c->gl, s, &g->slab[gles_scene_slab(g, &s->chunk[n])], &s->chunk[n], piece);
	if (!gles_context_check(c, "copying the lists of points to the GPU", error))
		return false;
	g->serial = s->serial;
	return true;
}

bool gles_scene_hold_bends(const gles_context *c, gles_scene *g, const scene *s, GError **error)
{
	if (s->pager || !g->slabs || g->slab[0].bends)
		return true;
	g_autofree void *piece = g_malloc((size_t)PIECE * BEND_BYTES);
	for (uint32_t n = 0; n < g->slabs; n++)
		g->slab[n].bends = upload(&c->gl, s, &g->slab[n], BEND_BYTES, take_bends, piece);
	return gles_context_check(c, "copying curvatures to the GPU", error);
}

bool gles_scene_hold_paint(const gles_context *c, gles_scene *g, const scene *s, GError **error)
{
	if (g->is_painted || !g->slabs)
		return true;
	g_autofree void *piece = g_malloc((size_t)PIECE * PAINT_BYTES);
	for (uint32_t n = 0; n < s->chunks && s->pager; n++)
		put_paint(
			&c->gl, s, &g->slab[gles_scene_slab(g, &s->chunk[n])], &s->chunk[n], piece);
	for (uint32_t n = 0; n < g->slabs && !s->pager; n++)
		g->slab[n].paint = upload(&c->gl, s, &g->slab[n], PAINT_BYTES, take_paint, piece);
	g->is_painted = true;
	return gles_context_check(c, "copying what is painted to the GPU", error);
}
