#ifndef FIRMWARE_IO_RECORD_H
#define FIRMWARE_IO_RECORD_H
/* A record (raw.rec) is what went over a head's wires, as it went: every byte to and from the
 * lidar, every stage edge, every camera frame, each with the host's time. It is the scan;
 * everything else is computed from it and can be computed again. It is only ever appended to.
 *
 * File, little-endian; a new kind of entry is a new version:
 *     header   8 bytes  "PLEINREC"
 *              4        version, 1
 *              4        CRC-32C of the 12 before
 * then entries, each padded with zeros to a multiple of 8 bytes:
 *     entry    4 bytes  mark, 0x3ecd52b8
 *              4        kind
 *              4        length of the payload
 *              4        sequence, from 0
 *              8        host time, ns
 *              4        zero
 *              4        CRC-32C of the 28 before and of the payload
 *                       payload
 *
 * A power cut loses at most the entry that was being written and what the disk had not yet taken: a
 * thread of the writer's own calls fdatasync without end while there is something to sync, so
 * nothing waits for the disk and the disk is never more than one sync behind. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum record_kind {
	/* JSON text: device, protocol, calibration, wall-clock time; a resumed scan has several */
	RECORD_SESSION = 1,
	RECORD_LIDAR_IN,     /* bytes as they arrived */
	RECORD_LIDAR_OUT,    /* bytes as they were sent */
	RECORD_LIDAR_GONE,   /* unplugged; no payload */
	RECORD_LIDAR_OPENED, /* plugged in again; no payload */
	RECORD_STAGE,        /* struct stage_event[] */
	RECORD_FRAME,        /* struct camera_frame_info, then the pixels */
	RECORD_CAMERA_GONE,  /* no payload */
	RECORD_MARK,         /* JSON text: what the scan was about to do, for people */
	RECORD_END,          /* the scan was whole and the record closed; no payload */
	RECORD_KINDS
};
#define RECORD_PAYLOAD_MAX (64u << 20)

struct record_entry {
	enum record_kind kind;
	uint32_t length;
	int64_t time_ns;
	const void *payload; /* 8-aligned; lives as long as the reader */
	uint64_t offset;     /* of the entry in the file */
	uint32_t sequence;
};

#define RECORD_ERROR (record_error_quark())
GQuark record_error_quark(void);
enum record_error {
	RECORD_ERROR_DAMAGED,      /* the message names the file, the entry and the byte */
	RECORD_ERROR_NOT_A_RECORD, /* another kind of file, or a record of a later version */
};
/* What the system refuses is of G_IO_ERROR. */

/* ---- writing: one owner, one thread ---- */
typedef struct record_writer record_writer;

/* Makes a new file, which must not exist: it appears under its name only with its header whole and
 * synced. */
record_writer *record_create(const char *path, GError **error);

/* Opens a record to go on with it. A tail that was cut while being written is removed
 * (ret_cut_bytes, may be NULL, says how much); damage elsewhere is refused with
 * RECORD_ERROR_DAMAGED and the file stays as it is. */
record_writer *record_append_to(const char *path, uint64_t *ret_cut_bytes, GError **error);

/* Two parts so that a frame's header and pixels need no copy; the second may be NULL, 0. Together
 * they have at most RECORD_PAYLOAD_MAX bytes. Fails when the disk is full or gone, also when the
 * thread met that with an earlier entry; the file then may end in a cut entry, which the next
 * record_append_to removes, and every later record_write and record_close says the same again. */
bool record_write(record_writer *w, enum record_kind kind, int64_t time_ns, const void *part1,
	size_t length1, const void *part2, size_t length2, GError **error);
uint64_t record_writer_size(const record_writer *w); /* bytes of header and whole entries so far */

/* Waits for the disk and closes; false when the disk refused anything on the way. Frees w in any
 * case. */
bool record_close(record_writer *w, GError **error);
void record_writer_free(record_writer *w); /* closes without caring; NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(record_writer, record_writer_free)

/* ---- reading: the file is mapped, not copied ---- */
typedef struct record_reader record_reader;
enum record_result {
	RECORD_ENTRY,  /* *ret_entry is the next entry */
	RECORD_AT_END, /* the file ends after a whole entry */
	RECORD_CUT,    /* nothing whole from ret_entry->offset on: a writer was stopped there */
	RECORD_BAD,    /* damage, with whole entries behind it: error is set */
};

/* Refuses what is not a record, with one sentence. The file may grow meanwhile (the reader sees
 * what was there); it must not be shortened, so no record_append_to while it is open. */
record_reader *record_open(const char *path, GError **error);
/* The same for bytes at hand; name stands for the path in messages. */
record_reader *record_open_bytes(GBytes *bytes, const char *name, GError **error);
enum record_result record_next(record_reader *r, struct record_entry *ret_entry, GError **error);
/* After RECORD_BAD: goes to the next whole entry and returns the bytes passed over. 0 when none is
 * to be had, which can be in a file that was made to look like entries everywhere; the search gives
 * up there in bounded time. */
uint64_t record_skip_damage(record_reader *r);
uint64_t record_reader_size(const record_reader *r);
uint64_t record_reader_position(const record_reader *r); /* offset of the next entry: progress */
void record_reader_free(record_reader *r);               /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(record_reader, record_reader_free)

#endif
