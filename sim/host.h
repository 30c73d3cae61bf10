#ifndef SIM_HOST_H
#define SIM_HOST_H
/* The program at the other end of the link, as the simulator sees it: messages in, messages out.
 * Blocks only where it says so. One owner; not thread-safe. */
#include "sim/link.h"
#include <glib.h>
#include <stdbool.h>

enum host_state {
	HOST_IDLE,   /* nothing came within the time-out */
	HOST_TALKS,  /* something came; host_next() may have a message */
	HOST_GONE,   /* it hung up */
	HOST_BROKEN, /* the link failed, error is set */
};

typedef struct host host;
host *host_new(int fd);  /* takes the descriptor */
void host_free(host *h); /* closes it; NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(host, host_free)

/* Blocks until the message is on its way; false when the host has hung up or the link failed (error
 * is set then). */
bool host_send(host *h, enum link_kind kind, int64_t host_ns, const void *payload, gsize length,
	GError **error);
/* Waits for bytes, for ever if timeout_ns is negative. */
enum host_state host_listen(host *h, int64_t timeout_ns, GError **error);
/* The next whole message; its payload lives until the next call. False when there is none, or one
 * that is too long for any command, in which case error is set. */
bool host_next(host *h, struct link_header *ret_header, const guint8 **ret_payload, GError **error);

#endif
