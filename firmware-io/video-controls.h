#ifndef FIRMWARE_IO_VIDEO_CONTROLS_H
#define FIRMWARE_IO_VIDEO_CONTROLS_H
/* A camera's exposure, gain, white balance and focus, locked (DEVICES 3.8): what is automatic is turned off first, for the others do nothing
 * before; then they are set, and read back, since drivers round and cameras have minds of their own.
 *
 * Gain in percent: drivers do not say what their numbers mean. Here 100 % is the least of the range and 1600 % its most, evenly between. */
#include "firmware-io/camera.h"
#include "firmware-io/video-device.h"

struct video_controls {
	int32_t focus;   /* in the driver's units; -1: its least, which is far away */
	GString *remark; /* what the camera lacks or does not keep, a sentence each; told once */
};

/* ret_in_force: as read back. Where the camera has no such control: 0 for exposure and white balance, which are not known then, and 100 for
 * gain. */
void video_controls_apply(const struct video_device *d, struct video_controls *v,
	const struct camera_controls *wanted, struct camera_controls *ret_in_force);

#endif
