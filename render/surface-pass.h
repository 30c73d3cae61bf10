#ifndef RENDER_SURFACE_PASS_H
#define RENDER_SURFACE_PASS_H
/* What each pixel of a picture is of: the normal and the segment of what lies at the depth of the mask, for filters that ask for them. The
 * same discs as the mask's; normals are means of those that lie there, segments and depths those of the nearest. */
#include "render/bands.h"

/* Of a band's pixels, rows of pitch, BAND_MARGIN columns before and behind; all 0 before, but for nearest_m, which is far. */
struct surface_desk {
	float *normal[3];
	float *nearest_m;
	float *leaf; /* whole numbers */
};
LANES_DECLARE(void, surface_chunk,
	(const struct band *b, const frame *f, const visibility_mask *m, const struct chunk_view *v,
		const struct surface_desk *d));

struct surface_planes {
	/* Rows as wide as the picture. Where nothing is: depth_m as it was, 0 0 0, 0. */
	float *depth_m;     /* becomes that of the nearest disc, with all its 32 bits */
	float (*normal)[3]; /* NULL: not wanted; nor is leaf then */
	uint16_t *leaf;
};
void surface_pass(const frame *f, const visibility_mask *m, const struct chunk_view *views,
	uint32_t count, const struct surface_planes *to);

#endif
