#ifndef SIM_OUTBOX_H
#define SIM_OUTBOX_H
/* Messages under way to the host, in the order of their arrival. One owner; not thread-safe. */
#include "sim/link.h"
#include <glib.h>

struct outbox_message {
	int64_t due_ns;
	enum link_kind kind;
	GByteArray *payload; /* may be NULL */
};

typedef struct outbox outbox;
outbox *outbox_new(void);
void outbox_free(outbox *o); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(outbox, outbox_free)

/* Takes the payload. Messages due at the same instant leave in the order they were pushed. */
void outbox_push(outbox *o, int64_t due_ns, enum link_kind kind, GByteArray *payload);
int64_t outbox_next_ns(const outbox *o); /* INT64_MAX when empty */
/* The first message, which the caller then owns; the outbox must not be empty. */
struct outbox_message outbox_pop(outbox *o);
void outbox_discard(
	outbox *o, enum link_kind kind, int64_t after_ns); /* those due later than after_ns */
void outbox_message_clear(struct outbox_message *message);

#endif
