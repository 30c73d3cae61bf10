#include "render/stroke.h"
#include "process/vector3.h"
#include "render/project-lanes.h"
#include <math.h>
#include <string.h>

/* Chunks to a task, so that the order of strokes does not depend on threads. */
#define TASK_CHUNKS 16
/* A surface seen at a lower cosine counts as seen at this one. */
#define COSINE_LEAST 0.05f
/* Of points without a normal. */
#define COSINE_UNKNOWN 0.5f
/* Strokes along an edge that comes towards the camera are shorter, down to this part. */
#define FORESHORTENED 0.25f
#define ALPHA_LEAST   (1 / 255.f)
#define UNIT_M        1e-4f

/* A layer as one chunk draws it. */
struct brush {
	const frame *f;
	const struct frame_layer *layer;
	const struct chunk_view *view;
	const visibility_mask *mask;
	float focal_px, middle_x, middle_y, near_m;
	float turn[3][3]; /* site to camera: rows right, down, forward */
	float ray_most;   /* length of the longest ray of depth 1 */
	int kind;
	float wanted_most;
	uint32_t list_from, list_count; /* of the kind in the chunk */
};

/* A point that may become a stroke. */
struct candidate {
	uint32_t point;
	float rank, spacing_m;
	float x_px, y_px, depth_m;
};

/* ---- what its surface looks like from here ---- */

static float around_zero(uint32_t point, uint32_t salt)
{
	return 2 * stroke_chance(point, salt) - 1;
}

static void to_camera(const struct brush *b, const int16_t packed[2], float ret[3])
{
	float v[3];
	model_unpack_normal(packed, v);
	for (int k = 0; k < 3; k++)
		ret[k] = vector3_dot(b->turn[k], v);
}

/* The ray through a place on the screen, of depth 1. */
static void ray_of(const struct brush *b, const struct candidate *c, float ret[3])
{
	ret[0] = (c->x_px - b->middle_x) / b->focal_px;
	ret[1] = (c->y_px - b->middle_y) / b->focal_px;
	ret[2] = 1;
}

/* Of the angle that the surface is seen at, times how much longer the ray is than the depth: a square metre of it covers so many
 * (focal length / depth)^2. */
static float cosine_of(const struct brush *b, const struct candidate *c, const float normal[3])
{
	float ray[3];
	if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0)
		return COSINE_UNKNOWN;
	ray_of(b, c, ray);
	return MAX(fabsf(vector3_dot(normal, ray)), COSINE_LEAST);
}

/* 1/depth over the screen, of the plane through the point. */
static void plane_slope(const struct brush *b, const struct candidate *c, const float normal[3],
	float reach_px, float ret[2])
{
	float ray[3], steepest = 0.5f / (c->depth_m * MAX(reach_px, 1));
	ray_of(b, c, ray);
	float away = vector3_dot(normal, ray) * c->depth_m * b->focal_px;
	for (int k = 0; k < 2; k++) {
		ret[k] = fabsf(away) > 1e-6f ? normal[k] / away : 0;
		ret[k] = CLAMP(ret[k], -steepest, steepest);
	}
}

/* The line through the point on the screen: unit, and pixels to a metre of it; 1/depth along it. */
struct line {
	float along[2], px_per_m, slope;
};

static bool line_of(const struct brush *b, const struct candidate *c, struct line *ret)
{
	float d[3], ray[3];
	const int16_t *packed = b->f->scene->direction[c->point];
	if (packed[0] == MODEL_NORMAL_NONE)
		return false;
	to_camera(b, packed, d);
	ray_of(b, c, ray);
	float scale = b->focal_px / c->depth_m;
	float x = (d[0] - ray[0] * d[2]) * scale, y = (d[1] - ray[1] * d[2]) * scale;
	float length = sqrtf(x * x + y * y);
	if (!(length > 1e-3f * scale))
		return false;
	ret->along[0] = x / length;
	ret->along[1] = y / length;
	ret->px_per_m = length;
	ret->slope = -d[2] / (c->depth_m * c->depth_m * length);
	return true;
}

