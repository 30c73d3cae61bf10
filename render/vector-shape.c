#include "render/vector-shape.h"
#include <math.h>
#include <string.h>

/* Of a sprite's Gaussian kernel: its diameter is so many sigmas (band-draw-lanes.c), and within it is this part of all its ink. */
#define SIGMAS 5.f
#define WITHIN 0.956f
/* Samples along a stroke: one to each pixel, but no more than this. */
#define SAMPLES_MOST 48

/* Edges lie no farther from where they should than this part of what nobody sees along a stroke. */
#define EDGE_FINE 0.4f

/* ---- profiles ---- */

/* covers: what is as good as 1, of alpha. Sums of alpha over the columns around a station: of all, squared, and with how far it is from the middle, -1 to 1. */
struct ink {
	double all, squares, aside;
};

static struct ink ink_around(const stroke_texture *t, const uint8_t *alpha, double covers,
	double from, double end, double *ret_columns)
{
	struct ink ink = { 0 };
	uint32_t first = (uint32_t)fmax(from * t->length, 0),
		 last = (uint32_t)fmin(ceil(end * t->length), t->length);
	for (uint32_t y = 0; y < t->width; y++)
		for (uint32_t x = first; x < last; x++) {
			double a = fmin(alpha[y * t->length + x] / 255.0 / covers, 1);
			ink.all += a;
			ink.squares += a * a;
			ink.aside += a * ((2.0 * y + 1) / t->width - 1);
		}
	*ret_columns = last - first;
	return ink;
}

/* The ink of each part of the length, pushed together until it is as opaque as ink of the stroke is on average. */
static struct vector_profile profile_of(const stroke_texture *t, double covers, uint32_t variant)
{
	const uint8_t *alpha = stroke_texture_variant(t, variant);
	struct vector_profile p = { 0 };
	double columns;
	struct ink whole = ink_around(t, alpha, covers, 0, 1, &columns);
	p.opacity = whole.all > 0 ? (float)(whole.squares / whole.all) : 0;
	for (int n = 0; n < VECTOR_STATIONS && p.opacity > 0; n++) {
		double at = (double)n / (VECTOR_STATIONS - 1), reach = 0.5 / (VECTOR_STATIONS - 1);
		struct ink here = ink_around(t, alpha, covers, at - reach, at + reach, &columns);
		if (here.all > 0)
			p.middle[n] = (float)(here.aside / here.all);
		p.half[n] = (float)(here.all / (columns * t->width * (double)p.opacity));
	}
	return p;
}

/* Of paint that of the broadest strokes. */
static const stroke_texture *texture_of(const struct frame_layer *l)
{
	return l->paint ? l->paint->level[0].texture : l->texture;
}

static uint32_t variant_of(const struct vector_shaper *v, const struct stroke *s)
{
	return (uint32_t)(stroke_chance(s->point, stroke_salt(s->copy, SALT_VARIANT)) *
			  (float)texture_of(v->layer)->variants);
}

/* Of a disc the edges are so near where they should be, in half widths. */
#define ROUND_OFF 0.2f

static bool is_round(const struct vector_profile *p)
{
	for (int n = 0; n < VECTOR_STATIONS; n++) {
		float t = 2 * (float)n / (VECTOR_STATIONS - 1) - 1;
		if (fabsf(p->middle[n]) > ROUND_OFF ||
			fabsf(p->half[n] - sqrtf(1 - t * t)) > ROUND_OFF)
			return false;
	}
	return p->opacity > 0;
}

/* Diameter of the disc that has as much ink, in half lengths. */
static float disc_of(const struct vector_profile *p)
{
	float area = 0;
	for (int n = 1; n < VECTOR_STATIONS; n++)
		area += (p->half[n - 1] + p->half[n]) * 2 / (VECTOR_STATIONS - 1);
	return 2 * sqrtf(area / (float)G_PI);
}

/* Dots of hatching that follow the screen are as long as wide on any surface. */
static bool has_discs(const struct frame_layer *l)
{
	return l->hatch && l->hatch->step.follows == FOLLOWS_SCREEN &&
	       fabsf(l->ink.length_px / l->ink.width_px - 1) < 0.05f;
}

