#ifndef PROCESS_IMPORT_PCD_H
#define PROCESS_IMPORT_PCD_H
/* PCD of versions .5 to .7: text, binary, or binary and compressed (LZF). The header is read and checked here, against the
 * length of the file too; PCL's own reader believes it. Binary bodies are then unpacked by PCL. Bodies of text are read
 * here: PCL passes over lines that are too short. */
#include "process/import-cloud.h"

enum pcd_data { PCD_TEXT, PCD_BINARY, PCD_COMPRESSED };

struct pcd_field {
	char *name;
	enum cloud_type type;
	uint32_t count;  /* of numbers */
	uint32_t offset; /* in bytes, in a point */
};
struct pcd_header {
	GArray *fields; /* of struct pcd_field */
	uint32_t point_bytes;
	uint32_t width, height;
	struct pose viewpoint;
	enum pcd_data data;
	uint64_t bytes, lines;
};
void pcd_header_clear(struct pcd_header *h);
bool pcd_header_read(import_source *file, struct pcd_header *ret, GError **error);

/* Points as they come from PCL, each point_bytes long. */
typedef void (*pcd_point_func)(gpointer user_data, const uint8_t *point);
/* body: behind the header, with 64 bytes more that can be read; its length was checked. */
bool pcd_read_binary(const struct pcd_header *h, const uint8_t *body, pcd_point_func point,
	gpointer user_data, GError **error);

#endif
