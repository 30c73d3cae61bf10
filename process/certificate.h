#ifndef PROCESS_CERTIFICATE_H
#define PROCESS_CERTIFICATE_H
/* A head's certificate (acquire/calibration.h) with what was found out of it: the one that the head told, its numbers replaced by
 * those that were seen, and under the key "measured" when, from what, with which deviations and what is left. */
#include "process/board-camera.h"

struct measured {
	const struct faces *faces;
	const struct two_face_result *lidar;
	const struct board_result *boards; /* NULL: no board was looked for or seen */
	const char *source;                /* what it was measured from, for people */
};

/* As JSON text, ending in a newline; caller frees. NULL with an error for a head whose certificate is none. */
char *certificate_text(const struct measured *m, GError **error);
/* Writes it, whole or not at all. A file that was there stays beside it, as FILE.1 or the first number that is free:
 * *ret_kept_as, caller frees, NULL when there was none. */
bool certificate_save(
	const struct measured *m, const char *path, char **ret_kept_as, GError **error);

#endif
