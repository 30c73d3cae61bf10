#include "sim/geometry.h"

void frame_around(vec axis, vec *ret_u, vec *ret_v)
{
	vec help = fabsf(axis[2]) < 0.9f ? (vec){ 0, 0, 1 } : (vec){ 1, 0, 0 };
	*ret_u = unit(cross(help, axis));
	*ret_v = cross(axis, *ret_u);
}

void mesh_init(struct mesh *m)
{
	m->points = g_array_new(FALSE, FALSE, sizeof(vec));
	m->normals = g_array_new(FALSE, FALSE, sizeof(vec));
	m->indices = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	m->faces = g_array_new(FALSE, FALSE, sizeof(struct face));
}

void mesh_clear(struct mesh *m)
{
	if (!m->points)
		return;
	g_array_free(m->points, TRUE);
	g_array_free(m->normals, TRUE);
	g_array_free(m->indices, TRUE);
	g_array_free(m->faces, TRUE);
	m->points = NULL;
}

void mesh_finish(struct mesh *m)
{
	for (guint i = 0; i < m->normals->len; i++) {
		vec *n = &g_array_index(m->normals, vec, i);
		*n = unit(*n);
	}
}

static uint32_t add_point(struct mesh *m, vec world)
{
	vec none = { 0 };
	g_array_append_val(m->points, world);
	g_array_append_val(m->normals, none);
	return m->points->len - 1;
}

/* Faces of no area are left out: they have no normal. */
static void add_face(const struct pen *p, struct mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
	vec pa = g_array_index(m->points, vec, a), pb = g_array_index(m->points, vec, b);
	vec pc = g_array_index(m->points, vec, c), normal = cross(pb - pa, pc - pa);
	if (length(normal) < 1e-9f)
		return;
	g_array_append_val(m->indices, a);
	g_array_append_val(m->indices, b);
	g_array_append_val(m->indices, c);
	g_array_append_val(m->faces, ((struct face){ p->material, p->object }));
	g_array_index(m->normals, vec, a) += normal;
	g_array_index(m->normals, vec, b) += normal;
	g_array_index(m->normals, vec, c) += normal;
}

static struct mesh *mesh_of(const struct pen *p)
{
	return p->glass && p->clear && p->clear[p->material] ? p->glass : p->mesh;
}

struct pen pen_at(const struct pen *p, float x, float y, float z)
{
	struct pen q = *p;
	q.at.o = frame_point(&p->at, (vec){ x, y, z });
	return q;
}

struct pen pen_turned(const struct pen *p, float x, float y, float z, float clockwise_rad)
{
	struct pen q = pen_at(p, x, y, z);
	float c = cosf(clockwise_rad), s = sinf(clockwise_rad);
	q.at.x = frame_turn(&p->at, (vec){ c, -s, 0 });
	q.at.y = frame_turn(&p->at, (vec){ s, c, 0 });
	return q;
}

struct pen pen_scaled(const struct pen *p, float scale)
{
	struct pen q = *p;
	q.at.x *= scale;
	q.at.y *= scale;
	q.at.z *= scale;
	return q;
}

struct pen pen_with(const struct pen *p, uint16_t material)
{
	struct pen q = *p;
	q.material = material;
	return q;
}

void pen_triangle(const struct pen *p, vec a, vec b, vec c)
{
	struct mesh *m = mesh_of(p);
	uint32_t i = add_point(m, frame_point(&p->at, a));
	add_point(m, frame_point(&p->at, b));
	add_point(m, frame_point(&p->at, c));
	add_face(p, m, i, i + 1, i + 2);
}

void pen_shaded(const struct pen *p, const vec corners[3], const vec normals[3])
{
	struct mesh *m = mesh_of(p);
	uint32_t i = m->points->len;
	pen_triangle(p, corners[0], corners[1], corners[2]);
	for (uint32_t k = 0; k < 3; k++)
		g_array_index(m->normals, vec, i + k) = frame_turn(&p->at, normals[k]);
}

void pen_quad(const struct pen *p, vec a, vec b, vec c, vec d)
{
	struct mesh *m = mesh_of(p);
	uint32_t i = add_point(m, frame_point(&p->at, a));
	add_point(m, frame_point(&p->at, b));
	add_point(m, frame_point(&p->at, c));
	add_point(m, frame_point(&p->at, d));
	add_face(p, m, i, i + 1, i + 2);
	add_face(p, m, i, i + 2, i + 3);
}

void pen_box(const struct pen *p, vec low, vec high)
{
	vec c[8];
	for (unsigned i = 0; i < 8; i++)
		c[i] = (vec){ i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1],
			i & 4 ? high[2] : low[2] };
	pen_quad(p, c[0], c[1], c[3], c[2]);
	pen_quad(p, c[4], c[5], c[7], c[6]);
	pen_quad(p, c[0], c[1], c[5], c[4]);
	pen_quad(p, c[2], c[3], c[7], c[6]);
	pen_quad(p, c[0], c[2], c[6], c[4]);
	pen_quad(p, c[1], c[3], c[7], c[5]);
}

void pen_prism(const struct pen *p, const vec *outline, unsigned n, float y0, float y1)
{
	vec near = { 0, y0, 0 }, far = { 0, y1, 0 };
	for (unsigned i = 0; i < n; i++) {
		vec a = outline[i], b = outline[(i + 1) % n];
		pen_quad(p, a + near, b + near, b + far, a + far);
		if (i >= 2) {
			pen_triangle(p, outline[0] + near, outline[i - 1] + near, a + near);
			pen_triangle(p, outline[0] + far, outline[i - 1] + far, a + far);
		}
	}
}

