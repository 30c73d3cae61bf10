#include "process/import-lines.h"
#include <gio/gio.h>
#include <string.h>

#define LINE_CHARACTERS_MAX 1000
#define BLOCK_BYTES         (1u << 20)

bool import_lines_refuse(GError **error, const struct import_lines *r, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	return import_refuse(error, r->file, G_IO_ERROR_INVALID_DATA,
		"line %" G_GUINT64_FORMAT ": %s", r->line, what);
}

void import_lines_begin(struct import_lines *r, import_source *file)
{
	*r = (struct import_lines){ .file = file, .block = g_malloc(BLOCK_BYTES + 1) };
	r->block[0] = 0;
}

void import_lines_clear(struct import_lines *r)
{
	g_free(r->block);
}

static bool refill(struct import_lines *r, GError **error)
{
	size_t kept = r->filled - r->at, got;
	memmove(r->block, r->block + r->at, kept);
	if (!import_source_read(
		    r->file, r->offset, r->block + kept, BLOCK_BYTES - kept, &got, error))
		return false;
	r->at = 0;
	r->filled = kept + got;
	r->offset += got;
	r->block[r->filled] = 0;
	return true;
}

bool import_lines_next(struct import_lines *r, const char **ret, GError **error)
{
	char *newline = memchr(r->block + r->at, '\n', r->filled - r->at);
	if (!newline) {
		if (!refill(r, error))
			return false;
		newline = memchr(r->block, '\n', r->filled);
	}
	*ret = r->at < r->filled ? r->block + r->at : NULL;
	char *end = newline ? newline : r->block + r->filled;
	r->line += *ret != NULL;
	if (end - (r->block + r->at) > LINE_CHARACTERS_MAX)
		return import_lines_refuse(
			error, r, "has more than %d characters", LINE_CHARACTERS_MAX);
	r->at = (size_t)(end - r->block) + (newline != NULL);
	return true;
}

uint64_t import_lines_tell(const struct import_lines *r)
{
	return r->offset - (r->filled - r->at);
}

void import_lines_seek(struct import_lines *r, uint64_t offset, uint64_t line)
{
	r->offset = offset;
	r->at = r->filled = 0;
	r->block[0] = 0;
	r->line = line;
}

bool import_lines_ends(const struct import_lines *r, const char *at)
{
	at = import_skip_blanks(at);
	return *at == '\n' || (*at == 0 && at == r->block + r->filled);
}
