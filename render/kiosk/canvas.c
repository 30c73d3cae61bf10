#include "render/kiosk/canvas.h"
#include <gio/gio.h>

/* A second tap comes within this, or the first was alone. */
#define DOUBLE_TAP_MS 320
/* A finger that has gone farther than this, of the widget's pixels, has not tapped. */
#define TAP_SLOP    14.0
#define KEY_STEP_PX 40.0
#define KEY_ZOOM    1.15
#define KEY_TWIST   0.087
#define WHEEL_ZOOM  1.1

struct _PleinairCanvas {
	GtkWidget parent;
	struct canvas_watcher watcher;
	GBytes *bgrx; /* shown; picture_width * picture_height */
	uint32_t picture_width, picture_height;
	uint32_t width, height;
	GtkGesture *drag, *pan, *mouse_pan, *zoom, *twist;
	double last_x, last_y, last_scale, last_angle;
	bool may_be_tap; /* what is down has not moved, and is alone */
	guint tap_timer;
	double tap_x, tap_y;
	void (*marks)(cairo_t *, double, double, gpointer);
	gpointer marks_data;
};
G_DEFINE_FINAL_TYPE(PleinairCanvas, canvas, GTK_TYPE_WIDGET)

static double px(PleinairCanvas *c)
{
	return gtk_widget_get_scale_factor(GTK_WIDGET(c));
}

/* ---- gestures ---- */

static void drag_begin(GtkGestureDrag *g, double x, double y, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	(void)g;
	(void)x;
	(void)y;
	c->last_x = c->last_y = 0;
}

static void moved(PleinairCanvas *c, double x, double y, void (*tell)(double, double, gpointer))
{
	double dx = x - c->last_x, dy = y - c->last_y;
	c->last_x = x;
	c->last_y = y;
	if (tell && (dx != 0 || dy != 0))
		tell(dx * px(c), dy * px(c), c->watcher.user_data);
}

static void drag_update(GtkGestureDrag *g, double x, double y, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	/* The first finger of two comes alone. */
	if (gtk_gesture_is_recognized(c->zoom))
		return;
	(void)g;
	if (hypot(x, y) > TAP_SLOP)
		c->may_be_tap = false;
	moved(c, x, y, c->watcher.drag);
}

static void pan_update(GtkGestureDrag *g, double x, double y, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	(void)g;
	moved(c, x, y, c->watcher.pan);
}

static void drag_end(GtkGestureDrag *g, double x, double y, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	(void)g;
	(void)x;
	(void)y;
	if (c->watcher.rest)
		c->watcher.rest(c->watcher.user_data);
}

static void two_begin(GtkGesture *g, GdkEventSequence *s, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	double x, y;
	(void)s;
	c->may_be_tap = false;
	c->last_scale = 1;
	c->last_angle = 0;
	if (gtk_gesture_get_bounding_box_center(g, &x, &y)) {
		c->last_x = x;
		c->last_y = y;
	}
}

/* Both fingers are told at once: pan by their middle, zoom, twist. */
static void zoom_changed(GtkGestureZoom *g, double scale, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	double x, y;
	if (!gtk_gesture_get_bounding_box_center(GTK_GESTURE(g), &x, &y))
		return;
	moved(c, x, y, c->watcher.pan);
	if (c->watcher.zoom && scale > 0 && c->last_scale > 0)
		c->watcher.zoom(scale / c->last_scale, x * px(c), y * px(c), c->watcher.user_data);
	c->last_scale = scale;
}

static void angle_changed(GtkGestureRotate *g, double angle, double delta, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	double by = remainder(delta - c->last_angle, 2 * G_PI);
	(void)g;
	(void)angle;
	if (c->watcher.twist)
		c->watcher.twist(by, c->watcher.user_data);
	c->last_angle = delta;
}

static void two_end(GtkGesture *g, GdkEventSequence *s, gpointer user_data)
{
	(void)g;
	(void)s;
	drag_end(NULL, 0, 0, user_data);
}

static gboolean was_single(gpointer user_data)
{
	PleinairCanvas *c = user_data;
	c->tap_timer = 0;
	if (c->watcher.tap)
		c->watcher.tap(c->tap_x, c->tap_y, c->watcher.user_data);
	return G_SOURCE_REMOVE;
}

