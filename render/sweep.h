#ifndef RENDER_SWEEP_H
#define RENDER_SWEEP_H
/* One parameter of a style, taken through several values, so that what it does can be seen: a row of pictures. As text a sweep is
 *
 *     STYLES[:NAME=VALUES[;NAME=VALUES...]]          TITLE | CAPTION | the same
 *
 * with commas between several styles or values. NAME is STEP.PARAMETER, where STEP is the id of a step of the site, or a section of the
 * style ("light"); or "view", from where; or "site", which of several sites. What has one value has it in all pictures; all that have
 * more have as many, and go along with each other. A value is written as in style files, quotes of a text left out; of lists and of
 * what is in quotes the commas do not count. "-" leaves it as the style has it, "@OTHER" takes that of another style.
 *
 * Const once made. */
#include "render/style.h"

#define SWEEP_VALUES_MAX 60u
typedef struct sweep sweep;
struct sweep {
	char *title, *caption; /* caption may be "" */
	char *name;            /* for files: the title's letters and digits */
	GPtrArray *parameters; /* of struct sweep_parameter; the first is "style" */
	guint count;           /* of values */
};
struct sweep_parameter {
	char *name;
	GPtrArray *values; /* of char * */
};
/* Errors: STYLE_ERROR_FIELD, one sentence. Whether there are such styles and parameters is asked by sweep_style. */
sweep *sweep_new(const char *text, GError **error);
void sweep_free(sweep *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(sweep, sweep_free)

/* NULL: the sweep does not say. */
const char *sweep_value(const sweep *s, const char *name, guint i);
bool sweep_has_site(const sweep *s, const char *name); /* also where it names none */
/* What changes, "length_px 12, cross 1"; and what stays, "pencil, hatching.cross 0"; caller frees. */
char *sweep_label(const sweep *s, guint i);
char *sweep_fixed(const sweep *s);
/* The style of value i. Errors tell the parameter, and what it may be. */
style *sweep_style(const sweep *s, guint i, const char *site_path, GError **error);

#endif
