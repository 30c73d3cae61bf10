#include "acquire/brackets.h"
#include "acquire/srgb.h"
#include <string.h>

/* Colours (0..255) are summed in quarters; beyond black and white they go as far as chroma can take them. */
#define QUARTERS     4
#define BELOW        (300 * QUARTERS)
#define COLOURS      (860 * QUARTERS)
#define HAT_MIDDLE   128.0
#define HAT_END      248.0 /* from here on a camera may mean "at least" */
#define HAT_SCALE    512
#define LINEAR_SCALE (1 << 19)
/* Light is looked up by the bits of its float: so many steps each time it doubles, from 2^-13 to beyond 4. */
#define STEPS_BITS  8
#define LIGHT_SHIFT (23 - STEPS_BITS)
#define LIGHT_FIRST ((127u - 13) << STEPS_BITS)
#define LIGHT_COUNT (16u << STEPS_BITS)
/* What the curve gives, in parts of 0..255. */
#define CODE_SCALE 16

/* Stops this near are of the same angle. */
#define SAME_RAD (G_PI / 180)

struct made {
	struct photo photo;
	uint32_t frames;
};

struct brackets {
	struct exposures exposures;
	struct photo frames[EXPOSURES_MAX]; /* pixels NULL: did not come */
	double base_light;                  /* of the first stop: 0 before */
	GArray *made;                       /* of struct made */
};

/* ---- curves ---- */

double brackets_tone(double light)
{
	if (light <= BRACKETS_KNEE)
		return MAX(light, 0);
	double end = (BRACKETS_WHITE - BRACKETS_KNEE) / (1 - BRACKETS_KNEE),
	       t = fmin((light - BRACKETS_KNEE) / (1 - BRACKETS_KNEE), end);
	return BRACKETS_KNEE + (1 - BRACKETS_KNEE) * t * (1 + t / (end * end)) / (1 + t);
}

/* ---- tables ---- */

struct tables {
	/* Of each frame and colour: weight times linear value above, weight times the frame's light below, to be added at one go. Sums of three stay
	 * below 2^31. */
	uint64_t says[EXPOSURES_MAX][COLOURS];
	float unit; /* of a quotient of these sums, as light */
	uint16_t code[LIGHT_COUNT];
	int16_t luma[256], red[256], green_cb[256], green_cr[256], blue[256]; /* in quarters */
};

static double hat(double colour)
{
	return colour < HAT_MIDDLE ? colour / HAT_MIDDLE
				   : fmax((HAT_END - colour) / (HAT_END - HAT_MIDDLE), 0);
}

/* Where all are black the longest exposure says so, and where all are white, or nothing fits, the shortest: by the least weight there is. */
static void fill_says(uint64_t *says, double share, bool is_shortest, bool is_longest)
{
	for (int i = 0; i < COLOURS; i++) {
		double colour = CLAMP((double)(i - BELOW) / QUARTERS, 0.0, 255.0),
		       least = is_shortest || (is_longest && colour < HAT_MIDDLE),
		       weight = fmax(rint(HAT_SCALE * hat(colour)), least);
		uint64_t value = (uint64_t)rint(
				 weight * LINEAR_SCALE * srgb_to_linear(colour / 255)),
			 light = (uint64_t)rint(weight * LINEAR_SCALE * share);
		says[i] = value << 32 | MAX(light, weight > 0);
	}
}

static void fill_frames(
	struct tables *t, const struct bracket_frame *frames, uint32_t count, double base_light)
{
	double shortest = INFINITY, longest = 0;
	for (uint32_t i = 0; i < count; i++) {
		shortest = fmin(shortest, frames[i].light);
		longest = fmax(longest, frames[i].light);
	}
	for (uint32_t i = 0; i < count; i++)
		fill_says(t->says[i], frames[i].light / longest, frames[i].light == shortest,
			frames[i].light == longest);
	t->unit = (float)(base_light / longest);
}

static void fill_code(struct tables *t)
{
	for (uint32_t i = 0; i < LIGHT_COUNT; i++) {
		uint32_t bits = ((i + LIGHT_FIRST) << LIGHT_SHIFT) + (1u << (LIGHT_SHIFT - 1));
		float light;
		memcpy(&light, &bits, sizeof light);
		t->code[i] = (uint16_t)lrint(
			255 * CODE_SCALE * fmin(srgb_of(brackets_tone(i ? light : 0)), 1));
	}
}

