#include "sim/camera.h"
#include "sim/chance.h"
#include <math.h>
#include <string.h>

#define BUFFERS_MAX 64
#define CURVE_SIZE  4096
#define EDGE        0.2f /* contrast of neighbours that are looked at closer */
#define EDGE_RAYS   3    /* what is usual: edges between two rows are looked at, not those beside */
#define FINE_PX     400  /* focal length from which that pays */

struct exposure {
	int64_t start_ns, middle_ns, due_ns;
	struct link_frame frame;
	uint32_t rows_done;
};

struct camera {
	struct camera_setup setup;
	struct lens lens;
	struct camera_mount mount;
	double home_rad; /* azimuth of the home slot */
	struct device_clock clock;
	float *rays;                  /* unit directions in the head's frame, 3 per pixel */
	guint8 curve[CURVE_SIZE + 1]; /* linear 0..1 to sRGB 0..255 */
	float *linear;                /* the frame being drawn, RGB */
	struct link_camera_controls controls;
	uint32_t buffers;
	bool started, gone;
	int64_t first_ns; /* of exposure 0 */
	double period_ns;
	uint32_t next;            /* exposure that did not start yet */
	struct exposure *current; /* being exposed or drawn; NULL: none */
	uint32_t bad_left, lost_left;
};

static void fill_rays(camera *c)
{
	const struct camera_mount mount = c->mount;
	float *ray = c->rays;

	for (uint32_t v = 0; v < c->lens.height; v++)
		for (uint32_t u = 0; u < c->lens.width; u++, ray += 3) {
			double d[3];

			lens_ray(&c->lens, u, v, d);
			for (int k = 0; k < 3; k++)
				ray[k] = (float)(mount.rotation[0][k] * d[0] +
						 mount.rotation[1][k] * d[1] +
						 mount.rotation[2][k] * d[2]);
		}
}

static void fill_curve(camera *c)
{
	for (int i = 0; i <= CURVE_SIZE; i++) {
		double x = (double)i / CURVE_SIZE;
		double y = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;

		c->curve[i] = (guint8)lrint(255 * y);
	}
}

static double from_seed(const sim_options *o, uint64_t what, double low, double high)
{
	return low + (high - low) * chance_uniform(chance_hash(o->seed, CHANCE_CLOCK, 3, what));
}

camera *camera_new(const struct camera_setup *setup)
{
	const sim_options *o = setup->options;

	if (o->camera_width == 0)
		return NULL;
	camera *c = g_new0(camera, 1);
	gsize pixels = (gsize)o->camera_width * o->camera_height;

	c->setup = *setup;
	c->lens = lens_of(o);
	c->mount = camera_mount_of(o);
	c->home_rad = lidar_mount_of(o).home_rad;
	c->clock = (struct device_clock){ .origin_ns = setup->now_ns,
		.start_ticks = o->camera_clock_start == UINT64_MAX
				       ? (uint64_t)from_seed(o, 0, 0, 4294967296.0)
				       : o->camera_clock_start,
		.tick_ns = 1e3,
		.drift_ppm = isnan(o->camera_ppm) ? from_seed(o, 1, -50, 50) : o->camera_ppm,
		.bits = 32 };
	c->period_ns = device_clock_true_ns(&c->clock, 1e9 / o->fps);
	c->controls = (struct link_camera_controls){ 50, 100, 5500 };
	c->rays = g_new(float, 3 * pixels);
	c->linear = g_new(float, 3 * pixels);
	fill_rays(c);
	fill_curve(c);
	return c;
}

void camera_free(camera *c)
{
	if (!c)
		return;
	g_free(c->rays);
	g_free(c->linear);
	g_free(c->current);
	g_free(c);
}

const struct lens *camera_lens(const camera *c)
{
	return &c->lens;
}

bool camera_control(camera *c, const struct link_camera_controls *controls)
{
	if (controls->exposure_100us < 1 || controls->exposure_100us > 10000 ||
		controls->gain_percent < 1 || controls->gain_percent > 6400 ||
		controls->white_balance_k < 1000 || controls->white_balance_k > 20000)
		return false;
	c->controls = *controls;
	return true;
}

int64_t camera_transfer_ns(const sim_options *o)
{
	return MIN(INT64_C(30000000), (int64_t)(5e8 / o->fps));
}

static int64_t start_ns(const camera *c, uint32_t exposure)
{
	return c->first_ns + llrint(c->period_ns * exposure);
}

/* Exposures that had no buffer went by unseen. */
static void catch_up(camera *c, int64_t now_ns)
{
	double late = ((double)(now_ns - c->first_ns)) / c->period_ns;

	if (late > c->next)
		c->next = (uint32_t)ceil(late);
}

