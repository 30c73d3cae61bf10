#ifndef RENDER_BENCH_DISCS_H
#define RENDER_BENCH_DISCS_H
#include "render/frame.h"

/* How many points the mask of a frame is drawn of: those in the picture whose rank is low enough (disc-lanes.h). */
uint64_t bench_count_discs(const frame *f);

#endif
