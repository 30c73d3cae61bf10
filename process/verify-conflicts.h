#ifndef PROCESS_VERIFY_CONFLICTS_H
#define PROCESS_VERIFY_CONFLICTS_H
/* What lies together among the surfaces of a scan that the other one saw through. */
#include "process/verify-compare.h"

/* What became of the cells that were looked at, as a grid of its own. */
struct conflicts_view {
	const struct verify_view *from;
	uint32_t rows, columns, stride;
	uint8_t *kind; /* enum compared */
};

double conflicts_cell_sr(const struct conflicts_view *v, uint32_t row);
/* Adds what lies together, and moves things beside the scanner out of what was seen through. */
void conflicts_add(const struct conflicts_view *v, struct comparison *ret);

#endif
