#ifndef PROCESS_EXPORT_WALK_H
#define PROCESS_EXPORT_WALK_H
/* The points of a station one block after another, always the same and in the same order: to look through them, to write them and to
 * compare what was written. One owner, one thread. */
#include "process/export-format.h"

typedef struct export_walk export_walk;
/* with what the survey keeps; without a survey so far, all. */
export_walk *export_walk_open(const struct export_job *j, const struct export_station *s,
	enum export_walk_order order, GError **error);
void export_walk_free(export_walk *w); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(export_walk, export_walk_free)
#define EXPORT_BLOCK 8192u
/* Points, or cells, that were gone through so far. */
uint64_t export_walk_done(const export_walk *w);
/* At most EXPORT_BLOCK; 0: that was all. Counts them as work done (export_step). */
bool export_walk_next(
	export_walk *w, const struct export_point **ret, size_t *ret_count, GError **error);
/* The index among the station's cells or points of the one that was given at i. */
uint64_t export_walk_index(const export_walk *w, size_t i);
/* The order in which the job's format has this station. */
enum export_walk_order export_order_of(const struct export_job *j, const struct export_station *s);

/* Fills the survey of each station, thinned where the options say so. */
bool export_survey_all(struct export_job *j, GError **error);
void export_survey_clear(struct export_survey *s);

#endif
