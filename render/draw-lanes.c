#define LANES_MAY_BE_WIDE
#include "render/draw-lanes.h"
#include "render/draw-laid.h"
#include "render/edl.h"
#include "render/light.h"
#include "render/project-lanes.h"
#include "render/splat.h"
#include <math.h>
#include <string.h>

INLINE void fill(const struct band *b, float *plane, float value)
{
	for (size_t i = 0; i < (size_t)b->pitch * b->rows; i += LANES)
		store(plane + i, all(value));
}

/* ---- paper ---- */

INLINE void lay_row(const float colour[3], float grain, const uint8_t *height, uint32_t width,
	float *relief, float *const canvas[3])
{
	for (uint32_t x = 0; x < width; x += LANES) {
		vb_row h = { 0 };
		memcpy(&h, height + x, MIN(LANES, width - x));
		vf up = (__builtin_convertvector(h, vf) - PAPER_TEXTURE_MEAN) * (1 / 128.f);
		store(relief + x, up);
		for (int k = 0; k < 3; k++)
			store(canvas[k] + x, least(colour[k] * (1 + 0.5f * grain * up), all(1)));
	}
}

INLINE void lay_paper(const struct draw_job *j, const struct band *b, struct draw_desk *d)
{
	const struct style_paper *paper = &j->f->drawing->whole.paper;
	for (int k = 0; k < 3; k++)
		d->paper[k] = light_of_srgb((float)paper->colour[k] / 255);
	for (uint32_t y = b->from; y < b->from + b->rows; y++) {
		float *canvas[3] = { band_row(b, d->canvas[0], y), band_row(b, d->canvas[1], y),
			band_row(b, d->canvas[2], y) };
		lay_row(d->paper, j->flat ? 0 : paper->grain, j->f->relief + (size_t)y * b->width,
			b->width, band_row(b, d->relief, y), canvas);
	}
}

/* ---- coloured points ---- */

struct points_look {
	const struct points_step *step; /* NULL: shows none */
	float times;                    /* SCENE_EXPOSED() */
	const float *srgb_steps, *light_steps;
};

INLINE vf between_steps(const float *of_step, vf part)
{
	vf at = clamp01(part) * (LIGHT_STEPS - 1);
	vi step = __builtin_convertvector(at, vi);
	vf low = (vf)gather(of_step, step, 4), high = (vf)gather(of_step + 1, step, 4);
	return low + (at - __builtin_convertvector(step, vf)) * (high - low);
}

/* What the step makes of eight pixels. */
INLINE void show_eight(const struct points_look *look, const vf light[3], vf ret[3])
{
	const struct points_step *step = look->step;
	vf s[3], grey;
	for (int k = 0; k < 3; k++) {
		vf srgb = between_steps(look->srgb_steps, light[k]);
		vf exposed = SCENE_EXPOSED(look->times, srgb);
		s[k] = ((exposed - 0.5f) * step->contrast + 0.5f) * step->brightness;
	}
	grey = 0.299f * s[0] + 0.587f * s[1] + 0.114f * s[2];
	for (int k = 0; k < 3; k++)
		ret[k] = between_steps(look->light_steps, grey + step->saturation * (s[k] - grey));
}

static bool is_plain(const struct points_look *look)
{
	const struct points_step *s = look->step;
	return look->times == 1 && s->brightness == 1 && s->contrast == 1 && s->saturation == 1;
}

/* Of a pixel, in their planes. */
static size_t points_at(const struct draw_desk *d, uint32_t x, uint32_t y)
{
	return (size_t)(y - d->together.from) * d->together.pitch + BAND_MARGIN + x;
}

