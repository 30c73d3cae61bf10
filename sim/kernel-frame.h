#ifndef SIM_KERNEL_FRAME_H
#define SIM_KERNEL_FRAME_H
/* Frames as cameras give them, of frames as the simulator draws them: NV12 becomes YUYV (each chroma row
 * serves two rows) or MJPEG (4:2:0, quality 90). */
#include "sim/link.h"
#include <glib.h>

struct kernel_frame_format {
	uint32_t fourcc; /* as V4L2 names it; 0: NV12 */
};

/* Of struct link_frame and its pixels, the same of the other format. */
GByteArray *kernel_frame(
	const struct kernel_frame_format *format, const guint8 *payload, gsize length);

#endif
