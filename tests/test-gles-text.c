/* Texts of shaders, without any OpenGL: what compilers say of them, where, and how much they share. */
#include "render/gles-shader-text.h"
#include "render/gles-shared-bytes.h"
#include <string.h>

#define ES "#version 310 es\n"

static void test_complaints(void)
{
	static const struct {
		const char *log, *sentence;
	} logs[] = {
		{ "0:12(7): error: `x' undeclared\n0:13(1): error: more\n",
			"s line 12: `x' undeclared" },
		{ "0:3(1): warning: x unused\n0:10012(7): error: `x' undeclared\n",
			"s, common line 12: `x' undeclared" },
		{ "0:9(2): preprocessor error: syntax error\n", "s line 9: syntax error" },
		{ "0(3) : warning C7050: \"y\" might be used\n"
		  "0(12) : error C1503: undefined variable \"x\"\n",
			"s line 12: undefined variable \"x\"" },
		{ "ERROR: 0:12: 'x' : undeclared identifier\nERROR: 1 compilation errors.\n",
			"s line 12: 'x' : undeclared identifier" },
		{ "0:12: L0002: Undeclared variable 'x'\n", "s line 12: Undeclared variable 'x'" },
		{ "\n out of memory\nmore\n", "s: out of memory" },
		{ "", "s: refused, without a word" },
	};
	g_autoptr(gles_shader_text) t = gles_shader_text_new("s", NULL, ES "void main() { }\n");
	for (size_t i = 0; i < G_N_ELEMENTS(logs); i++) {
		g_autofree char *is = gles_shader_text_complaint(t, logs[i].log);
		g_assert_cmpstr(is, ==, logs[i].sentence);
	}
}

static void test_places(void)
{
	g_autoptr(gles_shader_text) t = gles_shader_text_new("s", "int a;\nint b;",
		ES
		"// int a, c;\n#extension GL_OES_shader_image_atomic : enable\nint c;\n\nint d;");
	static const char *const places[][2] = { { "a", "s, common line 1" },
		{ "b", "s, common line 2" }, { "c", "s line 4" }, { "d", "s line 6" },
		{ "version", "s line 1" }, { "extension", "s line 3" }, { "e", "s" } };
	for (size_t i = 0; i < G_N_ELEMENTS(places); i++) {
		g_autofree char *is = gles_shader_text_place_of(t, places[i][0]);
		g_assert_cmpstr(is, ==, places[i][1]);
	}
	g_assert_cmpuint(strlen(t->plain), ==, strlen(t->whole));
}

static void test_shared_bytes(void)
{
	static const struct {
		const char *text;
		uint64_t bytes;
		const char *unclear;
	} texts[] = {
		{ "int a[4];", 0 },
		{ "layout(shared) uniform B { int a; };\nvoid main() { memoryBarrierShared(); }",
			0 },
		{ "shared float a, b[3];", 16 },
		{ "shared highp uint a[0x10u];\nshared vec2 b[2];", 64 + 16 },
		{ "shared vec3 a[2], b;", 48 },
		{ "shared mat4 a;\nshared mat3x2 b;", 64 + 48 },
		{ "shared bvec4[2][3] a[4];", 16 * 24 },
		{ "#define N (8 * 4)\nconst highp uint m = 2u;\nshared int a[N][m * 3u];",
			4 * 32 * 6 },
		{ "shared uint a[4000000000][4000000000][4000000000];", UINT64_C(1) << 40 },
		{ "#if A\n#define N 8\n#else\n#define N 9\n#endif\nshared int a[N];", 0,
			"int a[N]" },
		{ "#define N M\n#define M N\nshared int a[N];", 0, "int a[N]" },
		{ "shared int a[N];", 0, "int a[N]" },
		{ "shared int a[2 + 2];", 0, "int a[2 + 2]" },
		{ "shared int a[gl_WorkGroupSize.x];", 0, "int a[gl_WorkGroupSize.x]" },
		{ "shared struct s { int a; } b;", 0, "struct s" },
		{ "shared matrix a;", 0, "matrix a" },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(texts); i++) {
		struct gles_shared s = gles_shared_bytes(texts[i].text);
		g_autofree char *unclear = s.unclear;
		g_assert_cmpstr(unclear, ==, texts[i].unclear);
		g_assert_cmpuint(s.bytes, ==, texts[i].bytes);
	}
}

/* Half a shader is somebody typing: a sentence, and no more. */
static void test_cut_off(void)
{
	static const char whole[] =
		ES "/* a */ // b\n#extension GL_OES_shader_image_atomic : enable\n"
		   "#define N 4\nshared uint a[N * 2];\nvoid main() { }\n";
	for (size_t n = 0; n < sizeof whole; n++) {
		g_autofree char *cut = g_strndup(whole, n);
		g_autoptr(gles_shader_text) t = gles_shader_text_new("s", "int x;", cut);
		g_autoptr(GError) error = NULL;
		bool is_fine = gles_shader_text_check(t, &error);
		g_assert_cmpint(is_fine, ==, error == NULL);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/gles-text/complaints", test_complaints);
	g_test_add_func("/gles-text/places", test_places);
	g_test_add_func("/gles-text/shared-bytes", test_shared_bytes);
	g_test_add_func("/gles-text/cut-off", test_cut_off);
	return g_test_run();
}