/* The light of a pixel that a hole of the mask was filled in at: of the pixels around that points cover. */
static bool light_around(const struct draw_job *j, const struct band *b, const struct draw_desk *d,
	uint32_t x, uint32_t y, float ret[3])
{
	float sum[4] = { 0 }, depth_m = mask_depth(mask_key(j->mask, (int32_t)x, (int32_t)y));
	for (int down = -2; down <= 2; down++)
		for (int right = -2; right <= 2; right++) {
			int at_x = (int)x + right, at_y = (int)y + down;
			if (at_y < (int)b->from || at_y >= (int)(b->from + b->rows) || at_x < 0 ||
				at_x >= (int)b->width)
				continue;
			size_t at = points_at(d, (uint32_t)at_x, (uint32_t)at_y);
			float there_m = mask_depth(mask_key(j->mask, at_x, at_y));
			if (!(d->weight[at] > 0) || fabsf(there_m - depth_m) > 0.05f * depth_m)
				continue;
			for (int k = 0; k < 3; k++)
				sum[k] += d->light[k][at];
			sum[3] += d->weight[at];
		}
	for (int k = 0; k < 3; k++)
		ret[k] = sum[k] / MAX(sum[3], 1e-9f);
	return sum[3] > 0;
}

/* Of eight pixels; returns those that show points. */
INLINE vi light_of_eight(const struct draw_job *j, const struct band *b, const struct draw_desk *d,
	uint32_t x, uint32_t y, vi shown, vf ret[3])
{
	size_t at = points_at(d, x, y);
	vf weight = load(d->weight + at);
	for (int k = 0; k < 3; k++)
		ret[k] = load(d->light[k] + at) / choose(weight > 0, weight, all(1));
	for (unsigned bare = bits(shown & ~(weight > 0)); bare; bare &= bare - 1) {
		int n = __builtin_ctz(bare);
		float light[3];
		shown[n] = light_around(j, b, d, x + (uint32_t)n, y, light) ? -1 : 0;
		for (int k = 0; k < 3; k++)
			ret[k][n] = light[k];
	}
	return shown;
}

INLINE void show_row(const struct draw_job *j, const struct band *b, struct draw_desk *d,
	const struct points_look looks[256], uint32_t y)
{
	const int32_t *keys = j->mask->key + (size_t)y * j->mask->pitch;
	for (uint32_t x = 0; x < b->width; x += LANES) {
		vi key = *(const vi_loose *)(keys + x), shown = { 0 };
		vf light[3];
		for (int n = 0; n < (int)MIN(LANES, b->width - x); n++)
			shown[n] = key[n] < MASK_EMPTY && looks[key[n] & 255].step ? -1 : 0;
		if (!any(shown))
			continue;
		shown = light_of_eight(j, b, d, x, y, shown, light);
		while (any(shown)) {
			int32_t pipeline = key[__builtin_ctz(bits(shown))] & 255;
			vi same = shown & ((key & 255) == pipeline);
			vf to[3] = { light[0], light[1], light[2] };
			if (!is_plain(&looks[pipeline]))
				show_eight(&looks[pipeline], light, to);
			for (int k = 0; k < 3; k++) {
				float *row = band_row(b, d->canvas[k], y) + x;
				store(row, choose(same, to[k], load(row)));
			}
			shown &= ~same;
		}
	}
}

static void show_points(const struct draw_job *j, const struct band *b, struct draw_desk *d)
{
	struct points_look looks[256] = { 0 };
	for (guint p = 0; p < MIN(j->f->drawing->pipelines->len, 256); p++) {
		const struct points_step *step = splat_step(j->f, (uint8_t)p);
		if (step)
			looks[p] = (struct points_look){ step,
				scene_exposure_of(j->f->scene, step->exposure), light_srgb_steps(),
				light_of_steps() };
	}
	for (uint32_t y = b->from; y < b->from + b->rows; y++)
		show_row(j, b, d, looks, y);
}

