#include "process/mesh-sample.h"
#include "acquire/panorama.h"
#include "process/spacing.h"
#include <math.h>
#include <string.h>

#define COUNT_DEFAULT 500000.0
#define COUNT_MAX     4e9
/* On an area as large as the square of the spacing: so many leave next to no room for one more disc of half the spacing, */
#define DARTS_AN_AREA 14.0
/* and this is how many discs then lie on it, as was measured on spheres and planes. */
#define DISCS_AN_AREA 0.61

struct mesh_sample {
	const mesh *m;
	double *until_m2; /* area of all triangles up to this one */
	uint64_t darts, thrown;
	double spacing_m;
	double point_m2; /* of the surface, for each point */
	spacing *apart;  /* NULL: uniform */
	uint64_t chance;
};

mesh_sample *mesh_sample_new(const mesh *m, const struct mesh_sampling *how)
{
	mesh_sample *s = g_new0(mesh_sample, 1);
	double area = 0, count = how->count ? (double)how->count : COUNT_DEFAULT;
	s->m = m;
	s->chance = 0x853c49e6748fea9bu;
	s->until_m2 = g_new(double, m->triangles);
	for (uint32_t t = 0; t < m->triangles; t++)
		s->until_m2[t] = area += mesh_triangle_area_m2(m, t);
	s->spacing_m = how->spacing_m > 0 ? how->spacing_m : sqrt(DISCS_AN_AREA * area / count);
	if (!how->count && how->spacing_m > 0)
		count = DISCS_AN_AREA * area / (s->spacing_m * s->spacing_m);
	s->point_m2 = how->uniform ? area / count : s->spacing_m * s->spacing_m;
	if (how->uniform)
		s->spacing_m = 0;
	else
		s->apart = spacing_new(s->spacing_m);
	double darts =
		how->uniform ? count
			     : DARTS_AN_AREA * area / (s->spacing_m * s->spacing_m) * DISCS_AN_AREA;
	s->darts = (uint64_t)CLAMP(ceil(darts), 1, COUNT_MAX * DARTS_AN_AREA);
	return s;
}

void mesh_sample_free(mesh_sample *s)
{
	if (!s)
		return;
	spacing_free(s->apart);
	g_free(s->until_m2);
	g_free(s);
}

uint64_t mesh_sample_most(const mesh_sample *s)
{
	return s->darts;
}

double mesh_sample_fraction(const mesh_sample *s)
{
	return (double)s->thrown / (double)s->darts;
}

double mesh_sample_spacing_m(const mesh_sample *s)
{
	return s->spacing_m;
}

/* ---- chance ---- */

/* From 0 to just below 1 (splitmix64). */
static double draw(mesh_sample *s)
{
	uint64_t z = s->chance += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static uint32_t triangle_at(const mesh_sample *s, double area_m2)
{
	uint32_t low = 0, high = s->m->triangles - 1;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (s->until_m2[middle] > area_m2)
			high = middle;
		else
			low = middle + 1;
	}
	return low;
}

/* ---- a point ---- */

struct dart {
	uint32_t triangle;
	double share[3]; /* of each corner */
	double at_m[3];
};

static struct dart throw_dart(mesh_sample *s)
{
	struct dart d = { triangle_at(s, draw(s) * s->until_m2[s->m->triangles - 1]) };
	double root = sqrt(draw(s)), across = draw(s);
	d.share[0] = 1 - root;
	d.share[1] = root * (1 - across);
	d.share[2] = root * across;
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			d.at_m[i] += d.share[k] * s->m->at_m[s->m->corner[d.triangle][k]][i];
	return d;
}

/* Of the triangle, in pictures. */
static double texture_area(const float uv[3][2])
{
	double a[2] = { (double)uv[1][0] - (double)uv[0][0], (double)uv[1][1] - (double)uv[0][1] },
	       b[2] = { (double)uv[2][0] - (double)uv[0][0], (double)uv[2][1] - (double)uv[0][1] };
	return fabs(a[0] * b[1] - a[1] * b[0]) / 2;
}

