#ifndef SIM_COLA_TELEGRAM_H
#define SIM_COLA_TELEGRAM_H
/* The telegram LMDscandata in CoLa-A, word by word as captured from TiM5xx devices. */
#include "sim/lidar.h"

#define COLA_START (-450000) /* of the sweep, in 1/10000 degree of the sensor's angle */
#define COLA_STOP  2250000

/* LMDscandatacfg, in the order of its words. */
struct cola_output {
	int64_t low_channels, high_channels;
	int64_t remission, wide, unit;
	int64_t low_encoders, high_encoders;
	int64_t position, name, comment, time, every;
};

struct cola_telegram {
	const struct lidar_body *body;
	const struct cola_output *output;
	int64_t range_start, range_stop; /* 1/10000 degree */
	bool broken;
	uint16_t telegram_counter, scan_counter;
	int64_t leaves_ns;
};

/* Appends the telegram, which begins with the word sRA or sSN, without its frame. */
void cola_append_telegram(GString *out, const char *word, const struct cola_telegram *telegram,
	const struct beam_fan *fan);
/* Between beams, in whole 1/10000 degree as the device says it: one third becomes 3333. */
int cola_step_angle(const struct lidar_body *body);

#endif
