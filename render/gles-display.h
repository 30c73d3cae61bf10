#ifndef RENDER_GLES_DISPLAY_H
#define RENDER_GLES_DISPLAY_H
/* A display of EGL without a window: what a context is made on. One of each number lives in a process at most, and lives until
 * the process ends: EGL knows it once however often it is asked for, and drivers leak and crash when they are ended. Any thread.
 * Errors are GLES_ERROR_NONE, a sentence that goes on from "by surfaceless, ". */
#include "render/gles-about.h"
#include "render/gles-functions.h"

struct gles_display {
	const struct egl_functions *egl;
	EGLDisplay handle;
	const char *extensions; /* of the display, separated by blanks */
	enum gles_platform platform;
	uint32_t number;
};

#define GLES_DISPLAYS_MAX 32u

/* The numbers of a platform's displays in the order in which they should be tried, at least one; how many. 0: error says why. */
unsigned gles_display_list(
	enum gles_platform platform, uint32_t ret_number[GLES_DISPLAYS_MAX], GError **error);

/* The first time, it runs the driver's initialisation, which is where a broken one crashes: gles-probe.h does it in a child
 * before. Not to be freed. */
const struct gles_display *gles_display_get(
	enum gles_platform platform, uint32_t number, GError **error);

#endif
