#ifndef ACQUIRE_RECORDER_H
#define ACQUIRE_RECORDER_H
/* Scans on a thread of its own, for services: begun, paused, gone on with, stopped; how far it is can be asked at any time. One owner;
 * all functions and callbacks are of the thread that made it, which runs a main loop. */
#include "acquire/identify.h"
#include "acquire/picture.h"
#include "acquire/scan.h"

/* What a latched recorder says: see recorder_reset. */
#define RECORDER_NOT_RESET                                                                         \
	"the scanner was stopped for safety, and nobody has said since that it is safe: reset it"

enum recorder_state {
	RECORDER_IDLE,
	RECORDER_STARTING,
	RECORDER_SCANNING,
	RECORDER_DEVELOPING,
	RECORDER_PAUSING,
	RECORDER_PAUSED, /* a partial scan of site waits */
	RECORDER_STATES
};
extern const char *const recorder_state_names[RECORDER_STATES];

struct recorder_progress {
	enum recorder_state state;
	char *site; /* path; NULL before the first scan */
	uint32_t scan;
	char *preset, *doing;
	double fraction, column_fraction, seconds_left; /* below 0: not known */
	uint32_t photos_taken, photos_wanted;
};
void recorder_progress_clear(struct recorder_progress *p);

struct recorder_watcher {
	/* The head answers and the folder is there. */
	void (*begun)(gpointer user_data);
	/* error NULL: whole. partial: it is kept, and can be gone on with. stopped: somebody asked for it. */
	void (*ended)(const char *site, uint32_t scan, bool partial, bool stopped,
		const GError *error, gpointer user_data);
	void (*checked)(const GError *error, gpointer user_data);
	gpointer user_data;
};

typedef struct recorder recorder;
recorder *recorder_new(const struct recorder_watcher *watcher);
/* Stops what is under way, keeps the partial scan, and waits for it. NULL is fine. */
void recorder_free(recorder *r);

/* One of these at a time: SERVICE_ERROR_BUSY. A scan tells by begun, when it comes so far, and by ended; a check by checked. device: a URI; %n in it is the number
 * that the scan will have. */
bool recorder_start(recorder *r, const char *device, const char *site_path,
	const struct preset *preset, bool hdr, GError **error);
bool recorder_resume(recorder *r, const char *site_path, bool salvage, GError **error);
/* Opens the head and identifies its lidar. */
bool recorder_check(recorder *r, const char *device, GError **error);
/* A scan or a check that an emergency stop or an open interlock has ended leaves the recorder latched: it refuses to scan (PUMP_ERROR_NOT_RESET)
 * until somebody has said that it is safe, whatever became of the head meanwhile. This opens the head, resets its stage and checks; checked
 * follows. Still latched after that: a contact is open. */
bool recorder_reset(recorder *r, const char *device, GError **error);
bool recorder_is_latched(recorder *r);
/* Stops, and keeps what there is; ended follows. Fine when it is paused already. */
bool recorder_pause(recorder *r, GError **error);
/* Stops; ended follows. keep false: the partial scan is removed, also one that is paused. */
bool recorder_stop(recorder *r, bool keep, GError **error);
bool recorder_discard(recorder *r, const char *site_path, GError **error);

bool recorder_is_working(const recorder *r); /* on a scan or a check */
bool recorder_is_checking(const recorder *r);
struct recorder_progress recorder_progress(recorder *r); /* caller clears */
struct identity recorder_head(recorder *r);
void recorder_forget_head(recorder *r); /* another one is meant from now on */
/* What has been seen so far: 4 bytes a cell, RGBA, A 0 where nothing was; caller frees. *ret_serial changes with it. NULL: no scan
 * was made yet. Asking keeps it up to date. */
uint8_t *recorder_preview(recorder *r, enum picture plane, uint32_t *ret_columns,
	uint32_t *ret_rows, uint64_t *ret_serial);

#endif
