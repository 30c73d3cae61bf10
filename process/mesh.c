#include "process/mesh.h"
#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double ret[3])
{
	ret[0] = a[1] * b[2] - a[2] * b[1];
	ret[1] = a[2] * b[0] - a[0] * b[2];
	ret[2] = a[0] * b[1] - a[1] * b[0];
}

static double length_of(const double v[3])
{
	return sqrt(dot(v, v));
}

mesh *mesh_new(uint32_t vertices, uint32_t triangles, bool has_colour)
{
	mesh *m = g_new0(mesh, 1);
	m->vertices = vertices;
	m->triangles = triangles;
	m->at_m = g_malloc0_n(MAX(vertices, 1), sizeof *m->at_m);
	m->corner = g_malloc0_n(MAX(triangles, 1), sizeof *m->corner);
	m->rgb = has_colour ? g_malloc0_n(MAX(triangles, 1), sizeof *m->rgb) : NULL;
	return m;
}

void mesh_add_textures(mesh *m, GPtrArray *textures)
{
	m->textures = textures;
	m->texture = g_new(int16_t, MAX(m->triangles, 1));
	m->uv = g_malloc0_n(MAX(m->triangles, 1), sizeof *m->uv);
	for (uint32_t t = 0; t < m->triangles; t++)
		m->texture[t] = -1;
}

void mesh_free(mesh *m)
{
	if (!m)
		return;
	g_free(m->at_m);
	g_free(m->corner);
	g_free(m->rgb);
	g_free(m->surface);
	g_clear_pointer(&m->textures, g_ptr_array_unref);
	g_free(m->texture);
	g_free(m->uv);
	g_free(m);
}

/* ---- welding ---- */

static guint place_hash(gconstpointer key)
{
	const uint64_t *bits = key;
	uint64_t h = bits[0] * 0x9e3779b97f4a7c15u ^ bits[1] * 0xbf58476d1ce4e5b9u ^
		     bits[2] * 0x94d049bb133111ebu;
	return (guint)(h ^ h >> 32);
}

static gboolean place_equal(gconstpointer a, gconstpointer b)
{
	return memcmp(a, b, 3 * sizeof(double)) == 0;
}

void mesh_weld(mesh *m)
{
	g_autoptr(GHashTable) known = g_hash_table_new(place_hash, place_equal);
	g_autofree uint32_t *becomes = g_new(uint32_t, MAX(m->vertices, 1));
	uint32_t kept = 0;
	for (uint32_t i = 0; i < m->vertices; i++) {
		gpointer found;
		for (int k = 0; k < 3; k++)
			m->at_m[i][k] += 0.0; /* of two zeros one */
		if (g_hash_table_lookup_extended(known, m->at_m[i], NULL, &found)) {
			becomes[i] = GPOINTER_TO_UINT(found);
			continue;
		}
		memmove(m->at_m[kept], m->at_m[i], sizeof m->at_m[i]);
		g_hash_table_insert(known, m->at_m[kept], GUINT_TO_POINTER(kept));
		becomes[i] = kept++;
	}
	m->vertices = kept;
	for (uint32_t t = 0; t < m->triangles; t++)
		for (int k = 0; k < 3; k++)
			m->corner[t][k] = becomes[m->corner[t][k]];
}

/* ---- polygons ---- */

/* By the sum over its edges (Newell). */
static void polygon_normal(const mesh *m, const uint32_t *vertices, uint32_t count, double ret[3])
{
	memset(ret, 0, 3 * sizeof *ret);
	for (uint32_t i = 0; i < count; i++) {
		const double *a = m->at_m[vertices[i]], *b = m->at_m[vertices[(i + 1) % count]];
		for (int k = 0; k < 3; k++)
			ret[k] += (a[(k + 1) % 3] - b[(k + 1) % 3]) *
				  (a[(k + 2) % 3] + b[(k + 2) % 3]);
	}
}

/* Twice the area of a triangle, seen against n; below 0: it turns the other way. */
static double turn_of(const double a[3], const double b[3], const double c[3], const double n[3])
{
	double ab[3], ac[3], across[3];
	for (int k = 0; k < 3; k++) {
		ab[k] = b[k] - a[k];
		ac[k] = c[k] - a[k];
	}
	cross(ab, ac, across);
	return dot(across, n);
}

/* Whether the corner at i of those that are left can be cut off: it is no inward one, and none of the others lies in it. */
static bool is_ear(const mesh *m, const uint32_t *vertices, const uint32_t *left, uint32_t count,
	uint32_t i, const double n[3])
{
	uint32_t before = (i + count - 1) % count, behind = (i + 1) % count;
	const double *a = m->at_m[vertices[left[before]]], *b = m->at_m[vertices[left[i]]],
		     *c = m->at_m[vertices[left[behind]]];
	if (!(turn_of(a, b, c, n) > 0))
		return false;
	for (uint32_t k = 0; k < count; k++) {
		const double *p = m->at_m[vertices[left[k]]];
		if (k != before && k != i && k != behind && turn_of(a, b, p, n) > 0 &&
			turn_of(b, c, p, n) > 0 && turn_of(c, a, p, n) > 0)
			return false;
	}
	return true;
}

