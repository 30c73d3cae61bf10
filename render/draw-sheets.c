#include "render/depth-inpaint.h"
#include "render/draw-private.h"
#include "render/sheet-plan.h"
#include "render/surface-pass.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Parts of r->pictures. */
enum {
	PART_SHEET, /* as it is drawn, as large as the picture */
	PART_RGBA,
	PART_SPARE,
	PART_DEPTH,
	PART_NORMAL,
	PART_LEAF,
	PART_AWAY,
	PART_GREY, /* before filters */
	PART_INPAINTED,
	PART_WHOLE_DEPTH, /* of all sheets so far */
	PART_WHOLE_NORMAL,
	PART_WHOLE_LEAF,
	PART_SOFT, /* the nearest of what filters drew beside things, as far as it does not cover what is behind it */
	PART_SOFT_DEPTH,
};
_Static_assert(PART_SOFT_DEPTH < FILTER_ROOM_PARTS, "a place for each");

struct sheet_job {
	draw_room *room;
	const frame *f;
	struct picture_buffer *to;
	struct draw_times t;
	int64_t since_us;
	bool wants_surface;           /* the filters of the picture do */
	float *depth_m, (*normal)[3]; /* of the picture so far */
	uint16_t *leaf;
	uint8_t (*soft)[4]; /* the last one: how much it covers */
	float *soft_depth_m;
	bool has_soft;
	uint8_t paper[4];
};

/* ---- a sheet as a picture with depths ---- */

/* As far as it was: what the mask pushed it back is taken away again. */
static float depth_of(const frame *f, int32_t key)
{
	if (key >= MASK_EMPTY)
		return FILTER_FAR;
	struct sheet_depth d = sheet_depth_of(f, (uint32_t)key & 255);
	return (mask_depth(key) - d.offset_m) / d.per;
}

static void take_depths(const frame *f, const visibility_mask *m, float *to)
{
#pragma omp parallel for num_threads((int)frame_threads(f))
	for (uint32_t y = 0; y < m->height; y++)
		for (uint32_t x = 0; x < m->width; x++)
			to[(size_t)y * m->width + x] =
				depth_of(f, mask_key(m, (int32_t)x, (int32_t)y));
}

static bool is_focus_at(const frame *f, const visibility_mask *m, uint32_t x, uint32_t y)
{
	int32_t key = mask_key(m, (int32_t)x, (int32_t)y);
	return key < MASK_EMPTY && frame_pipeline(f, key & 255)->is_focus;
}

static void take_away(struct filter_job *j, const visibility_mask *m)
{
	const struct filter_image *i = &j->image;
	const frame *f = j->f;
	const float by_focal = 1 / (float)f->camera.focal_px,
		    middle_x = (float)camera_middle_x(&f->camera),
		    middle_y = (float)camera_middle_y(&f->camera),
		    nothing_m = fmaxf(f->focus.at_m[2], (float)f->camera.near_m);
#pragma omp parallel for num_threads((int)frame_threads(f))
	for (uint32_t row = 0; row < i->height; row++)
		for (uint32_t column = 0; column < i->width; column++) {
			size_t at = (size_t)row * i->width + column;
			uint32_t x = column + i->left, y = row + i->top;
			/* What nothing is behind counts by where it is in the picture: as deep as the focus. */
			float depth_m = i->depth_m[at] >= FILTER_FAR ? nothing_m : i->depth_m[at],
			      by_px = by_focal * LENS_SCALE_M(&f->focus.lens, depth_m);
			const float at_m[3] = { ((float)x + 0.5f - middle_x) * by_px,
				((float)y + 0.5f - middle_y) * by_px, depth_m };
			i->away[at] = frame_away(&f->focus, at_m,
				f->focus.on == FOCUS_SEGMENT && is_focus_at(f, m, x, y));
		}
}

/* The part of a plane of the whole picture that is in the box. */
static void cut(const void *from, void *to, size_t bytes, uint32_t width, const struct sheet_box *b)
{
	size_t row = (b->right - b->left) * bytes;
#pragma omp parallel for
	for (uint32_t y = b->top; y < b->bottom; y++)
		memcpy((char *)to + (y - b->top) * row,
			(const char *)from + ((size_t)y * width + b->left) * bytes, row);
}

