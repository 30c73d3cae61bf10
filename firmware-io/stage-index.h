#ifndef FIRMWARE_IO_STAGE_INDEX_H
#define FIRMWARE_IO_STAGE_INDEX_H
/* Steps of a stage whose motor turns by itself, from its slots alone: between two slots it is taken to turn evenly, so the steps of that
 * stretch are known once the second slot has passed. Steps count from the first slot that was ever passed.
 *
 * A slot is the same edge whichever way it is passed (stage-pins.c), so the first one after a turn-about is the one before it. Plain data, no
 * thread, no errors. */
#include <stdbool.h>
#include <stdint.h>

struct stage_index {
	double spacing; /* steps from slot to slot; the owner's to set */
	double at;      /* where the last slot is, in steps */
	int64_t steps;  /* whole ones up to there */
	int64_t since_ns;
	int direction; /* in which the last slot was passed; 0: none was */
};

/* The motor starts from rest. */
void stage_index_start(struct stage_index *x, int64_t now_ns);
/* It stopped somewhere: the next slot is the first one. */
void stage_index_forget(struct stage_index *x);
/* A slot passes. Returns how many steps (>= 0) were made since *ret_from_ns, evenly, the last one now. */
int64_t stage_index_pass(
	struct stage_index *x, int64_t now_ns, int direction, int64_t *ret_from_ns);
/* When the kth of n such steps was, 1 <= k <= n. */
int64_t stage_index_step_ns(int64_t from_ns, int64_t now_ns, int64_t k, int64_t n);

#endif
