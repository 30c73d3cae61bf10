#include "render/gles-layers.h"
#include "render/edl.h"
#include "render/splat.h"
#include <string.h>

/* Layer of layer.glsl. */
struct layer_block {
	float wanted_per_px[256], dithering_per_m2[256];
	float shape[4], look[4], opacity[4], wanted_most[4], ink_linear[4], own_way[4],
		turn[256][2], texels[4];
	uint32_t which[4];
	float hatch_way[4], hatch_tone[4], hatch_light[4], hatch_shape[4], hatch_line[4],
		hatch_own[4], pencils[PENCIL_BOX_MOST][4];
	uint32_t hatch_which[4];
	float contour[4], contour_least[4], cut[4];
	float paint_size[4], paint_look[4], paint_lay[4], paint_thick[4], paint_hole[4],
		paint_part[256];
	uint32_t paint_of[4], colour[4];
};
_Static_assert(PENCIL_BOX_MOST == 48, "as layer.glsl has it");
/* Pipelines of ground.frag.glsl. */
struct pipelines_block {
	float points[256][4], edl[256][4];
};

bool gles_layer_is_direct(const struct frame_layer *l)
{
	enum band_blend blend = band_blend_of(l);
	bool is_black = l->ink_linear[0] == 0 && l->ink_linear[1] == 0 && l->ink_linear[2] == 0;
	return l->ink.tooth <= 0 && (blend == BAND_COLOURED || (blend == BAND_INKED && is_black));
}

/* ---- a layer's numbers ---- */

/* Those whose strokes go along their lines. */
static uint32_t kinds_along(const struct ink_step *ink)
{
	switch (ink->direction) {
	case DIRECTION_LINE: return 1u << FEATURE_UNDIRECTED | 1u << FEATURE_DIRECTED;
	case DIRECTION_EDGE: return 1u << FEATURE_DIRECTED;
	default: return 0;
	}
}

static void describe_hatch(
	const struct frame_hatch *h, const scene *s, bool bent, struct layer_block *ret)
{
	const struct hatching_step *step = &h->step;
	float own = step->line_angle_deg * (float)(G_PI / 180);
	struct layer_block b = {
		.hatch_way = { (float)h->site_way[0], (float)h->site_way[1], (float)h->site_way[2],
			bent ? 2 : 1 },
		.hatch_tone = { step->own_tone, step->ink.tone_levels, s->darkest,
			1 / (s->lightest - s->darkest) },
		.hatch_light = { step->shine, step->shine_exponent, h->near_m, h->per_m },
		.hatch_shape = { step->cross, step->pressure, step->curvature, step->abstraction },
		.hatch_line = { cosf(own), sinf(own), step->mix, step->hue_shift_deg / 60 },
		.hatch_own = { h->exposure },
		.hatch_which = { h->rows, (uint32_t)step->follows, (uint32_t)step->colouring,
			h->pencils.count },
	};
	size_t from = offsetof(struct layer_block, hatch_way);
	memcpy((char *)ret + from, (char *)&b + from, offsetof(struct layer_block, contour) - from);
	memcpy(ret->pencils, h->pencils.pencil, sizeof ret->pencils);
}

static void describe_contours(const struct frame_layer *l, float px, struct layer_block *ret)
{
	const struct contours_step *step = &l->step->contours;
	memcpy(ret->contour, (float[4]){ 1, step->band_px * px, step->outlines, step->suggestive },
		sizeof ret->contour);
	ret->contour_least[0] = step->slant_least;
	ret->contour_least[1] = step->bent_least_per_m;
	ret->contour_least[2] = step->steps;
	ret->contour_least[3] = l->bend != NULL;
}

