#ifndef PROCESS_BENCH_STREET_H
#define PROCESS_BENCH_STREET_H
/* Sites of any size for benches: ordered scans with intensity and colour along a street of relief, 8 m from each other. */
#include "process/scan-graph.h"

#define BENCH_STREET_COLUMNS 3000u
#define BENCH_STREET_ROWS    792u
/* Of them has a point. */
#define BENCH_STREET_POINTS 1.9e6

/* Adds the scan-th one, from 0, to a site that is open for writing; counts its points. */
bool bench_street_add(site *s, uint32_t scan, uint64_t *ret_measured, GError **error);
/* Where the first so many stand; its array is the caller's. */
scan_graph bench_street_graph(uint32_t scans);

#endif
