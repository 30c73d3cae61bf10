#ifndef PROCESS_FEATURE_PICTURES_H
#define PROCESS_FEATURE_PICTURES_H
/* What was computed of a scan with a grid, for people to look at: a picture each, one pixel a cell. To add one, write a painter and
 * its row in scan_pictures. */
#include "process/range-grid.h"
#include "process/scan-features.h"

struct scan_picture_input {
	const range_grid *grid;
	const scan_features *features; /* of as many cells */
};

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
