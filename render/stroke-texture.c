#include "render/stroke-texture.h"
#include "render/stroke-media.h"
#include <string.h>

#define SEED 0x5ee7u

const struct stroke_texture_kind stroke_texture_kinds[STROKE_KINDS] = {
	[STROKE_GAUSSIAN] = { "gaussian", "Soft dot", stroke_gaussian },
	[STROKE_LINE] = { "line", "Line", stroke_line },
	[STROKE_DOT] = { "dot", "Round dot", stroke_dot },
	[STROKE_PENCIL] = { "pencil", "Pencil", stroke_pencil },
	[STROKE_INK_PEN] = { "ink-pen", "Ink pen", stroke_ink_pen },
	[STROKE_CHARCOAL] = { "charcoal", "Charcoal", stroke_charcoal },
	[STROKE_BRUSH] = { "brush", "Brush", stroke_brush },
	[STROKE_CHALK] = { "chalk", "Chalk", stroke_chalk },
	[STROKE_BRISTLES] = { "bristles", "Flat brush", stroke_bristles },
	[STROKE_DAB] = { "dab", "Dab of paint", stroke_dab },
};

static stroke_texture *texture_of(
	const char *name, uint32_t length, uint32_t width, uint32_t variants)
{
	stroke_texture *t = g_new0(stroke_texture, 1);
	*t = (stroke_texture){ g_strdup(name), length, width, variants };
	t->alpha = g_malloc0((size_t)length * width * variants);
	return t;
}

void stroke_texture_free(stroke_texture *t)
{
	if (!t)
		return;
	g_free(t->name);
	g_free(t->alpha);
	g_free(t);
}

static uint8_t *variant_of(stroke_texture *t, uint32_t variant)
{
	return t->alpha + (size_t)variant * t->length * t->width;
}

static void measure(stroke_texture *t)
{
	size_t n = (size_t)t->length * t->width;
	for (uint32_t k = 0; k < t->variants; k++)
		t->mean_alpha[k] = texels_mean(variant_of(t, k), n) / 255;
}

/* ---- made ---- */

/* 0 on the border texels, 1 a few further in. */
static float margin(const struct stroke_place *at)
{
	float x = fminf(at->x, STROKE_TEXTURE_LENGTH - at->x) - 0.5f;
	float y = fminf(at->y, STROKE_TEXTURE_WIDTH - at->y) - 0.5f;
	return fminf(x / 3, 1) * fminf(y / 2, 1);
}

static void make_variant(const struct stroke_texture_kind *kind, uint32_t seed, uint8_t *alpha)
{
	for (int y = 0; y < STROKE_TEXTURE_WIDTH; y++)
		for (int x = 0; x < STROKE_TEXTURE_LENGTH; x++) {
			struct stroke_place at = { .x = (float)x + 0.5f, .y = (float)y + 0.5f };
			at.along = at.x / STROKE_TEXTURE_LENGTH;
			at.across = 2 * at.y / STROKE_TEXTURE_WIDTH - 1;
			float a = CLAMP(kind->make(&at, seed), 0.0f, 1.0f) * margin(&at);
			*alpha++ = (uint8_t)lrintf(255 * a);
		}
}

static stroke_texture *make(enum stroke_kind kind)
{
	const struct stroke_texture_kind *k = &stroke_texture_kinds[kind];
	stroke_texture *t = texture_of(
		k->name, STROKE_TEXTURE_LENGTH, STROKE_TEXTURE_WIDTH, STROKE_TEXTURE_VARIANTS);
	for (uint32_t v = 0; v < t->variants; v++)
		make_variant(k, grain_hash(kind, v, SEED), variant_of(t, v));
	measure(t);
	return t;
}

/* ---- loaded ---- */

static void mirror(const uint8_t *from, uint8_t *to, bool along, bool across)
{
	for (int y = 0; y < STROKE_TEXTURE_WIDTH; y++)
		for (int x = 0; x < STROKE_TEXTURE_LENGTH; x++)
			*to++ = from[(across ? STROKE_TEXTURE_WIDTH - 1 - y : y) *
					     STROKE_TEXTURE_LENGTH +
				     (along ? STROKE_TEXTURE_LENGTH - 1 - x : x)];
}

static stroke_texture *load(const char *path, GError **error)
{
	enum { LENGTH = STROKE_TEXTURE_LENGTH - 2, WIDTH = STROKE_TEXTURE_WIDTH - 2 };
	uint32_t width, height;
	g_autofree uint8_t *ink = texels_read_png(path, TEXELS_INK, &width, &height, error);
	if (!ink)
		return NULL;
	g_autofree uint8_t *inner = g_malloc(LENGTH * WIDTH);
	texels_scale(ink, width, height, inner, LENGTH, WIDTH);
	if (texels_mean(inner, LENGTH * WIDTH) == 0) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"%s: has no ink: all of it is white or transparent", path);
		return NULL;
	}
	stroke_texture *t = texture_of(
		path, STROKE_TEXTURE_LENGTH, STROKE_TEXTURE_WIDTH, STROKE_TEXTURE_VARIANTS);
	for (int y = 0; y < WIDTH; y++)
		memcpy(t->alpha + (y + 1) * STROKE_TEXTURE_LENGTH + 1, inner + y * LENGTH, LENGTH);
	for (uint32_t v = 1; v < t->variants; v++)
		mirror(t->alpha, variant_of(t, v), v & 2, v & 1);
	measure(t);
	return t;
}

stroke_texture *stroke_texture_new(const char *name, GError **error)
{
	if (texels_is_path(name))
		return load(name, error);
	g_autoptr(GString) known = g_string_new(NULL);
	for (enum stroke_kind k = 0; k < STROKE_KINDS; k++) {
		if (strcmp(name, stroke_texture_kinds[k].name) == 0)
			return make(k);
		g_string_append_printf(known, "%s, ", stroke_texture_kinds[k].name);
	}
	g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT,
		"there is no stroke texture '%s': %sor the path of a PNG", name, known->str);
	return NULL;
}

stroke_texture *stroke_texture_scaled(const stroke_texture *t, uint32_t length, uint32_t width)
{
	stroke_texture *s = texture_of(t->name, length, width, t->variants);
	for (uint32_t v = 0; v < t->variants; v++)
		texels_scale(stroke_texture_variant(t, v), t->length, t->width, variant_of(s, v),
			length, width);
	measure(s);
	return s;
}
