#ifndef TESTS_GLES_HERE_H
#define TESTS_GLES_HERE_H
/* Whatever OpenGL ES there is, for tests of the gles backend: software is fine. */
#include "render/gles-draw.h"
#include "render/gles-probe.h"

static gles_context *gles_here_context;

/* NULL: there is none, and the test is skipped. */
static inline gles_context *gles_here(void)
{
	static struct gles_about found;
	static char *why;
	g_autoptr(GError) error = NULL;
	if (!why) {
		if (gles_context_probe(NULL, &found, &error)) {
			gles_here_context = gles_context_open(&found, &error);
			g_assert_no_error(error);
		}
		why = g_strdup(error ? error->message : "");
	}
	if (!gles_here_context)
		g_test_skip(why);
	return gles_here_context;
}

static inline gles_draw *gles_here_draw(void)
{
	g_autoptr(GError) error = NULL;
	gles_context *c = gles_here();
	gles_draw *d = c ? gles_draw_new(c, &error) : NULL;
	g_assert_no_error(error);
	return d;
}

#endif
