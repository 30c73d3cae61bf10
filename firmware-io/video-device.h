#ifndef FIRMWARE_IO_VIDEO_DEVICE_H
#define FIRMWARE_IO_VIDEO_DEVICE_H
/* A V4L2 device that captures (DEVICES 3): its format is agreed on, its buffers are mapped, it streams. What to do when it fails is
 * camera-v4l2.c's. Single-planar, and multi-planar with all of a frame in one plane.
 *
 * One owner, one thread; nothing blocks, but what the driver does in its ioctls. */
#include "firmware-io/camera-format.h"
#include <linux/videodev2.h>

/* What is asked of the system; tests have a device of their own behind it. As the calls of the same names; 0 or -1 and errno. */
struct video_calls {
	int (*open)(const char *path, int flags);
	int (*close)(int fd);
	int (*ioctl)(int fd, unsigned long request, void *argument);
	void *(*mmap)(size_t length, int fd, off_t offset);
	int (*munmap)(void *bytes, size_t length);
	int64_t (*now_ns)(void); /* CLOCK_MONOTONIC */
};
extern const struct video_calls video_calls_kernel;

#define VIDEO_BUFFERS_MAX 8

struct video_format {
	const struct camera_format *format;
	uint32_t width, height;
	size_t row_bytes;    /* padding included; 0 for MJPEG */
	size_t bytes;        /* that a frame has at least, padding included; 0 for MJPEG */
	bool full_range;     /* of YUV: 0..255, not 16..235 */
	bool bt709;          /* of YUV: not BT.601 */
	int64_t interval_ns; /* between frames; 0: not known */
};

struct video_wish {
	uint32_t fourcc;        /* 0: the best there is */
	uint32_t width, height; /* 0: as the device has them */
};

struct video_buffer {
	uint8_t *bytes;
	size_t length;
	int dma_fd; /* -1: the driver exports none */
};

struct video_device {
	const struct video_calls *calls;
	const char *path;
	int fd;        /* -1: closed */
	uint32_t type; /* V4L2_BUF_TYPE_* */
	struct video_format format;
	GArray *attempts; /* of struct video_wish: formats that it takes, best first */
	guint attempt;
	struct video_buffer buffers[VIDEO_BUFFERS_MAX];
	uint32_t count;
	bool streaming, busy;   /* busy: somebody else's, as it was last asked */
	bool signal_is_watched; /* video-signal.h */
};

enum video_result {
	VIDEO_OK,
	VIDEO_NOTHING, /* no frame now */
	VIDEO_NO_ROOM, /* the bus has no bandwidth left for this format */
	VIDEO_BROKEN,  /* to be started again */
	VIDEO_CHANGED, /* what comes has another size: to be opened again */
	VIDEO_GONE,    /* unplugged */
};

struct video_frame {
	uint32_t index;
	const uint8_t *bytes;
	size_t length;
	uint32_t flags, sequence; /* the driver's */
	int64_t stamp_ns;
	bool damaged; /* the driver says so, or what it says cannot be */
};

/* Opens path (which is borrowed, and must outlive the device) and finds out what it takes; not yet streaming. WIRE_ERROR_GONE: it is not
 * there, or in use, or may not be opened; WIRE_ERROR_BROKEN: it is no camera, or has no such format. */
bool video_open(struct video_device *d, const struct video_calls *calls, const char *path,
	const struct video_wish *wish, GError **error);
/* May be called on one that is closed. */
void video_close(struct video_device *d);

/* Sets the format of the present attempt, maps buffers and gives them all to the driver. */
bool video_prepare(struct video_device *d, GError **error);
/* VIDEO_NO_ROOM: video_next_attempt, and prepare again. */
enum video_result video_start(struct video_device *d);
/* False: there is none. */
bool video_next_attempt(struct video_device *d);
/* Stops, takes all buffers back, gives them out again and starts. */
enum video_result video_restart(struct video_device *d);

/* With VIDEO_OK the frame is the caller's until it is given back. */
enum video_result video_take(struct video_device *d, struct video_frame *ret);
enum video_result video_give_back(struct video_device *d, uint32_t index);

/* ioctl, tried again when a signal came between. */
int video_call(const struct video_device *d, unsigned long request, void *argument);

#endif
