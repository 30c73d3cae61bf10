#include "render/kiosk/pick-pane.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

/* A finger that begins so near to a mark means it; one that goes no further than SLACK_PX taps. */
#define REACH_PX 34
#define SLACK_PX 12
#define ZOOM_MAX 24.0
#define LOUPE_PX 92.0 /* its radius */
#define LOUPE    4.0
/* A mark goes so much slower than the finger. */
#define CARE    0.3
#define DISC_PX 15.0
#define NO_MARK G_MAXUINT
/* The cross of keys moves so far at a time, and stays so far from the pane's border. */
#define KEY_STEP_PX 24
#define CURSOR_PX   40

struct pane {
	struct pick_pane_watcher watcher;
	GtkWidget *area;
	cairo_surface_t *picture; /* NULL: none yet */
	uint32_t columns, rows;
	GArray *marks; /* of struct pick_mark */
	/* What is seen: pixels of the screen a cell, and the cell in the middle. */
	double scale, column, row;
	/* Under a finger. */
	guint held; /* of the marks; NO_MARK */
	double held_column, held_row, start_x, start_y, start_column, start_row, start_scale;
	bool moved;
	/* Of keys, once one was used there; column and row as of the middle. */
	bool has_cursor;
	double cursor_column, cursor_row;
};

static struct pane *pane_of(GtkWidget *area)
{
	return g_object_get_data(G_OBJECT(area), "pane");
}

/* ---- places ---- */

static double least_scale(const struct pane *p)
{
	double wide = gtk_widget_get_width(p->area);
	if (!p->columns || wide < 1)
		return 1;
	return wide / p->columns;
}

static void stay_inside(struct pane *p)
{
	double least = least_scale(p), high = gtk_widget_get_height(p->area);
	p->scale = CLAMP(p->scale, least, least * ZOOM_MAX);
	double half = high / 2 / p->scale;
	p->row = half * 2 >= p->rows ? p->rows / 2.0 : CLAMP(p->row, half, p->rows - half);
	p->column = fmod(fmod(p->column, p->columns) + p->columns, p->columns);
}

/* The nearest of all turns. */
static double around(const struct pane *p, double columns)
{
	return columns - p->columns * round(columns / p->columns);
}

static void to_screen(const struct pane *p, double column, double row, double *x, double *y)
{
	*x = gtk_widget_get_width(p->area) / 2.0 + around(p, column - p->column) * p->scale;
	*y = gtk_widget_get_height(p->area) / 2.0 + (row - p->row) * p->scale;
}

static void to_cell(const struct pane *p, double x, double y, double *column, double *row)
{
	double c = p->column + (x - gtk_widget_get_width(p->area) / 2.0) / p->scale;
	*column = fmod(fmod(c, p->columns) + p->columns, p->columns);
	*row = CLAMP(
		p->row + (y - gtk_widget_get_height(p->area) / 2.0) / p->scale, 0, p->rows - 1e-6);
}

static guint mark_near(const struct pane *p, double x, double y)
{
	guint nearest = NO_MARK;
	double best = REACH_PX;
	for (guint i = 0; i < p->marks->len; i++) {
		const struct pick_mark *m = &g_array_index(p->marks, struct pick_mark, i);
		double mx, my;
		to_screen(p, m->column + 0.5, m->row + 0.5, &mx, &my);
		double d = hypot(mx - x, my - y);
		if (d < best) {
			best = d;
			nearest = i;
		}
	}
	return nearest;
}

/* ---- drawing ---- */

/* The turn of the picture that is in the middle, and those beside it. */
static void paint_picture(const struct pane *p, cairo_t *cr, double column, double row,
	double scale, double x, double y, cairo_filter_t filter)
{
	for (int turn = -1; turn <= 1; turn++) {
		cairo_save(cr);
		cairo_translate(cr, x, y);
		cairo_scale(cr, scale, scale);
		cairo_translate(cr, turn * (double)p->columns - column, -row);
		cairo_set_source_surface(cr, p->picture, 0, 0);
		cairo_pattern_set_filter(cairo_get_source(cr), filter);
		cairo_rectangle(cr, 0, 0, p->columns, p->rows);
		cairo_fill(cr);
		cairo_restore(cr);
	}
}

