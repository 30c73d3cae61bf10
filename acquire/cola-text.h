#ifndef ACQUIRE_COLA_TEXT_H
#define ACQUIRE_COLA_TEXT_H
/* The tokens of a CoLa-A telegram: one space between them, numbers in upper-case hexadecimal, REAL
 * as the eight digits of an IEEE-754 single, strings as their length and as many characters, spaces
 * included. There is no sum, so reading is strict: what a device would not write is refused.
 * Stateless but for the cursor; any thread. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* After the first thing that is not what was asked for, bad stays set and all numbers read as 0. */
struct cola_cursor {
	const char *at, *end;
	bool bad;
};

static inline struct cola_cursor cola_cursor_of(const char *text, size_t length)
{
	return (struct cola_cursor){ text, text + length, false };
}

/* A token of 1 to characters_max characters above space; false, cursor bad, where there is none. */
bool cola_word(struct cola_cursor *c, size_t characters_max, const char **ret, size_t *ret_length);
uint32_t cola_hex(struct cola_cursor *c, unsigned digits_max); /* at most 8 */
int32_t cola_signed(struct cola_cursor *c);                    /* 32 bits, two's complement */
float cola_real(struct cola_cursor *c);
/* The characters stay where they are; control characters are refused. */
bool cola_string(struct cola_cursor *c, const char **ret, size_t *ret_length);
void cola_skip(struct cola_cursor *c, uint32_t numbers);

/* count numbers of at most digits_max (1 to 4) digits. This is where the time goes. */
void cola_values(struct cola_cursor *c, uint32_t count, unsigned digits_max, uint16_t *ret);

/* Nothing is left, but for one space at the end. */
bool cola_at_end(const struct cola_cursor *c);

#endif
