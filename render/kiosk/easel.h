#ifndef RENDER_KIOSK_EASEL_H
#define RENDER_KIOSK_EASEL_H
/* A drawn site in a widget, which fingers turn: one goes round, two shift, pinch and twist, a double tap looks at what is there. What
 * a tap means is its owner's affair. Main thread. */
#include "render/drawn-site.h"
#include "render/kiosk/artist.h"
#include "render/kiosk/canvas.h"
#include "render/kiosk/looking.h"
#include "render/scene-pick.h"

struct easel_watcher {
	/* A picture is on the screen; the first one, and each after. pictures as artist_picture has it. */
	void (*shown)(const struct artist_picture *p, gpointer user_data);
	void (*small)(uint32_t n, const struct artist_picture *p, gpointer user_data);
	/* picked NULL: there is nothing. */
	void (*tapped)(const struct scene_picked *picked, gpointer user_data);
	/* One finger; true: it was its owner's, and the view stays. May be NULL. */
	bool (*dragged)(double right_px, double down_px, gpointer user_data);
	void (*failed)(const char *sentence, gpointer user_data);
	/* To mark things on the picture: with its camera. May be NULL. */
	void (*marks)(cairo_t *cr, const struct camera *c, gpointer user_data);
	gpointer user_data;
};

typedef struct easel easel;
easel *easel_new(const char *name, enum backend_wish backend, const struct easel_watcher *watcher);
/* Before its widget goes. NULL is fine. */
void easel_free(easel *e);
GtkWidget *easel_widget(easel *e);

/* Loaded; must live until easel_free, or until another one is set. */
void easel_set_site(easel *e, const drawn_site *d);
/* Takes d. passing: more will follow at once, so it is drawn as a moving view is. */
void easel_set_drawing(easel *e, drawing *d, bool passing);
/* Another light and focus than the drawing's, until another drawing is set; a finger moves them. */
void easel_set_accents(easel *e, const struct style_light *light, const struct style_focus *focus);
void easel_set_small(easel *e, GPtrArray *drawings, uint32_t width, uint32_t height);
/* Goes there, within seconds (0: at once). */
void easel_look(easel *e, const struct looking *to, double seconds);
/* Where it looks, or goes to. */
struct looking easel_looking(const easel *e);
struct camera easel_camera(const easel *e); /* of what it shows now; width 0: not yet laid out */
const char *easel_why(const easel *e);      /* painter's line; NULL: not yet known */
void easel_redraw_marks(easel *e);

#endif
