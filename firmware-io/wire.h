#ifndef FIRMWARE_IO_WIRE_H
#define FIRMWARE_IO_WIRE_H
/* A wire carries a lidar's bytes: USB, tty, the simulator's link, a record played back. Above it
 * nobody knows which.
 *
 * Reading never blocks; head_wait() is where a program sleeps. All that passes is also written to
 * the head's record, if one is attached (head_attach_record), so nothing above has to remember to.
 * One owner, one thread. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct head;
typedef struct wire wire;

#define WIRE_ERROR (wire_error_quark())
GQuark wire_error_quark(void);
enum wire_error {
	WIRE_ERROR_GONE,   /* unplugged or not there: wire_open may succeed later */
	WIRE_ERROR_BROKEN, /* will not come back */
};

/* How a serial line is set: 8 data bits, no parity, 1 stop bit, no flow control. */
struct wire_line {
	uint32_t baud;
	bool dtr; /* asserted, which is a low pin: an RPLIDAR A1's motor runs while it is not */
};

/* What can be told of a wire that says nothing, or nothing sensible; zeros where it cannot. */
struct wire_counts {
	uint64_t bytes;          /* that came since it was opened */
	uint64_t lost_bytes;     /* that found no room: the reader was too slow */
	uint64_t framing_errors; /* a serial line's: many mean that its speed is wrong */
	uint64_t overruns;       /* the kernel's own */
	uint32_t waiting_most;   /* bytes that ever waited to be read: high-water mark */
	uint32_t room;           /* bytes that may wait */
};

struct wire_ops {
	/* Plugs in: also again after WIRE_ERROR_GONE. */
	bool (*open)(wire *w, GError **error);
	/* What has come, up to size: bytes > 0 with the time of their arrival, 0 for nothing now,
	 * -1 with an error. */
	gssize (*read)(wire *w, void *bytes, size_t size, int64_t *ret_arrival_ns, GError **error);
	/* All or an error. */
	bool (*write)(wire *w, const void *bytes, size_t length, GError **error);
	/* May be called on a wire that is gone. */
	void (*close)(wire *w);
	/* Sets a serial line, open or not; NULL where there is none (USB, TCP). */
	bool (*set_line)(wire *w, const struct wire_line *line, GError **error);
	void (*count)(wire *w, struct wire_counts *ret); /* may be NULL */
	/* For a head made of parts (parts.h): a descriptor that is readable while read has something; and what frees a wire, open or not.
	 * NULL elsewhere. */
	int (*wait_fd)(wire *w);
	void (*free)(wire *w);
};

/* The head of every backend's own struct. */
struct wire {
	const struct wire_ops *ops;
	struct head *head;
};

bool wire_open(wire *w, GError **error);
gssize wire_read(wire *w, void *bytes, size_t size, int64_t *ret_arrival_ns, GError **error);
bool wire_write(wire *w, const void *bytes, size_t length, GError **error);
void wire_close(wire *w);
bool wire_set_line(
	wire *w, const struct wire_line *line, GError **error); /* true where there is none */
struct wire_counts wire_count(wire *w);

#endif