/* BT.601, limited range, as colour.c takes it apart. */
static void fill_colours(struct tables *t)
{
	for (int i = 0; i < 256; i++) {
		t->luma[i] = (int16_t)lrint(QUARTERS * (i - 16) * 255.0 / 219);
		t->red[i] = (int16_t)lrint(QUARTERS * 1.596027 * (i - 128));
		t->green_cb[i] = (int16_t)lrint(QUARTERS * -0.391762 * (i - 128));
		t->green_cr[i] = (int16_t)lrint(QUARTERS * -0.812968 * (i - 128));
		t->blue[i] = (int16_t)lrint(QUARTERS * 2.017232 * (i - 128));
	}
}

/* ---- merging ---- */

#define BLOCK_COLOURS 12 /* of 2 x 2 pixels */

/* Light of each sum, and where the curve has it; by vectors. */
static inline void look_up(const struct tables *t, const uint64_t *sum, uint32_t *ret_code)
{
	float light[BLOCK_COLOURS];
	int32_t at[BLOCK_COLOURS];
	for (int i = 0; i < BLOCK_COLOURS; i++)
		light[i] = t->unit * (float)(int32_t)(sum[i] >> 32) / (float)(int32_t)sum[i];
	memcpy(at, light, sizeof at);
	for (int i = 0; i < BLOCK_COLOURS; i++)
		at[i] = CLAMP(
			(at[i] >> LIGHT_SHIFT) - (int32_t)LIGHT_FIRST, 0, (int32_t)LIGHT_COUNT - 1);
	for (int i = 0; i < BLOCK_COLOURS; i++)
		ret_code[i] = t->code[at[i]];
}

struct merging {
	const struct tables *tables;
	const struct bracket_frame *frames;
	uint32_t width, height;
	uint8_t *to;
};

static inline uint8_t luma_byte(uint32_t r, uint32_t g, uint32_t b)
{
	const uint32_t scale = CODE_SCALE * 65536;
	return (uint8_t)(16 + (16829 * r + 33039 * g + 6416 * b + scale / 2) / scale);
}

static const int32_t to_cb[3] = { -9714, -19070, 28784 }, to_cr[3] = { 28784, -24103, -4681 };

static inline uint8_t chroma_byte(const uint32_t *code, const int32_t to[3])
{
	const int32_t scale = CODE_SCALE * 65536;
	int32_t mean = 0;
	for (int c = 0; c < 3; c++)
		mean += to[c] *
			(int32_t)((code[c] + code[3 + c] + code[6 + c] + code[9 + c] + 2) / 4);
	return (uint8_t)CLAMP((mean + 128 * scale + scale / 2) / scale, 0, 255);
}

/* Four pixels that share their chroma. count is known where this is put in. */
static inline void merge_block(const struct merging *m, uint32_t count, size_t luma, size_t chroma)
{
	const struct tables *t = m->tables;
	const uint64_t *says[EXPOSURES_MAX][3];
	uint64_t sum[BLOCK_COLOURS];
	uint32_t code[BLOCK_COLOURS];
	for (uint32_t i = 0; i < count; i++) {
		const uint8_t *p = m->frames[i].pixels + chroma;
		const uint64_t *black = t->says[i] + BELOW;
		says[i][0] = black + t->red[p[1]];
		says[i][1] = black + t->green_cb[p[0]] + t->green_cr[p[1]];
		says[i][2] = black + t->blue[p[0]];
	}
	for (uint32_t k = 0; k < 4; k++) {
		size_t at = luma + (k & 1) + (k >> 1) * m->width;
		for (int c = 0; c < 3; c++)
			sum[3 * k + c] = 0;
		for (uint32_t i = 0; i < count; i++) {
			int y = t->luma[m->frames[i].pixels[at]];
			for (int c = 0; c < 3; c++)
				sum[3 * k + c] += says[i][c][y];
		}
	}
	look_up(t, sum, code);
	for (uint32_t k = 0; k < 4; k++) {
		const uint32_t *c = code + 3 * k;
		m->to[luma + (k & 1) + (k >> 1) * m->width] = luma_byte(c[0], c[1], c[2]);
	}
	m->to[chroma] = chroma_byte(code, to_cb);
	m->to[chroma + 1] = chroma_byte(code, to_cr);
}

static inline void merge_rows(const struct merging *m, uint32_t count, uint32_t y)
{
	size_t luma = (size_t)y * m->width, chroma = (size_t)m->width * m->height + luma / 2;
	for (uint32_t x = 0; x < m->width; x += 2)
		merge_block(m, count, luma + x, chroma + x);
}

