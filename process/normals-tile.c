#include "process/normals-tile.h"
#include "process/normals-plane.h"
#include "process/normals-window.h"
#include <string.h>

_Static_assert(TILE_STEP + 2 * (TILE_REACH + LINK_REACH) <= KEPT_ROWS, "they are kept");

tile *tile_new(void)
{
	return g_aligned_alloc0(1, sizeof(tile), 64);
}

void tile_free(tile *t)
{
	g_aligned_free(t);
}

/* ---- cells ---- */

INLINE struct place place_of(const struct tile_job *job, int y, int group, bool both)
{
	return (struct place){ .at = job->first + (size_t)(y - TILE_REACH) * job->pitch +
				     (size_t)group * GROUP,
		.below = both ? job->pitch : 0,
		.columns = (int)job->columns - group * GROUP,
		.ahead = 4 * job->pitch };
}

INLINE struct fit fit_lanes(
	const tile *t, const struct tile_job *job, int y, int c, const struct sums *s)
{
	return fit_plane(s, load(cell(t->w[kept(y)], c)), job->options->range_noise_m);
}

INLINE struct plane plane_at(
	const tile *t, const struct tile_job *job, int y, int c, const struct fit *f)
{
	return plane_of(t, f, load(cell(t->range[kept(y)], c)), job->options->range_noise_m);
}

INLINE void fit_blocks(tile *t, const struct tile_job *job, int y, int group)
{
	int c = MARGIN + TILE_REACH + group * GROUP;
	struct sums s = sum_blocks(t, job, y, c);
	struct fit f = fit_lanes(t, job, y, c, &s);
	struct plane p = plane_at(t, job, y, c, &f);
	put_planes(job->planes, place_of(job, y, group, true), &p, &p);
}

INLINE void fit_cells(tile *t, const struct tile_job *job, int y, int group, bool both)
{
	int c = MARGIN + TILE_REACH + group * GROUP;
	struct sums s[2][2];
	for (int odd = 0; odd < 2; odd++)
		sum_cells(t, job, y, c + odd, both, s[odd]);
	for (int below = 0; below <= both; below++) {
		struct fit f[2];
		struct plane p[2];
		for (int odd = 0; odd < 2; odd++) {
			f[odd] = fit_lanes(t, job, y + below, c + odd, &s[odd][below]);
			p[odd] = plane_at(t, job, y + below, c + odd, &f[odd]);
		}
		struct place at = place_of(job, y + below, group, false);
		put_planes(job->planes, at, &p[0], &p[1]);
		if (job->planes->count) {
			struct window even = window_of(t, &f[0]), odd = window_of(t, &f[1]);
			put_windows(job->planes, at, &even, &odd);
		}
	}
}

/* Rows y and y + 1. The windows of four cells side by side are all but the same, so one does for them; but not where something
 * ends between them. Who asks for the windows themselves gets those of cells. */
INLINE void fit_rows(tile *t, const struct tile_job *job, int y, int group)
{
	bool both = y + 1 < TILE_REACH + (int)job->rows;
	if (both && !job->planes->count && is_all_blocks(t, y, MARGIN + TILE_REACH + group * GROUP))
		fit_blocks(t, job, y, group);
	else
		fit_cells(t, job, y, group, both);
}

/* Some rows of a group are fitted, then those of the next: what their windows take in stays in the nearest cache. */
INLINE void fit_tile(tile *t, const struct tile_job *job, int first, int end)
{
	for (; t->taken < end + TILE_REACH + LINK_REACH; t->taken++)
		take_row(t, job, t->taken);
	for (int group = 0; group * GROUP < (int)job->columns; group++)
		for (int row = first; row < end; row += 2)
			fit_rows(t, job, row, group);
}

static void fit_tile_portable(tile *t, const struct tile_job *job, int first, int end)
{
	fit_tile(t, job, first, end);
}

#if defined __x86_64__
__attribute__((target("avx2,fma"))) static void fit_tile_avx2(
	tile *t, const struct tile_job *job, int first, int end)
{
	fit_tile(t, job, first, end);
}
#endif

static void put_nothing(const struct tile_job *job, uint32_t first, uint32_t end)
{
	const struct normals_planes *p = job->planes;
	float *none[] = { p->error_m, p->curvature },
	      *zero[] = { p->normal[0], p->normal[1], p->normal[2], p->count };
	for (uint32_t r = first; r < end; r++)
		for (uint32_t c = 0; c < job->columns; c++) {
			size_t i = job->first + r * job->pitch + c;
			for (size_t k = 0; k < G_N_ELEMENTS(none); k++)
				if (none[k])
					none[k][i] = NAN;
			for (size_t k = 0; k < G_N_ELEMENTS(zero); k++)
				if (zero[k])
					zero[k][i] = 0;
			if (p->offset_m)
				p->offset_m[i - p->offset_from] = 0;
		}
}

void tile_start(tile *t, const struct tile_job *job)
{
	t->has_segments = job->options->segment;
	t->height = (int)job->rows + 2 * TILE_REACH;
	t->width = (int)(job->columns + GROUP - 1) / GROUP * GROUP + 2 * TILE_REACH;
	t->is_empty = !set_frame(t, job);
	t->taken = -LINK_REACH;
	memset(t->sum_row, -1, sizeof t->sum_row);
	memset(t->block_row, -1, sizeof t->block_row);
}

void tile_fit(tile *t, const struct tile_job *job, uint32_t first, uint32_t end)
{
	const int from = TILE_REACH + (int)first, to = TILE_REACH + (int)end;
	if (t->is_empty) {
		put_nothing(job, first, end);
		return;
	}
#if defined __x86_64__
	if (!job->options->portable && __builtin_cpu_supports("avx2") &&
		__builtin_cpu_supports("fma")) {
		fit_tile_avx2(t, job, from, to);
		return;
	}
#endif
	fit_tile_portable(t, job, from, to);
}
