#ifndef PROCESS_EXPORT_E57_H
#define PROCESS_EXPORT_E57_H
/* What the files of the E57 writer share: the XML that grows with each station, and the pictures. */
#include "process/e57-pages.h"
#include "process/e57-write.h"
#include "process/export-format.h"

typedef struct e57_xml e57_xml;
e57_xml *e57_xml_new(const struct export_job *j); /* which must stay */
void e57_xml_free(e57_xml *x);                    /* NULL is fine */
/* Of a station whose points lie at a physical offset: begin, each field, end. step_m 0: whole numbers. */
void e57_xml_begin_points(e57_xml *x, const struct export_station *s, uint64_t offset);
void e57_xml_field(e57_xml *x, const char *name, int64_t least, int64_t most, double step_m);
void e57_xml_end_points(e57_xml *x);
/* A picture of a station. */
struct e57_xml_picture {
	const char *name, *kind; /* as in scan.json */
	char *guid;
	bool is_png;
	uint64_t offset, bytes; /* physical, of its blob */
	bool has_pose;
	struct pose pose;
	int64_t width, height;
	double pixel_width, pixel_height, focal_m;
};
void e57_xml_picture(e57_xml *x, const struct export_station *s, const struct e57_xml_picture *p);
/* All of it; no more can be added. x keeps it. */
const char *e57_xml_end(e57_xml *x, size_t *ret_length);

/* Writes the station's panorama in colour, as a sphere around its scanner, and the pictures that came with it. */
bool export_e57_pictures(const struct export_job *j, const struct export_station *s, e57_write *to,
	e57_xml *x, GError **error);

#endif
