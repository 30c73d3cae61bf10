#include "process/features-private.h"
#include "process/model.h"
#include <string.h>

/* Neighbours are taken so many cells away at most, and a window's width at best. */
#define REACH_MOST 16
/* Normals further apart are of another face; points further off the plane, as a share of how far away they are, too. */
#define SAME_FACE        0.7f
#define OFF_PLANE        0.5f
#define NEIGHBOURS_LEAST 6

/* What the neighbours say of the second fundamental form: a a, a b, b b and the products with the change of the normal. */
struct form {
	float aa, ab, bb, ap, aq_bp, bq;
	unsigned count, ways; /* ways: of the eight directions, one bit each */
};

struct frame {
	float normal[3], first[3], second[3];
};

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static struct frame frame_of(const float normal[3])
{
	struct frame f;
	const float level = sqrtf(normal[0] * normal[0] + normal[1] * normal[1]);
	memcpy(f.normal, normal, sizeof f.normal);
	f.first[0] = level > 1e-3f ? -normal[1] / level : 1;
	f.first[1] = level > 1e-3f ? normal[0] / level : 0;
	f.first[2] = level > 1e-3f ? 0
				   : -normal[0] / fmaxf(fabsf(normal[2]), 1e-6f) *
					     (normal[2] < 0 ? -1 : 1);
	for (int k = 0; k < 3; k++)
		f.second[k] = normal[(k + 1) % 3] * f.first[(k + 2) % 3] -
			      normal[(k + 2) % 3] * f.first[(k + 1) % 3];
	return f;
}

static void add_neighbour(const struct features_input *of, const float *const normal[3],
	const struct frame *f, size_t i, size_t k, int way, struct form *into)
{
	const range_grid *g = of->grid;
	const float there[3] = { normal[0][k], normal[1][k], normal[2][k] };
	const float off[3] = { g->x_m[k] - g->x_m[i], g->y_m[k] - g->y_m[i],
		g->z_m[k] - g->z_m[i] };
	const float ahead = dot(off, f->normal);
	if (!(g->range_m[k] > 0) || !(dot(there, f->normal) > SAME_FACE) ||
		ahead * ahead > OFF_PLANE * OFF_PLANE * dot(off, off) ||
		(of->leaf && of->leaf[i] && of->leaf[k] && of->leaf[i] != of->leaf[k]))
		return;
	float a = dot(off, f->first), b = dot(off, f->second), p = dot(there, f->first),
	      q = dot(there, f->second);
	into->aa += a * a;
	into->ab += a * b;
	into->bb += b * b;
	into->ap += a * p;
	into->aq_bp += a * q + b * p;
	into->bq += b * q;
	into->count++;
	into->ways |= 1u << way;
}

/* Neighbours on all sides, or at least on three of the four axes: an edge's own side alone tells nothing. */
static bool is_around(const struct form *s)
{
	unsigned both = s->ways & s->ways >> 4 & 15;
	return s->count >= NEIGHBOURS_LEAST && (both & (both - 1));
}

/* The symmetric matrix that takes a step to the change of the normal, by least squares; false: it is not determined. */
static bool solve(const struct form *s, float ret[3])
{
	const float m[3][3] = { { s->aa, s->ab, 0 }, { s->ab, s->aa + s->bb, s->ab },
		{ 0, s->ab, s->bb } };
	const float r[3] = { s->ap, s->aq_bp, s->bq };
	float c00 = m[1][1] * m[2][2] - m[1][2] * m[2][1], c01 = -(m[1][0] * m[2][2]),
	      c02 = m[1][0] * m[2][1];
	float det = m[0][0] * c00 + m[0][1] * c01, c11 = m[0][0] * m[2][2],
	      c12 = -(m[0][0] * m[1][2]);
	float c22 = m[0][0] * m[1][1] - m[0][1] * m[1][0], scale = s->aa + s->bb;
	if (!(det > 1e-4f * scale * scale * scale))
		return false;
	ret[0] = (c00 * r[0] + c01 * r[1] + c02 * r[2]) / det;
	ret[1] = (c01 * r[0] + c11 * r[1] + c12 * r[2]) / det;
	ret[2] = (c02 * r[0] + c12 * r[1] + c22 * r[2]) / det;
	return true;
}

