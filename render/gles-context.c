#include "render/gles-context.h"
#include "render/gles-about-gl.h"
#include "render/gles-buffer.h"

/* ---- a context ---- */

static bool debug_is_shown(void)
{
	return !g_log_writer_default_would_drop(G_LOG_LEVEL_DEBUG, G_LOG_DOMAIN);
}

static EGLContext create(
	const struct gles_display *d, EGLConfig config, bool is_robust, bool is_debug)
{
	EGLint attributes[16], n = 0;
	attributes[n++] = EGL_CONTEXT_MAJOR_VERSION;
	attributes[n++] = 3;
	attributes[n++] = EGL_CONTEXT_MINOR_VERSION;
	attributes[n++] = 1;
	if (is_robust) {
		/* To be told of resets; not EGL_CONTEXT_OPENGL_ROBUST_ACCESS, which costs speed at each access. */
		attributes[n++] = EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT;
		attributes[n++] = EGL_LOSE_CONTEXT_ON_RESET_EXT;
	}
	if (is_debug) {
		attributes[n++] = EGL_CONTEXT_FLAGS_KHR;
		attributes[n++] = EGL_CONTEXT_OPENGL_DEBUG_BIT_KHR;
	}
	attributes[n] = EGL_NONE;
	return d->egl->CreateContext(d->handle, config, EGL_NO_CONTEXT, attributes);
}

static bool choose_config(const struct gles_display *d, EGLConfig *ret, GError **error)
{
	if (gles_list_has(d->extensions, "EGL_KHR_no_config_context") ||
		gles_list_has(d->extensions, "EGL_MESA_configless_context")) {
		*ret = EGL_NO_CONFIG_KHR;
		return true;
	}
	/* 0: of any kind of surface; it would be windows, which there are none of. */
	EGLint n = 0, wanted[] = { EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT,
		EGL_NONE };
	if (d->egl->ChooseConfig(d->handle, wanted, ret, 1, &n) && n > 0)
		return true;
	g_set_error_literal(
		error, GLES_ERROR, GLES_ERROR_NONE, "its driver has no OpenGL ES 3 (no EGLConfig)");
	return false;
}

static bool create_context(gles_context *c, GError **error)
{
	const struct gles_display *d = c->display;
	if (!gles_list_has(d->extensions, "EGL_KHR_surfaceless_context")) {
		g_set_error_literal(error, GLES_ERROR, GLES_ERROR_NONE,
			"its driver cannot draw without a window (no EGL_KHR_surfaceless_context)");
		return false;
	}
	EGLConfig config;
	if (!d->egl->BindAPI(EGL_OPENGL_ES_API) || !choose_config(d, &config, error))
		return false;
	bool is_robust = gles_list_has(d->extensions, "EGL_EXT_create_context_robustness"),
	     is_debug = gles_list_has(d->extensions, "EGL_KHR_create_context") && debug_is_shown();
	c->handle = create(d, config, is_robust, is_debug);
	/* Some say that they could, and cannot. */
	if (c->handle == EGL_NO_CONTEXT && (is_robust || is_debug))
		c->handle = create(d, config, false, false);
	if (c->handle != EGL_NO_CONTEXT)
		return true;
	g_set_error(error, GLES_ERROR, GLES_ERROR_NONE,
		"its driver has no OpenGL ES 3.1 (eglCreateContext: %s)", egl_error_name(d->egl));
	return false;
}

bool gles_context_use(gles_context *c, GError **error)
{
	const struct egl_functions *egl = c->display->egl;
	if (egl->MakeCurrent(c->display->handle, EGL_NO_SURFACE, EGL_NO_SURFACE, c->handle))
		return true;
	g_set_error(error, GLES_ERROR, GLES_ERROR_NONE,
		"its driver cannot draw without a window (eglMakeCurrent: %s)",
		egl_error_name(egl));
	return false;
}

/* ---- what the driver says ---- */

static void GL_APIENTRY hear(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
	const GLchar *message, const void *user)
{
	(void)source, (void)id, (void)severity, (void)user;
	g_debug("OpenGL%s: %.*s", type == GL_DEBUG_TYPE_ERROR_KHR ? " error" : "", (int)length,
		message);
}

static void listen(gles_context *c)
{
	if (!c->gl.DebugMessageCallbackKHR || !debug_is_shown())
		return;
	c->gl.Enable(GL_DEBUG_OUTPUT_KHR);
	c->gl.DebugMessageCallbackKHR(hear, NULL);
}

bool gles_context_is_lost(const gles_context *c)
{
	if (c->gl.GetGraphicsResetStatusKHR)
		return c->gl.GetGraphicsResetStatusKHR() != GL_NO_ERROR;
	return c->gl.GetGraphicsResetStatusEXT && c->gl.GetGraphicsResetStatusEXT() != GL_NO_ERROR;
}

static const char *error_name(GLenum code)
{
	switch (code) {
	case GL_INVALID_ENUM: return "GL_INVALID_ENUM";
	case GL_INVALID_VALUE: return "GL_INVALID_VALUE";
	case GL_INVALID_OPERATION: return "GL_INVALID_OPERATION";
	case GL_INVALID_FRAMEBUFFER_OPERATION: return "GL_INVALID_FRAMEBUFFER_OPERATION";
	case GL_OUT_OF_MEMORY: return "GL_OUT_OF_MEMORY";
	case GL_CONTEXT_LOST_KHR: return "GL_CONTEXT_LOST";
	default: return "an unknown error";
	}
}

bool gles_context_check(const gles_context *c, const char *what, GError **error)
{
	GLenum first = c->gl.GetError();
	/* A lost context never runs out of them. */
	for (int i = 0; first != GL_NO_ERROR && i < 16 && c->gl.GetError() != GL_NO_ERROR; i++)
		;
	if (first == GL_NO_ERROR)
		return true;
	g_set_error(error, GLES_ERROR, GLES_ERROR_DRIVER, "while %s, OpenGL said %s", what,
		error_name(first));
	return false;
}

/* ---- together ---- */

gles_context *gles_context_open(const struct gles_about *found, GError **error)
{
	g_autoptr(gles_context) c = g_new0(gles_context, 1);
	GArray **stores[] = { &c->spent, &c->gone, &c->spare };
	for (size_t n = 0; n < G_N_ELEMENTS(stores); n++)
		*stores[n] = g_array_new(FALSE, FALSE, sizeof(struct gles_buffer));
	c->landing = g_new0(struct gles_buffer, 1);
	c->about.platform = found->platform;
	c->about.display = found->display;
	c->display = gles_display_get(found->platform, found->display, error);
	if (!c->display || !create_context(c, error) || !gles_context_use(c, error) ||
		!gles_functions_load(c->display->egl, &c->gl, error) ||
		!gles_about_fill(&c->about, &c->gl, error))
		return NULL;
	listen(c);
	return g_steal_pointer(&c);
}

void gles_context_free(gles_context *c)
{
	if (!c)
		return;
	if (c->handle != EGL_NO_CONTEXT) {
		const struct egl_functions *egl = c->display->egl;
		if (egl->GetCurrentContext() == c->handle)
			egl->MakeCurrent(
				c->display->handle, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
		egl->DestroyContext(c->display->handle, c->handle);
	}
	g_array_unref(c->spent);
	g_array_unref(c->gone);
	g_array_unref(c->spare);
	g_free(c->landing);
	g_free(c);
}
