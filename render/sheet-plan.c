#include "render/sheet-plan.h"
#include "render/filter.h"
#include <math.h>

static uint32_t count_of(
	const frame *f, const struct chunk_view *all, uint32_t count, uint32_t sheet)
{
	uint32_t ret = 0;
	for (uint32_t n = 0; n < count; n++)
		ret += f->sheet_of[all[n].pipeline] == sheet;
	return ret;
}

/* Those of a sheet, in the order of all; *ret_own is to be freed, NULL where none was left out. */
static const struct chunk_view *views_of(const frame *f, const struct chunk_view *all,
	uint32_t count, uint32_t sheet, uint32_t *ret_count, struct chunk_view **ret_own)
{
	uint32_t own = count_of(f, all, count, sheet), to = 0;
	*ret_count = own;
	*ret_own = NULL;
	if (own == count)
		return all;
	struct chunk_view *ret = *ret_own = g_new(struct chunk_view, own + 1);
	for (uint32_t n = 0; n < count; n++)
		if (f->sheet_of[all[n].pipeline] == sheet)
			ret[to++] = all[n];
	return ret;
}

/* ---- how far it reaches ---- */

uint32_t sheet_ink_reach(const frame *f, uint32_t sheet)
{
	float reach = 1;
	for (uint32_t n = 0; n < f->layers; n++)
		if (f->sheet_of[f->layer[n].pipeline] == sheet)
			reach = fmaxf(
				reach, f->layer[n].step->kind->radius_px(f->layer[n].step->bytes) *
						       f->ink_px * fmaxf(f->layer[n].ink.grow, 1) *
						       (1 + f->focus.abstraction) +
					       1);
	return (uint32_t)fminf(reach, 1e4f);
}

/* The part of a box of the whole picture that the camera draws. */
static uint32_t drawn_place(uint32_t whole, uint32_t from, uint32_t side)
{
	return whole > from ? MIN(whole - from, side) : 0;
}

static struct sheet_box drawn_box(const struct camera *c, const struct sheet_box *b)
{
	const struct camera_whole *w = &c->whole;
	return (struct sheet_box){ drawn_place(b->left, w->left, c->width),
		drawn_place(b->top, w->top, c->height), drawn_place(b->right, w->left, c->width),
		drawn_place(b->bottom, w->top, c->height) };
}

static struct sheet_box box_of(
	const frame *f, const struct chunk_view *views, uint32_t count, float reach)
{
	float low[2] = { 1e9f, 1e9f }, high[2] = { -1e9f, -1e9f };
	const float size[2] = { (float)f->camera.width, (float)f->camera.height };
	for (uint32_t n = 0; n < count; n++)
		for (int k = 0; k < 2; k++) {
			low[k] = fminf(low[k], views[n].low_px[k] - views[n].margin_px);
			high[k] = fmaxf(high[k], views[n].high_px[k] + views[n].margin_px);
		}
	struct sheet_box b = { 0 };
	uint32_t *from[2] = { &b.left, &b.top }, *end[2] = { &b.right, &b.bottom };
	for (int k = 0; k < 2; k++) {
		*from[k] = (uint32_t)CLAMP(low[k] - reach, 0, size[k]) / SHEET_BLOCK * SHEET_BLOCK;
		*end[k] = (uint32_t)CLAMP(ceilf(high[k] + reach), 0, size[k]);
	}
	return b;
}

/* ---- what the style leaves to us ---- */

static float spacing_of(const frame *f, const struct chunk_view *views, uint32_t count)
{
	double sum = 0, points = 0;
	for (uint32_t n = 0; n < count; n++) {
		const struct chunk_view *v = &views[n];
		double middle_m = ((double)v->near_m + (double)v->far_m) / 2;
		sum += (double)v->chunk->count * (double)v->chunk->spacing_most_m *
		       f->camera.focal_px / MAX(camera_scale_m(&f->camera, middle_m), 1e-3);
		points += v->chunk->count;
	}
	return points > 0 ? (float)(sum / points) : 0;
}

float sheet_whole_spacing_px(const frame *f, const struct chunk_view *views, uint32_t count)
{
	if (!camera_is_window(&f->camera))
		return spacing_of(f, views, count);
	frame whole = frame_of_whole(f);
	uint32_t whole_count;
	g_autofree struct chunk_view *all = chunk_views_new(&whole, &whole_count);
	return spacing_of(&whole, all, whole_count);
}

