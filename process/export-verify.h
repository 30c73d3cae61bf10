#ifndef PROCESS_EXPORT_VERIFY_H
#define PROCESS_EXPORT_VERIFY_H
/* Whether a file that was written has in it what it should have. */
#include "process/export-format.h"
#include "process/import.h"

/* As the program itself would import it: each point by its place (within half the resolution), colour, intensity and, where classes
 * is true, class; each station by its pose. */
bool export_verify_by_import(const struct export_job *j, const struct import_format *format,
	const char *path, bool classes, GError **error);
/* "PATH: was read back, and WHAT"; false. */
bool export_refuse_back(GError **error, const char *path, const char *format, ...)
	G_GNUC_PRINTF(3, 4);

#endif
