#include "render/poster.h"
#include "render/filter.h"
#include "render/sheet-plan.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

/* Bytes of a pixel of a window: its keys, one of each thread and one of all sheets, and its colour; with filters all that
 * draw-sheets.c knows of it, and what the hungriest of them keep (measured). */
#define BYTES_PLAIN    12
#define BYTES_FILTERED 150
/* Windows either way, at most. */
#define SIDES_MOST  128u
#define INNER_LEAST 256u
/* What a mask knows beside a window is not all that there is: of holes, and of what lies around a pixel. */
#define EDGE_PX 8u

/* ---- margins ---- */

static float edl_looks(const frame *f, uint32_t sheet)
{
	float most = 0;
	for (guint p = 0; p < f->drawing->pipelines->len; p++) {
		const struct step *s = f->sheet_of[p] == sheet ? frame_step(f, p, "edl") : NULL;
		if (s)
			most = fmaxf(most, s->kind->radius_px(s->bytes) * f->px);
	}
	return most;
}

static uint64_t sheet_looks(const frame *f, uint32_t sheet)
{
	uint32_t filters;
	const struct step *steps = frame_filters(f, sheet, &filters);
	uint64_t looks = filter_looks(steps, filters, f->px);
	if (filters)
		looks += (uint32_t)fmaxf(
			frame_inpaint(f, sheet)->radius_px * f->px, SHEET_RADIUS_MOST);
	return looks + (uint64_t)fmaxf(edl_looks(f, sheet), (float)sheet_ink_reach(f, sheet));
}

/* How far strokes look around them in the mask. */
static float mask_looks_px(const frame *f)
{
	float most = 0;
	for (uint32_t n = 0; n < f->layers; n++) {
		const struct frame_layer *l = &f->layer[n];
		if (l->paint)
			most = fmaxf(most, (float)MAX(l->paint->hole_px, l->paint->gap_px));
		if (l->is_contours)
			most = fmaxf(most, CONTOURS_REACH * l->step->contours.band_px * f->ink_px);
	}
	return most;
}

uint32_t poster_margin_px(const frame *f)
{
	const struct pipeline *whole = &f->drawing->picture;
	uint64_t most = 0;
	for (uint32_t n = 0; n < f->sheets; n++)
		most = MAX(most, sheet_looks(f, n));
	most += filter_looks(whole->steps, whole->filters, f->px);
	most += (uint64_t)mask_looks_px(f) + EDGE_PX;
	return (uint32_t)MIN(most, UINT32_MAX);
}

/* ---- the grid ---- */

static size_t bytes_of(const frame *f, uint64_t pixels)
{
	size_t bytes = BYTES_PLAIN + 4 * frame_threads(f) + (f->is_filtered ? BYTES_FILTERED : 0);
	return bytes * pixels;
}

static uint64_t window_side(uint32_t side, uint32_t parts, uint32_t margin)
{
	return MIN((side + parts - 1) / parts + 2 * (uint64_t)margin, side);
}

/* What a window is for is no less than its margin: much smaller ones would be drawn many times over. */
static uint32_t parts_most(uint32_t side, uint32_t margin)
{
	return CLAMP(side / MAX(margin, INNER_LEAST), 1, SIDES_MOST);
}

struct asked {
	const frame *f;
	const struct camera *c;
	size_t bytes;
	uint32_t side_most, margin;
};

static uint64_t pixels_of(const struct asked *a, uint32_t columns, uint32_t rows)
{
	return window_side(a->c->width, columns, a->margin) *
	       window_side(a->c->height, rows, a->margin);
}

static bool fits(const struct asked *a, uint32_t columns, uint32_t rows)
{
	return bytes_of(a->f, pixels_of(a, columns, rows)) <= a->bytes &&
	       window_side(a->c->width, columns, a->margin) <= a->side_most &&
	       window_side(a->c->height, rows, a->margin) <= a->side_most;
}

/* Of all grids whose windows fit the one that draws the fewest pixels in all; where none fits, that with the smallest windows. */
struct poster_grid poster_grid_of(
	const frame *f, const struct camera *c, size_t bytes, uint32_t side_most)
{
	struct asked a = { f, c, bytes, side_most, poster_margin_px(f) };
	uint32_t rows_most = parts_most(c->height, a.margin),
		 columns_most = parts_most(c->width, a.margin);
	struct poster_grid best = { columns_most, rows_most, a.margin };
	uint64_t least = UINT64_MAX;
	if (a.margin == UINT32_MAX || fits(&a, 1, 1))
		return (struct poster_grid){ 1, 1, 0 };
	for (uint32_t rows = 1; rows <= rows_most; rows++)
		for (uint32_t columns = 1; columns <= columns_most; columns++) {
			uint64_t all = pixels_of(&a, columns, rows) * rows * columns;
			if (all >= least || !fits(&a, columns, rows))
				continue;
			best.columns = columns;
			best.rows = rows;
			least = all;
		}
	return best;
}

static uint32_t cut_at(uint32_t side, uint32_t parts, uint32_t n, uint32_t block)
{
	return n == parts ? side : (uint32_t)((uint64_t)side * n / parts) / block * block;
}

struct poster_window poster_window_at(const struct camera *c, const struct poster_grid *g,
	uint32_t reduce, uint32_t column, uint32_t row)
{
	uint32_t block = SHEET_BLOCK * reduce,
		 margin = (uint32_t)MIN(
			 ((uint64_t)g->margin_px + block - 1) / block * block, CAMERA_SIDE_MAX);
	struct poster_window w = { cut_at(c->width, g->columns, column, block),
		cut_at(c->height, g->rows, row, block),
		cut_at(c->width, g->columns, column + 1, block),
		cut_at(c->height, g->rows, row + 1, block), *c };
	if (g->columns == 1 && g->rows == 1)
		return w;
	uint32_t left = w.left - MIN(w.left, margin), top = w.top - MIN(w.top, margin);
	w.camera = camera_window(c, left, top, MIN(w.right + margin, c->width) - left,
		MIN(w.bottom + margin, c->height) - top);
	return w;
}

