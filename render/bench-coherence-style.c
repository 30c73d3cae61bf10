#include "render/bench-coherence-style.h"
#include <math.h>
#include <string.h>

/* ---- opened ---- */

/* One mask does for both: the same discs, and no pipelines to tell apart. */
static bool shares_mask(const drawing *a, const drawing *b)
{
	const struct pipeline *x = &g_array_index(a->pipelines, struct pipeline, 0),
			      *y = &g_array_index(b->pipelines, struct pipeline, 0);
	return a->pipelines->len == 1 && b->pipelines->len == 1 &&
	       memcmp(&x->mask, &y->mask, sizeof x->mask) == 0;
}

static char *title_of(const char *name)
{
	char *title = g_path_get_basename(name);
	if (g_str_has_suffix(title, ".json"))
		title[strlen(title) - strlen(".json")] = 0;
	return title;
}

/* The first layer of hatching. */
static const struct frame_layer *hatching_of(const frame *f)
{
	for (uint32_t l = 0; l < f->layers; l++)
		if (f->layer[l].hatch)
			return &f->layer[l];
	return NULL;
}

static void lighten(struct styled *s)
{
	const struct frame_layer *l = hatching_of(s->frame);
#pragma omp parallel for schedule(static)
	for (uint32_t n = 0; n < s->bright->count; n++) {
		float light = frame_hatch_brightness(s->frame, l->hatch, n);
		memset(s->bright->rgba[n], (int)(255 * CLAMP(light, 0, 1) + 0.5f), 3);
		s->bright->rgba[n][3] = 255;
	}
}

/* Plain points, in no light, in place of what it draws. */
static drawing *plain_drawing(drawing *d)
{
	for (guint n = 0; d && n < d->pipelines->len; n++) {
		struct pipeline *p = &g_array_index(d->pipelines, struct pipeline, n);
		p->steps[0] = step_defaults(step_kind_find("points"));
		p->layers = 1;
		p->filters = 0;
	}
	if (d)
		d->whole.light.amount = d->whole.focus.amount = 0;
	return d;
}

/* All of the scene but the colours is the other's. */
static bool open_bright(struct styled *s, const char *name, const bench_place *p,
	const scene *points, const struct camera *c, GError **error)
{
	if (!hatching_of(s->frame))
		return true;
	s->bright_drawing = plain_drawing(bench_place_drawing(p, name, error));
	if (!s->bright_drawing)
		return false;
	s->bright = g_memdup2(points, sizeof *points);
	s->bright->rgba = g_malloc(((size_t)points->count + 16) * sizeof *points->rgba);
	lighten(s);
	s->bright_frame = frame_new(s->bright, s->bright_drawing, c, error);
	return s->bright_frame;
}

static void close_bright(struct styled *s)
{
	frame_free(s->bright_frame);
	drawing_free(s->bright_drawing);
	if (s->bright)
		g_free(s->bright->rgba);
	g_free(s->bright);
}

bool styled_open(struct styled *s, const char *name, const bench_place *p, const scene *points,
	const struct camera *c, const struct styled *baseline, GError **error)
{
	s->title = title_of(name);
	s->drawing = bench_place_drawing(p, name, error);
	s->smooth = s->drawing ? bench_place_drawing(p, name, error) : NULL;
	drawing *again = s->smooth ? bench_place_drawing(p, name, error) : NULL;
	if (!again)
		return false;
	s->smooth->whole.paper.grain = 0;
	s->toned = tone_drawing(again);
	struct camera fine = camera_scaled(c, FINE);
	s->frame = frame_new(points, s->drawing, c, error);
	if (s->frame)
		s->fine_frame = frame_new(points, s->smooth, &fine, error);
	if (s->fine_frame)
		memset(s->fine_frame->relief, PAPER_TEXTURE_MEAN, (size_t)fine.width * fine.height);
	if (s->fine_frame && s->toned)
		s->toned_frame = frame_new(points, s->toned, c, error);
	if (s->frame && baseline && !open_bright(s, name, p, points, c, error))
		return false;
	s->shares_mask = baseline && shares_mask(s->drawing, baseline->drawing);
	return s->fine_frame && (!s->toned || s->toned_frame);
}

void styled_close(struct styled *s)
{
	shot_clear(&s->before);
	shot_clear(&s->now);
	fine_shot_clear(&s->fine_before);
	fine_shot_clear(&s->fine_now);
	close_bright(s);
	g_free(s->title);
	frame_free(s->frame);
	frame_free(s->fine_frame);
	frame_free(s->toned_frame);
	drawing_free(s->drawing);
	drawing_free(s->smooth);
	drawing_free(s->toned);
}