/* What is away from the focus fades to the paper. */
static void fade_to_paper(const struct draw_job *j, const struct band *b, struct draw_desk *d)
{
	const struct camera *c = &j->f->camera;
	const struct style_paper *paper = &j->f->drawing->whole.paper;
	float by_focal = 1 / (float)c->focal_px;
	for (uint32_t y = b->from; y < b->from + b->rows; y++)
		for (uint32_t x = 0; x < b->width; x++) {
			int32_t key = mask_key(j->mask, (int32_t)x, (int32_t)y);
			/* Beside things filters may have drawn: as deep as the focus. */
			bool is_bare = key >= MASK_EMPTY;
			if (is_bare && !j->ground)
				continue;
			float depth_m = is_bare ? fmaxf(j->f->focus.at_m[2], (float)c->near_m)
						: mask_depth(key);
			float scale_m = camera_scale_f(c, depth_m);
			float at_m[3] = { ((float)x + 0.5f - (float)camera_middle_x(c)) * by_focal *
						  scale_m,
				((float)y + 0.5f - (float)camera_middle_y(c)) * by_focal * scale_m,
				depth_m };
			float part = j->f->focus.amount *
				     frame_away(&j->f->focus, at_m,
					     !is_bare && frame_pipeline(j->f, key & 255)->is_focus);
			float up = 1 + 0.5f * paper->grain * band_row(b, d->relief, y)[x];
			for (int k = 0; k < 3; k++) {
				float *at = &band_row(b, d->canvas[k], y)[x],
				      bare = d->paper[k] * up;
				*at += part * (fminf(bare, 1) - *at);
			}
		}
}

INLINE void draw_points(const struct draw_job *j, struct draw_desk *d)
{
	for (int k = 0; k < 3; k++)
		fill(&d->together, d->light[k], 0);
	fill(&d->together, d->weight, 0);
	splat_band(&d->together, j->f, j->mask, j->views, j->count, d->light, d->weight);
}

/* ---- inks ---- */

INLINE vf uncovered(
	const struct frame_layer *l, const float *bare, const struct draw_desk *d, size_t at)
{
	return on_relief(load(bare + at), load(d->relief + at), l->ink.tooth);
}

/* What is of one ink multiplies what is below, or covers it. Most of a picture has no ink of a layer. */
INLINE void add_inked(
	const struct frame_layer *l, struct draw_desk *d, size_t at, enum band_blend blend)
{
	if (!any(load(d->ink.bare + at) < 1))
		return;
	vf bare = uncovered(l, d->ink.bare, d, at);
	store(d->ink.bare + at, all(1));
	for (int k = 0; k < 3; k++) {
		float ink = l->ink_linear[k];
		vf below = load(d->canvas[k] + at);
		store(d->canvas[k] + at, blend == BAND_COVERING ? below * bare + (1 - bare) * ink
								: below * (ink + (1 - ink) * bare));
	}
}

INLINE void add_coloured(const struct frame_layer *l, struct draw_desk *d, size_t at)
{
	for (int k = 0; k < 3; k++)
		store(d->canvas[k] + at,
			load(d->canvas[k] + at) * uncovered(l, d->ink.channel[k], d, at));
}

INLINE void add_painted(const struct frame_layer *l, struct draw_desk *d, size_t at)
{
	vf bare = uncovered(l, d->ink.bare, d, at), weight = load(d->ink.weight + at);
	store(d->ink.bare + at, all(1));
	for (int k = 0; k < 3; k++) {
		vf below = load(d->canvas[k] + at),
		   paint = load(d->ink.channel[k] + at) / most(weight, all(1e-12f));
		store(d->canvas[k] + at,
			choose(weight > 0, below * bare + (1 - bare) * paint, below));
	}
}

/* ---- layers ---- */

INLINE void add_layer(const struct frame_layer *l, const struct band *b, struct draw_desk *d)
{
	enum band_blend blend = band_blend_of(l);
	for (size_t at = 0; at < (size_t)b->pitch * b->rows; at += LANES)
		if (blend < BAND_COLOURED)
			add_inked(l, d, at, blend);
		else if (blend == BAND_COLOURED)
			add_coloured(l, d, at);
		else
			add_painted(l, d, at);
}

/* All is bare before; and after layers of paint sums are 0. */
INLINE void clear_ink(const struct frame_layer *l, const struct band *b, struct draw_desk *d)
{
	enum band_blend blend = band_blend_of(l);
	bool is_sum = blend >= BAND_PAINTED;
	if (blend < BAND_COLOURED || (blend == BAND_LAID && d->is_laid))
		return;
	for (int k = 0; k < 3; k++)
		fill(b, d->ink.channel[k], is_sum ? 0 : 1);
	if (is_sum)
		fill(b, d->ink.weight, 0);
	if (blend == BAND_LAID)
		fill(b, d->ink.height, 0);
	d->is_laid = blend == BAND_LAID;
}

