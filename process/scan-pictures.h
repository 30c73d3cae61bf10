#ifndef PROCESS_SCAN_PICTURES_H
#define PROCESS_SCAN_PICTURES_H
/* What was computed of a scan with a grid, for people to look at: a picture each, one pixel a cell. To add one, write a painter and
 * its row in scan_pictures. */
#include "process/range-grid.h"
#include "process/scan-features.h"
#include "process/scan-segments.h"

struct scan_picture_input {
	const range_grid *grid;
	const scan_features *features; /* of as many cells, as are */
	const scan_segments *segments;
	const struct segment_colour *colour; /* by number of the segment */
};

/* What a segment is painted in: its class's colour, and one of its own. */
struct segment_colour {
	uint8_t class[3], own[3];
};
/* SEGMENTS_MAX + 1 of them; caller frees. */
struct segment_colour *segment_colours(const segments *tree);

struct scan_picture {
	const char *name;  /* of the file: 0001-NAME.png */
	const char *title; /* a sentence for the page */
	void (*paint)(
		const struct scan_picture_input *of, size_t cell, uint8_t rgb[3]); /* rgb: white */
};
/* Ends with a row without a name. */
extern const struct scan_picture scan_pictures[];

/* Replaces the file as a whole. */
bool scan_picture_save(const struct scan_picture *p, const struct scan_picture_input *of,
	const char *path, GError **error);
/* Replaces FOLDER/index.html by a page that shows all pictures of these scans, without script or network. */
bool scan_pictures_write_page(
	const char *folder, const char *title, const GArray *numbers, GError **error);

#endif
