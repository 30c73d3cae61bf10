#ifndef SIM_LIDAR_COLA_H
#define SIM_LIDAR_COLA_H
/* A lidar that speaks SICK's CoLa-A, of the kind of a TiM571: 270 degrees, sensor angles -45 to 225
 * degrees, 90 straight ahead, frames of 02 ... 03, no sums. Shapes follow captured telegrams of
 * TiM551 and TiM561.
 *
 * An answer leaves 1.5 ms after its command; a command that comes before that is refused with sFA
 * D. A telegram leaves about 4 ms after its last beam, which is the instant of "time since
 * start-up"; "time of transmission" is when it leaves, both in us of a clock of 32 bits. DIST1 is
 * in mm, 0 nothing there, 1 too faint, 2 mirrored away; with a limit_m above 65 the scale factor is
 * 2 (and 4 above 131). RSSI1 has 8 or 16 bits, as LMDscandatacfg says.
 *
 * Writing and methods but Run, SetAccessMode, LMCstartmeas and LMCstopmeas need a login. mSCreboot
 * takes the device away for 8 s. After a fault of the hardware telegrams carry the device status 0
 * 1 and SCdevicestate is 2 until a reboot. */
#include "sim/lidar.h"

extern const struct lidar_protocol lidar_cola;

#endif
