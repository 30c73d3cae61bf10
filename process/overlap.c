#include "process/overlap.h"
#include "process/model.h"
#include <string.h>

#define RANGE_NOISE_M   0.012
#define COSINE_MIN      0.1 /* beyond 84 degrees noise of the normal is all there is */
#define COSINE_DEFAULT  0.7
#define NORMALS_DOT_MIN 0.5
#define ROUGH_NOISE     3.0 /* a plane error above this many times the noise is no plane */

void overlap_scan_free(overlap_scan *s)
{
	if (!s)
		return;
	g_free(s->point);
	g_free(s->lattice.cell);
	g_free(s);
}

uint64_t overlap_scan_bytes(const overlap_scan *s)
{
	uint64_t cells = (uint64_t)s->columns * s->rows;
	uint64_t lattice = (uint64_t)s->lattice.columns * s->lattice.rows;
	return cells * sizeof *s->point + (s->lattice.cell ? lattice * sizeof *s->lattice.cell : 0);
}

/* A cell without a point tells in its place what it is. */
static bool has_point(const struct overlap_point *p)
{
	return p->position_m[0] != 0 || p->position_m[1] != 0 || p->position_m[2] != 0;
}

static void take_normal(struct overlap_point *p, const scan_geometry *geometry, size_t cell)
{
	p->normal[0] = p->normal[1] = MODEL_NORMAL_NONE;
	if (!geometry || !(geometry->plane_error_m[cell] < ROUGH_NOISE * RANGE_NOISE_M))
		return;
	memcpy(p->normal, geometry->normal[cell], sizeof p->normal);
}

overlap_scan *overlap_scan_new(uint32_t number, const range_grid *g, const scan_geometry *geometry)
{
	overlap_scan *s = g_new0(overlap_scan, 1);
	size_t cells = range_grid_cells(g);
	g_assert(!geometry || geometry->count == cells);
	s->number = number;
	s->columns = g->columns;
	s->rows = g->rows;
	s->pose = POSE_IDENTITY;
	s->beam_sr = g->column_rad * g->row_rad;
	s->point = g_new(struct overlap_point, cells);
	for (size_t i = 0; i < cells; i++) {
		s->point[i] = (struct overlap_point){ { g->x_m[i], g->y_m[i], g->z_m[i] } };
		if (has_point(&s->point[i]))
			take_normal(&s->point[i], geometry, i);
		else
			s->point[i].normal[0] = g->cell[i];
		s->reach_m = fmax(s->reach_m, g->range_m[i]);
	}
	s->lattice = g->lattice;
	if (g->lattice.cell)
		s->lattice.cell = g_memdup2(g->lattice.cell,
			(size_t)g->lattice.columns * g->lattice.rows * sizeof *g->lattice.cell);
	return s;
}

/* A point in the site's frame. */
struct seen {
	double at[3], normal[3];
	bool has_normal;
};

static void look_at(const overlap_scan *s, size_t cell, struct seen *ret)
{
	const struct overlap_point *p = &s->point[cell];
	float n[3];
	model_unpack_normal(p->normal, n);
	ret->has_normal = n[0] != 0 || n[1] != 0 || n[2] != 0;
	pose_apply(&s->pose,
		(const double[3]){ p->position_m[0], p->position_m[1], p->position_m[2] }, ret->at);
	pose_rotate(&s->pose, (const double[3]){ n[0], n[1], n[2] }, ret->normal);
}

/* The cell of s that looks towards a place in the site. */
static uint32_t find(const overlap_scan *s, const double at[3])
{
	const double *t = s->pose.translation_m;
	const double(*r)[3] = s->pose.rotation;
	double d[3] = { at[0] - t[0], at[1] - t[1], at[2] - t[2] };
	int64_t cell =
		range_lattice_find(&s->lattice, r[0][0] * d[0] + r[1][0] * d[1] + r[2][0] * d[2],
			r[0][1] * d[0] + r[1][1] * d[1] + r[2][1] * d[2],
			r[0][2] * d[0] + r[1][2] * d[1] + r[2][2] * d[2]);
	return cell < 0          ? RANGE_GRID_NONE
	       : s->lattice.cell ? s->lattice.cell[cell]
				 : (uint32_t)cell;
}

static double squared_distance(const double a[3], const double b[3])
{
	double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	return x * x + y * y + z * z;
}

/* The normal that both are judged by; false: there is none. */
static bool common_normal(const struct seen *p, const struct seen *q, double ret[3])
{
	if (!p->has_normal && !q->has_normal)
		return false;
	double length = 0;
	for (int i = 0; i < 3; i++) {
		ret[i] = (p->has_normal ? p->normal[i] : 0) + (q->has_normal ? q->normal[i] : 0);
		length += ret[i] * ret[i];
	}
	length = sqrt(length);
	for (int i = 0; i < 3; i++)
		ret[i] /= length;
	return true;
}

/* Area of the surface that a beam of s covers, m2. Of equals the lower number is the better. */
static double patch_m2(const overlap_scan *s, const double at[3], const double normal[3])
{
	double range2 = squared_distance(at, s->pose.translation_m), cosine = COSINE_DEFAULT;
	if (normal) {
		double d = 0;
		for (int i = 0; i < 3; i++)
			d += normal[i] * (s->pose.translation_m[i] - at[i]);
		cosine = fmax(d / sqrt(range2), COSINE_MIN);
	}
	return range2 * s->beam_sr / cosine * (1 + 1e-9 * s->number);
}

