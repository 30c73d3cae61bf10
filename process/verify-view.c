#include "process/verify-view.h"

struct tally {
	uint16_t looked, nothing;
};

static void enter(
	struct verify_view *v, struct tally *tally, size_t at, const range_grid *g, uint32_t cell)
{
	struct verify_block *b = &v->block[at];
	float range = g->range_m[cell];
	if (range > 0) {
		b->near_m = b->near_m > 0 ? fminf(b->near_m, range) : range;
		b->far_m = fmaxf(b->far_m, range);
		v->range_max_m = fmaxf(v->range_max_m, range);
	}
	tally[at].looked += range > 0 || g->cell[cell] == CELL_NO_RETURN;
	tally[at].nothing += g->cell[cell] == CELL_NO_RETURN;
}

struct verify_view *verify_view_new(const range_grid *g, const pyramid *p)
{
	const struct range_lattice *l = &g->lattice;
	struct verify_view *v = g_new0(struct verify_view, 1);
	uint32_t across = (uint32_t)lround(p->column_rad / l->column_rad),
		 down = (uint32_t)lround(p->row_rad / l->row_rad);
	v->columns = p->level[0].columns;
	v->rows = p->level[0].rows;
	v->wraps = p->wraps;
	v->column_rad = (float)p->column_rad;
	v->row_rad = (float)p->row_rad;
	v->azimuth_min_rad = (float)p->azimuth_min_rad;
	v->elevation_max_rad = (float)p->elevation_max_rad;
	v->noise_m = (float)p->noise_m;
	v->surfel = p->level[0].surfel;
	size_t n = (size_t)v->columns * v->rows;
	v->block = g_new0(struct verify_block, n);
	g_autofree struct tally *tally = g_new0(struct tally, n);
	for (uint32_t r = 0; r < l->rows; r++)
		for (uint32_t c = 0; c < l->columns; c++) {
			size_t from = (size_t)r * l->columns + c;
			uint32_t cell = l->cell ? l->cell[from] : (uint32_t)from;
			uint32_t row = r / down, column = c / across;
			if (cell != RANGE_GRID_NONE && row < v->rows && column < v->columns)
				enter(v, tally, (size_t)row * v->columns + column, g, cell);
		}
	for (size_t i = 0; i < n; i++) {
		v->block[i].looked = (uint8_t)MIN(tally[i].looked, 255);
		v->block[i].nothing =
			tally[i].looked ? (uint8_t)(255 * tally[i].nothing / tally[i].looked) : 0;
	}
	return v;
}

void verify_view_free(struct verify_view *v)
{
	if (!v)
		return;
	g_free(v->block);
	g_free(v);
}
