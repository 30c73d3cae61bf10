#ifndef SIM_CABLE_H
#define SIM_CABLE_H
/* The cable between the lidar and the host's port: it delays what the lidar says by a minimum, an
 * exponential tail and a rare spike, never lets a later byte overtake an earlier one, and is where
 * plugs are pulled and telegrams damaged. Nothing is heard while the host has the port closed. */
#include "sim/outbox.h"
#include <stdbool.h>

struct cable_desc {
	uint64_t seed;
	double latency_ns, jitter_ns;
	gsize packet;  /* bytes that arrive together, 0 for all */
	bool absent;   /* nothing was ever plugged in */
	uint32_t baud; /* of a serial line, where bytes need their time; 0: none */
	gsize frame;   /* bytes that begin to go out together there */
};

typedef struct cable cable;
cable *cable_new(const struct cable_desc *desc, outbox *out); /* borrows the outbox */
void cable_free(cable *c);                                    /* NULL is fine */

/* The host's side. */
void cable_open(cable *c, int64_t now_ns);
void cable_close(cable *c);
bool cable_is_open(const cable *c);
/* The host's end of a serial line; 9600 baud until it is set. At another speed than the lidar's,
 * both hear garbage. */
void cable_set_line(cable *c, uint32_t baud);
bool cable_is_clear(const cable *c);

/* The lidar's side: bytes that leave it together at a moment, answers or a telegram of measurements
 * (which is what the faults strike). */
void cable_answer(cable *c, int64_t leaves_ns, const void *bytes, gsize length);
void cable_telegram(cable *c, int64_t leaves_ns, const void *bytes, gsize length);

/* Faults. */
void cable_unplug(cable *c, int64_t now_ns, double seconds);  /* now, to come back after a while */
void cable_unplug_in_telegram(cable *c, double seconds);      /* in the middle of the next one */
void cable_silence(cable *c, int64_t now_ns, double seconds); /* NAN: until it is opened anew */
void cable_garble(cable *c, uint32_t telegrams);
void cable_merge(cable *c, uint32_t telegrams);
void cable_split(cable *c, gsize bytes);
/* Since when the lidar has power again after it was last unplugged; INT64_MIN if it never was. */
int64_t cable_powered_ns(const cable *c);

#endif
