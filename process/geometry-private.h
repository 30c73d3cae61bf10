#ifndef PROCESS_GEOMETRY_PRIVATE_H
#define PROCESS_GEOMETRY_PRIVATE_H
/* What geometry*.c share. */
#include "process/geometry.h"
#include "process/normals.h"

geometry *geometry_new(uint32_t columns, uint32_t rows); /* not filled */
/* Not filled; ask g_aligned_free. */
float *geometry_plane(size_t cells);
/* With what options leave open filled in. */
struct normals_options geometry_normals_options(
	const range_grid *g, const struct geometry_options *options);

#endif
