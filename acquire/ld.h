#ifndef ACQUIRE_LD_H
#define ACQUIRE_LD_H
/* The packets of LDRobot's LD06, LD19 and STL-27L (DEVICES 2.3): 47 bytes, little-endian, twelve
 * measurements with the angles of the first and the last. The device sends them whenever it turns
 * and cannot be told anything. Stateless; any thread. */
#include <stdbool.h>
#include <stdint.h>

#define LD_PACKET_BYTES 47
#define LD_SAMPLES      12
#define LD_HEADER       0x54
#define LD_VERSION      0x2c
#define LD_STAMP_WRAP   30000

/* CRC-8 over the packet but its last byte: 0x4D, from 0, most significant bit first. */
uint8_t ld_crc(const uint8_t *bytes, unsigned length);
/* Begins as a packet does, and its sum is right; bytes has LD_PACKET_BYTES. */
bool ld_is_packet(const uint8_t *bytes);

#endif
