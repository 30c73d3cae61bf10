#ifndef ACQUIRE_SCIP_IDENTITY_H
#define ACQUIRE_SCIP_IDENTITY_H
/* What the replies to VV and PP say of the device. Stateless; any thread. */
#include "acquire/decoder.h"

/* What PP told; scans have no angles before. Steps count counter-clockwise. */
struct scip_parameters {
	uint32_t range_min_mm, range_max_mm, steps_per_turn, first_step, last_step, front_step,
		turns_per_minute;
};

/* text: the lines of the reply to VV, "KEY:value" joined by '\n'. Keys that are missing change
 * nothing. */
void scip_adopt_version(const char *text, struct lidar_identity *identity);

/* The reply to PP. False, nothing changed, where one of its seven numbers is missing or cannot be.
 */
bool scip_adopt_parameters(
	const char *text, struct scip_parameters *parameters, struct lidar_identity *identity);

#endif
