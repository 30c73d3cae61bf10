#ifndef PROCESS_FACES_H
#define PROCESS_FACES_H
/* The beams of a record before they are placed: every turn of the mirror with the stage's angle, so that they can be placed again
 * and again while a calibration is looked for. The lidar sweeps more than half a circle, so a direction is seen by the front half
 * of its fan and, half a turn of the stage later, by the back half: the two faces, as surveyors say of a theodolite. A scan of
 * the preset "calibration" has both; of others, the way home shows the second.
 *
 * One owner; const once read. */
#include "acquire/colour.h"
#include "acquire/stream.h"

struct face_line {
	guint first; /* of its ranges */
	uint32_t beams;
	double front_rad, front_step_rad; /* stage angle at the first beam, and from beam to beam */
	double first_angle_rad, angle_step_rad; /* the device's */
	double pace_rad_s;                      /* of the stage, below 0 on the way back */
};

struct faces {
	GArray *lines;   /* of struct face_line */
	GArray *range_m; /* of float, as the device said; 0: none */
	GArray *photos;  /* of struct photo, with the exposure that the scan settled on */
	struct calibration calibration; /* what the head said of itself in the last session */
	char *certificate;              /* the same, as the text it was */
	struct stream_report report;
	record_reader *record; /* which photos lie in */
};

/* fraction 0..1; true stops. */
typedef bool (*faces_progress)(double fraction, gpointer user_data);

/* NULL with one sentence that names the file. progress may be NULL; stopped: G_IO_ERROR_CANCELLED. */
struct faces *faces_read(
	const char *record_path, faces_progress progress, gpointer user_data, GError **error);
void faces_free(struct faces *f); /* NULL is fine */
typedef struct faces faces;
G_DEFINE_AUTOPTR_CLEANUP_FUNC(faces, faces_free)

#endif
