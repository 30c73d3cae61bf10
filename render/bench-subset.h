#ifndef RENDER_BENCH_SUBSET_H
#define RENDER_BENCH_SUBSET_H
/* A model of the same place with fewer points, so that scenes of different sites can be compared. */
#include "process/model.h"

/* Writes the first part of every chunk, which is a uniform subset (process/model.h), about so many points in all; each stands for as
 * much more surface. points must be less than the model has. */
bool bench_subset_write(const model *from, uint64_t points, const char *path, GError **error);

#endif
