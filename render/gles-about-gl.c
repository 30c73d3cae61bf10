#include "render/gles-about-gl.h"
#include <string.h>

static int32_t integer(const struct gles_functions *gl, GLenum name)
{
	GLint value = 0;
	gl->GetIntegerv(name, &value);
	return value;
}

static void text(const struct gles_functions *gl, GLenum name, char *ret, size_t size)
{
	const char *is = (const char *)gl->GetString(name);
	g_strlcpy(ret, is ? is : "unknown", size);
}

/* The upper end of a range. */
static float upper(const struct gles_functions *gl, GLenum name)
{
	GLfloat range[2] = { 0 };
	gl->GetFloatv(name, range);
	return range[1];
}

static int32_t least_of_two(const struct gles_functions *gl, GLenum name)
{
	GLint sides[2] = { 0 };
	gl->GetIntegerv(name, sides);
	return MIN(sides[0], sides[1]);
}

static void ask_compute(const struct gles_functions *gl, struct gles_limits *l)
{
	l->group_invocations = integer(gl, GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS);
	l->shared_bytes = integer(gl, GL_MAX_COMPUTE_SHARED_MEMORY_SIZE);
	for (GLuint i = 0; i < 3; i++) {
		gl->GetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_SIZE, i, &l->group_size[i]);
		gl->GetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, i, &l->groups[i]);
	}
}

static void ask_buffers(const struct gles_functions *gl, struct gles_limits *l)
{
	GLint64 bytes = 0;
	gl->GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
	l->storage_block_bytes = bytes;
	l->storage_blocks = integer(gl, GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS);
	l->vertex_storage_blocks = integer(gl, GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS);
	l->fragment_storage_blocks = integer(gl, GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS);
	l->storage_alignment = integer(gl, GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT);
	l->uniform_block_bytes = integer(gl, GL_MAX_UNIFORM_BLOCK_SIZE);
	l->uniform_alignment = integer(gl, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT);
}

static void ask_pictures(const struct gles_functions *gl, struct gles_limits *l)
{
	l->texture_size = integer(gl, GL_MAX_TEXTURE_SIZE);
	l->renderbuffer_size = integer(gl, GL_MAX_RENDERBUFFER_SIZE);
	l->viewport_size = least_of_two(gl, GL_MAX_VIEWPORT_DIMS);
	l->samples = integer(gl, GL_MAX_SAMPLES);
	l->colour_outputs =
		MIN(integer(gl, GL_MAX_DRAW_BUFFERS), integer(gl, GL_MAX_COLOR_ATTACHMENTS));
	l->texture_units = integer(gl, GL_MAX_TEXTURE_IMAGE_UNITS);
	l->vertex_attributes = integer(gl, GL_MAX_VERTEX_ATTRIBS);
	l->point_size = upper(gl, GL_ALIASED_POINT_SIZE_RANGE);
	l->line_width = upper(gl, GL_ALIASED_LINE_WIDTH_RANGE);
}

static void ask_extensions(const struct gles_functions *gl, struct gles_about *a)
{
	bool is_32 = a->major > 3 || a->minor >= 2;
	a->has_float_blend = gles_has_extension(gl, "GL_EXT_float_blend");
	a->has_float_colour = is_32 || gles_has_extension(gl, "GL_EXT_color_buffer_float");
	a->has_half_float_colour =
		a->has_float_colour || gles_has_extension(gl, "GL_EXT_color_buffer_half_float");
	a->has_float_linear = gles_has_extension(gl, "GL_OES_texture_float_linear");
	a->has_image_atomic = is_32 || gles_has_extension(gl, "GL_OES_shader_image_atomic");
	a->has_timer = gles_has_extension(gl, "GL_EXT_disjoint_timer_query");
	a->has_buffer_storage = gles_has_extension(gl, "GL_EXT_buffer_storage");
	a->has_program_binary = integer(gl, GL_NUM_PROGRAM_BINARY_FORMATS) > 0;
	a->has_reset_status = gl->GetGraphicsResetStatusKHR || gl->GetGraphicsResetStatusEXT;
}

bool gles_about_fill(struct gles_about *a, const struct gles_functions *gl, GError **error)
{
	text(gl, GL_VENDOR, a->vendor, sizeof a->vendor);
	text(gl, GL_RENDERER, a->renderer, sizeof a->renderer);
	text(gl, GL_VERSION, a->version, sizeof a->version);
	a->major = integer(gl, GL_MAJOR_VERSION);
	a->minor = integer(gl, GL_MINOR_VERSION);
	if (!g_str_has_prefix(a->version, "OpenGL ES") || a->major < 3 ||
		(a->major == 3 && a->minor < 1)) {
		g_set_error(error, GLES_ERROR, GLES_ERROR_NONE,
			"its driver has \"%s\", which is not OpenGL ES 3.1", a->version);
		return false;
	}
	a->is_software = gles_renderer_is_software(a->renderer);
	ask_pictures(gl, &a->limits);
	ask_buffers(gl, &a->limits);
	ask_compute(gl, &a->limits);
	ask_extensions(gl, a);
	/* A limit that it does not know stays 0. A context lost at once never runs out of errors. */
	for (int i = 0; i < 64 && gl->GetError() != GL_NO_ERROR; i++)
		;
	return true;
}
