/* Light and focus by touch: while one of them is chosen a finger moves it, and two fingers move the view as ever. */
#include "render/kiosk/draw-screen.h"
#include "render/kiosk/kiosk-probe.h"
#include "render/kiosk/light-ball.h"
#include <json-glib/json-glib.h>

/* A finger that goes this part of the picture's height takes the light from the middle of the ball to its edge. */
#define BALL_REACH  0.3
#define BALL_RADIUS 56.0
#define BALL_MARGIN 120.0 /* above the bar */
/* What a light is when it is first switched on: from the left above. */
#define LIGHT_AMOUNT 0.65f
static const double first_place[2] = { -0.55, -0.6 };
/* A finger that goes so far makes the focus e times as large, or the rest as far away as it can be. */
#define FOCUS_GROWS_PX   240.0
#define FOCUS_FADES_PART 0.5
/* Of the way from the eye to what was tapped. */
#define FOCUS_RADIUS_PART 0.18
#define FOCUS_AMOUNT      0.9f
#define FOCUS_ABSTRACTION 1.f
#define FALLOFF_PART      2.f

/* ---- what the style says ---- */

static bool read_whole(struct draw_screen *s, struct style_whole *ret)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(style) now = s->edit ? style_edit_style(s->edit, s->folder, &error) : NULL;
	if (now)
		*ret = now->whole;
	kiosk_complain_of(s->kiosk, error);
	return now;
}

static void set(struct draw_screen *s, const char *section, const char *parameter, float value)
{
	style_edit_set(s->edit, section, parameter,
		json_node_init_double(json_node_alloc(), (double)value));
}

static void set_light(struct draw_screen *s, const struct style_light *l)
{
	set(s, "light", "amount", l->amount);
	set(s, "light", "azimuth_deg", l->azimuth_deg);
	set(s, "light", "elevation_deg", l->elevation_deg);
}

static void set_focus(struct draw_screen *s, const struct style_focus *f)
{
	set(s, "focus", "amount", f->amount);
	set(s, "focus", "abstraction", f->abstraction);
	set(s, "focus", "filters", f->filters);
	set(s, "focus", "across", f->across);
	set(s, "focus", "down", f->down);
	set(s, "focus", "radius_px", f->radius_px);
	set(s, "focus", "falloff_px", f->falloff_px);
	set(s, "focus", "segment", f->segment);
	set(s, "focus", "radius_m", f->radius_m);
	set(s, "focus", "falloff_m", f->falloff_m);
	set(s, "focus", "x_m", f->x_m);
	set(s, "focus", "y_m", f->y_m);
	set(s, "focus", "z_m", f->z_m);
}

/* For tests. */
static void tell(const struct style_whole *w)
{
	kiosk_probe_set("light", "%.3f %.1f %.1f", (double)w->light.amount,
		(double)w->light.azimuth_deg, (double)w->light.elevation_deg);
	kiosk_probe_set("focus", "%.3f %.3f %.3f", (double)w->focus.amount,
		(double)w->focus.abstraction, (double)w->focus.radius_m);
}

static void show(struct draw_screen *s, const struct style_whole *whole)
{
	s->whole = *whole;
	tell(whole);
	easel_set_accents(s->easel, &whole->light, &whole->focus);
	easel_redraw_marks(s->easel);
}

void draw_accents_refresh(struct draw_screen *s)
{
	draw_accents_stop(s);
	read_whole(s, &s->whole);
	tell(&s->whole);
	easel_redraw_marks(s->easel);
}

void draw_accents_stop(struct draw_screen *s)
{
	if (s->glide)
		g_source_remove(s->glide);
	s->glide = 0;
}

/* ---- light ---- */

static void begin_light(struct draw_screen *s)
{
	struct camera c = easel_camera(s->easel);
	struct style_whole whole = s->whole;
	if (whole.light.amount > 0 || !c.width)
		return;
	draw_screen_will_slide(s, "light", _("Light"));
	whole.light.amount = LIGHT_AMOUNT;
	light_ball_light(&c, first_place, &whole.light);
	set_light(s, &whole.light);
	show(s, &whole);
}

