/* The panel beside the picture: what was tapped, and how it is drawn. */
#include "render/kiosk/draw-screen.h"
#include "render/kiosk/step-sliders.h"
#include <json-glib/json-glib.h>

#define PANEL_WIDTH 400

static const struct segment *node_of(const struct draw_screen *s)
{
	return s->site && s->site->tree ? segments_find(s->site->tree, s->node) : NULL;
}

static const char *node_name(const struct draw_screen *s)
{
	const struct segment *node = node_of(s);
	return node && s->node != SEGMENT_SITE ? node->name : _("The whole site");
}

/* ---- changes ---- */

/* key: of the node in the style; name: as people read it. */
static void change(struct draw_screen *s, const char *key, const char *name, const char *step_id,
	const struct step_parameter *p, JsonNode *value)
{
	g_autofree char *what = g_strdup_printf("%s %s %s", key, step_id, p->name),
			*did = g_strdup_printf(_("%s changed"), name);
	draw_screen_will_slide(s, what, did);
	style_edit_change(s->edit, key, step_id, p->name, value);
	draw_screen_redraw(s, true);
}

static void slid(
	const char *step_id, const struct step_parameter *p, JsonNode *value, gpointer user_data)
{
	struct draw_screen *s = user_data;
	char key[32];
	change(s, draw_screen_node_key(s, key), node_name(s), step_id, p, value);
}

/* Of the filters of the picture of all. */
static void picture_slid(
	const char *step_id, const struct step_parameter *p, JsonNode *value, gpointer user_data)
{
	change(user_data, "picture", _("The whole picture"), step_id, p, value);
}

/* Of the whole picture; paper, light or focus. */
static void section_slid(
	const char *section, const struct step_parameter *p, JsonNode *value, gpointer user_data)
{
	struct draw_screen *s = user_data;
	g_autofree char *what = g_strdup_printf("%s %s", section, p->name);
	g_autofree char *did = g_strdup_printf(_("%s changed"), _("The whole site"));
	draw_screen_will_slide(s, what, did);
	style_edit_set(s->edit, section, p->name, value);
	draw_screen_redraw(s, true);
	draw_accents_refresh(s);
}

static void hide_pressed(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	char key[32];
	g_autoptr(GArray) nothing = g_array_new(FALSE, FALSE, sizeof(struct step));
	g_autofree char *did = g_strdup_printf(_("%s is not drawn"), node_name(s));
	(void)b;
	draw_screen_will_change(s, did);
	style_edit_set_steps(s->edit, draw_screen_node_key(s, key), nothing);
	draw_screen_redraw(s, false);
	draw_panel_fill(s);
	kiosk_say(s->kiosk, did);
}

static void reset_pressed(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	char key[32];
	g_autofree char *did = g_strdup_printf(_("%s as it was"), node_name(s));
	(void)b;
	draw_screen_will_change(s, did);
	style_edit_reset(s->edit, draw_screen_node_key(s, key));
	draw_screen_redraw(s, false);
	draw_panel_fill(s);
}

static void save_pressed(GtkButton *b, gpointer user_data)
{
	struct draw_screen *s = user_data;
	g_autoptr(GError) error = NULL;
	g_autoptr(GDateTime) now = g_date_time_new_now_local();
	g_autofree char *title = g_date_time_format(now, _("My style of %d.%m. %H:%M"));
	g_autofree char *name = NULL;
	(void)b;
	if (!style_edit_save(s->edit, s->folder, title, &name, &error)) {
		kiosk_complain_of(s->kiosk, error);
		return;
	}
	g_free(s->style_name);
	s->style_name = g_strdup(name);
	draw_strip_fill(s);
	g_autofree char *said = g_strdup_printf(_("Kept as \"%s\"."), title);
	kiosk_say(s->kiosk, said);
}

/* ---- what is selected ---- */

static void select_node(struct draw_screen *s, uint32_t node)
{
	s->node = node;
	g_clear_pointer(&s->last_slid, g_free);
	draw_panel_fill(s);
	easel_redraw_marks(s->easel);
}

void draw_panel_select(struct draw_screen *s, uint32_t leaf)
{
	bool known = leaf && s->site->tree && segments_find(s->site->tree, leaf);
	s->leaf = known ? leaf : 0;
	select_node(s, known ? leaf : SEGMENT_SITE);
	if (known)
		draw_panel_show(s, true);
}

static void crumb_pressed(GtkButton *b, gpointer user_data)
{
	select_node(user_data, GPOINTER_TO_UINT(g_object_get_data(G_OBJECT(b), "node")));
}

static GtkWidget *crumb(struct draw_screen *s, uint32_t id, const char *text)
{
	g_autofree char *name = g_strdup_printf("node-%u", id);
	GtkWidget *b = kit_button(name, NULL, text, NULL, id == s->node ? "main" : NULL,
		G_CALLBACK(crumb_pressed), s);
	g_object_set_data(G_OBJECT(b), "node", GUINT_TO_POINTER(id));
	return b;
}

/* From the site down to what was tapped. */
static GtkWidget *crumbs(struct draw_screen *s)
{
	GtkWidget *column = kit_column(6, NULL);
	const struct segment *n = s->leaf ? segments_find(s->site->tree, s->leaf) : NULL;
	for (; n && n->id != SEGMENT_SITE; n = segments_find(s->site->tree, n->parent))
		gtk_box_prepend(GTK_BOX(column), crumb(s, n->id, _(n->name)));
	gtk_box_prepend(GTK_BOX(column), crumb(s, SEGMENT_SITE, _("The whole site")));
	return column;
}

