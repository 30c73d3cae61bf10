#include "render/bench-coherence-private.h"
#include <math.h>

#define CELL_COVERED 0.5  /* that count */
#define TILE_COVERED 0.99 /* covered whole */
#define TILE_STROKES 50   /* wanted in a tile: of fewer, chance says more than the layer */
#define TILES_LEAST  8u

struct cell {
	float covered; /* pixels */
	float wanted;  /* points that are needed, strokes that still fade in counted */
	float points;  /* that are shown, with their copies */
	float strokes; /* that are drawn, each by how far it has faded in */
};

struct cells {
	uint32_t columns, rows;
	struct cell *cell;
};

bool density_has(const struct frame_layer *l)
{
	return !l->is_contours && !l->is_profile && !l->stipple &&
	       l->kinds & (1 << FEATURE_NONE | 1 << FEATURE_DITHER);
}

static struct cell *cell_at(const struct cells *c, double x_px, double y_px)
{
	if (!(x_px >= 0 && y_px >= 0))
		return NULL;
	uint32_t column = (uint32_t)x_px / CELL_PX, row = (uint32_t)y_px / CELL_PX;
	return column < c->columns && row < c->rows ? &c->cell[row * c->columns + column] : NULL;
}

/* ---- what is wanted ---- */

static float wanted_at(const struct frame_layer *l, uint8_t lightness, int32_t key)
{
	if (!l->hatch)
		return l->wanted_per_px[lightness];
	return l->hatch->wanted_per_px[frame_hatch_shade(
		l->hatch, (float)lightness / 255, mask_depth(key))];
}

static void add_wanted(const struct cells *c, const struct frame_layer *l, const visibility_mask *m,
	const uint8_t *lightness)
{
	for (uint32_t y = 0; y < m->height; y++)
		for (uint32_t x = 0; x < m->width; x++) {
			int32_t key = mask_key(m, (int32_t)x, (int32_t)y);
			struct cell *cell = cell_at(c, x, y);
			if (!cell || key == MASK_EMPTY ||
				(key & ((1 << MASK_PIPELINE_BITS) - 1)) != l->pipeline)
				continue;
			cell->covered++;
			cell->wanted += wanted_at(l, lightness[(size_t)y * m->width + x], key);
		}
}

/* ---- what there is ---- */

static float strokes_of(const struct frame_layer *l, const scene *s, uint32_t point)
{
	bool spreads = (l->hatch || frame_layer_has_surface(l, s->kind[point])) &&
		       s->normal[point][0] != MODEL_NORMAL_NONE;
	uint32_t copies = spreads ? frame_copies(l) : 1;
	return (float)(s->kind[point] == FEATURE_UNDIRECTED ? MIN(copies, LEAVES_COPIES) : copies);
}

static void add_point(const struct cells *c, const visibility_mask *m, const struct chunk_view *v,
	const scene *s, uint32_t i, float strokes, const struct camera *camera)
{
	float at[3];
	uint32_t point = v->chunk->first + i;
	for (int k = 0; k < 3; k++)
		at[k] = v->base[k] + s->place[point].q[0] * v->axis[0][k] +
			s->place[point].q[1] * v->axis[1][k] + s->place[point].q[2] * v->axis[2][k];
	if (!(at[2] > camera->near_m))
		return;
	float scale = (float)camera->focal_px / camera_scale_f(camera, at[2]);
	float x = (float)camera->width / 2 + scale * at[0],
	      y = (float)camera->height / 2 + scale * at[1];
	struct cell *cell = cell_at(c, x, y);
	if (!cell || at[2] > mask_depth(mask_key(m, (int32_t)x, (int32_t)y)))
		return;
#pragma omp atomic
	cell->points += strokes;
}

static void add_points(
	const struct cells *c, const frame *f, const struct frame_layer *l, const struct shot *s)
{
#pragma omp parallel for schedule(dynamic, 4)
	for (uint32_t n = 0; n < s->view_count; n++) {
		const struct scene_chunk *chunk = s->views[n].chunk;
		if (s->views[n].pipeline != l->pipeline)
			continue;
		for (uint32_t i = 0; i < chunk->count; i++)
			if (l->kinds >> f->scene->kind[chunk->first + i] & 1)
				add_point(c, s->mask, &s->views[n], f->scene, i,
					strokes_of(l, f->scene, chunk->first + i), &s->camera);
	}
}

/* Of a point that has faded in, as ink_step (step.h) says; the mean of what differs by chance. */
static float opacity_of(const struct frame_layer *l, const scene *s, const struct stroke *stroke)
{
	const struct ink_step *ink = &l->ink;
	float faint = 1 - ink->degree * (1 - s->degree[stroke->point] / 255.f);
	float away = ink->fade_m > 0 ? exp2f(-1 / (stroke->q * ink->fade_m)) : 1;
	return ink->opacity * (1 - ink->opacity_variation / 2) * faint * away;
}

/* Of hatching: pressed as its chance is, and as long as it lies on the surface; those across come on top of it. Of paint: for all
 * those that are left out where there is little to see. */
