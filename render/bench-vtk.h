#ifndef RENDER_BENCH_VTK_H
#define RENDER_BENCH_VTK_H
/* VTK, which most viewers of point clouds draw with, on the same points: a Python program that draws them in their colours, 3 px wide,
 * without light, off the screen. It needs Debian's python3-vtk9 and an X display: xvfb-run's, else that of DISPLAY. */
#include "render/bench-frames.h"

#define BENCH_VTK_CAMERAS_MAX 8
struct bench_vtk {
	char *why_not; /* NULL: it ran */
	char *version, *renderer;
	double first_s; /* of the first frame: with what is prepared for it */
	double frame_s[BENCH_VTK_CAMERAS_MAX];
	uint32_t cameras;
};
/* Files go to a folder, and are removed. When it does not run ret tells why. */
void bench_vtk_run(const scene *s, const struct bench_camera *cameras, uint32_t count,
	const char *folder, struct bench_vtk *ret);
void bench_vtk_clear(struct bench_vtk *v);

#endif
