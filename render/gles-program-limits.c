#include "render/gles-program-limits.h"
#include "render/gles-program.h"
#include <string.h>

/* ---- what a program has of one kind: storage blocks, uniforms, outputs ---- */

struct resource {
	const struct gles_functions *gl;
	GLuint program;
	GLenum kind;
	GLuint index;
};

static GLint property(const struct resource *r, GLenum name)
{
	GLint value = 0;
	r->gl->GetProgramResourceiv(r->program, r->kind, r->index, 1, &name, 1, NULL, &value);
	return value;
}

/* Its name, without the brackets of an array. */
static void name_of(const struct resource *r, char ret[128])
{
	GLsizei length = 0;
	ret[0] = 0;
	r->gl->GetProgramResourceName(r->program, r->kind, r->index, 128, &length, ret);
	ret[strcspn(ret, "[")] = 0;
}

static GLuint count(const struct gles_functions *gl, GLuint program, GLenum kind)
{
	GLint n = 0;
	gl->GetProgramInterfaceiv(program, kind, GL_ACTIVE_RESOURCES, &n);
	return (GLuint)MAX(n, 0);
}

static bool refuse(const gles_shader_text *text, const char *word, GError **error,
	const char *format, ...) G_GNUC_PRINTF(4, 5);
static bool refuse(
	const gles_shader_text *text, const char *word, GError **error, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *sentence = g_strdup_vprintf(format, arguments),
			*where = gles_shader_text_place_of(text, word);
	va_end(arguments);
	g_set_error(error, GLES_ERROR, GLES_ERROR_LIMIT, "%s: %s", where, sentence);
	return false;
}

/* ---- vertex shaders ---- */

/* All of GL_IMAGE_1D to GL_UNSIGNED_INT_IMAGE_2D_MULTISAMPLE_ARRAY of desktop OpenGL; those of ES are among them. */
static bool is_image(GLint type)
{
	return type >= 0x904C && type <= 0x906C;
}

static bool check_vertex_blocks(const struct gles_functions *gl, GLuint program,
	const gles_shader_text *text, GError **error)
{
	struct resource r = { gl, program, GL_SHADER_STORAGE_BLOCK, 0 };
	for (GLuint n = count(gl, program, r.kind); r.index < n; r.index++) {
		char name[128];
		name_of(&r, name);
		/* Mesa 22.3 says "by none" of arrays without a size whose index varies, and of atomics. */
		if (property(&r, GL_REFERENCED_BY_VERTEX_SHADER) ||
			gles_shader_text_has(text, name))
			return refuse(text, name, error,
				"the storage buffer %s in a vertex shader; small boards have none "
				"there",
				name);
	}
	return true;
}

static bool check_vertex_uniforms(const struct gles_functions *gl, GLuint program,
	const gles_shader_text *text, GError **error)
{
	struct resource r = { gl, program, GL_UNIFORM, 0 };
	for (GLuint n = count(gl, program, r.kind); r.index < n; r.index++) {
		char name[128];
		GLint type = property(&r, GL_TYPE);
		bool is_counter = type == GL_UNSIGNED_INT_ATOMIC_COUNTER;
		if (!(is_image(type) || is_counter) ||
			!property(&r, GL_REFERENCED_BY_VERTEX_SHADER))
			continue;
		name_of(&r, name);
		return refuse(text, name, error,
			"the %s %s in a vertex shader; small boards have none there",
			is_counter ? "atomic counter" : "image", name);
	}
	return true;
}

/* ---- fragment shaders ---- */

static bool check_outputs(const struct gles_functions *gl, GLuint program,
	const gles_shader_text *text, GError **error)
{
	struct resource r = { gl, program, GL_PROGRAM_OUTPUT, 0 };
	for (GLuint n = count(gl, program, r.kind); r.index < n; r.index++) {
		char name[128];
		/* -1: gl_FragDepth. */
		GLint first = property(&r, GL_LOCATION), size = property(&r, GL_ARRAY_SIZE),
		      last = first + MAX(size, 1) - 1;
		if (first < 0 || last < GLES_OUTPUTS_MAX)
			continue;
		name_of(&r, name);
		return refuse(text, name, error,
			"the colour output %s at location %d; small boards have %d, 0 to %d", name,
			last, GLES_OUTPUTS_MAX, GLES_OUTPUTS_MAX - 1);
	}
	return true;
}

/* ---- compute shaders ---- */

static bool check_group(const struct gles_functions *gl, GLuint program,
	const gles_shader_text *text, GError **error)
{
	GLint size[3] = { 1, 1, 1 };
	gl->GetProgramiv(program, GL_COMPUTE_WORK_GROUP_SIZE, size);
	gint64 invocations = (gint64)size[0] * size[1] * size[2];
	return invocations <= GLES_GROUP_MAX ||
	       refuse(text, "local_size_x", error,
		       "a group of %d x %d x %d = %" G_GINT64_FORMAT
		       " invocations; small boards have %d",
		       size[0], size[1], size[2], invocations, GLES_GROUP_MAX);
}

bool gles_program_check(const struct gles_functions *gl, GLuint program,
	const struct gles_program_texts *texts, GError **error)
{
	if (texts->compute)
		return check_group(gl, program, texts->compute, error);
	return check_vertex_blocks(gl, program, texts->vertex, error) &&
	       check_vertex_uniforms(gl, program, texts->vertex, error) &&
	       check_outputs(gl, program, texts->fragment, error);
}