static bool draw_at(
	frame *f, const struct camera *c, struct picture_buffer *picture, GError **error)
{
	if (!frame_move(f, c, error))
		return false;
	draw_frame(NULL, f, picture, NULL);
	return true;
}

bool styled_try_static(
	struct styled *s, const struct camera *c, struct picture_buffer *picture, GError **error)
{
	size_t bytes = (size_t)picture->width * picture->height * sizeof *picture->rgba;
	struct camera other = camera_turned(c, 0.1);
	if (!draw_at(s->frame, c, picture, error))
		return false;
	g_autofree void *first = g_memdup2(picture->rgba, bytes);
	if (!draw_at(s->frame, &other, picture, error) || !draw_at(s->frame, c, picture, error))
		return false;
	s->is_static = memcmp(first, picture->rgba, bytes) == 0;
	return true;
}

void styled_turn_light(struct styled *s, double by_deg)
{
	struct style_light light = s->drawing->whole.light;
	light.azimuth_deg += (float)by_deg;
	frame_set_light(s->frame, &light);
	frame_set_light(s->fine_frame, &light);
	if (s->toned_frame)
		frame_set_light(s->toned_frame, &light);
	if (s->bright)
		lighten(s);
}

/* ---- frames ---- */

void styled_begin_path(struct styled *s)
{
	shot_clear(&s->before);
	shot_clear(&s->now);
	fine_shot_clear(&s->fine_before);
	fine_shot_clear(&s->fine_now);
	s->change = s->fine_change = (struct reprojection_sums){ 0 };
	s->tally = (struct stroke_tally){ 0 };
	s->tone = (struct tone_sums){ 0 };
	s->kept_least = s->density_least = s->layer_least = s->tone_mean_least = INFINITY;
	s->density_most = s->layer_most = s->tone_mean_most = -INFINITY;
	s->limited = s->cv = s->cv_all = 0;
	s->densities = s->cvs = s->cvs_all = 0;
}

void styled_step(struct styled *s)
{
	shot_clear(&s->before);
	s->before = s->now;
	s->now = (struct shot){ 0 };
	fine_shot_clear(&s->fine_before);
	s->fine_before = s->fine_now;
	s->fine_now = (struct fine_shot){ 0 };
}

bool styled_take(struct styled *s, const struct camera *c, const struct styled *baseline,
	struct picture_buffer *picture, struct picture_buffer *fine, GError **error)
{
	shot_clear(&s->now);
	fine_shot_clear(&s->fine_now);
	/* All styles are moved as the baseline is. */
	bool is_baseline = baseline == s;
	return shot_take(&s->now, s->frame, c, s->shares_mask ? baseline->now.mask : NULL,
		       is_baseline, picture, error) &&
	       fine_shot_take(&s->fine_now, s->fine_frame, c, is_baseline, fine, error);
}

/* ---- two of them ---- */

static void tally_strokes(struct styled *s, float *const scratch[2])
{
	struct stroke_tally t = { 0 };
	for (uint32_t l = 0; l < s->frame->layers; l++)
		if (s->frame->layer[l].is_profile)
			line_tally_add(&t, &s->before, &s->now, l);
		else
			stroke_tally_add(&t, &s->before, &s->now, l, scratch);
	s->tally.shown += t.shown;
	s->tally.kept += t.kept;
	s->tally.compared += t.compared;
	s->tally.jumped += t.jumped;
	s->tally.step_most = fmaxf(s->tally.step_most, t.step_most);
	if (t.shown)
		s->kept_least = fmin(s->kept_least, (double)t.kept / (double)t.shown);
}

void styled_measure_pair(
	struct styled *s, const reprojection *r, const reprojection *fine, float *const scratch[2])
{
	reprojection_add(r, s->now.luminance, s->before.luminance, 1, &s->change);
	reprojection_add(
		fine, s->fine_now.luminance, s->fine_before.luminance, FINE, &s->fine_change);
	tally_strokes(s, scratch);
}

/* ---- one of them ---- */

static void add_variation(double cv, double *sum, uint32_t *count)
{
	if (isnan(cv))
		return;
	*sum += cv;
	++*count;
}

