#ifndef RENDER_BENCH_FIGURE_H
#define RENDER_BENCH_FIGURE_H
/* A number out of what a bench printed as JSON, by where it stands:
 *
 *     normals/method=pleinair/cpu_s                            of an array the first object whose method is pleinair
 *     scenes/scene=A/frames/style=figure-7a;backend=cpu;#2/fps the third of those that are both
 *     fine/method=pleinair/prepare_cpu_s+align_cpu_s           a sum of members
 *     vtk/fps/#0                                               an element */
#include <json-glib/json-glib.h>
#include <stdbool.h>

struct bench_figure {
	bool there;
	double value;
	const char *
		why_not; /* what stands there instead, of root; may be NULL also when it is not there */
};
/* root: NULL: nothing is there. */
struct bench_figure bench_figure_find(JsonObject *root, const char *path);

#endif
