#ifndef SIM_LIDAR_LD_H
#define SIM_LIDAR_LD_H
/* A lidar of LDRobot: LD06, LD19 or STL-27L. It turns and speaks as long as it has power, in packets
 * of twelve measurements, and listens to nothing. Intensity is 200 for white at 6 m. After a fault
 * of the hardware it is silent until its port is opened anew. */
#include "sim/lidar.h"

extern const struct lidar_protocol lidar_ld;

#endif
