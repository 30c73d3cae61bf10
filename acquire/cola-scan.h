#ifndef ACQUIRE_COLA_SCAN_H
#define ACQUIRE_COLA_SCAN_H
/* LMDscandata of SICK TiM and LMS: the telegram that carries a scan (manual 8015883, pages 22-26).
 * Its fields are walked by the counts in it, never by place, as devices differ in channels,
 * encoders and names. */
#include "acquire/cola-text.h"
#include "acquire/scanline.h"

/* Numbers of a channel below this are codes: 0 no return, 1 dazzled, others reserved. */
#define COLA_RANGE_MIN_RAW 16
#define COLA_VALUES_MAX    65536

/* Room for one scan, used again for the next; zero is empty. */
struct cola_scan {
	uint16_t *raw, *intensity,
		*other; /* as sent: of DIST1, of RSSI1, of channels that nobody asked for */
	uint32_t *range_mm;
	uint32_t size;
};

/* The cursor stands behind "LMDscandata ". False where the telegram is not whole or not right; what
 * ret then holds is undefined. ret lives in scan until the next call; arrival_ns stays for the
 * caller to set. */
bool cola_scan_parse(struct cola_scan *scan, struct cola_cursor *c, struct scanline *ret);
void cola_scan_clear(struct cola_scan *scan);

/* The device writes steps cut to 1/10000 degree: 3333 is a third of a degree, and over 811 beams
 * the difference is 0.027 degrees. Where a 24th of a degree stands behind a step, that one is
 * returned. */
double cola_true_step_deg(uint32_t step_e4);

/* The device says 90 degrees for straight ahead. */
double cola_angle_rad(int32_t angle_e4);

#endif
