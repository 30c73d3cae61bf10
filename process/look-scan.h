#ifndef PROCESS_LOOK_SCAN_H
#define PROCESS_LOOK_SCAN_H
/* A scan that is new to its site, as a first look at it (model-look.h) takes it: every second row and column, with the normals and
 * features of that alone; and, point by point, what the model of before has of the same surface. One owner. */
#include "process/model-inputs.h"
#include "process/model-part.h"
#include "process/model.h"

typedef struct look_scan look_scan;
/* Its points on the lattice of this cell. NULL with an error. */
look_scan *look_scan_new(
	const site *s, const struct model_input *input, double cell_m, GError **error);
void look_scan_free(look_scan *l); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(look_scan, look_scan_free)

/* A point of the model, at that place in the site. True: the scan saw its surface better; otherwise, where both saw it, that point of the
 * scan is left out. Any thread. */
bool look_scan_saw_better(look_scan *l, const struct model_point *p, const double at_m[3]);
/* When all points were shown to it: those of the scan that stay, along the curve, of the segments that the model told, as far as their
 * surfaces go on smoothly; owned by l. */
const struct part_point *look_scan_points(look_scan *l, size_t *ret_count);

#endif