void camera_lend(camera *c, int64_t now_ns)
{
	if (c->gone) {
		outbox_push(c->setup.out, now_ns, LINK_CAMERA_GONE, NULL);
		return;
	}
	if (!c->started) {
		c->started = true;
		c->first_ns =
			now_ns + llrint(c->period_ns * from_seed(c->setup.options, 2, 0.1, 1));
	}
	if (c->buffers == 0)
		catch_up(c, now_ns);
	c->buffers = MIN(c->buffers + 1, BUFFERS_MAX);
}

int64_t camera_next_ns(const camera *c)
{
	bool real_time = c->setup.options->speed > 0;

	/* In real time nobody waits for a frame that is still being drawn. */
	if (c->current && real_time && c->current->rows_done < c->lens.height)
		return INT64_MAX;
	if (c->current)
		return c->current->due_ns;
	return c->buffers > 0 && !c->gone ? start_ns(c, c->next) : INT64_MAX;
}

void camera_strike(camera *c, int64_t now_ns, const struct fault *fault)
{
	switch (fault->kind) {
	case FAULT_BADFRAME: c->bad_left = fault->count; break;
	case FAULT_FRAMELOSS: c->lost_left = (uint32_t)fault->param; break;
	case FAULT_CAMERAGONE:
		c->gone = true;
		outbox_push(c->setup.out, now_ns, LINK_CAMERA_GONE, NULL);
		break;
	default: g_assert_not_reached();
	}
}

static void start_exposure(camera *c)
{
	int64_t at_ns = start_ns(c, c->next);
	int64_t exposure_ns = (int64_t)c->controls.exposure_100us * 100000;

	c->current = g_new0(struct exposure, 1);
	*c->current = (struct exposure){ .start_ns = at_ns,
		.middle_ns = at_ns + exposure_ns / 2,
		.due_ns = at_ns + exposure_ns + camera_transfer_ns(c->setup.options),
		.frame = { .ticks_us = device_clock_ticks(&c->clock, at_ns),
			.sequence = c->next,
			.flags = c->bad_left > 0 ? LINK_FRAME_ERROR : 0,
			.width = c->lens.width,
			.height = c->lens.height,
			.exposure_100us = c->controls.exposure_100us,
			.gain_percent = c->controls.gain_percent,
			.white_balance_k = c->controls.white_balance_k } };
	c->bad_left -= c->bad_left > 0;
	c->buffers--;
}

/* Head to world at the middle of the exposure: turned by the stage, then as the tripod stands. */
static void pose(const camera *c, double ret_rotation[3][3], double ret_origin_m[3])
{
	const struct world_station *station = &c->setup.station;
	const struct camera_mount mount = c->mount;
	double azimuth = stage_azimuth_rad(c->setup.stage, c->current->middle_ns, 0) + c->home_rad;
	double sine = sin(azimuth), cosine = cos(azimuth);
	double turn[3][3] = { { cosine, sine, 0 }, { -sine, cosine, 0 }, { 0, 0, 1 } };

	for (int i = 0; i < 3; i++) {
		ret_origin_m[i] = station->position_m[i];
		for (int j = 0; j < 3; j++) {
			ret_rotation[i][j] = 0;
			for (int k = 0; k < 3; k++)
				ret_rotation[i][j] += station->rotation[i][k] * turn[k][j];
			ret_origin_m[i] += ret_rotation[i][j] * mount.translation_m[j];
		}
	}
}

/* Sensor noise: shot noise and a floor, from four draws of sixteen bits whose sum is nearly normal.
 */
static float sensor_noise(const camera *c, gsize pixel, float level)
{
	uint64_t h = chance_hash(
		c->setup.options->seed, CHANCE_PIXEL, c->current->frame.sequence, pixel);
	float sum = (float)((h & 0xffff) + (h >> 16 & 0xffff) + (h >> 32 & 0xffff) + (h >> 48)) /
		    65535.0f;

	return (sum - 2) * 1.732f * sqrtf(2e-5f * fmaxf(level, 0) + 4e-7f);
}

struct view {
	double rotation[3][3], origin_m[3];
};

/* Pixels that are looked at together. */
#define TOGETHER 8

struct look {
	gsize pixel[TOGETHER];
	unsigned count;
	float light[3 * TOGETHER]; /* RGB of each, once looked at */
};

static void direction_of(
	const camera *c, const struct view *view, gsize pixel, const float spot[2], double ret[3])
{
	const float *ray = c->rays + 3 * pixel;
	gsize u = pixel % c->lens.width, v = pixel / c->lens.width;
	const float *right = u + 1 < c->lens.width ? ray + 3 : ray;
	const float *below = v + 1 < c->lens.height ? ray + 3 * c->lens.width : ray;
	double head[3];

	for (int k = 0; k < 3; k++)
		head[k] = ray[k] + spot[0] * (right[k] - ray[k]) + spot[1] * (below[k] - ray[k]);
	for (int k = 0; k < 3; k++)
		ret[k] = view->rotation[k][0] * head[0] + view->rotation[k][1] * head[1] +
			 view->rotation[k][2] * head[2];
}

