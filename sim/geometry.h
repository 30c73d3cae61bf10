#ifndef SIM_GEOMETRY_H
#define SIM_GEOMETRY_H
/* Vectors, frames, triangle meshes, and a pen that draws solids into them.
 *
 * A pen carries a local frame, a material and the object (of the world's instances) that its
 * triangles belong to. It is a small value: copy it, move the copy, and draw in local coordinates.
 * All walls, mouldings, columns, limbs and cars come from the handful of primitives below. Which
 * side of a triangle is its front is of no importance anywhere. */
#include <glib.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* The fourth component is 0 and means nothing. */
typedef float vec __attribute__((vector_size(16)));

static inline float dot(vec a, vec b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline vec cross(vec a, vec b)
{
	return (vec){ a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
		a[0] * b[1] - a[1] * b[0] };
}

static inline float length(vec a)
{
	return sqrtf(dot(a, a));
}

/* The zero vector stays what it is. */
static inline vec unit(vec a)
{
	float l = length(a);
	return l > 0 ? a / l : a;
}

static inline vec mix(vec a, vec b, float t)
{
	return a + (b - a) * t;
}

static inline float clamp_unit(float x)
{
	return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* Local to world: where the axes and the origin are. */
struct frame {
	vec x, y, z, o;
};

#define FRAME_WORLD ((struct frame){ { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } })

static inline vec frame_turn(const struct frame *f, vec v)
{
	return f->x * v[0] + f->y * v[1] + f->z * v[2];
}

static inline vec frame_point(const struct frame *f, vec p)
{
	return frame_turn(f, p) + f->o;
}

/* Two perpendiculars to a unit vector. */
void frame_around(vec axis, vec *ret_u, vec *ret_v);

/* What a triangle belongs to. */
struct face {
	uint16_t material, object;
};

struct mesh {
	GArray *points;  /* of vec */
	GArray *normals; /* of vec, one per point: for shading only, summed over the faces that
			    share the point */
	GArray *indices; /* of uint32_t, three per face */
	GArray *faces;   /* of struct face */
};

void mesh_init(struct mesh *m);
void mesh_clear(struct mesh *m);
/* Brings the summed normals to unit length. Call it once, when all is drawn. */
void mesh_finish(struct mesh *m);

struct pen {
	struct mesh *mesh;
	struct mesh *glass; /* panes and water go here, apart, so that light passes them; NULL: into
			       mesh too */
	const uint8_t *clear; /* by material: nonzero goes into glass */
	struct frame at;
	uint16_t material, object;
};

/* Copies of a pen: moved and turned (clockwise seen from above) in its own frame, or with another
 * material. */
struct pen pen_at(const struct pen *p, float x, float y, float z);
struct pen pen_turned(const struct pen *p, float x, float y, float z, float clockwise_rad);
struct pen pen_scaled(const struct pen *p, float scale);
struct pen pen_with(const struct pen *p, uint16_t material);

void pen_triangle(const struct pen *p, vec a, vec b, vec c);
/* With a shading normal for each corner. */
void pen_shaded(const struct pen *p, const vec corners[3], const vec normals[3]);
void pen_quad(const struct pen *p, vec a, vec b, vec c, vec d);
void pen_box(const struct pen *p, vec low, vec high);
/* A convex outline in the x-z plane, drawn from y0 to y1, both ends closed. */
void pen_prism(const struct pen *p, const vec *outline, unsigned n, float y0, float y1);
/* A smooth skin over rows x columns points, row by row. */
void pen_skin(const struct pen *p, const vec *points, unsigned rows, unsigned columns);
/* Leaf-shaped quad with its shading normal bent towards `lean` so that a crown shades as a mass. */
void pen_leaf(const struct pen *p, vec stalk, vec along, vec across, vec lean);
/* Profile of (radius, height) pairs turned round z; sharp turns of the profile stay sharp. */
void pen_lathe(const struct pen *p, const float (*profile)[2], unsigned n, unsigned segments);
/* Round tube along a path; both ends closed. */
void pen_tube(
	const struct pen *p, const vec *path, const float *radii, unsigned n, unsigned segments);
/* The straight case: from a to b with radii at both. */
void pen_rod(const struct pen *p, vec a, vec b, float radius_a, float radius_b, unsigned segments);
void pen_ball(const struct pen *p, vec centre, vec radii, unsigned segments);
/* Profile of (out, up) pairs run along x from x0 to x1, out being -y. A mitre of +1 lengthens that
 * end by what the profile stands out (an outer corner), -1 shortens it (an inner one), 0 cuts it
 * square and closes it. */
void pen_moulding(const struct pen *p, const float (*profile)[2], unsigned n, float x0, float x1,
	float mitre0, float mitre1);

#endif
