#ifndef FIRMWARE_IO_PARTS_H
#define FIRMWARE_IO_PARTS_H
/* A real head is made of parts that know nothing of each other: a wire to the lidar, a stage on pins, a camera. This says which, and
 * makes each.
 *
 * What the machine has stands in /etc/pleinair.conf (or the file that $PLEINAIR_CONF names), a GKeyFile; a device URI may
 * override any of it by "?group.key=value", as in  tim:?camera.node=none&stage.chip=gpiochip2.  Keys that are not known are refused, with
 * the file and the line's group, for a misspelt pin must not become a stage without an emergency stop. */
#include "firmware-io/head.h"

/* Text of a key; NULL: not given. Lives as long as the parts. group.key must be a row of the table in parts.c. */
typedef struct parts parts;
const char *parts_text(const parts *p, const char *group, const char *key);
/* A number within a range; `otherwise` where it is not given. Refuses what is none. */
bool parts_number(const parts *p, const char *group, const char *key, double min, double max,
	double otherwise, double *ret, GError **error);
bool parts_flag(const parts *p, const char *group, const char *key, bool otherwise, bool *ret,
	GError **error);

/* The file, with what uri says after its '?' above it; rest is what the URI says between ':' and '?'. */
parts *parts_read(const char *uri, GError **error);
const char *parts_rest(const parts *p);
void parts_free(parts *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(parts, parts_free)

/* Each has its file. The head is the one that they will be of: they keep it, and nothing else; parts live only during the call. */
wire *wire_new_usb(head *h, const parts *p, const char *scheme, GError **error);
wire *wire_new_tty(head *h, const parts *p, const char *scheme, GError **error);
/* [stage]; NULL without an error: it says chip=none. */
stage *stage_new_pins(head *h, const parts *p, GError **error);
/* [camera]; NULL without an error: it says node=none, or nothing. */
camera *camera_new_v4l2(head *h, const parts *p, GError **error);

head *head_open_parts(const char *uri, GError **error);

#endif