static void drag_light(struct draw_screen *s, double right_px, double down_px)
{
	struct camera c = easel_camera(s->easel);
	struct style_whole whole = s->whole;
	double place[2], reach_px = BALL_REACH * c.height;
	light_ball_place(&c, &whole.light, place);
	place[0] += right_px / reach_px;
	place[1] += down_px / reach_px;
	draw_screen_will_slide(s, "light", _("Light"));
	if (whole.light.amount <= 0)
		whole.light.amount = LIGHT_AMOUNT;
	light_ball_light(&c, place, &whole.light);
	set_light(s, &whole.light);
	show(s, &whole);
}

/* ---- focus ---- */

static void glide(struct draw_screen *s, const struct style_whole *to);

/* Where there was none yet: as large as things look that are tapped. */
static void begin_focus(struct style_focus *f, double away_m)
{
	f->amount = FOCUS_AMOUNT;
	f->abstraction = FOCUS_ABSTRACTION;
	f->filters = 1;
	f->radius_m = (float)(FOCUS_RADIUS_PART * away_m);
	f->falloff_m = FALLOFF_PART * f->radius_m;
}

static void focus_on(struct draw_screen *s, const struct scene_picked *picked)
{
	struct style_whole whole = s->whole;
	struct style_focus *f = &whole.focus;
	struct camera c = easel_camera(s->easel);
	double away2 = 0, px[2], depth_m;
	for (int k = 0; k < 3; k++)
		away2 += (picked->place_m[k] - c.eye_m[k]) * (picked->place_m[k] - c.eye_m[k]);
	draw_screen_will_slide(s, "focus place", _("Focus"));
	if (!style_focus_is_there(f))
		begin_focus(f, sqrt(away2));
	if (f->on == FOCUS_PICTURE && camera_project(&c, picked->place_m, px, &depth_m)) {
		f->across = (float)CLAMP(px[0] / c.width, 0, 1);
		f->down = (float)CLAMP(px[1] / c.height, 0, 1);
	}
	f->x_m = (float)picked->place_m[0];
	f->y_m = (float)picked->place_m[1];
	f->z_m = (float)picked->place_m[2];
	if (f->on != FOCUS_SEGMENT) {
		set_focus(s, f);
		glide(s, &whole);
		return;
	}
	/* Which things are in focus is of the drawing. */
	f->segment = (float)picked->leaf;
	set_focus(s, f);
	draw_screen_redraw(s, false);
	draw_accents_refresh(s);
}

/* ---- the focus goes from place to place ---- */

#define GLIDE_MS    40
#define GLIDE_STEPS 9

/* Of the way there is so much behind it, softly at both ends. */
static float between(float from, float to, float part)
{
	return from + (to - from) * part * part * (3 - 2 * part);
}

static gboolean glide_on(gpointer user_data)
{
	struct draw_screen *s = user_data;
	struct style_whole now = s->glide_to;
	float part = (float)++s->glide_step / GLIDE_STEPS;
	const struct style_focus *from = &s->glide_from.focus, *to = &s->glide_to.focus;
	float *at[] = { &now.focus.amount, &now.focus.abstraction, &now.focus.filters,
		&now.focus.x_m, &now.focus.y_m, &now.focus.z_m, &now.focus.across,
		&now.focus.down };
	const float was[] = { from->amount, from->abstraction, from->filters, from->x_m, from->y_m,
		from->z_m, from->across, from->down };
	const float is[] = { to->amount, to->abstraction, to->filters, to->x_m, to->y_m, to->z_m,
		to->across, to->down };
	for (size_t n = 0; n < G_N_ELEMENTS(at); n++)
		*at[n] = between(was[n], is[n], part);
	show(s, &now);
	if (s->glide_step < GLIDE_STEPS)
		return G_SOURCE_CONTINUE;
	s->glide = 0;
	return G_SOURCE_REMOVE;
}

/* A focus that comes grows where it is. */
static void glide(struct draw_screen *s, const struct style_whole *to)
{
	s->glide_from = s->whole;
	s->glide_to = *to;
	s->glide_step = 0;
	if (!style_focus_is_there(&s->whole.focus)) {
		struct style_focus *f = &s->glide_from.focus;
		*f = to->focus;
		f->amount = f->abstraction = f->filters = 0;
	}
	if (!s->glide)
		s->glide = g_timeout_add(GLIDE_MS, glide_on, s);
}