void pen_skin(const struct pen *p, const vec *points, unsigned rows, unsigned columns)
{
	struct mesh *m = mesh_of(p);
	uint32_t base = m->points->len;
	for (unsigned i = 0; i < rows * columns; i++)
		add_point(m, frame_point(&p->at, points[i]));
	for (unsigned r = 0; r + 1 < rows; r++)
		for (unsigned c = 0; c + 1 < columns; c++) {
			uint32_t i = base + r * columns + c;
			add_face(p, m, i, i + 1, i + columns + 1);
			add_face(p, m, i, i + columns + 1, i + columns);
		}
}

void pen_leaf(const struct pen *p, vec stalk, vec along, vec across, vec lean)
{
	struct mesh *m = mesh_of(p);
	vec normal = unit(cross(along, across)), fold = normal * (0.12f * length(along));
	uint32_t i = add_point(m, frame_point(&p->at, stalk));
	add_point(m, frame_point(&p->at, stalk + along * 0.45f + across + fold));
	add_point(m, frame_point(&p->at, stalk + along));
	add_point(m, frame_point(&p->at, stalk + along * 0.45f - across + fold));
	add_face(p, m, i, i + 1, i + 2);
	add_face(p, m, i, i + 2, i + 3);
	vec world = frame_turn(&p->at, normal * (dot(normal, lean) < 0 ? -0.6f : 0.6f) + lean);
	for (uint32_t k = 0; k < 4; k++)
		g_array_index(m->normals, vec, i + k) = world;
}

/* Every ring starts and ends at the same place with the same radius, so the last column repeats the
 * first; its shading normal is off by half a segment there, which is not seen at the numbers of
 * segments used. */
static vec ring_point(vec centre, vec u, vec v, float radius, unsigned i, unsigned segments)
{
	float a = 2 * G_PI * (i % segments) / segments;
	return centre + u * (radius * cosf(a)) + v * (radius * sinf(a));
}

static bool profile_turns(const float (*f)[2], unsigned i)
{
	float ax = f[i][0] - f[i - 1][0], ay = f[i][1] - f[i - 1][1];
	float bx = f[i + 1][0] - f[i][0], by = f[i + 1][1] - f[i][1];
	return ax * bx + ay * by < 0.75f * hypotf(ax, ay) * hypotf(bx, by);
}

void pen_lathe(const struct pen *p, const float (*profile)[2], unsigned n, unsigned segments)
{
	unsigned columns = segments + 1, rows = 0;
	g_autofree vec *points = g_new(vec, (gsize)n * columns);
	for (unsigned i = 0; i < n; i++) {
		for (unsigned k = 0; k < columns; k++)
			points[rows * columns + k] = ring_point((vec){ 0, 0, profile[i][1] },
				(vec){ 1, 0, 0 }, (vec){ 0, 1, 0 }, profile[i][0], k, segments);
		rows++;
		if (i + 1 < n && (i == 0 || !profile_turns(profile, i)))
			continue;
		pen_skin(p, points, rows, columns);
		memmove(points, points + (rows - 1) * columns, columns * sizeof(vec));
		rows = 1;
	}
}

void pen_tube(
	const struct pen *p, const vec *path, const float *radii, unsigned n, unsigned segments)
{
	unsigned columns = segments + 1;
	g_autofree vec *points = g_new(vec, (gsize)(n + 2) * columns);
	vec u = { 0 }, v = { 0 };
	for (unsigned i = 0; i < n; i++) {
		vec axis = unit(path[MIN(i + 1, n - 1)] - path[i ? i - 1 : 0]);
		if (i == 0)
			frame_around(axis, &u, &v);
		u = unit(u - axis * dot(u, axis));
		v = cross(axis, u);
		for (unsigned k = 0; k < columns; k++)
			points[(i + 1) * columns + k] =
				ring_point(path[i], u, v, radii[i], k, segments);
	}
	for (unsigned k = 0; k < columns; k++) {
		points[k] = path[0];
		points[(n + 1) * columns + k] = path[n - 1];
	}
	pen_skin(p, points, n + 2, columns);
}

void pen_rod(const struct pen *p, vec a, vec b, float radius_a, float radius_b, unsigned segments)
{
	pen_tube(p, (vec[]){ a, b }, (float[]){ radius_a, radius_b }, 2, segments);
}

void pen_ball(const struct pen *p, vec centre, vec radii, unsigned segments)
{
	unsigned rows = segments / 2 + 1, columns = segments + 1;
	g_autofree vec *points = g_new(vec, (gsize)rows * columns);
	for (unsigned r = 0; r < rows; r++)
		for (unsigned c = 0; c < columns; c++) {
			float lat = G_PI * r / (rows - 1),
			      lon = 2 * G_PI * (c % segments) / segments;
			vec at = { sinf(lat) * cosf(lon), sinf(lat) * sinf(lon), cosf(lat) };
			points[r * columns + c] = centre + at * radii;
		}
	pen_skin(p, points, rows, columns);
}

void pen_moulding(const struct pen *p, const float (*profile)[2], unsigned n, float x0, float x1,
	float mitre0, float mitre1)
{
	vec last_a = { 0 }, last_b = { 0 }, first_a = { 0 }, first_b = { 0 };
	for (unsigned i = 0; i < n; i++) {
		float out = profile[i][0], up = profile[i][1];
		vec a = { x0 - mitre0 * out, -out, up }, b = { x1 + mitre1 * out, -out, up };
		if (i)
			pen_quad(p, last_a, last_b, b, a);
		else
			first_a = a, first_b = b;
		if (i >= 2 && mitre0 == 0)
			pen_triangle(p, first_a, last_a, a);
		if (i >= 2 && mitre1 == 0)
			pen_triangle(p, first_b, last_b, b);
		last_a = a, last_b = b;
	}
}