static void set_colour(cairo_t *cr, const struct pick_mark *m)
{
	if (m->bad)
		cairo_set_source_rgb(cr, 0.78, 0.1, 0.1);
	else if (m->alone)
		cairo_set_source_rgb(cr, 0.85, 0.45, 0);
	else
		cairo_set_source_rgb(cr, 0.04, 0.36, 0.34);
}

static void paint_number(cairo_t *cr, double x, double y, uint32_t number)
{
	g_autofree char *text = g_strdup_printf("%u", number);
	cairo_text_extents_t e;
	cairo_set_font_size(cr, 17);
	cairo_text_extents(cr, text, &e);
	cairo_move_to(cr, x - e.width / 2 - e.x_bearing, y - e.height / 2 - e.y_bearing);
	cairo_set_source_rgb(cr, 1, 1, 1);
	cairo_show_text(cr, text);
}

/* A ring around the place, and the number beside it: what is picked stays visible. */
static void paint_mark(const struct pane *p, cairo_t *cr, const struct pick_mark *m)
{
	double x, y;
	to_screen(p, m->column + 0.5, m->row + 0.5, &x, &y);
	cairo_new_path(cr);
	cairo_arc(cr, x, y, m->selected ? 11 : 8, 0, 2 * G_PI);
	cairo_set_line_width(cr, 6);
	cairo_set_source_rgb(cr, 1, 1, 1);
	cairo_stroke_preserve(cr);
	cairo_set_line_width(cr, 3);
	set_colour(cr, m);
	cairo_stroke(cr);
	double down = y > 50 ? -26 : 26;
	cairo_arc(cr, x, y + down, DISC_PX, 0, 2 * G_PI);
	cairo_set_source_rgb(cr, 1, 1, 1);
	cairo_set_line_width(cr, 4);
	cairo_stroke_preserve(cr);
	set_colour(cr, m);
	cairo_fill(cr);
	paint_number(cr, x, y + down, m->number);
}

static const struct pick_mark *looked_at(const struct pane *p)
{
	if (p->held != NO_MARK)
		return &g_array_index(p->marks, struct pick_mark, p->held);
	for (guint i = 0; i < p->marks->len; i++)
		if (g_array_index(p->marks, struct pick_mark, i).selected)
			return &g_array_index(p->marks, struct pick_mark, i);
	return NULL;
}

/* In the corner that is further from the mark. */
static void paint_loupe(const struct pane *p, cairo_t *cr, const struct pick_mark *m)
{
	double x, y, wide = gtk_widget_get_width(p->area);
	to_screen(p, m->column + 0.5, m->row + 0.5, &x, &y);
	double lx = x < wide / 2 ? wide - LOUPE_PX - 10 : LOUPE_PX + 10, ly = LOUPE_PX + 10;
	double scale = MAX(p->scale * LOUPE, 8);
	cairo_save(cr);
	cairo_arc(cr, lx, ly, LOUPE_PX, 0, 2 * G_PI);
	cairo_clip_preserve(cr);
	cairo_set_source_rgb(cr, 0, 0, 0);
	cairo_fill(cr);
	paint_picture(p, cr, m->column + 0.5, m->row + 0.5, scale, lx, ly, CAIRO_FILTER_NEAREST);
	set_colour(cr, m);
	cairo_set_line_width(cr, 2);
	cairo_move_to(cr, lx - LOUPE_PX, ly);
	cairo_line_to(cr, lx - scale, ly);
	cairo_move_to(cr, lx + scale, ly);
	cairo_line_to(cr, lx + LOUPE_PX, ly);
	cairo_move_to(cr, lx, ly - LOUPE_PX);
	cairo_line_to(cr, lx, ly - scale);
	cairo_move_to(cr, lx, ly + scale);
	cairo_line_to(cr, lx, ly + LOUPE_PX);
	cairo_stroke(cr);
	cairo_rectangle(cr, lx - scale / 2, ly - scale / 2, scale, scale);
	cairo_stroke(cr);
	cairo_restore(cr);
	cairo_arc(cr, lx, ly, LOUPE_PX, 0, 2 * G_PI);
	cairo_set_line_width(cr, 4);
	cairo_set_source_rgb(cr, 1, 1, 1);
	cairo_stroke_preserve(cr);
	cairo_set_line_width(cr, 2);
	cairo_set_source_rgb(cr, 0.1, 0.1, 0.1);
	cairo_stroke(cr);
}

