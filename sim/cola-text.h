#ifndef SIM_COLA_TEXT_H
#define SIM_COLA_TEXT_H
/* How CoLa-A writes things: words between single blanks, numbers in upper-case hexadecimal without
 * leading zeros. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

/* Errors of sFA, those that this device has reason to give. */
enum cola_error {
	COLA_OK = 0,
	COLA_METHOD_DENIED = 1,
	COLA_METHOD_UNKNOWN = 2,
	COLA_VARIABLE_UNKNOWN = 3,
	COLA_OUT_OF_RANGE = 4,
	COLA_TOO_FEW = 8,
	COLA_WRITE_DENIED = 0xa,
	COLA_COMMAND_UNKNOWN = 0xc,
	COLA_BUSY = 0xd,
	COLA_EVENT_UNKNOWN = 0xf,
	COLA_BAD_NUMBER = 0x11,
};

/* Each appends a blank and the value. */
void cola_append_word(GString *out, const char *word);
void cola_append_number(GString *out, uint32_t value);   /* two's complement for negative ones */
void cola_append_real(GString *out, float value);        /* the eight digits of IEEE 754 */
void cola_append_string(GString *out, const char *text); /* its length, then its characters */

/* A number of the host: hexadecimal, or decimal behind a sign. */
bool cola_parse_number(const char *word, int64_t *ret_number);

#endif