static struct filter_job job_of(struct sheet_job *s, const struct sheet_box *b)
{
	struct filter_job j = { .f = s->f,
		.room = &s->room->filters,
		.lanes = s->f->lanes,
		.px = s->f->px,
		.time_s = s->f->time_s,
		.image = { .width = b->right - b->left,
			.height = b->bottom - b->top,
			.left = b->left,
			.top = b->top,
			.paper = s->paper } };
	filter_room *r = &s->room->pictures;
	size_t pixels = filter_pixels(&j.image);
	j.image.rgba = filter_room_part(r, PART_RGBA, pixels * 4);
	j.image.spare = filter_room_part(r, PART_SPARE, pixels * 4);
	j.image.depth_m = filter_room_part(r, PART_DEPTH, pixels * sizeof(float));
	if (s->f->focus.is_there && s->f->focus.filters > 0)
		j.image.away = filter_room_part(r, PART_AWAY, pixels * sizeof(float));
	return j;
}

/* ---- compositing ---- */

struct merging {
	const struct sheet_job *s;
	const struct filter_image *image;
	const float *depth_m; /* to compare by */
	int32_t by;
};

static int change_of(const struct sheet_job *s, const uint8_t rgba[4])
{
	int most = 0;
	for (int k = 0; k < 3; k++)
		most = MAX(most, abs((int)rgba[k] - (int)s->paper[k]));
	return most;
}

/* Beside things bare paper shows through what filters drew, where that is thin: the soft borders of lines, what was blurred. It must not
 * hide what is behind the thing. */
static bool is_soft(const struct sheet_job *s, const struct filter_image *i, size_t at)
{
	return i->depth_m[at] >= FILTER_FAR && change_of(s, i->rgba[at]) < SHEET_COVERS;
}

/* Without the paper, and how much it covers. */
static void put_soft(const struct sheet_job *s, const struct filter_image *i, size_t at, size_t to,
	float depth_m)
{
	int change = change_of(s, i->rgba[at]);
	if (!change || depth_m >= s->soft_depth_m[to])
		return;
	for (int k = 0; k < 3; k++) {
		int full = s->paper[k] +
			   ((int)i->rgba[at][k] - (int)s->paper[k]) * SHEET_COVERS / change;
		s->soft[to][k] = (uint8_t)CLAMP(full, 0, 255);
	}
	s->soft[to][3] = (uint8_t)(change * 255 / SHEET_COVERS);
	s->soft_depth_m[to] = depth_m;
}

/* Ink that reaches over what it is on, and has no depth, lies on the paper, if nothing is there. */
static void merge_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct merging *m = data;
	const struct filter_image *i = m->image;
	const struct sheet_job *s = m->s;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x,
			       to = (size_t)(y + i->top) * s->to->width + x + i->left;
			if (s->has_soft && m->depth_m[at] < FILTER_FAR && is_soft(s, i, at)) {
				put_soft(s, i, at, to, m->depth_m[at]);
				continue;
			}
			bool has_ink = change_of(s, i->rgba[at]) > 0,
			     is_far = m->depth_m[at] >= FILTER_FAR;
			bool shows = m->by == COMPOSITE_LAYERS ? !is_far || has_ink
				     : is_far ? has_ink && s->depth_m[to] >= FILTER_FAR
					      : m->depth_m[at] < s->depth_m[to];
			if (!shows)
				continue;
			memcpy(s->to->rgba[to], i->rgba[at], 4);
			s->depth_m[to] = m->depth_m[at];
			if (s->wants_surface && i->normal) {
				memcpy(s->normal[to], i->normal[at], sizeof *s->normal);
				s->leaf[to] = i->leaf[at];
			}
		}
}

