#ifndef ACQUIRE_RUN_PRIVATE_H
#define ACQUIRE_RUN_PRIVATE_H
/* What the files of a run share: run.c goes where coverage is missing, run-photos.c where photos are. */
#include "acquire/run.h"

struct run {
	struct pump pump;
	struct run_options options;
	struct stage_pace pace;
	/* Of the directions seen by half turns of the stage: the second counts where both faces are wanted. */
	coverage *coverage[2];
	uint32_t faces;
	panorama *preview;
	photos *photos;
	struct exposures exposures; /* of stops */
	bool scanning, streaming, metering, recalling, controls_known;
	bool steady; /* the stage goes slowly enough for a photo to tell where it was taken */
	uint64_t device_errors; /* up to the last start */
	uint32_t suspects, recoveries;
	char *doing;
	double seen_fraction; /* never falls, whatever is cleared */
};

/* What progress says is being done. */
void run_say(run *r, const char *doing);
/* Moves the stage there and waits for it. */
bool run_go(run *r, double angle_rad, double rate_rad_s, GError **error);

/* The stream's hooks. */
void run_take_frame(const struct camera_frame_info *info, const uint8_t *pixels, double front_rad,
	bool locked, gpointer user_data);
void run_take_stop(const struct exposures *exposures, gpointer user_data);

/* Once the camera has metered: the photos' exposure, and those around it, from here on. */
bool run_lock_exposure(run *r, GError **error);
/* When all columns are there: the photos that are not. */
bool run_take_photos(run *r, GError **error);

#endif
