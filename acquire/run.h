#ifndef ACQUIRE_RUN_H
#define ACQUIRE_RUN_H
/* A run drives a head through one scan while its record is written: home, meter, pass over what is
 * not yet covered, photograph the rest, come back. There is one idea in it: *go where coverage is
 * missing*. At first that is everywhere; after a lost revolution, a slipped stage, an unplugged
 * lidar or a power cut it is what was lost. One owner, one thread. */
#include "acquire/coverage.h"
#include "acquire/photos.h"
#include "acquire/preset.h"
#include "acquire/pump.h"

struct run_progress {
	double fraction;        /* 0..1 */
	double column_fraction; /* of the columns that are whole */
	uint32_t photos_taken, photos_wanted;
	const char *doing;       /* "homing", "scanning", "going back for 12 columns", ... */
	const panorama *preview; /* what has been seen so far, coarsely; in no way final */
};

struct run_options {
	const struct preset *preset;
	bool hdr; /* photos at stops, with several exposures each, when all columns are there; none in passing */
	double wait_for_lidar_s; /* after it was unplugged; 0 means 60 */
	/* Called each turn; true stops the scan, which can be resumed later. May be NULL. */
	bool (*progress)(const struct run_progress *progress, gpointer user_data);
	gpointer user_data;
};

typedef struct run run;

/* The head stays the caller's. */
run *run_new(head *h, const struct run_options *options);
void run_free(run *r); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(run, run_free)

/* Takes in an entry of a record made earlier, so that what it covered is not scanned again. */
bool run_recall(run *r, const struct record_entry *entry, GError **error);

/* The session's header has been written to the record as this entry. */
bool run_begin(run *r, const struct record_entry *session, GError **error);
/* Wakes and identifies the lidar. After it run_predict can be asked. */
bool run_prepare(run *r, GError **error);
/* Of the present session, or of the last one recalled; NULL before the first. */
const struct calibration *run_calibration(const run *r);
struct prediction run_predict(const run *r);
const struct lidar_identity *run_lidar(const run *r);
/* Scans until all is covered or cannot be. false: stopped, or something is broken; the record is
 * good as far as it goes. */
bool run_scan(run *r, GError **error);

uint32_t run_missing_columns(const run *r); /* of both faces, where both are wanted */
const panorama *run_preview(const run *r);  /* as run_progress has it */
struct stream_report run_report(const run *r);
struct camera_controls run_camera_controls(const run *r);

#endif
