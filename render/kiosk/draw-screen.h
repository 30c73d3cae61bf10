#ifndef RENDER_KIOSK_DRAW_SCREEN_H
#define RENDER_KIOSK_DRAW_SCREEN_H
/* What the parts of the screen Draw share: the picture (screen-draw.c), the strip of styles (draw-strip.c), the panel that changes how a
 * thing is drawn (draw-panel.c), and light and focus by touch (draw-accents.c), and where one looks from (draw-views.c). */
#include "render/kiosk/easel.h"
#include "render/kiosk/kiosk.h"
#include "render/style-edit.h"

/* What one finger moves. */
enum draw_tool { DRAW_LOOK, DRAW_LIGHT, DRAW_FOCUS };

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
	bool strip_is_new; /* the style that is drawn is not where one looks yet */
	guint strip_timer;
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
	/* Light and focus. */
	enum draw_tool tool;
	GtkWidget *light_button, *focus_button, *tool_bar, *tool_hint;
	struct style_whole whole; /* of the edit, while there is a tool */
	/* The focus is on its way, in steps. */
	guint glide, glide_step;
	struct style_whole glide_from, glide_to;
	/* The walk. */
	guint station; /* that is stood at, from 1; 0: none */
	GtkWidget *around;
};

/* The style as it is changed now is drawn; passing: a slider moves. */
void draw_screen_redraw(struct draw_screen *s, bool passing);
/* The edit as a text, so that it can be taken back: call before a change. did is said to people. */
void draw_screen_will_change(struct draw_screen *s, const char *did);
/* The same for what a finger slides: changes of one kind that follow each other soon are taken back together. */
void draw_screen_will_slide(struct draw_screen *s, const char *what, const char *did);
/* As style files name the node. */
const char *draw_screen_node_key(const struct draw_screen *s, char buffer[32]);

/* ---- draw-strip.c ---- */
GtkWidget *draw_strip_new(struct draw_screen *s);
void draw_strip_fill(struct draw_screen *s); /* buttons for all styles that there are now */
void draw_strip_got_small(struct draw_screen *s, uint32_t n, const struct artist_picture *p);
void draw_screen_use_style(struct draw_screen *s, const char *name); /* for all */

/* ---- draw-accents.c ---- */
GtkWidget *draw_accents_tools(struct draw_screen *s);
GtkWidget *draw_accents_bar(struct draw_screen *s); /* what the finger does now */
/* true: it was meant for the light or the focus. */
bool draw_accents_tapped(struct draw_screen *s, const struct scene_picked *picked);
bool draw_accents_dragged(struct draw_screen *s, double right_px, double down_px);
void draw_accents_marks(struct draw_screen *s, cairo_t *cr, const struct camera *c);
/* One finger looks around again. */
void draw_accents_end(struct draw_screen *s);
/* A focus that is on its way goes no farther. */
void draw_accents_stop(struct draw_screen *s);
/* After the edit has changed otherwise. */
void draw_accents_refresh(struct draw_screen *s);

/* ---- draw-views.c ---- */
GtkWidget *draw_views_tools(struct draw_screen *s);
/* A built-in view; mode: of one in perspective. */
void draw_views_look_from(
	struct draw_screen *s, const char *name, enum looking_mode mode, double seconds);

/* ---- draw-panel.c ---- */
GtkWidget *draw_panel_new(struct draw_screen *s);
void draw_panel_show(struct draw_screen *s, bool visible);
void draw_panel_close(struct draw_screen *s); /* and nothing is selected */
/* Of the leaf that was tapped, or of all (0). */
void draw_panel_select(struct draw_screen *s, uint32_t leaf);
void draw_panel_fill(struct draw_screen *s);
void draw_panel_marks(struct draw_screen *s, cairo_t *cr, const struct camera *c);

#endif
