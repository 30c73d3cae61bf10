#ifndef PROCESS_IMPORT_NUMBER_H
#define PROCESS_IMPORT_NUMBER_H
/* Decimal numbers in large texts: correctly rounded as strtod is, without a locale, and several times as fast. Where mantissa
 * and power of ten are both exact doubles one operation rounds right (Clinger 1990, "How to read floating point numbers
 * accurately"); for what is longer strtod is asked. */
#include <stdbool.h>
#include <stdint.h>

/* Reads [+-]digits[.digits][e[+-]digits] at *text and moves it behind. false: there is no number, or it is beyond a double;
 * *text is then as it was. The text must end in a byte that is no part of a number, such as a newline or 0. */
bool import_number(const char **text, double *ret);
/* Digits alone. false: none, or beyond 64 bits. */
bool import_integer(const char **text, uint64_t *ret);

#endif
