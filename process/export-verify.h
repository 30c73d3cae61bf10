#ifndef PROCESS_EXPORT_VERIFY_H
#define PROCESS_EXPORT_VERIFY_H
/* Whether a file that was written has in it what it should have. */
#include "process/export-format.h"
#include "process/import.h"

/* As the program itself would import it: each point by its place (within half the resolution), colour, intensity and, where classes
 * is true, class; each station by its pose. */
bool export_verify_by_import(const struct export_job *j, const struct import_format *format,
	const char *path, bool classes, GError **error);
/* Of a file of equal records behind a header: byte for byte. */
struct export_records {
	const void *header;                /* of so many bytes, compared; NULL: passed over */
	size_t header_bytes, record_bytes; /* the latter at most EXPORT_RECORD_MAX */
	bool cells_too;                    /* cells without a point have a record */
	void (*encode)(gpointer user_data, const struct export_station *s,
		const struct export_point *p, uint8_t *into);
	gpointer user_data;
};
#define EXPORT_RECORD_MAX 128
bool export_verify_records(const struct export_job *j, const struct export_records *records,
	const char *path, GError **error);
/* "PATH: was read back, and WHAT"; false. */
bool export_refuse_back(GError **error, const char *path, const char *format, ...)
	G_GNUC_PRINTF(3, 4);

#endif