static void pressed(GtkGestureClick *g, int n, double x, double y, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	(void)g;
	(void)n;
	(void)x;
	(void)y;
	c->may_be_tap = true;
}

static void tapped(GtkGestureClick *g, int n, double x, double y, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	(void)g;
	if (!c->may_be_tap)
		return;
	gtk_widget_grab_focus(GTK_WIDGET(c));
	c->tap_x = x * px(c);
	c->tap_y = y * px(c);
	g_clear_handle_id(&c->tap_timer, g_source_remove);
	if (n == 2 && c->watcher.double_tap)
		c->watcher.double_tap(c->tap_x, c->tap_y, c->watcher.user_data);
	else if (n == 1)
		c->tap_timer =
			g_timeout_add(c->watcher.double_tap ? DOUBLE_TAP_MS : 0, was_single, c);
}

static void held(GtkGestureLongPress *g, double x, double y, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	(void)g;
	if (c->watcher.hold)
		c->watcher.hold(x * px(c), y * px(c), c->watcher.user_data);
}

static gboolean scrolled(GtkEventControllerScroll *s, double dx, double dy, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	(void)s;
	(void)dx;
	if (c->watcher.zoom && dy != 0)
		c->watcher.zoom(pow(WHEEL_ZOOM, -dy), c->width / 2.0, c->height / 2.0,
			c->watcher.user_data);
	drag_end(NULL, 0, 0, c);
	return GDK_EVENT_STOP;
}

/* ---- keys ---- */

static bool key_drags(PleinairCanvas *c, guint key)
{
	int right, down;
	if (!c->watcher.drag || !kit_arrow_of_key(key, &right, &down))
		return false;
	c->watcher.drag(KEY_STEP_PX * right, KEY_STEP_PX * down, c->watcher.user_data);
	return true;
}

static bool key_turns(PleinairCanvas *c, guint key)
{
	int closer = kit_zoom_of_key(key);
	bool left = key == GDK_KEY_Page_Up, right = key == GDK_KEY_Page_Down;
	if (closer && c->watcher.zoom)
		c->watcher.zoom(closer > 0 ? KEY_ZOOM : 1 / KEY_ZOOM, c->width / 2.0,
			c->height / 2.0, c->watcher.user_data);
	if ((left || right) && c->watcher.twist)
		c->watcher.twist(right ? KEY_TWIST : -KEY_TWIST, c->watcher.user_data);
	return closer || left || right;
}

static gboolean key_pressed(
	GtkEventControllerKey *k, guint key, guint code, GdkModifierType m, gpointer user_data)
{
	PleinairCanvas *c = user_data;
	(void)k;
	(void)code;
	if (m & (GDK_CONTROL_MASK | GDK_ALT_MASK))
		return GDK_EVENT_PROPAGATE;
	return key_drags(c, key) || key_turns(c, key) ? GDK_EVENT_STOP : GDK_EVENT_PROPAGATE;
}

static void key_released(
	GtkEventControllerKey *k, guint key, guint code, GdkModifierType m, gpointer user_data)
{
	(void)k;
	(void)key;
	(void)code;
	(void)m;
	drag_end(NULL, 0, 0, user_data);
}

/* ---- the widget ---- */

static void canvas_size_allocate(GtkWidget *w, int width, int height, int baseline)
{
	PleinairCanvas *c = PLEINAIR_CANVAS(w);
	uint32_t wide = (uint32_t)(width * px(c)), high = (uint32_t)(height * px(c));
	(void)baseline;
	if (wide == c->width && high == c->height)
		return;
	c->width = wide;
	c->height = high;
	if (wide && high && c->watcher.resized)
		c->watcher.resized(wide, high, c->watcher.user_data);
}

static const cairo_user_data_key_t bytes_key;

