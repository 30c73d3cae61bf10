#include "render/gles-functions.h"
#include "render/gles-about.h"
#include <dlfcn.h>
#include <errno.h>
#include <string.h>

static void *library(const char *name, GError **error)
{
	void *handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
	if (handle)
		return handle;
	const char *why = dlerror();
	/* Of the library itself, not of one that it needs. */
	bool is_missing =
		why && g_str_has_prefix(why, name) && strstr(why, g_strerror(ENOENT)) != NULL;
	if (is_missing)
		g_set_error(
			error, GLES_ERROR, GLES_ERROR_NONE, "there is no %s on this machine", name);
	else
		g_set_error(error, GLES_ERROR, GLES_ERROR_NONE, "%s cannot be loaded: %s", name,
			why ? why : "no reason given");
	return NULL;
}

static bool load_egl(struct egl_functions *ret, GError **error)
{
	void *handle = library("libEGL.so.1", error);
	if (!handle)
		return false;
	ret->GetProcAddress = (__typeof__(ret->GetProcAddress))dlsym(handle, "eglGetProcAddress");
	const char *missing = ret->GetProcAddress ? NULL : "eglGetProcAddress";
#define FIND(name)                                                                                 \
	if (!(ret->name = (__typeof__(ret->name))dlsym(handle, "egl" #name)) &&                    \
		ret->GetProcAddress)                                                               \
		ret->name = (__typeof__(ret->name))ret->GetProcAddress("egl" #name);
#define FIND_OR_FAIL(name)                                                                         \
	FIND(name)                                                                                 \
	if (!ret->name && !missing)                                                                \
		missing = "egl" #name;
	EGL_FUNCTIONS(FIND_OR_FAIL)
	EGL_OPTIONAL(FIND)
	if (missing)
		g_set_error(error, GLES_ERROR, GLES_ERROR_NONE, "libEGL.so.1 has no %s", missing);
	return !missing;
}

const struct egl_functions *egl_functions_load(GError **error)
{
	static struct egl_functions egl;
	static GError *failed;
	static size_t once;
	if (g_once_init_enter(&once)) {
		load_egl(&egl, &failed);
		g_once_init_leave(&once, 1);
	}
	if (!failed)
		return &egl;
	g_propagate_error(error, g_error_copy(failed));
	return NULL;
}

const char *egl_error_name(const struct egl_functions *egl)
{
	static const char *const names[] = { "EGL_SUCCESS", "EGL_NOT_INITIALIZED", "EGL_BAD_ACCESS",
		"EGL_BAD_ALLOC", "EGL_BAD_ATTRIBUTE", "EGL_BAD_CONFIG", "EGL_BAD_CONTEXT",
		"EGL_BAD_CURRENT_SURFACE", "EGL_BAD_DISPLAY", "EGL_BAD_MATCH",
		"EGL_BAD_NATIVE_PIXMAP", "EGL_BAD_NATIVE_WINDOW", "EGL_BAD_PARAMETER",
		"EGL_BAD_SURFACE", "EGL_CONTEXT_LOST" };
	EGLint code = egl->GetError();
	return code >= EGL_SUCCESS && code <= EGL_CONTEXT_LOST ? names[code - EGL_SUCCESS]
							       : "an unknown error";
}

static void *find_gles(const struct egl_functions *egl, const char *name)
{
	void *function = (void *)egl->GetProcAddress(name);
	if (function)
		return function;
	/* Before EGL 1.5, eglGetProcAddress answered for extensions only. */
	static void *handle;
	static size_t once;
	if (g_once_init_enter(&once)) {
		handle = dlopen("libGLESv2.so.2", RTLD_NOW | RTLD_LOCAL);
		g_once_init_leave(&once, 1);
	}
	return handle ? dlsym(handle, name) : NULL;
}

bool gles_functions_load(
	const struct egl_functions *egl, struct gles_functions *ret, GError **error)
{
	const char *missing = NULL;
	memset(ret, 0, sizeof *ret);
#define LOAD(name)                                                                                 \
	if (!(ret->name = (__typeof__(ret->name))find_gles(egl, "gl" #name)) && !missing)          \
		missing = "gl" #name;
	GLES_FUNCTIONS(LOAD)
	if (missing) {
		g_set_error(error, GLES_ERROR, GLES_ERROR_NONE, "its OpenGL ES has no %s", missing);
		return false;
	}
	/* Dispatchers hand out functions for anything: what is there, the list of extensions says. */
#define LOAD_OPTIONAL(needs, name)                                                                 \
	if (gles_has_extension(ret, #needs))                                                       \
		ret->name = (__typeof__(ret->name))find_gles(egl, "gl" #name);
	GLES_OPTIONAL(LOAD_OPTIONAL)
	return true;
}

bool gles_has_extension(const struct gles_functions *gl, const char *name)
{
	GLint extensions = 0;
	gl->GetIntegerv(GL_NUM_EXTENSIONS, &extensions);
	for (GLint i = 0; i < extensions; i++) {
		const char *is = (const char *)gl->GetStringi(GL_EXTENSIONS, (GLuint)i);
		if (is && !strcmp(is, name))
			return true;
	}
	return false;
}

bool gles_list_has(const char *list, const char *word)
{
	size_t length = strlen(word);
	for (const char *at = list; at && (at = strstr(at, word)); at += length)
		if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == 0))
			return true;
	return false;
}
