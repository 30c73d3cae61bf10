#include "render/gles-trial.h"
#include "render/gles-program.h"
#include <stdlib.h>

enum { SIDE = 16, PIXELS = SIDE * SIDE, CHANNELS = 4 };

static const char fill[] =
	"#version 310 es\n"
	"layout(local_size_x = 64) in;\n"
	"struct entry { vec4 corner, colour; };\n"
	"layout(std430, binding = 0) writeonly buffer Entries { entry entries[]; };\n"
	"void main() {\n"
	"	uint i = gl_GlobalInvocationID.x, x = i % 16u, y = i / 16u;\n"
	"	vec3 c = vec3(uvec3(x * 16u + 3u, y * 16u + 5u, (x ^ y) * 16u + 7u)) / 255.0;\n"
	"	entries[i] = entry(vec4(vec2(x, y) / 8.0 - 1.0, 0.0, 1.0), vec4(c, 1.0));\n"
	"}\n";
static const char place[] =
	"#version 310 es\n"
	"layout(location = 0) in vec4 corner;\n"
	"layout(location = 1) in vec4 colour;\n"
	"flat out vec4 paint;\n"
	"void main() {\n"
	"	vec2 far = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) / 8.0;\n"
	"	gl_Position = corner + vec4(far, 0.0, 0.0);\n"
	"	paint = colour;\n"
	"}\n";
static const char paint[] = "#version 310 es\n"
			    "precision mediump float;\n"
			    "flat in vec4 paint;\n"
			    "layout(location = 0) out vec4 pixel;\n"
			    "void main() { pixel = paint; }\n";

struct trial {
	GLuint fill, draw, entries, vertices, picture, frame;
};

static void make_picture(const struct gles_functions *gl, struct trial *t)
{
	gl->GenTextures(1, &t->picture);
	gl->BindTexture(GL_TEXTURE_2D, t->picture);
	gl->TexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, SIDE, SIDE);
	gl->GenFramebuffers(1, &t->frame);
	gl->BindFramebuffer(GL_FRAMEBUFFER, t->frame);
	gl->FramebufferTexture2D(
		GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, t->picture, 0);
	gl->Viewport(0, 0, SIDE, SIDE);
	gl->ClearColor(0, 0, 0, 0);
	gl->Clear(GL_COLOR_BUFFER_BIT);
}

static void make_entries(const struct gles_functions *gl, struct trial *t)
{
	gl->GenBuffers(1, &t->entries);
	gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, t->entries);
	gl->BufferData(GL_SHADER_STORAGE_BUFFER, PIXELS * 8 * (GLsizeiptr)sizeof(float), NULL,
		GL_DYNAMIC_COPY);
	gl->UseProgram(t->fill);
	gl->DispatchCompute(PIXELS / 64, 1, 1);
	gl->MemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT);
}

static void draw(const struct gles_functions *gl, struct trial *t)
{
	gl->GenVertexArrays(1, &t->vertices);
	gl->BindVertexArray(t->vertices);
	gl->BindBuffer(GL_ARRAY_BUFFER, t->entries);
	for (GLuint i = 0; i < 2; i++) {
		gl->EnableVertexAttribArray(i);
		gl->VertexAttribPointer(i, 4, GL_FLOAT, GL_FALSE, 8 * sizeof(float),
			GUINT_TO_POINTER(i * 4 * sizeof(float)));
		gl->VertexAttribDivisor(i, 1);
	}
	gl->UseProgram(t->draw);
	gl->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, PIXELS);
}

static void clean(const struct gles_functions *gl, struct trial *t)
{
	gl->UseProgram(0);
	gl->BindVertexArray(0);
	gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
	gl->DeleteProgram(t->fill);
	gl->DeleteProgram(t->draw);
	gl->DeleteVertexArrays(1, &t->vertices);
	gl->DeleteBuffers(1, &t->entries);
	gl->DeleteFramebuffers(1, &t->frame);
	gl->DeleteTextures(1, &t->picture);
}

static bool check(const uint8_t is[PIXELS * CHANNELS], GError **error)
{
	for (int i = 0; i < PIXELS; i++) {
		int x = i % SIDE, y = i / SIDE;
		int wanted[] = { x * 16 + 3, y * 16 + 5, (x ^ y) * 16 + 7, 255 };
		const uint8_t *p = is + i * CHANNELS;
		for (int c = 0; c < CHANNELS; c++)
			if (abs(p[c] - wanted[c]) > 1) {
				g_set_error(error, GLES_ERROR, GLES_ERROR_DRIVER,
					"its driver draws wrong pictures (pixel %d, %d is %d %d %d "
					"%d, not %d %d %d %d)",
					x, y, p[0], p[1], p[2], p[3], wanted[0], wanted[1],
					wanted[2], wanted[3]);
				return false;
			}
	}
	return true;
}

static bool run(const gles_context *c, struct trial *t, GError **error)
{
	const struct gles_functions *gl = &c->gl;
	t->fill = gles_program_new(
		c, &(struct gles_program_desc){ .name = "trial", .compute = fill }, error);
	if (!t->fill)
		return false;
	t->draw = gles_program_new(c,
		&(struct gles_program_desc){ .name = "trial", .vertex = place, .fragment = paint },
		error);
	if (!t->draw)
		return false;
	uint8_t pixels[PIXELS * CHANNELS] = { 0 };
	make_picture(gl, t);
	make_entries(gl, t);
	draw(gl, t);
	gl->ReadPixels(0, 0, SIDE, SIDE, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
	return gles_context_check(c, "drawing a picture", error) && check(pixels, error);
}

bool gles_trial(const gles_context *c, GError **error)
{
	struct trial t = { 0 };
	bool is_right = run(c, &t, error);
	clean(&c->gl, &t);
	return is_right;
}
