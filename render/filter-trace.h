#ifndef RENDER_FILTER_TRACE_H
#define RENDER_FILTER_TRACE_H
/* Means along what the picture shows, and across it: from each pixel so many steps of a pixel, either way. Internal to filters. */
#include "render/filter-planes.h"

#define FILTER_TRACE_MOST 96

/* What becomes of a sum of weighted numbers. */
enum filter_trace_by {
	TRACE_MEAN,  /* divided by the sum of weights */
	TRACE_SUM,   /* as it is */
	TRACE_NOISE, /* divided by the root of the sum of their squares: as uneven as before */
};

struct filter_trace {
	const struct filter_job *j;
	struct filter_flow_plane flow;
	int steps; /* at most FILTER_TRACE_MOST; lines end where the picture does */
	float weight[FILTER_TRACE_MOST +
		     1]; /* of the pixel itself, and of those so many steps away */
	enum filter_trace_by by;
	bool is_across;
	/* From a plane, between its pixels, to a plane; or from the nearest pixels of a picture to the same of another. */
	const float *from;
	float *to;
	const uint8_t (*from_rgba)[4];
	uint8_t (*to_rgba)[4];
};
/* Gaussian weights as far as two sigma; by MEAN they need not sum up to 1, by SUM they do. */
void filter_trace_weigh(struct filter_trace *t, float sigma);
void filter_trace_run(const struct filter_trace *t);
LANES_DECLARE(void, filter_trace_rows, (const void *trace, uint32_t from, uint32_t end));

#endif
