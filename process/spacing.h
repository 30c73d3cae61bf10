#ifndef PROCESS_SPACING_H
#define PROCESS_SPACING_H
/* Points of which no two are nearer to each other than a spacing: each is taken unless one that was taken before is in its way. So
 * what comes first stays, and every point that was refused has one that was taken within 1.0045 times the spacing. About 15 bytes a
 * point that is taken. One owner, one thread. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct spacing spacing;
spacing *spacing_new(double spacing_m); /* above 0 */
void spacing_free(spacing *s);          /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(spacing, spacing_free)
/* Whether the point is taken. Coordinates are finite. */
bool spacing_take(spacing *s, const double at_m[3]);
uint64_t spacing_count(const spacing *s);

#endif