/* The part of the chunks in whose boxes on the screen, and in depth, others of another sheet are. */
static float overlap_of(
	const frame *f, const struct chunk_view *all, uint32_t count, uint32_t sheet)
{
	if (count_of(f, all, count, sheet) == count)
		return 0;
	enum { SIDE = 64, DEEP = 24 };
	g_autofree uint64_t *own = g_new0(uint64_t, SIDE * SIDE),
			    *other = g_new0(uint64_t, SIDE * SIDE);
	for (uint32_t n = 0; n < count; n++) {
		const struct chunk_view *v = &all[n];
		uint64_t *to = f->sheet_of[v->pipeline] == sheet ? own : other;
		float size[2] = { (float)f->camera.width, (float)f->camera.height };
		uint32_t low[2], high[2];
		for (int k = 0; k < 2; k++) {
			low[k] = (uint32_t)(CLAMP(v->low_px[k] / size[k], 0, 0.999f) * SIDE);
			high[k] = (uint32_t)(CLAMP(v->high_px[k] / size[k], 0, 0.999f) * SIDE);
		}
		int from = (int)CLAMP(4 * log2f(v->near_m + 1), 0, DEEP - 1),
		    end = (int)CLAMP(4 * log2f(v->far_m + 1), 0, DEEP - 1);
		uint64_t deep = ((uint64_t)2 << end) - ((uint64_t)1 << from);
		for (uint32_t y = low[1]; y <= high[1]; y++)
			for (uint32_t x = low[0]; x <= high[0]; x++)
				to[y * SIDE + x] |= deep;
	}
	uint32_t cells = 0, shared = 0;
	for (uint32_t n = 0; n < SIDE * SIDE; n++) {
		cells += (uint32_t)__builtin_popcountll(own[n]);
		shared += (uint32_t)__builtin_popcountll(own[n] & other[n]);
	}
	return cells ? (float)shared / (float)cells : 0;
}

/* Filters draw as far beside things as they reach, at most, and what they draw there must find a depth across
 * the gaps between points; but where other segments are all around, a wide circle would take depths of other parts of a thing. */
#define THRESHOLD    0.03f
#define RADIUS_CLOSE 0.5f /* of it, where all is close to other sheets */
static void choose_inpainting(const frame *f, const struct chunk_view *all, uint32_t all_count,
	uint32_t sheet, struct sheet_plan *p)
{
	const struct inpaint_step *by = frame_inpaint(f, sheet);
	float radius = by->radius_px * f->px;
	if (by->radius_px <= 0) {
		float reach = fmaxf(
			(float)filter_reach(p->steps, p->filters, f->px) / 2, 1.5f * p->spacing_px);
		radius = fminf(2 + reach, SHEET_RADIUS_MOST) *
			 (1 - (1 - RADIUS_CLOSE) * overlap_of(f, all, all_count, sheet));
	}
	p->radius = MAX((int)rintf(radius), 1);
	p->threshold = by->threshold > 0 ? by->threshold : THRESHOLD;
}

/* ---- all ---- */

/* all: what the whole picture shows; own: of it, the sheet's. */
static void look_at_whole(const frame *f, const struct chunk_view *all, uint32_t count,
	const struct chunk_view *own, uint32_t own_count, uint32_t sheet, struct sheet_plan *p)
{
	p->box = box_of(f, own, own_count,
		(float)(sheet_ink_reach(f, sheet) + filter_reach(p->steps, p->filters, f->px)));
	p->spacing_px = spacing_of(f, own, own_count);
	if (p->filters)
		choose_inpainting(f, all, count, sheet, p);
}

/* The camera draws a window of it. */
static void look_around_window(const frame *f, uint32_t sheet, struct sheet_plan *p)
{
	frame whole = frame_of_whole(f);
	uint32_t count, own_count;
	g_autofree struct chunk_view *all = chunk_views_new(&whole, &count), *copy = NULL;
	const struct chunk_view *own = views_of(&whole, all, count, sheet, &own_count, &copy);
	look_at_whole(&whole, all, count, own, own_count, sheet, p);
	p->box = drawn_box(&f->camera, &p->box);
}

struct sheet_plan sheet_plan_new(
	const frame *f, const struct chunk_view *all, uint32_t count, uint32_t sheet)
{
	struct sheet_plan p = { 0 };
	p.views = views_of(f, all, count, sheet, &p.count, &p.own);
	p.steps = frame_filters(f, sheet, &p.filters);
	if (p.count && camera_is_window(&f->camera))
		look_around_window(f, sheet, &p);
	else if (p.count)
		look_at_whole(f, all, count, p.views, p.count, sheet, &p);
	return p;
}

void sheet_plan_clear(struct sheet_plan *p)
{
	g_clear_pointer(&p->own, g_free);
	p->views = NULL;
}

bool sheets_have_soft(const frame *f)
{
	bool ret = false;
	for (uint32_t n = 0; n < f->sheets; n++) {
		uint32_t filters;
		frame_filters(f, n, &filters);
		ret |= filters && f->drawing->composite_by == COMPOSITE_INPAINTED;
	}
	return ret;
}
