#ifndef RENDER_COLOUR_TEXT_H
#define RENDER_COLOUR_TEXT_H
/* "#rrggbb", as files have colours. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* false: it is none, and ret is as it was. */
static inline bool colour_of_text(const char *text, uint8_t ret[3])
{
	bool good = text[0] == '#' && strlen(text) == 7;
	for (int i = 1; good && i < 7; i++)
		good = g_ascii_isxdigit(text[i]);
	for (int i = 0; good && i < 3; i++)
		ret[i] = (uint8_t)(g_ascii_xdigit_value(text[1 + 2 * i]) << 4 |
				   g_ascii_xdigit_value(text[2 + 2 * i]));
	return good;
}

#endif
