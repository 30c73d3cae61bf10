#include "process/import-ptx.h"
#include <string.h>

#define LINE_CHARACTERS_MAX 1000

bool ptx_refuse(GError **error, const struct ptx *r, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	return import_refuse(error, r->file, G_IO_ERROR_INVALID_DATA,
		"line %" G_GUINT64_FORMAT ": %s", r->line, what);
}

static bool refill(struct ptx *r, GError **error)
{
	size_t kept = r->filled - r->at, got;
	memmove(r->block, r->block + r->at, kept);
	if (!import_source_read(
		    r->file, r->offset, r->block + kept, PTX_BLOCK_BYTES - kept, &got, error))
		return false;
	r->at = 0;
	r->filled = kept + got;
	r->offset += got;
	r->block[r->filled] = 0;
	return true;
}

bool ptx_next_line(struct ptx *r, const char **ret, GError **error)
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
		return ptx_refuse(error, r, "has more than %d characters", LINE_CHARACTERS_MAX);
	r->at = (size_t)(end - r->block) + (newline != NULL);
	return true;
}

uint64_t ptx_tell(const struct ptx *r)
{
	return r->offset - (r->filled - r->at);
}

void ptx_seek(struct ptx *r, uint64_t offset, uint64_t line)
{
	r->offset = offset;
	r->at = r->filled = 0;
	r->block[0] = 0;
	r->line = line;
}

bool ptx_ends_line(const struct ptx *r, const char *at)
{
	at = ptx_skip_blanks(at);
	return *at == '\n' || (*at == 0 && at == r->block + r->filled);
}

bool ptx_read_numbers(struct ptx *r, int count, double *ret, const char *what, GError **error)
{
	const char *at;
	if (!ptx_next_line(r, &at, error))
		return false;
	if (!at)
		return r->line++,
		       ptx_refuse(error, r, "the file ends, and %s must stand here", what);
	for (int i = 0; i < count; i++) {
		at = ptx_skip_blanks(at);
		if (!import_number(&at, &ret[i]) || !ptx_ends_field(*at))
			return ptx_refuse(error, r, "%s must stand here", what);
	}
	return ptx_ends_line(r, at) ||
	       ptx_refuse(error, r, "%s must stand here, and nothing else", what);
}
