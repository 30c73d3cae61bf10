#ifndef RENDER_KIOSK_CANVAS_H
#define RENDER_KIOSK_CANVAS_H
/* A widget that shows one picture, as large as it is, and tells what fingers do on it. With a mouse: left drags, right or middle pans,
 * the wheel zooms; with keys: arrows drag, + and - zoom, Page Up and Down twist. Lengths are in the picture's pixels (those of the
 * screen), places from its left upper corner. Main thread. */
#include "render/kiosk/kit.h"

struct canvas_watcher {
	void (*resized)(uint32_t width, uint32_t height, gpointer user_data);
	/* One finger; two fingers. */
	void (*drag)(double right_px, double down_px, gpointer user_data);
	void (*pan)(double right_px, double down_px, gpointer user_data);
	/* Factor and angle since the last call; the place is between the fingers. */
	void (*zoom)(double factor, double x, double y, gpointer user_data);
	void (*twist)(double angle_rad, gpointer user_data);
	/* What fingers began has come to its end. */
	void (*rest)(gpointer user_data);
	void (*tap)(double x, double y, gpointer user_data);
	void (*double_tap)(double x, double y, gpointer user_data);
	/* Held at one place. */
	void (*hold)(double x, double y, gpointer user_data);
	gpointer user_data;
};

G_DECLARE_FINAL_TYPE(PleinairCanvas, canvas, PLEINAIR, CANVAS, GtkWidget)
GtkWidget *canvas_new(const char *name, const char *label, const struct canvas_watcher *watcher);
/* Shown from the next frame on, scaled to the widget; rows of blue, green, red and a fourth byte that is 255. */
void canvas_show(GtkWidget *canvas, GBytes *bgrx, uint32_t width, uint32_t height);
/* Of the screen, 0 before it is laid out. */
uint32_t canvas_width_px(GtkWidget *canvas);
uint32_t canvas_height_px(GtkWidget *canvas);
/* Called after the picture is drawn, to mark things on it; in the picture's pixels of the size above. NULL: nothing is. */
void canvas_set_marks(GtkWidget *canvas,
	void (*draw)(cairo_t *cr, double width, double height, gpointer user_data),
	gpointer user_data);
/* No callback comes any more: their owner goes before the widget. */
void canvas_forget(GtkWidget *canvas);
GdkTexture *canvas_texture(GBytes *bgrx, uint32_t width, uint32_t height); /* caller unrefs */

#endif
