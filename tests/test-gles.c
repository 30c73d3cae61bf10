/* OpenGL ES without a window: on whatever there is, software as a rule; without any, on drivers that fail in all ways, which
 * must end in a sentence. */
#include "render/backend-choice.h"
#include "render/gles-buffer.h"
#include "render/gles-context.h"
#include "render/gles-probe.h"
#include "render/gles-program.h"
#include "render/gles-trial.h"
#include <dlfcn.h>
#include <glib/gstdio.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

/* What there is here, looked for once, before the first context is opened. NULL: ret_why says it. */
static const struct gles_about *here(const char **ret_why)
{
	static struct gles_about found;
	static char *why;
	static bool is_asked, is_found;
	if (!is_asked) {
		g_autoptr(GError) error = NULL;
		is_found = gles_context_probe(NULL, &found, &error);
		why = g_strdup(error ? error->message : "");
	}
	is_asked = true;
	*ret_why = why;
	return is_found ? &found : NULL;
}

/* NULL: the test is skipped. */
static gles_context *open_here(void)
{
	const char *why;
	const struct gles_about *found = here(&why);
	if (!found) {
		g_test_skip(why);
		return NULL;
	}
	g_autoptr(GError) error = NULL;
	gles_context *c = gles_context_open(found, &error);
	g_assert_no_error(error);
	return c;
}

static void assert_has(const char *text, const char *part)
{
	if (!text || !strstr(text, part))
		g_error("\"%s\" has no \"%s\"", text, part);
}

/* ---- a context ---- */

/* No store is written again, and none is freed, before the GPU has come to rest; then they are taken again. */
static void test_stores(void)
{
	g_autoptr(gles_context) c = open_here();
	g_autoptr(GError) error = NULL;
	if (!c)
		return;
	struct gles_buffer b = { 0 };
	GLuint name[3];
	for (uint32_t n = 0; n < 3; n++) {
		uint32_t in[40] = { n, [39] = 7 * n }, out[40];
		g_assert_true(gles_buffer_put(c, &b, in, sizeof in, "a test", &error));
		g_assert_true(gles_buffer_read(c, &b, sizeof out, out, &error));
		g_assert_cmpmem(in, sizeof in, out, sizeof out);
		name[n] = b.name;
	}
	g_assert_true(name[0] != name[1] && name[1] != name[2] && name[0] != name[2]);
	gles_buffer_clear(c, &b);
	g_assert_cmpuint(c->gone->len, ==, 1);
	gles_buffers_rest(c);
	g_assert_cmpuint(c->gone->len, ==, 0);
	g_assert_true(gles_buffer_put(c, &b, name, sizeof name, "a test", &error));
	g_assert_true(b.name != name[0] && b.name != name[1]); /* too large for so little */
	uint32_t again[40] = { 0 };
	g_assert_true(gles_buffer_put(c, &b, again, sizeof again, "a test", &error));
	g_assert_true(b.name == name[0] || b.name == name[1]);
	gles_buffer_clear(c, &b);
	gles_buffers_rest(c);
	g_assert_no_error(error);
}

static void test_context(void)
{
	g_autoptr(gles_context) c = open_here();
	g_autoptr(GError) error = NULL;
	if (!c)
		return;
	g_autofree char *text = gles_about_text(&c->about);
	g_test_message("%s; %s", text, c->about.version);
	const struct gles_limits *l = &c->about.limits;
	/* What every OpenGL ES 3.1 has at least. */
	g_assert_cmpint(c->about.major, ==, 3);
	g_assert_cmpint(c->about.minor, >=, 1);
	g_assert_cmpint(l->texture_size, >=, 2048);
	g_assert_cmpint(l->viewport_size, >=, 2048);
	g_assert_cmpint(l->colour_outputs, >=, 4);
	g_assert_cmpint(l->group_invocations, >=, 128);
	g_assert_cmpint(l->group_size[0], >=, 128);
	g_assert_cmpint(l->groups[2], >=, 65535);
	g_assert_cmpint(l->shared_bytes, >=, 16384);
	g_assert_cmpint(l->storage_block_bytes, >=, 1 << 27);
	g_assert_cmpint(l->storage_blocks, >=, 4);
	g_assert_cmpfloat(l->point_size, >=, 1);
	g_assert_true(gles_trial(c, &error));
	g_assert_no_error(error);
	g_assert_false(gles_context_is_lost(c));
}

