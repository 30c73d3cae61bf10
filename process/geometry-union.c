#include "process/geometry-private.h"
#include <string.h>

/* The other scan's plane must hold the point so well, in sigma of both, and its window must be about there. */
#define ON_PLANE  3.0f
#define IN_WINDOW 2.0f
/* A window this much wider than the own one (in variance) tells of less detail than is known already. */
#define WIDER        4.0f
#define AGREES_WHOLE 0.94f /* 20 degrees */
#define AGREES_ELSE  0.5f  /* 60: what is known of the cell is poor */

/* Sums over the union of the neighbourhoods, of offsets from the point itself, scanner frame. */
struct geometry_union {
	struct posed_grid of;
	struct normals_options options;
	geometry *result;
	float *count, *sum[3], *square[6];
	float *spread_m2; /* of the scan's own window; 0: it has none that is whole */
	uint32_t *others; /* how many windows of other scans came in */
};

void geometry_union_free(geometry_union *u)
{
	if (!u)
		return;
	geometry_free(u->result);
	g_aligned_free(u->count);
	for (int k = 0; k < 3; k++)
		g_aligned_free(u->sum[k]);
	for (int k = 0; k < 6; k++)
		g_aligned_free(u->square[k]);
	g_aligned_free(u->spread_m2);
	g_free(u->others);
	g_free(u);
}

static bool is_whole(const struct normals_planes *p, size_t i)
{
	return p->count[i] > 0 && p->offset_m[i] > 0;
}

