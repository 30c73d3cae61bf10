#include "render/bench-bars.h"
#include "render/bench-reach.h"
#include <math.h>
#include <string.h>

#define WIDTH     360.0
#define LEFT      1.0
#define RIGHT     (WIDTH - 1)
#define ROW       37.0 /* of a text and its bar */
#define BAR       12.0
#define BAR_AT    17.0 /* below the text */
#define TOP       18.0 /* the line's label */
#define LOG_RATIO 20.0
/* Bars a person tells apart in grey, too. */
#define OURS  "#1f5fa8"
#define OTHER "#9aa3ab"
#define LINE  "#b3261e"

/* ---- scale ---- */

struct scale {
	double least, most;
	bool log;
};

static bool measured(JsonObject *o, double *ret)
{
	if (!json_object_has_member(o, "measured"))
		return false;
	*ret = json_object_get_double_member(o, "measured");
	return true;
}

static void include(struct scale *s, double value)
{
	s->most = fmax(s->most, value);
	if (value > 0)
		s->least = fmin(s->least, value);
}

static struct scale scale_of(JsonObject *row)
{
	struct scale s = { INFINITY, 0, false };
	JsonArray *peers = json_object_get_array_member(row, "peers");
	double value;
	include(&s, json_object_get_double_member(row, "wanted"));
	if (measured(row, &value))
		include(&s, value);
	for (guint n = 0; n < json_array_get_length(peers); n++)
		if (measured(json_array_get_object_element(peers, n), &value))
			include(&s, value);
	s.log = s.most > LOG_RATIO * s.least;
	if (s.log) {
		s.least = pow(10, floor(log10(s.least) - 0.3));
		s.most = pow(10, log10(s.most) + 0.1);
	} else {
		s.least = 0;
		s.most = s.most > 0 ? s.most * 1.08 : 1;
	}
	return s;
}

static double place(const struct scale *s, double value)
{
	double at =
		s->log ? (value > s->least ? log(value / s->least) / log(s->most / s->least) : 0)
		       : value / s->most;
	return LEFT + (RIGHT - LEFT) * CLAMP(at, 0.0, 1.0);
}

/* ---- parts ---- */

static char *px(double value)
{
	char text[G_ASCII_DTOSTR_BUF_SIZE];
	return g_strdup(g_ascii_formatd(text, sizeof text, "%.1f", value));
}

static void append_text(GString *to, double x, double y, const char *more, const char *text)
{
	g_autofree char *at_x = px(x), *at_y = px(y), *safe = g_markup_escape_text(text, -1);
	g_string_append_printf(to, "<text x=\"%s\" y=\"%s\"%s>%s</text>", at_x, at_y, more, safe);
}

static void append_bar(GString *to, double y, double end, const char *fill, const char *stroke)
{
	g_autofree char *x = px(LEFT), *at_y = px(y), *width = px(fmax(end - LEFT, 1.5)),
			*height = px(BAR);
	g_string_append_printf(to,
		"<rect x=\"%s\" y=\"%s\" width=\"%s\" height=\"%s\" fill=\"%s\" stroke=\"%s\"/>", x,
		at_y, width, height, fill, stroke);
}

/* A program: its name at the left, its figure at the right, its bar below both. */
struct bar {
	JsonObject *of;
	const char *name, *weight, *fill, *stroke;
};

static double bar_y(guint number)
{
	return TOP + 6 + ROW * number;
}

static void append_words(GString *to, double y, const struct bar *b, const char *unit)
{
	double value;
	const char *of = json_object_get_string_member_with_default(b->of, "of", NULL);
	g_autofree char *left = g_strdup_printf(" font-weight=\"%s\"", b->weight),
			*right = g_strdup_printf(
				" text-anchor=\"end\" font-weight=\"%s\"", b->weight);
	append_text(to, LEFT, y + 12, left, b->name);
	if (!measured(b->of, &value)) {
		append_text(to, LEFT, y + 28, " fill=\"#5c656d\" font-size=\"12\"",
			json_object_get_string_member_with_default(b->of, "why_not", ""));
		return;
	}
	g_autofree char *number = bench_reach_number(value),
			*text = of ? g_strdup_printf("%s %s (%s)", number, unit, of)
				   : g_strdup_printf("%s %s", number, unit);
	append_text(to, RIGHT, y + 12, right, text);
}