struct vector_shaper vector_shaper_of(const struct frame_layer *l, const visibility_mask *m,
	uint32_t width, uint32_t height, float fine_px)
{
	struct vector_shaper v = { .layer = l,
		.mask = m,
		.width = width,
		.height = height,
		.fine_px = fine_px,
		.edge_px = EDGE_FINE * fine_px };
	const stroke_texture *t = texture_of(l);
	double covers = l->paint ? PAINT_COVERS : 1;
	v.form = t || l->is_profile      ? VECTOR_AREAS
		 : step_is_dots(l->step) ? VECTOR_DOTS
					 : VECTOR_LINES;
	for (uint32_t n = 0; t && n < MIN(t->variants, STROKE_TEXTURE_VARIANTS); n++)
		v.profile[n] = profile_of(t, covers, n);
	bool round = t && has_discs(l);
	for (uint32_t n = 0; round && n < MIN(t->variants, STROKE_TEXTURE_VARIANTS); n++)
		round = is_round(&v.profile[n]);
	if (round) {
		v.form = VECTOR_DOTS;
		v.disc = disc_of(&v.profile[0]);
	}
	return v;
}

/* ---- what is seen ---- */

static float key_as_float(int32_t key)
{
	union {
		int32_t bits;
		float value;
	} u = { key };
	return u.value;
}

static bool is_reached(
	const struct vector_shaper *v, struct stroke_reach r, int32_t x, int32_t y, float q)
{
	if (x < 0 || y < 0 || x >= (int32_t)v->width || y >= (int32_t)v->height)
		return false;
	float behind = q * key_as_float(mask_key(v->mask, x, y));
	return behind >= r.from && behind <= r.to;
}

static bool is_reached_beside(const struct vector_shaper *v, struct stroke_reach r, int32_t x,
	int32_t y, int32_t right, int32_t down, float q)
{
	int32_t far = v->layer->paint->hole_px, half = (far + 1) / 2;
	return is_reached(v, r, x + right * half, y + down * half, q) ||
	       is_reached(v, r, x + right * far, y + down * far, q);
}

/* Where the painter lays paint: on what it reaches, and on small holes in that. */
static bool takes_paint(
	const struct vector_shaper *v, const struct stroke *s, int32_t x, int32_t y, float q)
{
	struct stroke_reach r = stroke_paint_reach(v->layer->paint, s);
	if (is_reached(v, r, x, y, q) || mask_key(v->mask, x, y) < MASK_EMPTY)
		return is_reached(v, r, x, y, q);
	return (is_reached_beside(v, r, x, y, -1, 0, q) &&
		       is_reached_beside(v, r, x, y, 1, 0, q)) ||
	       (is_reached_beside(v, r, x, y, 0, -1, q) && is_reached_beside(v, r, x, y, 0, 1, q));
}

/* A place of the stroke, along and across from its middle; as the painter asks for a pixel (band-draw-lanes.c). */
static bool is_seen(
	const struct vector_shaper *v, const struct stroke *s, float along, float across)
{
	float x = s->x_px + along * s->along[0] - across * s->along[1],
	      y = s->y_px + along * s->along[1] + across * s->along[0];
	if (!(x >= 0 && y >= 0 && x < (float)v->width && y < (float)v->height))
		return false;
	if (!v->mask)
		return true;
	int32_t column = (int32_t)x, row = (int32_t)y;
	float q = s->q + ((float)column + 0.5f - s->x_px) * s->slope[0] +
		  ((float)row + 0.5f - s->y_px) * s->slope[1];
	if (v->layer->paint)
		return takes_paint(v, s, column, row, q);
	return q * key_as_float(mask_key(v->mask, column, row)) >= stroke_shows_from(v->layer, s);
}

/* Of its breadth more than half. */
static bool is_seen_there(const struct vector_shaper *v, const struct stroke *s, float along)
{
	if (s->half_width_px < 1.5f)
		return is_seen(v, s, along, 0);
	int seen = 0;
	for (int n = -1; n <= 1; n++)
		seen += is_seen(v, s, along, 0.5f * (float)n * s->half_width_px);
	return seen >= 2;
}