/* The same of a sheet that nothing filters, as it was drawn. */
static void merge_drawn(
	struct sheet_job *s, const struct sheet_box *b, const struct picture_buffer *drawn)
{
	const visibility_mask *m = s->room->mask;
#pragma omp parallel for num_threads((int)frame_threads(s->f))
	for (uint32_t y = b->top; y < b->bottom; y++) {
		const uint32_t *from = (const void *)drawn->rgba[(size_t)y * drawn->width];
		uint32_t *to = (void *)s->to->rgba[(size_t)y * drawn->width];
		float *depth_m = s->depth_m + (size_t)y * drawn->width;
		for (uint32_t x = b->left; x < b->right; x++) {
			float here_m = depth_of(s->f, mask_key(m, (int32_t)x, (int32_t)y));
			bool is_ink = here_m >= FILTER_FAR && depth_m[x] >= FILTER_FAR &&
				      memcmp(&from[x], s->paper, 3) != 0;
			if (here_m < depth_m[x] || is_ink) {
				to[x] = from[x];
				depth_m[x] = here_m;
			}
		}
	}
	s->t.composite_s += draw_lap(&s->since_us);
}

/* Ink beside things is no part of them yet: points have left bare paper there. */
static void grey_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_image *i = data;
	for (size_t at = (size_t)from * i->width; at < (size_t)end * i->width; at++)
		i->grey_before[at] =
			depth_inpaint_grey(i->depth_m[at] < FILTER_FAR ? i->rgba[at] : i->paper);
}

/* ---- a sheet ---- */

static bool draw_sheet(struct sheet_job *s, const struct sheet_plan *p, struct picture_buffer *to)
{
	draw_room *r = s->room;
	struct draw_job j = { .f = s->f,
		.to = to,
		.views = p->views,
		.count = p->count,
		.flat = true,
		.lists = &r->lists,
		.first_row = p->box.top,
		.end_row = p->box.bottom };
	j.mask = r->mask = visibility_mask_renew(r->mask, s->f, p->views, p->count);
	s->t.chunks_hidden += r->mask->chunks_hidden;
	s->t.mask_s += draw_lap(&s->since_us);
	if (frame_is_stopped(s->f))
		return false;
	r->of_layer = stroke_room_fill_some(
		r->strokes, s->f, j.mask, p->views, p->count, frame_layers_over(s->f, false));
	s->t.choose_s += draw_lap(&s->since_us);
	j.of_layer = r->of_layer;
	band_lists_fill(&r->lists, s->f, r->of_layer, to->height);
	for (uint32_t n = 0; n < s->f->layers; n++)
		s->t.strokes += r->of_layer[n].count;
	s->t.bin_s += draw_lap(&s->since_us);
	if (p->box.bottom > p->box.top)
		draw_bands(r, &j);
	s->t.draw_s += draw_lap(&s->since_us);
	return !frame_is_stopped(s->f);
}

/* Normals and segments of the box's pixels, if anybody wants them. */
static void take_surface(
	struct sheet_job *s, struct filter_job *j, const struct sheet_plan *p, float *depth_m)
{
	const frame *f = s->f;
	size_t whole = (size_t)f->camera.width * f->camera.height,
	       pixels = filter_pixels(&j->image);
	filter_room *r = &s->room->pictures;
	struct surface_planes to = { depth_m, NULL, NULL };
	/* Behind each other in the room: of the whole picture, then of the box. */
	char *normals = filter_room_part(r, PART_NORMAL, (whole + pixels) * sizeof *to.normal),
	     *leaves = filter_room_part(r, PART_LEAF, (whole + pixels) * sizeof *to.leaf);
	to.normal = (float(*)[3])(void *)normals;
	to.leaf = (uint16_t *)(void *)leaves;
	surface_pass(f, s->room->mask, p->views, p->count, &to);
	j->image.normal = to.normal + whole;
	j->image.leaf = to.leaf + whole;
	cut(to.normal, j->image.normal, sizeof *to.normal, f->camera.width, &p->box);
	cut(to.leaf, j->image.leaf, sizeof *to.leaf, f->camera.width, &p->box);
}

