#ifndef PROCESS_PLANE_INSIDE_H
#define PROCESS_PLANE_INSIDE_H
/* Whether places are of a polygon, or near it: its edges by stripes, so that few are looked at. Internal to process/plane-*. */
#include "process/plane-find.h"

typedef struct plane_inside plane_inside;
plane_inside *plane_inside_new(const struct plane_draft *d); /* which it copies */
void plane_inside_free(plane_inside *i);                     /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(plane_inside, plane_inside_free)
/* In it, or no farther from its border; within_m counts up to PLANE_INSIDE_WITHIN_M, or so many spacings of its points if these are more. */
#define PLANE_INSIDE_WITHIN_M 0.6f
#define PLANE_INSIDE_SPACINGS 2.f
bool plane_inside_near(const plane_inside *i, const float at[2], float within_m);
/* No farther from those parts of its border that meet no other plane. */
bool plane_inside_is_border(const plane_inside *i, const float at[2], float within_m);

#endif
