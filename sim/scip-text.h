#ifndef SIM_SCIP_TEXT_H
#define SIM_SCIP_TEXT_H
/* How SCIP 2.0 writes things (specification C-42-03320B): six bits to a character, a sum after each
 * line. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

char scip_line_sum(const char *text, gsize length); /* (sum of bytes & 0x3f) + 0x30 */
/* `characters` times six bits, most significant first; larger values show their low bits. */
void scip_append_number(GString *out, uint32_t value, unsigned characters);
/* text, sum, LF */
void scip_append_line(GString *out, const char *text, gsize length);
/* KEY:value;sum LF, the sum without the semicolon, as VV, PP and II write. */
void scip_append_property(GString *out, const char *format, ...) G_GNUC_PRINTF(2, 3);
/* Lines of 64 characters. */
void scip_append_block(GString *out, const char *data, gsize length);

/* A command: two letters, parameters, and a string of at most 16 characters behind a semicolon that
 * only the echo needs. */
struct scip_command {
	const char *line; /* all of it, for the echo */
	const char *parameters;
	gsize parameter_length;
	const char *string; /* with its semicolon, or "" */
};

/* Takes a line apart; the result points into it. Returns NULL or the status code that refuses it.
 */
const char *scip_parse(const char *line, struct scip_command *ret_command);
/* The decimal number in so many characters of the parameters, or -1. */
int scip_decimal(const struct scip_command *command, gsize at, gsize length);

#endif
