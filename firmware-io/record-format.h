#ifndef FIRMWARE_IO_RECORD_FORMAT_H
#define FIRMWARE_IO_RECORD_FORMAT_H
/* The bytes of a record as record.h lays them down, for its writer, its reader and those who test
 * them. All numbers are little-endian: use GUINT32_TO_LE and its kin. */
#include "firmware-io/crc32c.h"
#include <stddef.h>
#include <stdint.h>

#define RECORD_FILE_MAGIC   "PLEINREC"
#define RECORD_FILE_VERSION 1u
#define RECORD_ENTRY_MARK   0x3ecd52b8u

struct record_file_header {
	char magic[8];
	uint32_t version;
	uint32_t crc; /* of the 12 bytes before */
};

struct record_head {
	uint32_t mark, kind, length, sequence;
	uint64_t time_ns;
	uint32_t zero;
	uint32_t crc; /* of the 28 bytes before and the payload */
};

_Static_assert(sizeof(struct record_file_header) == 16 && sizeof(struct record_head) == 32,
	"structs have the layout of the file");

static inline uint32_t record_file_header_crc(const struct record_file_header *h)
{
	return crc32c(0, h, offsetof(struct record_file_header, crc));
}

static inline uint32_t record_head_crc(const struct record_head *h)
{
	return crc32c(0, h, offsetof(struct record_head, crc));
}

/* Zeros that follow a payload. */
static inline size_t record_padding(size_t length)
{
	return -length & 7;
}

#endif