/* GSK's cairo renderer copies each texture that it draws, which costs as much as all the rest: it gets the bytes themselves. */
static void append_bytes(PleinairCanvas *c, GtkSnapshot *s, const graphene_rect_t *all)
{
	cairo_surface_t *picture = cairo_image_surface_create_for_data(
		(unsigned char *)g_bytes_get_data(c->bgrx, NULL), CAIRO_FORMAT_RGB24,
		(int)c->picture_width, (int)c->picture_height, (int)c->picture_width * 4);
	cairo_surface_set_user_data(
		picture, &bytes_key, g_bytes_ref(c->bgrx), (cairo_destroy_func_t)g_bytes_unref);
	cairo_t *cr = gtk_snapshot_append_cairo(s, all);
	cairo_scale(cr, (double)all->size.width / c->picture_width,
		(double)all->size.height / c->picture_height);
	cairo_set_source_surface(cr, picture, 0, 0);
	cairo_pattern_set_filter(cairo_get_source(cr), CAIRO_FILTER_BILINEAR);
	cairo_pattern_set_extend(cairo_get_source(cr), CAIRO_EXTEND_PAD);
	cairo_set_operator(cr, CAIRO_OPERATOR_SOURCE);
	cairo_paint(cr);
	cairo_destroy(cr);
	cairo_surface_destroy(picture);
}

static void append_picture(PleinairCanvas *c, GtkSnapshot *s, const graphene_rect_t *all)
{
	GskRenderer *renderer = gtk_native_get_renderer(gtk_widget_get_native(GTK_WIDGET(c)));
	if (GSK_IS_CAIRO_RENDERER(renderer)) {
		append_bytes(c, s, all);
		return;
	}
	g_autoptr(GdkTexture) texture =
		canvas_texture(c->bgrx, c->picture_width, c->picture_height);
	gtk_snapshot_append_texture(s, texture, all);
}

static void canvas_snapshot(GtkWidget *w, GtkSnapshot *s)
{
	PleinairCanvas *c = PLEINAIR_CANVAS(w);
	float width = (float)gtk_widget_get_width(w), height = (float)gtk_widget_get_height(w);
	graphene_rect_t all = GRAPHENE_RECT_INIT(0, 0, width, height);
	if (c->bgrx)
		append_picture(c, s, &all);
	if (!c->marks || !c->width)
		return;
	cairo_t *cr = gtk_snapshot_append_cairo(s, &all);
	cairo_scale(cr, 1 / px(c), 1 / px(c));
	c->marks(cr, c->width, c->height, c->marks_data);
	cairo_destroy(cr);
}

static void canvas_dispose(GObject *o)
{
	PleinairCanvas *c = PLEINAIR_CANVAS(o);
	g_clear_handle_id(&c->tap_timer, g_source_remove);
	g_clear_pointer(&c->bgrx, g_bytes_unref);
	G_OBJECT_CLASS(canvas_parent_class)->dispose(o);
}

static void canvas_class_init(PleinairCanvasClass *class)
{
	GtkWidgetClass *w = GTK_WIDGET_CLASS(class);
	G_OBJECT_CLASS(class)->dispose = canvas_dispose;
	w->size_allocate = canvas_size_allocate;
	w->snapshot = canvas_snapshot;
	gtk_widget_class_set_css_name(w, "canvas");
	gtk_widget_class_set_accessible_role(w, GTK_ACCESSIBLE_ROLE_IMG);
}

static GtkGesture *add(PleinairCanvas *c, GtkGesture *g)
{
	gtk_widget_add_controller(GTK_WIDGET(c), GTK_EVENT_CONTROLLER(g));
	return g;
}

static GtkGesture *add_drag(PleinairCanvas *c, guint button, GCallback update)
{
	GtkGesture *g = add(c, gtk_gesture_drag_new());
	gtk_gesture_single_set_button(GTK_GESTURE_SINGLE(g), button);
	g_signal_connect(g, "drag-begin", G_CALLBACK(drag_begin), c);
	g_signal_connect(g, "drag-update", update, c);
	g_signal_connect(g, "drag-end", G_CALLBACK(drag_end), c);
	return g;
}

