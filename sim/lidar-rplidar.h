#ifndef SIM_LIDAR_RPLIDAR_H
#define SIM_LIDAR_RPLIDAR_H
/* An RPLIDAR of Slamtec's A, C or S series. It answers 0.5 ms after a request whose sum is right and
 * falls silent at any while it measures but STOP and RESET. Scan mode 0 is the standard one, mode 1
 * that of its make (or of the option format=), which it calls typical. Measurements begin a second
 * after its motor is told to turn: by DTR (A1), SET_MOTOR_PWM (A2, A3) or HQ_MOTOR_SPEED (C, S),
 * which C and S do by themselves too. After a fault of the hardware it is silent, and its health is
 * 2, until it is reset; with the option health=2 for good. */
#include "sim/lidar.h"

extern const struct lidar_protocol lidar_rplidar;

#endif
