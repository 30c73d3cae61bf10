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
	GLES_STIPPLE_PUT, /* and the rest of stippling */
	GLES_STIPPLE_SPREAD,
	GLES_STIPPLE_ASK,
	GLES_STIPPLE_TREE,
	GLES_STIPPLE_DECIDE,
	GLES_STIPPLE_COUNT,
	GLES_STIPPLE_WRITE,
	GLES_USES
};

bool gles_programs_make(const gles_context *c, GLuint ret[GLES_USES], GError **error);
void gles_programs_clear(const gles_context *c, GLuint programs[GLES_USES]);

#endif
