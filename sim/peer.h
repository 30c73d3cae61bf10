#ifndef SIM_PEER_H
#define SIM_PEER_H
/* The other end of a stream socket, on the thread's main loop: bytes come by a call, what is sent and
 * does not fit yet waits. One owner, one thread. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct peer peer;
struct peer_calls {
	/* What came, all of it; false: hang up, once what was sent is on its way. */
	bool (*bytes)(peer *p, const uint8_t *bytes, gsize length, gpointer data);
	void (*gone)(peer *p, gpointer data); /* the last call: p is freed after it */
};

peer *peer_new(int fd, const struct peer_calls *calls, gpointer data); /* takes fd */
void peer_send(peer *p, const void *bytes, gsize length);
gsize peer_waiting(const peer *p); /* bytes that were not yet taken by the other end */
void peer_hang_up(peer *p);        /* gone() follows, when what was sent is on its way */

#endif
