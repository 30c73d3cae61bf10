#include "process/scribble-window.h"
#include "process/watershed.h"
#include <string.h>

struct window {
	uint32_t column, row, columns, rows; /* columns may run on over the seam */
	bool wraps;                          /* it is all around */
};

static void mark_used(const range_grid *g, int32_t inside, const int32_t *label, bool *column,
	uint32_t *ret_top, uint32_t *ret_bottom)
{
	*ret_top = g->rows;
	*ret_bottom = 0;
	for (uint32_t r = 0; r < g->rows; r++)
		for (uint32_t c = 0; c < g->columns; c++) {
			int32_t l = label[(size_t)r * g->columns + c];
			if (l != 0 && l != inside)
				continue;
			column[c] = true;
			*ret_top = MIN(*ret_top, r);
			*ret_bottom = r;
		}
}

/* The columns beside the longest run of those that are not used; where the grid does not wrap a run ends at its sides, which
 * the one before the first column and behind the last one stand for. */
static void choose_columns(const range_grid *g, const bool *used, struct window *w)
{
	uint32_t n = g->columns, first = 0, last = n - 1;
	if (!g->wraps) {
		while (first < n && !used[first])
			first++;
		while (last > first && !used[last])
			last--;
		w->column = first ? first - 1 : 0;
		w->columns = MIN(last + 1, n - 1) - w->column + 1;
		return;
	}
	uint32_t longest = 0, end = 0, run = 0;
	for (uint32_t k = 0; k < 2 * n; k++) {
		run = used[k % n] ? 0 : run + 1;
		if (run > longest && run <= n) {
			longest = run;
			end = k % n;
		}
	}
	w->wraps = longest < 3; /* one more at each side would leave none */
	w->column = w->wraps ? 0 : end;
	w->columns = w->wraps ? n : n - longest + 2;
}

static size_t cell_at(const range_grid *g, const struct window *w, uint32_t r, uint32_t c)
{
	return (size_t)(w->row + r) * g->columns + (w->column + c) % g->columns;
}

static void flood_copy(const range_grid *g, const struct scribble_edges *edges,
	const struct window *w, int32_t *label)
{
	size_t n = (size_t)w->columns * w->rows;
	g_autofree float *right = g_new(float, n), *down = g_new(float, n);
	g_autofree int32_t *part = g_new(int32_t, n);
	for (uint32_t r = 0; r < w->rows; r++)
		for (uint32_t c = 0; c < w->columns; c++) {
			size_t to = (size_t)r * w->columns + c, from = cell_at(g, w, r, c);
			right[to] = edges->step_right[from];
			down[to] = edges->step_down[from];
			part[to] = label[from];
		}
	struct watershed_image image = { .columns = w->columns,
		.rows = w->rows,
		.wraps = w->wraps,
		.step_right = right,
		.step_down = down };
	watershed_flood(&image, part);
	for (uint32_t r = 0; r < w->rows; r++)
		for (uint32_t c = 0; c < w->columns; c++)
			label[cell_at(g, w, r, c)] = part[(size_t)r * w->columns + c];
}

void scribble_window_flood(
	const range_grid *g, const struct scribble_edges *edges, int32_t inside, int32_t *label)
{
	uint32_t top, bottom;
	g_autofree bool *used = g_new0(bool, g->columns);
	mark_used(g, inside, label, used, &top, &bottom);
	if (top > bottom)
		return;
	struct window w = { .row = top ? top - 1 : 0 };
	w.rows = MIN(bottom + 1, g->rows - 1) - w.row + 1;
	choose_columns(g, used, &w);
	flood_copy(g, edges, &w, label);
}
