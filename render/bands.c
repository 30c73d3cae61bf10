#include "render/bands.h"
#include <math.h>

/* Rows that the stroke may touch. */
static inline float reach_down(const struct stroke *s)
{
	return fabsf(s->along[1]) * s->half_length_px + fabsf(s->along[0]) * s->half_width_px + 1;
}

struct reach {
	uint16_t first, end; /* bands */
};

static struct reach bands_of(const struct stroke *s, float more, uint32_t height)
{
	float reach = reach_down(s) + more, low = s->y_px - reach, high = s->y_px + reach;
	if (high < 0 || low >= (float)height)
		return (struct reach){ 0 };
	return (struct reach){ (uint16_t)(fmaxf(low, 0) / BAND_ROWS),
		(uint16_t)(fminf(high, (float)(height - 1)) / BAND_ROWS + 1) };
}

/* Parts of a layer that are looked at side by side: so many that threads are done at about the same time. */
#define PARTS 16

static uint32_t part_end(const struct stroke_blocks *strokes, uint32_t parts)
{
	return (uint32_t)((uint64_t)strokes->blocks * parts / PARTS);
}

static void count_part(const struct stroke_blocks *strokes, uint32_t part, float more,
	uint32_t height, struct reach *reach, uint32_t *count)
{
	for (uint32_t k = part_end(strokes, part); k < part_end(strokes, part + 1); k++) {
		const struct stroke_block *b = strokes->block[k];
		for (uint32_t n = 0; n < b->count; n++) {
			struct reach r = reach[b->first + n] =
				bands_of(&b->stroke[n], more, height);
			for (uint32_t band = r.first; band < r.end; band++)
				count[band]++;
		}
	}
}

/* Memory for so many, of any content; a quarter more, so that the next frames have enough of it too. */
static void *grown(void *memory, size_t *room, size_t count, size_t bytes)
{
	if (memory && count <= *room)
		return memory;
	g_free(memory);
	*room = count + count / 4 + 1;
	return g_malloc_n(*room, bytes);
}

/* Turns counts of all parts, band by band, into where each begins. */
static void lay_out(band_lists *b, uint32_t *count)
{
	uint32_t total = 0;
	for (uint32_t k = 0; k < b->bands; k++) {
		for (uint32_t part = 0; part < PARTS; part++) {
			uint32_t own = count[part * b->bands + k];
			count[part * b->bands + k] = total;
			total += own;
		}
		b->end[k] = total;
	}
	b->which = grown(b->which, &b->room, total, sizeof *b->which);
}

static void fill_part(band_lists *to, const struct stroke_blocks *strokes, uint32_t part,
	const struct reach *reach, uint32_t *at)
{
	for (uint32_t k = part_end(strokes, part); k < part_end(strokes, part + 1); k++) {
		const struct stroke_block *b = strokes->block[k];
		for (uint32_t n = 0; n < b->count; n++) {
			struct reach r = reach[b->first + n];
			for (uint32_t band = r.first; band < r.end; band++)
				to->which[at[band]++] = &b->stroke[n];
		}
	}
}

void band_lists_fill(band_lists *b, const struct frame_layer *l,
	const struct stroke_blocks *strokes, uint32_t height, bool single_thread)
{
	float more = l->paint ? BAND_AROUND : 0;
	b->bands = (height + BAND_ROWS - 1) / BAND_ROWS;
	b->end = g_renew(uint32_t, b->end, b->bands + 1);
	g_autofree struct reach *reach = g_new(struct reach, strokes->count + 1);
	g_autofree uint32_t *at = g_new0(uint32_t, PARTS * b->bands);
#pragma omp parallel for schedule(dynamic, 1) if (!single_thread)
	for (uint32_t part = 0; part < PARTS; part++)
		count_part(strokes, part, more, height, reach, at + part * b->bands);
	lay_out(b, at);
#pragma omp parallel for schedule(dynamic, 1) if (!single_thread)
	for (uint32_t part = 0; part < PARTS; part++)
		fill_part(b, strokes, part, reach, at + part * b->bands);
}

void band_lists_clear(band_lists *b)
{
	g_clear_pointer(&b->end, g_free);
	g_free(b->which);
	*b = (band_lists){ 0 };
}
