#ifndef ACQUIRE_SCIP_ECHO_H
#define ACQUIRE_SCIP_ECHO_H
/* Every telegram of SCIP begins with the echo of its command, a line without a sum, and a status
 * line. Which lines may be an echo is how the decoder finds its feet again after garbage.
 * Stateless; any thread. */
#include "acquire/scip.h"

enum scip_echo_kind {
	SCIP_ECHO_NONE,    /* cannot be an echo */
	SCIP_ECHO_OTHER,   /* looks like one, of a command that we do not know */
	SCIP_ECHO_COMMAND, /* VV, PP, II, BM, QT, RS, RT, RB, TM, SS, CR, SCIP2.0 */
	SCIP_ECHO_SCAN,    /* GD, GS, GE, MD, MS, ME, HD, HE, ND, NE */
};

struct scip_echo {
	enum scip_echo_kind kind;
	char command[40]; /* without its string */
	size_t bytes;     /* of the line, with one for its end */
	size_t junk; /* of those, before the command: a cut telegram may have lost the end of its
			line */
	/* The rest is for SCIP_ECHO_SCAN. */
	const struct scip_scan_command *scan;
	uint32_t start, end, cluster; /* steps; cluster is at least 1 */
};

struct scip_scan_command {
	char name[3];
	const char *data_status; /* of the telegram that carries a scan */
	uint8_t parameter_digits;
	struct scip_layout layout;
};

void scip_echo_parse(const char *line, size_t length, struct scip_echo *ret);

/* Two characters and their sum. */
bool scip_is_status(const char *line, size_t length);

#endif
