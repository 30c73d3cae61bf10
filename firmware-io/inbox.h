#ifndef FIRMWARE_IO_INBOX_H
#define FIRMWARE_IO_INBOX_H
/* An inbox takes what a device says from the thread that listens to it to the one that owns the wire. It has room for so many bytes from the
 * start; nothing is allocated while bytes come, and the listener never waits. What finds no room is lost as a whole piece, and counted: a
 * cut telegram is seen by its decoder, a reader that is that late has other troubles.
 *
 * put and fail are the listener's, the rest the owner's. */
#include "firmware-io/wire.h"

typedef struct inbox inbox;
inbox *inbox_new(uint32_t room);
void inbox_free(inbox *i); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(inbox, inbox_free)

void inbox_put(inbox *i, const void *bytes, size_t length, int64_t arrival_ns);
/* Nothing more will come, for this reason: inbox_take says so once it has given out what came before. Takes the error. */
void inbox_fail(inbox *i, GError *error);

/* As wire_ops.read has it: of one arrival at a time. */
gssize inbox_take(inbox *i, void *bytes, size_t size, int64_t *ret_arrival_ns, GError **error);
/* Forgets bytes, error and counts. */
void inbox_clear(inbox *i);
/* Readable while inbox_take has something to say. */
int inbox_fd(const inbox *i);
/* bytes, lost_bytes, waiting_most and room; leaves the others. */
void inbox_count(inbox *i, struct wire_counts *ret);

/* CLOCK_MONOTONIC. */
int64_t inbox_now_ns(void);

#endif