/* octaves: so much of them. */
static void describe_paint(
	const struct frame_paint *p, float thickness_px, float octaves, struct layer_block *ret)
{
	const struct paint_step *s = &p->step;
	float size[] = { 1, s->fine, s->detail, s->follow },
	      look[] = { s->even, s->contrast, s->warmth, s->hue_variation_deg / 60 },
	      lay[] = { octaves * p->octaves[0], octaves * p->octaves[1], p->behind, p->behind_m },
	      thick[] = { 0.5f * thickness_px, s->shine, s->light_variation,
		      s->lies == LIES_SCREEN };
	memcpy(ret->paint_size, size, sizeof size);
	memcpy(ret->paint_look, look, sizeof look);
	memcpy(ret->paint_lay, lay, sizeof lay);
	memcpy(ret->paint_thick, thick, sizeof thick);
	ret->paint_hole[0] = (float)p->hole_px;
	ret->paint_hole[1] = p->broad;
	ret->paint_hole[2] = p->exposure;
	ret->paint_hole[3] = (float)p->gap_px;
	memcpy(ret->paint_part, p->part, sizeof ret->paint_part);
	ret->hatch_which[3] = p->palette.count;
	memcpy(ret->pencils, p->palette.pencil, sizeof ret->pencils);
	ret->texels[0] = (float)p->level[0].texture->length;
	ret->texels[1] = (float)p->level[0].texture->width;
	ret->texels[2] = (float)p->level[0].texture->variants;
}

/* Of the weights of paint: half floats have room for fewer. */
static float octaves_of(const struct gles_about *about)
{
	return about->has_float_blend
		       ? 1
		       : PAINT_OCTAVES_HALF / (PAINT_OCTAVES_LAY + PAINT_OCTAVES_PAINT);
}

static void describe(const struct frame_layer *l, const struct gles_about *about, const frame *f,
	struct layer_block *ret)
{
	const struct ink_step *ink = &l->ink;
	*ret = (struct layer_block){
		.shape = { ink->length_px, ink->width_px, ink->spacing_px, ink->length_variation },
		.look = { ink->grow, ink->scatter, ink->saturation, ink->tooth },
		.opacity = { ink->opacity, ink->opacity_variation, ink->degree, ink->fade_m },
		.texels = { 1, 1, 1, (float)l->lit },
		.which = { l->kinds | l->together << 8, l->is_queue, kinds_along(ink),
			ink->colour == COLOUR_POINT },
		.colour = { 0, band_blend_of(l), frame_copies(l), l->is_focus },
	};
	memcpy(ret->wanted_per_px, l->wanted_per_px, sizeof ret->wanted_per_px);
	memcpy(ret->dithering_per_m2, l->dithering_per_m2, sizeof ret->dithering_per_m2);
	memcpy(ret->own_way, l->own_way, sizeof l->own_way);
	ret->own_way[2] = l->dithers_alone ? f->scene->dither_per_m2 : 0;
	ret->own_way[3] = ink->reach_m;
	memcpy(ret->turn, l->turn, sizeof ret->turn);
	memcpy(ret->ink_linear, l->ink_linear, sizeof l->ink_linear);
	memcpy(ret->colour, ink->ink, sizeof ink->ink);
	for (int kind = 0; kind < FEATURE_KINDS; kind++)
		ret->wanted_most[kind] = l->wanted_most[kind];
	if (l->hatch)
		describe_hatch(l->hatch, f->scene, l->bend, ret);
	if (l->is_contours)
		describe_contours(l, f->ink_px, ret);
	if (l->is_cut)
		memcpy(ret->cut, (float[4]){ 1, l->step->cut.thick_m }, sizeof ret->cut);
	if (l->paint) {
		describe_paint(
			l->paint, l->paint->step.thickness_px * f->px, octaves_of(about), ret);
		ret->paint_of[0] = l->pipeline;
	}
	if (l->texture) {
		ret->texels[0] = (float)l->texture->length;
		ret->texels[1] = (float)l->texture->width;
		ret->texels[2] = (float)l->texture->variants;
	}
}

