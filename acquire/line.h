#ifndef ACQUIRE_LINE_H
#define ACQUIRE_LINE_H
/* What drivers share about the line to their lidar: at which speed it speaks, and what is wrong
 * when it does not. Part of the dialogue: runs on the pump, in its thread. */
#include "acquire/pump.h"

struct line_search {
	const uint32_t *speeds_baud; /* ends with 0 */
	bool dtr;                    /* as in struct wire_line */
	/* Is the lidar there, at the speed that is set now? Errors are of the wire alone. */
	bool (*is_there)(struct pump *p, bool *ret_there, GError **error);
};

/* Leaves the line at the first of the speeds at which the lidar is there. Otherwise
 * PUMP_ERROR_NO_ANSWER, with what was tried and what is wrong: no byte came, bytes of nothing, or
 * another lidar's. */
bool line_find(struct pump *p, const struct line_search *search, GError **error);

/* For a driver that got no answer: sets PUMP_ERROR_NO_ANSWER with what the bytes that came tell,
 * and returns false. silent is the sentence where none came. */
bool line_complain(struct pump *p, const char *silent, GError **error);

#endif
