#include "sim/cola-text.h"
#include <string.h>

void cola_append_word(GString *out, const char *word)
{
	g_string_append_c(out, ' ');
	g_string_append(out, word);
}

void cola_append_number(GString *out, uint32_t value)
{
	static const char digits[] = "0123456789ABCDEF";
	unsigned shift = 28;

	while (shift > 0 && value >> shift == 0)
		shift -= 4;
	g_string_append_c(out, ' ');
	for (;; shift -= 4) {
		g_string_append_c(out, digits[value >> shift & 15]);
		if (shift == 0)
			return;
	}
}

void cola_append_real(GString *out, float value)
{
	uint32_t bits;

	memcpy(&bits, &value, sizeof bits);
	g_string_append_printf(out, " %08X", bits);
}

void cola_append_string(GString *out, const char *text)
{
	cola_append_number(out, (uint32_t)strlen(text));
	cola_append_word(out, text);
}

bool cola_parse_number(const char *word, int64_t *ret_number)
{
	bool decimal = *word == '+' || *word == '-';
	char *end;

	if (!g_ascii_isxdigit(word[decimal ? 1 : 0]) || strlen(word) > 11)
		return false;
	*ret_number = g_ascii_strtoll(word, &end, decimal ? 10 : 16);
	return *end == '\0';
}
