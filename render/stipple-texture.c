#include "render/stipple-texture.h"
#include "render/large.h"

static void hold(struct stipple_texture *t, const struct stipple_plane *p)
{
	if (t->memory && t->columns == p->columns && t->rows == p->rows)
		return;
	stipple_texture_clear(t);
	size_t bytes = (size_t)p->pitch * (size_t)p->rows * sizeof *t->key;
	char *at = t->memory = large_new(2 * large_part(bytes));
	t->key = large_take(&at, bytes);
	t->other = large_take(&at, bytes);
	t->columns = p->columns;
	t->rows = p->rows;
	t->pitch = p->pitch;
}

void stipple_texture_begin(
	struct stipple_texture *t, const struct stipple_plane *p, bool single_thread)
{
	hold(t, p);
	ptrdiff_t texels = (ptrdiff_t)t->pitch * t->rows;
#pragma omp parallel for schedule(static) if (!single_thread)
	for (ptrdiff_t n = 0; n < texels; n++)
		t->key[n] = t->other[n] = STIPPLE_EMPTY;
}

void stipple_texture_spread(struct stipple_texture *t, const struct stipple_plane *p,
	enum lanes_path lanes, bool single_thread)
{
	for (uint32_t n = 0; n < p->passes; n++) {
#pragma omp parallel for schedule(static) if (!single_thread)
		for (int32_t row = 1; row < t->rows - 1; row++)
			LANES_OF(lanes, stipple_spread_row)
		(t->key, t->other, t->pitch, t->columns, row, p->step);
		int32_t *spread = t->other;
		t->other = t->key;
		t->key = spread;
	}
}

void stipple_texture_clear(struct stipple_texture *t)
{
	large_free(t->memory);
	*t = (struct stipple_texture){ 0 };
}