/* Sideways it becomes larger or smaller, upwards what is around it fainter. */
static void drag_focus(struct draw_screen *s, double right_px, double down_px)
{
	struct style_whole whole = s->whole;
	struct style_focus *f = &whole.focus;
	double height_px = easel_camera(s->easel).height;
	if (!style_focus_is_there(f)) {
		kiosk_say(s->kiosk, _("Tap the thing that the drawing is about."));
		return;
	}
	draw_screen_will_slide(s, "focus", _("Focus"));
	draw_accents_stop(s);
	float larger = (float)exp(right_px / FOCUS_GROWS_PX);
	f->radius_m = CLAMP(f->radius_m * larger, 0.05f, 1000.f);
	f->falloff_m = FALLOFF_PART * f->radius_m;
	f->radius_px = CLAMP(f->radius_px * larger, 10.f, 2000.f);
	f->falloff_px = CLAMP(f->falloff_px * larger, 20.f, 4000.f);
	float by = (float)(-down_px / (FOCUS_FADES_PART * height_px));
	/* Never both 0, which would be none. */
	f->amount = CLAMP(f->amount + by, 0.05f, 1.f);
	f->abstraction = CLAMP(f->abstraction + 2 * by, 0.f, 3.f);
	set_focus(s, f);
	show(s, &whole);
}

bool draw_accents_tapped(struct draw_screen *s, const struct scene_picked *picked)
{
	if (s->tool != DRAW_FOCUS)
		return false;
	if (picked)
		focus_on(s, picked);
	return true;
}

bool draw_accents_dragged(struct draw_screen *s, double right_px, double down_px)
{
	if (s->tool == DRAW_LIGHT)
		drag_light(s, right_px, down_px);
	if (s->tool == DRAW_FOCUS)
		drag_focus(s, right_px, down_px);
	return s->tool != DRAW_LOOK;
}

/* ---- marks ---- */

static void mark_focus(const struct draw_screen *s, cairo_t *cr, const struct camera *c)
{
	const struct style_focus *f = &s->whole.focus;
	const double at_m[3] = { (double)f->x_m, (double)f->y_m, (double)f->z_m };
	double px[2], depth_m, radius_px, dash[2] = { 12, 9 };
	if (!style_focus_is_there(f) || f->on == FOCUS_SEGMENT)
		return;
	if (f->on == FOCUS_PICTURE) {
		px[0] = (double)f->across * c->width;
		px[1] = (double)f->down * c->height;
		radius_px = (double)f->radius_px * c->height / FRAME_STYLE_HEIGHT;
	} else if (camera_project(c, at_m, px, &depth_m)) {
		radius_px = (double)f->radius_m * c->focal_px / camera_scale_m(c, depth_m);
	} else {
		return;
	}
	cairo_new_path(cr);
	cairo_arc(cr, px[0], px[1], MAX(radius_px, 8), 0, 2 * G_PI);
	cairo_set_line_width(cr, 5);
	cairo_set_source_rgba(cr, 1, 1, 1, 0.8);
	cairo_stroke_preserve(cr);
	cairo_set_dash(cr, dash, 2, 0);
	cairo_set_line_width(cr, 2.5);
	cairo_set_source_rgba(cr, 0.77, 0.34, 0.16, 1);
	cairo_stroke(cr);
	cairo_set_dash(cr, NULL, 0, 0);
	cairo_arc(cr, px[0], px[1], 5, 0, 2 * G_PI);
	cairo_fill(cr);
}

void draw_accents_marks(struct draw_screen *s, cairo_t *cr, const struct camera *c)
{
	double place[2];
	if (s->tool == DRAW_FOCUS)
		mark_focus(s, cr, c);
	if (s->tool != DRAW_LIGHT || s->whole.light.amount <= 0)
		return;
	light_ball_place(c, &s->whole.light, place);
	light_ball_draw(
		cr, place, c->width / 2.0, c->height - BALL_RADIUS - BALL_MARGIN, BALL_RADIUS);
}

