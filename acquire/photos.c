#include "acquire/photos.h"
#include "acquire/srgb.h"

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
	bool at_stops; /* frames count at stops alone */
	bool *taken;
	struct exposures stop; /* at which the stage stands */
	uint32_t came;         /* a bit for each of its exposures */
	bool lent, metering;
	int64_t lent_ns, metered_ns;
	struct camera_controls controls;
	double radiance_sum; /* logarithms of what a frame's percentile says, per unit of exposure
			      */
	uint32_t metered;
};

photos *photos_new(camera *c, uint32_t count, bool at_stops)
{
	photos *p = g_new0(photos, 1);
	p->camera = c;
	p->count = c ? count : 0;
	p->at_stops = at_stops;
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
		c.exposure_100us = (uint32_t)CLAMP(lrint(wanted), 1, CAMERA_THIRTIETH_100US);
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
	p->radiance_sum +=
		log(fmax(srgb_to_linear(CLAMP((level - 16.0) / 219, 0, 1)), 1e-4) / exposure);
	p->metered++;
	if (level < 230 || p->controls.exposure_100us <= 1)
		return;
	p->controls.exposure_100us = MAX(1, p->controls.exposure_100us / 3);
	p->radiance_sum = 0;
	p->metered = 0;
	p->metering = false;
}

/* The angle whose photo is to be taken hereabouts; how far past it the front is. */
static uint32_t angle_at(const photos *p, double front_rad, double *ret_past_rad)
{
	double spacing = 2 * G_PI / p->count,
	       turn = front_rad - floor(front_rad / (2 * G_PI)) * (2 * G_PI);
	uint32_t k = (uint32_t)(turn / spacing) % p->count;
	*ret_past_rad = turn - (k + 0.5) * spacing;
	return k;
}

bool photos_watch(photos *p, double front_rad, int64_t now_ns, GError **error)
{
	double past;
	if (p->lent && now_ns - p->lent_ns > SECOND_NS)
		p->lent = false; /* the frame was lost */
	if (p->count == 0 || p->at_stops || p->lent)
		return true;
	uint32_t k = angle_at(p, front_rad, &past);
	return p->taken[k] || past < -0.5 * DEGREE || past > NEAR_ENOUGH ? true
									 : lend(p, now_ns, error);
}

/* Whether all is there now that is wanted of the angle. */
static bool is_enough(photos *p, const struct camera_frame_info *info, bool locked)
{
	if (!p->at_stops)
		return locked;
	int i = exposures_find(&p->stop, &info->controls);
	if (i >= 0)
		p->came |= 1u << i;
	return i >= 0 && photos_lacks(p) < 0;
}

void photos_take(photos *p, const struct camera_frame_info *info, const uint8_t *pixels,
	double front_rad, bool locked)
{
	double past;
	p->lent = false;
	if (p->count == 0)
		return;
	if (p->metering && !locked)
		meter(p, info, pixels);
	if (!is_enough(p, info, locked))
		return;
	uint32_t k = angle_at(p, front_rad, &past);
	if (fabs(past) <= NEAR_ENOUGH + DEGREE)
		p->taken[k] = true;
}

/* ---- at stops ---- */

bool photos_try_exposures(photos *p, struct exposures *ret, GError **error)
{
	struct exposures wanted =
		exposures_around(&p->controls, camera_longest_exposure_100us(p->camera));
	*ret = (struct exposures){ 1, { p->controls } };
	for (uint32_t i = 1; i < wanted.count; i++) {
		struct camera_controls *c = &wanted.controls[i];
		if (!camera_set_controls(p->camera, c, error))
			return false;
		camera_get_controls(p->camera, c);
		exposures_add(ret, c);
	}
	return camera_set_controls(p->camera, &p->controls, error);
}

void photos_stop(photos *p, const struct exposures *e)
{
	p->stop = *e;
	p->came = 0;
	p->lent = false;
}

int photos_lacks(const photos *p)
{
	for (uint32_t i = 0; i < p->stop.count; i++)
		if (!(p->came & 1u << i))
			return (int)i;
	return -1;
}

bool photos_expose(photos *p, uint32_t exposure, int64_t now_ns, GError **error)
{
	return camera_set_controls(p->camera, &p->stop.controls[exposure], error) &&
	       lend(p, now_ns, error);
}

bool photos_is_waiting(const photos *p, int64_t now_ns)
{
	return p->lent && now_ns - p->lent_ns <= LOST_NS;
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