static void filter_sheet(
	struct sheet_job *s, const struct sheet_plan *p, const struct picture_buffer *drawn)
{
	const frame *f = s->f;
	filter_room *r = &s->room->pictures;
	struct filter_job j = job_of(s, &p->box);
	j.spacing_px = p->spacing_px;
	size_t pixels = filter_pixels(&j.image), whole = (size_t)f->camera.width * f->camera.height;
	float *depth_m = filter_room_part(r, PART_INPAINTED, whole * sizeof(float));
	take_depths(f, s->room->mask, depth_m);
	if (s->wants_surface || filter_wants_surface(p->steps, p->filters))
		take_surface(s, &j, p, depth_m);
	cut(depth_m, j.image.depth_m, sizeof(float), f->camera.width, &p->box);
	cut(drawn->rgba, j.image.rgba, 4, f->camera.width, &p->box);
	if (j.image.away)
		take_away(&j, s->room->mask);
	struct merging m = { s, &j.image, j.image.depth_m, f->drawing->composite_by };
	if (p->filters) {
		struct depth_inpainting d = { .image = &j.image,
			.to = depth_m,
			.threshold = p->threshold,
			.radius = p->radius };
		j.image.grey_before = filter_room_part(r, PART_GREY, pixels);
		filter_each_rows(&j, grey_rows, &j.image, j.image.height, 64);
		s->t.composite_s += draw_lap(&s->since_us);
		for (uint32_t n = 0; n < p->filters; n++)
			if (step_is_filter(&p->steps[n]))
				filter_apply(&j, &p->steps[n]);
		s->t.filter_s += draw_lap(&s->since_us);
		if (m.by == COMPOSITE_INPAINTED) {
			depth_inpaint(&j, &d);
			m.depth_m = d.to;
		}
	}
	filter_each_rows(&j, merge_rows, &m, j.image.height, 64);
	s->t.composite_s += draw_lap(&s->since_us);
}

static bool do_plan(struct sheet_job *s, const struct sheet_plan *p)
{
	struct picture_buffer drawn = { s->to->width, s->to->height,
		filter_room_part(
			&s->room->pictures, PART_SHEET, (size_t)s->to->width * s->to->height * 4) };
	if (!draw_sheet(s, p, &drawn))
		return false;
	s->room->joined = visibility_mask_join(s->room->joined, s->f, s->room->mask);
	if (!p->filters && !s->wants_surface)
		merge_drawn(s, &p->box, &drawn);
	else
		filter_sheet(s, p, &drawn);
	return !frame_is_stopped(s->f);
}

static bool do_sheet(
	struct sheet_job *s, const struct chunk_view *all, uint32_t all_count, uint32_t sheet)
{
	struct sheet_plan p = sheet_plan_new(s->f, all, all_count, sheet);
	bool going = !p.count || do_plan(s, &p);
	sheet_plan_clear(&p);
	return going;
}

/* ---- the picture ---- */

/* What covers only in part comes over what is behind it, once all of that is known. */
static void blend_soft(struct sheet_job *s)
{
	size_t pixels = (size_t)s->to->width * s->to->height;
#pragma omp parallel for num_threads((int)frame_threads(s->f))
	for (size_t at = 0; at < pixels; at++) {
		if (!(s->soft_depth_m[at] < s->depth_m[at]))
			continue;
		uint8_t *to = s->to->rgba[at];
		for (int k = 0; k < 3; k++) {
			int by = ((int)s->soft[at][k] - (int)to[k]) * s->soft[at][3];
			to[k] = (uint8_t)(to[k] + (by + (by < 0 ? -127 : 127)) / 255);
		}
		if (s->depth_m[at] >= FILTER_FAR)
			s->depth_m[at] = s->soft_depth_m[at];
	}
	s->t.composite_s += draw_lap(&s->since_us);
}

