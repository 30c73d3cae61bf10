#include "process/import-number.h"
#include <glib.h>
#include <math.h>

#define MANTISSA_EXACT (UINT64_C(1) << 53)
#define POWER_EXACT    22
/* Of digits that surely fit into 64 bits. */
#define DIGITS_SURE 19

static const double powers[POWER_EXACT + 1] = { 1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9,
	1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22 };

static inline bool is_digit(char c)
{
	return (unsigned char)(c - '0') < 10;
}

/* All digits of a run; their number is text behind less before. */
static inline const char *read_digits(const char *text, uint64_t *mantissa)
{
	uint64_t value = *mantissa;
	for (; is_digit(*text); text++)
		value = value * 10 + (uint64_t)(*text - '0');
	*mantissa = value;
	return text;
}

static inline const char *read_exponent(const char *text, int *ret)
{
	if (*text != 'e' && *text != 'E')
		return text;
	const char *at = text + 1;
	bool negative = *at == '-';
	at += *at == '-' || *at == '+';
	if (!is_digit(*at))
		return text;
	int value = 0;
	for (; is_digit(*at); at++)
		value = MIN(value * 10 + (*at - '0'), 100000);
	*ret = negative ? -value : value;
	return at;
}

static bool read_slowly(const char **text, const char *end, double *ret)
{
	char *behind;
	double value = g_ascii_strtod(*text, &behind);
	if (behind != end || !isfinite(value))
		return false;
	*ret = value;
	*text = end;
	return true;
}

bool import_number(const char **text, double *ret)
{
	const char *at = *text;
	uint64_t mantissa = 0;
	int exponent = 0;
	bool negative = *at == '-';
	at += *at == '-' || *at == '+';
	const char *first = at;
	at = read_digits(at, &mantissa);
	long digits = at - first, decimals = 0;
	if (*at == '.') {
		const char *point = at++;
		at = read_digits(at, &mantissa);
		decimals = at - point - 1;
	}
	if (digits + decimals == 0)
		return false;
	at = read_exponent(at, &exponent);
	long power = exponent - decimals;
	if (digits + decimals > DIGITS_SURE || mantissa > MANTISSA_EXACT || power < -POWER_EXACT ||
		power > POWER_EXACT)
		return read_slowly(text, at, ret);
	double value = (double)mantissa;
	value = power < 0 ? value / powers[-power] : value * powers[power];
	*ret = negative ? -value : value;
	*text = at;
	return true;
}

bool import_integer(const char **text, uint64_t *ret)
{
	const char *at = *text;
	uint64_t value = 0;
	for (; is_digit(*at); at++) {
		uint64_t digit = (uint64_t)(*at - '0');
		if (value > (UINT64_MAX - digit) / 10)
			return false;
		value = value * 10 + digit;
	}
	if (at == *text)
		return false;
	*ret = value;
	*text = at;
	return true;
}
