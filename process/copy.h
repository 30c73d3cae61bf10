#ifndef PROCESS_COPY_H
#define PROCESS_COPY_H
/* Copies of a site, or of parts of it, on another disk, each file read back and compared by SHA-256. TO/NAME/SHA256SUMS lists what was
 * copied, as sha256sum -c reads it.
 *
 * A file appears there when it is whole. What is there already with the same content is not written again, so that a copy which was
 * cut off goes on. A file there that another program put there is never touched: the copy is refused; and so it is where a folder
 * there is a link. Links of the site are passed over. Errors are of G_IO_ERROR; G_IO_ERROR_CANCELLED when it was told to stop. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

enum copy_what { COPY_SITE, COPY_SCANS, COPY_EXPORTS, COPY_PICTURES, COPY_WHATS };
extern const char *const copy_what_names[COPY_WHATS];

struct copy_options {
	enum copy_what what;
	/* true stops; may be NULL. */
	bool (*progress)(double fraction, const char *doing, gpointer user_data);
	gpointer user_data;
};
struct copy_result {
	char *folder; /* TO/NAME; caller frees */
	uint32_t files, written;
	uint64_t bytes; /* of all files */
};

bool copy_site(const char *site_path, const char *to, const struct copy_options *options,
	struct copy_result *ret, GError **error);

#endif
