#include "process/geometry.h"
#include "process/geometry-private.h"
#include <sys/mman.h>

#define HUGE_PAGE ((size_t)2 << 20)

void geometry_free(geometry *g)
{
	if (!g)
		return;
	g_aligned_free(g->normal_x);
	g_aligned_free(g->normal_y);
	g_aligned_free(g->normal_z);
	g_aligned_free(g->plane_error_m);
	g_aligned_free(g->curvature);
	g_free(g);
}

float *geometry_plane(size_t cells)
{
	size_t bytes = (cells + 64) * sizeof(float);
	if (bytes < HUGE_PAGE)
		return g_aligned_alloc(1, bytes, 64);
	/* Small pages take a fifth of the time, and even the last few a tenth: so whole ones only. */
	bytes = (bytes + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
	void *p = g_aligned_alloc(1, bytes, HUGE_PAGE);
#if defined MADV_HUGEPAGE
	madvise(p, bytes, MADV_HUGEPAGE); /* if it is refused, so be it */
#endif
	return p;
}

geometry *geometry_new(uint32_t columns, uint32_t rows)
{
	geometry *g = g_new0(geometry, 1);
	size_t cells = (size_t)columns * rows;
	g->columns = columns;
	g->rows = rows;
	g->normal_x = geometry_plane(cells);
	g->normal_y = geometry_plane(cells);
	g->normal_z = geometry_plane(cells);
	g->plane_error_m = geometry_plane(cells);
	g->curvature = geometry_plane(cells);
	return g;
}

struct normals_options geometry_normals_options(
	const range_grid *g, const struct geometry_options *options)
{
	return (struct normals_options){
		.radius_m =
			options && options->radius_m > 0 ? options->radius_m : GEOMETRY_RADIUS_M,
		.range_noise_m = options && options->range_noise_m > 0
					 ? options->range_noise_m
					 : normals_range_noise_m(g, NULL),
		.single_thread = options && options->single_thread,
	};
}

geometry *geometry_estimate(const range_grid *g, const struct geometry_options *options)
{
	geometry *ret = geometry_new(g->columns, g->rows);
	struct normals_options o = geometry_normals_options(g, options);
	struct normals_planes planes = { .normal = { ret->normal_x, ret->normal_y, ret->normal_z },
		.error_m = ret->plane_error_m,
		.curvature = ret->curvature };
	normals_estimate(g, &o, &planes);
	return ret;
}
