#ifndef PROCESS_IMPORT_LINES_H
#define PROCESS_IMPORT_LINES_H
/* The lines of a large text, one after another and never more than a block of it in memory. One owner, one thread. */
#include "process/import-number.h"
#include "process/import.h"

struct import_lines {
	import_source *file;
	char *block; /* with a zero behind it */
	size_t at, filled;
	uint64_t offset; /* of the file, behind what is in the block */
	uint64_t line;   /* number of the line read last */
};
void import_lines_begin(struct import_lines *l, import_source *file); /* which must stay */
void import_lines_clear(struct import_lines *l);

/* "PATH: line 371: WHAT"; false. */
bool import_lines_refuse(GError **error, const struct import_lines *l, const char *format, ...)
	G_GNUC_PRINTF(3, 4);
/* The next line, which ends in a newline, in a carriage return before it, or in 0 at the end of the file. *ret is NULL when
 * there is none. */
bool import_lines_next(struct import_lines *l, const char **ret, GError **error);
/* Where the next line begins, in bytes of the file. */
uint64_t import_lines_tell(const struct import_lines *l);
/* Back to there, with that line before it. */
void import_lines_seek(struct import_lines *l, uint64_t offset, uint64_t line);
/* Nothing but blanks up to the end of the line. A zero byte ends a line only where the file ends. */
bool import_lines_ends(const struct import_lines *l, const char *at);

static inline const char *import_skip_blanks(const char *at)
{
	while (*at == ' ' || *at == '\t' || *at == '\r')
		at++;
	return at;
}

/* Behind a number: nothing that belongs to it. */
static inline bool import_ends_field(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == 0;
}

#endif
