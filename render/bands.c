#include "render/bands.h"

/* From the first band to before the end. */
struct reach {
	uint32_t first, end;
};

/* more: rows beside those of the stroke that it is drawn for, too. */
static inline struct reach reach_of(struct stroke_span s, int32_t more, int32_t height)
{
	int32_t top = MAX(s.top - STROKE_SPAN_ABOVE - more, 0),
		end = MIN(s.end - STROKE_SPAN_ABOVE + more, height);
	if (top >= end)
		return (struct reach){ 0 };
	return (struct reach){ (uint32_t)top / BAND_ROWS, (uint32_t)(end - 1) / BAND_ROWS + 1 };
}

/* Parts of all blocks that are looked at side by side: so many that threads are done at about the same time. */
#define PARTS 32

/* What is filled. */
struct filling {
	band_lists *to;
	const frame *f;
	const struct stroke_blocks *of_layer;
	uint32_t height;
	uint32_t block_end[FRAME_LAYERS_MAX]; /* of all layers in a row */
	uint32_t *at; /* of each part, layer, and band: how many; then where they go */
};

/* Blocks of one layer that are in a part. */
struct piece {
	uint32_t layer, from, end;
};

static struct piece piece_of(const struct filling *w, uint32_t part, uint32_t layer)
{
	uint64_t all = w->block_end[w->f->layers - 1];
	uint32_t before = layer ? w->block_end[layer - 1] : 0,
		 from = (uint32_t)(all * part / PARTS), end = (uint32_t)(all * (part + 1) / PARTS);
	return (struct piece){ layer, MAX(from, before) - before,
		MAX(MIN(end, w->block_end[layer]), before) - before };
}

static int32_t more_of(const struct filling *w, const struct piece *p)
{
	return w->f->layer[p->layer].paint ? BAND_AROUND : 0;
}

static void count_piece(const struct filling *w, const struct piece *p, uint32_t *count)
{
	int32_t more = more_of(w, p), height = (int32_t)w->height;
	for (uint32_t k = p->from; k < p->end; k++) {
		const struct stroke_block *b = w->of_layer[p->layer].block[k];
		for (uint32_t n = 0; n < b->count; n++) {
			struct reach r = reach_of(b->span[n], more, height);
			for (uint32_t band = r.first; band < r.end; band++)
				count[band]++;
		}
	}
}

static void fill_piece(const struct filling *w, const struct piece *p, uint32_t *at)
{
	int32_t more = more_of(w, p), height = (int32_t)w->height;
	for (uint32_t k = p->from; k < p->end; k++) {
		const struct stroke_block *b = w->of_layer[p->layer].block[k];
		for (uint32_t n = 0; n < b->count; n++) {
			struct reach r = reach_of(b->span[n], more, height);
			for (uint32_t band = r.first; band < r.end; band++)
				w->to->which[at[band]++] = k << BAND_STROKE_BITS | n;
		}
	}
}

typedef void look_at_piece(const struct filling *w, const struct piece *p, uint32_t *at);

static void look_at_part(const struct filling *w, uint32_t part, look_at_piece *look)
{
	for (uint32_t n = 0; n < w->f->layers; n++) {
		struct piece p = piece_of(w, part, n);
		if (p.from < p.end)
			look(w, &p, w->at + (part * w->f->layers + n) * w->to->bands);
	}
}

/* Memory for so many, of any content; an eighth more, so that the next frames have enough of it too. */
static void *grown(void *memory, size_t *room, size_t count, size_t bytes)
{
	if (memory && count <= *room)
		return memory;
	g_free(memory);
	*room = count + count / 8 + 1;
	return g_malloc_n(*room, bytes);
}

/* Turns counts of all parts, layer by layer and band by band, into where each begins. */
static void lay_out(const struct filling *w)
{
	band_lists *b = w->to;
	uint32_t total = 0, lists = w->f->layers * b->bands;
	for (uint32_t k = 0; k < lists; k++) {
		for (uint32_t part = 0; part < PARTS; part++) {
			uint32_t own = w->at[part * lists + k];
			w->at[part * lists + k] = total;
			total += own;
		}
		b->end[k] = total;
	}
	b->which = grown(b->which, &b->room, total, sizeof *b->which);
}

void band_lists_fill(
	band_lists *b, const frame *f, const struct stroke_blocks *of_layer, uint32_t height)
{
	struct filling w = { b, f, of_layer, height };
	uint32_t blocks = 0;
	for (uint32_t n = 0; n < f->layers; n++)
		w.block_end[n] = blocks += of_layer[n].blocks;
	b->bands = (height + BAND_ROWS - 1) / BAND_ROWS;
	b->end = g_renew(uint32_t, b->end, f->layers * b->bands + 1);
	g_autofree uint32_t *at = w.at = g_new0(uint32_t, PARTS * f->layers * b->bands + 1);
#pragma omp parallel for schedule(dynamic, 1) if (!f->single_thread)
	for (uint32_t part = 0; part < PARTS; part++)
		look_at_part(&w, part, count_piece);
	lay_out(&w);
#pragma omp parallel for schedule(dynamic, 1) if (!f->single_thread)
	for (uint32_t part = 0; part < PARTS; part++)
		look_at_part(&w, part, fill_piece);
}

struct band_strokes band_strokes_of(
	const band_lists *b, const struct stroke_blocks *of_layer, uint32_t layer, uint32_t band)
{
	uint32_t list = layer * b->bands + band, first = list ? b->end[list - 1] : 0;
	return (struct band_strokes){ b->which + first, b->end[list] - first,
		of_layer[layer].block };
}

void band_lists_clear(band_lists *b)
{
	g_free(b->end);
	g_free(b->which);
	*b = (band_lists){ 0 };
}
