#ifndef ACQUIRE_RPLIDAR_FRAMES_H
#define ACQUIRE_RPLIDAR_FRAMES_H
/* What Slamtec's RPLIDARs send (DEVICES 2.4): descriptors that say what follows, and six kinds of
 * frames with measurements, all little-endian. Stateless; any thread. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RPLIDAR_DESCRIPTOR_BYTES 7
#define RPLIDAR_REPLY_BYTES_MAX  256
#define RPLIDAR_NODE_BYTES       5
#define RPLIDAR_FRAME_BYTES_MAX  781
#define RPLIDAR_SAMPLES_MAX      96
#define RPLIDAR_TURN_Q6          (360 * 64)

enum rplidar_format {
	RPLIDAR_STANDARD,    /* 81: a node a measurement */
	RPLIDAR_EXPRESS,     /* 82: capsules, which need the next one's first angle */
	RPLIDAR_ULTRA,       /* 84: also the next one's first distance */
	RPLIDAR_DENSE,       /* 85 */
	RPLIDAR_ULTRA_DENSE, /* 86 */
	RPLIDAR_HQ,          /* 83: nodes with angles of their own again, 96 together */
	RPLIDAR_FORMATS,
};

struct rplidar_descriptor {
	uint8_t type;
	uint32_t length;
	bool loops; /* measurements, of this format, until they are stopped */
	enum rplidar_format format;
};

/* bytes has RPLIDAR_DESCRIPTOR_BYTES. Only what a device may say is one. */
bool rplidar_is_descriptor(const uint8_t *bytes, struct rplidar_descriptor *ret);

uint8_t rplidar_answer_type(enum rplidar_format format);
size_t rplidar_frame_bytes(enum rplidar_format format);
uint32_t rplidar_frame_samples(enum rplidar_format format);

/* The two check bits are right; there is no sum. */
static inline bool rplidar_is_node(const uint8_t *at)
{
	return ((at[0] ^ at[0] >> 1) & 1) && (at[1] & 1);
}

/* bytes has rplidar_frame_bytes(): begins as it should, and the sum is right. */
bool rplidar_is_frame(enum rplidar_format format, const uint8_t *bytes);
/* It is not all one byte over and over, which sums of a few bits may take for a frame. */
bool rplidar_has_content(enum rplidar_format format, const uint8_t *bytes);

/* Of capsules. */
uint32_t rplidar_start_q6(enum rplidar_format format, const uint8_t *bytes);
bool rplidar_begins_anew(enum rplidar_format format, const uint8_t *bytes);
/* Of ultra-dense capsules and of HQ, microseconds; others have none. */
bool rplidar_stamp_us(enum rplidar_format format, const uint8_t *bytes, uint64_t *ret);

struct rplidar_samples {
	float clockwise_rad[RPLIDAR_SAMPLES_MAX];
	uint32_t range_mm[RPLIDAR_SAMPLES_MAX];
	uint16_t intensity[RPLIDAR_SAMPLES_MAX];
	uint32_t count;
	bool has_intensity;
};

/* A capsule that spans so much of a turn. next is the capsule behind it, or NULL where that is lost:
 * then what depends on it is no return. */
void rplidar_decode_capsule(enum rplidar_format format, const uint8_t *bytes, const uint8_t *next,
	uint32_t span_q6, struct rplidar_samples *ret);

/* One node of HQ; true where a turn begins with it. */
bool rplidar_decode_hq(
	const uint8_t *node, float *ret_clockwise_rad, uint32_t *ret_mm, uint16_t *ret_quality);
#define RPLIDAR_HQ_NODES_AT   9
#define RPLIDAR_HQ_NODE_BYTES 8

#endif