void mesh_cut_polygon(const mesh *m, const uint32_t *vertices, uint32_t count, uint32_t *ret)
{
	g_autofree uint32_t *left = g_new(uint32_t, count);
	double n[3];
	polygon_normal(m, vertices, count, n);
	for (uint32_t i = 0; i < count; i++)
		left[i] = i;
	for (; count >= 3; count--, ret += 3) {
		uint32_t ear = 0;
		/* Where there is none, the polygon crosses itself or has no area: any will do. */
		while (count > 3 && ear < count && !is_ear(m, vertices, left, count, ear, n))
			ear++;
		ear = ear == count ? 0 : ear;
		ret[0] = left[(ear + count - 1) % count];
		ret[1] = left[ear];
		ret[2] = left[(ear + 1) % count];
		memmove(left + ear, left + ear + 1, (count - ear - 1) * sizeof *left);
	}
}

/* ---- triangles ---- */

static void edge_of(const mesh *m, uint32_t triangle, int k, double ret[3])
{
	const uint32_t *c = m->corner[triangle];
	for (int i = 0; i < 3; i++)
		ret[i] = m->at_m[c[(k + 2) % 3]][i] - m->at_m[c[(k + 1) % 3]][i];
}

static double triangle_cross(const mesh *m, uint32_t t, double ret[3])
{
	double a[3], b[3];
	edge_of(m, t, 0, a);
	edge_of(m, t, 1, b);
	cross(a, b, ret);
	return length_of(ret);
}

double mesh_triangle_area_m2(const mesh *m, uint32_t triangle)
{
	double unused[3];
	return triangle_cross(m, triangle, unused) / 2;
}

static bool normalise(double v[3])
{
	double length = length_of(v);
	if (!(length > 0))
		return false;
	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return true;
}

/* At corner k, between the edges that meet there. */
static double corner_angle(const mesh *m, uint32_t t, int k)
{
	double a[3], b[3], across[3];
	edge_of(m, t, (k + 2) % 3, a); /* from k to k+1 */
	edge_of(m, t, (k + 1) % 3, b); /* from k+2 to k */
	for (int i = 0; i < 3; i++)
		b[i] = -b[i];
	cross(a, b, across);
	return atan2(length_of(across), dot(a, b));
}

/* ---- normals ---- */

/* normal: three numbers a vertex. */
static void add_normals(const mesh *m, double *normal)
{
	for (uint32_t t = 0; t < m->triangles; t++) {
		double n[3];
		triangle_cross(m, t, n);
		if (!normalise(n))
			continue;
		for (int k = 0; k < 3; k++) {
			double angle = corner_angle(m, t, k);
			for (int i = 0; i < 3; i++)
				normal[3 * (size_t)m->corner[t][k] + i] += angle * n[i];
		}
	}
	for (uint32_t v = 0; v < m->vertices; v++)
		normalise(normal + 3 * (size_t)v);
}

/* ---- curvature ---- */

/* Two directions across a normal. */
struct frame {
	double u[3], v[3];
};

static struct frame frame_across(const double n[3])
{
	struct frame f;
	double least[3] = { 0, 0, 0 };
	int axis = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
	axis = fabs(n[2]) < fabs(n[axis]) ? 2 : axis;
	least[axis] = 1;
	cross(n, least, f.u);
	normalise(f.u);
	cross(n, f.u, f.v);
	return f;
}

/* How the normal changes along u and v: symmetric, three numbers. */
struct tensor {
	double uu, uv, vv;
};

/* Turns the frame about the axis that takes its own normal to n. */
static void turn_to(struct frame *f, const double own[3], const double n[3])
{
	double axis[3], *v[2] = { f->u, f->v };
	cross(own, n, axis);
	double cosine = CLAMP(dot(own, n), -1, 1), sine = length_of(axis);
	if (!normalise(axis))
		return;
	for (int k = 0; k < 2; k++) {
		double across[3], along = dot(axis, v[k]);
		cross(axis, v[k], across);
		for (int i = 0; i < 3; i++)
			v[k][i] = v[k][i] * cosine + across[i] * sine +
				  axis[i] * along * (1 - cosine);
	}
}

/* The same tensor in another frame of the same plane. */
static struct tensor seen_in(
	const struct tensor *t, const struct frame *from, const struct frame *to)
{
	double a = dot(to->u, from->u), b = dot(to->u, from->v), c = dot(to->v, from->u),
	       d = dot(to->v, from->v);
	return (struct tensor){ a * a * t->uu + 2 * a * b * t->uv + b * b * t->vv,
		a * c * t->uu + (a * d + b * c) * t->uv + b * d * t->vv,
		c * c * t->uu + 2 * c * d * t->uv + d * d * t->vv };
}

/* Normal equations of six equations for uu, uv, vv: along each edge the change of the normal. */
struct equations {
	double a[3][3], b[3];
};

