#include "render/mask-lanes.h"
#include "render/project-lanes.h"
#include <string.h>

/* ---- holes ---- */

INLINE vi keys_at(const int32_t *const rows[5], int down, int x)
{
	return *(const vi_loose *)(rows[down + 2] + x);
}

/* A pixel between two that are nearer, one or two pixels wide, belongs to them. */
INLINE vi filled(const int32_t *const rows[5], int x)
{
	static const int pairs[8][4] = { { -1, 0, 1, 0 }, { 0, -1, 0, 1 }, { -1, -1, 1, 1 },
		{ 1, -1, -1, 1 }, { -2, 0, 1, 0 }, { -1, 0, 2, 0 }, { 0, -2, 0, 1 },
		{ 0, -1, 0, 2 } };
	vi own = keys_at(rows, 0, x), between = own;
	for (int n = 0; n < 8; n++)
		between = lower(between, higher(keys_at(rows, pairs[n][1], x + pairs[n][0]),
						 keys_at(rows, pairs[n][3], x + pairs[n][2])));
	vi is_hole = (vf)between * MASK_HOLE < (vf)own;
	return (between & is_hole) | (own & ~is_hole);
}

INLINE void fill_row(const int32_t *const rows[5], int32_t *to, uint32_t width)
{
	for (int x = 0; x < (int)width; x += LANES)
		store_mask(to + x, filled(rows, x));
}

/* ---- threads' pictures together ---- */

/* Nothing beyond the picture's edges, whatever discs there left, and nothing above and below. */
INLINE void merge_row(const visibility_mask *m, int y, int32_t *to)
{
	const int32_t *row[FRAME_THREADS_MOST];
	if (y < 0 || y >= (int)m->height) {
		mask_clear(to - MASK_MARGIN, m->pitch);
		return;
	}
	for (uint32_t n = 0; n < m->threads; n++)
		row[n] = mask_first_key(m, m->part[n]) + (ptrdiff_t)y * m->pitch;
	for (int x = 0; x < (int)m->width; x += LANES) {
		vi key = load_mask(row[0] + x);
		for (uint32_t n = 1; n < m->threads; n++)
			key = lower(key, load_mask(row[n] + x));
		store_mask(to + x, key);
	}
	for (int x = 0; x < MASK_MARGIN; x++)
		to[-1 - x] = to[(int)m->width + x] = MASK_EMPTY;
}

/* ---- tiles ---- */

/* Keys of the deepest pixels so far of a row of tiles. */
INLINE void deepen(const int32_t *row, uint32_t width, vi *deepest)
{
	vi column = __builtin_convertvector(lane_number, vi);
	for (uint32_t x = 0; x < width; x += LANES)
		deepest[x / MASK_TILE] = higher(deepest[x / MASK_TILE],
			load_mask(row + x) & (column + (int32_t)x < (int32_t)width));
}

INLINE void put_tiles(visibility_mask *m, uint32_t down, vi *deepest)
{
	for (uint32_t across = 0; across < m->tiles_across; across++) {
		int32_t most = 0;
		for (int k = 0; k < LANES; k++)
			most = MAX(most, deepest[across][k]);
		m->deepest_m[down * m->tiles_across + across] = mask_depth(most);
		deepest[across] = (vi){ 0 };
	}
}

void LANES_NAME(mask_look)(visibility_mask *m, uint32_t down, struct mask_bench *b)
{
	uint32_t end = MIN((down + 1) * MASK_TILE, m->height);
	for (uint32_t y = down * MASK_TILE; y < end; y++) {
		merge_row(m, (int)y, b->row[0]);
		deepen(b->row[0], m->width, b->deepest);
	}
	put_tiles(m, down, b->deepest);
}

/* Of all threads' pictures: of tiles from .. end, two rows above and two below. Others draw over these when they finish theirs. */
void LANES_NAME(mask_look_around)(
	const visibility_mask *m, uint32_t from, uint32_t end, struct mask_bench *b)
{
	int top = (int)(from * MASK_TILE), below = (int)MIN(end * MASK_TILE, m->height);
	for (int k = 0; k < 2; k++) {
		merge_row(m, top - 2 + k, b->row[k]);
		merge_row(m, below + k, b->below[k]);
	}
}

/* The first picture of a thread becomes the mask's, row by row: those farther down are as they were. */
void LANES_NAME(mask_finish)(visibility_mask *m, uint32_t from, uint32_t end, struct mask_bench *b)
{
	int top = (int)(from * MASK_TILE), below = (int)MIN(end * MASK_TILE, m->height);
	for (int k = 0; k < 2 && from < end; k++)
		merge_row(m, top + k, b->row[2 + k]);
	for (int y = top; y < below; y++) {
		int32_t *to = m->key + (ptrdiff_t)y * m->pitch, *first = b->row[0];
		if (y + 2 < below)
			merge_row(m, y + 2, b->row[4]);
		else
			memcpy(b->row[4] - MASK_MARGIN, b->below[y + 2 - below] - MASK_MARGIN,
				m->pitch * sizeof *to);
		fill_row((const int32_t *const *)b->row, to, m->width);
		deepen(to, m->width, b->deepest);
		memmove(b->row, b->row + 1, 4 * sizeof *b->row);
		b->row[4] = first;
		if ((y + 1) % MASK_TILE == 0 || y + 1 == below)
			put_tiles(m, (uint32_t)y / MASK_TILE, b->deepest);
	}
}
