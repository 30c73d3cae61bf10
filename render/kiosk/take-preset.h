#ifndef RENDER_KIOSK_TAKE_PRESET_H
#define RENDER_KIOSK_TAKE_PRESET_H
/* Sizes and forms that a site is taken home in, and the options of the job that makes one. Without GTK. */
#include "render/kiosk/exports.h"

struct take_preset {
	const char *id;     /* for names of files and widgets */
	const char *label;  /* to be translated */
	const char *ending; /* of the file */
	const char *size;   /* in pixels, or on paper; NULL: the command's own */
	double dpi;         /* on paper; 0: the command's own */
	const char *path;   /* the camera's way, of films */
	double spacing_m;   /* of points, thinned out; 0: all of them */
};
/* Of EXPORT_PICTURE, EXPORT_DRAWING, EXPORT_FILM, EXPORT_REPORT and EXPORT_POINTS; ends with a row without id. The first is what is offered when
 * nobody has chosen. */
const struct take_preset *take_presets(enum export_kind kind);
/* NULL: the kind has none of that id. */
const struct take_preset *take_preset_find(enum export_kind kind, const char *id);

/* "figure-7d-overview-a4": a name that tells what it is; caller frees. */
char *take_stem(
	enum export_kind kind, const struct take_preset *p, const char *style, const char *seen);
/* "render", "report" or "export": the job's kind. */
const char *take_job(enum export_kind kind);
/* Its options (a{sv}), floating. */
GVariant *take_options(enum export_kind kind, const struct take_preset *p, const char *style,
	const char *seen, const char *output);

#endif
