/* Shaders that every driver here would take, and small boards would not: each is refused with a sentence. And those just within
 * the limits, which are not. */
#include "render/gles-probe.h"
#include "render/gles-program.h"
#include <string.h>

/* NULL: the test is skipped. */
static gles_context *open_here(void)
{
	static struct gles_about found;
	static char *why;
	static bool is_found;
	g_autoptr(GError) error = NULL;
	if (!why) {
		is_found = gles_context_probe(NULL, &found, &error);
		why = g_strdup(error ? error->message : "");
	}
	g_clear_error(&error);
	if (!is_found) {
		g_test_skip(why);
		return NULL;
	}
	gles_context *c = gles_context_open(&found, &error);
	g_assert_no_error(error);
	return c;
}

#define ES     "#version 310 es\n"
#define HIGH   "precision highp float;\nprecision highp int;\n"
#define VERTEX ES "void main() {\n\tgl_Position = vec4(0.0);\n}\n"
#define FRAGMENT                                                                                   \
	ES HIGH "layout(location = 0) out vec4 pixel;\nvoid main() { pixel = vec4(1.0); }\n"

static const struct sample {
	const char *name, *common, *vertex, *fragment, *compute;
	const char *says; /* NULL: it is taken */
	int code;
} samples[] = {
	{ "storage-in-vertex",
		.vertex = ES "layout(std430, binding = 0) readonly buffer Points {\n"
			     "\tvec4 at[];\n"
			     "};\n"
			     "void main() { gl_Position = at[gl_VertexID]; }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 2: the storage buffer Points in a vertex shader; "
			"small boards have none there",
		.code = GLES_ERROR_LIMIT },
	{ "storage-array-in-vertex",
		.vertex = ES "layout(std430, binding = 0) readonly buffer Points {\n"
			     "\tvec4 at[];\n"
			     "} points[2];\n"
			     "void main() { gl_Position = points[1].at[0]; }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 2: the storage buffer Points in a vertex shader; "
			"small boards have none there",
		.code = GLES_ERROR_LIMIT },
	/* Of this one, Mesa 22.3 says that no shader uses it. */
	{ "storage-counted-in-vertex",
		.vertex = ES "layout(std430, binding = 0) buffer Counts { uint drawn; };\n"
			     "void main() { gl_Position = vec4(float(atomicAdd(drawn, 1u))); }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 2: the storage buffer Counts in a vertex shader; "
			"small boards have none there",
		.code = GLES_ERROR_LIMIT },
	{ "storage-in-common",
		.common = "precision highp float;\n"
			  "layout(std430, binding = 0) buffer Points { vec4 at[]; };",
		.vertex = VERTEX,
		.fragment = ES "layout(location = 0) out vec4 pixel;\n"
			       "void main() { pixel = at[int(gl_FragCoord.x)]; }\n",
		.says = "sample (vertex), common line 2: the storage buffer Points in a vertex "
			"shader; small boards have none there",
		.code = GLES_ERROR_LIMIT },
	{ "storage-unused-in-vertex",
		.vertex = ES "layout(std430, binding = 0) readonly buffer Points { vec4 at[]; };\n"
			     "void main() { gl_Position = vec4(0.0); }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 2: the storage buffer Points in a vertex shader; "
			"small boards have none there",
		.code = GLES_ERROR_LIMIT },
	{ "image-unused-in-vertex",
		.vertex = ES "precision highp image2D;\n"
			     "layout(rgba8, binding = 0) readonly uniform image2D marks;\n"
			     "void main() { gl_Position = vec4(0.0); }\n",
		.fragment = FRAGMENT },
	{ "storage-in-fragment", .vertex = VERTEX,
		.fragment = ES HIGH
		"layout(std430, binding = 0) readonly buffer Points { vec4 at[]; };\n"
		"layout(location = 0) out vec4 pixel;\n"
		"void main() { pixel = at[0]; }\n" },
	{ "image-in-vertex",
		.vertex = ES "precision highp image2D;\n"
			     "layout(rgba8, binding = 0) readonly uniform image2D marks;\n"
			     "void main() { gl_Position = imageLoad(marks, ivec2(0)); }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 3: the image marks in a vertex shader; small boards "
			"have none there",
		.code = GLES_ERROR_LIMIT },
	{ "counter-in-vertex",
		.vertex = ES "layout(binding = 0) uniform atomic_uint drawn;\n"
			     "void main() { gl_Position = vec4(float(atomicCounter(drawn))); }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 2: the atomic counter drawn in a vertex shader; "
			"small "
			"boards have none there",
		.code = GLES_ERROR_LIMIT },
	{ "group-of-512",
		.compute = ES "layout(std430, binding = 0) buffer Sums { uint sum[]; };\n"
			      "\n"
			      "layout(local_size_x = 32, local_size_y = 16) in;\n"
			      "void main() { sum[gl_LocalInvocationIndex] = 1u; }\n",
		.says = "sample (compute) line 4: a group of 32 x 16 x 1 = 512 invocations; small "
			"boards have 256",
		.code = GLES_ERROR_LIMIT },
	{ "group-of-256", .compute = ES "layout(std430, binding = 0) buffer Sums { uint sum[]; };\n"
					"layout(local_size_x = 16, local_size_y = 16) in;\n"
					"void main() { sum[gl_LocalInvocationIndex] = 1u; }\n" },
	{ "shared-too-large",
		.compute = ES "layout(local_size_x = 64) in;\n"
			      "layout(std430, binding = 0) buffer Sums { float sum[]; };\n"
			      "shared uint few[4];\n"
			      "#define SIDE 64\n"
			      "shared vec4 tile[SIDE * 33];\n"
			      "void main() { tile[0] = vec4(1.0); few[0] = 1u; barrier();\n"
			      "sum[0] = tile[1].x + float(few[1]); }\n",
		.says = "sample (compute) line 6: shared variables of 33808 bytes; small boards "
			"have 32768",
		.code = GLES_ERROR_LIMIT },
	{ "shared-just-fits",
		.compute =
			ES "layout(local_size_x = 64) in;\n"
			   "layout(std430, binding = 0) buffer Sums { float sum[]; };\n"
			   "const uint side = 64u;\n"
			   "shared float tile[side][128];\n"
			   "void main() { tile[0][0] = 1.0; barrier(); sum[0] = tile[1][2]; }\n" },
	{ "shared-unclear",
		.compute = ES "layout(local_size_x = 64) in;\n"
			      "layout(std430, binding = 0) buffer Sums { float sum[]; };\n"
			      "struct cell { float a; vec3 b; };\n"
			      "shared cell tile[64];\n"
			      "void main() { tile[0].a = 1.0; barrier(); sum[0] = tile[1].a; }\n",
		.says = "sample (compute) line 5: how large the shared cell tile[64] is cannot be "
			"told from the text; write numbers (small boards have 32 KiB)",
		.code = GLES_ERROR_LIMIT },
	{ "five-outputs", .vertex = VERTEX,
		.fragment = ES HIGH "layout(location = 0) out vec4 first;\n"
				    "layout(location = 4) out uint fifth;\n"
				    "void main() { first = vec4(1.0); fifth = 2u; }\n",
		.says = "sample (fragment) line 5: the colour output fifth at location 4; small "
			"boards have 4, 0 to 3",
		.code = GLES_ERROR_LIMIT },
	{ "array-of-outputs", .vertex = VERTEX,
		.fragment =
			ES HIGH "layout(location = 0) out vec4 all[6];\n"
				"void main() { for (int i = 0; i < 6; i++) all[i] = vec4(1.0); }\n",
		.says = "sample (fragment) line 4: the colour output all at location 5; small "
			"boards "
			"have 4, 0 to 3",
		.code = GLES_ERROR_LIMIT },
	{ "four-outputs-and-depth", .vertex = VERTEX,
		.fragment =
			ES HIGH "layout(location = 0) out vec4 all[4];\n"
				"void main() { for (int i = 0; i < 4; i++) all[i] = vec4(1.0);\n"
				"gl_FragDepth = 0.5; }\n" },
	{ "geometry",
		.vertex = ES "#extension GL_EXT_geometry_shader : require\n"
			     "void main() { gl_Position = vec4(0.0); }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 2: it asks for GL_EXT_geometry_shader; small boards "
			"have no geometry shaders",
		.code = GLES_ERROR_LIMIT },
	{ "tessellation",
		.vertex = ES "#extension GL_EXT_tessellation_shader : enable\n"
			     "void main() { gl_Position = vec4(0.0); }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 2: it asks for GL_EXT_tessellation_shader; small "
			"boards have no tessellation shaders",
		.code = GLES_ERROR_LIMIT },
	{ "64-bit-atomics",
		.compute = ES "// 64-bit keys\n"
			      "#extension GL_NV_shader_atomic_int64 : require\n"
			      "layout(local_size_x = 64) in;\n"
			      "void main() { }\n",
		.says = "sample (compute) line 3: it asks for GL_NV_shader_atomic_int64; small "
			"boards have no 64-bit integers and atomics",
		.code = GLES_ERROR_LIMIT },
	{ "other-extension", .vertex = VERTEX,
		.fragment = ES " # extension GL_EXT_shader_framebuffer_fetch : require\n" HIGH
			       "layout(location = 0) inout vec4 pixel;\n"
			       "void main() { pixel *= 0.5; }\n",
		.says = "sample (fragment) line 2: it asks for GL_EXT_shader_framebuffer_fetch; of "
			"extensions, small boards surely have GL_OES_shader_image_atomic alone",
		.code = GLES_ERROR_LIMIT },
	{ "allowed-extension", .compute = ES
			       "/*\n#extension GL_EXT_geometry_shader : require\n*/\n"
			       "#extension GL_OES_shader_image_atomic : require\n"
			       "layout(local_size_x = 64) in;\n"
			       "precision highp uimage2D;\n"
			       "layout(r32ui, binding = 0) uniform uimage2D depth;\n"
			       "void main() { imageAtomicMin(depth, ivec2(0), 1u); }\n" },
	{ "newer-language", .vertex = "#version 320 es\nvoid main() { gl_Position = vec4(0.0); }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 1: it must begin with #version 310 es, the GLSL that "
			"small boards have",
		.code = GLES_ERROR_LIMIT },
	{ "no-version", .vertex = "void main() { gl_Position = vec4(0.0); }\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 1: it must begin with #version 310 es, the GLSL that "
			"small boards have",
		.code = GLES_ERROR_LIMIT },
	{ "desktop", .vertex = VERTEX,
		.fragment =
			"\n#version 450 core\nout vec4 pixel;\nvoid main() { pixel = vec4(1); }\n",
		.says = "sample (fragment) line 2: it must begin with #version 310 es, the GLSL "
			"that "
			"small boards have",
		.code = GLES_ERROR_LIMIT },
	{ "large-points",
		.vertex = ES "void main() {\n"
			     "\tgl_Position = vec4(0.0);\n"
			     "\tgl_PointSize = 600.0;\n"
			     "}\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 4: points of 600.0 pixels; small boards have 512 at "
			"most",
		.code = GLES_ERROR_LIMIT },
	{ "points", .vertex = ES "void main() { gl_Position = vec4(0.0); gl_PointSize = 512.0; }\n",
		.fragment = FRAGMENT },
	/* ---- what the compiler refuses; the words differ, the place does not ---- */
	{ "mistake", .vertex = ES "void main() {\n\tgl_Position = nowhere;\n}\n",
		.fragment = FRAGMENT,
		.says = "sample (vertex) line 3: ", .code = GLES_ERROR_COMPILE },
	{ "mistake-in-common", .common = "float half_of(float x)\n{\n\treturn x * nowhere;\n}",
		.vertex = VERTEX, .fragment = FRAGMENT,
		.says = "sample (vertex), common line 3: ", .code = GLES_ERROR_COMPILE },
	{ "mistake-behind-common", .common = "float half_of(float x)\n{\n\treturn x * 0.5;\n}",
		.vertex = ES "\nvoid main() {\n\tgl_Position = vec4(half_of(1.0)) + nowhere;\n}\n",
		.fragment = ES "#extension GL_OES_shader_image_atomic : enable\n" HIGH
			       "layout(location = 0) out vec4 pixel;\n"
			       "void main() { pixel = vec4(half_of(1.0)); }\n",
		.says = "sample (vertex) line 4: ", .code = GLES_ERROR_COMPILE },
	{ "limit-behind-common", .common = "float half_of(float x)\n{\n\treturn x * 0.5;\n}",
		.compute = ES "layout(std430, binding = 0) buffer Sums { float sum[]; };\n"
			      "layout(local_size_x = 257) in;\n"
			      "void main() { sum[gl_LocalInvocationIndex] = half_of(1.0); }\n",
		.says = "sample (compute) line 3: a group of 257 x 1 x 1 = 257 invocations; small "
			"boards have 256",
		.code = GLES_ERROR_LIMIT },
	{ "common",
		.common = "precision highp float;\nfloat half_of(float x)\n{\n\treturn x * 0.5;\n}",
		.vertex = ES "void main() { gl_Position = vec4(half_of(1.0)); }\n",
		.fragment = ES "layout(location = 0) out vec4 pixel;\n"
			       "void main() { pixel = vec4(half_of(1.0)); }\n" },
	{ "shaders-apart", .vertex = VERTEX,
		.fragment = ES HIGH "in vec4 paint;\n"
				    "layout(location = 0) out vec4 pixel;\n"
				    "void main() { pixel = paint; }\n",
		.says = "sample: its shaders do not fit together: ", .code = GLES_ERROR_COMPILE },
};

static void test_sample(gconstpointer data)
{
	const struct sample *s = data;
	g_autoptr(gles_context) c = open_here();
	g_autoptr(GError) error = NULL;
	if (!c)
		return;
	struct gles_program_desc desc = { "sample", s->common, s->vertex, s->fragment, s->compute };
	GLuint program = gles_program_new(c, &desc, &error);
	if (!s->says)
		g_assert_no_error(error);
	else
		g_assert_error(error, GLES_ERROR, s->code);
	g_assert_cmpint(program != 0, ==, s->says == NULL);
	if (error)
		g_test_message("%s", error->message);
	if (s->says && s->code == GLES_ERROR_LIMIT)
		g_assert_cmpstr(error->message, ==, s->says);
	else if (s->says)
		g_assert_true(g_str_has_prefix(error->message, s->says) &&
			      strlen(error->message) > strlen(s->says) &&
			      !strchr(error->message, '\n'));
	c->gl.DeleteProgram(program);
	g_assert_true(gles_context_check(c, "testing", NULL));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(samples); i++) {
		g_autofree char *path = g_strconcat("/gles-program/", samples[i].name, NULL);
		g_test_add_data_func(path, &samples[i], test_sample);
	}
	return g_test_run();
}
