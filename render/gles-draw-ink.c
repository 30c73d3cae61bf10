#include "render/gles-ink.h"
#include <stddef.h>

_Static_assert(GLES_STROKES - GLES_SPRITES == KERNEL_TEXTURE, "in the order of kernels");

static void set_attribute(const struct gles_functions *gl, GLuint n, GLint numbers, size_t word)
{
	gl->EnableVertexAttribArray(n);
	gl->VertexAttribPointer(
		n, numbers, GL_FLOAT, GL_FALSE, 4 * GLES_STROKE_WORDS, GSIZE_TO_POINTER(4 * word));
	gl->VertexAttribDivisor(n, 1);
}

/* As choose-write.glsl wrote them. */
static void set_strokes(const struct gles_functions *gl, GLuint strokes)
{
	gl->BindBuffer(GL_ARRAY_BUFFER, strokes);
	set_attribute(gl, 0, 4, 0);
	set_attribute(gl, 1, 4, 4);
	set_attribute(gl, 2, 1, 8);
	gl->EnableVertexAttribArray(3);
	gl->VertexAttribIPointer(
		3, 1, GL_UNSIGNED_INT, 4 * GLES_STROKE_WORDS, GSIZE_TO_POINTER(4 * 9));
	gl->VertexAttribDivisor(3, 1);
}

/* Of what is bare the least stays, whatever was drawn first. */
static bool is_least(enum band_blend blend)
{
	return blend == BAND_STRONGEST || blend == BAND_COVERING;
}

static void draw_strokes(gles_draw *d, const struct frame_layer *l, uint32_t n)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->UseProgram(d->program[GLES_SPRITES + band_kernel_of(l)]);
	if (l->texture || l->paint)
		gles_draw_bind_texture(d, 1, GL_TEXTURE_2D_ARRAY, d->layers.texture[n]);
	gl->Enable(GL_BLEND);
	gl->BlendEquation(is_least(band_blend_of(l)) ? GL_MIN : GL_FUNC_ADD);
	if (band_blend_of(l) >= BAND_PAINTED)
		gl->BlendFuncSeparate(GL_ONE, GL_ONE, GL_ZERO, GL_SRC_ALPHA);
	else
		gl->BlendFunc(GL_ZERO, GL_SRC_COLOR);
	set_strokes(gl, d->strokes[n].name);
	gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, d->commands.name);
	gl->DrawArraysIndirect(GL_TRIANGLE_STRIP, GSIZE_TO_POINTER(sizeof(uint32_t[4]) * n));
	gl->BlendEquation(GL_FUNC_ADD);
}

static void clear(gles_draw *d, enum band_blend blend)
{
	static const GLfloat ones[] = { 1, 1, 1, 1 }, no_paint[] = { 0, 0, 0, 1 }, zero[4] = { 0 };
	const struct gles_functions *gl = &d->c->gl;
	gl->BindFramebuffer(GL_FRAMEBUFFER, d->targets.ink[blend].frame);
	gl->ClearBufferfv(GL_COLOR, 0, blend >= BAND_PAINTED ? no_paint : ones);
	if (blend >= BAND_PAINTED)
		gl->ClearBufferfv(GL_COLOR, 1, zero);
}

void gles_draw_combine(gles_draw *d, enum band_blend blend)
{
	const struct gles_functions *gl = &d->c->gl;
	if (blend >= BAND_PAINTED || blend == BAND_COVERING)
		gl->BlendFunc(GL_ONE, GL_SRC_ALPHA);
	else
		gl->BlendFunc(GL_ZERO, GL_SRC_COLOR);
	gl->DrawArrays(GL_TRIANGLES, 0, 3);
}

static void combine(gles_draw *d, enum band_blend blend)
{
	const struct gles_functions *gl = &d->c->gl;
	const struct gles_target *ink = &d->targets.ink[blend];
	gl->BindFramebuffer(GL_FRAMEBUFFER, d->targets.canvas.frame);
	gl->UseProgram(d->program[GLES_COMBINE]);
	gles_draw_bind_texture(d, 3, GL_TEXTURE_2D, ink->plane[0]);
	gles_draw_bind_texture(d, 4, GL_TEXTURE_2D, ink->plane[1]);
	gles_draw_combine(d, blend);
}

static void draw_layer(gles_draw *d, const struct frame_layer *l, uint32_t n)
{
	enum band_blend blend = band_blend_of(l);
	bool is_direct = gles_layer_is_direct(l);
	if (is_direct)
		d->c->gl.BindFramebuffer(GL_FRAMEBUFFER, d->targets.canvas.frame);
	else
		clear(d, blend);
	draw_strokes(d, l, n);
	if (!is_direct)
		combine(d, blend);
	d->c->gl.Disable(GL_BLEND);
}

bool gles_draw_ink(gles_draw *d, const frame *f, uint64_t layers, GError **error)
{
	for (uint32_t n = 0; n < f->layers; n++) {
		const struct frame_layer *l = &f->layer[n];
		if (!(layers >> n & 1))
			continue;
		gles_layers_bind(d->c, &d->layers, n);
		if (!gles_ink_is_summed(d, l))
			draw_layer(d, l, n);
		else if (!gles_ink_put(d, l, n, error))
			return false;
	}
	return true;
}

void gles_draw_out(gles_draw *d)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->BindFramebuffer(GL_FRAMEBUFFER, d->targets.picture.frame);
	gl->UseProgram(d->program[GLES_OUT]);
	gles_draw_bind_texture(d, 3, GL_TEXTURE_2D, d->targets.canvas.plane[0]);
	gles_draw_bind_texture(d, 5, GL_TEXTURE_2D, d->srgb);
	gl->DrawArrays(GL_TRIANGLES, 0, 3);
}