static void add_gestures(PleinairCanvas *c)
{
	c->drag = add_drag(c, GDK_BUTTON_PRIMARY, G_CALLBACK(drag_update));
	add_drag(c, GDK_BUTTON_SECONDARY, G_CALLBACK(pan_update));
	add_drag(c, GDK_BUTTON_MIDDLE, G_CALLBACK(pan_update));
	c->zoom = add(c, gtk_gesture_zoom_new());
	g_signal_connect(c->zoom, "begin", G_CALLBACK(two_begin), c);
	g_signal_connect(c->zoom, "scale-changed", G_CALLBACK(zoom_changed), c);
	g_signal_connect(c->zoom, "end", G_CALLBACK(two_end), c);
	c->twist = add(c, gtk_gesture_rotate_new());
	g_signal_connect(c->twist, "angle-changed", G_CALLBACK(angle_changed), c);
	gtk_gesture_group(c->twist, c->zoom);
	GtkGesture *click = add(c, gtk_gesture_click_new());
	g_signal_connect(click, "pressed", G_CALLBACK(pressed), c);
	g_signal_connect(click, "released", G_CALLBACK(tapped), c);
	GtkGesture *hold = add(c, gtk_gesture_long_press_new());
	g_signal_connect(hold, "pressed", G_CALLBACK(held), c);
}

static void canvas_init(PleinairCanvas *c)
{
	add_gestures(c);
	GtkEventController *wheel =
		gtk_event_controller_scroll_new(GTK_EVENT_CONTROLLER_SCROLL_VERTICAL);
	g_signal_connect(wheel, "scroll", G_CALLBACK(scrolled), c);
	gtk_widget_add_controller(GTK_WIDGET(c), wheel);
	GtkEventController *keys = gtk_event_controller_key_new();
	g_signal_connect(keys, "key-pressed", G_CALLBACK(key_pressed), c);
	g_signal_connect(keys, "key-released", G_CALLBACK(key_released), c);
	gtk_widget_add_controller(GTK_WIDGET(c), keys);
	gtk_widget_set_focusable(GTK_WIDGET(c), TRUE);
	gtk_widget_set_overflow(GTK_WIDGET(c), GTK_OVERFLOW_HIDDEN);
	kit_grow(GTK_WIDGET(c), true, true);
}

GtkWidget *canvas_new(const char *name, const char *label, const struct canvas_watcher *watcher)
{
	PleinairCanvas *c = g_object_new(canvas_get_type(), "name", name, NULL);
	c->watcher = *watcher;
	gtk_accessible_update_property(GTK_ACCESSIBLE(c), GTK_ACCESSIBLE_PROPERTY_LABEL, label, -1);
	return kit_classed(GTK_WIDGET(c), "canvas");
}

GdkTexture *canvas_texture(GBytes *bgrx, uint32_t width, uint32_t height)
{
	return gdk_memory_texture_new(
		(int)width, (int)height, GDK_MEMORY_B8G8R8A8_PREMULTIPLIED, bgrx, (gsize)width * 4);
}

void canvas_show(GtkWidget *canvas, GBytes *bgrx, uint32_t width, uint32_t height)
{
	PleinairCanvas *c = PLEINAIR_CANVAS(canvas);
	g_bytes_ref(bgrx);
	g_clear_pointer(&c->bgrx, g_bytes_unref);
	c->bgrx = bgrx;
	c->picture_width = width;
	c->picture_height = height;
	gtk_widget_queue_draw(canvas);
}

uint32_t canvas_width_px(GtkWidget *canvas)
{
	return PLEINAIR_CANVAS(canvas)->width;
}

uint32_t canvas_height_px(GtkWidget *canvas)
{
	return PLEINAIR_CANVAS(canvas)->height;
}

void canvas_set_marks(GtkWidget *canvas,
	void (*draw)(cairo_t *cr, double width, double height, gpointer user_data),
	gpointer user_data)
{
	PleinairCanvas *c = PLEINAIR_CANVAS(canvas);
	c->marks = draw;
	c->marks_data = user_data;
	gtk_widget_queue_draw(canvas);
}

void canvas_forget(GtkWidget *canvas)
{
	PleinairCanvas *c = PLEINAIR_CANVAS(canvas);
	c->watcher = (struct canvas_watcher){ 0 };
	c->marks = NULL;
	g_clear_handle_id(&c->tap_timer, g_source_remove);
}
