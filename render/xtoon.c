#include "render/xtoon.h"
#include "render/colour-text.h"
#include "render/texels.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

struct stop {
	float brightness, depth; /* depth NAN: all */
	float rgba[4];
};

/* ---- stops ---- */

static float number_of(JsonObject *o, const char *name, double fallback)
{
	return (float)json_object_get_double_member_with_default(o, name, fallback);
}

static struct stop stop_of(JsonObject *o, const uint8_t ink[3])
{
	struct stop s = { number_of(o, "brightness", 0), number_of(o, "depth", NAN),
		{ ink[0], ink[1], ink[2], 255 * number_of(o, "chance", 1) } };
	const char *colour = json_object_get_string_member_with_default(o, "colour", "");
	uint8_t rgb[3];
	if (colour_of_text(colour, rgb))
		for (int k = 0; k < 3; k++)
			s.rgba[k] = rgb[k];
	return s;
}

static gint by_brightness(gconstpointer a, gconstpointer b)
{
	const struct stop *x = a, *y = b;
	return (x->brightness > y->brightness) - (x->brightness < y->brightness);
}

static gint by_value(gconstpointer a, gconstpointer b)
{
	const float *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

static bool is_at(const struct stop *s, float depth)
{
	return isnan(s->depth) || s->depth == depth;
}

static void between(const float *a, const float *b, float part, float *ret)
{
	for (int k = 0; k < 4; k++)
		ret[k] = a[k] + part * (b[k] - a[k]);
}

/* Of the stops of one depth, which are in the order of their brightness. */
static void colour_at(const GArray *stops, float depth, float brightness, float ret[4])
{
	const struct stop *below = NULL, *above = NULL;
	for (guint i = 0; i < stops->len && !above; i++) {
		const struct stop *s = &g_array_index(stops, struct stop, i);
		if (!is_at(s, depth))
			continue;
		if (s->brightness > brightness)
			above = s;
		else
			below = s;
	}
	below = below ? below : above;
	above = above ? above : below;
	float room = above->brightness - below->brightness;
	between(below->rgba, above->rgba, room > 0 ? (brightness - below->brightness) / room : 0,
		ret);
}

static GArray *depths_of(const GArray *stops)
{
	GArray *depths = g_array_new(FALSE, FALSE, sizeof(float));
	for (guint i = 0; i < stops->len; i++) {
		float depth = g_array_index(stops, struct stop, i).depth;
		bool known = isnan(depth);
		for (guint k = 0; k < depths->len; k++)
			known |= g_array_index(depths, float, k) == depth;
		if (!known)
			g_array_append_val(depths, depth);
	}
	g_array_sort(depths, by_value);
	return depths;
}

static void fill_row(const GArray *stops, const GArray *depths, float depth, uint8_t (*row)[4])
{
	guint n = 0;
	while (n < depths->len && g_array_index(depths, float, n) <= depth)
		n++;
	float low = n > 0 ? g_array_index(depths, float, n - 1) : NAN;
	float high = n < depths->len ? g_array_index(depths, float, n) : low;
	low = isnan(low) ? high : low;
	float part = high > low ? (depth - low) / (high - low) : 0;
	for (uint32_t x = 0; x < XTOON_COLUMNS; x++) {
		float near[4], far[4], rgba[4], light = (float)x / (XTOON_COLUMNS - 1);
		colour_at(stops, low, light, near);
		colour_at(stops, high, light, far);
		between(near, far, part, rgba);
		for (int k = 0; k < 4; k++)
			row[x][k] = (uint8_t)(rgba[k] + 0.5f);
	}
}

static GArray *parse(const char *json, const uint8_t ink[3])
{
	g_autoptr(JsonNode) root = json_from_string(json, NULL);
	JsonArray *list = root && JSON_NODE_HOLDS_ARRAY(root) ? json_node_get_array(root) : NULL;
	GArray *stops = g_array_new(FALSE, FALSE, sizeof(struct stop));
	for (guint i = 0; list && i < json_array_get_length(list); i++) {
		struct stop s = stop_of(json_array_get_object_element(list, i), ink);
		g_array_append_val(stops, s);
	}
	g_array_sort(stops, by_brightness);
	return stops;
}

static xtoon *alloc(uint32_t rows)
{
	xtoon *x = g_new0(xtoon, 1);
	x->rows = rows;
	x->rgba = g_malloc0((size_t)rows * XTOON_COLUMNS * sizeof *x->rgba);
	return x;
}

static xtoon *from_stops(const char *json, const uint8_t ink[3])
{
	g_autoptr(GArray) stops = parse(json, ink);
	g_autoptr(GArray) depths = depths_of(stops);
	g_assert(stops->len);
	xtoon *x = alloc(depths->len > 1 ? XTOON_ROWS_MOST : 1);
	for (uint32_t y = 0; y < x->rows; y++)
		fill_row(stops, depths,
			x->rows > 1 ? (float)y / (float)(x->rows - 1)
				    : (depths->len ? g_array_index(depths, float, 0) : 0),
			x->rgba + (size_t)y * XTOON_COLUMNS);
	return x;
}

/* ---- pictures ---- */

/* Where column or row n of so many lies in a picture: the first pixel, and how far on to the next. */
static uint32_t place_of(uint32_t n, uint32_t of, uint32_t pixels, float *ret_part)
{
	float at = of > 1 ? (float)n * (float)(pixels - 1) / (float)(of - 1) : 0;
	uint32_t first = MIN((uint32_t)at, pixels - 1);
	*ret_part = at - (float)first;
	return first;
}

static xtoon *from_png(const char *path, GError **error)
{
	uint32_t width, height;
	g_autofree uint8_t *pixel = texels_read_png_rgba(path, &width, &height, error);
	if (!pixel)
		return NULL;
	xtoon *x = alloc(MIN(height, XTOON_ROWS_MOST));
	for (uint32_t n = 0; n < x->rows * XTOON_COLUMNS; n++) {
		float u, v;
		uint32_t left = place_of(n % XTOON_COLUMNS, XTOON_COLUMNS, width, &u),
			 upper = place_of(n / XTOON_COLUMNS, x->rows, height, &v),
			 right = MIN(left + 1, width - 1), lower = MIN(upper + 1, height - 1);
		for (int k = 0; k < 4; k++) {
			const uint8_t *in = pixel + k;
			size_t row[2] = { (size_t)upper * width, (size_t)lower * width };
			float a = in[4 * (row[0] + left)], b = in[4 * (row[0] + right)],
			      c = in[4 * (row[1] + left)], d = in[4 * (row[1] + right)];
			a += u * (b - a);
			c += u * (d - c);
			x->rgba[n][k] = (uint8_t)(a + v * (c - a) + 0.5f);
		}
	}
	return x;
}

/* ---- all ---- */

xtoon *xtoon_new(const char *source, const uint8_t ink[3], GError **error)
{
	return *source == '[' ? from_stops(source, ink) : from_png(source, error);
}

void xtoon_free(xtoon *x)
{
	if (!x)
		return;
	g_free(x->rgba);
	g_free(x);
}
