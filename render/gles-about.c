#include "render/gles-about.h"
#include <string.h>

G_DEFINE_QUARK(gles - error - quark, gles_error)

const char *const gles_platform_names[GLES_PLATFORMS] = { "surfaceless", "device", "gbm" };

bool gles_renderer_is_software(const char *renderer)
{
	static const char *const names[] = { "llvmpipe", "softpipe", "swiftshader", "swrast",
		"lavapipe", "software rasterizer", "basic render driver" };
	g_autofree char *lower = g_ascii_strdown(renderer, -1);
	for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
		if (strstr(lower, names[i]))
			return true;
	return false;
}

char *gles_about_text(const struct gles_about *a)
{
	/* NVIDIA's ends in "/PCIe/SSE2". */
	const char *bus = strstr(a->renderer, "/PCI");
	int length = bus ? (int)(bus - a->renderer) : (int)strlen(a->renderer);
	return g_strdup_printf("%.*s, OpenGL ES %d.%d by EGL %s", length, a->renderer, a->major,
		a->minor, gles_platform_names[a->platform]);
}
