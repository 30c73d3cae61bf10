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

#endif
