#include "render/kiosk/step-sliders.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

struct slider {
	const char *step_id; /* interned */
	const struct step_parameter *parameter;
	step_slid slid;
	gpointer user_data;
	GtkWidget *value;
};

static void tell(struct slider *s, JsonNode *value)
{
	s->slid(s->step_id, s->parameter, value, s->user_data);
}

static int digits_of(const struct step_parameter *p)
{
	double range = p->slider_most - p->slider_least;
	return range >= 100 ? 0 : range >= 10 ? 1 : 2;
}

static void show_value(struct slider *s, double value)
{
	g_autofree char *text = g_strdup_printf("%.*f %s", digits_of(s->parameter), value,
		s->parameter->unit ? s->parameter->unit : "");
	kit_set_text(s->value, g_strchomp(text));
}

static void number_slid(GtkRange *range, gpointer user_data)
{
	struct slider *s = user_data;
	double v = CLAMP(gtk_range_get_value(range), s->parameter->least, s->parameter->most);
	show_value(s, v);
	tell(s, json_node_init_double(json_node_alloc(), v));
}

static void switched(GtkSwitch *w, GParamSpec *what, gpointer user_data)
{
	(void)what;
	tell(user_data, json_node_init_boolean(json_node_alloc(), gtk_switch_get_active(w)));
}

static void chosen(GtkDropDown *w, GParamSpec *what, gpointer user_data)
{
	struct slider *s = user_data;
	guint n = gtk_drop_down_get_selected(w);
	(void)what;
	if (n != GTK_INVALID_LIST_POSITION)
		tell(s, json_node_init_string(json_node_alloc(), s->parameter->choices[n]));
}

/* ---- colours: inks and paints, the ones that people reach for ---- */

static const char *const palette[] = { "#000000", "#26241f", "#5a5148", "#8a8378", "#ffffff",
	"#8c2f1b", "#c4572a", "#d9a441", "#5b6e2c", "#2f5d3a", "#1f6d78", "#23437a", "#5a3a78",
	"#a23b6a", "#f4ecd8" };

static void swatch_pressed(GtkButton *button, gpointer user_data)
{
	const char *colour = g_object_get_data(G_OBJECT(button), "colour");
	tell(user_data, json_node_init_string(json_node_alloc(), colour));
}

static void draw_swatch(
	GtkDrawingArea *area, cairo_t *cr, int width, int height, gpointer user_data)
{
	GdkRGBA c;
	(void)area;
	gdk_rgba_parse(&c, user_data);
	cairo_set_source_rgb(cr, (double)c.red, (double)c.green, (double)c.blue);
	cairo_arc(cr, width / 2.0, height / 2.0, MIN(width, height) / 2.0 - 2, 0, 2 * G_PI);
	cairo_fill_preserve(cr);
	cairo_set_source_rgba(cr, 0.5, 0.5, 0.5, 0.8);
	cairo_set_line_width(cr, 1.5);
	cairo_stroke(cr);
}

static GtkWidget *swatch(struct slider *s, const char *colour)
{
	GtkWidget *area = gtk_drawing_area_new();
	gtk_drawing_area_set_content_width(GTK_DRAWING_AREA(area), 34);
	gtk_drawing_area_set_content_height(GTK_DRAWING_AREA(area), 34);
	gtk_drawing_area_set_draw_func(GTK_DRAWING_AREA(area), draw_swatch, (gpointer)colour, NULL);
	GtkWidget *button = gtk_button_new();
	gtk_button_set_child(GTK_BUTTON(button), area);
	kit_classed(button, "swatch");
	g_autofree char *name = g_strdup_printf("ink-%s", colour + 1);
	gtk_widget_set_name(button, name);
	gtk_accessible_update_property(
		GTK_ACCESSIBLE(button), GTK_ACCESSIBLE_PROPERTY_LABEL, colour, -1);
	g_object_set_data(G_OBJECT(button), "colour", (gpointer)colour);
	g_signal_connect(button, "clicked", G_CALLBACK(swatch_pressed), s);
	return button;
}

static GtkWidget *colour_row(struct slider *s)
{
	GtkWidget *flow = gtk_grid_new();
	for (guint i = 0; i < G_N_ELEMENTS(palette); i++)
		gtk_grid_attach(
			GTK_GRID(flow), swatch(s, palette[i]), (int)i % 5, (int)i / 5, 1, 1);
	gtk_grid_set_row_spacing(GTK_GRID(flow), 6);
	gtk_grid_set_column_spacing(GTK_GRID(flow), 6);
	return flow;
}

/* ---- one parameter ---- */

static GtkWidget *number_row(struct slider *s, float value, const char *name)
{
	const struct step_parameter *p = s->parameter;
	double least = fmin(p->slider_least, (double)value),
	       most = fmax(p->slider_most, (double)value);
	GtkWidget *scale = gtk_scale_new_with_range(
		GTK_ORIENTATION_HORIZONTAL, least, most, fmax((most - least) / 100, 1e-3));
	gtk_range_set_value(GTK_RANGE(scale), (double)value);
	gtk_widget_set_name(scale, name);
	show_value(s, (double)value);
	g_signal_connect(scale, "value-changed", G_CALLBACK(number_slid), s);
	return scale;
}

/* Caller frees. */
static char *capital(const char *text)
{
	if (!*text)
		return g_strdup("");
	g_autofree char *first = g_utf8_strup(text, g_utf8_next_char(text) - text);
	return g_strconcat(first, g_utf8_next_char(text), NULL);
}