static void colour_of_texture(const mesh_sample *s, const struct dart *d, uint8_t ret[3])
{
	const mesh *m = s->m;
	const float(*uv)[2] = m->uv[d->triangle];
	double at[2] = { 0 }, area_m2 = mesh_triangle_area_m2(m, d->triangle);
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 2; i++)
			at[i] += d->share[k] * (double)uv[k][i];
	mesh_texture_at(m->textures->pdata[m->texture[d->triangle]], at[0], at[1],
		area_m2 > 0 ? texture_area(uv) * s->point_m2 / area_m2 : 0, ret);
}

static void colour_of_corners(const mesh *m, const struct dart *d, uint8_t ret[3])
{
	for (int i = 0; i < 3; i++) {
		double value = 0;
		for (int k = 0; k < 3; k++)
			value += d->share[k] * m->rgb[d->triangle][k][i];
		ret[i] = (uint8_t)(value + 0.5);
	}
}

static void set_record(const mesh_sample *s, const struct dart *d, struct point_record *r)
{
	const mesh *m = s->m;
	*r = (struct point_record){ .x_m = d->at_m[0],
		.y_m = d->at_m[1],
		.z_m = d->at_m[2],
		.cell = CELL_MEASURED,
		.return_number = 1 };
	if (m->textures && m->texture[d->triangle] >= 0)
		colour_of_texture(s, d, r->rgb);
	else if (m->rgb)
		colour_of_corners(m, d, r->rgb);
}

static void unit(float v[3])
{
	double length = sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
	for (int i = 0; i < 3; i++)
		v[i] = length > 0 ? (float)(v[i] / length) : 0;
}

/* Directions have no sign: those of the corners are turned to the side of the one that weighs most. */
static double side_of(const struct surface_record *a, const struct surface_record *b)
{
	double along = 0;
	for (int i = 0; i < 3; i++)
		along += a->direction[i] * b->direction[i];
	return along < 0 ? -1 : 1;
}

/* Of three corners k1 need not be the same curvature everywhere: where it changes sign, that of the nearest corner counts. */
static void set_surface(const mesh *m, const struct dart *d, struct surface_record *r)
{
	const struct surface_record *corner[3], *nearest;
	int most = d->share[0] >= d->share[1] ? 0 : 1;
	most = d->share[2] > d->share[most] ? 2 : most;
	for (int k = 0; k < 3; k++)
		corner[k] = &m->surface[m->corner[d->triangle][k]];
	nearest = corner[most];
	*r = (struct surface_record){ 0 };
	double k1 = 0, k2 = 0;
	for (int k = 0; k < 3; k++) {
		bool same = corner[k]->k1 * nearest->k1 > 0;
		double side = side_of(nearest, corner[k]), share = d->share[k];
		k1 += share * (same ? corner[k]->k1 : nearest->k1);
		k2 += share * (same ? corner[k]->k2 : nearest->k2);
		for (int i = 0; i < 3; i++) {
			r->normal[i] += (float)(share * corner[k]->normal[i]);
			r->direction[i] += (float)(same ? share * side * corner[k]->direction[i]
							: share * nearest->direction[i]);
		}
	}
	r->k1 = (float)k1;
	r->k2 = (float)k2;
	unit(r->normal);
	unit(r->direction);
}

size_t mesh_sample_next(
	mesh_sample *s, struct point_record *into, struct surface_record *into_surface, size_t max)
{
	size_t count = 0;
	for (; count < max && s->thrown < s->darts; s->thrown++) {
		struct dart d = throw_dart(s);
		if (s->apart && !spacing_take(s->apart, d.at_m))
			continue;
		set_record(s, &d, &into[count]);
		set_surface(s->m, &d, &into_surface[count++]);
	}
	return count;
}