static void describe_pipelines(const frame *f, struct pipelines_block *ret, bool *ret_has_points)
{
	*ret_has_points = false;
	memset(ret, 0, sizeof *ret);
	for (guint n = 0; n < f->drawing->pipelines->len; n++) {
		const struct points_step *points = splat_step(f, (uint8_t)n);
		const struct step *edl = frame_step(f, n, "edl");
		if (points)
			memcpy(ret->points[n],
				(float[4]){ points->brightness, points->contrast,
					points->saturation,
					scene_exposure_of(f->scene, points->exposure) },
				sizeof ret->points[n]);
		if (edl) {
			ret->edl[n][0] = edl->edl.strength;
			ret->edl[n][1] = edl_radius(edl->edl.radius_px * f->px);
			ret->edl[n][3] = f->scene->spacing_median_m;
		}
		ret->edl[n][2] = frame_pipeline(f, n)->is_focus;
		*ret_has_points |= points != NULL;
	}
}

static void upload_numbers(const gles_context *c, gles_layers *g, const frame *f)
{
	const struct gles_functions *gl = &c->gl;
	GLintptr unit = MAX(c->about.limits.uniform_alignment, 16);
	g->layer_bytes = ((GLintptr)sizeof(struct layer_block) + unit - 1) / unit * unit;
	size_t bytes = (size_t)g->layer_bytes * f->layers + sizeof(struct pipelines_block);
	g_autofree char *all = g_malloc0(bytes);
	for (uint32_t n = 0; n < f->layers; n++) {
		struct layer_block block;
		describe(&f->layer[n], &c->about, f, &block);
		memcpy(all + (size_t)g->layer_bytes * n, &block, sizeof block);
	}
	g_autofree struct pipelines_block *pipelines = g_new(struct pipelines_block, 1);
	describe_pipelines(f, pipelines, &g->has_points);
	memcpy(all + (size_t)g->layer_bytes * f->layers, pipelines, sizeof *pipelines);
	gl->GenBuffers(1, &g->numbers);
	gl->BindBuffer(GL_UNIFORM_BUFFER, g->numbers);
	gl->BufferData(GL_UNIFORM_BUFFER, (GLsizeiptr)bytes, all, GL_STATIC_DRAW);
}

/* ---- textures ---- */

/* With a border of 0 around each variant. */
static void upload_level(const struct gles_functions *gl, const stroke_texture *t, GLint level)
{
	GLsizei length = (GLsizei)t->length + 2, width = (GLsizei)t->width + 2;
	size_t texels = (size_t)length * (size_t)width * t->variants;
	g_autofree uint8_t *all = g_malloc0(texels);
	for (uint32_t v = 0; v < t->variants; v++)
		for (uint32_t y = 0; y < t->width; y++)
			memcpy(all + ((size_t)v * (t->width + 2) + y + 1) * (t->length + 2) + 1,
				stroke_texture_variant(t, v) + (size_t)y * t->length, t->length);
	gl->TexSubImage3D(GL_TEXTURE_2D_ARRAY, level, 0, 0, 0, length, width, (GLsizei)t->variants,
		GL_RED, GL_UNSIGNED_BYTE, all);
}

/* largest: the first level. */
static GLuint begin_texture(
	const struct gles_functions *gl, const stroke_texture *largest, GLsizei levels)
{
	GLuint name;
	gl->GenTextures(1, &name);
	gl->BindTexture(GL_TEXTURE_2D_ARRAY, name);
	gl->TexStorage3D(GL_TEXTURE_2D_ARRAY, levels, GL_R8, (GLsizei)largest->length + 2,
		(GLsizei)largest->width + 2, (GLsizei)largest->variants);
	gl->TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER,
		levels > 1 ? GL_LINEAR_MIPMAP_NEAREST : GL_LINEAR);
	gl->TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	gl->TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	gl->TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	return name;
}

static GLuint upload_texture(const struct gles_functions *gl, const struct frame_layer *l)
{
	GLuint name = begin_texture(gl, l->paint ? l->paint->level[0].texture : l->texture,
		l->paint ? PAINT_LEVELS : 1);
	for (uint32_t n = 0; l->paint && n < PAINT_LEVELS; n++)
		upload_level(gl, l->paint->level[n].texture, (GLint)n);
	if (!l->paint)
		upload_level(gl, l->texture, 0);
	return name;
}

