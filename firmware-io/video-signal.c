#include "firmware-io/video-signal.h"
#include "firmware-io/wire.h"
#include <errno.h>

#define TRIES 4

static bool fail(GError **error, const struct video_device *d, const char *why)
{
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE, "%s %s", d->path, why);
	return false;
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

static bool fail_by_errno(GError **error, const struct video_device *d)
{
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
	default: return true; /* a camera that is its own source */
	}
}

bool video_follow_signal(struct video_device *d, GError **error)
{
	struct v4l2_event_subscription change = { .type = V4L2_EVENT_SOURCE_CHANGE };
	struct v4l2_requestbuffers none = { .type = d->type, .memory = V4L2_MEMORY_MMAP };
	/* First, so that no change falls between; drivers may also call it one that they are set. */
	d->signal_is_watched = video_call(d, VIDIOC_SUBSCRIBE_EVENT, &change) == 0;
	for (int i = 0; i < TRIES; i++) {
		struct v4l2_dv_timings timings = { 0 };
		if (video_call(d, VIDIOC_QUERY_DV_TIMINGS, &timings) < 0)
			return fail_by_errno(error, d);
		video_call(d, VIDIOC_REQBUFS, &none); /* or it is busy */
		if (video_call(d, VIDIOC_S_DV_TIMINGS, &timings) < 0)
			return fail(error, d,
				errno == EBUSY ? "is in use by another program"
					       : "does not take the picture that its cable brings");
		if (!video_signal_has_changed(d))
			return true;
	}
	errno = ENOLCK;
	return fail_by_errno(error, d);
}
