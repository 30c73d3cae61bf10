#ifndef ACQUIRE_FRAMES_H
#define ACQUIRE_FRAMES_H
/* Frames as cameras make them (YUYV, NV12, Bayer, MJPEG), turned into what everything downstream works on: NV12, BT.601, limited range.
 *
 * YUYV: chroma of two rows is averaged. Bayer: bilinear demosaic at the borders' own pixels mirrored, then the sRGB curve; the sensor's colours are
 * not balanced, for nothing is known of it. MJPEG: by libturbojpeg; a picture that ends early is refused. Full range and BT.709, where the
 * frame's flags say so, are converted. One owner; not thread-safe. */
#include "firmware-io/camera.h"

typedef struct frames frames;
frames *frames_new(void);
void frames_free(frames *f); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(frames, frames_free)

/* The frame as NV12, or NULL for one that is damaged or of a kind that is not known; width and height must be even. ret_info: of the result, with
 * the frame's other facts. The pixels live until the next call, or as long as those given. */
const uint8_t *frames_nv12(frames *f, const struct camera_frame_info *info, const uint8_t *pixels,
	size_t bytes, struct camera_frame_info *ret_info);

/* The host's time of a stamp that is the host's own (CAMERA_HOST_CLOCK), of which the low 32 bits of its microseconds are known, and the time at which
 * it came. */
int64_t frames_host_ns(uint32_t ticks_us, int64_t arrival_ns);
/* From a frame's stamp to the middle of its exposure. */
int64_t frames_middle_ns(const struct camera_frame_info *info, double readout_us);

#endif
