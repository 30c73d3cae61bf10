#ifndef ACQUIRE_PLANES_H
#define ACQUIRE_PLANES_H
/* A panorama on disk: TIFF planes in the scan's folder, which any picture program opens.
 *
 *     range.tiff      32-bit float, metres from the head's centre; 0 = none
 *     intensity.tiff  16 bit, the lidar's own scale
 *     cell.tiff       8 bit, enum panorama_cell: 0 empty, 1 measured, 2 filled, 3 no return
 *     offset.tiff     two signed 16-bit samples: the beam's azimuth and elevation from the cell's
 *                     centre, in cells/65534
 *     colour.tiff     three 8-bit samples, sRGB; missing when the scan has no colour
 *
 * Row 0 is the highest, column 0 starts at azimuth 0 and azimuth rises clockwise. The grid's
 * elevations stand in scan.json. */
#include "acquire/panorama.h"

/* File names, NULL-terminated; colour.tiff last. */
extern const char *const planes_names[];

/* Writes all planes under other names and syncs, then gives them theirs: when the disk is full, the
 * planes that were there stay. A colour.tiff of before goes when there is no colour now. */
bool planes_save(const panorama *p, const char *folder, GError **error);

/* Checks that every plane has the grid's size and type. desc comes from scan.json. */
panorama *planes_load(const char *folder, const struct panorama_desc *desc, GError **error);

#endif
