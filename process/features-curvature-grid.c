#include "process/features-private.h"
#include "process/vector3.h"

/* Neighbours are taken so many cells away at most, and a window's width at best. */
#define REACH_MOST 16
/* One after the other around; the opposite of each is four later. */
#define WAYS 8
static const int8_t ways[WAYS][2] = { { 0, 1 }, { 1, 1 }, { 1, 0 }, { 1, -1 }, { 0, -1 },
	{ -1, -1 }, { -1, 0 }, { -1, 1 } };

/* Cells of a row, side by side for vectors: their points, frames (u, v: the tangents) and forms. */
#define LANES 128
struct lanes {
	uint32_t count, row, column[LANES];
	int32_t near[LANES];              /* cell of the neighbour that is added */
	uint32_t is_near[LANES];          /* 0: there is none */
	int8_t down[LANES], right[LANES]; /* cells to the furthest */
	float x[LANES], y[LANES], z[LANES];
	float nx[LANES], ny[LANES], nz[LANES], ux[LANES], uy[LANES], uz[LANES], vx[LANES],
		vy[LANES], vz[LANES];
	float a[LANES], b[LANES], p[LANES], q[LANES], aa[LANES], ab[LANES], bb[LANES], ap[LANES],
		aq_bp[LANES], bq[LANES];
	uint32_t added[LANES], ways[LANES];
};

struct bender {
	const struct features_input *of;
	const float *const *normal;
	const struct features_options *options;
	features *f;
};

static int8_t cells_of(const struct features_options *o, float range_m, float beam_rad)
{
	float beam_m = range_m * beam_rad,
	      wide_m = fmaxf(o->radius_m, sqrtf(62 * o->range_noise_m * beam_m));
	return (int8_t)CLAMP((int)lrintf(1.5f * wide_m / beam_m), 1, REACH_MOST);
}

static void put_cell(const struct bender *t, uint32_t column, struct lanes *l)
{
	const range_grid *g = t->of->grid;
	const size_t i = (size_t)l->row * g->columns + column;
	const float own[3] = { t->normal[0][i], t->normal[1][i], t->normal[2][i] };
	const uint32_t n = l->count;
	if (!(g->range_m[i] > 0) || !(vector3_dot(own, own) > 0))
		return;
	const float level =
		fmaxf(sqrtf(g->x_m[i] * g->x_m[i] + g->y_m[i] * g->y_m[i]) / g->range_m[i], 0.05f);
	const struct feature_frame frame = feature_frame_of(own);
	l->down[n] = cells_of(t->options, g->range_m[i], (float)g->row_rad);
	l->right[n] = cells_of(t->options, g->range_m[i], (float)g->column_rad * level);
	l->column[n] = column;
	l->x[n] = g->x_m[i];
	l->y[n] = g->y_m[i];
	l->z[n] = g->z_m[i];
	l->nx[n] = own[0];
	l->ny[n] = own[1];
	l->nz[n] = own[2];
	l->ux[n] = frame.first[0];
	l->uy[n] = frame.first[1];
	l->uz[n] = frame.first[2];
	l->vx[n] = frame.second[0];
	l->vy[n] = frame.second[1];
	l->vz[n] = frame.second[2];
	l->a[n] = l->b[n] = l->p[n] = l->q[n] = 0;
	l->aa[n] = l->ab[n] = l->bb[n] = l->ap[n] = l->aq_bp[n] = l->bq[n] = 0;
	l->added[n] = l->ways[n] = 0;
	l->count++;
}

/* Sets the neighbours one way, of all lanes. */
static void step(const struct bender *t, const int8_t way[2], int half, struct lanes *l)
{
	const range_grid *g = t->of->grid;
	const uint16_t *leaf = t->of->leaf;
	for (uint32_t n = 0; n < l->count; n++) {
		const size_t i = (size_t)l->row * g->columns + l->column[n];
		const int y = way[0] * MAX(l->down[n] / half, 1),
			  x = way[1] * MAX(l->right[n] / half, 1);
		size_t k = i;
		bool is = range_grid_step(g, l->row, l->column[n], y, x, &k) && g->range_m[k] > 0 &&
			  !(leaf && leaf[i] && leaf[k] && leaf[i] != leaf[k]);
		l->is_near[n] = is;
		l->near[n] = (int32_t)(is ? k : i);
	}
}

