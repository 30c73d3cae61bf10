#ifndef PROCESS_MESH_H
#define PROCESS_MESH_H
/* A triangle mesh, and what its surface does at each vertex: normals by the angles of the corners (Thürmer & Wüthrich 1998), principal
 * curvatures from how the normals change along the edges of each triangle (Rusinkiewicz 2004, "Estimating curvatures and their
 * derivatives on triangle meshes"). One owner; const once mesh_curve was called. */
#include "acquire/surface.h"
#include "process/mesh-texture.h"

typedef struct mesh mesh;
struct mesh {
	uint32_t vertices, triangles;
	double (*at_m)[3];
	uint32_t (*corner)[3];
	uint8_t (*rgb)[3][3];           /* of each corner; NULL: no colour */
	struct surface_record *surface; /* of each vertex; NULL until mesh_curve */
	GPtrArray *textures;            /* of mesh_texture; NULL: none, and none of the next two */
	int16_t *texture;               /* of each triangle, its place in textures; below 0: none */
	float (*uv)[3][2];              /* of each corner, as mesh_texture_at takes it */
};
mesh *mesh_new(uint32_t vertices, uint32_t triangles, bool has_colour);
/* Takes the textures, and makes room for what corners have of them: no triangle has one. It must have colour. */
void mesh_add_textures(mesh *m, GPtrArray *textures);
void mesh_free(mesh *m); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(mesh, mesh_free)
/* A polygon of count corners, at least 3, as count - 2 triangles by its ears: ret is three places in vertices for each. One that
 * crosses itself is cut somehow. */
void mesh_cut_polygon(const mesh *m, const uint32_t *vertices, uint32_t count, uint32_t *ret);
/* Makes vertices at one place one, so that triangles that were told apart are neighbours. */
void mesh_weld(mesh *m);
void mesh_curve(mesh *m);
double mesh_triangle_area_m2(const mesh *m, uint32_t triangle);

#endif
