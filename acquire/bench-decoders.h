#ifndef ACQUIRE_BENCH_DECODERS_H
#define ACQUIRE_BENCH_DECODERS_H
/* How fast each lidar's bytes are decoded, on one core: what a simulated lidar of the kind said in a
 * few seconds, through the decoder again and again. */
#include <glib.h>
#include <stdbool.h>

struct bench_decoder {
	const char *key, *title;    /* for JSON, for people */
	const char *protocol, *uri; /* of the simulated head */
};
/* Ends with a row without a key. */
extern const struct bench_decoder bench_decoders[];

bool bench_decoder_measure(const struct bench_decoder *d, double *ret_mb_s, GError **error);

#endif
