#ifndef RENDER_BENCH_STATUE_H
#define RENDER_BENCH_STATUE_H
/* A closed thing to draw of any number of points: a tube with bumps along a trefoil knot, three metres across, as if a mesh had been
 * sampled, with normals and curvatures, without colours or features. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

/* The file of a model (process/model.h); the same for the same number. Errors are of files. */
bool bench_statue_write(const char *path, uint64_t points, GError **error);

#endif