static bool shows_cursor(const struct pane *p)
{
	return p->has_cursor && gtk_widget_has_focus(p->area);
}

static void paint_cursor(const struct pane *p, cairo_t *cr)
{
	double x, y;
	to_screen(p, p->cursor_column, p->cursor_row, &x, &y);
	for (int white = 1; white >= 0; white--) {
		for (int k = 0; k < 4; k++) {
			double right = k == 0 ? 1 : k == 1 ? -1 : 0;
			double down = k == 2 ? 1 : k == 3 ? -1 : 0;
			cairo_move_to(cr, x + 6 * right, y + 6 * down);
			cairo_line_to(cr, x + 24 * right, y + 24 * down);
		}
		cairo_set_line_width(cr, white ? 6 : 2.5);
		cairo_set_source_rgb(cr, white, white, white);
		cairo_stroke(cr);
	}
}

static void draw(GtkDrawingArea *area, cairo_t *cr, int width, int height, gpointer user_data)
{
	struct pane *p = user_data;
	(void)area;
	cairo_set_source_rgb(cr, 0.16, 0.16, 0.16);
	cairo_paint(cr);
	if (!p->picture)
		return;
	if (!(p->scale > 0))
		p->scale = least_scale(p);
	stay_inside(p);
	paint_picture(
		p, cr, p->column, p->row, p->scale, width / 2.0, height / 2.0, CAIRO_FILTER_GOOD);
	for (guint i = 0; i < p->marks->len; i++)
		paint_mark(p, cr, &g_array_index(p->marks, struct pick_mark, i));
	if (shows_cursor(p)) {
		struct pick_mark at = { .column = (uint32_t)p->cursor_column,
			.row = (uint32_t)p->cursor_row };
		paint_cursor(p, cr);
		paint_loupe(p, cr, &at);
		return;
	}
	const struct pick_mark *m = looked_at(p);
	if (m)
		paint_loupe(p, cr, m);
}

/* ---- fingers ---- */

static void drag_begin(GtkGestureDrag *g, double x, double y, gpointer user_data)
{
	struct pane *p = user_data;
	(void)g;
	p->moved = p->has_cursor = false;
	p->start_x = x;
	p->start_y = y;
	p->start_column = p->column;
	p->start_row = p->row;
	p->held = p->picture ? mark_near(p, x, y) : NO_MARK;
	if (p->held == NO_MARK)
		return;
	const struct pick_mark *m = &g_array_index(p->marks, struct pick_mark, p->held);
	p->held_column = m->column + 0.5;
	p->held_row = m->row + 0.5;
}

static void tell_moved(struct pane *p, double right, double down, bool last)
{
	struct pick_mark *m = &g_array_index(p->marks, struct pick_mark, p->held);
	double c = p->held_column + right * CARE / p->scale;
	double r = p->held_row + down * CARE / p->scale;
	m->column = (uint32_t)fmod(fmod(c, p->columns) + p->columns, p->columns);
	m->row = (uint32_t)CLAMP(r, 0, p->rows - 1);
	if (p->watcher.mark_moved)
		p->watcher.mark_moved(m->number, m->column, m->row, last, p->watcher.user_data);
}

static void drag_update(GtkGestureDrag *g, double right, double down, gpointer user_data)
{
	struct pane *p = user_data;
	(void)g;
	p->moved = p->moved || hypot(right, down) > SLACK_PX;
	if (!p->moved || !p->picture)
		return;
	if (p->held != NO_MARK)
		tell_moved(p, right, down, false);
	else {
		p->column = p->start_column - right / p->scale;
		p->row = p->start_row - down / p->scale;
		stay_inside(p);
	}
	gtk_widget_queue_draw(p->area);
}

static void tap(struct pane *p, double x, double y)
{
	double column, row;
	if (p->held != NO_MARK) {
		if (p->watcher.mark_tapped)
			p->watcher.mark_tapped(
				g_array_index(p->marks, struct pick_mark, p->held).number,
				p->watcher.user_data);
		return;
	}
	to_cell(p, x, y, &column, &row);
	if (p->watcher.tapped)
		p->watcher.tapped((uint32_t)column, (uint32_t)row, p->watcher.user_data);
}