/* Ten times, a hundred times ... */
static void append_decades(GString *to, const struct scale *s, double bottom)
{
	for (double at = s->least; at <= s->most * 1.0001; at *= 10) {
		g_autofree char *x = px(place(s, at)), *y = px(bottom), *top = px(TOP + 4);
		g_string_append_printf(to,
			"<line x1=\"%s\" x2=\"%s\" y1=\"%s\" y2=\"%s\" stroke=\"#dfe3e6\"/>", x, x,
			top, y);
	}
}

static void append_stroke(GString *to, double at, double from, double until)
{
	g_autofree char *x = px(at), *top = px(from), *bottom = px(until);
	g_string_append_printf(to,
		"<line x1=\"%s\" x2=\"%s\" y1=\"%s\" y2=\"%s\" stroke=\"" LINE
		"\" stroke-width=\"2.5\"/>",
		x, x, top, bottom);
}

/* Across each bar, and not through the words between them. */
static void append_line(
	GString *to, const struct scale *s, JsonObject *row, const struct bar *bars, guint count)
{
	double at = place(s, json_object_get_double_member(row, "wanted")), value;
	g_autofree char *wish = bench_reach_wish(row), *label = g_strconcat("wanted: ", wish, NULL);
	const char *anchor = at < WIDTH * 0.3 ? "start" : at > WIDTH * 0.7 ? "end" : "middle";
	g_autofree char *more =
		g_strdup_printf(" text-anchor=\"%s\" fill=\"" LINE "\" font-size=\"12\"", anchor);
	append_text(to, at, TOP - 6, more, label);
	append_stroke(to, at, TOP - 3, TOP + 5);
	for (guint n = 0; n < count; n++)
		if (measured(bars[n].of, &value))
			append_stroke(
				to, at, bar_y(n) + BAR_AT - 2.5, bar_y(n) + BAR_AT + BAR + 2.5);
}

static void append_all(GString *to, const struct scale *s, JsonObject *row, const struct bar *bars,
	guint count, double bottom)
{
	double value;
	if (s->log)
		append_decades(to, s, bottom);
	for (guint n = 0; n < count; n++)
		if (measured(bars[n].of, &value))
			append_bar(to, bar_y(n) + BAR_AT, place(s, value), bars[n].fill,
				bars[n].stroke);
	append_line(to, s, row, bars, count);
	for (guint n = 0; n < count; n++)
		append_words(to, bar_y(n), &bars[n], json_object_get_string_member(row, "unit"));
}

/* ---- all of it ---- */

void bench_bars_append(GString *to, JsonObject *row, guint number)
{
	struct scale s = scale_of(row);
	JsonArray *peers = json_object_get_array_member(row, "peers");
	guint count = json_array_get_length(peers) + 1;
	bool reached = json_object_get_boolean_member_with_default(row, "reached", FALSE);
	double bottom = bar_y(count), height = bottom + 20;
	g_autofree char *high = px(height), *hatch = g_strdup_printf("url(#hatch%u)", number);
	g_autofree char *what =
		g_markup_escape_text(json_object_get_string_member(row, "what"), -1);
	g_string_append_printf(to,
		"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 360 %s\" role=\"img\" "
		"aria-label=\"%s\" font-family=\"system-ui,'DejaVu Sans',sans-serif\" "
		"font-size=\"13\" fill=\"#1c2226\">"
		"<defs><pattern id=\"hatch%u\" width=\"6\" height=\"6\" "
		"patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">"
		"<rect width=\"6\" height=\"6\" fill=\"#fff\"/><rect width=\"2.6\" height=\"6\" "
		"fill=\"" OURS "\"/></pattern></defs>",
		high, what, number);
	g_autofree struct bar *bars = g_new(struct bar, count);
	bars[0] = (struct bar){ row, "pleinair", "700", reached ? OURS : hatch, OURS };
	for (guint n = 1; n < count; n++) {
		JsonObject *peer = json_array_get_object_element(peers, n - 1);
		bars[n] = (struct bar){ peer, json_object_get_string_member(peer, "name"), "400",
			OTHER, OTHER };
	}
	append_all(to, &s, row, bars, count, bottom);
	g_autofree char *better = g_strdup_printf("%s is better%s",
		json_object_get_boolean_member(row, "at_least") ? "more" : "less",
		s.log ? "; log scale: a line every ten times" : "");
	append_text(to, RIGHT, height - 6, " text-anchor=\"end\" font-size=\"11\" fill=\"#5c656d\"",
		better);
	g_string_append(to, "</svg>\n");
}
