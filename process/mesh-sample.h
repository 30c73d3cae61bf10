#ifndef PROCESS_MESH_SAMPLE_H
#define PROCESS_MESH_SAMPLE_H
/* Points on a mesh, the same each time: spread by chance, as many for each patch of area; or blue noise, of which no two are nearer to
 * each other than a spacing, and which leave no place much further than that from a point (Poisson discs by throwing darts). One
 * owner, one thread. */
#include "acquire/points.h"
#include "process/mesh.h"

struct mesh_sampling {
	uint64_t count;   /* of points, about; 0: as the spacing says, or half a million */
	double spacing_m; /* between blue noise's; 0: as the count says */
	bool uniform;     /* by chance, not blue noise */
};

typedef struct mesh_sample mesh_sample;
/* m must stay, with its curvature. It has some area. */
mesh_sample *mesh_sample_new(const mesh *m, const struct mesh_sampling *how);
void mesh_sample_free(mesh_sample *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(mesh_sample, mesh_sample_free)
/* At least so many points will come at most. */
uint64_t mesh_sample_most(const mesh_sample *s);
/* 0: that were all. */
size_t mesh_sample_next(
	mesh_sample *s, struct point_record *into, struct surface_record *into_surface, size_t max);
double mesh_sample_fraction(const mesh_sample *s);
double mesh_sample_spacing_m(const mesh_sample *s); /* 0: uniform */

#endif
