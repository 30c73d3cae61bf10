#ifndef RENDER_GLES_PROGRAMS_H
#define RENDER_GLES_PROGRAMS_H
/* All programs that draw frames. */
#include "render/gles-context.h"

enum gles_use {
	GLES_CLEAR,
	GLES_MASK,
	GLES_HOLES,
	GLES_POINTS,
	GLES_COUNT, /* choosing strokes */
	GLES_SCAN,
	GLES_WRITE,
	GLES_SPRITES,
	GLES_LINES,
	GLES_STROKES,
	GLES_GROUND,
	GLES_COMBINE,
	GLES_OUT,
	GLES_USES
};

bool gles_programs_make(const gles_context *c, GLuint ret[GLES_USES], GError **error);
void gles_programs_clear(const gles_context *c, GLuint programs[GLES_USES]);

#endif