static bool is_dot_seen(const struct vector_shaper *v, const struct stroke *s)
{
	float reach = 0.4f * s->half_length_px;
	int seen = is_seen(v, s, 0, 0) + is_seen(v, s, reach, 0) + is_seen(v, s, -reach, 0) +
		   is_seen(v, s, 0, reach) + is_seen(v, s, 0, -reach);
	return seen >= 3;
}

/* A part that is too short is left out, or as long as can be seen, by chance: so that means stay. */
static bool keeps(const struct stroke *s, uint32_t number, float fine, float run[2])
{
	float length = run[1] - run[0], middle = (run[0] + run[1]) / 2;
	if (length >= 2 * fine)
		return true;
	if (stroke_chance(s->point ^ (number + 1) * 0x5bd1e995u, stroke_salt(s->copy, SALT_SHADE)) *
			2 * fine >=
		length)
		return false;
	run[0] = middle - fine;
	run[1] = middle + fine;
	return true;
}

/* Of these, with what is between them where that is too short to be seen. */
static uint32_t join_runs(
	const struct vector_shaper *v, const struct stroke *s, float run[][2], uint32_t runs)
{
	float fine = fminf(v->fine_px / s->half_length_px, 0.5f);
	uint32_t joined = 0, kept = 0;
	for (uint32_t n = 0; n < runs; n++)
		if (joined && run[n][0] - run[joined - 1][1] < 2 * fine)
			run[joined - 1][1] = run[n][1];
		else
			memmove(run[joined++], run[n], sizeof *run);
	for (uint32_t n = 0; n < joined; n++)
		if (keeps(s, n, fine, run[n]))
			memmove(run[kept++], run[n], sizeof *run);
	return kept;
}

/* Parts that are seen, from and to along the stroke, -1 to 1. */
static uint32_t find_runs(
	const struct vector_shaper *v, const struct stroke *s, float run[VECTOR_PARTS_MOST][2])
{
	int samples = CLAMP((int)(2 * s->half_length_px + 0.5f), 3, SAMPLES_MOST);
	uint32_t runs = 0;
	bool before = false;
	for (int n = 0; n < samples; n++) {
		float from = 2.f * (float)n / (float)samples - 1;
		bool seen = is_seen_there(v, s, (from + 1.f / (float)samples) * s->half_length_px);
		if (seen && !before && runs == VECTOR_PARTS_MOST)
			break;
		if (seen && !before)
			run[runs++][0] = from;
		if (seen)
			run[runs - 1][1] = 2.f * (float)(n + 1) / (float)samples - 1;
		before = seen;
	}
	return join_runs(v, s, run, runs);
}

/* ---- shapes ---- */

static void add_corner(struct vector_shape *to, const struct stroke *s, float along, float across)
{
	float *c = to->corner[to->corners++];
	c[0] = s->x_px + along * s->along[0] - across * s->along[1];
	c[1] = s->y_px + along * s->along[1] + across * s->along[0];
}

static float station_at(int n)
{
	return 2.f * (float)n / (VECTOR_STATIONS - 1) - 1;
}

/* Where an edge of an area is at t of -1 to 1, in half widths; side: -1 or 1, or farther from the middle. */
static float edge_at(const struct vector_profile *p, float t, float side)
{
	float at = (t + 1) / 2 * (VECTOR_STATIONS - 1);
	int first = CLAMP((int)at, 0, VECTOR_STATIONS - 2);
	float part = at - (float)first;
	float middle = p->middle[first] + part * (p->middle[first + 1] - p->middle[first]),
	      half = p->half[first] + part * (p->half[first + 1] - p->half[first]);
	return middle + side * half;
}

static void add_edge(struct vector_shape *to, const struct vector_profile *p,
	const struct stroke *s, float t, float side)
{
	add_corner(to, s, t * s->half_length_px, edge_at(p, t, side) * s->half_width_px);
}

/* How far the edges at t lie from straight ones between two other places; in half widths. */
static float away_from(const struct vector_profile *p, float from, float end, float t)
{
	float most = 0, part = (t - from) / (end - from);
	for (int side = -1; side <= 1; side += 2) {
		float a = edge_at(p, from, (float)side), b = edge_at(p, end, (float)side);
		most = fmaxf(most, fabsf(edge_at(p, t, (float)side) - a - part * (b - a)));
	}
	return most;
}

