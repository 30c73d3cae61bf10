#include "sim/peer.h"
#include <errno.h>
#include <glib-unix.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

struct peer {
	int fd;
	const struct peer_calls *calls;
	gpointer data;
	GByteArray *out;
	guint in_source, out_source;
	bool leaving, broken;
};

static void peer_end(peer *p)
{
	g_clear_handle_id(&p->in_source, g_source_remove);
	g_clear_handle_id(&p->out_source, g_source_remove);
	close(p->fd);
	p->calls->gone(p, p->data);
	g_byte_array_unref(p->out);
	g_free(p);
}

static void flush(peer *p)
{
	while (p->out->len > 0 && !p->broken) {
		ssize_t sent = send(p->fd, p->out->data, p->out->len, MSG_NOSIGNAL | MSG_DONTWAIT);

		if (sent >= 0)
			g_byte_array_remove_range(p->out, 0, (guint)sent);
		else if (errno == EAGAIN || errno == EWOULDBLOCK)
			return;
		else if (errno != EINTR)
			p->broken = true;
	}
}

static gboolean on_writable(int fd, GIOCondition condition, gpointer data)
{
	peer *p = data;

	(void)fd, (void)condition;
	flush(p);
	if (p->out->len > 0 && !p->broken)
		return G_SOURCE_CONTINUE;
	p->out_source = 0;
	if (p->leaving || p->broken)
		peer_end(p);
	return G_SOURCE_REMOVE;
}

static void watch_out(peer *p)
{
	if (!p->out_source)
		p->out_source =
			g_unix_fd_add(p->fd, G_IO_OUT | G_IO_HUP | G_IO_ERR, on_writable, p);
}

void peer_send(peer *p, const void *bytes, gsize length)
{
	g_byte_array_append(p->out, bytes, (guint)length);
	flush(p);
	if (p->out->len > 0 || p->broken)
		watch_out(p);
}

gsize peer_waiting(const peer *p)
{
	return p->out->len;
}

void peer_hang_up(peer *p)
{
	p->leaving = true;
	watch_out(p);
}

static gboolean on_readable(int fd, GIOCondition condition, gpointer data)
{
	static guint8 bytes[1 << 16];
	peer *p = data;
	ssize_t got = recv(fd, bytes, sizeof bytes, MSG_DONTWAIT);

	(void)condition;
	if (got < 0 && (errno == EAGAIN || errno == EINTR))
		return G_SOURCE_CONTINUE;
	if (got > 0 && (p->leaving || p->calls->bytes(p, bytes, (gsize)got, p->data)))
		return G_SOURCE_CONTINUE;
	p->in_source = 0;
	if (got > 0)
		peer_hang_up(p);
	else
		peer_end(p);
	return G_SOURCE_REMOVE;
}

peer *peer_new(int fd, const struct peer_calls *calls, gpointer data)
{
	peer *p = g_new0(peer, 1);
	int at_once = 1;

	p->fd = fd;
	p->calls = calls;
	p->data = data;
	p->out = g_byte_array_new();
	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &at_once,
		sizeof at_once); /* fails for others, which need it not */
	p->in_source = g_unix_fd_add(fd, G_IO_IN | G_IO_HUP | G_IO_ERR, on_readable, p);
	return p;
}
