#include "render/kiosk/easel.h"
#include "render/kiosk/kiosk-probe.h"
#include <gio/gio.h>

/* A view that has not changed for so long stands still. */
#define STILL_MS       140
#define PICK_RADIUS_PX 14.0
#define FOCUS_SECONDS  0.6
#define FOCUS_NEARER   2.0
/* After so long without a picture another gesture has begun. */
#define PACE_NEW_US (G_USEC_PER_SEC / 2)

struct easel {
	GtkWidget *canvas;
	enum backend_wish backend;
	struct easel_watcher watcher;
	const drawn_site *site;
	artist *artist;
	drawing *waiting; /* until there is an artist */
	struct looking now, from, to;
	bool has_looking;
	double way_s; /* of the way from..to; 0: it has arrived */
	int64_t left_us;
	guint still_timer, tick;
	/* How well pictures of the gesture that is under way keep up. */
	struct {
		guint pictures;
		int64_t first_us, last_us;
		double latest_s;
	} pace;
};

/* ---- wishes ---- */

struct camera easel_camera(const easel *e)
{
	return looking_camera(&e->now, canvas_width_px(e->canvas), canvas_height_px(e->canvas));
}

static void wish(easel *e, bool moving)
{
	struct camera c = easel_camera(e);
	if (e->artist && e->has_looking && c.width && c.height)
		artist_look(e->artist, &c, moving);
}

static gboolean stands_still(gpointer user_data)
{
	easel *e = user_data;
	e->still_timer = 0;
	wish(e, false);
	return G_SOURCE_REMOVE;
}

static void has_moved(easel *e)
{
	g_clear_handle_id(&e->still_timer, g_source_remove);
	e->still_timer = g_timeout_add(STILL_MS, stands_still, e);
	wish(e, true);
}

/* ---- a way from one view to another ---- */

static void stop_way(easel *e)
{
	if (e->tick)
		gtk_widget_remove_tick_callback(e->canvas, e->tick);
	e->tick = 0;
	e->way_s = 0;
}

static gboolean go_on(GtkWidget *w, GdkFrameClock *clock, gpointer user_data)
{
	easel *e = user_data;
	(void)w;
	(void)clock;
	double part = (double)(g_get_monotonic_time() - e->left_us) * 1e-6 / e->way_s;
	e->now = looking_between(&e->from, &e->to, part);
	has_moved(e);
	if (part < 1)
		return G_SOURCE_CONTINUE;
	e->tick = 0;
	e->way_s = 0;
	return G_SOURCE_REMOVE;
}

void easel_look(easel *e, const struct looking *to, double seconds)
{
	stop_way(e);
	if (!e->has_looking || seconds <= 0) {
		e->now = e->to = *to;
		e->has_looking = true;
		wish(e, false);
		return;
	}
	e->from = e->now;
	e->to = *to;
	e->way_s = seconds;
	e->left_us = g_get_monotonic_time();
	e->tick = gtk_widget_add_tick_callback(e->canvas, go_on, e, NULL);
}

struct looking easel_looking(const easel *e)
{
	return e->way_s > 0 ? e->to : e->now;
}

/* ---- fingers ---- */

static double height_of(const easel *e)
{
	return canvas_height_px(e->canvas);
}

static void dragged(double right_px, double down_px, gpointer user_data)
{
	easel *e = user_data;
	if (e->watcher.dragged && e->watcher.dragged(right_px, down_px, e->watcher.user_data))
		return;
	stop_way(e);
	looking_drag(&e->now, right_px, down_px, height_of(e));
	has_moved(e);
}

static void panned(double right_px, double down_px, gpointer user_data)
{
	easel *e = user_data;
	stop_way(e);
	looking_pan(&e->now, right_px, down_px, height_of(e));
	has_moved(e);
}

static void zoomed(double factor, double x, double y, gpointer user_data)
{
	easel *e = user_data;
	stop_way(e);
	looking_zoom(&e->now, factor, x - canvas_width_px(e->canvas) / 2.0, y - height_of(e) / 2,
		height_of(e));
	has_moved(e);
}

static void twisted(double angle_rad, gpointer user_data)
{
	easel *e = user_data;
	stop_way(e);
	looking_twist(&e->now, angle_rad);
	has_moved(e);
}

static bool pick(easel *e, double x, double y, struct scene_picked *ret)
{
	struct camera c = easel_camera(e);
	double at[2] = { x, y };
	return e->site && e->site->scene && c.width &&
	       scene_pick(e->site->scene, &c, NULL, at, PICK_RADIUS_PX, ret);
}

static void tapped(double x, double y, gpointer user_data)
{
	easel *e = user_data;
	struct scene_picked picked;
	if (e->watcher.tapped)
		e->watcher.tapped(pick(e, x, y, &picked) ? &picked : NULL, e->watcher.user_data);
}