/* Moves the point in its plane, inside the patch that it stands for. */
static void scatter(const struct brush *b, const float normal[3], struct candidate *c)
{
	/* Two axes of the plane (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"). */
	float sign = normal[2] >= 0 ? 1 : -1, s = -1 / (sign + normal[2]),
	      t = normal[0] * normal[1] * s;
	float axis[2][3] = { { 1 + sign * normal[0] * normal[0] * s, sign * t, -sign * normal[0] },
		{ t, sign + normal[1] * normal[1] * s, -normal[1] } };
	float reach_m = b->layer->ink.scatter * b->f->scene->disc[c->point] * (UNIT_M / 2), at[3];
	ray_of(b, c, at);
	for (int k = 0; k < 3; k++)
		at[k] = at[k] * c->depth_m +
			reach_m * (around_zero(c->point, 5) * axis[0][k] +
					  around_zero(c->point, 6) * axis[1][k]);
	if (at[2] < b->near_m)
		return;
	c->depth_m = at[2];
	c->x_px = b->middle_x + b->focal_px * at[0] / at[2];
	c->y_px = b->middle_y + b->focal_px * at[1] / at[2];
}

/* ---- how many of them are drawn ---- */

static bool is_toned_dithering(const struct frame_layer *l)
{
	return l->ink.tone == TONE_COLOUR && l->ink.points == INK_DITHERING;
}

/* Those of edges are as dense along them; but where a tone is shown they are surface like all other points. */
static bool is_on_edge(const struct brush *b)
{
	return b->kind == FEATURE_DIRECTED && !is_toned_dithering(b->layer);
}

/* Points that come after dithering points, as dense as all points are. */
static bool shares_queue(const struct brush *b)
{
	return b->kind != FEATURE_DITHER && is_toned_dithering(b->layer);
}

/* Strokes wanted to a square metre of its surface. */
static float need_on_surface(const struct brush *b, const struct candidate *c, float cosine)
{
	float px_per_m = b->focal_px / c->depth_m;
	uint8_t lightness = scene_lightness(b->f->scene->rgba[c->point]);
	return b->layer->wanted_per_px[lightness] * px_per_m * px_per_m * cosine;
}

/* Its place among the points that a layer draws there, as points to a square metre before it, and the last one's. Where a tone is
 * shown all other points come after the dithering points, in one queue with them. */
struct place {
	float rank, last;
};

static struct place place_of(const struct brush *b, const struct candidate *c)
{
	float per_m2 = 1 / (c->spacing_m * c->spacing_m);
	if (!is_toned_dithering(b->layer))
		return (struct place){ c->rank * per_m2, per_m2 };
	const scene *s = b->f->scene;
	float there = b->layer->dithering_per_m2[scene_lightness(s->rgba[c->point])],
	      spacing_m = s->spacing[c->point] * UNIT_M, last = there + 1 / (spacing_m * spacing_m);
	if (b->kind == FEATURE_DITHER)
		return (struct place){ c->rank * there, last };
	return (struct place){ there + c->rank * (last - there), last };
}

static float need_along(const struct brush *b, const struct candidate *c, const struct line *l)
{
	return l->px_per_m * c->spacing_m / (b->layer->ink.spacing_px * STROKE_FADE_MEAN);
}

/* ---- hidden or not ---- */

/* floorf, which has no instruction of its own on old processors. */
static int whole(float x)
{
	int towards_zero = (int)x;
	return towards_zero - (x < (float)towards_zero);
}

static float shows(const struct brush *b, int x, int y, float depth_m)
{
	const visibility_mask *m = b->mask;
	x = CLAMP(x, 0, (int)m->width - 1);
	y = CLAMP(y, 0, (int)m->height - 1);
	return depth_m <= mask_depth(mask_key(m, x, y)) ? 1.f : 0.f;
}

/* Part of the four pixels around that it is not hidden in. */
static float visibility(const struct brush *b, const struct candidate *c)
{
	if (!b->mask)
		return 1;
	float x = c->x_px - 0.5f, y = c->y_px - 0.5f;
	int x0 = whole(x), y0 = whole(y);
	float u = x - (float)x0, v = y - (float)y0;
	return (1 - v) * ((1 - u) * shows(b, x0, y0, c->depth_m) +
				 u * shows(b, x0 + 1, y0, c->depth_m)) +
	       v * ((1 - u) * shows(b, x0, y0 + 1, c->depth_m) +
			   u * shows(b, x0 + 1, y0 + 1, c->depth_m));
}

float stroke_growth(float need)
{
	float half = need / 2, mean = 1;
	if (need <= 1)
		return 1;
	if (need < 2) /* the mean of stroke_fade over all ranks */
		mean = half + (1 - half) * (log2f(need) + 1 / (float)G_LN2) + half * log2f(half);
	return sqrtf(need * STROKE_FADE_MEAN / mean);
}

