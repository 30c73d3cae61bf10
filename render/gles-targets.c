#include "render/gles-targets.h"
#include <string.h>

static GLuint plane(const struct gles_functions *gl, GLenum format, const gles_targets *t)
{
	GLuint name;
	gl->GenTextures(1, &name);
	gl->BindTexture(GL_TEXTURE_2D, name);
	gl->TexStorage2D(GL_TEXTURE_2D, 1, format, (GLsizei)t->width, (GLsizei)t->height);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return name;
}

/* second 0: it has one plane. */
static bool make(const gles_context *c, const gles_targets *t, GLenum first, GLenum second,
	struct gles_target *ret, GError **error)
{
	static const GLenum both[] = { GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1 };
	const struct gles_functions *gl = &c->gl;
	GLenum format[] = { first, second };
	gl->GenFramebuffers(1, &ret->frame);
	gl->BindFramebuffer(GL_FRAMEBUFFER, ret->frame);
	for (int n = 0; n < 2 && format[n]; n++) {
		ret->plane[n] = plane(gl, format[n], t);
		gl->FramebufferTexture2D(GL_FRAMEBUFFER, both[n], GL_TEXTURE_2D, ret->plane[n], 0);
	}
	gl->DrawBuffers(second ? 2 : 1, both);
	if (!gles_context_check(c, "making room for the picture", error))
		return false;
	if (gl->CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
		return true;
	g_set_error(error, GLES_ERROR, GLES_ERROR_DRIVER,
		"the GPU cannot draw into a picture of %u x %u pixels", t->width, t->height);
	return false;
}

static void clear(const gles_context *c, struct gles_target *t)
{
	c->gl.DeleteFramebuffers(1, &t->frame);
	c->gl.DeleteTextures(2, t->plane);
	memset(t, 0, sizeof *t);
}

void gles_targets_clear(const gles_context *c, gles_targets *t)
{
	c->gl.DeleteTextures(1, &t->keys);
	clear(c, &t->canvas);
	clear(c, &t->picture);
	for (size_t n = 0; n < G_N_ELEMENTS(t->ink); n++)
		clear(c, &t->ink[n]);
	memset(t, 0, sizeof *t);
}

static bool check_size(const gles_context *c, uint32_t width, uint32_t height, GError **error)
{
	const struct gles_limits *l = &c->about.limits;
	uint32_t most = (uint32_t)MIN(l->texture_size, l->viewport_size);
	if (width <= most && height <= most)
		return true;
	g_set_error(error, GLES_ERROR, GLES_ERROR_LIMIT,
		"a picture of %u x %u pixels is larger than the GPU draws, %u a side", width,
		height, most);
	return false;
}

bool gles_targets_hold(const gles_context *c, gles_targets *t, uint32_t width, uint32_t height,
	bool is_filtered, GError **error)
{
	if (t->width == width && t->height == height && t->is_filtered == is_filtered)
		return true;
	gles_targets_clear(c, t);
	if (!check_size(c, width, height, error))
		return false;
	*t = (gles_targets){ .width = width, .height = height, .is_filtered = is_filtered };
	GLenum light = is_filtered && c->about.has_float_blend ? GL_RGBA32F
		       : c->about.has_half_float_colour        ? GL_RGBA16F
							       : GL_SRGB8_ALPHA8;
	t->keys = plane(&c->gl, GL_R32UI, t);
	if (make(c, t, light, 0, &t->canvas, error) && make(c, t, GL_RGBA8, 0, &t->picture, error))
		return true;
	gles_targets_clear(c, t);
	return false;
}

bool gles_targets_hold_ink(
	const gles_context *c, gles_targets *t, enum band_blend blend, GError **error)
{
	bool has_half = c->about.has_half_float_colour, has_float = c->about.has_float_blend;
	/* Dense strokes wear half floats out: each one rounds what those before have left. */
	GLenum single = has_float ? GL_R32F : has_half ? GL_R16F : GL_SRGB8_ALPHA8;
	GLenum first[] = { [BAND_INKED] = single,
		[BAND_STRONGEST] = single,
		[BAND_COVERING] = single,
		[BAND_COLOURED] = has_float  ? GL_RGBA32F
				  : has_half ? GL_RGBA16F
					     : GL_SRGB8_ALPHA8,
		[BAND_PAINTED] = has_float ? GL_RGBA32F : GL_RGBA16F,
		[BAND_LAID] = has_float ? GL_RGBA32F : GL_RGBA16F };
	GLenum sums[] = { [BAND_PAINTED] = has_float ? GL_R32F : GL_R16F,
		[BAND_LAID] = has_float ? GL_RG32F : GL_RG16F };
	GLenum second = sums[blend];
	if (t->ink[blend].frame)
		return true;
	if (blend >= BAND_PAINTED && !has_half && !has_float) {
		g_set_error(error, GLES_ERROR, GLES_ERROR_LIMIT,
			"the GPU cannot mix paint, for it does not draw into half floats");
		return false;
	}
	if (make(c, t, first[blend], second, &t->ink[blend], error))
		return true;
	clear(c, &t->ink[blend]);
	return false;
}