/* What the probe said of the driver is what is opened. */
static void test_found(void)
{
	g_autoptr(gles_context) c = open_here();
	const char *why;
	if (!c)
		return;
	const struct gles_about *found = here(&why);
	g_assert_cmpstr(c->about.renderer, ==, found->renderer);
	g_assert_cmpint(c->about.platform, ==, found->platform);
	g_assert_cmpuint(c->about.display, ==, found->display);
	g_assert_cmpint(c->about.limits.group_invocations, ==, found->limits.group_invocations);
}

/* Two share their display: the end of one is not the other's. */
static void test_two(void)
{
	g_autoptr(gles_context) first = open_here(), second = NULL;
	g_autoptr(GError) error = NULL;
	if (!first)
		return;
	second = gles_context_open(&first->about, &error);
	g_assert_no_error(error);
	g_assert_true(gles_trial(second, &error));
	g_assert_true(gles_context_use(first, &error));
	g_assert_true(gles_trial(first, &error));
	g_clear_pointer(&second, gles_context_free);
	g_assert_true(gles_trial(first, &error));
	g_clear_pointer(&first, gles_context_free);
	first = open_here();
	g_assert_true(gles_trial(first, &error));
	g_assert_no_error(error);
}

static gpointer draw_apart(gpointer data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(gles_context) c = gles_context_open(data, &error);
	g_assert_no_error(error);
	return GINT_TO_POINTER(gles_trial(c, NULL));
}

static void test_threads(void)
{
	g_autoptr(gles_context) c = open_here();
	if (!c)
		return;
	GThread *thread = g_thread_new("apart", draw_apart, &c->about);
	g_assert_true(gles_trial(c, NULL));
	g_assert_true(GPOINTER_TO_INT(g_thread_join(thread)));
	g_assert_true(gles_trial(c, NULL));
}

/* A mistake of ours is said once, and over with. */
static void test_mistake(void)
{
	g_autoptr(gles_context) c = open_here();
	g_autoptr(GError) error = NULL;
	if (!c)
		return;
	c->gl.Enable(GL_TEXTURE_2D);
	g_assert_false(gles_context_check(c, "testing", &error));
	g_assert_error(error, GLES_ERROR, GLES_ERROR_DRIVER);
	g_assert_cmpstr(error->message, ==, "while testing, OpenGL said GL_INVALID_ENUM");
	g_assert_true(gles_context_check(c, "testing", NULL));
}

/* ---- other machines: this program once more, in other surroundings ---- */

/* What it does there: says what would draw, or why nothing can. */
static int say(const char *wish_name)
{
	enum backend_wish wish;
	struct gles_about found;
	g_autoptr(GError) why_none = NULL, error = NULL;
	g_auto(backend_choice) choice = { 0 };
	if (!backend_wish_parse(wish_name, &wish, &error))
		return 2;
	bool is_found = gles_context_probe(
		&(struct gles_probe_options){ .patience_s = 2 }, &found, &why_none);
	bool is_chosen = backend_choose(wish, is_found ? &found : NULL, why_none, &choice, &error);
	g_print("%s", is_chosen ? choice.why : error->message);
	return is_chosen ? 0 : 1;
}

/* And this: a context, and a mistake in it. */
static int make_mistake(void)
{
	struct gles_about found;
	g_autoptr(gles_context) c =
		gles_context_probe(NULL, &found, NULL) ? gles_context_open(&found, NULL) : NULL;
	if (!c)
		return 2;
	c->gl.Enable(GL_TEXTURE_2D);
	return 0;
}

