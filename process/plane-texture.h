#ifndef PROCESS_PLANE_TEXTURE_H
#define PROCESS_PLANE_TEXTURE_H
/* The colours of a plane region: means of its points at each texel, those measured closely counting more; and where there are none, of what
 * is around, the nearer the more (pull and push, Grossman and Dally 1998, "Point Sample Rendering"). In linear light. */
#include "process/plane-find.h"

/* Sets texel, texel_m, low_m, width and height: all that the rings enclose and margin_m around. texel_m: at least. */
void plane_texture(struct plane_draft *d, const struct plane_spot *spot, uint32_t count,
	float texel_m, float margin_m);

#endif
