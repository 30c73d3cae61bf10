#ifndef TESTS_KIOSK_RIG_PRIVATE_H
#define TESTS_KIOSK_RIG_PRIVATE_H
/* What the files of the rig share. */
#include "tests/kiosk-rig.h"
#include <gio/gio.h>

/* A socket of questions and answers in lines. */
struct rig_line {
	GSocketConnection *connection;
	GDataInputStream *input;
};
/* False where nothing listens there. */
bool rig_line_open(struct rig_line *line, const char *path);
void rig_line_close(struct rig_line *line);
/* Lines that each end in "\n", answered with COUNT times "ok". False, with its words, at an error. What stands before an "ok"
 * is added to TEXT, which may be NULL. */
bool rig_line_ask(
	struct rig_line *line, const char *questions, int count, GString *text, GError **error);

struct rig {
	char *folder;
	char *program;
	char **arguments;
	char **environment;
	GTestDBus *bus; /* NULL: somebody else's */
	GSubprocess *weston, *running;
	struct rig_line touch, probe;
};

/* Lines for weston-touch.c, COUNT of them, all at once. */
void rig_send(rig *r, const char *lines, int count);
/* One finger's or key's line. */
void rig_say(rig *r, const char *format, ...) G_GNUC_PRINTF(2, 3);
/* Ends the test program with why, and what is shown. */
void rig_fail(rig *r, const char *format, ...) G_GNUC_PRINTF(2, 3) G_GNUC_NORETURN;

#endif