typedef struct said {
	char *out, *err;
	int status;
} said;
static void said_clear(said *s)
{
	g_free(s->out);
	g_free(s->err);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(said, said_clear)

/* set: "NAME=value", NULL-terminated. */
static said run_where(const char *const *set, const char *what, const char *wish)
{
	g_auto(GStrv) environment = g_get_environ();
	environment = g_environ_unsetenv(environment, "PLEINAIR_EGL");
	for (; *set; set++) {
		g_auto(GStrv) pair = g_strsplit(*set, "=", 2);
		environment = g_environ_setenv(environment, pair[0], pair[1], TRUE);
	}
	char *arguments[] = { (char *)"/proc/self/exe", (char *)what, (char *)wish, NULL };
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	g_autoptr(GError) error = NULL;
	arguments[0] = self;
	said s = { 0 };
	int status;
	g_spawn_sync(NULL, arguments, environment, G_SPAWN_DEFAULT, NULL, NULL, &s.out, &s.err,
		&status, &error);
	g_assert_no_error(error);
	s.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
	g_test_message("%s%s", s.out, s.err);
	return s;
}

static char *fake_folder(void)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL),
			*folder = g_path_get_dirname(self);
	return g_build_filename(folder, "fake-egl", NULL);
}

/* "FAKE_EGL_REAL=/usr/lib/.../libEGL.so.1"; NULL: there is none. */
static char *real_egl(void)
{
	void *handle = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
	struct link_map *map = NULL;
	if (!handle || dlinfo(handle, RTLD_DI_LINKMAP, &map))
		return NULL;
	return g_strdup_printf("FAKE_EGL_REAL=%s", map->l_name);
}

#define OPENGL_GONE "gles was asked for, but EGL has no OpenGL ES 3.1: "

static const struct failure {
	const char *name, *fake, *sentence;
} failures[] = {
	{ "refuses", "refuse",
		OPENGL_GONE "by surfaceless, EGL cannot start its driver (EGL_NOT_INITIALIZED); "
			    "by device, EGL has no EGL_EXT_platform_device; "
			    "by gbm, EGL has no EGL_KHR_platform_gbm" },
	{ "crashes", "crash",
		"by surfaceless, its driver crashes (Segmentation fault); by device" },
	{ "aborts", "abort", "by surfaceless, its driver crashes (Aborted); by device" },
	{ "exits", "exit",
		"by surfaceless, its driver ends the program (exit status 3); by device" },
	{ "hangs", "hang", "by surfaceless, its driver hangs (2 s); by device" },
	{ "closes-all", "closed",
		"by surfaceless, its driver crashes (Segmentation fault); by device" },
};

static void test_failure(gconstpointer data)
{
	const struct failure *f = data;
	g_autofree char *folder = fake_folder(),
			*path = g_strdup_printf("LD_LIBRARY_PATH=%s", folder),
			*mode = g_strdup_printf("FAKE_EGL=%s", f->fake);
	const char *set[] = { path, mode, NULL };
	g_auto(said) s = run_where(set, "--say", "gles");
	g_assert_cmpint(s.status, ==, 1);
	assert_has(s.out, f->sentence);
	assert_has(s.out, OPENGL_GONE);
	g_auto(said) automatic = run_where(set, "--say", "auto");
	g_assert_cmpint(automatic.status, ==, 0);
	assert_has(automatic.out, "cpu: EGL has no OpenGL ES 3.1: ");
}

/* The real driver, but for one thing. */
static void fail_over_real(const char *mode, int status, const char *sentence)
{
	const char *why;
	g_autofree char *folder = fake_folder(), *real = real_egl(),
			*path = g_strdup_printf("LD_LIBRARY_PATH=%s", folder),
			*fake = g_strdup_printf("FAKE_EGL=%s", mode);
	if (!here(&why)) {
		g_test_skip(why);
		return;
	}
	const char *set[] = { path, fake, real, NULL };
	g_auto(said) s = run_where(set, "--say", "gles");
	g_assert_cmpint(s.status, ==, status);
	assert_has(s.out, sentence);
}

