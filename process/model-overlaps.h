#ifndef PROCESS_MODEL_OVERLAPS_H
#define PROCESS_MODEL_OVERLAPS_H
/* Which points of each scan another scan has better (overlap.h), kept in SITE/model/parts/0003.overlap: a bit per cell, and
 * which scans, standing where, it was compared with. When scans are added, only pairs with them are looked at.
 *
 * Scans without a grid take no part here: model-thin.h. */
#include "process/build-progress.h"
#include "process/model-inputs.h"

/* Brings the files up to date. Holds about memory_bytes at most: as many scans as fit are compared with each of the others in
 * turn. */
bool model_overlaps_update(const site *s, const model_inputs *inputs,
	const struct build_progress *progress, GError **error);

/* The file of a scan, with its bits, 1: dropped; caller frees. NULL when there is none of these inputs. */
product *model_overlaps_open(const site *s, const struct model_input *input,
	const uint64_t **ret_dropped, uint64_t *ret_words);

char *model_part_path(const site *s, uint32_t number, const char *ending); /* caller frees */

#endif