/* From what the neighbours are to sums: in place, the planes are the same. */
static void sum_own(geometry_union *u, const struct normals_planes *p, size_t i)
{
	const range_grid *g = u->of.grid;
	const float point[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
	u->spread_m2[i] = 0;
	if (!is_whole(p, i)) {
		u->count[i] = 0;
		for (int k = 0; k < 3; k++)
			u->sum[k][i] = 0;
		for (int k = 0; k < 6; k++)
			u->square[k][i] = 0;
		return;
	}
	float n = p->count[i], error2 = p->error_m[i] * p->error_m[i], centre[3];
	u->spread_m2[i] = p->covariance_m2[0][i] + p->covariance_m2[3][i] + p->covariance_m2[5][i];
	for (int k = 0; k < 3; k++)
		centre[k] = p->centre_m[k][i] - point[k];
	for (int k = 0, a = 0; a < 3; a++)
		for (int b = a; b < 3; b++, k++)
			u->square[k][i] = n * (p->covariance_m2[k][i] + centre[a] * centre[b] +
						      error2 * p->normal[a][i] * p->normal[b][i]);
	for (int k = 0; k < 3; k++)
		u->sum[k][i] = n * centre[k];
}

geometry_union *geometry_union_new(
	const struct posed_grid *of, const struct geometry_options *options)
{
	geometry_union *u = g_new0(geometry_union, 1);
	const range_grid *g = of->grid;
	size_t cells = range_grid_cells(g);
	u->of = *of;
	u->options = geometry_normals_options(g, options);
	u->options.segment = of->segment;
	u->result = geometry_new(g->columns, g->rows);
	u->count = geometry_plane(cells);
	u->spread_m2 = geometry_plane(cells);
	u->others = g_new0(uint32_t, cells);
	struct normals_planes p = { .normal = { u->result->normal_x, u->result->normal_y,
					    u->result->normal_z },
		.error_m = u->result->plane_error_m,
		.curvature = u->result->curvature,
		.offset_m = geometry_plane(cells),
		.count = u->count };
	for (int k = 0; k < 3; k++)
		p.centre_m[k] = u->sum[k] = geometry_plane(cells);
	for (int k = 0; k < 6; k++)
		p.covariance_m2[k] = u->square[k] = geometry_plane(cells);
	normals_fit(g, &u->options, &p);
#pragma omp parallel for if (!u->options.single_thread)
	for (size_t i = 0; i < cells; i++)
		sum_own(u, &p, i);
	normals_mend(g, &u->options, &p);
	g_aligned_free(p.offset_m);
	return u;
}

/* ---- another scan ---- */

struct other {
	const struct posed_grid *scan;
	struct normals_planes planes;
	struct normals_options options;
	struct pose there, back; /* from the union's frame to the other's, and back */
};

static void other_init(struct other *o, const geometry_union *u, const struct posed_grid *scan)
{
	size_t cells = range_grid_cells(scan->grid);
	struct pose to_site = pose_inverse(&scan->pose);
	const struct geometry_options options = { .radius_m = u->options.radius_m,
		.single_thread = u->options.single_thread };
	*o = (struct other){ .scan = scan,
		.options = geometry_normals_options(scan->grid, &options) };
	o->options.segment = scan->segment;
	o->there = pose_compose(&to_site, &u->of.pose);
	o->back = pose_inverse(&o->there);
	float **planes[] = { &o->planes.error_m, &o->planes.offset_m, &o->planes.count };
	for (size_t k = 0; k < G_N_ELEMENTS(planes); k++)
		*planes[k] = geometry_plane(cells);
	for (int k = 0; k < 3; k++) {
		o->planes.normal[k] = geometry_plane(cells);
		o->planes.centre_m[k] = geometry_plane(cells);
	}
	for (int k = 0; k < 6; k++)
		o->planes.covariance_m2[k] = geometry_plane(cells);
	normals_fit(scan->grid, &o->options, &o->planes);
}

static void other_clear(struct other *o)
{
	g_aligned_free(o->planes.error_m);
	g_aligned_free(o->planes.offset_m);
	g_aligned_free(o->planes.count);
	for (int k = 0; k < 3; k++) {
		g_aligned_free(o->planes.normal[k]);
		g_aligned_free(o->planes.centre_m[k]);
	}
	for (int k = 0; k < 6; k++)
		g_aligned_free(o->planes.covariance_m2[k]);
}

/* Whether the window of the other's cell k is a neighbourhood of cell i, whose point is at point in the other's frame. */
static bool is_neighbourhood(
	const geometry_union *u, const struct other *o, size_t i, const double point[3], uint32_t k)
{
	const struct normals_planes *p = &o->planes;
	const double *eye =
		o->there.translation_m; /* where the union's scanner stands, for the other */
	if (!(o->scan->grid->range_m[k] > 0) || !is_whole(p, k))
		return false;
	double off = p->offset_m[k], before = off, apart2 = 0;
	for (int a = 0; a < 3; a++) {
		double apart = point[a] - p->centre_m[a][k];
		off += p->normal[a][k] * point[a];
		before += p->normal[a][k] * eye[a];
		apart2 += apart * apart;
	}
	if (!(before > 0)) /* it would see the back of that plane */
		return false;
	double noise_m = u->options.range_noise_m * before / u->of.grid->range_m[i],
	       error_m = p->error_m[k];
	float spread_m2 = p->covariance_m2[0][k] + p->covariance_m2[3][k] + p->covariance_m2[5][k];
	return off * off <= ON_PLANE * ON_PLANE * (noise_m * noise_m + error_m * error_m) &&
	       apart2 <= IN_WINDOW * IN_WINDOW * spread_m2 &&
	       (u->spread_m2[i] == 0 || spread_m2 <= WIDER * u->spread_m2[i]);
}

static bool same_leaf(const geometry_union *u, const struct other *o, size_t i, uint32_t k)
{
	uint32_t a = u->of.segment ? u->of.segment[i] : 0,
		 b = o->scan->segment ? o->scan->segment[k] : 0;
	return !a || !b || a == b;
}

static bool normals_agree(const geometry_union *u, size_t i, const double normal[3])
{
	const geometry *g = u->result;
	double x = g->normal_x[i], y = g->normal_y[i], z = g->normal_z[i];
	if (x == 0 && y == 0 && z == 0)
		return true;
	return x * normal[0] + y * normal[1] + z * normal[2] >=
	       (u->spread_m2[i] > 0 ? AGREES_WHOLE : AGREES_ELSE);
}

/* rotation * covariance * rotation^T, xx xy xz yy yz zz. */
static void turn_covariance(
	const double r[3][3], const struct normals_planes *p, uint32_t k, double ret[6])
{
	static const int8_t at[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
	double half[3][3];
	for (int a = 0; a < 3; a++)
		for (int b = 0; b < 3; b++) {
			half[a][b] = 0;
			for (int j = 0; j < 3; j++)
				half[a][b] += r[a][j] * p->covariance_m2[at[j][b]][k];
		}
	for (int a = 0; a < 3; a++)
		for (int b = a; b < 3; b++) {
			ret[at[a][b]] = 0;
			for (int j = 0; j < 3; j++)
				ret[at[a][b]] += half[a][j] * r[b][j];
		}
}

static void add_window(geometry_union *u, const struct other *o, size_t i)
{
	const range_grid *g = u->of.grid;
	const struct normals_planes *p = &o->planes;
	double own[3] = { g->x_m[i], g->y_m[i], g->z_m[i] }, point[3], centre[3], normal[3],
	       covariance[6];
	pose_apply(&o->there, own, point);
	uint32_t k = range_grid_find(o->scan->grid, point[0], point[1], point[2]);
	if (k == RANGE_GRID_NONE || !is_neighbourhood(u, o, i, point, k) || !same_leaf(u, o, i, k))
		return;
	for (int a = 0; a < 3; a++) {
		normal[a] = p->normal[a][k];
		centre[a] = p->centre_m[a][k];
	}
	pose_rotate(&o->back, normal, normal);
	if (!normals_agree(u, i, normal))
		return;
	pose_apply(&o->back, centre, centre);
	turn_covariance((const double(*)[3])o->back.rotation, p, k, covariance);
	double n = p->count[k], error2 = p->error_m[k] * p->error_m[k];
	for (int a = 0; a < 3; a++)
		centre[a] -= own[a];
	for (int j = 0, a = 0; a < 3; a++)
		for (int b = a; b < 3; b++, j++)
			u->square[j][i] += (float)(n * (covariance[j] + centre[a] * centre[b] +
							       error2 * normal[a] * normal[b]));
	for (int a = 0; a < 3; a++)
		u->sum[a][i] += (float)(n * centre[a]);
	u->count[i] += (float)n;
	u->others[i]++;
}

void geometry_union_add(geometry_union *u, const struct posed_grid *scan)
{
	struct other o;
	other_init(&o, u, scan);
	size_t cells = range_grid_cells(u->of.grid);
#pragma omp parallel for schedule(dynamic, 4096) if (!u->options.single_thread)
	for (size_t i = 0; i < cells; i++)
		if (u->of.grid->range_m[i] > 0)
			add_window(u, &o, i);
	other_clear(&o);
}

/* ---- the joint plane ---- */

static double largest_cross(const double m[3][3], double ret[3])
{
	double best = 0;
	for (int a = 0; a < 3; a++) {
		const double *p = m[a], *q = m[(a + 1) % 3];
		double c[3] = { p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
			p[0] * q[1] - p[1] * q[0] };
		double length2 = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
		if (length2 > best) {
			best = length2;
			memcpy(ret, c, sizeof c);
		}
	}
	return best;
}

/* Smallest eigenvalue and its unit eigenvector of a symmetric matrix, xx xy xz yy yz zz: by the roots of its cubic; rows of
 * (matrix - eigenvalue) span what is perpendicular. false: there is no one direction. */
static bool smallest_direction(const double c[6], double *ret_value, double ret[3])
{
	double mean = (c[0] + c[3] + c[5]) / 3, off = c[1] * c[1] + c[2] * c[2] + c[4] * c[4];
	double x = c[0] - mean, y = c[3] - mean, z = c[5] - mean;
	double scale = sqrt((x * x + y * y + z * z + 2 * off) / 6);
	if (!(scale > 0))
		return false;
	double det = x * (y * z - c[4] * c[4]) - c[1] * (c[1] * z - c[4] * c[2]) +
		     c[2] * (c[1] * c[4] - y * c[2]);
	double angle = acos(CLAMP(det / (2 * scale * scale * scale), -1, 1)) / 3;
	double value = mean + 2 * scale * cos(angle + 2 * G_PI / 3);
	const double m[3][3] = { { c[0] - value, c[1], c[2] }, { c[1], c[3] - value, c[4] },
		{ c[2], c[4], c[5] - value } };
	double length2 = largest_cross(m, ret);
	if (!(length2 > 1e-18 * scale * scale * scale * scale))
		return false;
	for (int k = 0; k < 3; k++)
		ret[k] /= sqrt(length2);
	*ret_value = fmax(value, 0);
	return true;
}

static void join(geometry_union *u, size_t i)
{
	const range_grid *g = u->of.grid;
	geometry *r = u->result;
	double n = u->count[i], mean[3], c[6], value, normal[3] = { 0 };
	for (int k = 0; k < 3; k++)
		mean[k] = u->sum[k][i] / n;
	for (int k = 0, a = 0; a < 3; a++)
		for (int b = a; b < 3; b++, k++)
			c[k] = u->square[k][i] / n - mean[a] * mean[b];
	if (!smallest_direction(c, &value, normal))
		return;
	double away =
		normal[0] * g->x_m[i] + normal[1] * g->y_m[i] + normal[2] * g->z_m[i] > 0 ? -1 : 1;
	r->normal_x[i] = (float)(away * normal[0]);
	r->normal_y[i] = (float)(away * normal[1]);
	r->normal_z[i] = (float)(away * normal[2]);
	if (u->spread_m2[i] > 0 ||
		isnan(r->plane_error_m[i])) { /* at a crease the own error tells of it */
		r->plane_error_m[i] = (float)sqrt(value);
		r->curvature[i] = (float)(value / (c[0] + c[3] + c[5]));
	}
}

geometry *geometry_union_finish(geometry_union *u)
{
	size_t cells = range_grid_cells(u->of.grid);
#pragma omp parallel for schedule(dynamic, 4096) if (!u->options.single_thread)
	for (size_t i = 0; i < cells; i++)
		if (u->others[i])
			join(u, i);
	return g_steal_pointer(&u->result);
}

geometry *geometry_estimate_union(const struct posed_grid *scans, size_t count, size_t which,
	const struct geometry_options *options,
	bool (*progress)(double fraction, gpointer user_data), gpointer user_data)
{
	g_autoptr(geometry_union) u = geometry_union_new(&scans[which], options);
	for (size_t i = 0; i < count; i++) {
		if (progress && !progress((double)i / (double)count, user_data))
			return NULL;
		if (i != which)
			geometry_union_add(u, &scans[i]);
	}
	return geometry_union_finish(u);
}