/* ---- the stroke ---- */

static void colour_of(const struct brush *b, const struct candidate *c, uint8_t ret[4])
{
	const struct ink_step *ink = &b->layer->ink;
	const uint8_t *rgba = b->f->scene->rgba[c->point];
	memcpy(ret, ink->ink, 4);
	if (ink->colour != COLOUR_POINT || !rgba[3])
		return;
	float grey = scene_lightness(rgba);
	for (int k = 0; k < 3; k++)
		ret[k] = (uint8_t)CLAMP(grey + ink->saturation * (rgba[k] - grey) + 0.5f, 0, 255);
}

static void turn_along(const struct brush *b, struct stroke *s, const float along[2], float half_px)
{
	const float *turn = b->layer->turn[(int)(stroke_chance(s->point, 2) * 256)];
	s->along_px[0] = half_px * (along[0] * turn[0] - along[1] * turn[1]);
	s->along_px[1] = half_px * (along[0] * turn[1] + along[1] * turn[0]);
}

static float opacity_of(const struct brush *b, const struct candidate *c)
{
	const struct ink_step *ink = &b->layer->ink;
	float degree = b->f->scene->degree[c->point] / 255.f;
	float alpha = ink->opacity * (1 - ink->opacity_variation * stroke_chance(c->point, 3));
	alpha *= 1 - ink->degree * (1 - degree);
	return ink->fade_m > 0 ? alpha * exp2f(-c->depth_m / ink->fade_m) : alpha;
}

/* line NULL: at the layer's own angle; normal NULL: of one depth. */
static struct stroke stroke_of(const struct brush *b, const struct candidate *c, float alpha,
	float growth, const struct line *line, const float *normal)
{
	const struct ink_step *ink = &b->layer->ink;
	struct stroke s = { .x_px = c->x_px, .y_px = c->y_px, .alpha = alpha, .point = c->point };
	float half_px = growth * ink->length_px / 2 *
			(1 + ink->length_variation * around_zero(c->point, 1));
	s.half_width_px = growth * ink->width_px / 2;
	s.q = 1 / c->depth_m;
	if (line) {
		float whole = b->focal_px / c->depth_m;
		half_px *= CLAMP(2 * line->px_per_m / whole, FORESHORTENED, 1);
		turn_along(b, &s, line->along, half_px);
		for (int k = 0; k < 2; k++)
			s.slope[k] = line->slope * line->along[k];
	} else {
		turn_along(b, &s, b->layer->own_way, half_px);
		if (normal)
			plane_slope(b, c, normal, half_px, s.slope);
	}
	colour_of(b, c, s.rgba);
	return s;
}

static bool is_seen_from_behind(
	const struct brush *b, const struct candidate *c, const float normal[3])
{
	float ray[3];
	ray_of(b, c, ray);
	return frame_pipeline(b->f, b->layer->pipeline)->mask.backs == BACKS_HIDDEN &&
	       vector3_dot(normal, ray) > 0;
}

static bool goes_along(const struct brush *b)
{
	int32_t direction = b->layer->ink.direction;
	return direction == DIRECTION_LINE ||
	       (direction == DIRECTION_EDGE && b->kind == FEATURE_DIRECTED);
}

static void add_stroke(const struct brush *b, const struct candidate *c, float alpha, float growth,
	const struct line *line, const float *normal, GArray *to)
{
	alpha *= opacity_of(b, c);
	if (alpha < ALPHA_LEAST)
		return;
	struct stroke s = stroke_of(b, c, alpha, growth, line, normal);
	g_array_append_val(to, s);
}

static void try_on_edge(const struct brush *b, struct candidate *c, GArray *to)
{
	struct line line;
	float normal[3];
	bool has_line = line_of(b, c, &line);
	float shown = visibility(b, c);
	to_camera(b, b->f->scene->normal[c->point], normal);
	if (shown <= 0 || is_seen_from_behind(b, c, normal) || !has_line)
		return;
	add_stroke(b, c, shown * stroke_fade(c->rank, need_along(b, c, &line)), 1,
		goes_along(b) ? &line : NULL, normal, to);
}

