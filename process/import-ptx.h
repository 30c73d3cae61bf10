#ifndef PROCESS_IMPORT_PTX_H
#define PROCESS_IMPORT_PTX_H
/* What the files of the PTX reader share: its state, the lines of a file, the head of a scan. */
#include "process/import-number.h"
#include "process/import.h"

#define PTX_COORDINATE_MAX_M 1e9

struct ptx {
	import_source *file;
	char *block; /* PTX_BLOCK_BYTES and a zero */
	size_t at, filled;
	uint64_t offset; /* of the file, behind what is in the block */
	uint64_t line;   /* number of the line read last */
	uint32_t scans;
	uint64_t first_offset, first_line; /* of the cells of this scan; the line before them */
	uint64_t cells_left;
	bool has_points, is_map;
	/* The transform scales, mirrors or shears, so no pose says it: points are given where it takes them. */
	bool is_applied;
	struct pose applied; /* a matrix, no rotation */
	/* Intensities that become 0 and 65535: 0 and 1, or the least and the largest of the scan. */
	double intensity_low, intensity_high;
	double intensity_least, intensity_most; /* met so far */
	int fields; /* of a cell's line, all alike where there are points; 0: none seen yet */
	char *note;
	struct import_scan scan;
};
#define PTX_BLOCK_BYTES (1u << 20)

/* "PATH: line 371: WHAT"; false. */
bool ptx_refuse(GError **error, const struct ptx *r, const char *format, ...) G_GNUC_PRINTF(3, 4);

/* The next line, which ends in a newline, in a carriage return before it, or in 0 at the end of the file. *ret is NULL when
 * there is none. */
bool ptx_next_line(struct ptx *r, const char **ret, GError **error);
/* Where the next line begins, in bytes of the file. */
uint64_t ptx_tell(const struct ptx *r);
/* Back to there, with that line before it. */
void ptx_seek(struct ptx *r, uint64_t offset, uint64_t line);
/* A line with just these numbers; what it is, for the message. */
bool ptx_read_numbers(struct ptx *r, int count, double *ret, const char *what, GError **error);
/* Behind the last field. A zero byte ends a line only where the file ends. */
bool ptx_ends_line(const struct ptx *r, const char *at);

static inline const char *ptx_skip_blanks(const char *at)
{
	while (*at == ' ' || *at == '\t' || *at == '\r')
		at++;
	return at;
}

/* Behind a number: nothing that belongs to it. */
static inline bool ptx_ends_field(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == 0;
}

/* From its first line, which was read, to the line before its first cell. */
bool ptx_read_head(struct ptx *r, const char *first, GError **error);

#endif
