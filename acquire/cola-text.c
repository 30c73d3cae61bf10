#include "acquire/cola-text.h"
#include "acquire/bytes.h"

static bool fail(struct cola_cursor *c)
{
	c->bad = true;
	c->at = c->end;
	return false;
}

/* Takes the space after a token; the last token has none. */
static bool end_token(struct cola_cursor *c)
{
	if (c->at < c->end && *c->at++ != ' ')
		return fail(c);
	return true;
}

bool cola_word(struct cola_cursor *c, size_t characters_max, const char **ret, size_t *ret_length)
{
	const char *start = c->at;
	while (c->at<c->end && * c->at> ' ' && *c->at < 0x7f)
		c->at++;
	size_t length = (size_t)(c->at - start);
	if (length == 0 || length > characters_max)
		return fail(c);
	*ret = start;
	*ret_length = length;
	return end_token(c);
}

/* 16 and above where it is none. */
static inline uint32_t hex_digit(char c)
{
	if (c >= '0' && c <= '9')
		return (uint32_t)(c - '0');
	return c >= 'A' && c <= 'F' ? (uint32_t)(c - 'A' + 10) : 16;
}

uint32_t cola_hex(struct cola_cursor *c, unsigned digits_max)
{
	uint32_t value = 0, digit;
	unsigned digits = 0;
	for (; c->at < c->end && (digit = hex_digit(*c->at)) < 16; c->at++, digits++)
		value = value << 4 | digit;
	if (digits == 0 || digits > digits_max || !end_token(c))
		return fail(c);
	return value;
}

int32_t cola_signed(struct cola_cursor *c)
{
	return (int32_t)cola_hex(c, 8);
}

float cola_real(struct cola_cursor *c)
{
	uint32_t bits = cola_hex(c, 8);
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

bool cola_string(struct cola_cursor *c, const char **ret, size_t *ret_length)
{
	size_t length = cola_hex(c, 4);
	if (c->bad || (size_t)(c->end - c->at) < length)
		return fail(c);
	*ret = c->at;
	*ret_length = length;
	for (size_t i = 0; i < length; i++)
		if ((uint8_t)c->at[i] < ' ')
			return fail(c);
	c->at += length;
	/* Of an empty string some firmware writes both spaces around it, some one. */
	return (length == 0 && c->at < c->end && *c->at != ' ') || end_token(c);
}

void cola_skip(struct cola_cursor *c, uint32_t numbers)
{
	while (numbers-- > 0 && !c->bad)
		cola_hex(c, 8);
}

bool cola_at_end(const struct cola_cursor *c)
{
	return !c->bad && c->at == c->end;
}

/* Four hexadecimal digits in the bytes of a word, the lowest byte most significant; bits are left
 * in *bad where a byte is none of 0-9 A-F. Every byte is checked at once: adding what is missing to
 * 0x80 carries into its high bit when it is large enough, and as no byte is above 0x7f, never
 * further. */
static inline uint32_t hex4(uint32_t word, uint32_t *bad)
{
	uint32_t low = word & 0x7f7f7f7f;
	uint32_t from_0 = low + 0x50505050, past_9 = low + 0x46464646;
	uint32_t from_A = low + 0x3f3f3f3f, past_F = low + 0x39393939;
	*bad |= (word | ~(from_0 & (~past_9 | from_A) & ~past_F)) & 0x80808080;
	uint32_t digits = (low & 0x0f0f0f0f) + ((low >> 6 & 0x01010101) * 9);
	return (digits & 0xf) << 12 | (digits >> 8 & 0xf) << 8 | (digits >> 16 & 0xf) << 4 |
	       digits >> 24;
}

/* A word of eight bytes holds a token of up to four digits and its space: find the space, push the
 * digits up against the end of four bytes, fill up with '0'. No branch depends on how long a token
 * is. */
void cola_values(struct cola_cursor *c, uint32_t count, unsigned digits_max, uint16_t *ret)
{
	uint32_t i = 0, bad = 0;
	const char *at = c->at;
	for (; i < count && c->end - at >= 8; i++) {
		uint64_t word = bytes_load64(at);
		uint64_t space = bytes_zero_mask(word ^ BYTES_EVERY(' '));
		unsigned digits = space ? (unsigned)__builtin_ctzll(space) >> 3 : 8;
		if (digits - 1 >= digits_max)
			break; /* the slow way will say */
		uint64_t right = (uint32_t)word;
		right = right << (32 - 8 * digits) | UINT64_C(0x30303030) >> 8 * digits;
		ret[i] = (uint16_t)hex4((uint32_t)right, &bad);
		at += digits + 1;
	}
	c->at = at;
	if (bad)
		fail(c);
	for (; i < count && !c->bad; i++)
		ret[i] = (uint16_t)cola_hex(c, digits_max);
}
