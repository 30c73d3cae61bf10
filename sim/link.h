#ifndef SIM_LINK_H
#define SIM_LINK_H
/* The link is the one byte stream between a simulated head and the program that believes it has a
 * real one. It stands where USB, tty, GPIO and V4L2 stand otherwise: below every parser. It carries
 * the bytes of each device untouched and adds only what a kernel would add: the host's time of
 * arrival, plugged and unplugged, a frame's place in memory.
 *
 * A message is a link_header and `length` bytes of payload; all numbers are little-endian. The
 * simulator speaks first (LINK_HELLO). This header is the only one of sim/ that the product
 * includes.
 *
 * Time. host_ns is the host's CLOCK_MONOTONIC. In real time (`speed=1`) it is just that, and
 * messages come when they are due. At `speed=max` the simulator owns it: nothing happens until the
 * host sends LINK_WAIT, which says "I have read everything and would sleep until then". The
 * simulator then runs its world up to the first thing that the host would wake for, sends it, and
 * closes with LINK_NOW. So a scan runs as fast as the machine can cast rays, time-outs of seconds
 * cost nothing, and the same seed gives the same scan to the byte. */
#include <stdint.h>

#define LINK_VERSION     2u
#define LINK_PAYLOAD_MAX (64u << 20)

struct link_header {
	uint32_t length; /* of the payload, at most LINK_PAYLOAD_MAX */
	uint32_t kind;   /* enum link_kind */
	int64_t host_ns; /* to the host: when this arrived; from the host: 0, or the deadline of
			    LINK_WAIT */
};

enum link_kind {
	/* From the simulator. */
	LINK_HELLO = 1, /* struct link_hello, then the head's calibration certificate as JSON text,
			 * whose "camera" is null when there is none */
	LINK_NOW,       /* ends the answer to LINK_WAIT */
	LINK_LIDAR_BYTES,  /* as the lidar sent them */
	LINK_LIDAR_GONE,   /* unplugged, or the answer to LINK_LIDAR_OPEN when it is not there */
	LINK_LIDAR_OPENED, /* the answer to LINK_LIDAR_OPEN */
	LINK_STAGE_EVENTS, /* struct link_stage_event[], in order */
	LINK_CAMERA_FRAME, /* struct link_frame, then the pixels */
	LINK_CAMERA_GONE,

	/* Only where devices stand behind a kernel (kernel.h). */
	LINK_LIDAR_HALTED = 32, /* the endpoint that its bytes come by has halted */
	LINK_STAGE_SLIPPED, /* double: so many steps were lost, against the direction of motion */

	/* From the host. */
	LINK_WAIT = 65,       /* no payload; host_ns is the deadline */
	LINK_LIDAR_OPEN,      /* no payload */
	LINK_LIDAR_CLOSE,     /* no payload */
	LINK_LIDAR_WRITE,     /* bytes for the lidar */
	LINK_STAGE_MOVE,      /* struct link_stage_move; replaces a move under way, ramping from the
				 present rate */
	LINK_STAGE_STOP,      /* no payload; ramps down */
	LINK_CAMERA_CONTROLS, /* struct link_camera_controls; in force from the next exposure */
	LINK_LIDAR_LINE, /* struct link_line: how the lidar's serial line is set from now on; one that
			    * has none (USB) does not care */
	LINK_CAMERA_QUEUE, /* no payload: lends one buffer; the next exposure that starts fills it.
			    * Exposures with no buffer are dropped and counted in the sequence, as
			    * V4L2 does. */
	LINK_STAGE_RESET,  /* no payload: after an emergency stop or an open interlock; moves are
			    * ignored until then, and no reset counts while one of them lasts */
	/* Only where devices stand behind a kernel. */
	LINK_STAGE_BEGIN =
		96,        /* no payload: from now on pulses drive the stage, from where it stood
				  at power-on */
	LINK_STAGE_PULSES, /* struct link_stage_pulse[], in order */
	LINK_TIME, /* int64_t: what the time is, in nanoseconds of the sender's clock, and that no pulse before it is untold. The head's time
		    * stands still until the next; host_ns and the times of pulses are of that clock. Below 0: it goes on by itself. */
};

struct link_hello {
	uint32_t version;   /* LINK_VERSION */
	uint32_t real_time; /* 1: host_ns is CLOCK_MONOTONIC and LINK_WAIT is not used */
	char lidar_protocol
		[16]; /* "scip", "cola", "ld" or "rplidar", as the port's name would tell */
};

struct link_line {
	uint32_t baud;
	uint32_t dtr; /* 1: asserted */
};

/* The stage's own clock is a free-running 32-bit counter of microseconds. */
enum link_stage_kind {
	LINK_STAGE_STEP,    /* a step pulse; direction says which way */
	LINK_STAGE_INDEX,   /* an index slot passed the sensor */
	LINK_STAGE_HOME,    /* the home slot passed the sensor */
	LINK_STAGE_STOPPED, /* the move is over */
	LINK_STAGE_FAULT,   /* the drive stopped by itself */
	LINK_STAGE_ESTOP_PRESSED,
	LINK_STAGE_ESTOP_RELEASED,
	LINK_STAGE_INTERLOCK_OPENED,
	LINK_STAGE_INTERLOCK_CLOSED,
};
struct link_stage_event {
	uint32_t ticks_us;
	int8_t direction; /* +1 clockwise seen from above, -1 */
	uint8_t kind;     /* enum link_stage_kind */
	uint16_t reserved;
};

/* A pulse of the driver's STEP pin while it was enabled. */
struct link_stage_pulse {
	int64_t at_ns;     /* CLOCK_MONOTONIC of the simulator, or as LINK_TIME says */
	int32_t direction; /* +1, -1 */
	uint32_t reserved;
};

struct link_stage_move {
	int64_t target_steps;         /* counted from where the stage stood at power-on */
	double rate_steps_s;          /* top speed, > 0 */
	double acceleration_steps_s2; /* > 0 */
};

struct link_camera_controls {
	uint32_t exposure_100us;  /* as V4L2_CID_EXPOSURE_ABSOLUTE */
	uint32_t gain_percent;    /* 100 = base sensitivity */
	uint32_t white_balance_k; /* as V4L2_CID_WHITE_BALANCE_TEMPERATURE */
};

/* A frame, pixels NV12 (BT.601, limited range), stamped by the camera's own 32-bit microsecond
 * counter at the start of exposure. */
struct link_frame {
	uint32_t ticks_us;
	uint32_t sequence;
	uint32_t flags;         /* LINK_FRAME_ERROR: the pixels may be damaged */
	uint32_t width, height; /* both even */
	uint32_t exposure_100us, gain_percent, white_balance_k; /* as they were in force */
};
#define LINK_FRAME_ERROR 0x40u

#endif
