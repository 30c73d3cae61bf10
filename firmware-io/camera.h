#ifndef FIRMWARE_IO_CAMERA_H
#define FIRMWARE_IO_CAMERA_H
/* The camera exposes all the time; a buffer that was lent to it (camera_queue) is filled by the
 * next exposure that begins, exposures without a buffer are dropped and only counted in the
 * sequence: V4L2's streaming model. One owner, one thread. Reading never blocks. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct head;
typedef struct camera camera;

/* Exposure and white balance are always locked: a panorama must not change its mind half-way. */
struct camera_controls {
	uint32_t exposure_100us; /* V4L2_CID_EXPOSURE_ABSOLUTE */
	uint32_t gain_percent;   /* 100 = base sensitivity */
	uint32_t white_balance_k;
};

#define CAMERA_FOURCC_NV12 0x3231564eu
/* Of flags. */
#define CAMERA_FRAME_ERROR 0x40u /* V4L2_BUF_FLAG_ERROR: the pixels may be damaged */
#define CAMERA_HOST_CLOCK                                                                          \
	0x10000u /* ticks are microseconds of the host's own clock, its low 32 bits */
#define CAMERA_STAMP_END                                                                           \
	0x20000u /* ticks are of the instant after the last pixel was read out, not of the start of exposure */
#define CAMERA_FULL_RANGE 0x40000u /* of YUV: 0..255 */
#define CAMERA_BT709      0x80000u /* of YUV */
#define CAMERA_SIDE_MAX   16384u

/* As it stands in a record, before the pixels. */
struct camera_frame_info {
	uint32_t
		ticks; /* of the camera's clock at the start of exposure, if flags say nothing else: it wraps */
	uint32_t sequence;
	uint32_t flags;
	uint32_t
		fourcc; /* of camera-format.h; YUV is BT.601, limited range, if flags say nothing else */
	uint32_t width, height;
	struct camera_controls controls; /* in force for this frame, as the camera itself says */
	uint32_t reserved;
};

struct camera_ops {
	bool (*set_controls)(camera *c, const struct camera_controls *controls, GError **error);
	/* What the camera made of them, as far as it is known; NULL where it takes them as they are. */
	void (*get_controls)(camera *c, struct camera_controls *ret);
	/* See camera_longest_exposure_100us; NULL where nothing is known of the beat of its frames. */
	uint32_t (*longest_exposure_100us)(camera *c);
	bool (*queue)(camera *c, GError **error);
	/* 1 with a frame (its pixels are the camera's own until the next call), 0 for none, -1 with
	 * an error (WIRE_ERROR). */
	int (*read)(camera *c, struct camera_frame_info *ret_info, const uint8_t **ret_pixels,
		size_t *ret_bytes, int64_t *ret_arrival_ns, GError **error);
	/* For a head made of parts (parts.h): a descriptor that is readable while read has something, -1 while nothing can come; and what
	 * frees it. NULL elsewhere. */
	int (*wait_fd)(camera *c);
	void (*close)(camera *c);
};

struct camera {
	const struct camera_ops *ops;
	struct head *head;
	bool gone; /* as the last read said: the record is told once */
};

/* Bytes of an NV12 frame. */
static inline size_t camera_frame_bytes(const struct camera_frame_info *info)
{
	return (size_t)info->width * info->height * 3 / 2;
}

bool camera_set_controls(camera *c, const struct camera_controls *controls, GError **error);
/* Those in force, which can differ a little from what was set; leaves them where the camera says nothing. */
void camera_get_controls(camera *c, struct camera_controls *controls);
/* What fits between two frames: at least a thirtieth of a second is taken to. */
#define CAMERA_THIRTIETH_100US 330u
uint32_t camera_longest_exposure_100us(camera *c);
bool camera_queue(camera *c, GError **error);
/* After WIRE_ERROR_GONE it may be called again, as often as one likes: a camera can come back. */
int camera_read(camera *c, struct camera_frame_info *ret_info, const uint8_t **ret_pixels,
	size_t *ret_bytes, int64_t *ret_arrival_ns, GError **error);

#endif