static void measure_density(struct styled *s, const uint8_t *lightness)
{
	/* Strokes of all layers; of the rest the worst. */
	struct density worst = { 0, 0, NAN, 0, NAN, NAN };
	bool has = false;
	for (uint32_t l = 0; l < s->frame->layers; l++) {
		if (!density_has(&s->frame->layer[l]))
			continue;
		struct density d = density_of(s->frame, &s->now, l, lightness);
		has = true;
		/* fmin and fmax pass over what is no number */
		s->layer_least = fmin(s->layer_least, d.relative);
		s->layer_most = fmax(s->layer_most, d.relative);
		worst.strokes += d.strokes;
		worst.wanted += d.wanted;
		worst.limited_share = fmax(worst.limited_share, d.limited_share);
		worst.cv = fmax(worst.cv, d.cv);
		worst.cv_all = fmax(worst.cv_all, d.cv_all);
	}
	if (!has)
		return;
	if (worst.wanted > 0) {
		s->density_least = fmin(s->density_least, worst.strokes / worst.wanted);
		s->density_most = fmax(s->density_most, worst.strokes / worst.wanted);
	}
	s->limited += worst.limited_share;
	s->densities++;
	add_variation(worst.cv, &s->cv, &s->cvs);
	add_variation(worst.cv_all, &s->cv_all, &s->cvs_all);
}

static bool measure_tone(
	struct styled *s, const uint8_t *lightness, struct picture_buffer *picture, GError **error)
{
	struct tone_sums t = { 0 };
	if (!tone_add(&t, s->toned_frame, &s->now, lightness, picture, error))
		return false;
	s->tone.error2 += t.error2;
	s->tone.light += t.light;
	s->tone.wanted += t.wanted;
	s->tone.tiles += t.tiles;
	s->tone.error2_all += t.error2_all;
	s->tone.tiles_all += t.tiles_all;
	if (!t.tiles)
		return true;
	double off = (t.light - t.wanted) / (double)t.tiles;
	s->tone_mean_least = fmin(s->tone_mean_least, off);
	s->tone_mean_most = fmax(s->tone_mean_most, off);
	return true;
}

/* How light hatching takes each pixel for. */
static uint8_t *draw_bright(struct styled *s, struct picture_buffer *picture, GError **error)
{
	if (!frame_move(s->bright_frame, &s->now.camera, error))
		return NULL;
	draw_frame(NULL, s->bright_frame, picture, NULL);
	size_t pixels = (size_t)picture->width * picture->height;
	uint8_t *ret = g_new(uint8_t, pixels);
	for (size_t n = 0; n < pixels; n++)
		ret[n] = picture->rgba[n][1];
	return ret;
}

bool styled_measure_frame(
	struct styled *s, const uint8_t *lightness, struct picture_buffer *picture, GError **error)
{
	g_autofree uint8_t *own = s->bright ? draw_bright(s, picture, error) : NULL;
	if (s->bright && !own)
		return false;
	measure_density(s, own ? own : lightness);
	return !s->toned || measure_tone(s, own ? own : lightness, picture, error);
}

/* ---- what comes out ---- */

static double by(double sum, double count)
{
	return count > 0 ? sum / count : NAN;
}

struct coherence_row styled_row(
	const struct styled *s, const char *path, const struct styled *baseline)
{
	const struct stroke_tally *t = &s->tally;
	bool has_density = isfinite(s->density_least);
	return (struct coherence_row){ s->title, path, .kept_least = t->shown ? s->kept_least : NAN,
		.kept = by((double)t->kept, (double)t->shown),
		.step_most = t->compared ? t->step_most : NAN,
		.jumped_share = by((double)t->jumped, (double)t->compared),
		.density_least = has_density ? s->density_least : NAN,
		.density_most = has_density ? s->density_most : NAN,
		.layer_least = has_density ? s->layer_least : NAN,
		.layer_most = has_density ? s->layer_most : NAN,
		.limited_share = by(s->limited, s->densities), .cv = by(s->cv, s->cvs),
		.cv_all = by(s->cv_all, s->cvs_all), .warp = reprojection_share(&s->fine_change),
		/* The baseline is what the others are compared with. */
		.warp_pixels = s == baseline ? NAN
					     : by(reprojection_change(&s->change),
						       reprojection_change(&baseline->change)),
		.tone = sqrt(by(s->tone.error2, (double)s->tone.tiles)),
		.tone_all = sqrt(by(s->tone.error2_all, (double)s->tone.tiles_all)),
		.tone_bias = by(s->tone.light - s->tone.wanted, (double)s->tone.tiles),
		.tone_drift = s->tone.tiles ? s->tone_mean_most - s->tone_mean_least : NAN,
		.is_static = s->is_static };
}