static void try_on_surface(const struct brush *b, struct candidate *c, GArray *to)
{
	struct line line;
	float normal[3];
	struct place place = place_of(b, c);
	if (place.rank >= need_on_surface(b, c, b->ray_most))
		return;
	to_camera(b, b->f->scene->normal[c->point], normal);
	bool is_flat = b->kind < FEATURE_UNDIRECTED &&
		       (normal[0] != 0 || normal[1] != 0 || normal[2] != 0);
	if (is_flat && b->layer->ink.scatter > 0)
		scatter(b, normal, c);
	float need = need_on_surface(b, c, cosine_of(b, c, normal)),
	      fade = stroke_fade(place.rank, need);
	float shown = fade > 0 ? visibility(b, c) : 0;
	if (shown <= 0 || is_seen_from_behind(b, c, normal))
		return;
	bool has_line = goes_along(b) && line_of(b, c, &line);
	add_stroke(b, c, shown * fade, MIN(stroke_growth(need / place.last), b->layer->ink.grow),
		has_line ? &line : NULL, is_flat ? normal : NULL, to);
}

/* ---- a chunk's points ---- */

/* need = this * (px_per_m * spacing)^2 at most, of points on surface. */
static float wanted_most(const struct brush *b)
{
	const struct frame_layer *l = b->layer;
	float most = 0;
	for (int n = 0; n < 256; n++) {
		float here = l->wanted_per_px[n];
		if (is_toned_dithering(l) && b->kind == FEATURE_DITHER)
			here *= b->f->scene->dither_per_m2 / l->dithering_per_m2[n];
		most = MAX(most, here);
	}
	return most * b->ray_most;
}

/* No rank above it is drawn. */
static float need_most(const struct brush *b)
{
	const struct scene_chunk *c = b->view->chunk;
	float scale = b->focal_px / b->view->near_m *
		      (shares_queue(b) ? c->spacing_most_m : c->list_spacing_most_m[b->kind]);
	if (is_on_edge(b))
		return scale * b->ray_most / (b->layer->ink.spacing_px * STROKE_FADE_MEAN);
	return b->wanted_most * scale * scale;
}

INLINE vf gather_u16(const uint16_t *from, const uint16_t *list)
{
	int32_t x[LANES];
	for (int k = 0; k < LANES; k++)
		x[k] = from[list[k]];
	return __builtin_convertvector(*(const vi_loose *)x, vf);
}

/* Those of eight that may be drawn, by what is quickly told. */
INLINE unsigned promising(const struct brush *b, const struct lane_points *l, vf rank, vf spacing_m)
{
	float reach = b->layer->ink.length_px / 2;
	vf scale = spacing_m * (b->focal_px / l->depth_m);
	vf need = is_on_edge(b)
			  ? scale * (b->ray_most / (b->layer->ink.spacing_px * STROKE_FADE_MEAN))
			  : scale * scale * b->wanted_most;
	return bits((l->depth_m > b->near_m) & (l->x_px >= -reach) & (l->y_px >= -reach) &
		    (l->x_px < 2 * b->middle_x + reach) & (l->y_px < 2 * b->middle_y + reach) &
		    (rank < need));
}

INLINE void choose_points(const struct brush *b, GArray *to)
{
	const scene *s = b->f->scene;
	const struct scene_chunk *c = b->view->chunk;
	float ranks = 1.f / (float)b->list_count;
	uint32_t end = (uint32_t)MIN(need_most(b) * (float)b->list_count + 1, (float)b->list_count);
	for (uint32_t i = 0; i < end; i += LANES) {
		uint32_t at = c->first + b->list_from + i;
		const uint16_t *list = s->list + at;
		vf q[3];
		for (int axis = 0; axis < 3; axis++)
			q[axis] = gather_u16(s->q[axis] + c->first, list);
		struct lane_points l =
			project_lanes(b->view, q, b->focal_px, b->middle_x, b->middle_y);
		vf rank = ((float)i + 0.5f + lane_number) * ranks;
		vf spacing_m = (shares_queue(b) ? gather_u16(s->spacing + c->first, list)
						: load_u16(s->list_spacing + at)) *
			       UNIT_M;
		unsigned left = promising(b, &l, rank, spacing_m);
		if (end - i < LANES)
			left &= (1u << (end - i)) - 1;
		for (; left; left &= left - 1) {
			int k = __builtin_ctz(left);
			struct candidate one = { c->first + list[k], rank[k], spacing_m[k],
				l.x_px[k], l.y_px[k], l.depth_m[k] };
			(is_on_edge(b) ? try_on_edge : try_on_surface)(b, &one, to);
		}
	}
}

