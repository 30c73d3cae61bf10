#ifndef ACQUIRE_MARKS_H
#define ACQUIRE_MARKS_H
/* The RECORD_MARKs that programs understand, as JSON; others are for people. All texts are the caller's to free. */
#include "acquire/exposures.h"

/* Which exposure the photos have. */
char *mark_lock_text(const struct camera_controls *controls);
/* The lidar was told to stop for a while: the turns until it streams again are not lost. */
char *mark_pause_text(void);
/* The stage stands at a photo angle, and frames of these exposures follow that belong together; count 0: no more do. */
char *mark_stop_text(const struct exposures *e);

struct mark {
	bool pauses, locks, stops; /* what it is; each of the others is zero then */
	struct camera_controls locked;
	struct exposures stop;
};
struct mark mark_read(const void *text, size_t length);

#endif
