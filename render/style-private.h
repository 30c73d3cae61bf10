#ifndef RENDER_STYLE_PRIVATE_H
#define RENDER_STYLE_PRIVATE_H
/* What a style is made of inside. Nodes keep their JSON: what a change means, is known only where it is inherited to. */
#include "render/style-reader.h"

/* What a style says about the node of this name; const. */
struct style_node {
	char *key;
	JsonNode *json; /* an object of the document */
	style_document *document;
};
static inline const struct style_node *style_node_at(const style *s, guint i)
{
	return s->nodes->pdata[i];
}

/* The steps of a node, as they are inherited; the first is the mask, which is always there. Compared by their bytes. */
struct step_list {
	struct step steps[1 + PIPELINE_STEPS_MAX];
	uint32_t count;
	uint32_t mask_given; /* not the one of a pipeline without any */
};
void step_list_clear(struct step_list *list);
/* Adds the steps of a JSON list. */
bool step_list_read(struct step_list *list, style_reader *r, JsonNode *steps);
/* The parameters of the object that r is in, of another step than that, into step. */
bool step_list_read_change(struct step *step, style_reader *r, JsonNode *change);
/* What the node does to what it inherits. list holds nothing that counts after a failure. */
bool step_list_apply(struct step_list *list, const struct style_node *node, GError **error);
struct step *step_list_find(struct step_list *list, const char *id); /* NULL: none */

/* Refuses a node that cannot be, whatever it inherits. */
bool style_node_check(style_reader *r, const char *key, JsonNode *node);
/* Refuses what nothing of the style can be changed or removed by: for the site and the classes exactly, for things as far as it can
 * be told without their tree. */
bool style_check(const style *s, GError **error);

/* Where styles are looked for, the first counts; caller frees. */
GPtrArray *style_folders(const char *site_path);
/* A style on the way; those that are being loaded as its bases' users. */
struct style_loading {
	const char *site_path;
	const char *path; /* the file's true one */
	const struct style_loading *user;
};
style *style_load_in(
	const char *path, const char *site_path, const struct style_loading *user, GError **error);
style *style_find_in(const char *name, const char *folder, const char *site_path,
	const struct style_loading *user, GError **error);

#endif
