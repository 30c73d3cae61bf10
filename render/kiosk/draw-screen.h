#ifndef RENDER_KIOSK_DRAW_SCREEN_H
#define RENDER_KIOSK_DRAW_SCREEN_H
/* What the parts of the screen Draw share: the picture (screen-draw.c), the strip of styles (draw-strip.c), and the panel that changes
 * how a thing is drawn (draw-panel.c). */
#include "render/kiosk/easel.h"
#include "render/kiosk/kiosk.h"
#include "render/style-edit.h"

struct draw_screen {
	kiosk *kiosk;
	char *folder;
	GtkWidget *widget, *stack; /* the stack: "wait", "draw", "nothing" */
	GtkWidget *wait_text, *nothing_text;
	GCancellable *gone;
	drawn_site *site;
	easel *easel;
	/* The strip. */
	GtkWidget *strip;
	char **names;        /* of styles */
	GPtrArray *pictures; /* GtkPicture of each, not owned */
	char *style_name;
	style_edit *edit; /* of that style */
	/* The panel. */
	GtkWidget *panel, *panel_box;
	uint32_t node;   /* of the tree: what is changed; SEGMENT_SITE: all */
	uint32_t leaf;   /* that was tapped; 0: none */
	char *last_slid; /* what the last change was of, so that one slide is one undo */
	int64_t last_slid_us;
	/* The walk. */
	guint station; /* that is stood at, from 1; 0: none */
	GtkWidget *around;
};

/* The style as it is changed now is drawn; passing: a slider moves. */
void draw_screen_redraw(struct draw_screen *s, bool passing);
/* The edit as a text, so that it can be taken back: call before a change. did is said to people. */
void draw_screen_will_change(struct draw_screen *s, const char *did);
/* As style files name the node. */
const char *draw_screen_node_key(const struct draw_screen *s, char buffer[32]);

/* ---- draw-strip.c ---- */
GtkWidget *draw_strip_new(struct draw_screen *s);
void draw_strip_fill(struct draw_screen *s); /* buttons for all styles that there are now */
void draw_strip_got_small(struct draw_screen *s, uint32_t n, const struct artist_picture *p);
void draw_screen_use_style(struct draw_screen *s, const char *name); /* for all */

/* ---- draw-panel.c ---- */
GtkWidget *draw_panel_new(struct draw_screen *s);
void draw_panel_show(struct draw_screen *s, bool visible);
/* Of the leaf that was tapped, or of all (0). */
void draw_panel_select(struct draw_screen *s, uint32_t leaf);
void draw_panel_fill(struct draw_screen *s);
void draw_panel_marks(struct draw_screen *s, cairo_t *cr, const struct camera *c);

#endif
