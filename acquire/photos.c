#include "acquire/photos.h"
#include <math.h>

#define SECOND_NS INT64_C(1000000000)
#define DEGREE    (G_PI / 180)
/* A photo serves a wanted angle when it was taken this near. */
#define NEAR_ENOUGH (4 * DEGREE)
/* Frames for metering: one each this often. */
#define METER_EVERY_NS (SECOND_NS)
/* A frame that has not come by then was lost. */
#define LOST_NS (3 * SECOND_NS)
/* The brightest sixth of what is not sky may come close to white. */
#define METER_PERCENTILE 0.85
#define METER_TARGET     0.62 /* of full scale, linear */

struct photos {
	camera *camera;
	uint32_t count;
	bool *taken;
	bool lent, metering;
	int64_t lent_ns, metered_ns;
	struct camera_controls controls;
	double radiance_sum; /* logarithms of what a frame's percentile says, per unit of exposure
			      */
	uint32_t metered;
};

photos *photos_new(camera *c, uint32_t count)
{
	photos *p = g_new0(photos, 1);
	p->camera = c;
	p->count = c ? count : 0;
	p->taken = g_new0(bool, p->count + 1);
	p->controls = (struct camera_controls){
		.exposure_100us = 50, .gain_percent = 100, .white_balance_k = 5500
	};
	return p;
}

void photos_free(photos *p)
{
	if (!p)
		return;
	g_free(p->taken);
	g_free(p);
}

static bool lend(photos *p, int64_t now_ns, GError **error)
{
	p->lent = true;
	p->lent_ns = now_ns;
	return camera_queue(p->camera, error);
}

bool photos_meter(photos *p, int64_t now_ns, GError **error)
{
	if (p->lent && now_ns - p->lent_ns > LOST_NS)
		p->lent = false;
	if (p->count == 0 || p->lent || (p->metered && now_ns - p->metered_ns < METER_EVERY_NS))
		return true;
	if (!p->metering && !camera_set_controls(p->camera, &p->controls, error))
		return false;
	p->metering = true;
	p->metered_ns = now_ns;
	return lend(p, now_ns, error);
}

bool photos_use_controls(photos *p, const struct camera_controls *controls, GError **error)
{
	p->metering = false;
	p->controls = *controls;
	if (p->count == 0)
		return true;
	if (!camera_set_controls(p->camera, controls, error))
		return false;
	/* Photos are known by the controls that they were taken with. */
	camera_get_controls(p->camera, &p->controls);
	return true;
}

bool photos_settle_exposure(photos *p, GError **error)
{
	struct camera_controls c = p->controls;
	if (p->metered) {
		double wanted = METER_TARGET / exp(p->radiance_sum / p->metered);
		c.exposure_100us = (uint32_t)CLAMP(lrint(wanted), 1, 330);
		/* Beyond a thirtieth of a second the stage would blur it: gain has to do the rest.
		 */
		c.gain_percent = (uint32_t)CLAMP(lrint(100 * wanted / c.exposure_100us), 100, 1600);
	}
	p->lent = false;
	return photos_use_controls(p, &c, error);
}

struct camera_controls photos_controls(const photos *p)
{
	return p->controls;
}

static double linear(double luma)
{
	double v = CLAMP((luma - 16) / 219, 0.0, 1.0);
	return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

/* A frame that is blown out says only "at least"; the next one is taken darker. */
static void meter(photos *p, const struct camera_frame_info *info, const uint8_t *pixels)
{
	if (info->controls.exposure_100us == 0)
		return; /* it exposes as it likes: nothing follows from how bright the frame is */
	uint32_t histogram[256] = { 0 }, n = info->width * info->height, below = 0, level = 0;
	for (uint32_t i = 0; i < n; i++)
		histogram[pixels[i]]++;
	for (; level < 255 && below + histogram[level] < METER_PERCENTILE * n; level++)
		below += histogram[level];
	double exposure = info->controls.exposure_100us * (info->controls.gain_percent / 100.0);
	p->radiance_sum += log(fmax(linear(level), 1e-4) / exposure);
	p->metered++;
	if (level < 230 || p->controls.exposure_100us <= 1)
		return;
	p->controls.exposure_100us = MAX(1, p->controls.exposure_100us / 3);
	p->radiance_sum = 0;
	p->metered = 0;
	p->metering = false;
}

bool photos_watch(photos *p, double front_rad, int64_t now_ns, GError **error)
{
	double spacing = 2 * G_PI / p->count;
	if (p->lent && now_ns - p->lent_ns > SECOND_NS)
		p->lent = false; /* the frame was lost */
	if (p->count == 0 || p->lent)
		return true;
	double turn = front_rad - floor(front_rad / (2 * G_PI)) * (2 * G_PI);
	uint32_t k = (uint32_t)(turn / spacing) % p->count;
	double past = turn - (k + 0.5) * spacing;
	return p->taken[k] || past < -0.5 * DEGREE || past > NEAR_ENOUGH ? true
									 : lend(p, now_ns, error);
}

void photos_take(photos *p, const struct camera_frame_info *info, const uint8_t *pixels,
	double front_rad, bool locked)
{
	p->lent = false;
	if (p->count == 0)
		return;
	if (p->metering && !locked)
		meter(p, info, pixels);
	if (!locked)
		return;
	double spacing = 2 * G_PI / p->count;
	double turn = front_rad - floor(front_rad / (2 * G_PI)) * (2 * G_PI);
	uint32_t k = (uint32_t)(turn / spacing) % p->count;
	if (fabs(turn - (k + 0.5) * spacing) <= NEAR_ENOUGH + DEGREE)
		p->taken[k] = true;
}

uint32_t photos_wanted(const photos *p)
{
	return p->count;
}

uint32_t photos_taken(const photos *p)
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < p->count; i++)
		n += p->taken[i];
	return n;
}

bool photos_next(const photos *p, double from_rad, double *ret_rad)
{
	for (uint32_t i = 0; i < p->count; i++) {
		*ret_rad = (i + 0.5) * 2 * G_PI / p->count;
		if (!p->taken[i] && *ret_rad >= from_rad)
			return true;
	}
	return false;
}