static void test_wrong(void)
{
	fail_over_real("wrong", 1,
		"its driver draws wrong pictures (pixel 1, 1 is 19 85 7 255, not 19 21 7 255)");
}

static void test_old(void)
{
	fail_over_real("old", 1,
		"its driver has no OpenGL ES 3.1 (eglCreateContext: EGL_NOT_INITIALIZED)");
}

/* One platform's driver crashes: another platform is taken. */
static void test_other_platform(void)
{
	g_auto(said) s =
		run_where((const char *[]){ "PLEINAIR_EGL=device", NULL }, "--say", "gles");
	if (s.status)
		g_test_skip(s.out);
	else
		fail_over_real("crash-surfaceless", 0, " by EGL device");
}

static void test_no_library(void)
{
	g_autofree char *folder = fake_folder(),
			*audit = g_strdup_printf("LD_AUDIT=%s/libEGL.so.1", folder);
	const char *set[] = { audit, NULL };
	g_auto(said) s = run_where(set, "--say", "gles");
	g_assert_cmpstr(
		s.out, ==, "gles was asked for, but there is no libEGL.so.1 on this machine");
	g_assert_cmpint(s.status, ==, 1);
	g_auto(said) automatic = run_where(set, "--say", "auto");
	g_assert_cmpstr(automatic.out, ==, "cpu: there is no libEGL.so.1 on this machine");
	g_assert_cmpint(automatic.status, ==, 0);
}

static void test_bad_library(void)
{
	g_autofree char *folder = g_dir_make_tmp("gles-XXXXXX", NULL),
			*file = g_build_filename(folder, "libEGL.so.1", NULL),
			*path = g_strdup_printf("LD_LIBRARY_PATH=%s", folder);
	g_assert_true(g_file_set_contents(file, "no library", -1, NULL));
	g_auto(said) s = run_where((const char *[]){ path, NULL }, "--say", "auto");
	assert_has(s.out, "cpu: libEGL.so.1 cannot be loaded: ");
	g_assert_cmpint(s.status, ==, 0);
	remove(file);
	remove(folder);
}

static void test_no_driver(void)
{
	g_auto(said) s = run_where((const char *[]){ "__EGL_VENDOR_LIBRARY_FILENAMES=/nowhere",
					   "__EGL_VENDOR_LIBRARY_DIRS=/nowhere", NULL },
		"--say", "gles");
	/* An EGL that is no dispatcher takes no notice. */
	if (s.status == 0)
		g_test_skip("this libEGL is not a dispatcher");
	else if (!strstr(s.out, "no libEGL"))
		g_assert_cmpstr(
			s.out, ==, OPENGL_GONE "it has no driver that draws without a window");
}

static void test_forbidden(void)
{
	g_auto(said) none =
		run_where((const char *[]){ "PLEINAIR_EGL=none", NULL }, "--say", "auto");
	g_assert_cmpstr(none.out, ==, "cpu: PLEINAIR_EGL=none forbids OpenGL");
	g_assert_cmpint(none.status, ==, 0);
	g_auto(said) wrong =
		run_where((const char *[]){ "PLEINAIR_EGL=glx", NULL }, "--say", "gles");
	g_assert_cmpstr(wrong.out, ==,
		"gles was asked for, but PLEINAIR_EGL is \"glx\", not surfaceless, device, gbm or "
		"none");
	g_assert_cmpint(wrong.status, ==, 1);
}

/* Each platform alone gives what it is named for, or says what it lacks. */
static void test_platform(gconstpointer data)
{
	const char *name = data;
	g_autofree char *only = g_strdup_printf("PLEINAIR_EGL=%s", name),
			*by = g_strdup_printf(" by EGL %s", name),
			*lacks = g_strdup_printf("gles was asked for, but ");
	g_auto(said) s = run_where((const char *[]){ only, NULL }, "--say", "gles");
	g_assert_cmpint(s.status, >=, 0);
	assert_has(s.out, s.status ? lacks : by);
	if (s.status)
		g_test_skip(s.out);
}

