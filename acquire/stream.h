#ifndef ACQUIRE_STREAM_H
#define ACQUIRE_STREAM_H
/* A stream takes the entries of a record in order - live, as they are written, or from the file -
 * and gives out placed scanlines and frames with the stage angle at which they were taken.
 *
 * A line can be placed once the clocks are known and the stage's pulses reach beyond its last beam.
 * Live, lines wait for that in a short queue, and clocks are as good as what has been seen so far.
 * From a file the stream goes through twice: it learns all clocks and pulses first, is rewound, and
 * then places every line with what it knows of the whole scan.
 *
 * One owner; not thread-safe. Callbacks may not feed. */
#include "acquire/decoder.h"
#include "acquire/exposures.h"
#include "acquire/placement.h"
#include "firmware-io/camera.h"
#include "firmware-io/record.h"

typedef struct stream stream;

enum stream_mode { STREAM_LIVE, STREAM_LEARN_FIRST };

struct stream_sink {
	/* Each may be NULL. */
	void (*line)(
		const struct scanline *line, const struct placed_line *placed, gpointer user_data);
	/* front_rad: stage angle in the middle of the exposure. Frames are NV12 here, whatever the
	 * camera makes (frames.h); pixels have the length that info says, checked, and live until
	 * the callback returns. locked: taken with the exposure that the scan settled on
	 * (mark_lock_text); others were for metering, or are of a stop. */
	void (*frame)(const struct camera_frame_info *info, const uint8_t *pixels, double front_rad,
		bool locked, gpointer user_data);
	void (*reply)(const struct lidar_reply *reply, gpointer user_data);
	/* The frames from here to the next call are of one photo stop (mark_stop_text); count 0: they are of none. */
	void (*stop)(const struct exposures *exposures, gpointer user_data);
	gpointer user_data;
};

/* Turns of the mirror that are missing, found by the device's counter and clock. */
struct stream_loss {
	double from_rad, to_rad; /* stage angle before and after, not wrapped */
	uint32_t revolutions;
};

struct stream_report {
	uint32_t sessions;
	uint64_t revolutions, lost_revolutions;
	uint32_t counter_jumps; /* the counter jumped but no time had passed: nothing is missing */
	uint64_t device_errors; /* revolutions that the device itself did not trust: not placed */
	uint64_t unplaced;      /* whole revolutions that no clock or stage angle was known for */
	uint64_t bad_telegrams, bad_frames;
	uint32_t suspect_intervals; /* of the stage */
	double drift_ppm;           /* of the lidar's clock in the last session */
	bool ended;                 /* RECORD_END was seen */
};

stream *stream_new(enum stream_mode mode, const struct stream_sink *sink);
void stream_free(stream *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(stream, stream_free)

/* Refuses a session whose header cannot be read; skips what it does not know. */
bool stream_feed(stream *s, const struct record_entry *entry, GError **error);
/* After the last entry of the first pass, or of a later one; the next entry fed is the first again. */
void stream_rewind(stream *s);

/* Takes so much off the lidar's stamps, from the next line on: what lidar-delay.h found. */
void stream_advance_lidar(stream *s, int64_t delay_ns);

/* All of it takes work: the clock is fitted to all that came. */
struct stream_report stream_get_report(const stream *s);
/* Revolutions and errors of the device alone, as they are counted; lives as long as the stream. */
const struct stream_report *stream_counts(const stream *s);
/* Of struct stream_loss; caller frees. */
GArray *stream_losses(const stream *s);
/* Of the present session; NULL before the first. */
const struct calibration *stream_calibration(const stream *s);
const char *stream_protocol(const stream *s); /* "" before the first */
const struct lidar_identity *stream_lidar(const stream *s);
stage_track *stream_stage(const stream *s);

#endif