static GtkWidget *choice_row(struct slider *s, int32_t which)
{
	g_autoptr(GPtrArray) words = g_ptr_array_new_with_free_func(g_free);
	for (const char *const *c = s->parameter->choices; *c; c++)
		g_ptr_array_add(words, capital(_(*c)));
	g_ptr_array_add(words, NULL);
	GtkWidget *w = gtk_drop_down_new_from_strings((const char *const *)words->pdata);
	gtk_drop_down_set_selected(GTK_DROP_DOWN(w), (guint)which);
	g_signal_connect(w, "notify::selected", G_CALLBACK(chosen), s);
	return w;
}

/* values: the struct that the parameter is of. */
static GtkWidget *widget_of(struct slider *s, const void *values)
{
	const struct step_parameter *p = s->parameter;
	const uint8_t *at = (const uint8_t *)values + p->offset;
	g_autofree char *name = g_strdup_printf("slider-%s-%s", s->step_id, p->name);
	float number;
	int32_t which;
	memcpy(&number, at, sizeof number);
	memcpy(&which, at, sizeof which);
	GtkWidget *w;
	if (p->type == PARAMETER_NUMBER)
		return number_row(s, number, name);
	if (p->type == PARAMETER_COLOUR)
		return colour_row(s);
	if (p->type == PARAMETER_BOOLEAN) {
		w = gtk_switch_new();
		gtk_switch_set_active(GTK_SWITCH(w), which != 0);
		gtk_widget_set_halign(w, GTK_ALIGN_START);
		g_signal_connect(w, "notify::active", G_CALLBACK(switched), s);
	} else
		w = choice_row(s, which);
	gtk_widget_set_name(w, name);
	return w;
}

/* "length_px" -> "Length"; the unit stands with the value. */
static char *words_of(const char *name)
{
	g_autofree char *words = g_strdelimit(g_strdup(name), "_", ' ');
	static const char *const units[] = { " px", " deg", " m", " s" };
	for (size_t i = 0; i < G_N_ELEMENTS(units); i++)
		if (g_str_has_suffix(words, units[i]))
			words[strlen(words) - strlen(units[i])] = '\0';
	if (words[0])
		words[0] = g_ascii_toupper(words[0]);
	return g_strdup(_(words));
}

/* Some parameters, of a step or a section: struct part. */
struct part {
	const char *id, *title; /* id: interned, or for ever */
	const struct step_parameter *parameters;
	const void *values;
	step_slid slid;
	gpointer user_data;
};

static GtkWidget *parameter_row(const struct part *of, const struct step_parameter *p)
{
	struct slider *s = g_new0(struct slider, 1);
	*s = (struct slider){ of->id, p, of->slid, of->user_data, NULL };
	g_autofree char *title = words_of(p->name);
	s->value = kit_line("value", "", "small number soft", false);
	GtkWidget *head = kit_row(
		8, kit_grow(kit_line("parameter", title, NULL, true), true, false), s->value, NULL);
	GtkWidget *value = widget_of(s, of->values), *row = kit_column(0, head, value, NULL);
	gtk_accessible_update_property(GTK_ACCESSIBLE(value), GTK_ACCESSIBLE_PROPERTY_LABEL, title,
		GTK_ACCESSIBLE_PROPERTY_DESCRIPTION, _(p->help), -1);
	gtk_widget_set_tooltip_text(row, _(p->help));
	g_object_set_data_full(G_OBJECT(row), "slider", s, g_free);
	return row;
}

/* Textures are files, lists are for editors, and places are tapped: not for sliders. */
static bool is_for_people(const struct step_parameter *p)
{
	return p->type != PARAMETER_TEXTURE && p->type != PARAMETER_XTOON &&
	       p->type != PARAMETER_PENCILS && p->type != PARAMETER_MODEL &&
	       !(p->type == PARAMETER_NUMBER && p->slider_least >= p->slider_most);
}

static GtkWidget *part_new(const struct part *of, bool open)
{
	GtkWidget *rows = kit_column(4, NULL);
	for (const struct step_parameter *p = of->parameters; p->name; p++)
		if (is_for_people(p))
			gtk_box_append(GTK_BOX(rows), parameter_row(of, p));
	GtkWidget *part = gtk_expander_new(of->title);
	gtk_expander_set_child(GTK_EXPANDER(part), rows);
	gtk_expander_set_expanded(GTK_EXPANDER(part), open);
	g_autofree char *name = g_strdup_printf("step-%s", of->id);
	gtk_widget_set_name(part, name);
	return part;
}

GtkWidget *step_sliders_new(const GArray *steps, step_slid slid, gpointer user_data)
{
	GtkWidget *all = kit_column(10, NULL);
	bool is_first = true;
	for (guint i = 0; i < steps->len; i++) {
		const struct step *step = &g_array_index(steps, struct step, i);
		if (step->kind->stage == STEP_MASK)
			continue;
		g_autofree char *title = g_strdup_printf("%s · %s", _(step->kind->title), step->id);
		struct part part = { step->id, title, step->kind->parameters, step->bytes, slid,
			user_data };
		gtk_box_append(GTK_BOX(all), part_new(&part, is_first));
		is_first = false;
	}
	if (is_first)
		gtk_box_append(GTK_BOX(all), kit_text(_("Nothing is drawn here."), "soft"));
	return all;
}

GtkWidget *section_sliders_new(const struct style_whole *whole, step_slid slid, gpointer user_data)
{
	GtkWidget *all = kit_column(10, NULL);
	for (const struct style_section *n = style_sections; n->name; n++) {
		g_autofree char *title = words_of(n->name);
		struct part part = { n->name, title, n->parameters, (const char *)whole + n->offset,
			slid, user_data };
		gtk_box_append(GTK_BOX(all), part_new(&part, false));
	}
	return all;
}