static bool is_same_surface(const struct seen *p, const struct seen *q, const double *normal,
	double patch, double noise_m)
{
	double off = 3 * G_SQRT2 * noise_m + 0.5 * sqrt(patch);
	double distance2 = squared_distance(p->at, q->at);
	double reach = off + 2 * sqrt(patch);
	if (distance2 > reach * reach)
		return false;
	if (!normal)
		return true;
	double along = 0, dot = 0;
	for (int i = 0; i < 3; i++) {
		along += normal[i] * (p->at[i] - q->at[i]);
		dot += p->normal[i] * q->normal[i];
	}
	return fabs(along) <= off && (!p->has_normal || !q->has_normal || dot > NORMALS_DOT_MIN);
}

/* The point of the eight cells around one that lies nearest to a place. */
static bool look_around(const overlap_scan *s, uint32_t cell, const double at[3], struct seen *ret)
{
	int64_t row = cell / s->columns, column = cell % s->columns;
	double nearest = INFINITY;
	for (int64_t r = MAX(row - 1, 0); r <= MIN(row + 1, s->rows - 1); r++)
		for (int64_t k = column - 1; k <= column + 1; k++) {
			int64_t c = s->lattice.wraps ? (k + s->columns) % s->columns : k;
			size_t i = (size_t)(r * s->columns + c);
			if (c < 0 || c >= s->columns || !has_point(&s->point[i]))
				continue;
			struct seen other;
			look_at(s, i, &other);
			double distance = squared_distance(other.at, at);
			if (distance < nearest)
				*ret = other;
			nearest = fmin(nearest, distance);
		}
	return nearest < INFINITY;
}

/* What s measured where that place is. No beam goes to a cell when beams are sparser than cells, or when a few were lost; then
 * those around it tell. */
static bool look_towards(const overlap_scan *s, const double at[3], struct seen *ret)
{
	uint32_t cell = find(s, at);
	if (cell == RANGE_GRID_NONE)
		return false;
	const struct overlap_point *p = &s->point[cell];
	if (has_point(p))
		return look_at(s, cell, ret), true;
	return p->normal[0] != CELL_NO_RETURN && look_around(s, cell, at, ret);
}

enum verdict_of_pair { NO_PARTNER, PARTNER_IS_WORSE, PARTNER_IS_BETTER };

/* Point p of a against what b measured there. */
static enum verdict_of_pair compare(const overlap_scan *a, const overlap_scan *b,
	const struct seen *p, double noise_m, struct seen *ret_partner)
{
	struct seen *q = ret_partner;
	if (!look_towards(b, p->at, q))
		return NO_PARTNER;
	double middle[3], normal[3];
	for (int i = 0; i < 3; i++)
		middle[i] = 0.5 * (p->at[i] + q->at[i]);
	const double *n = common_normal(p, q, normal) ? normal : NULL;
	double of_a = patch_m2(a, middle, n), of_b = patch_m2(b, middle, n);
	if (!is_same_surface(p, q, n, fmax(of_a, of_b), noise_m))
		return NO_PARTNER;
	return of_b < of_a ? PARTNER_IS_BETTER : PARTNER_IS_WORSE;
}

/* Whether b could have anything better at p at all: spares most look-ups. The normals of partners differ a little, hence the
 * factor. */
static bool is_worth_looking(const overlap_scan *a, const overlap_scan *b, const struct seen *p)
{
	double least = squared_distance(p->at, b->pose.translation_m) * b->beam_sr;
	double own = patch_m2(a, p->at, p->has_normal ? p->normal : NULL);
	return p->has_normal ? least < 1.5 * own : least * COSINE_MIN < own;
}

static bool is_better_in(const overlap_scan *a, const overlap_scan *b, size_t cell, double noise_m)
{
	struct seen p, q, again;
	if (!has_point(&a->point[cell]))
		return false;
	look_at(a, cell, &p);
	return is_worth_looking(a, b, &p) && compare(a, b, &p, noise_m, &q) == PARTNER_IS_BETTER &&
	       compare(b, a, &q, noise_m, &again) != PARTNER_IS_BETTER;
}

void overlap_mark(const overlap_scan *a, const overlap_scan *b,
	const struct overlap_options *options, uint8_t *dropped)
{
	const double noise_m =
		options && options->range_noise_m > 0 ? options->range_noise_m : RANGE_NOISE_M;
#pragma omp parallel for schedule(dynamic, 8)
	for (uint32_t row = 0; row < a->rows; row++)
		for (size_t i = (size_t)row * a->columns, end = i + a->columns; i < end; i++)
			if (!dropped[i] && is_better_in(a, b, i, noise_m))
				dropped[i] = 1;
}

bool overlap_is_possible(const overlap_scan *a, const overlap_scan *b)
{
	double reach = a->reach_m + b->reach_m;
	return squared_distance(a->pose.translation_m, b->pose.translation_m) <= reach * reach;
}