static void double_tapped(double x, double y, gpointer user_data)
{
	easel *e = user_data;
	struct scene_picked picked;
	if (!pick(e, x, y, &picked))
		return;
	struct looking to = looking_at(&e->now, picked.place_m, FOCUS_NEARER);
	easel_look(e, &to, FOCUS_SECONDS);
}

static void resized(uint32_t width, uint32_t height, gpointer user_data)
{
	(void)width;
	(void)height;
	wish(user_data, false);
}

static void draw_marks(cairo_t *cr, double width, double height, gpointer user_data)
{
	easel *e = user_data;
	struct camera c = easel_camera(e);
	(void)width;
	(void)height;
	if (e->site && c.width)
		e->watcher.marks(cr, &c, e->watcher.user_data);
}

/* ---- what the artist brings ---- */

/* For tests and those who measure: pictures of a gesture, over how many seconds, and how late the latest of them was. */
static void tell_pace(easel *e, const struct artist_picture *p)
{
	int64_t now_us = g_get_monotonic_time();
	if (p->pictures)
		return;
	if (now_us - e->pace.last_us > PACE_NEW_US) {
		e->pace.pictures = 0;
		e->pace.first_us = now_us;
		e->pace.latest_s = 0;
	}
	e->pace.pictures++;
	e->pace.last_us = now_us;
	e->pace.latest_s = MAX(e->pace.latest_s, (double)(now_us - p->wished_us) * 1e-6);
	kiosk_probe_set("pace", "%u %.3f %.3f %u", e->pace.pictures,
		(double)(now_us - e->pace.first_us) * 1e-6, e->pace.latest_s, p->width);
}

static void got_picture(const struct artist_picture *p, gpointer user_data)
{
	easel *e = user_data;
	canvas_show(e->canvas, p->bgrx, p->width, p->height);
	tell_pace(e, p);
	if (e->watcher.shown)
		e->watcher.shown(p, e->watcher.user_data);
}

static void got_small(uint32_t n, const struct artist_picture *p, gpointer user_data)
{
	easel *e = user_data;
	if (e->watcher.small)
		e->watcher.small(n, p, e->watcher.user_data);
}

static void has_failed(const char *sentence, gpointer user_data)
{
	easel *e = user_data;
	if (e->watcher.failed)
		e->watcher.failed(sentence, e->watcher.user_data);
}

/* ---- the whole ---- */

easel *easel_new(const char *name, enum backend_wish backend, const struct easel_watcher *watcher)
{
	easel *e = g_new0(easel, 1);
	e->backend = backend;
	e->watcher = *watcher;
	e->canvas = canvas_new(name, _("The drawn site"),
		&(struct canvas_watcher){ .resized = resized,
			.drag = dragged,
			.pan = panned,
			.zoom = zoomed,
			.twist = twisted,
			.tap = tapped,
			.double_tap = double_tapped,
			.user_data = e });
	g_object_ref_sink(e->canvas);
	if (watcher->marks)
		canvas_set_marks(e->canvas, draw_marks, e);
	return e;
}

void easel_free(easel *e)
{
	if (!e)
		return;
	artist_free(e->artist);
	drawing_free(e->waiting);
	g_clear_handle_id(&e->still_timer, g_source_remove);
	stop_way(e);
	canvas_forget(e->canvas);
	g_object_unref(e->canvas);
	g_free(e);
}

GtkWidget *easel_widget(easel *e)
{
	return e->canvas;
}

void easel_set_site(easel *e, const drawn_site *d)
{
	g_clear_pointer(&e->artist, artist_free);
	e->site = d;
	if (!d)
		return;
	e->artist = artist_new(d->scene, e->backend,
		&(struct artist_watcher){ got_picture, got_small, has_failed, e });
	if (e->waiting)
		artist_set_drawing(e->artist, g_steal_pointer(&e->waiting));
	wish(e, false);
}

void easel_set_drawing(easel *e, drawing *d, bool passing)
{
	if (e->artist) {
		artist_set_drawing(e->artist, d);
		if (passing)
			has_moved(e);
		else
			wish(e, false);
		return;
	}
	drawing_free(e->waiting);
	e->waiting = d;
}

void easel_set_accents(easel *e, const struct style_light *light, const struct style_focus *focus)
{
	if (!e->artist)
		return;
	artist_set_accents(e->artist, light, focus);
	has_moved(e);
}

void easel_set_small(easel *e, GPtrArray *drawings, uint32_t width, uint32_t height)
{
	if (e->artist)
		artist_set_small(e->artist, drawings, width, height);
	else if (drawings)
		g_ptr_array_unref(drawings);
}

const char *easel_why(const easel *e)
{
	return e->artist ? artist_why(e->artist) : NULL;
}

void easel_redraw_marks(easel *e)
{
	gtk_widget_queue_draw(e->canvas);
}