static GLuint upload_shades(const struct gles_functions *gl, const struct frame_hatch *h,
	GLenum kind, GLenum format, GLenum type, const void *texels)
{
	GLuint name;
	gl->GenTextures(1, &name);
	gl->BindTexture(GL_TEXTURE_2D, name);
	gl->TexStorage2D(GL_TEXTURE_2D, 1, kind, XTOON_COLUMNS, (GLsizei)h->rows);
	gl->TexSubImage2D(
		GL_TEXTURE_2D, 0, 0, 0, XTOON_COLUMNS, (GLsizei)h->rows, format, type, texels);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return name;
}

static void upload_hatch(
	const struct gles_functions *gl, gles_layers *g, uint32_t n, const struct frame_hatch *h)
{
	g->xtoon_colours[n] = upload_shades(gl, h, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, h->rgba);
	g->xtoon_wanted[n] = upload_shades(gl, h, GL_R32F, GL_RED, GL_FLOAT, h->wanted_per_px);
}

/* A texel to a pixel. */
static GLuint upload_relief(const struct gles_functions *gl, const frame *f)
{
	GLuint name;
	GLsizei width = (GLsizei)f->relief_width, height = (GLsizei)f->relief_height;
	gl->GenTextures(1, &name);
	gl->BindTexture(GL_TEXTURE_2D, name);
	gl->TexStorage2D(GL_TEXTURE_2D, 1, GL_R8, width, height);
	gl->TexSubImage2D(
		GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RED, GL_UNSIGNED_BYTE, f->relief);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return name;
}

/* ---- all ---- */

void gles_layers_clear(const gles_context *c, gles_layers *g)
{
	c->gl.DeleteBuffers(1, &g->numbers);
	c->gl.DeleteTextures(FRAME_LAYERS_MAX, g->texture);
	c->gl.DeleteTextures(FRAME_LAYERS_MAX, g->xtoon_colours);
	c->gl.DeleteTextures(FRAME_LAYERS_MAX, g->xtoon_wanted);
	c->gl.DeleteTextures(1, &g->relief);
	memset(g, 0, sizeof *g);
}

/* Of each window another one. */
static bool hold_relief(const gles_context *c, gles_layers *g, const frame *f, GError **error)
{
	if (g->relief_serial == f->relief_serial)
		return true;
	c->gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
	c->gl.DeleteTextures(1, &g->relief);
	g->relief = upload_relief(&c->gl, f);
	g->relief_serial = f->relief_serial;
	return gles_context_check(c, "copying the style to the GPU", error);
}

bool gles_layers_hold(const gles_context *c, gles_layers *g, const frame *f, GError **error)
{
	if (g->serial == f->serial)
		return hold_relief(c, g, f, error);
	gles_layers_clear(c, g);
	c->gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
	upload_numbers(c, g, f);
	for (uint32_t n = 0; n < f->layers; n++) {
		if (f->layer[n].texture || f->layer[n].paint)
			g->texture[n] = upload_texture(&c->gl, &f->layer[n]);
		if (f->layer[n].hatch)
			upload_hatch(&c->gl, g, n, f->layer[n].hatch);
	}
	g->layers = f->layers;
	if (!hold_relief(c, g, f, error))
		return false;
	g->serial = f->serial;
	return true;
}

void gles_layers_bind(const gles_context *c, const gles_layers *g, uint32_t layer)
{
	c->gl.BindBufferRange(GL_UNIFORM_BUFFER, 1, g->numbers, g->layer_bytes * (GLintptr)layer,
		sizeof(struct layer_block));
}

void gles_layers_bind_pipelines(const gles_context *c, const gles_layers *g)
{
	c->gl.BindBufferRange(GL_UNIFORM_BUFFER, 1, g->numbers,
		g->layer_bytes * (GLintptr)g->layers, sizeof(struct pipelines_block));
}
