#include "process/verify-view.h"

/* A cell is empty when this share of its beams did not come back. */
#define EMPTY_SHARE 0.9f

/* What the beams of one cell met. */
struct tally {
	float near_m, far_m;
	uint16_t looked, nothing;
};

static void enter(struct tally *t, const range_grid *g, uint32_t cell)
{
	float range = g->range_m[cell];
	bool nothing = g->cell[cell] == CELL_NO_RETURN;
	if (range > 0) {
		t->near_m = t->far_m > 0 ? fminf(t->near_m, range) : range;
		t->far_m = fmaxf(t->far_m, range);
	}
	t->looked += range > 0 || nothing;
	t->nothing += nothing;
}

static struct tally *count(const struct verify_view *v, const range_grid *g, const pyramid *p)
{
	const struct range_lattice *l = &g->lattice;
	struct tally *tally = g_new0(struct tally, (size_t)v->columns * v->rows);
	uint32_t across = (uint32_t)lround(p->column_rad / l->column_rad),
		 down = (uint32_t)lround(p->row_rad / l->row_rad);
	for (uint32_t r = 0; r < l->rows; r++)
		for (uint32_t c = 0; c < l->columns; c++) {
			size_t from = (size_t)r * l->columns + c;
			uint32_t cell = l->cell ? l->cell[from] : (uint32_t)from;
			uint32_t row = r / down, column = c / across;
			if (cell != RANGE_GRID_NONE && row < v->rows && column < v->columns)
				enter(&tally[(size_t)row * v->columns + column], g, cell);
		}
	return tally;
}

static struct verify_around gather(
	const struct verify_view *v, const struct tally *tally, int32_t row, int32_t column)
{
	struct verify_around a = { .near_m = INFINITY };
	for (int32_t dr = -1; dr <= 1; dr++)
		for (int32_t dc = -1; dc <= 1; dc++) {
			int64_t at = verify_view_at(v, row + dr, column + dc);
			if (at < 0 || !tally[at].looked)
				continue;
			const struct tally *t = &tally[at];
			a.looked++;
			a.empty += t->nothing >= EMPTY_SHARE * t->looked;
			if (t->far_m > 0) {
				a.near_m = fminf(a.near_m, t->near_m);
				a.far_m = fmaxf(a.far_m, t->far_m);
			}
		}
	return a;
}

struct verify_view *verify_view_new(const range_grid *g, const pyramid *p)
{
	struct verify_view *v = g_new(struct verify_view, 1);
	*v = (struct verify_view){ .columns = p->level[0].columns,
		.rows = p->level[0].rows,
		.wraps = p->wraps,
		.column_rad = (float)p->column_rad,
		.row_rad = (float)p->row_rad,
		.azimuth_min_rad = (float)p->azimuth_min_rad,
		.elevation_max_rad = (float)p->elevation_max_rad,
		.surfel = p->level[0].surfel,
		.beams = (float)(p->column_rad * p->row_rad / (g->column_rad * g->row_rad)),
		.around = g_new(
			struct verify_around, (size_t)p->level[0].columns * p->level[0].rows) };
	g_autofree struct tally *tally = count(v, g, p);
	for (uint32_t r = 0; r < v->rows; r++)
		for (uint32_t c = 0; c < v->columns; c++) {
			size_t at = (size_t)r * v->columns + c;
			v->around[at] = gather(v, tally, (int32_t)r, (int32_t)c);
			v->range_max_m = fmaxf(v->range_max_m, tally[at].far_m);
		}
	return v;
}

void verify_view_free(struct verify_view *v)
{
	if (!v)
		return;
	g_free(v->around);
	g_free(v);
}