/* Of the places first to last those that edges cannot do without (Douglas & Peucker 1973). */
static void keep_between(const struct vector_profile *p, const float *place, int first, int last,
	float tolerance, bool *kept)
{
	int worst = first;
	float most = tolerance;
	for (int n = first + 1; n < last; n++) {
		float away = away_from(p, place[first], place[last], place[n]);
		if (away > most) {
			worst = n;
			most = away;
		}
	}
	if (worst == first)
		return;
	kept[worst] = true;
	keep_between(p, place, first, worst, tolerance, kept);
	keep_between(p, place, worst, last, tolerance, kept);
}

/* What lies between the edges; kept NULL: with all places. */
static float area_of(const struct vector_profile *p, const float *place, const bool *kept, int last)
{
	float sum = 0, from = place[0];
	for (int n = 1; n <= last; n++) {
		if (kept && !kept[n])
			continue;
		float broad = edge_at(p, from, 1) - edge_at(p, from, -1) + edge_at(p, place[n], 1) -
			      edge_at(p, place[n], -1);
		sum += (place[n] - from) * broad / 2;
		from = place[n];
	}
	return sum;
}

/* With as much ink as with all places; where too few were left for that, with more of them. */
#define BROADER_MOST 1.5f
static float keep_some(
	const struct vector_profile *p, const float *place, int last, float tolerance, bool *kept)
{
	float all = area_of(p, place, NULL, last), broader;
	do {
		keep_between(p, place, 0, last, tolerance, kept);
		broader = all / fmaxf(area_of(p, place, kept, last), 1e-6f);
		tolerance /= 2;
	} while (broader > BROADER_MOST && tolerance > 1e-3f);
	return CLAMP(broader, 1, BROADER_MOST);
}

static void outline(struct vector_shape *to, const struct vector_profile *p, const struct stroke *s,
	const float run[2], float edge_px)
{
	float place[VECTOR_STATIONS + 2] = { run[0] };
	bool kept[VECTOR_STATIONS + 2] = { true };
	int last = 0;
	for (int n = 0; n < VECTOR_STATIONS; n++)
		if (station_at(n) > run[0] && station_at(n) < run[1])
			place[++last] = station_at(n);
	place[++last] = run[1];
	kept[last] = true;
	float broader = keep_some(p, place, last, edge_px / s->half_width_px, kept);
	for (int n = 0; n <= last; n++)
		if (kept[n])
			add_edge(to, p, s, place[n], -broader);
	for (int n = last; n >= 0; n--)
		if (kept[n])
			add_edge(to, p, s, place[n], broader);
}

uint32_t vector_shapes_of(const struct vector_shaper *v, const struct stroke *s,
	struct vector_shape ret[VECTOR_PARTS_MOST])
{
	float run[VECTOR_PARTS_MOST][2];
	uint32_t runs;
	if (v->form == VECTOR_DOTS) {
		ret[0].corners = 0;
		add_corner(&ret[0], s, 0, 0);
		return is_dot_seen(v, s);
	}
	runs = find_runs(v, s, run);
	for (uint32_t n = 0; n < runs; n++) {
		ret[n].corners = 0;
		if (v->form == VECTOR_AREAS)
			outline(&ret[n], &v->profile[variant_of(v, s)], s, run[n], v->edge_px);
		else
			for (int end = 0; end < 2; end++)
				add_corner(&ret[n], s, run[n][end] * s->half_length_px, 0);
	}
	return runs;
}

/* ---- looks ---- */

float vector_width_px(const struct vector_shaper *v, const struct stroke *s)
{
	if (v->form == VECTOR_AREAS)
		return 0;
	if (v->form == VECTOR_LINES)
		return 2 * s->half_width_px;
	if (v->disc > 0)
		return v->disc * s->half_length_px;
	float sigma = 2 * s->half_length_px / SIGMAS; /* a disc of the area 2 pi sigma^2 */
	return 2 * sigma * sqrtf(2 * WITHIN);
}

float vector_alpha(const struct vector_shaper *v, const struct stroke *s)
{
	float alpha = v->layer->paint ? 1 - PAINT_DRY(s->alpha) : s->alpha;
	if (v->form == VECTOR_AREAS || v->disc > 0)
		alpha *= v->profile[variant_of(v, s)].opacity;
	return alpha;
}
