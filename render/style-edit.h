#ifndef RENDER_STYLE_EDIT_H
#define RENDER_STYLE_EDIT_H
/* A style of one's own: what a person changes of another one, for the site, a class, or a thing. As text it is a style file, so an
 * earlier text is all that undoing needs. Nodes are named as in style files: "site", "vegetation", "#19". One owner. */
#include "acquire/site.h"
#include "render/style.h"
#include <json-glib/json-glib.h>

typedef struct style_edit style_edit;
/* On this style: one that the site's folder of styles has is gone on with, another becomes the base of a new one. */
style_edit *style_edit_new(const char *style_name, const char *site_path, GError **error);
/* Takes back a text of style_edit_text. */
style_edit *style_edit_parse(const char *text, GError **error);
void style_edit_free(style_edit *e); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(style_edit, style_edit_free)

/* Gives one parameter of the step with this id a value; takes value. */
void style_edit_change(style_edit *e, const char *node, const char *step_id, const char *parameter,
	JsonNode *value);
/* The same of a section of the whole picture: "light" (style_sections); takes value. */
void style_edit_set(style_edit *e, const char *section, const char *parameter, JsonNode *value);
/* The light and the focus that the other one says, where this one says none. */
void style_edit_take_accents(style_edit *e, const style_edit *from);
/* The node has these steps (of struct step), whatever it would inherit; none: it is not drawn. */
void style_edit_set_steps(style_edit *e, const char *node, const GArray *steps);
/* The node is as the base has it. */
void style_edit_reset(style_edit *e, const char *node);

/* Caller frees. */
char *style_edit_text(const style_edit *e);
style *style_edit_style(const style_edit *e, const char *site_path, GError **error);
/* Writes SITE/styles/NAME.json, NAME made of the title's letters, and no name of another style; *ret_name is freed by the caller.
 * Refuses what would not be a style. */
bool style_edit_save(const style_edit *e, const char *site_path, const char *title, char **ret_name,
	GError **error);

#endif
