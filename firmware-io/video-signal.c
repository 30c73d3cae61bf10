#include "firmware-io/video-signal.h"
#include "firmware-io/wire.h"
#include <errno.h>

static bool fail(GError **error, const struct video_device *d, const char *why)
{
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE, "%s %s", d->path, why);
	return false;
}

bool video_follow_signal(struct video_device *d, GError **error)
{
	struct v4l2_event_subscription change = { .type = V4L2_EVENT_SOURCE_CHANGE };
	struct v4l2_dv_timings timings = { 0 };
	/* First, so that no change falls between. Cameras that are their own source know neither. */
	d->signal_is_watched = video_call(d, VIDIOC_SUBSCRIBE_EVENT, &change) == 0;
	if (video_call(d, VIDIOC_QUERY_DV_TIMINGS, &timings) == 0) {
		struct v4l2_requestbuffers none = { .type = d->type, .memory = V4L2_MEMORY_MMAP };
		video_call(d, VIDIOC_REQBUFS, &none); /* or it is busy */
		return video_call(d, VIDIOC_S_DV_TIMINGS, &timings) == 0 ||
		       fail(error, d,
			       errno == EBUSY ? "is in use by another program"
					      : "does not take the picture that its cable brings");
	}
	switch (errno) {
	case ENOLINK:
		return fail(error, d,
			"gets no picture: check the camera's cable, and that it is switched on");
	case ENOLCK:
		return fail(error, d,
			"gets a picture that does not hold still: check the camera's cable");
	case ERANGE:
		return fail(error, d,
			"gets a picture of a size or rate that it cannot take: set another at the "
			"camera");
	default: return true;
	}
}

bool video_signal_has_changed(struct video_device *d)
{
	struct v4l2_event e;
	bool changed = false;
	while (d->signal_is_watched && video_call(d, VIDIOC_DQEVENT, &e) == 0)
		changed |= e.type == V4L2_EVENT_SOURCE_CHANGE &&
			   e.u.src_change.changes & V4L2_EVENT_SRC_CH_RESOLUTION;
	return changed;
}
