#include "render/gles-ink.h"
#include "render/gles-program.h"

/* As much ink as a layer of strokes leaves in a large picture, in pieces: so many pixels a side, so often. */
#define SIDE  1024
#define TIMES 16
/* The first time warms up. */
#define TRIES 3
/* So many times faster it must be. */
#define CLEARLY 2

static const char all[] =
	"#version 310 es\n"
	"void main() {\n"
	"	gl_Position = vec4(float(gl_VertexID & 1) * 4.0 - 1.0, float(gl_VertexID >> 1) * "
	"4.0 - 1.0, 0.0, 1.0);\n"
	"}\n";
static const char blend[] = "#version 310 es\n"
			    "precision highp float;\n"
			    "layout(location = 0) out vec4 ink;\n"
			    "void main() { ink = vec4(0.9 + 0.0001 * fract(gl_FragCoord.x)); }\n";
static const char add[] = "#version 310 es\n"
			  "layout(local_size_x = 256) in;\n"
			  "layout(std430, binding = 0) buffer Ink { uint ink[]; };\n"
			  "void main() { atomicAdd(ink[gl_GlobalInvocationID.x], 3u); }\n";

struct trial {
	const gles_context *c;
	GLuint blend, add, words, picture, frame, vertices;
};

static void make_room(struct trial *t)
{
	const struct gles_functions *gl = &t->c->gl;
	gl->GenTextures(1, &t->picture);
	gl->BindTexture(GL_TEXTURE_2D, t->picture);
	gl->TexStorage2D(GL_TEXTURE_2D, 1,
		t->c->about.has_float_blend         ? GL_R32F
		: t->c->about.has_half_float_colour ? GL_R16F
						    : GL_RGBA8,
		SIDE, SIDE);
	gl->GenFramebuffers(1, &t->frame);
	gl->BindFramebuffer(GL_FRAMEBUFFER, t->frame);
	gl->FramebufferTexture2D(
		GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, t->picture, 0);
	gl->GenBuffers(1, &t->words);
	gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, t->words);
	gl->BufferData(GL_SHADER_STORAGE_BUFFER, SIDE * SIDE * 4, NULL, GL_DYNAMIC_COPY);
	gl->GenVertexArrays(1, &t->vertices);
	gl->BindVertexArray(t->vertices);
	gl->Viewport(0, 0, SIDE, SIDE);
}

static void clean(struct trial *t)
{
	const struct gles_functions *gl = &t->c->gl;
	gl->Disable(GL_BLEND);
	gl->UseProgram(0);
	gl->BindVertexArray(0);
	gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
	gl->DeleteProgram(t->blend);
	gl->DeleteProgram(t->add);
	gl->DeleteBuffers(1, &t->words);
	gl->DeleteFramebuffers(1, &t->frame);
	gl->DeleteTextures(1, &t->picture);
	gl->DeleteVertexArrays(1, &t->vertices);
}

static void blend_once(const struct gles_functions *gl)
{
	gl->DrawArrays(GL_TRIANGLES, 0, 3);
}

static void add_once(const struct gles_functions *gl)
{
	gl->DispatchCompute(SIDE * SIDE / 256, 1, 1);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

/* Microseconds, the least of the tries. */
static int64_t time_of(
	const struct trial *t, GLuint program, void once(const struct gles_functions *gl))
{
	const struct gles_functions *gl = &t->c->gl;
	int64_t least_us = INT64_MAX;
	gl->UseProgram(program);
	for (int n = 0; n < TRIES; n++) {
		gl->Finish();
		int64_t began_us = g_get_monotonic_time();
		for (int k = 0; k < TIMES; k++)
			once(gl);
		gl->Finish();
		least_us = MIN(least_us, g_get_monotonic_time() - began_us);
	}
	return least_us;
}

static bool run(struct trial *t, bool *ret_sums, GError **error)
{
	const struct gles_functions *gl = &t->c->gl;
	t->blend = gles_program_new(t->c,
		&(struct gles_program_desc){
			.name = "trial of ink", .vertex = all, .fragment = blend },
		error);
	t->add = t->blend ? gles_program_new(t->c,
				    &(struct gles_program_desc){
					    .name = "trial of ink", .compute = add },
				    error)
			  : 0;
	if (!t->add)
		return false;
	make_room(t);
	gl->Enable(GL_BLEND);
	gl->BlendFunc(GL_ZERO, GL_SRC_COLOR);
	int64_t blend_us = time_of(t, t->blend, blend_once), add_us = time_of(t, t->add, add_once);
	*ret_sums = blend_us > CLEARLY * add_us;
	g_debug("ink: %d times %d pixels are blended in %.2f ms, added in %.2f: strokes are %s",
		TIMES, SIDE * SIDE, 1e-3 * (double)blend_us, 1e-3 * (double)add_us,
		*ret_sums ? "added" : "blended");
	return gles_context_check(t->c, "trying out ink", error);
}

bool gles_ink_trial(const gles_context *c, bool *ret_sums, GError **error)
{
	struct trial t = { .c = c };
	const char *wish = g_getenv("PLEINAIR_INK");
	*ret_sums = g_strcmp0(wish, "added") == 0;
	if (c->about.is_software || *ret_sums || g_strcmp0(wish, "blended") == 0)
		return true;
	bool good = run(&t, ret_sums, error);
	clean(&t);
	return good;
}