void brackets_merge(const struct bracket_frame *frames, uint32_t count, double base_light,
	uint32_t width, uint32_t height, uint8_t *ret_pixels)
{
	g_autofree struct tables *t = g_new0(struct tables, 1);
	struct merging m = { t, frames, width, height, ret_pixels };
	g_assert(count >= 1 && count <= EXPOSURES_MAX);
	fill_frames(t, frames, count, base_light);
	fill_code(t);
	fill_colours(t);
#pragma omp parallel for
	for (uint32_t y = 0; y < height; y += 2)
		if (count == 3)
			merge_rows(&m, 3, y);
		else
			merge_rows(&m, count, y);
}

/* ---- stops ---- */

static void drop_pixels(struct photo *p)
{
	g_clear_pointer((gpointer *)&p->pixels, g_free);
}

static void made_clear(gpointer data)
{
	drop_pixels(&((struct made *)data)->photo);
}

brackets *brackets_new(void)
{
	brackets *b = g_new0(brackets, 1);
	b->made = g_array_new(FALSE, FALSE, sizeof(struct made));
	g_array_set_clear_func(b->made, made_clear);
	return b;
}

void brackets_free(brackets *b)
{
	if (!b)
		return;
	for (int i = 0; i < EXPOSURES_MAX; i++)
		drop_pixels(&b->frames[i]);
	g_array_unref(b->made);
	g_free(b);
}

static struct photo *first_of(brackets *b)
{
	for (int i = 0; i < EXPOSURES_MAX; i++)
		if (b->frames[i].pixels)
			return &b->frames[i];
	return NULL;
}

void brackets_add(
	brackets *b, const struct camera_frame_info *info, const uint8_t *pixels, double front_rad)
{
	int i = exposures_find(&b->exposures, &info->controls);
	const struct photo *other = first_of(b);
	if (i < 0 || b->frames[i].pixels ||
		(other && (other->info.width != info->width || other->info.height != info->height)))
		return;
	b->frames[i] =
		(struct photo){ *info, g_memdup2(pixels, camera_frame_bytes(info)), front_rad };
}

/* All frames of the stop as one, which keeps the first one's facts. */
static struct made merge_stop(brackets *b, struct photo *first)
{
	struct bracket_frame frames[EXPOSURES_MAX];
	struct made made = { .photo = *first };
	for (int i = 0; i < EXPOSURES_MAX; i++)
		if (b->frames[i].pixels)
			frames[made.frames++] = (struct bracket_frame){ b->frames[i].pixels,
				exposures_light(&b->frames[i].info.controls) };
	uint8_t *pixels = g_malloc(camera_frame_bytes(&first->info));
	brackets_merge(
		frames, made.frames, b->base_light, first->info.width, first->info.height, pixels);
	made.photo.pixels = pixels;
	for (int i = 0; i < EXPOSURES_MAX; i++)
		drop_pixels(&b->frames[i]);
	return made;
}

static void keep(brackets *b, struct made made)
{
	for (guint i = 0; i < b->made->len; i++) {
		struct made *other = &g_array_index(b->made, struct made, i);
		if (fabs(remainder(other->photo.front_rad - made.photo.front_rad, 2 * G_PI)) >
			SAME_RAD)
			continue;
		if (other->frames < made.frames) {
			made_clear(other);
			*other = made;
		} else
			made_clear(&made);
		return;
	}
	g_array_append_val(b->made, made);
}

void brackets_stop(brackets *b, const struct exposures *e)
{
	struct photo *first = first_of(b);
	if (first && b->exposures.count > 1)
		keep(b, merge_stop(b, first));
	else if (first)
		keep(b, (struct made){
				{ first->info, g_steal_pointer(&first->pixels), first->front_rad },
				1 });
	b->exposures = *e;
	if (b->base_light == 0 && e->count)
		b->base_light = exposures_light(&e->controls[0]);
}

uint32_t brackets_take(brackets *b, GArray *photos)
{
	uint32_t merged = 0;
	brackets_stop(b, &(struct exposures){ 0 });
	for (guint i = 0; i < b->made->len; i++) {
		struct made *made = &g_array_index(b->made, struct made, i);
		merged += made->frames > 1;
		g_array_append_val(photos, made->photo);
		made->photo.pixels = NULL;
	}
	g_array_set_size(b->made, 0);
	return merged;
}
