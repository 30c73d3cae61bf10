#ifndef SIM_LIDAR_H
#define SIM_LIDAR_H
/* The simulated lidar: a motor that turns, a laser that measures along the fan of beams, a clock,
 * and a protocol that tells of it over a cable. What differs between makes stands in a struct
 * lidar_protocol, one file each.
 *
 * A protocol speaks of time in its own clock and of revolutions by number; it is asked once per
 * revolution, at the instant of the last beam, whether it sends it. Lidars on a serial line measure
 * at their own beat, all round, and send a few measurements at a time. */
#include "sim/beam.h"
#include "sim/cable.h"
#include "sim/clock.h"
#include "sim/fault.h"
#include "sim/head.h"
#include "sim/mirror.h"
#include "sim/options.h"
#include "sim/stage.h"

/* What a protocol knows and may use. */
struct lidar_body {
	const sim_options *options;
	cable *cable;
	struct device_clock clock;
	struct mirror mirror;
	uint32_t revolution_at_power_on;
	/* Of serial lidars, which send portions of a turn and count those as revolutions. The encoder
	 * goes clockwise from straight ahead. */
	double turn_ns;        /* true time of a turn, on average */
	double *encoder_turns; /* of each beam of the portion, whole turns too */
	double *turned_rad;    /* of each, back against it */
	double reboot_s; /* set by the protocol to go away for so long, once its answer is out */
};

struct lidar_protocol {
	const char *name;
	double nominal_tick_ns; /* of the device's clock */
	unsigned clock_bits;
	gpointer (*create)(struct lidar_body *body);
	void (*destroy)(gpointer self);
	void (*power_on)(gpointer self); /* all settings as from the factory */
	void (*receive)(gpointer self, int64_t now_ns, const guint8 *bytes, gsize length);
	bool (*is_waiting)(gpointer self);   /* somebody waits for measurements */
	bool (*is_streaming)(gpointer self); /* and not just for one */
	bool (*wants)(gpointer self, uint32_t revolution);
	void (*send)(gpointer self, const struct beam_fan *fan, int64_t now_ns);
	void (*skip)(
		gpointer self, uint32_t revolution);  /* measured, but lost before it was sent */
	void (*fail)(gpointer self, int64_t now_ns);  /* the hardware breaks */
	void (*jump)(gpointer self, uint32_t counts); /* the scan counter goes wrong */
	/* Of serial lidars, which may be NULL: */
	void (*set_dtr)(gpointer self, int64_t now_ns, bool asserted);
	/* How far a beam that reads this range is turned back against the encoder. */
	double (*turned_rad)(gpointer self, double range_m);
};

struct lidar_setup {
	const sim_options *options;
	const world *world;
	struct world_station station;
	const stage *stage;
	outbox *out;
	sim_truth_func truth; /* may be NULL */
	gpointer truth_data;
	int64_t settle_ns; /* lidar_next_ns() is so much later than the end of the revolution */
	int64_t now_ns;
};

typedef struct lidar lidar;
lidar *lidar_new(const struct lidar_setup *setup); /* borrows all it points to */
void lidar_free(lidar *l);                         /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(lidar, lidar_free)

void lidar_open(lidar *l, int64_t now_ns);
void lidar_close(lidar *l);
void lidar_set_line(lidar *l, int64_t now_ns, const struct link_line *line);
void lidar_write(lidar *l, int64_t now_ns, const guint8 *bytes, gsize length);

/* When the next revolution ends that somebody waits for, or INT64_MAX; lidar_run() then measures
 * and sends it. */
int64_t lidar_next_ns(const lidar *l);
/* True while streaming; then the front went from one azimuth to another since the revolution
 * before. */
bool lidar_passes(const lidar *l, double *ret_from_rad, double *ret_to_rad);
void lidar_strike(
	lidar *l, int64_t now_ns, const struct fault *fault); /* one of the lidar's faults */
void lidar_run(lidar *l, int64_t now_ns);
/* Measures ahead what of the current revolution lies in the past, at most so many beams; false if
 * there was nothing. */
bool lidar_prepare(lidar *l, int64_t now_ns, uint32_t beams);

#endif
