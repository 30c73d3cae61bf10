#ifndef ACQUIRE_DEVELOP_H
#define ACQUIRE_DEVELOP_H
/* Developing makes the panorama out of a record: all clocks and all stage pulses are read first,
 * then every beam is placed with what is known of the whole scan, gaps are filled and marked, and
 * the photos give the colour. The same record gives the same panorama. */
#include "acquire/lidar-delay.h"
#include "acquire/panorama.h"
#include "acquire/stream.h"

struct develop_options {
	struct panorama_desc desc;
	/* Called now and then; fraction 0..1. May be NULL. */
	void (*progress)(double fraction, gpointer user_data);
	gpointer user_data;
};

struct develop_result {
	struct stream_report report;
	GArray *losses;                 /* of struct stream_loss; freed by develop_result_clear */
	struct calibration calibration; /* of the last session */
	struct lidar_identity lidar;
	char protocol[16];
	uint32_t photos;
	uint32_t merged_photos; /* of them, those of several exposures */
	bool delay_known;       /* delay was measured, and taken off */
	struct lidar_delay_result delay;
	bool cut; /* the record ends inside an entry */
};
void develop_result_clear(struct develop_result *r);

/* NULL with one sentence that names file and place. ret_result may be NULL. */
panorama *develop_record(const char *path, const struct develop_options *options,
	struct develop_result *ret_result, GError **error);

#endif