static void drag_end(GtkGestureDrag *g, double right, double down, gpointer user_data)
{
	struct pane *p = user_data;
	(void)g;
	if (!p->picture)
		return;
	if (!p->moved)
		tap(p, p->start_x, p->start_y);
	else if (p->held != NO_MARK)
		tell_moved(p, right, down, true);
	p->held = NO_MARK;
	gtk_widget_queue_draw(p->area);
}

static void zoom_begin(GtkGesture *g, GdkEventSequence *sequence, gpointer user_data)
{
	struct pane *p = user_data;
	(void)g;
	(void)sequence;
	p->start_scale = p->scale;
	p->held = NO_MARK;
}

static void zoom_by(struct pane *p, double scale, double x, double y)
{
	double right = x - gtk_widget_get_width(p->area) / 2.0,
	       down = y - gtk_widget_get_height(p->area) / 2.0, was = p->scale;
	p->scale = scale;
	stay_inside(p);
	/* What is between the fingers stays there. */
	p->column += right / was - right / p->scale;
	p->row += down / was - down / p->scale;
	stay_inside(p);
	gtk_widget_queue_draw(p->area);
}

static void zoomed(GtkGestureZoom *g, double factor, gpointer user_data)
{
	struct pane *p = user_data;
	double x = 0, y = 0;
	gtk_gesture_get_bounding_box_center(GTK_GESTURE(g), &x, &y);
	if (p->picture)
		zoom_by(p, p->start_scale * factor, x, y);
}

static gboolean scrolled(GtkEventControllerScroll *c, double right, double down, gpointer user_data)
{
	struct pane *p = user_data;
	(void)c;
	(void)right;
	if (p->picture)
		zoom_by(p, p->scale * pow(1.2, -down), gtk_widget_get_width(p->area) / 2.0,
			gtk_widget_get_height(p->area) / 2.0);
	return TRUE;
}

/* ---- keys ---- */

/* It begins in the middle, and what is seen follows it. */
static void move_cursor(struct pane *p, double columns, double rows)
{
	if (!p->has_cursor) {
		p->has_cursor = true;
		p->cursor_column = floor(p->column) + 0.5;
		p->cursor_row = floor(p->row) + 0.5;
	}
	double x, y, wide = gtk_widget_get_width(p->area), high = gtk_widget_get_height(p->area);
	double c = p->cursor_column + columns;
	p->cursor_column = fmod(fmod(c, p->columns) + p->columns, p->columns);
	p->cursor_row = CLAMP(p->cursor_row + rows, 0.5, p->rows - 0.5);
	to_screen(p, p->cursor_column, p->cursor_row, &x, &y);
	p->column += (x - CLAMP(x, CURSOR_PX, MAX(wide - CURSOR_PX, CURSOR_PX))) / p->scale;
	p->row += (y - CLAMP(y, CURSOR_PX, MAX(high - CURSOR_PX, CURSOR_PX))) / p->scale;
}

static void zoom_at_cursor(struct pane *p, double factor)
{
	double x, y;
	move_cursor(p, 0, 0);
	to_screen(p, p->cursor_column, p->cursor_row, &x, &y);
	zoom_by(p, p->scale * factor, x, y);
}

static void pick_at_cursor(struct pane *p)
{
	double x, y;
	move_cursor(p, 0, 0);
	to_screen(p, p->cursor_column, p->cursor_row, &x, &y);
	p->held = NO_MARK;
	tap(p, x, y);
}

/* Arrows move a cross, with Shift cell by cell, + and - zoom, the space bar picks what is under it. */
static gboolean key_pressed(
	GtkEventControllerKey *c, guint key, guint code, GdkModifierType with, gpointer user_data)
{
	struct pane *p = user_data;
	double step = with & GDK_SHIFT_MASK ? 1 : MAX(round(KEY_STEP_PX / p->scale), 1);
	int right, down, closer = kit_zoom_of_key(key);
	(void)c;
	(void)code;
	if (!p->picture)
		return FALSE;
	if (kit_arrow_of_key(key, &right, &down))
		move_cursor(p, step * right, step * down);
	else if (closer)
		zoom_at_cursor(p, closer > 0 ? 1.25 : 0.8);
	else if (key == GDK_KEY_space || key == GDK_KEY_Return || key == GDK_KEY_KP_Enter)
		pick_at_cursor(p);
	else
		return FALSE;
	stay_inside(p);
	gtk_widget_queue_draw(p->area);
	return TRUE;
}