/* Light at pixels, off their middles by shares of them. */
static void look(const camera *c, const struct view *view, const float spot[2], struct look *l)
{
	double direction[3 * TOGETHER];

	for (unsigned i = 0; i < l->count; i++)
		direction_of(c, view, l->pixel[i], spot, direction + 3 * i);
	world_radiance(c->setup.world, view->origin_m, direction, l->count, l->light);
}

static bool differs(const float *a, const float *b)
{
	return fabsf(a[1] - b[1]) > 0.06f + EDGE * (a[1] + b[1]);
}

static const float middle[2] = { 0, 0 };

/* Edges between these two rows and the next: they are other pairs', so their rays are cast again. */
static void look_beside(const camera *c, const struct view *view, uint32_t v, bool *edge)
{
	uint32_t width = c->lens.width;
	const float *rgb = c->linear + 3 * (gsize)v * width;

	for (int below = 0; below < 2; below++) {
		if (below ? v + 2 >= c->lens.height : v == 0)
			continue;
		for (uint32_t u = 0; u < width; u += TOGETHER) {
			struct look beside = { .count = MIN(TOGETHER, width - u) };

			for (unsigned i = 0; i < beside.count; i++)
				beside.pixel[i] = (gsize)(below ? v + 2 : v - 1) * width + u + i;
			look(c, view, middle, &beside);
			for (unsigned i = 0; i < beside.count; i++) {
				uint32_t here = below * width + u + i;

				edge[here] |= differs(rgb + 3 * here, beside.light + 3 * i);
			}
		}
	}
}

/* Where in a pixel its nth ray goes: by the plastic number, evenly however many there are. */
static void spot_of(uint32_t n, float ret[2])
{
	static const float first[][2] = { { 0, 0 }, { 0.33f, -0.25f }, { -0.33f, 0.25f } };

	for (int k = 0; k < 2; k++)
		ret[k] =
			n < 3 ? first[n][k]
			      : (float)(fmod(0.5 + n * (k ? 0.5698402910 : 0.7548776662), 1) - 0.5);
}

/* Gives pixels, which were looked at once, the mean of all their rays. */
static void look_closer(const camera *c, const struct view *view, struct look *l)
{
	uint32_t rays = (uint32_t)c->setup.options->edge_rays;

	for (uint32_t n = 1; n < rays; n++) {
		float spot[2];

		spot_of(n, spot);
		look(c, view, spot, l);
		for (unsigned i = 0; i < l->count; i++)
			for (int k = 0; k < 3; k++)
				c->linear[3 * l->pixel[i] + k] += l->light[3 * i + k];
	}
	for (unsigned i = 0; i < l->count; i++)
		for (int k = 0; k < 3; k++)
			c->linear[3 * l->pixel[i] + k] /= (float)rays;
	l->count = 0;
}

/* Rails, bars and leaves are finer than a pixel: where neighbours differ more rays are cast.
 * Pixels that are coarse anyway keep to one. */
static void refine(const camera *c, const struct view *view, uint32_t v)
{
	uint32_t width = c->lens.width;
	const float *rgb = c->linear + 3 * (gsize)v * width;
	g_autofree bool *edge = g_new0(bool, 2 * width);
	struct look l = { .count = 0 };

	for (uint32_t i = 0; i < 2 * width; i++) {
		const float *here = rgb + 3 * i, *across = here + 3 * width;

		if (i % width && differs(here, here - 3))
			edge[i] = edge[i - 1] = true;
		if (i < width && differs(here, across))
			edge[i] = edge[i + width] = true;
	}
	if (c->setup.options->edge_rays > EDGE_RAYS)
		look_beside(c, view, v, edge);
	/* column by column, so that what is looked at together lies together */
	for (uint32_t i = 0; i < 2 * width; i++) {
		uint32_t here = i / 2 + i % 2 * width;

		if (edge[here])
			l.pixel[l.count++] = (gsize)v * width + here;
		if (l.count == TOGETHER)
			look_closer(c, view, &l);
	}
	look_closer(c, view, &l);
}

static void expose_row(camera *c, uint32_t v)
{
	const struct link_frame *f = &c->current->frame;
	float exposure = (float)(f->exposure_100us / 50.0 * f->gain_percent / 100.0);
	float warmth = sqrtf((float)f->white_balance_k / 5500);
	const float gain[3] = { exposure * warmth, exposure, exposure / warmth };

	for (uint32_t u = 0; u < f->width; u++) {
		gsize pixel = (gsize)v * f->width + u;
		float *rgb = c->linear + 3 * pixel;
		float noise = sensor_noise(c, pixel, rgb[1] * gain[1]);

		for (int k = 0; k < 3; k++)
			rgb[k] = rgb[k] * gain[k] + noise;
	}
}

