#ifndef ACQUIRE_SCIP_H
#define ACQUIRE_SCIP_H
/* The sums and numbers of SCIP 2.0 (Hokuyo, specification C-42-03320B). A number is written in
 * characters of 6 bits, value
 * + 0x30, most significant first: two characters up to 4095, three up to 262143, four 24 bits. A
 * sum is one such character over the low 6 bits of the sum of a line's bytes. Stateless; any
 * thread. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SCIP_BLOCK_CHARS                                                                           \
	64 /* values come in lines of so many characters and one sum; the last may be shorter */

/* How a scan command writes one step. */
struct scip_layout {
	uint8_t distance_chars; /* 2 or 3 */
	bool intensity;         /* three characters of it follow the distance */
	bool echoes;            /* further echoes of the same step follow, each after '&' */
};

char scip_sum(const char *text, size_t length);

/* False where a character is none of the 64. chars is 1 to 5. */
bool scip_number(const char *text, unsigned chars, uint32_t *ret);

/* Takes a line of values with its sum at the end: digits (0..63, or SCIP_AND for '&' where echoes
 * may come) go to ret_digits, line_length - 1 of them. False, ret_digits spoilt, where the sum or a
 * character is wrong; as every character is held to the alphabet, each single flipped bit is seen.
 */
bool scip_take_block(const char *line, size_t line_length, bool echoes, uint8_t *ret_digits);
#define SCIP_AND ((uint8_t)('&' - 0x30))

/* Decodes digits into exactly as many steps as asked, false where the digits are not just that. Of
 * several echoes the first is kept: it is the nearest surface of a beam that met two. Intensities
 * have up to 18 bits and saturate at 65535, so that the scale is the device's own, as in the other
 * protocols; intensity may be NULL where the layout has none. */
bool scip_decode_steps(const uint8_t *digits, size_t length, const struct scip_layout *layout,
	uint32_t steps, uint32_t *range_mm, uint16_t *intensity);

#endif