/* ---- the widget ---- */

static void pane_free(gpointer data)
{
	struct pane *p = data;
	g_clear_pointer(&p->picture, cairo_surface_destroy);
	g_array_unref(p->marks);
	g_free(p);
}

static void add_gestures(struct pane *p)
{
	GtkGesture *drag = gtk_gesture_drag_new(), *zoom = gtk_gesture_zoom_new();
	GtkEventController *wheel =
		gtk_event_controller_scroll_new(GTK_EVENT_CONTROLLER_SCROLL_VERTICAL);
	GtkEventController *keys = gtk_event_controller_key_new();
	g_signal_connect(drag, "drag-begin", G_CALLBACK(drag_begin), p);
	g_signal_connect(drag, "drag-update", G_CALLBACK(drag_update), p);
	g_signal_connect(drag, "drag-end", G_CALLBACK(drag_end), p);
	g_signal_connect(zoom, "begin", G_CALLBACK(zoom_begin), p);
	g_signal_connect(zoom, "scale-changed", G_CALLBACK(zoomed), p);
	g_signal_connect(wheel, "scroll", G_CALLBACK(scrolled), p);
	g_signal_connect(keys, "key-pressed", G_CALLBACK(key_pressed), p);
	gtk_widget_add_controller(p->area, GTK_EVENT_CONTROLLER(drag));
	gtk_widget_add_controller(p->area, GTK_EVENT_CONTROLLER(zoom));
	gtk_widget_add_controller(p->area, wheel);
	gtk_widget_add_controller(p->area, keys);
}

GtkWidget *pick_pane_new(
	const char *name, const char *label, const struct pick_pane_watcher *watcher)
{
	struct pane *p = g_new0(struct pane, 1);
	p->watcher = *watcher;
	p->held = NO_MARK;
	p->marks = g_array_new(FALSE, TRUE, sizeof(struct pick_mark));
	p->area = kit_grow(gtk_drawing_area_new(), true, true);
	gtk_widget_set_name(p->area, name);
	gtk_widget_set_focusable(p->area, TRUE);
	gtk_widget_set_size_request(p->area, 200, 120);
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(p->area), GTK_ACCESSIBLE_PROPERTY_LABEL, label, -1);
	gtk_drawing_area_set_draw_func(GTK_DRAWING_AREA(p->area), draw, p, NULL);
	g_signal_connect(p->area, "notify::has-focus", G_CALLBACK(gtk_widget_queue_draw), NULL);
	g_object_set_data_full(G_OBJECT(p->area), "pane", p, pane_free);
	add_gestures(p);
	return p->area;
}

void pick_pane_set_picture(GtkWidget *pane, const uint8_t *rgb, uint32_t columns, uint32_t rows)
{
	struct pane *p = pane_of(pane);
	g_clear_pointer(&p->picture, cairo_surface_destroy);
	p->columns = columns;
	p->rows = rows;
	p->scale = 0;
	p->column = columns / 2.0;
	p->row = rows / 2.0;
	p->picture = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)columns, (int)rows);
	uint8_t *data = cairo_image_surface_get_data(p->picture);
	size_t stride = (size_t)cairo_image_surface_get_stride(p->picture);
	cairo_surface_flush(p->picture);
	for (uint32_t r = 0; r < rows; r++)
		for (uint32_t c = 0; c < columns; c++) {
			const uint8_t *from = rgb + 3 * ((size_t)r * columns + c);
			uint32_t pixel = (uint32_t)from[0] << 16 | (uint32_t)from[1] << 8 | from[2];
			memcpy(data + r * stride + 4 * (size_t)c, &pixel, 4);
		}
	cairo_surface_mark_dirty(p->picture);
	gtk_widget_queue_draw(pane);
}

void pick_pane_set_marks(GtkWidget *pane, const struct pick_mark *marks, guint count)
{
	struct pane *p = pane_of(pane);
	g_array_set_size(p->marks, 0);
	g_array_append_vals(p->marks, marks, count);
	if (p->held >= count)
		p->held = NO_MARK;
	gtk_widget_queue_draw(pane);
}

void pick_pane_forget(GtkWidget *pane)
{
	pane_of(pane)->watcher = (struct pick_pane_watcher){ 0 };
}
