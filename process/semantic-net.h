#ifndef PROCESS_SEMANTIC_NET_H
#define PROCESS_SEMANTIC_NET_H
/* A network from an ONNX file, run by OpenCV on the processor. What it is asked and what its answers mean is semantic-model.h's.
 * One owner, one thread at a time; OpenCV spreads the work over all. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif

typedef struct semantic_net semantic_net;

/* bytes: the whole file, needed only here. Refuses what OpenCV cannot run. Messages begin with what. */
semantic_net *semantic_net_new(
	const uint8_t *bytes, size_t length, const char *what, GError **error);
void semantic_net_free(semantic_net *n); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(semantic_net, semantic_net_free)

/* in: channels planes of rows * columns, one after the other; ret_scores: classes planes likewise. Refuses a network that does
 * not take that many channels of that size, and one whose answer is not 1 x classes x rows x columns. */
bool semantic_net_run(semantic_net *n, const float *in, uint32_t channels, uint32_t columns,
	uint32_t rows, uint32_t classes, float *ret_scores, const char *what, GError **error);

#ifdef __cplusplus
}
#endif
#endif
