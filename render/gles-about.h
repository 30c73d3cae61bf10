#ifndef RENDER_GLES_ABOUT_H
#define RENDER_GLES_ABOUT_H
/* What an OpenGL ES 3.1 context says about itself: who made it, whether it is a processor in disguise, what it can hold. Flat,
 * without pointers, so that a child can send it to its parent as it is (gles-probe.h). Needs no OpenGL header. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

/* The ways to a context without a window, in the order in which they are tried. */
enum gles_platform {
	GLES_SURFACELESS, /* EGL_MESA_platform_surfaceless: Mesa, on any machine */
	GLES_DEVICE,      /* EGL_EXT_platform_device: NVIDIA without a display server */
	GLES_GBM,         /* EGL_KHR_platform_gbm: render nodes, /dev/dri/renderD* */
	GLES_PLATFORMS
};
extern const char *const gles_platform_names[GLES_PLATFORMS]; /* "surfaceless", "device", "gbm" */

struct gles_limits {
	int32_t texture_size, renderbuffer_size, viewport_size,
		samples; /* pixels on a side; samples a pixel */
	int32_t colour_outputs, texture_units, vertex_attributes;
	int32_t group_invocations, group_size[3], groups[3], shared_bytes; /* compute */
	int32_t storage_blocks, vertex_storage_blocks, fragment_storage_blocks, storage_alignment;
	int32_t uniform_block_bytes, uniform_alignment;
	int64_t storage_block_bytes;
	float point_size, line_width; /* pixels */
};

struct gles_about {
	enum gles_platform platform;
	uint32_t display; /* which of the platform's: a device's index, a render node's number */
	int32_t major, minor;
	char vendor[64], renderer[128], version[128];
	bool is_software; /* llvmpipe and the like: backend cpu does the same work many times faster */
	struct gles_limits limits;
	bool has_float_blend;       /* blending into RGBA32F */
	bool has_half_float_colour; /* drawing into RGBA16F */
	bool has_float_colour;      /* drawing into RGBA32F */
	bool has_float_linear;      /* filtering RGBA32F */
	bool has_image_atomic, has_timer, has_buffer_storage, has_program_binary;
	bool has_reset_status; /* gles_context_is_lost can tell */
};

#define GLES_ERROR (gles_error_quark())
enum gles_error {
	GLES_ERROR_NONE,    /* there is no OpenGL ES 3.1 here, or it may not be used */
	GLES_ERROR_DRIVER,  /* there is, but it crashes, hangs, or draws something else */
	GLES_ERROR_COMPILE, /* a shader that the compiler refuses */
	GLES_ERROR_LIMIT    /* a shader that small boards would refuse */
};
GQuark gles_error_quark(void);

/* By the names that software renderers have. */
bool gles_renderer_is_software(const char *renderer);
/* "NVIDIA H200, OpenGL ES 3.2 by EGL device"; the caller frees it. */
char *gles_about_text(const struct gles_about *a);

#endif
