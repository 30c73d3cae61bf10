#ifndef RENDER_GLES_SHADER_TEXT_H
#define RENDER_GLES_SHADER_TEXT_H
/* The text of a shader: put together, checked for what can only be seen in it, and what compilers say of it made readable. No
 * OpenGL needed; pure functions, any thread.
 *
 * A shader is its own text and, behind its #version and #extension lines, a common text that several shaders share. #line keeps
 * the numbers of both; those of the common text begin at 10,001, since Mesa forgets the number of a source. */
#include "render/gles-about.h"
#include <stddef.h>

typedef struct gles_shader_text gles_shader_text;
struct gles_shader_text {
	char *name;  /* "strokes (vertex)" */
	char *whole; /* what the compiler is given */
	char *plain; /* the same with comments blanked, byte for byte at the same places */
};

/* common: NULL is fine. */
gles_shader_text *gles_shader_text_new(const char *name, const char *common, const char *text);
void gles_shader_text_free(gles_shader_text *t); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(gles_shader_text, gles_shader_text_free)

/* Refuses, with GLES_ERROR_LIMIT and the line: another #version than 310 es; any #extension but GL_OES_shader_image_atomic
 * (geometry and tessellation shaders and 64-bit atomics need one); gl_PointSize set to a number above 512 (sizes that are
 * computed, the board clamps); more than 32 KiB of shared variables, or shared variables whose size cannot be told from the
 * text: they are scalars, vectors and matrices, and arrays of them whose extents are products of numbers and of names that
 * #define or const give a number. */
bool gles_shader_text_check(const gles_shader_text *t, GError **error);

/* "strokes (vertex) line 12", of what stands at a place of whole; "strokes (vertex), common line 3". The caller frees it. */
char *gles_shader_text_place(const gles_shader_text *t, size_t offset);
/* The same of the first place where this word stands; the name alone where it does not. */
char *gles_shader_text_place_of(const gles_shader_text *t, const char *word);

/* Whether it stands anywhere but in a comment. */
bool gles_shader_text_has(const gles_shader_text *t, const char *word);

/* The first error of a compiler's log: "strokes (vertex) line 12: 'x' undeclared". Knows the ways of Mesa, NVIDIA, ANGLE, ARM;
 * where it does not understand, the first line of the log. The caller frees it. */
char *gles_shader_text_complaint(const gles_shader_text *t, const char *log);

#endif
