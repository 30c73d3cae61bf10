#ifndef ACQUIRE_DECODER_H
#define ACQUIRE_DECODER_H
/* A decoder turns the bytes that a lidar sends, in pieces of any size, into scanlines and replies.
 * It never writes, waits or looks at a clock, so the same decoder reads a live wire and a record
 * made years ago. After garbage, a lost byte or a cut telegram it finds the next good telegram by
 * itself; every telegram that it gives out was whole and, where the protocol has sums, correct.
 *
 * One owner; not thread-safe. Feeding allocates only while the decoder grows to the size of the
 * device's telegrams. */
#include "acquire/scanline.h"
#include <glib.h>
#include <stddef.h>

typedef struct decoder decoder;

/* The answer to a command. */
struct lidar_reply {
	int64_t arrival_ns;  /* of its last byte */
	const char *command; /* SCIP: the echoed line without its string ("PP", "TM1"); CoLa: type
				and name ("sRA DeviceIdent"); RPLIDAR the kind of answer ("info") */
	const char *status;  /* SCIP: two characters ("00", "0E"); CoLa: "" or, for sFA, the error
				number in hex */
	const char *text;    /* what followed: SCIP lines without their sums, joined by '\n'; CoLa
				values, space-separated; RPLIDAR the bytes in hex */
};

/* What a device told of itself; empty strings and zeros until it has. */
struct lidar_identity {
	char model[64], serial[32], firmware[64];
	double first_angle_rad, angle_step_rad;
	uint32_t beams;
	double scan_rate_hz;
	double range_max_m;
};

struct decoder_counts {
	uint64_t scanlines, replies;
	uint64_t bad_sums, malformed; /* telegrams refused */
	uint64_t skipped_bytes;       /* that belonged to no telegram */
};

struct decoder_sink {
	void (*scanline)(
		const struct scanline *line, gpointer user_data); /* line lives during the call */
	void (*reply)(
		const struct lidar_reply *reply, gpointer user_data); /* likewise; may be NULL */
	gpointer user_data;
};

/* One row per protocol. */
struct decoder_ops {
	const char *protocol; /* "scip", "cola", "ld", "rplidar" */
	decoder *(*create)(void);
	/* bytes may end anywhere; arrival_ns is when the last of them came. Gives out all that
	 * became whole. */
	void (*feed)(decoder *d, const void *bytes, size_t length, int64_t arrival_ns);
	void (*destroy)(decoder *d);
};
extern const struct decoder_ops decoder_scip, decoder_cola, decoder_ld, decoder_rplidar;

/* The head of every decoder; the protocol's own fields follow it. */
struct decoder {
	const struct decoder_ops *ops;
	struct decoder_sink sink;
	struct lidar_identity identity;
	struct decoder_counts counts;
};

/* NULL for a protocol that is not known. */
decoder *decoder_new(const char *protocol, const struct decoder_sink *sink);
void decoder_feed(decoder *d, const void *bytes, size_t length, int64_t arrival_ns);
const struct lidar_identity *decoder_identity(const decoder *d);
const struct decoder_counts *decoder_get_counts(const decoder *d);
void decoder_free(decoder *d); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(decoder, decoder_free)

#endif
