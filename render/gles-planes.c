#include "render/gles-planes.h"
#include "render/gles-draw-private.h"
#include "render/splat.h"
#include <string.h>

/* plane_view of planes.glsl. */
struct gles_plane {
	float normal[4], u[4], v[4], rule[4];
	uint32_t of[4];
	float light[4];
	uint32_t texture[SCENE_PLANE_LEVELS][4];
};
_Static_assert(SCENE_PLANE_LEVELS == 14, "as planes.glsl has it");
_Static_assert(sizeof(struct plane_span) == 16, "as planes.glsl has it");

static void describe(const frame *f, const struct plane_view *v, struct gles_plane *ret)
{
	const struct mask_step *step = &frame_pipeline(f, v->pipeline)->mask;
	*ret = (struct gles_plane){ .normal = { v->normal[0], v->normal[1], v->normal[2],
					    v->along },
		.rule = { v->back_m, step->offset_m, step->offset_relative,
			v->plane->region->texel_m },
		.of = { v->pipeline, v->leaf, v->plane->levels,
			splat_step(f, v->pipeline) != NULL },
		.light = { v->lit } };
	memcpy(ret->u, v->u, sizeof ret->u);
	memcpy(ret->v, v->v, sizeof ret->v);
	for (uint32_t k = 0; k < v->plane->levels; k++) {
		const struct scene_plane_level *l = &v->plane->level[k];
		memcpy(ret->texture[k], &(uint32_t[4]){ l->first, l->width, l->height, 0 },
			sizeof ret->texture[k]);
	}
}

static bool hold_texels(
	const gles_context *c, struct gles_planes *p, const scene *s, GError **error)
{
	if (p->serial == s->serial)
		return true;
	if (!gles_buffer_put(c, &p->texels, s->planes->texel, (int64_t)s->planes->texels * 4,
		    "textures of planes", error))
		return false;
	p->serial = s->serial;
	return true;
}

bool gles_planes_fill(const gles_context *c, struct gles_planes *p, const frame *f,
	const struct chunk_view *views, uint32_t count, GError **error)
{
	g_autoptr(plane_views) v = plane_views_new(f, views, count);
	p->spans = 0;
	if (!v || !v->spans)
		return true;
	g_autofree struct gles_plane *plane = g_new(struct gles_plane, v->count);
	for (uint32_t n = 0; n < v->count; n++)
		describe(f, &v->view[n], &plane[n]);
	if (!hold_texels(c, p, f->scene, error) ||
		!gles_buffer_put(c, &p->planes, plane, (int64_t)(v->count * sizeof *plane),
			"planes", error) ||
		!gles_buffer_put(c, &p->span, v->span, (int64_t)v->spans * (int64_t)sizeof *v->span,
			"rows of planes", error))
		return false;
	p->spans = v->spans;
	return true;
}

void gles_planes_draw(const gles_context *c, const struct gles_planes *p)
{
	c->gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, p->span.name);
	c->gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, p->planes.name);
	for (uint32_t n = 0; n < p->spans; n += GLES_GROUPS_MAX) {
		c->gl.Uniform1ui(0, n);
		c->gl.DispatchCompute(MIN(p->spans - n, GLES_GROUPS_MAX), 1, 1);
	}
}

void gles_planes_clear(const gles_context *c, struct gles_planes *p)
{
	gles_buffer_clear(c, &p->texels);
	gles_buffer_clear(c, &p->planes);
	gles_buffer_clear(c, &p->span);
	p->serial = 0;
	p->spans = 0;
}