static void keep_form(features *f, size_t i, const struct frame *frame, const float s[3])
{
	float mean = 0.5f * (s[0] + s[2]), half = 0.5f * (s[0] - s[2]),
	      apart = sqrtf(half * half + s[1] * s[1]), along[3];
	/* Half the angle of (half, s[1]), without its sine. */
	float cosine = apart > 0 ? sqrtf(fmaxf(0.5f + 0.5f * half / apart, 0)) : 1;
	float sine = apart > 0 ? copysignf(sqrtf(fmaxf(0.5f - 0.5f * half / apart, 0)), s[1]) : 0;
	f->k1[i] = mean + apart;
	f->k2[i] = mean - apart;
	if (fabsf(f->k2[i]) > fabsf(f->k1[i])) {
		float swap = f->k1[i], turned = -sine;
		f->k1[i] = f->k2[i];
		f->k2[i] = swap;
		sine = cosine;
		cosine = turned;
	}
	for (int k = 0; k < 3; k++)
		along[k] = cosine * frame->first[k] + sine * frame->second[k];
	model_pack_normal(along, f->principal[i]);
}

static int cells_of(
	const range_grid *g, const struct features_options *o, float range_m, float beam_rad)
{
	float beam_m = range_m * beam_rad,
	      wide_m = fmaxf(o->radius_m, sqrtf(62 * o->range_noise_m * beam_m));
	(void)g;
	return CLAMP((int)lrintf(1.5f * wide_m / beam_m), 1, REACH_MOST);
}

static void bend_cell(const struct features_input *of, const float *const normal[3],
	const struct features_options *o, uint32_t row, uint32_t column, features *f)
{
	/* One after the other around; the opposite of each is four later. */
	static const int8_t way[8][2] = { { 0, 1 }, { 1, 1 }, { 1, 0 }, { 1, -1 }, { 0, -1 },
		{ -1, -1 }, { -1, 0 }, { -1, 1 } };
	const range_grid *g = of->grid;
	const size_t i = (size_t)row * g->columns + column;
	const float own[3] = { normal[0][i], normal[1][i], normal[2][i] };
	if (!(g->range_m[i] > 0) || !(dot(own, own) > 0))
		return;
	const float level =
		fmaxf(sqrtf(g->x_m[i] * g->x_m[i] + g->y_m[i] * g->y_m[i]) / g->range_m[i], 0.05f);
	const int down = cells_of(g, o, g->range_m[i], (float)g->row_rad);
	const int right = cells_of(g, o, g->range_m[i], (float)g->column_rad * level);
	const struct frame frame = frame_of(own);
	struct form form = { 0 };
	for (int half = 2; half >= 1; half--)
		for (int w = 0; w < 8; w++) {
			size_t k;
			int y = way[w][0] * MAX(down / half, 1),
			    x = way[w][1] * MAX(right / half, 1);
			if (range_grid_step(g, row, column, y, x, &k))
				add_neighbour(of, normal, &frame, i, k, w, &form);
		}
	float s[3];
	if (is_around(&form) && solve(&form, s))
		keep_form(f, i, &frame, s);
}

void feature_curvature(const struct features_input *of, const float *const normal[3],
	const struct features_options *o, features *f)
{
#pragma omp parallel for schedule(dynamic, 8) if (!o->single_thread)
	for (uint32_t row = 0; row < of->grid->rows; row++)
		for (uint32_t column = 0; column < of->grid->columns; column++)
			bend_cell(of, normal, o, row, column, f);
}
