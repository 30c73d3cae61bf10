#ifndef FIRMWARE_IO_CAMERA_V4L2_H
#define FIRMWARE_IO_CAMERA_V4L2_H
/* A camera behind V4L2 (DEVICES 3): camera.h's model on a device that streams all the time. Of what comes, the first frame is handed out whose exposure
 * began after a buffer was lent; others go back to the driver at once. Frames that are damaged, short, or taken while controls settle (as
 * many as there are buffers, and two) do not count: the loan stays for the next.
 *
 * Frames have the format they came in, without the padding of their rows. Stamps are the driver's if it stamps by CLOCK_MONOTONIC; else, and
 * where a stamp cannot be, the instant at which the frame was seen here, which is said once.
 *
 * What fails is started again: the stream first, then the whole device. Without success, or once it is unplugged, read says WIRE_ERROR_GONE and
 * looks for it again once a second, as often as it is called; controls that were set meanwhile are applied, and loans stay. */
#include "firmware-io/parts.h"
#include "firmware-io/video-device.h"

struct camera_v4l2_counts {
	uint64_t frames;   /* that came */
	uint64_t handed;   /* that were handed out */
	uint64_t damaged;  /* the driver said so, or what it said could not be */
	uint64_t cut;      /* shorter than their format, or no whole JPEG */
	uint64_t lost;     /* by gaps in the sequence */
	uint64_t silences; /* times that no frame came for too long */
	uint64_t restarts, openings;
	uint64_t changes; /* of the picture that its cable brings */
	bool host_stamps; /* the last frame's stamp was the driver's */
};

/* As camera_new_v4l2 (parts.h), on a device of somebody else's: for tests. */
camera *camera_new_v4l2_on(
	head *h, const parts *p, const struct video_calls *calls, GError **error);
struct camera_v4l2_counts camera_v4l2_count(const camera *c);
/* What it lacks or does not keep, as it was said; NULL: nothing. */
const char *camera_v4l2_remark(const camera *c);

/* The frame that was read last, as a dma-buf, which the camera keeps; -1 where the driver exports none. It has the padding of its rows. Nothing in
 * pleinair imports it yet, as frames are recorded by the bytes; it is for a viewfinder on the GPU. */
int camera_v4l2_dma_buf(const camera *c);

#endif
