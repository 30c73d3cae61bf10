#include "render/kiosk/journal.h"
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>

#define FILE_MOST (256 * 1024)

struct journal {
	char *path;
	GPtrArray *lines;
};

static void keep(journal *j, char *line)
{
	g_ptr_array_add(j->lines, line);
	if (j->lines->len > JOURNAL_LINES)
		g_ptr_array_remove_index(j->lines, 0);
}

static void read_back(journal *j)
{
	g_autofree char *text = NULL;
	gsize length;
	if (!g_file_get_contents(j->path, &text, &length, NULL))
		return;
	if (length > FILE_MOST) {
		g_autofree char *old = g_strconcat(j->path, ".1", NULL);
		g_rename(j->path, old);
	}
	g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
	for (char **l = lines; *l; l++)
		if (**l && g_utf8_validate(*l, -1, NULL))
			keep(j, g_strdup(*l));
}

journal *journal_new(const char *path)
{
	journal *j = g_new0(journal, 1);
	j->path = g_strdup(path);
	j->lines = g_ptr_array_new_with_free_func(g_free);
	if (path)
		read_back(j);
	return j;
}

void journal_free(journal *j)
{
	if (!j)
		return;
	g_ptr_array_unref(j->lines);
	g_free(j->path);
	g_free(j);
}

void journal_add(journal *j, const char *sentence)
{
	g_autoptr(GDateTime) now = g_date_time_new_now_local();
	g_autofree char *time = g_date_time_format(now, "%Y-%m-%d %H:%M:%S");
	char *line = g_strdup_printf("%s  %s", time, sentence);
	FILE *f = j->path ? fopen(j->path, "ae") : NULL;
	if (f) {
		fprintf(f, "%s\n", line);
		fclose(f);
	}
	keep(j, line);
}

GPtrArray *journal_lines(const journal *j)
{
	return j->lines;
}
