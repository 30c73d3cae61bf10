#ifndef RENDER_VIEW_SOURCES_H
#define RENDER_VIEW_SOURCES_H
/* What views of a site are found from: its saved views, boxes with the points of its model and the places where
 * scanners stood; and what the boxes alone tell of the site. A box counts as its points spread evenly in it. */
#include "acquire/site.h"
#include "process/model.h"
#include "render/camera.h"
#include "render/view-boxes.h"

struct view_station {
	uint32_t number;  /* of the scan */
	struct pose pose; /* scan to site: of the scanner itself */
};

struct view_sources {
	const site *site;        /* NULL: no saved views */
	const view_boxes *boxes; /* NULL: there is no model, or no point in it */
	const struct view_station *stations;
	size_t station_count;
	double aspect; /* width by height of the picture that is to be framed; 0: 4/3 */
};

/* Where the scanners of the scans in the model stood when it was made, sorted by number, of struct
 * view_station; without those of point clouds, which do not tell, but for those of turning lidars (scan-geometry.h). Errors are of manifest.h and
 * PRODUCT_ERROR. Caller frees. */
GArray *view_stations(const site *s, const model *m, GError **error);

struct view_box {
	double low_m[3], high_m[3];
};
/* What the bulk of the points is in, from the 2nd to the 98th percentile on each axis. There must be
 * boxes. */
struct view_box view_bulk(const struct view_sources *s);

/* Moves a camera, without turning it, to where nearly all points just fit in its picture, with a
 * margin: behind each edge remains one of a hundred at most, and only what is far. Returns the depth of the middle,
 * a place amid the site. There must be boxes. */
double view_frame(const struct view_sources *s, const double middle_m[3], struct camera *c);

/* What of the site a camera sees at depths from near_m to far_m. */
struct view_sight {
	double points; /* seen; towards the left and right edge a point counts less, and one that faces away not at all */
	double distance_m;    /* their mean depth; 0 where there are none */
	double elevation_rad; /* and their mean direction from the eye */
	double aside_rad; /* how far to the right the middle of what stands there at all is, where a side of the picture stays empty; else 0 */
	double low_rad,
		high_rad; /* between which elevations anything stands there at all; both 0: nothing does */
};
/* By a coarse depth picture of the boxes; those with few points hide nothing. The camera's picture
 * should have some ten pixels a side. */
struct view_sight view_look(
	const struct view_sources *s, const struct camera *c, double near_m, double far_m);

/* Height of the ground around a place, from flat chunks within 3 m that lie clearly below it; NAN:
 * none do. */
double view_ground_m(const struct view_sources *s, const double place_m[3]);

#endif
