#include "acquire/scip.h"
#include <glib.h>

char scip_sum(const char *text, size_t length)
{
	uint8_t sum = 0;
	for (size_t i = 0; i < length; i++)
		sum += (uint8_t)text[i];
	return (char)((sum & 0x3f) + 0x30);
}

bool scip_number(const char *text, unsigned chars, uint32_t *ret)
{
	uint32_t value = 0;
	for (unsigned i = 0; i < chars; i++) {
		uint8_t digit = (uint8_t)(text[i] - 0x30);
		if (digit > 0x3f)
			return false;
		value = value << 6 | digit;
	}
	*ret = value;
	return true;
}

/* Inlined with a constant length and a constant echoes, this is a handful of vector instructions.
 */
static inline __attribute__((always_inline)) bool take_digits(
	const char *line, size_t chars, bool echoes, uint8_t *ret_digits)
{
	uint8_t sum = 0, bad = 0;
	for (size_t i = 0; i < chars; i++) {
		uint8_t c = (uint8_t)line[i], digit = (uint8_t)(c - 0x30);
		uint8_t high = digit & 0xc0;
		sum += c;
		bad |= echoes && digit == SCIP_AND ? 0 : high;
		ret_digits[i] = digit;
	}
	return !bad && line[chars] == (char)((sum & 0x3f) + 0x30);
}

bool scip_take_block(const char *line, size_t line_length, bool echoes, uint8_t *ret_digits)
{
	if (line_length == SCIP_BLOCK_CHARS + 1)
		return echoes ? take_digits(line, SCIP_BLOCK_CHARS, true, ret_digits)
			      : take_digits(line, SCIP_BLOCK_CHARS, false, ret_digits);
	return line_length > 1 && take_digits(line, line_length - 1, echoes, ret_digits);
}

static inline uint32_t digits3(const uint8_t *d)
{
	return (uint32_t)d[0] << 12 | (uint32_t)d[1] << 6 | d[2];
}

static void decode_short(const uint8_t *d, uint32_t steps, uint32_t *range_mm)
{
	for (uint32_t i = 0; i < steps; i++, d += 2)
		range_mm[i] = (uint32_t)d[0] << 6 | d[1];
}

static void decode_long(const uint8_t *d, uint32_t steps, uint32_t *range_mm)
{
	for (uint32_t i = 0; i < steps; i++, d += 3)
		range_mm[i] = digits3(d);
}

static void decode_both(const uint8_t *d, uint32_t steps, uint32_t *range_mm, uint16_t *intensity)
{
	for (uint32_t i = 0; i < steps; i++, d += 6) {
		range_mm[i] = digits3(d);
		intensity[i] = (uint16_t)MIN(digits3(d + 3), UINT16_MAX);
	}
}

/* An echo of a step is whole and holds no '&'. */
static bool is_plain(const uint8_t *d, size_t chars)
{
	uint8_t bad = 0;
	for (size_t i = 0; i < chars; i++)
		bad |= d[i] & 0xc0;
	return !bad;
}

static bool decode_echoes(const uint8_t *d, const uint8_t *end, const struct scip_layout *layout,
	uint32_t steps, uint32_t *range_mm, uint16_t *intensity)
{
	size_t chars = layout->intensity ? 6 : 3;
	uint32_t step = 0;
	while (d < end) {
		bool further = *d == SCIP_AND;
		d += further;
		if ((size_t)(end - d) < chars || !is_plain(d, chars) || (further && step == 0))
			return false;
		if (!further) {
			if (step == steps)
				return false;
			range_mm[step] = digits3(d);
			if (layout->intensity)
				intensity[step] = (uint16_t)MIN(digits3(d + 3), UINT16_MAX);
			step++;
		}
		d += chars;
	}
	return step == steps;
}

bool scip_decode_steps(const uint8_t *digits, size_t length, const struct scip_layout *layout,
	uint32_t steps, uint32_t *range_mm, uint16_t *intensity)
{
	if (layout->echoes)
		return decode_echoes(digits, digits + length, layout, steps, range_mm, intensity);
	size_t chars = layout->distance_chars + (layout->intensity ? 3u : 0u);
	if (length != chars * steps)
		return false;
	if (layout->intensity)
		decode_both(digits, steps, range_mm, intensity);
	else if (layout->distance_chars == 2)
		decode_short(digits, steps, range_mm);
	else
		decode_long(digits, steps, range_mm);
	return true;
}