INLINE void draw_layer(
	const struct draw_job *j, const struct band *b, struct draw_desk *d, uint32_t n)
{
	const struct frame_layer *l = &j->f->layer[n];
	struct band_strokes strokes =
		band_strokes_of(j->lists, j->of_layer, n, b->from / BAND_ROWS);
	if (!strokes.count)
		return;
	struct band drawn = l->paint ? laid_band(b, j->to->height) : *b, whole = *b;
	struct band_parts laid;
	if (l->paint) {
		laid = no_parts(b, l);
		d->ink.laid = &laid;
		whole.rows = BAND_ROWS + 2 * BAND_AROUND;
	}
	clear_ink(l, &whole, d);
	band_draw(&drawn, j->f, l, &strokes, l->stipple || l->is_profile ? NULL : j->mask, &d->ink);
	if (!l->paint) {
		add_layer(l, b, d);
		return;
	}
	add_laid(j, l, b, &drawn, d);
}

/* ---- a band ---- */

/* What filters made; where nothing is, on the paper's grain. */
INLINE void lay_ground(const struct draw_job *j, const struct band *b, struct draw_desk *d)
{
	const float *light = light_of_bytes();
	float grain = 0.5f * j->f->drawing->whole.paper.grain;
	for (uint32_t y = b->from; y < b->from + b->rows; y++) {
		const uint8_t(*from)[4] = j->ground->rgba + (size_t)y * b->width;
		const float *relief = band_row(b, d->relief, y);
		for (uint32_t x = 0; x < b->width; x++) {
			bool is_bare = mask_key(j->mask, (int32_t)x, (int32_t)y) >= MASK_EMPTY;
			float by = is_bare ? 1 + grain * relief[x] : 1;
			for (int k = 0; k < 3; k++)
				band_row(b, d->canvas[k], y)[x] = fminf(light[from[x][k]] * by, 1);
		}
	}
}

/* Of pixels side by side, whose light is there in the canvas. */
INLINE vi srgb_at(const struct draw_desk *d, size_t at)
{
	const uint8_t *srgb = light_srgb_bytes();
	vi ret = (vi)all(0) + (int32_t)0xff000000;
	for (int k = 0; k < 3; k++) {
		vf light = clamp01(load(d->canvas[k] + at));
		vi step = __builtin_convertvector(light * (LIGHT_STEPS - 1) + 0.5f, vi);
		ret |= (gather(srgb, step, 1) & 255) << 8 * k;
	}
	return ret;
}

INLINE void put_out(const struct draw_job *j, const struct band *b, const struct draw_desk *d)
{
	for (uint32_t y = b->from; y < b->from + b->rows; y++) {
		uint8_t(*to)[4] = j->to->rgba + (size_t)y * b->width;
		size_t row = (size_t)(y - b->from) * b->pitch + BAND_MARGIN;
		for (uint32_t x = 0; x < b->width; x += LANES) {
			vi rgba = srgb_at(d, row + x);
			if (b->width - x >= LANES)
				*(vi_loose *)(void *)to[x] = rgba;
			else
				memcpy(to[x], &rgba, (size_t)4 * (b->width - x));
		}
	}
}

INLINE void draw_band(const struct draw_job *j, const struct band *b, struct draw_desk *d)
{
	lay_paper(j, b, d);
	if (j->ground)
		lay_ground(j, b, d);
	else if (d->has_points)
		show_points(j, b, d);
	if (!j->ground)
		edl_shade(b, j->f, j->mask, d->canvas);
	if (j->f->focus.amount > 0 && !j->flat)
		fade_to_paper(j, b, d);
	for (uint32_t n = 0; j->lists && n < j->f->layers; n++)
		draw_layer(j, b, d, n);
	put_out(j, b, d);
}

/* Bands in a row, in d->together. */
void LANES_NAME(draw_together)(const struct draw_job *j, struct draw_desk *d)
{
	const struct band *t = &d->together;
	if (d->has_points)
		draw_points(j, d);
	for (uint32_t from = t->from; from < t->from + t->rows; from += BAND_ROWS) {
		struct band b = { t->width, from, MIN(BAND_ROWS, t->from + t->rows - from),
			t->pitch };
		draw_band(j, &b, d);
	}
}
