#ifndef RENDER_DRAWN_SITE_H
#define RENDER_DRAWN_SITE_H
/* A site that is drawn: its model, where scanners stood, its tree of segments, and its points in memory. What commands that draw
 * have in common. One owner; const once it is loaded. */
#include "render/frame.h"
#include "render/view-find.h"

typedef struct drawn_site drawn_site;
struct drawn_site {
	char *folder;
	site *site;
	model *model;
	bool is_look; /* a first look (process/model-look.h): 'pleinair process' has yet to make the model */
	GArray *stations; /* of struct view_station */
	view_boxes *boxes;
	struct view_sources sources; /* for view_find */
	segments *tree;              /* NULL: none was found yet */
	scene *scene;                /* NULL until drawn_site_load */
};
/* Without its points: to look for views. aspect is that of the pictures, width by height. Errors are of site_open, model_open and
 * view_stations. */
drawn_site *drawn_site_new(const char *folder, double aspect, GError **error);
/* How much memory the points of each site may take that is loaded from then on: "4G", "512M", a number of bytes. Until it is said, or NULL:
 * half of the machine's. More than that comes from the disk as it is looked at (scene-pager.h). Before there are threads. */
bool drawn_site_set_memory(const char *text, GError **error);
/* With points and segments. Errors are of segments_load and scene_new_within. */
bool drawn_site_load(drawn_site *d, GError **error);
void drawn_site_free(drawn_site *d); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(drawn_site, drawn_site_free)

/* Whether the drawing has profile lines, of which the site, which is loaded, has none. */
bool drawn_site_lacks_lines(const drawn_site *d, const drawing *how);
/* The style of that name, as this site's leaves are drawn in it. Errors are of style_find and drawing_new. */
drawing *drawn_site_style(const drawn_site *d, const char *style_name, GError **error);

#endif