static void add_equation(struct equations *e, const double row[3], double right)
{
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++)
			e->a[i][k] += row[i] * row[k];
		e->b[i] += row[i] * right;
	}
}

static bool solve(struct equations *e, double ret[3])
{
	for (int i = 0; i < 3; i++) {
		int best = i;
		for (int k = i + 1; k < 3; k++)
			best = fabs(e->a[k][i]) > fabs(e->a[best][i]) ? k : best;
		if (!(fabs(e->a[best][i]) > 1e-300))
			return false;
		for (int k = 0; k < 3; k++) {
			double swap = e->a[i][k];
			e->a[i][k] = e->a[best][k];
			e->a[best][k] = swap;
		}
		double swap = e->b[i];
		e->b[i] = e->b[best];
		e->b[best] = swap;
		for (int k = i + 1; k < 3; k++) {
			double f = e->a[k][i] / e->a[i][i];
			for (int j = i; j < 3; j++)
				e->a[k][j] -= f * e->a[i][j];
			e->b[k] -= f * e->b[i];
		}
	}
	for (int i = 3; i-- > 0;) {
		ret[i] = e->b[i];
		for (int k = i + 1; k < 3; k++)
			ret[i] -= e->a[i][k] * ret[k];
		ret[i] /= e->a[i][i];
	}
	return true;
}

static bool tensor_of(
	const mesh *m, uint32_t t, const double *normal, const struct frame *f, struct tensor *ret)
{
	struct equations e = { 0 };
	double found[3];
	for (int k = 0; k < 3; k++) {
		double edge[3], change[3];
		const double *from = normal + 3 * (size_t)m->corner[t][(k + 1) % 3],
			     *to = normal + 3 * (size_t)m->corner[t][(k + 2) % 3];
		edge_of(m, t, k, edge);
		for (int i = 0; i < 3; i++)
			change[i] = to[i] - from[i];
		double u = dot(edge, f->u), v = dot(edge, f->v);
		add_equation(&e, (double[3]){ u, v, 0 }, dot(change, f->u));
		add_equation(&e, (double[3]){ 0, u, v }, dot(change, f->v));
	}
	if (!solve(&e, found))
		return false;
	*ret = (struct tensor){ found[0], found[1], found[2] };
	return true;
}

static void set_curvature(struct surface_record *r, const struct tensor *t, const struct frame *f)
{
	double middle = (t->uu + t->vv) / 2, half = (t->uu - t->vv) / 2,
	       radius = sqrt(half * half + t->uv * t->uv),
	       angle = atan2(t->uv, half) / 2; /* of the larger one */
	bool larger_first = middle >= 0;
	r->k1 = (float)(larger_first ? middle + radius : middle - radius);
	r->k2 = (float)(larger_first ? middle - radius : middle + radius);
	angle += larger_first ? 0 : G_PI / 2;
	for (int i = 0; i < 3; i++)
		r->direction[i] = (float)(cos(angle) * f->u[i] + sin(angle) * f->v[i]);
}

static void add_tensors(const mesh *m, const double *normal, struct tensor *tensor, double *weight)
{
	for (uint32_t t = 0; t < m->triangles; t++) {
		double n[3], area = triangle_cross(m, t, n) / 2;
		struct tensor own;
		if (!normalise(n))
			continue;
		struct frame f = frame_across(n);
		if (!tensor_of(m, t, normal, &f, &own))
			continue;
		for (int k = 0; k < 3; k++) {
			uint32_t v = m->corner[t][k];
			struct frame turned = f, there = frame_across(normal + 3 * (size_t)v);
			turn_to(&turned, n, normal + 3 * (size_t)v);
			struct tensor seen = seen_in(&own, &turned, &there);
			tensor[v].uu += area * seen.uu;
			tensor[v].uv += area * seen.uv;
			tensor[v].vv += area * seen.vv;
			weight[v] += area;
		}
	}
}

void mesh_curve(mesh *m)
{
	g_autofree double *normal = g_new0(double, 3 * (size_t)MAX(m->vertices, 1));
	g_autofree struct tensor *tensor = g_new0(struct tensor, MAX(m->vertices, 1));
	g_autofree double *weight = g_new0(double, MAX(m->vertices, 1));
	g_free(m->surface);
	m->surface = g_new0(struct surface_record, MAX(m->vertices, 1));
	add_normals(m, normal);
	add_tensors(m, normal, tensor, weight);
	for (uint32_t v = 0; v < m->vertices; v++) {
		struct surface_record *r = &m->surface[v];
		r->k1 = r->k2 = NAN;
		if (!(weight[v] > 0))
			continue;
		for (int i = 0; i < 3; i++)
			r->normal[i] = (float)normal[3 * (size_t)v + i];
		struct tensor mean = { tensor[v].uu / weight[v], tensor[v].uv / weight[v],
			tensor[v].vv / weight[v] };
		struct frame f = frame_across(normal + 3 * (size_t)v);
		set_curvature(r, &mean, &f);
	}
}
