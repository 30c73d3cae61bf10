#ifndef FIRMWARE_IO_CRC32C_H
#define FIRMWARE_IO_CRC32C_H
/* CRC-32C (Castagnoli; RFC 3720 B.4): polynomial 1EDC6F41 reflected, initial value and final xor
 * FFFFFFFF. Uses the processor's instruction where there is one (x86: chosen at run time; ARM: when
 * compiled for it), tables of eight otherwise. Any thread. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* crc is 0 for the first piece, then the result so far. */
uint32_t crc32c(uint32_t crc, const void *bytes, size_t length);

/* The two ways by themselves, so that tests can hold one against the other. crc32c_by_instruction
 * must not be called where crc32c_has_instruction says no. */
uint32_t crc32c_by_tables(uint32_t crc, const void *bytes, size_t length);
uint32_t crc32c_by_instruction(uint32_t crc, const void *bytes, size_t length);
bool crc32c_has_instruction(void);

#endif
