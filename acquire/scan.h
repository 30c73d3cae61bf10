#ifndef ACQUIRE_SCAN_H
#define ACQUIRE_SCAN_H
/* A scan from the press of the button to the finished folder: record, panorama, manifest. What
 * stops on the way stays as a partial scan and can be resumed or discarded. */
#include "acquire/develop.h"
#include "acquire/preset.h"
#include "acquire/run.h"
#include "acquire/site.h"

#define SCAN_SCHEMA 1

struct scan_options {
	const char *device; /* URI */
	head *head; /* instead of opening device: taken over; device is then only its name */
	const struct preset *preset; /* of a resumed scan: NULL, it keeps its own */
	bool hdr; /* photos at stops, of several exposures each; a resumed scan has its own way here, too */
	bool resume; /* go on with the partial scan */
	/* Resume although entries in the middle of the record are damaged: without them. The
	 * record as it was stays beside it as raw.rec.damaged. */
	bool salvage;
	double wait_for_lidar_s; /* 0: 60 */
	/* As run_options has it. predicted: called once, before the stage moves, with what the
	 * lidar that is connected will take. */
	bool (*progress)(const struct run_progress *progress, gpointer user_data);
	void (*predicted)(const struct prediction *prediction, const struct lidar_identity *lidar,
		gpointer user_data);
	/* Called once, when all is recorded and the panorama is being made of it, with all that the preview has. May be NULL. */
	void (*developing)(const panorama *preview, gpointer user_data);
	gpointer user_data;
};

struct scan_result {
	uint32_t number;
	uint32_t columns, rows;
	struct panorama_counts counts;
	struct stream_report report;
	uint32_t missing_columns, photos;
	bool hdr;               /* was asked for */
	uint32_t merged_photos; /* of several exposures */
	uint64_t record_bytes;
	double seconds; /* of the head's time, over all sessions */
};

/* Records one scan into the site and develops it. false: nothing was begun, or a partial scan was
 * kept that can be gone on with (*ret_partial, its number, else 0). A partial scan whose record or
 * manifest is damaged stays untouched; RECORD_ERROR_DAMAGED says that salvage may help. */
bool scan_record(site *s, const struct scan_options *options, struct scan_result *ret_result,
	uint32_t *ret_partial, GError **error);

/* "70.1 MB"; caller frees. */
char *scan_size_text(uint64_t bytes);

/* The device that the partial scan was begun with; caller frees. */
char *scan_partial_device(const site *s, GError **error);

/* Fails with a sentence when the file system of the folder has less than need_bytes free. */
bool scan_check_space(const char *folder, uint64_t need_bytes, GError **error);

/* Reads a finished scan: its manifest, then its planes, each checked by size and SHA-256 (a flipped
 * bit does not always hinder the decoder). With verify, all its files are checked, also the record.
 */
panorama *scan_load(const site *s, uint32_t number, bool verify, GError **error);
/* How many photos of a finished scan are of several exposures; 0: it is no HDR scan. */
uint32_t scan_hdr_photos(const site *s, uint32_t number);
/* Whether the record of a finished scan is as it was written, by size and SHA-256. */
bool scan_check_record(const site *s, uint32_t number, GError **error);
/* Develops the panorama of a finished scan again from its record, which is checked first, and
 * replaces planes and manifest. */
bool scan_develop_again(site *s, uint32_t number, GError **error);

#endif
