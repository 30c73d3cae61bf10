#ifndef FIRMWARE_IO_CRC32C_H
#define FIRMWARE_IO_CRC32C_H
/* CRC-32C (Castagnoli; RFC 3720 B.4): polynomial 1EDC6F41 reflected, initial value and final xor FFFFFFFF. Uses the
 * processor's instruction where there is one (chosen at run time), tables of eight otherwise. */
#include <stddef.h>
#include <stdint.h>

/* crc is 0 for the first piece, then the result so far. */
uint32_t crc32c(uint32_t crc, const void *bytes, size_t length);

#endif
