#ifndef PROCESS_MODEL_THIN_H
#define PROCESS_MODEL_THIN_H
/* Where clouds overlap with other scans. They have no grid to look into, so it is told from cells of space, while the points of
 * all scans come along the Morton curve: in each cell the scan with the smallest patches stays, and what another one has there of
 * the same side of the surface goes, if either is a cloud. A cell is two to four patches wide, by the clouds' own points in the
 * metre around it. A scan counts as the best only where it covers its cell at least half as well as any.
 *
 * It holds what lies in one block of space, a metre wide, or at most MODEL_THIN_MAX points. */
#include "process/model-write.h"

#define MODEL_THIN_MAX (1u << 20)

typedef struct model_thin model_thin;
/* Hands on to w, which must live longer. clouds: the numbers of the scans that are some. */
model_thin *model_thin_new(model_writer *w, unsigned level, GHashTable *clouds);
bool model_thin_add(model_thin *t, const struct part_point *p, uint16_t scan, GError **error);
/* What is still held. */
bool model_thin_flush(model_thin *t, GError **error);
void model_thin_free(model_thin *t); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(model_thin, model_thin_free)

#endif