/* Sizes are even, so rows go in pairs: what is looked at together is four pixels wide and two high. */
static void draw_pair(camera *c, const struct view *view, uint32_t v)
{
	uint32_t width = c->lens.width;

	for (uint32_t u = 0; u < width; u += TOGETHER / 2) {
		struct look l = { .count = 2 * MIN(TOGETHER / 2, width - u) };

		for (unsigned i = 0; i < l.count; i++)
			l.pixel[i] = (gsize)(v + i % 2) * width + u + i / 2;
		look(c, view, middle, &l);
		for (unsigned i = 0; i < l.count; i++)
			memcpy(c->linear + 3 * l.pixel[i], l.light + 3 * i, 3 * sizeof(float));
	}
	if (c->lens.focal_px > FINE_PX || c->setup.options->edge_rays > EDGE_RAYS)
		refine(c, view, v);
	expose_row(c, v);
	expose_row(c, v + 1);
}

static void draw(camera *c, uint32_t rows)
{
	uint32_t from = c->current->rows_done, to = MIN(from + rows, c->lens.height);
	bool threaded = c->setup.options->speed == 0;
	struct view view;

	pose(c, view.rotation, view.origin_m);
#pragma omp parallel for schedule(dynamic, 2) if (threaded)
	for (uint32_t v = from; v < to; v += 2)
		draw_pair(c, &view, v);
	c->current->rows_done = to;
}

static void encode(const camera *c, guint8 *nv12)
{
	uint32_t width = c->lens.width, height = c->lens.height;
	guint8 *chroma = nv12 + (gsize)width * height;

	for (uint32_t v = 0; v < height; v += 2)
		for (uint32_t u = 0; u < width; u += 2) {
			int sum[3] = { 0 };

			for (int corner = 0; corner < 4; corner++) {
				gsize pixel = (gsize)(v + corner / 2) * width + u + corner % 2;
				int rgb[3];

				for (int k = 0; k < 3; k++) {
					float x = CLAMP(c->linear[3 * pixel + k], 0.0f, 1.0f);

					rgb[k] = c->curve[(int)(x * CURVE_SIZE + 0.5f)];
					sum[k] += rgb[k];
				}
				nv12[pixel] = (guint8)(16 + ((16829 * rgb[0] + 33039 * rgb[1] +
								     6416 * rgb[2] + 32768) >>
								    16));
			}
			/* Sums of four: two bits more to shift away. */
			*chroma++ = (guint8)(128 + ((-9714 * sum[0] - 19070 * sum[1] +
							    28784 * sum[2] + 131072) >>
							   18));
			*chroma++ = (guint8)(128 + ((28784 * sum[0] - 24103 * sum[1] -
							    4681 * sum[2] + 131072) >>
							   18));
		}
}

/* What a broken transfer leaves: the lower part shifted sideways and a band without data. */
static void damage(const camera *c, guint8 *nv12)
{
	uint32_t width = c->lens.width, height = c->lens.height;
	guint8 *from = nv12 + (gsize)width * (height / 3);

	memmove(from, from + width / 3, (gsize)width * (height / 2));
	memset(nv12 + (gsize)width * (height * 3 / 4), 0, (gsize)width * (height / 8));
}

static void deliver(camera *c, int64_t now_ns)
{
	struct exposure *e = c->current;
	gsize pixels = (gsize)c->lens.width * c->lens.height;
	GByteArray *payload = g_byte_array_new();

	draw(c, c->lens.height);
	g_byte_array_append(payload, (const guint8 *)&e->frame, sizeof e->frame);
	g_byte_array_set_size(payload, (guint)(sizeof e->frame + pixels * 3 / 2));
	encode(c, payload->data + sizeof e->frame);
	if (e->frame.flags & LINK_FRAME_ERROR)
		damage(c, payload->data + sizeof e->frame);
	outbox_push(c->setup.out, now_ns, LINK_CAMERA_FRAME, payload);
}

void camera_run(camera *c, int64_t now_ns)
{
	if (c->current) {
		if (!c->gone)
			deliver(c, now_ns);
		g_clear_pointer(&c->current, g_free);
		catch_up(c, now_ns);
		return;
	}
	if (c->lost_left > 0)
		c->lost_left--;
	else if (!c->gone)
		start_exposure(c);
	c->next++;
}

bool camera_prepare(camera *c, int64_t now_ns, uint32_t rows)
{
	if (!c->current || now_ns < c->current->middle_ns ||
		c->current->rows_done >= c->lens.height)
		return false;
	draw(c, rows);
	return true;
}
