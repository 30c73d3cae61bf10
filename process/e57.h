#ifndef PROCESS_E57_H
#define PROCESS_E57_H
/* E57 (ASTM E2807), what its reader and its writer have in common. A file is pages of 1024 bytes, the last four of each a CRC-32C
 * of the others. Logical offsets count the bytes without them, physical ones with them. Little-endian but for the CRC.
 *
 *     header, 48 bytes at 0    "ASTM-E57", u32 major 1, u32 minor 0, u64 length of the file, u64 physical offset and u64 logical
 *                              length of the XML, u64 1024
 *     compressed vectors       u8 1, 7 zero, u64 logical length of the section, u64 physical offset of its first data packet,
 *                              u64 of its index packet; then packets, each of at most 64 KiB
 *       data packet            u8 1, u8 flags, u16 length - 1, u16 streams, u16 length of each; the streams; to a multiple of 4
 *       index packet           u8 0 ...; what is in it can be told without
 *       empty packet           u8 2, u8 0, u16 length - 1
 *     blobs                    u8 0, 7 zero, u64 logical length of the section; the bytes
 *     XML                      what all this is; offsets in it are physical
 *
 * A field of a vector's records has a stream of its own, which runs on from packet to packet: whole numbers less their minimum in
 * as few bits as their range needs, the lowest first, none at all for a range of one; floats as they are in memory. */
#include <stdint.h>

#define E57_PAGE_BYTES   1024u
#define E57_PAGE_PAYLOAD 1020u
#define E57_HEADER_BYTES 48u
#define E57_SIGNATURE    "ASTM-E57"
#define E57_NAMESPACE    "http://www.astm.org/COMMIT/E57/2010-e57-v1.0"
#define E57_VECTOR_BYTES 32u /* header of the section */
#define E57_BLOB_BYTES   16u
#define E57_PACKET_MAX   65536u
#define E57_VECTOR_ID    1u
#define E57_BLOB_ID      0u
#define E57_PACKET_INDEX 0u
#define E57_PACKET_DATA  1u
#define E57_PACKET_EMPTY 2u
/* Classes of points as LAS numbers them are no part of the standard; ours stand in a namespace of their own, as it asks for. */
#define E57_CLASS_PREFIX    "pleinair"
#define E57_CLASS_NAMESPACE "urn:pleinair:e57:1"

static inline uint64_t e57_physical(uint64_t logical)
{
	return logical / E57_PAGE_PAYLOAD * E57_PAGE_BYTES + logical % E57_PAGE_PAYLOAD;
}

/* Of an offset inside a CRC: that of the page behind it. */
static inline uint64_t e57_logical(uint64_t physical)
{
	uint64_t in_page = physical % E57_PAGE_BYTES;
	return physical / E57_PAGE_BYTES * E57_PAGE_PAYLOAD +
	       (in_page < E57_PAGE_PAYLOAD ? in_page : E57_PAGE_PAYLOAD);
}

/* Bits of the whole numbers from least to most. */
static inline unsigned e57_bits(int64_t least, int64_t most)
{
	uint64_t span = (uint64_t)most - (uint64_t)least;
	return span ? 64u - (unsigned)__builtin_clzll(span) : 0;
}

#endif