/* What the driver thinks of it is shown with the messages for debugging, and only there. */
static void test_debug(void)
{
	g_autoptr(gles_context) c = open_here();
	if (!c)
		return;
	if (!c->gl.DebugMessageCallbackKHR) {
		g_test_skip("no GL_KHR_debug");
		return;
	}
	g_auto(said) shown =
		run_where((const char *[]){ "G_MESSAGES_DEBUG=pleinair", NULL }, "--mistake", NULL);
	assert_has(shown.out, "OpenGL error: ");
	g_auto(said) quiet =
		run_where((const char *[]){ "G_MESSAGES_DEBUG=", NULL }, "--mistake", NULL);
	g_assert_cmpstr(quiet.out, ==, "");
}

/* ---- the choice ---- */

static const struct choosing {
	enum backend_wish wish;
	const char *renderer; /* NULL: there is none */
	const char *why;      /* that it says */
	bool fails;
} choosings[] = {
	{ BACKEND_WISH_AUTO, "NVIDIA H200/PCIe/SSE2",
		"gles: NVIDIA H200, OpenGL ES 3.2 by EGL device" },
	{ BACKEND_WISH_GLES, "V3D 4.2", "gles: V3D 4.2, OpenGL ES 3.2 by EGL device" },
	{ BACKEND_WISH_AUTO, "llvmpipe (LLVM 15.0.6, 256 bits)",
		"cpu: the only OpenGL here is software (llvmpipe)" },
	{ BACKEND_WISH_GLES, "llvmpipe (LLVM 15.0.6, 256 bits)",
		"gles: llvmpipe (LLVM 15.0.6, 256 bits), OpenGL ES 3.2 by EGL device, which is "
		"software: cpu would be faster" },
	{ BACKEND_WISH_AUTO, NULL, "cpu: there is no libEGL.so.1" },
	{ BACKEND_WISH_GLES, NULL, "gles was asked for, but there is no libEGL.so.1", true },
	{ BACKEND_WISH_CPU, NULL, "cpu: as asked for" },
	{ BACKEND_WISH_CPU, "V3D 4.2", "cpu: as asked for" },
};

static void choose(const struct choosing *c)
{
	struct gles_about about = { .platform = GLES_DEVICE, .major = 3, .minor = 2 };
	g_autoptr(GError) none = NULL, error = NULL;
	g_auto(backend_choice) choice = { 0 };
	if (c->renderer) {
		g_strlcpy(about.renderer, c->renderer, sizeof about.renderer);
		about.is_software = gles_renderer_is_software(c->renderer);
	} else {
		g_set_error_literal(&none, GLES_ERROR, GLES_ERROR_NONE, "there is no libEGL.so.1");
	}
	bool is_chosen =
		backend_choose(c->wish, c->renderer ? &about : NULL, none, &choice, &error);
	g_assert_cmpint(is_chosen, ==, !c->fails);
	g_assert_cmpstr(is_chosen ? choice.why : error->message, ==, c->why);
	if (is_chosen)
		g_assert_true(g_str_has_prefix(
			c->why, choice.backend == BACKEND_GLES ? "gles: " : "cpu: "));
}

static void test_no_gpu(void)
{
	static const char *const some[] = { "nvidia0", "dri", "dxg", "mali0" };
	g_autofree char *folder = g_dir_make_tmp("gpu-XXXXXX", NULL),
			*other = g_build_filename(folder, "null", NULL),
			*missing = g_build_filename(folder, "none", NULL);
	g_assert_true(backend_may_have_gpu(missing));
	g_assert_true(g_file_set_contents(other, "", -1, NULL));
	g_assert_false(backend_may_have_gpu(folder));
	for (size_t n = 0; n < G_N_ELEMENTS(some); n++) {
		g_autofree char *file = g_build_filename(folder, some[n], NULL);
		g_assert_true(g_file_set_contents(file, "", -1, NULL));
		g_assert_true(backend_may_have_gpu(folder));
		g_assert_cmpint(g_remove(file), ==, 0);
	}
	g_assert_cmpint(g_remove(other), ==, 0);
	g_assert_cmpint(g_rmdir(folder), ==, 0);
}

