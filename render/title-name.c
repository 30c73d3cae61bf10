#include "render/title-name.h"

char *title_name(const char *title, gsize letters_most, const char *fallback)
{
	g_autofree char *plain = g_str_to_ascii(title, NULL);
	GString *name = g_string_new(NULL);
	for (const char *c = plain; *c && name->len < letters_most; c++)
		if (g_ascii_isalnum(*c))
			g_string_append_c(name, g_ascii_tolower(*c));
		else if (name->len && name->str[name->len - 1] != '-')
			g_string_append_c(name, '-');
	while (name->len && name->str[name->len - 1] == '-')
		g_string_truncate(name, name->len - 1);
	if (!name->len)
		g_string_assign(name, fallback);
	return g_string_free(name, FALSE);
}
