/* A libEGL.so.1 whose driver fails as $FAKE_EGL says; put before the real one by LD_LIBRARY_PATH.
 *
 *   refuse crash abort exit hang   what eglInitialize does
 *   closed                         crashes after it closed every descriptor, as careless drivers do
 *   crash-surfaceless              the same, of the platform surfaceless alone; all else is the real library's ($FAKE_EGL_REAL)
 *   wrong                          glReadPixels gets a pixel wrong, all else is the real library's
 *   old                            there is no OpenGL ES 3.1 (eglCreateContext refuses), all else is the real library's
 *
 * As LD_AUDIT, it hides every libEGL from dlopen instead. */
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl31.h>
#include <dlfcn.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Only these are seen; what the loader asks of an auditor is in no header that others include. */
unsigned la_version(unsigned version);
char *la_objsearch(const char *name, uintptr_t *cookie, unsigned flag);
__eglMustCastToProperFunctionPointerType eglGetProcAddress(const char *name);
typedef __eglMustCastToProperFunctionPointerType function;

unsigned la_version(unsigned version)
{
	return version;
}

char *la_objsearch(const char *name, uintptr_t *cookie, unsigned flag)
{
	(void)cookie, (void)flag;
	/* Where it is looked for, not what is asked for. */
	return strstr(name, "/libEGL.so") ? NULL : (char *)name;
}

static bool mode_is(const char *mode)
{
	const char *is = getenv("FAKE_EGL");
	return is && !strcmp(is, mode);
}

static function real(const char *name)
{
	const char *path = getenv("FAKE_EGL_REAL");
	void *handle = path ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
	if (!handle)
		return NULL;
	function known = (function)dlsym(handle, name);
	__typeof__(eglGetProcAddress) *find =
		(__typeof__(eglGetProcAddress) *)dlsym(handle, "eglGetProcAddress");
	return known ? known : find ? find(name) : NULL;
}

/* ---- its driver ---- */

static EGLenum platform;

static EGLDisplay get_display(EGLenum of, void *native, const EGLint *attributes)
{
	PFNEGLGETPLATFORMDISPLAYEXTPROC f =
		(PFNEGLGETPLATFORMDISPLAYEXTPROC)real("eglGetPlatformDisplayEXT");
	platform = of;
	return f ? f(of, native, attributes) : (EGLDisplay)&platform;
}

static EGLBoolean initialize(EGLDisplay display, EGLint *major, EGLint *minor)
{
	__typeof__(eglInitialize) *f = (__typeof__(eglInitialize) *)real("eglInitialize");
	if (mode_is("closed"))
		close_range(3, 1000, 0);
	if (mode_is("crash") || mode_is("closed") ||
		(mode_is("crash-surfaceless") && platform == EGL_PLATFORM_SURFACELESS_MESA))
		raise(SIGSEGV);
	if (mode_is("abort"))
		abort();
	if (mode_is("exit"))
		exit(3);
	while (mode_is("hang"))
		pause();
	return f ? f(display, major, minor) : EGL_FALSE;
}

static const char *query_string(EGLDisplay display, EGLint name)
{
	__typeof__(eglQueryString) *f = (__typeof__(eglQueryString) *)real("eglQueryString");
	return f ? f(display, name) : "EGL_EXT_platform_base EGL_MESA_platform_surfaceless";
}

static EGLint get_error(void)
{
	__typeof__(eglGetError) *f = (__typeof__(eglGetError) *)real("eglGetError");
	return f && !mode_is("old") ? f() : EGL_NOT_INITIALIZED;
}

static EGLContext create_context(
	EGLDisplay display, EGLConfig config, EGLContext share, const EGLint *attributes)
{
	__typeof__(eglCreateContext) *f = (__typeof__(eglCreateContext) *)real("eglCreateContext");
	return f && !mode_is("old") ? f(display, config, share, attributes) : EGL_NO_CONTEXT;
}

static void GL_APIENTRY read_pixels(
	GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type, void *pixels)
{
	__typeof__(glReadPixels) *f = (__typeof__(glReadPixels) *)real("glReadPixels");
	f(x, y, width, height, format, type, pixels);
	if (mode_is("wrong"))
		((uint8_t *)pixels)[4 * 17 + 1] ^= 0x40;
}

static long nothing(void)
{
	return 0;
}

function eglGetProcAddress(const char *name)
{
	static const struct {
		const char *name;
		function does;
	} own[] = { { "eglGetPlatformDisplayEXT", (function)get_display },
		{ "eglInitialize", (function)initialize },
		{ "eglQueryString", (function)query_string },
		{ "eglGetError", (function)get_error },
		{ "eglCreateContext", (function)create_context },
		{ "glReadPixels", (function)read_pixels } };
	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		if (!strcmp(own[i].name, name))
			return own[i].does;
	function is = real(name);
	return is ? is : (function)nothing;
}
