#ifndef RENDER_GLES_PROGRAMS_H
#define RENDER_GLES_PROGRAMS_H
/* All programs that draw frames. */
#include "render/gles-context.h"

enum gles_use {
	GLES_CLEAR,
	GLES_MASK,
	GLES_HOLES,
	GLES_DEEPEST,
	GLES_HIDE,
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
	/* What follows is made when it is first wanted. */
	GLES_LATER,
	GLES_FILTER_FINISH = GLES_LATER,
	GLES_FILTER_BLUR,
	GLES_FILTER_NUMBERS,
	GLES_FILTER_FLOW,
	GLES_FILTER_TRACE,
	GLES_FILTER_NOISE,
	GLES_FILTER_WAVES,
	GLES_FILTER_KUWAHARA,
	GLES_FILTER_ANISOTROPIC,
	GLES_FILTER_BILATERAL,
	GLES_FILTER_GAPS,
	GLES_FILTER_QUANTISE,
	GLES_FILTER_DOG,
	GLES_FILTER_EDGES,
	GLES_FILTER_WATERCOLOUR,
	GLES_FILTER_OIL,
	GLES_FILTER_PENCIL,
	GLES_FILTER_GRADE,
	GLES_FILTER_WARP,
	GLES_FILTER_SHADE,
	GLES_FILTER_INPAINT,
	GLES_SPRITES_PUT, /* strokes whose ink is summed up (gles-ink.h) */
	GLES_LINES_PUT,
	GLES_STROKES_PUT,
	GLES_COMBINE_SUMS,
	GLES_PROFILE_SEE, /* profile lines */
	GLES_PROFILE_WRITE,
	GLES_PLANE_MASK, /* plane surfaces */
	GLES_PLANE_POINTS,
	GLES_PLANE_SURFACE,
	GLES_SHEET_SURFACE, /* sheets, and what becomes of them */
	GLES_SHEET_TAKE,
	GLES_SHEET_MERGE,
	GLES_SHEET_JOIN,
	GLES_SHEET_KEYS,
	GLES_SHEET_GROUND,
	GLES_USES
};

bool gles_programs_make(const gles_context *c, GLuint ret[GLES_USES], GError **error);
/* One of those behind GLES_LATER, if it is not there yet. */
bool gles_programs_want(
	const gles_context *c, GLuint programs[GLES_USES], enum gles_use use, GError **error);
void gles_programs_clear(const gles_context *c, GLuint programs[GLES_USES]);

#endif