static void test_choice(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(choosings); i++)
		choose(&choosings[i]);
	g_auto(backend_choice) cpu = { 0 };
	g_assert_true(backend_choose_here(BACKEND_WISH_CPU, &cpu, NULL));
	g_assert_cmpint(cpu.backend, ==, BACKEND_CPU);
}

static void test_wish(void)
{
	enum backend_wish wish = BACKEND_WISH_CPU;
	g_autoptr(GError) error = NULL;
	g_assert_true(backend_wish_parse(NULL, &wish, NULL) && wish == BACKEND_WISH_AUTO);
	g_assert_true(backend_wish_parse("gles", &wish, NULL) && wish == BACKEND_WISH_GLES);
	g_assert_true(backend_wish_parse("cpu", &wish, NULL) && wish == BACKEND_WISH_CPU);
	g_assert_false(backend_wish_parse("gpu", &wish, &error));
	g_assert_error(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE);
}

static void test_renderers(void)
{
	static const char *const software[] = { "llvmpipe (LLVM 15.0.6, 256 bits)", "softpipe",
		"Google SwiftShader", "Mesa swrast", "Software Rasterizer",
		"ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)",
		"zink Vulkan 1.3(llvmpipe (LLVM 15.0.6, 256 bits))" };
	static const char *const gpus[] = { "NVIDIA H200/PCIe/SSE2", "V3D 4.2", "Mali-G610",
		"Mesa Intel(R) UHD Graphics 620 (KBL GT2)", "AMD Radeon RX 580 Series (polaris10)",
		"NVIDIA Tegra Orin (nvgpu)/integrated", "zink Vulkan 1.3(V3D 7.1)" };
	for (size_t i = 0; i < G_N_ELEMENTS(software); i++)
		g_assert_true(gles_renderer_is_software(software[i]));
	for (size_t i = 0; i < G_N_ELEMENTS(gpus); i++)
		g_assert_false(gles_renderer_is_software(gpus[i]));
}

int main(int argc, char **argv)
{
	if (argc == 3 && !strcmp(argv[1], "--say"))
		return say(argv[2]);
	if (argc == 2 && !strcmp(argv[1], "--mistake"))
		return make_mistake();
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/gles/renderers", test_renderers);
	g_test_add_func("/gles/wish", test_wish);
	g_test_add_func("/gles/choice", test_choice);
	g_test_add_func("/gles/no-gpu", test_no_gpu);
	g_test_add_func("/gles/context", test_context);
	g_test_add_func("/gles/stores", test_stores);
	g_test_add_func("/gles/found", test_found);
	g_test_add_func("/gles/two", test_two);
	g_test_add_func("/gles/threads", test_threads);
	g_test_add_func("/gles/mistake", test_mistake);
	g_test_add_func("/gles/debug", test_debug);
	for (size_t i = 0; i < GLES_PLATFORMS; i++) {
		g_autofree char *path = g_strconcat("/gles/by/", gles_platform_names[i], NULL);
		g_test_add_data_func(path, gles_platform_names[i], test_platform);
	}
	for (size_t i = 0; i < G_N_ELEMENTS(failures); i++) {
		g_autofree char *path = g_strconcat("/gles/driver/", failures[i].name, NULL);
		g_test_add_data_func(path, &failures[i], test_failure);
	}
	g_test_add_func("/gles/driver/wrong", test_wrong);
	g_test_add_func("/gles/driver/old", test_old);
	g_test_add_func("/gles/driver/other-platform", test_other_platform);
	g_test_add_func("/gles/no-library", test_no_library);
	g_test_add_func("/gles/bad-library", test_bad_library);
	g_test_add_func("/gles/no-driver", test_no_driver);
	g_test_add_func("/gles/forbidden", test_forbidden);
	return g_test_run();
}