static GtkWidget *actions(struct draw_screen *s)
{
	GtkWidget *row = kit_row(8,
		kit_grow(kit_button("node-hide", NULL, _("Hide"), NULL, NULL,
				 G_CALLBACK(hide_pressed), s),
			true, false),
		kit_grow(kit_button("node-reset", NULL, _("As it was"), NULL, NULL,
				 G_CALLBACK(reset_pressed), s),
			true, false),
		NULL);
	return row;
}

/* Where the style filters the picture of all. */
static void append_picture(struct draw_screen *s, const style *now)
{
	g_autoptr(GArray) filters =
		now && s->node == SEGMENT_SITE ? style_steps(now, NULL, STYLE_PICTURE, NULL) : NULL;
	if (!filters || !filters->len)
		return;
	gtk_box_append(GTK_BOX(s->panel_box), kit_text(_("The whole picture"), "soft"));
	gtk_box_append(GTK_BOX(s->panel_box), step_sliders_new(filters, picture_slid, s));
}

void draw_panel_fill(struct draw_screen *s)
{
	if (!s->edit || !gtk_widget_get_visible(s->panel))
		return;
	g_autoptr(GError) error = NULL;
	g_autoptr(style) now = style_edit_style(s->edit, s->folder, &error);
	g_autoptr(GArray) steps = now ? style_steps(now, s->site->tree, s->node, &error) : NULL;
	kit_empty(s->panel_box);
	kiosk_complain_of(s->kiosk, error);
	GtkBox *box = GTK_BOX(s->panel_box);
	gtk_box_append(box, kit_named_text("node-name", node_name(s), "title"));
	gtk_box_append(box, kit_text(s->node == SEGMENT_SITE
					     ? _("Tap a thing in the picture to change only that.")
					     : _("A style from below is now for this alone."),
				    "small soft"));
	gtk_box_append(box, crumbs(s));
	if (s->node != SEGMENT_SITE)
		gtk_box_append(box, actions(s));
	if (steps)
		gtk_box_append(box, step_sliders_new(steps, slid, s));
	append_picture(s, now);
	if (now && s->node == SEGMENT_SITE)
		gtk_box_append(box, section_sliders_new(&now->whole, section_slid, s));
	gtk_box_append(box, kit_button("style-save", "document-save-symbolic", _("Keep as a style"),
				    NULL, "main", G_CALLBACK(save_pressed), s));
}

/* ---- the box around it ---- */

static bool project(const struct camera *c, const double p[3], double px[2])
{
	double depth;
	return camera_project(c, p, px, &depth);
}

static void edge(cairo_t *cr, const struct camera *c, const struct segment *n, int from, int to)
{
	double p[2][3], px[2][2];
	for (int k = 0; k < 3; k++) {
		p[0][k] = from >> k & 1 ? n->high_m[k] : n->low_m[k];
		p[1][k] = to >> k & 1 ? n->high_m[k] : n->low_m[k];
	}
	if (!project(c, p[0], px[0]) || !project(c, p[1], px[1]))
		return;
	cairo_move_to(cr, px[0][0], px[0][1]);
	cairo_line_to(cr, px[1][0], px[1][1]);
}

void draw_panel_marks(struct draw_screen *s, cairo_t *cr, const struct camera *c)
{
	const struct segment *n = node_of(s);
	if (!n || s->node < SEGMENT_FIRST || n->low_m[0] > n->high_m[0])
		return;
	for (int a = 0; a < 8; a++)
		for (int k = 0; k < 3; k++)
			if (!(a >> k & 1))
				edge(cr, c, n, a, a | 1 << k);
	/* Seen on any ground. */
	cairo_set_line_width(cr, 4);
	cairo_set_source_rgba(cr, 1, 1, 1, 0.85);
	cairo_stroke_preserve(cr);
	cairo_set_line_width(cr, 2);
	cairo_set_source_rgba(cr, 0.77, 0.34, 0.16, 1);
	cairo_stroke(cr);
}

/* ---- the panel ---- */

void draw_panel_show(struct draw_screen *s, bool visible)
{
	gtk_widget_set_visible(s->panel, visible);
	if (!visible)
		return;
	draw_accents_end(s);
	draw_panel_fill(s);
}

void draw_panel_close(struct draw_screen *s)
{
	draw_panel_show(s, false);
	s->leaf = 0;
	select_node(s, SEGMENT_SITE);
}

static void close_pressed(GtkButton *b, gpointer user_data)
{
	(void)b;
	draw_panel_close(user_data);
}

GtkWidget *draw_panel_new(struct draw_screen *s)
{
	s->panel_box = kit_column(12, NULL);
	GtkWidget *close = kit_button("panel-close", "window-close-symbolic", NULL, _("Close"),
		"flat", G_CALLBACK(close_pressed), s);
	gtk_widget_set_halign(close, GTK_ALIGN_END);
	s->panel = kit_classed(kit_column(0, close, kit_scroll(s->panel_box), NULL), "panel");
	gtk_widget_set_size_request(s->panel, PANEL_WIDTH, -1);
	gtk_widget_set_halign(s->panel, GTK_ALIGN_END);
	gtk_widget_set_visible(s->panel, FALSE);
	return s->panel;
}