/* ---- drawing ---- */

struct poster {
	painter *painter;
	frame *f;
	const struct camera *c;
	const struct poster_desc *desc;
	struct poster_grid grid;
	uint32_t reduce;
	struct picture_buffer drawn, rows; /* a window; reduced, a row of them */
	struct draw_times sum;
};

static void add_times(struct draw_times *sum, const struct draw_times *t)
{
	double *to[] = { &sum->cull_s, &sum->mask_s, &sum->choose_s, &sum->bin_s, &sum->draw_s,
		&sum->all_s, &sum->filter_s, &sum->composite_s };
	const double add[] = { t->cull_s, t->mask_s, t->choose_s, t->bin_s, t->draw_s, t->all_s,
		t->filter_s, t->composite_s };
	for (size_t n = 0; n < G_N_ELEMENTS(to); n++)
		*to[n] += add[n];
	sum->points_in_view += t->points_in_view;
	sum->strokes += t->strokes;
	sum->chunks_in_view += t->chunks_in_view;
	sum->chunks_hidden += t->chunks_hidden;
}

/* As large as the window; memory of the largest so far. */
static void make_room(struct picture_buffer *b, size_t *room, uint32_t width, uint32_t height)
{
	size_t pixels = (size_t)width * height;
	if (pixels > *room) {
		picture_buffer_clear(b);
		*b = picture_buffer_new(width, height);
		*room = pixels;
	}
	b->width = width;
	b->height = height;
}

/* The part of what was drawn that the window is for, where its margins are cut off, in place: rows only move forward. */
static void cut_margins(struct picture_buffer *b, const struct poster_window *w)
{
	uint32_t left = w->left - w->camera.whole.left, top = w->top - w->camera.whole.top,
		 width = w->right - w->left, height = w->bottom - w->top;
	for (uint32_t y = 0; y < height; y++)
		memmove(b->rgba + (size_t)y * width, b->rgba + (size_t)(y + top) * b->width + left,
			(size_t)width * 4);
	b->width = width;
	b->height = height;
}

/* Into the rows, at its column. */
static void put_window(struct poster *p, const struct poster_window *w)
{
	struct picture_buffer small = picture_buffer_reduced(&p->drawn, p->reduce);
	for (uint32_t y = 0; y < small.height; y++)
		memcpy(p->rows.rgba + (size_t)y * p->rows.width + w->left / p->reduce,
			small.rgba + (size_t)y * small.width, (size_t)small.width * 4);
	picture_buffer_clear(&small);
}

static bool draw_window(
	struct poster *p, const struct poster_window *w, size_t *room, GError **error)
{
	struct draw_times t = { 0 };
	make_room(&p->drawn, room, w->camera.width, w->camera.height);
	if (!frame_move(p->f, &w->camera, error) ||
		!painter_draw(p->painter, p->f, &p->drawn, &t, error))
		return false;
	add_times(&p->sum, &t);
	cut_margins(&p->drawn, w);
	put_window(p, w);
	return true;
}

static bool draw_row(struct poster *p, uint32_t row, size_t *drawn, size_t *rows, GError **error)
{
	double all = (double)p->grid.columns * p->grid.rows;
	struct poster_window w = poster_window_at(p->c, &p->grid, p->reduce, 0, row);
	make_room(&p->rows, rows, p->c->width / p->reduce, (w.bottom - w.top) / p->reduce);
	for (uint32_t column = 0; column < p->grid.columns; column++) {
		w = poster_window_at(p->c, &p->grid, p->reduce, column, row);
		double part = (row * p->grid.columns + column + 1) / all;
		if (!draw_window(p, &w, drawn, error) ||
			(p->desc->going && !p->desc->going(p->desc->data, part, error)))
			return false;
	}
	return p->desc->take(p->desc->data, &p->rows, w.top / p->reduce, error);
}

static bool check_whole(const frame *f, const struct camera *c, GError **error)
{
	uint64_t pixels = (uint64_t)c->width * c->height;
	if (pixels <= POSTER_WHOLE_MOST || poster_margin_px(f) < UINT32_MAX)
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
		"a network of the style looks at all of the picture, which can then be drawn with "
		"at "
		"most %u million pixels, not %u",
		(unsigned)(POSTER_WHOLE_MOST / 1000000), (unsigned)(pixels / 1000000));
	return false;
}

bool poster_draw(painter *with, frame *f, const struct camera *c, const struct poster_desc *desc,
	struct draw_times *ret_times, GError **error)
{
	struct poster p = { .painter = with,
		.f = f,
		.c = c,
		.desc = desc,
		.reduce = MAX(desc->reduce, 1),
		.grid = poster_grid_of(
			f, c, desc->bytes ? desc->bytes : POSTER_BYTES, painter_side_most(with)) };
	size_t drawn = 0, rows = 0;
	bool good = check_whole(f, c, error);
	g_assert(c->width % p.reduce == 0 && c->height % p.reduce == 0);
	for (uint32_t row = 0; good && row < p.grid.rows; row++)
		good = draw_row(&p, row, &drawn, &rows, error);
	picture_buffer_clear(&p.drawn);
	picture_buffer_clear(&p.rows);
	if (good && ret_times)
		*ret_times = p.sum;
	return good;
}
