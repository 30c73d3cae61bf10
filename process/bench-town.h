#ifndef PROCESS_BENCH_TOWN_H
#define PROCESS_BENCH_TOWN_H
/* Sites that are larger than memory, for benches: a simulated place again and again, as the blocks of a town, written as any model
 * is. Each block has things of its own, but one ground is below all. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

/* From one block to the next, east and north. */
#define BENCH_TOWN_PITCH_M 65.536

struct bench_town {
	uint32_t across, down; /* blocks */
	uint64_t points;
	double seconds; /* that writing it took */
};
/* Makes a site of at least so many points at path, of the blocks of the one at from; a model, segments and site.json, without scans. */
bool bench_town_write(const char *from, const char *path, uint64_t wanted, struct bench_town *ret,
	GError **error);

#endif
