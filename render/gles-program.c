#include "render/gles-program.h"
#include "render/gles-program-limits.h"
#include <string.h>

/* ---- one shader ---- */

/* Those that can be said at all; geometry and tessellation shaders cannot. */
static const struct kind {
	GLenum code;
	const char *name;
} kinds[] = { { GL_VERTEX_SHADER, "vertex" }, { GL_FRAGMENT_SHADER, "fragment" },
	{ GL_COMPUTE_SHADER, "compute" } };

static gles_shader_text *text_of(
	const struct gles_program_desc *desc, const struct kind *kind, const char *text)
{
	g_autofree char *name = g_strdup_printf("%s (%s)", desc->name, kind->name);
	return gles_shader_text_new(name, desc->common, text);
}

static char *log_of(const struct gles_functions *gl, GLuint shader)
{
	GLint size = 0;
	gl->GetShaderiv(shader, GL_INFO_LOG_LENGTH, &size);
	char *log = g_malloc0((size_t)MAX(size, 0) + 1);
	gl->GetShaderInfoLog(shader, size + 1, NULL, log);
	return log;
}

static bool compile(const struct gles_functions *gl, GLuint shader, const gles_shader_text *text,
	GError **error)
{
	const char *whole = text->whole;
	gl->ShaderSource(shader, 1, &whole, NULL);
	gl->CompileShader(shader);
	GLint is_compiled = 0;
	gl->GetShaderiv(shader, GL_COMPILE_STATUS, &is_compiled);
	g_autofree char *log = log_of(gl, shader);
	if (is_compiled) {
		if (*log)
			g_debug("%s: %s", text->name, log);
		return true;
	}
	g_autofree char *complaint = gles_shader_text_complaint(text, log);
	g_set_error_literal(error, GLES_ERROR, GLES_ERROR_COMPILE, complaint);
	return false;
}

/* Compiled and attached; the program keeps it alive. */
static bool attach(const struct gles_functions *gl, GLuint program, const struct kind *kind,
	const gles_shader_text *text, GError **error)
{
	if (!gles_shader_text_check(text, error))
		return false;
	GLuint shader = gl->CreateShader(kind->code);
	bool is_compiled = compile(gl, shader, text, error);
	if (is_compiled)
		gl->AttachShader(program, shader);
	gl->DeleteShader(shader);
	return is_compiled;
}

/* ---- a program ---- */

static bool link_program(
	const struct gles_functions *gl, GLuint program, const char *name, GError **error)
{
	gl->LinkProgram(program);
	GLint is_linked = 0, size = 0;
	gl->GetProgramiv(program, GL_LINK_STATUS, &is_linked);
	if (is_linked)
		return true;
	gl->GetProgramiv(program, GL_INFO_LOG_LENGTH, &size);
	g_autofree char *log = g_malloc0((size_t)MAX(size, 0) + 1);
	gl->GetProgramInfoLog(program, size + 1, NULL, log);
	const char *words = g_strstrip(log);
	if (g_str_has_prefix(words, "error: ")) /* Mesa's */
		words += strlen("error: ");
	g_set_error(error, GLES_ERROR, GLES_ERROR_COMPILE,
		"%s: its shaders do not fit together: %.*s", name, (int)strcspn(words, "\n"),
		*words ? words : "no reason given");
	return false;
}

static bool build(const struct gles_functions *gl, GLuint program,
	const struct gles_program_desc *desc, GError **error)
{
	const char *given[G_N_ELEMENTS(kinds)] = { desc->vertex, desc->fragment, desc->compute };
	g_autoptr(gles_shader_text) vertex = NULL, fragment = NULL, compute = NULL;
	gles_shader_text **text[] = { &vertex, &fragment, &compute };
	for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++) {
		if (!given[i])
			continue;
		*text[i] = text_of(desc, &kinds[i], given[i]);
		if (!attach(gl, program, &kinds[i], *text[i], error))
			return false;
	}
	struct gles_program_texts texts = { vertex, fragment, compute };
	return link_program(gl, program, desc->name, error) &&
	       gles_program_check(gl, program, &texts, error);
}

GLuint gles_program_new(const gles_context *c, const struct gles_program_desc *desc, GError **error)
{
	g_assert(desc->compute ? !desc->vertex && !desc->fragment : desc->vertex && desc->fragment);
	GLuint program = c->gl.CreateProgram();
	if (build(&c->gl, program, desc, error))
		return program;
	c->gl.DeleteProgram(program);
	return 0;
}