/* ---- choosing ---- */

static void use(struct draw_screen *s, enum draw_tool tool)
{
	static const char *const hints[] = { [DRAW_LOOK] = "",
		[DRAW_LIGHT] = N_("Drag: the light follows your finger."),
		[DRAW_FOCUS] =
			N_("Tap what the drawing is about. Drag sideways: more or less of it; "
			   "up: the rest fades.") };
	if (tool != DRAW_LOOK)
		draw_panel_close(s);
	s->tool = tool;
	gtk_toggle_button_set_active(GTK_TOGGLE_BUTTON(s->light_button), tool == DRAW_LIGHT);
	gtk_toggle_button_set_active(GTK_TOGGLE_BUTTON(s->focus_button), tool == DRAW_FOCUS);
	if (tool != DRAW_LOOK)
		kit_set_text(s->tool_hint, _(hints[tool]));
	gtk_widget_set_visible(s->tool_bar, tool != DRAW_LOOK);
	draw_accents_refresh(s);
	if (tool == DRAW_LIGHT)
		begin_light(s);
}

static void toggled(GtkToggleButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	enum draw_tool mine = GTK_WIDGET(b) == s->light_button ? DRAW_LIGHT : DRAW_FOCUS;
	bool on = gtk_toggle_button_get_active(b);
	if (on && s->tool != mine)
		use(s, mine);
	if (!on && s->tool == mine)
		use(s, DRAW_LOOK);
}

/* Neither light nor focus, whichever is chosen; and the fingers look around again. */
static void without_pressed(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	struct style_whole whole = s->whole;
	(void)b;
	if (s->tool == DRAW_LIGHT) {
		draw_screen_will_change(s, _("No light"));
		whole.light.amount = 0;
		set_light(s, &whole.light);
	} else {
		draw_screen_will_change(s, _("No focus"));
		draw_accents_stop(s);
		whole.focus.amount = whole.focus.abstraction = whole.focus.filters = 0;
		set_focus(s, &whole.focus);
	}
	g_clear_pointer(&s->last_slid, g_free);
	show(s, &whole);
	use(s, DRAW_LOOK);
	draw_panel_fill(s);
}

void draw_accents_end(struct draw_screen *s)
{
	use(s, DRAW_LOOK);
}

static GtkWidget *tool_button(
	struct draw_screen *s, const char *name, const char *icon, const char *tip)
{
	GtkWidget *b = gtk_toggle_button_new();
	gtk_button_set_child(GTK_BUTTON(b), gtk_image_new_from_icon_name(icon));
	gtk_widget_set_name(b, name);
	gtk_widget_set_tooltip_text(b, tip);
	gtk_accessible_update_property(GTK_ACCESSIBLE(b), GTK_ACCESSIBLE_PROPERTY_LABEL, tip, -1);
	g_signal_connect(b, "toggled", G_CALLBACK(toggled), s);
	return b;
}

GtkWidget *draw_accents_tools(struct draw_screen *s)
{
	s->light_button = tool_button(
		s, "draw-light", "weather-clear-symbolic", _("Where the light comes from"));
	s->focus_button = tool_button(
		s, "draw-focus", "find-location-symbolic", _("What the drawing is about"));
	return kit_column(8, s->light_button, s->focus_button, NULL);
}

GtkWidget *draw_accents_bar(struct draw_screen *s)
{
	s->tool_hint = kit_named_text("tool-hint", "", NULL);
	kit_narrow(s->tool_hint, -1, 46);
	s->tool_bar = kit_classed(kit_row(12, kit_grow(s->tool_hint, true, false),
					  kit_button("tool-without", NULL, _("Without"), NULL, NULL,
						  G_CALLBACK(without_pressed), s),
					  NULL),
		"over");
	gtk_widget_set_halign(s->tool_bar, GTK_ALIGN_CENTER);
	gtk_widget_set_valign(s->tool_bar, GTK_ALIGN_END);
	gtk_widget_set_visible(s->tool_bar, FALSE);
	return kit_margin(s->tool_bar, 12);
}