static void choose_portable(const struct brush *b, GArray *to)
{
	choose_points(b, to);
}

#if defined __x86_64__
__attribute__((target("avx2"))) static void choose_avx2(const struct brush *b, GArray *to)
{
	choose_points(b, to);
}
#else
#define choose_avx2 choose_portable
#endif

static struct brush brush_of(const frame *f, const visibility_mask *m, const struct chunk_view *v,
	const struct frame_layer *l)
{
	const struct camera *c = &f->camera;
	struct brush b = { f, l, v, m, (float)c->focal_px, (float)c->width / 2,
		(float)c->height / 2, (float)c->near_m };
	const double *row[3] = { c->right, c->down, c->forward };
	for (int k = 0; k < 3; k++)
		for (int n = 0; n < 3; n++)
			b.turn[k][n] = (float)row[k][n];
	float reach = l->ink.length_px / 2;
	float corner[3] = { (b.middle_x + reach) / b.focal_px, (b.middle_y + reach) / b.focal_px,
		1 };
	b.ray_most = vector3_length(corner);
	return b;
}

static void choose_kinds(struct brush *b, GArray *to)
{
	bool wide = !b->f->portable && vectors_have_avx2();
	for (b->kind = 0; b->kind < FEATURE_KINDS; b->kind++) {
		b->list_from = b->kind ? b->view->chunk->kind_end[b->kind - 1] : 0;
		b->list_count = b->view->chunk->kind_end[b->kind] - b->list_from;
		if (!(b->layer->kinds >> b->kind & 1) || !b->list_count)
			continue;
		b->wanted_most = wanted_most(b);
		(wide ? choose_avx2 : choose_portable)(b, to);
	}
}

/* ---- all ---- */

struct task {
	GArray *of_layer[FRAME_LAYERS_MAX];
};

static void run_task(const frame *f, const visibility_mask *m, const struct chunk_view *views,
	uint32_t count, struct task *t)
{
	for (uint32_t n = 0; n < count; n++) {
		if (m && mask_hides(m, &views[n]))
			continue;
		for (uint32_t l = 0; l < f->layers; l++) {
			if (f->layer[l].pipeline != views[n].pipeline)
				continue;
			struct brush b = brush_of(f, m, &views[n], &f->layer[l]);
			if (!t->of_layer[l])
				t->of_layer[l] = g_array_new(FALSE, FALSE, sizeof(struct stroke));
			choose_kinds(&b, t->of_layer[l]);
		}
	}
}

static void join(const struct task *task, uint32_t tasks, uint32_t layer, stroke_list *ret)
{
	size_t count = 0, at = 0;
	for (uint32_t n = 0; n < tasks; n++)
		count += task[n].of_layer[layer] ? task[n].of_layer[layer]->len : 0;
	ret->stroke = g_new(struct stroke, count + 1);
	ret->count = (uint32_t)count;
	for (uint32_t n = 0; n < tasks; n++) {
		GArray *a = task[n].of_layer[layer];
		if (!a)
			continue;
		if (a->len)
			memcpy(ret->stroke + at, a->data, a->len * sizeof(struct stroke));
		at += a->len;
		g_array_unref(a);
	}
}

stroke_list *stroke_lists_new(
	const frame *f, const visibility_mask *m, const struct chunk_view *views, uint32_t count)
{
	uint32_t tasks = (count + TASK_CHUNKS - 1) / TASK_CHUNKS;
	g_autofree struct task *task = g_new0(struct task, tasks + 1);
	stroke_list *lists = g_new0(stroke_list, f->layers + 1);
#pragma omp parallel for schedule(dynamic, 1) if (!f->single_thread)
	for (uint32_t n = 0; n < tasks; n++)
		run_task(f, m, views + n * TASK_CHUNKS, MIN(TASK_CHUNKS, count - n * TASK_CHUNKS),
			&task[n]);
#pragma omp parallel for schedule(dynamic, 1) if (!f->single_thread)
	for (uint32_t l = 0; l < f->layers; l++)
		join(task, tasks, l, &lists[l]);
	return lists;
}

void stroke_lists_free(stroke_list *lists, uint32_t layers)
{
	for (uint32_t l = 0; lists && l < layers; l++)
		g_free(lists[l].stroke);
	g_free(lists);
}
