#include "sim/lidar-make.h"
#include <glib.h>
#include <math.h>
#include <string.h>

#define TOGETHER_US 4000
#define LINE_SHARE  0.92 /* that measurements may fill */

static const struct lidar_make makes[] = {
	{ "scip", "scip", 40, 200 },
	{ "cola", "cola", 15, 65 },
	{ "none", "scip", 40, 200, .absent = true },
	{ "ld06", "ld", 10, 12, 230400, 1e6 / 4500 },
	{ "ld19", "ld", 10, 12, 230400, 1e6 / 4500 },
	{ "stl27l", "ld", 10, 25, 921600, 1e6 / 21600 },
	{ "rplidar-a1", "rplidar", 5.5, 12, 115200, 127, SIM_ULTRA, 0x18, SIM_MOTOR_DTR },
	{ "rplidar-a2", "rplidar", 10, 12, 115200, 250, SIM_EXPRESS, 0x28, SIM_MOTOR_PWM },
	{ "rplidar-a3", "rplidar", 10, 25, 256000, 62.5, SIM_ULTRA, 0x31, SIM_MOTOR_PWM },
	{ "rplidar-c1", "rplidar", 10, 12, 460800, 200, SIM_DENSE, 0x41, SIM_MOTOR_RPM },
	{ "rplidar-s1", "rplidar", 10, 40, 256000, 108.5, SIM_DENSE, 0x61, SIM_MOTOR_RPM },
	{ "rplidar-s2", "rplidar", 10, 30, 1000000, 31.25, SIM_DENSE, 0x71, SIM_MOTOR_RPM },
	{ "rplidar-s3", "rplidar", 10, 40, 1000000, 31.25, SIM_ULTRA_DENSE, 0x81, SIM_MOTOR_RPM },
};

const struct lidar_make *lidar_make_find(const char *name)
{
	for (gsize i = 0; i < G_N_ELEMENTS(makes); i++)
		if (strcmp(makes[i].name, name) == 0)
			return &makes[i];
	return NULL;
}

static const struct {
	uint16_t bytes, samples;
} frames[SIM_FORMATS] = {
	[SIM_AS_MADE] = { 47, 12 }, /* of ld */
	[SIM_STANDARD] = { 5, 1 },
	[SIM_EXPRESS] = { 84, 32 },
	[SIM_ULTRA] = { 132, 96 },
	[SIM_DENSE] = { 84, 40 },
	[SIM_ULTRA_DENSE] = { 170, 64 },
	[SIM_HQ] = { 781, 96 },
};

static enum sim_format frame_of(const struct lidar_make *make, enum sim_format format)
{
	return strcmp(make->protocol, "ld") == 0 ? SIM_AS_MADE : format;
}

uint32_t lidar_frame_bytes(const struct lidar_make *make, enum sim_format format)
{
	return frames[frame_of(make, format)].bytes;
}

uint32_t lidar_frame_samples(const struct lidar_make *make, enum sim_format format)
{
	return frames[frame_of(make, format)].samples;
}

void lidar_make_portion(const struct lidar_make *make, enum sim_format format, uint32_t baud,
	double *ret_sample_us, uint32_t *ret_portion)
{
	uint32_t samples = lidar_frame_samples(make, format);
	double line_us = lidar_frame_bytes(make, format) * 10e6 / baud / samples / LINE_SHARE;
	double beat_us = frame_of(make, format) != SIM_AS_MADE && line_us > make->sample_us
				 ? ceil(line_us * 4) / 4
				 : make->sample_us;

	*ret_sample_us = beat_us;
	*ret_portion = samples * (uint32_t)ceil(TOGETHER_US / (samples * beat_us));
}
