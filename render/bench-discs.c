#include "render/bench-discs.h"
#include "render/chunk-view.h"
#include "render/disc-lanes.h"

uint64_t bench_count_discs(const frame *f)
{
	uint32_t count;
	uint64_t discs = 0;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	for (uint32_t n = 0; n < count; n++) {
		const struct pipeline *line =
			&g_array_index(f->drawing->pipelines, struct pipeline, views[n].pipeline);
		struct disc_pass p = disc_pass_of(f, &views[n], line->mask.disc, DISC_RADIUS_LEAST);
		for (uint32_t i = 0; i < p.end; i += LANES) {
			struct disc_lanes d;
			disc_lanes_find(f->scene, &p, &views[n], i, 0, &d);
			discs += (unsigned)__builtin_popcount(bits(d.drawn));
		}
	}
	return discs;
}
