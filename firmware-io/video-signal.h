#ifndef FIRMWARE_IO_VIDEO_SIGNAL_H
#define FIRMWARE_IO_VIDEO_SIGNAL_H
/* A camera may be a box that a cable brings a picture to (HDMI, SDI): then somebody else says how large the picture is, and may change it or pull the
 * cable at any time. The kernel's "Digital Video (DV) Timings" and its event SOURCE_CHANGE. Owner and thread as video-device.h. */
#include "firmware-io/video-device.h"

/* On opening: the device is to follow what its cable brings. True also for cameras that have none. WIRE_ERROR_GONE: nothing usable comes now. */
bool video_follow_signal(struct video_device *d, GError **error);
/* Since it was opened or asked last; then the format is to be agreed on anew. */
bool video_signal_has_changed(struct video_device *d);

#endif
