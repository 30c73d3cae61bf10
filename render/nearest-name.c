#include "render/nearest-name.h"
#include <string.h>

#define LETTERS_MAX 64

/* Rows are of the letters of a, columns of those of b; three rows are enough. */
static guint distance(const char *a, const char *b)
{
	guint rows[3][LETTERS_MAX + 1];
	guint *before = rows[0], *above = rows[1], *row = rows[2];
	size_t rows_count = strlen(a), columns = strlen(b);
	for (size_t k = 0; k <= columns; k++)
		row[k] = (guint)k;
	for (size_t i = 1; i <= rows_count; i++) {
		guint *freed = before;
		before = above;
		above = row;
		row = freed;
		row[0] = (guint)i;
		for (size_t k = 1; k <= columns; k++) {
			char x = g_ascii_tolower(a[i - 1]), y = g_ascii_tolower(b[k - 1]);
			row[k] = MIN(MIN(above[k], row[k - 1]) + 1, above[k - 1] + (x != y));
			if (i > 1 && k > 1 && x == g_ascii_tolower(b[k - 2]) &&
				y == g_ascii_tolower(a[i - 2]))
				row[k] = MIN(row[k], before[k - 2] + 1);
		}
	}
	return row[columns];
}

/* "angle" of "angle_deg". */
static const char *begun_name(const char *name, const char *const *names)
{
	size_t length = strlen(name);
	for (; length && *names; names++)
		if (g_ascii_strncasecmp(*names, name, length) == 0 && (*names)[length] == '_')
			return *names;
	return NULL;
}

const char *nearest_name(const char *name, const char *const *names)
{
	const char *nearest = begun_name(name, names);
	size_t length = strlen(name);
	guint least = nearest ? 0 : G_MAXUINT;
	for (; length <= LETTERS_MAX && *names; names++) {
		size_t longer = MAX(length, strlen(*names));
		guint d = longer <= LETTERS_MAX ? distance(name, *names) : G_MAXUINT;
		if (d < least && d <= (longer + 2) / 3) {
			least = d;
			nearest = *names;
		}
	}
	return nearest;
}

char *nearest_name_hint(const char *name, const char *const *names)
{
	const char *nearest = nearest_name(name, names);
	if (nearest)
		return g_strdup_printf("; did you mean '%s'?", nearest);
	g_autofree char *all = g_strjoinv(", ", (char **)names);
	return *all ? g_strconcat("; there is ", all, NULL) : g_strdup("");
}
