#include "render/pencil-box.h"
#include "render/colour-text.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <stdlib.h>

/* ---- hues ---- */

struct hsv hsv_of(const float rgb[3])
{
	float most = MAX(rgb[0], MAX(rgb[1], rgb[2])), least = MIN(rgb[0], MIN(rgb[1], rgb[2])),
	      range = most - least;
	struct hsv c = { 0, most > 0 ? range / most : 0, most };
	if (range <= 0)
		return c;
	if (most == rgb[0])
		c.hue = (rgb[1] - rgb[2]) / range;
	else if (most == rgb[1])
		c.hue = 2 + (rgb[2] - rgb[0]) / range;
	else
		c.hue = 4 + (rgb[0] - rgb[1]) / range;
	c.hue += c.hue < 0 ? 6 : 0;
	return c;
}

/* Each channel is full within a sixth of the circle around its own hue, and none a third away. */
static float full(float hue, float own)
{
	float away = fabsf(hue - own);
	away = MIN(away, 6 - away);
	return CLAMP(2 - away, 0, 1);
}

void hsv_to_rgb(const struct hsv *c, float ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = c->value * (1 - c->saturation * (1 - full(c->hue, 2 * (float)k)));
}

/* ---- a box ---- */

static int by_hue(const void *a, const void *b)
{
	const struct pencil *x = a, *y = b;
	return (x->hue > y->hue) - (x->hue < y->hue);
}

static void add(pencil_box *b, const char *colour)
{
	uint8_t bytes[3] = { 0 };
	float rgb[3];
	colour_of_text(colour, bytes);
	for (int k = 0; k < 3; k++)
		rgb[k] = (float)bytes[k] / 255;
	struct hsv c = hsv_of(rgb);
	if (c.saturation <= 0 || b->count == PENCIL_BOX_MOST)
		return;
	struct pencil *p = &b->pencil[b->count++];
	p->hue = c.hue;
	for (int k = 0; k < 3; k++)
		p->rgb[k] = rgb[k] / c.value;
}

pencil_box pencil_box_of(const char *json)
{
	pencil_box b = { 0 };
	g_autoptr(JsonNode) root = json_from_string(json, NULL);
	JsonArray *list = root && JSON_NODE_HOLDS_ARRAY(root) ? json_node_get_array(root) : NULL;
	for (guint i = 0; list && i < json_array_get_length(list); i++)
		add(&b, json_array_get_string_element(list, i));
	qsort(b.pencil, b.count, sizeof *b.pencil, by_hue);
	return b;
}

/* ---- a stroke ---- */

/* Which of the two pencils beside the hue. */
static const struct pencil *pick(const pencil_box *b, float hue, float chance)
{
	uint32_t n = 0;
	while (n < b->count && b->pencil[n].hue <= hue)
		n++;
	const struct pencil *below = &b->pencil[(n + b->count - 1) % b->count],
			    *above = &b->pencil[n % b->count];
	float room = above->hue - below->hue, away = hue - below->hue;
	room += room <= 0 ? 6 : 0;
	away += away < 0 ? 6 : 0;
	return chance * room < away ? above : below;
}

/* White takes from its fullness, black from its lightness. A pencil that is paler than the colour stays as it is. */
static void mix(const struct pencil *p, const struct hsv *c, float ret[3])
{
	float least = MIN(p->rgb[0], MIN(p->rgb[1], p->rgb[2])), own = 1 - least;
	float part = MIN(c->saturation / MAX(own, 1e-3f), 1);
	for (int k = 0; k < 3; k++)
		ret[k] = c->value * (1 - part * (1 - p->rgb[k]));
}

void pencil_box_draw(const pencil_box *b, float hue_shift_deg, float chance, float rgb[3])
{
	struct hsv c = hsv_of(rgb);
	c.hue += hue_shift_deg * (1 / 60.f);
	if (c.hue < 0 || c.hue >= 6)
		c.hue -= 6 * floorf(c.hue * (1 / 6.f));
	if (b->count)
		mix(pick(b, c.hue, chance), &c, rgb);
	else if (hue_shift_deg != 0)
		hsv_to_rgb(&c, rgb);
}
