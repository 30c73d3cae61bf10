#ifndef SIM_CAMERA_H
#define SIM_CAMERA_H
/* The camera on the head: portrait, 95 degrees from top to bottom, pitched up by 5, a few
 * centimetres above and before the lidar's centre, turned with the stage. Exposures start on the
 * beat of its own clock; one that finds a buffer lent is drawn as the world looks at its middle (no
 * motion blur, no rolling shutter) and comes 30 ms (half a beat at most) after its end. Exposures
 * are numbered from the first buffer lent.
 *
 * A pixel is the radiance times exposure / 5 ms times gain, tinted by the white balance (5500 K is
 * neutral), with the noise of a sensor, through the sRGB curve: 1.0 (a white wall in full sun) just
 * reaches white at 5 ms and gain 100 %. */
#include "sim/clock.h"
#include "sim/fault.h"
#include "sim/mount.h"
#include "sim/options.h"
#include "sim/outbox.h"
#include "sim/stage.h"
#include "sim/world.h"

struct camera_setup {
	const sim_options *options;
	const world *world;
	struct world_station station;
	const stage *stage;
	outbox *out;
	int64_t now_ns;
};

typedef struct camera camera;
/* NULL when the options want none. */
camera *camera_new(const struct camera_setup *setup);
void camera_free(camera *c); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(camera, camera_free)

const struct lens *camera_lens(const camera *c);
bool camera_control(
	camera *c, const struct link_camera_controls *controls); /* false: out of range */
/* From the end of an exposure to the arrival of its frame. */
int64_t camera_transfer_ns(const sim_options *o);
void camera_lend(camera *c, int64_t now_ns);

/* When an exposure starts that finds a buffer, or a frame is due; INT64_MAX otherwise. In real time
 * a frame is due when it is drawn, which camera_prepare() must do; else camera_run() draws it at
 * the due time. */
int64_t camera_next_ns(const camera *c);
void camera_strike(
	camera *c, int64_t now_ns, const struct fault *fault); /* one of the camera's faults */
void camera_run(camera *c, int64_t now_ns);
/* Draws ahead some rows, an even number, of a frame whose exposure is over; false if there is
 * nothing to draw. */
bool camera_prepare(camera *c, int64_t now_ns, uint32_t rows);

#endif
