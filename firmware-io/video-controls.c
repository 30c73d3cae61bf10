#include "firmware-io/video-controls.h"
#include <math.h>
#include <string.h>

#define GAIN_MIN_PERCENT 100
#define GAIN_MAX_PERCENT 1600

/* What runs by itself, and how it is stopped. */
static const struct {
	uint32_t id;
	int32_t off;
	const char *remark; /* where it does not stay off; NULL: it matters little */
} automatic[] = {
	{ V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL, "changes its exposure by itself" },
	{ V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0, NULL },
	{ V4L2_CID_AUTO_WHITE_BALANCE, 0, "changes its white balance by itself" },
	{ V4L2_CID_AUTOGAIN, 0, "changes its gain by itself" },
	{ V4L2_CID_FOCUS_AUTO, 0, "focuses by itself" },
	{ V4L2_CID_BACKLIGHT_COMPENSATION, 0, NULL },
};

static void remark(struct video_controls *v, const char *text)
{
	if (!strstr(v->remark->str, text))
		g_string_append_printf(v->remark, "%s%s", v->remark->len ? "; it " : "it ", text);
}

static bool find(const struct video_device *d, uint32_t id, struct v4l2_queryctrl *ret)
{
	*ret = (struct v4l2_queryctrl){ .id = id };
	return video_call(d, VIDIOC_QUERYCTRL, ret) == 0 &&
	       !(ret->flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY));
}

/* Sets, and says what it then is. */
static bool set(const struct video_device *d, uint32_t id, int32_t value, int32_t *ret)
{
	struct v4l2_control c = { id, value };
	video_call(d, VIDIOC_S_CTRL, &c);
	c.value = value;
	if (video_call(d, VIDIOC_G_CTRL, &c) < 0)
		return false;
	*ret = c.value;
	return true;
}

/* Onto a value that the range has. */
static int32_t fit(const struct v4l2_queryctrl *q, double value)
{
	double step = q->step > 0 ? q->step : 1;
	double steps = rint((CLAMP(value, q->minimum, q->maximum) - q->minimum) / step);
	return (int32_t)fmin(q->minimum + steps * step, q->maximum);
}

static void stop_automatic(const struct video_device *d, struct video_controls *v)
{
	struct v4l2_queryctrl q;
	int32_t is;
	for (size_t i = 0; i < G_N_ELEMENTS(automatic); i++)
		if (find(d, automatic[i].id, &q) &&
			(!set(d, automatic[i].id, automatic[i].off, &is) ||
				is != automatic[i].off) &&
			automatic[i].remark)
			remark(v, automatic[i].remark);
}

/* What is in force; `lacking` where there is no such control. not_kept: what to say where the camera makes something else of it. */
static uint32_t lock(const struct video_device *d, struct video_controls *v, uint32_t id,
	uint32_t wanted, uint32_t lacking, const char *lacks, const char *not_kept)
{
	struct v4l2_queryctrl q;
	int32_t value, is;
	if (!find(d, id, &q)) {
		remark(v, lacks);
		return lacking;
	}
	value = fit(&q, wanted);
	if (!set(d, id, value, &is) || is < 0) {
		remark(v, not_kept);
		return lacking;
	}
	if (ABS((int64_t)is - value) > MAX(q.step, 1))
		remark(v, not_kept);
	return (uint32_t)is;
}

static uint32_t lock_gain(const struct video_device *d, struct video_controls *v, uint32_t percent)
{
	struct v4l2_queryctrl q;
	int32_t is;
	if (!find(d, V4L2_CID_GAIN, &q) && !find(d, V4L2_CID_ANALOGUE_GAIN, &q)) {
		remark(v, "has no control of its gain");
		return GAIN_MIN_PERCENT;
	}
	double range = fmax((double)q.maximum - q.minimum, 1);
	double share = ((double)percent - GAIN_MIN_PERCENT) / (GAIN_MAX_PERCENT - GAIN_MIN_PERCENT);
	int32_t value = fit(&q, q.minimum + share * range);
	if (!set(d, q.id, value, &is)) {
		remark(v, "does not tell its gain");
		return GAIN_MIN_PERCENT;
	}
	if (ABS((int64_t)is - value) > MAX(q.step, 1))
		remark(v, "does not keep its gain");
	share = CLAMP(((double)is - q.minimum) / range, 0, 1);
	return (uint32_t)lrint(GAIN_MIN_PERCENT + share * (GAIN_MAX_PERCENT - GAIN_MIN_PERCENT));
}

static void lock_focus(const struct video_device *d, struct video_controls *v)
{
	struct v4l2_queryctrl q;
	int32_t is;
	if (!find(d, V4L2_CID_FOCUS_ABSOLUTE, &q))
		return; /* most lenses are fixed */
	int32_t value = fit(&q, v->focus < 0 ? q.minimum : v->focus);
	if (!set(d, q.id, value, &is) || ABS((int64_t)is - value) > MAX(q.step, 1))
		remark(v, "does not keep its focus");
}

void video_controls_apply(const struct video_device *d, struct video_controls *v,
	const struct camera_controls *wanted, struct camera_controls *ret_in_force)
{
	stop_automatic(d, v);
	*ret_in_force = (struct camera_controls){
		.exposure_100us = lock(d, v, V4L2_CID_EXPOSURE_ABSOLUTE, wanted->exposure_100us, 0,
			"has no control of its exposure", "does not keep its exposure"),
		.gain_percent = lock_gain(d, v, wanted->gain_percent),
		.white_balance_k = lock(d, v, V4L2_CID_WHITE_BALANCE_TEMPERATURE,
			wanted->white_balance_k, 0, "has no control of its white balance",
			"does not keep its white balance"),
	};
	lock_focus(d, v);
}