/* feature_form_add() of all lanes. */
static inline __attribute__((always_inline)) void add(
	const struct bender *t, uint32_t way, struct lanes *l)
{
	const range_grid *g = t->of->grid;
	const float *x = g->x_m, *y = g->y_m, *z = g->z_m, *nx = t->normal[0], *ny = t->normal[1],
		    *nz = t->normal[2];
#pragma omp simd
	for (uint32_t n = 0; n < l->count; n++) {
		const int32_t k = l->near[n];
		const float dx = x[k] - l->x[n], dy = y[k] - l->y[n], dz = z[k] - l->z[n];
		const float mx = nx[k], my = ny[k], mz = nz[k];
		const float off = dx * l->nx[n] + dy * l->ny[n] + dz * l->nz[n],
			    cosine = mx * l->nx[n] + my * l->ny[n] + mz * l->nz[n];
		const bool is = l->is_near[n] &
				feature_form_is_same_face(dx * dx + dy * dy + dz * dz, off, cosine);
		float a = dx * l->ux[n] + dy * l->uy[n] + dz * l->uz[n],
		      b = dx * l->vx[n] + dy * l->vy[n] + dz * l->vz[n];
		float p = mx * l->ux[n] + my * l->uy[n] + mz * l->uz[n],
		      q = mx * l->vx[n] + my * l->vy[n] + mz * l->vz[n];
		a = is ? a : 0;
		b = is ? b : 0;
		p = is ? p : 0;
		q = is ? q : 0;
		l->a[n] += a;
		l->b[n] += b;
		l->p[n] += p;
		l->q[n] += q;
		l->aa[n] += a * a;
		l->ab[n] += a * b;
		l->bb[n] += b * b;
		l->ap[n] += a * p;
		l->aq_bp[n] += a * q + b * p;
		l->bq[n] += b * q;
		l->added[n] += is ? 1 : 0;
		l->ways[n] |= is ? 1u << way : 0;
	}
}

static void add_portable(const struct bender *t, uint32_t way, struct lanes *l)
{
	add(t, way, l);
}

#if defined __x86_64__
__attribute__((target("avx2,fma"))) static void add_avx2(
	const struct bender *t, uint32_t way, struct lanes *l)
{
	add(t, way, l);
}
#endif

static void bend(const struct bender *t, struct lanes *l)
{
	void (*add_all)(const struct bender *, uint32_t, struct lanes *) = add_portable;
#if defined __x86_64__
	if (!t->options->portable && __builtin_cpu_supports("avx2") &&
		__builtin_cpu_supports("fma"))
		add_all = add_avx2;
#endif
	for (int half = 2; half >= 1; half--)
		for (uint32_t w = 0; w < WAYS; w++) {
			step(t, ways[w], half, l);
			add_all(t, w, l);
		}
	for (uint32_t n = 0; n < l->count; n++) {
		const struct feature_frame frame = { { l->nx[n], l->ny[n], l->nz[n] },
			{ l->ux[n], l->uy[n], l->uz[n] }, { l->vx[n], l->vy[n], l->vz[n] } };
		const struct feature_form form = { l->a[n], l->b[n], l->p[n], l->q[n], l->aa[n],
			l->ab[n], l->bb[n], l->ap[n], l->aq_bp[n], l->bq[n], l->added[n],
			l->ways[n] };
		feature_form_keep(
			&form, &frame, t->f, (size_t)l->row * t->f->columns + l->column[n]);
	}
	l->count = 0;
}

void feature_curvature(const struct features_input *of, const float *const normal[3],
	const struct features_options *o, features *f)
{
	const range_grid *g = of->grid;
	const struct bender t = { of, normal, o, f };
#pragma omp parallel for schedule(dynamic, 8) if (!o->single_thread)
	for (uint32_t row = 0; row < g->rows; row++) {
		struct lanes l;
		l.count = 0;
		l.row = row;
		for (uint32_t column = 0; column < g->columns; column++) {
			put_cell(&t, column, &l);
			if (l.count == LANES)
				bend(&t, &l);
		}
		bend(&t, &l);
	}
}
