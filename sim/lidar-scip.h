#ifndef SIM_LIDAR_SCIP_H
#define SIM_LIDAR_SCIP_H
/* A lidar that speaks SCIP 2.0, of the kind of Hokuyo's UTM-30LX but with a range of 200 m and as
 * many steps as asked: 270 degrees, AMIN 0, AFRT = 3/8 ARES, AMAX = 3/4 ARES, DMIN 23 mm. One echo
 * per step: HD, HE, ND and NE are refused as unknown commands (status 0E).
 *
 * Answers leave 0.3 ms after their command. A scan leaves 1 ms after its last beam; its stamp is
 * the instant of step 0 of its sweep, in whole ms of a clock of 24 bits, whatever the steps asked
 * for. A count limits a stream, then the laser stays on. Distances below DMIN are codes: 0 nothing
 * there, 1 too faint, 19 the beam was mirrored away.
 *
 * Of its errors: status 50 and silence after a fault of the hardware, until RS, RT or RB; II then
 * says so in STAT. */
#include "sim/lidar.h"

extern const struct lidar_protocol lidar_scip;

#endif
