#ifndef FIRMWARE_IO_HEAD_H
#define FIRMWARE_IO_HEAD_H
/* A head is a lidar wire, a pan stage and perhaps a camera that stand on one host clock. It is
 * opened by URI; the table in head.c has a row per scheme.
 *
 * The host clock is CLOCK_MONOTONIC, except that a simulated head may run it faster and a replayed
 * one shows the clock of the record. So nothing above may look at another clock: "now" is
 * head_now_ns, sleeping is head_wait. */
#include "firmware-io/camera.h"
#include "firmware-io/record.h"
#include "firmware-io/stage.h"
#include "firmware-io/wire.h"

typedef struct head head;

struct head_ops {
	int64_t (*now_ns)(head *h);
	/* Sleeps until something can be read or deadline_ns has passed, whichever is first. false:
	 * the head is lost. */
	bool (*wait)(head *h, int64_t deadline_ns, GError **error);
	void (*close)(head *h);
};

struct head {
	const struct head_ops *ops;
	wire *lidar;
	stage *stage;
	camera *camera;        /* NULL: none */
	char *lidar_protocol;  /* "scip", "cola", "ld", "rplidar": a decoder's name */
	char *calibration;     /* the head's certificate, JSON text */
	record_writer *record; /* borrowed; NULL: not recorded */
	GError *record_error;  /* the first one; reported by the next head_wait */
};

/* Fails for a scheme that is not known or not built in, and for a head that is not there, with what
 * to do. The lidar is not yet open. */
head *head_open(const char *uri, GError **error);

/* A head behind a connected link (sim/link.h): for tests that run the simulator in a thread. Takes
 * fd. */
head *head_open_link(int fd, GError **error);

int64_t head_now_ns(head *h);
bool head_wait(head *h, int64_t deadline_ns, GError **error);

/* From now on all that passes is written to the record, until it is attached to NULL. */
void head_attach_record(head *h, record_writer *record);
void head_close(head *h); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(head, head_close)

/* For the backends. */
void head_tap(head *h, enum record_kind kind, int64_t time_ns, const void *part1, size_t length1,
	const void *part2, size_t length2);
head *head_open_sim(const char *description, GError **error);
head *head_open_replay(const char *path, GError **error);

#endif