static void begin(struct sheet_job *s)
{
	const frame *f = s->f;
	size_t pixels = (size_t)s->to->width * s->to->height;
	filter_room *r = &s->room->pictures;
	memcpy(s->paper, f->drawing->whole.paper.colour, 3);
	s->paper[3] = 255;
	s->wants_surface =
		filter_wants_surface(f->drawing->picture.steps, f->drawing->picture.filters);
	s->depth_m = filter_room_part(r, PART_WHOLE_DEPTH, pixels * sizeof(float));
	s->has_soft = sheets_have_soft(f);
	if (s->has_soft) {
		s->soft = filter_room_part(r, PART_SOFT, pixels * sizeof *s->soft);
		s->soft_depth_m = filter_room_part(r, PART_SOFT_DEPTH, pixels * sizeof(float));
	}
	if (s->wants_surface) {
		s->normal = filter_room_part(r, PART_WHOLE_NORMAL, pixels * sizeof *s->normal);
		s->leaf = filter_room_part(r, PART_WHOLE_LEAF, pixels * sizeof *s->leaf);
		memset(s->normal, 0, pixels * sizeof *s->normal);
		memset(s->leaf, 0, pixels * sizeof *s->leaf);
	}
#pragma omp parallel for num_threads((int)frame_threads(f))
	for (size_t at = 0; at < pixels; at++) {
		memcpy(s->to->rgba[at], s->paper, 4);
		s->depth_m[at] = FILTER_FAR;
		if (s->has_soft)
			s->soft_depth_m[at] = FILTER_FAR;
	}
	s->room->joined = visibility_mask_join(s->room->joined, f, NULL);
	if (!s->room->strokes)
		s->room->strokes = stroke_room_new();
}

static void filter_whole(struct sheet_job *s, const struct chunk_view *views, uint32_t count)
{
	const struct pipeline *p = &s->f->drawing->picture;
	struct sheet_box b = { 0, 0, s->to->width, s->to->height };
	struct filter_job j = job_of(s, &b);
	j.spacing_px = sheet_whole_spacing_px(s->f, views, count);
	j.image.rgba = s->to->rgba; /* where it stays, if it is swapped an even number of times */
	j.image.depth_m = s->depth_m;
	j.image.normal = s->normal;
	j.image.leaf = s->leaf;
	if (j.image.away)
		take_away(&j, s->room->joined);
	s->t.composite_s += draw_lap(&s->since_us);
	for (uint32_t n = 0; n < p->filters; n++)
		filter_apply(&j, &p->steps[n]);
	if (j.image.rgba != s->to->rgba)
		cut(j.image.rgba, s->to->rgba, 4, s->to->width, &b);
	s->t.filter_s += draw_lap(&s->since_us);
}

static bool is_finished(const frame *f, uint64_t over)
{
	return !over && !(f->focus.amount > 0) && !(f->drawing->whole.paper.grain > 0);
}

/* Paper's grain, what fades away from the focus, and strokes that lie over. */
static void finish(
	struct sheet_job *s, const struct chunk_view *views, uint32_t count, uint64_t over)
{
	draw_room *r = s->room;
	struct draw_job j = { .f = s->f,
		.mask = r->joined,
		.views = views,
		.count = count,
		.to = s->to,
		.ground = s->to };
	if (over) {
		r->of_layer =
			stroke_room_fill_some(r->strokes, s->f, r->joined, views, count, over);
		s->t.choose_s += draw_lap(&s->since_us);
		band_lists_fill(&r->lists, s->f, r->of_layer, s->to->height);
		for (uint32_t n = 0; n < s->f->layers; n++)
			s->t.strokes += r->of_layer[n].count;
		s->t.bin_s += draw_lap(&s->since_us);
		j.lists = &r->lists;
		j.of_layer = r->of_layer;
	}
	draw_bands(r, &j);
	s->t.draw_s += draw_lap(&s->since_us);
}

void draw_sheets(draw_room *r, const frame *f, bool over, struct picture_buffer *to,
	struct draw_times *ret_times)
{
	int64_t begin_us = g_get_monotonic_time();
	struct sheet_job s = { .room = r, .f = f, .to = to, .since_us = begin_us };
	uint32_t count;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	uint64_t layers_over = over ? frame_layers_over(f, true) : 0;
	bool going = true;
	begin(&s);
	s.t.cull_s = draw_lap(&s.since_us);
	for (uint32_t n = 0; going && n < f->sheets; n++)
		going = do_sheet(&s, views, count, n);
	if (going && s.has_soft)
		blend_soft(&s);
	if (going && f->drawing->picture.filters)
		filter_whole(&s, views, count);
	if (going && !is_finished(f, layers_over))
		finish(&s, views, count, layers_over);
	s.t.chunks_in_view = count;
	for (uint32_t n = 0; n < count; n++)
		s.t.points_in_view += views[n].chunk->count;
	s.t.all_s = (double)(g_get_monotonic_time() - begin_us) * 1e-6;
	if (ret_times)
		*ret_times = s.t;
}