static float weight_of(const frame *f, const struct frame_layer *l, const struct stroke *s)
{
	const struct frame_hatch *h = l->hatch;
	if (l->paint)
		return (float)s->aslant / 255 / l->paint->part[l->paint->seen->detail[s->point]];
	if (!h)
		return 1;
	float brightness = frame_hatch_brightness(f, h, s->point);
	float chance = h->chance[frame_hatch_shade(h, brightness, 1 / s->q)];
	float pressure = fmaxf(frame_hatch_pressure(&h->step, chance), 1e-3f);
	float larger = s->half_width_px * 2 / l->ink.width_px;
	return s->copy & 1 ? 0 : s->half_length_px * 2 / (l->ink.length_px * larger * pressure);
}

static void add_strokes(
	const struct cells *c, const frame *f, const struct frame_layer *l, const stroke_list *list)
{
	for (uint32_t n = 0; n < list->count; n++) {
		const struct stroke *s = &list->stroke[n];
		struct cell *cell = cell_at(c, s->x_px, s->y_px);
		float opacity = opacity_of(l, f->scene, s);
		if (cell && opacity > 0)
			cell->strokes += s->alpha / opacity * weight_of(f, l, s);
	}
}

/* ---- summed up ---- */

static bool is_limited(const struct cell *c)
{
	return c->points < c->wanted;
}

static void sum_cells(const struct cells *c, struct density *ret)
{
	double covered = 0, limited = 0, strokes = 0, wanted = 0;
	for (uint32_t n = 0; n < c->columns * c->rows; n++) {
		const struct cell *cell = &c->cell[n];
		covered += cell->covered;
		if (is_limited(cell))
			limited += cell->covered;
		else if (cell->covered >= CELL_COVERED * CELL_PX * CELL_PX) {
			strokes += cell->strokes;
			wanted += cell->wanted * STROKE_FADE_MEAN;
		}
	}
	ret->strokes = strokes;
	ret->wanted = wanted;
	ret->relative = wanted > 0 ? strokes / wanted : NAN;
	ret->limited_share = covered > 0 ? limited / covered : NAN;
}

static struct cell tile_at(const struct cells *c, uint32_t column, uint32_t row)
{
	struct cell sum = { 0 };
	for (uint32_t y = row; y < row + TILE_PX / CELL_PX; y++)
		for (uint32_t x = column; x < column + TILE_PX / CELL_PX; x++) {
			const struct cell *cell = &c->cell[y * c->columns + x];
			sum.covered += cell->covered;
			sum.wanted += cell->wanted;
			sum.points += cell->points;
			sum.strokes += cell->strokes;
		}
	return sum;
}

double coefficient_of_variation(const double *value, uint32_t count)
{
	double sum = 0, squares = 0;
	for (uint32_t n = 0; n < count; n++)
		sum += value[n];
	double mean = sum / count;
	for (uint32_t n = 0; n < count; n++)
		squares += (value[n] - mean) * (value[n] - mean);
	return count < 2 ? NAN : sqrt(squares / count) / mean;
}

static double tile_variation(const struct cells *c, bool with_limited)
{
	const uint32_t step = TILE_PX / CELL_PX;
	g_autofree double *relative = g_new(double, c->columns * c->rows + 1);
	uint32_t count = 0;
	for (uint32_t row = 0; row + step <= c->rows; row += step)
		for (uint32_t column = 0; column + step <= c->columns; column += step) {
			struct cell tile = tile_at(c, column, row);
			double wanted = tile.wanted * STROKE_FADE_MEAN;
			if (tile.covered >= TILE_COVERED * TILE_PX * TILE_PX &&
				wanted >= TILE_STROKES && (with_limited || !is_limited(&tile)))
				relative[count++] = tile.strokes / wanted;
		}
	return count < TILES_LEAST ? NAN : coefficient_of_variation(relative, count);
}

static struct cells cells_new(
	const frame *f, const struct shot *s, uint32_t layer, const uint8_t *lightness)
{
	const struct frame_layer *l = &f->layer[layer];
	struct cells c = { (s->mask->width + CELL_PX - 1) / CELL_PX,
		(s->mask->height + CELL_PX - 1) / CELL_PX };
	c.cell = g_new0(struct cell, c.columns * c.rows);
	add_wanted(&c, l, s->mask, lightness);
	add_points(&c, f, l, s);
	return c;
}

void density_find_limited(const frame *f, const struct shot *s, uint32_t layer,
	const uint8_t *lightness, bool *limited)
{
	const uint32_t step = TILE_PX / CELL_PX, across = s->mask->width / TILE_PX;
	struct cells c = cells_new(f, s, layer, lightness);
	for (uint32_t down = 0; down < s->mask->height / TILE_PX; down++)
		for (uint32_t n = 0; n < across; n++) {
			struct cell tile = tile_at(&c, n * step, down * step);
			limited[down * across + n] |= is_limited(&tile);
		}
	g_free(c.cell);
}

struct density density_of(
	const frame *f, const struct shot *s, uint32_t layer, const uint8_t *lightness)
{
	struct cells c = cells_new(f, s, layer, lightness);
	struct density d;
	add_strokes(&c, f, &f->layer[layer], &s->lists[layer]);
	sum_cells(&c, &d);
	d.cv = tile_variation(&c, false);
	d.cv_all = tile_variation(&c, true);
	g_free(c.cell);
	return d;
}
