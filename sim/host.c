#include "sim/host.h"
#include <errno.h>
#include <gio/gio.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#define COMMAND_MAX 65536 /* no host has more to say at once */

struct host {
	int fd;
	GByteArray *in;
	gsize taken; /* bytes of `in` that were handed out */
};

host *host_new(int fd)
{
	host *h = g_new0(host, 1);

	h->fd = fd;
	h->in = g_byte_array_new();
	return h;
}

void host_free(host *h)
{
	if (!h)
		return;
	close(h->fd);
	g_byte_array_unref(h->in);
	g_free(h);
}

static bool fail(const char *what, GError **error)
{
	int number = errno;

	g_set_error(error, G_IO_ERROR, g_io_error_from_errno(number), "%s: %s", what,
		g_strerror(number));
	return false;
}

static void advance(struct iovec *part, gsize sent)
{
	part->iov_base = (guint8 *)part->iov_base + sent;
	part->iov_len -= sent;
}

bool host_send(host *h, enum link_kind kind, int64_t host_ns, const void *payload, gsize length,
	GError **error)
{
	struct link_header header = { (uint32_t)length, (uint32_t)kind, host_ns };
	struct iovec parts[2] = { { &header, sizeof header }, { (void *)payload, length } };
	struct msghdr message = { .msg_iov = parts, .msg_iovlen = 2 };

	while (parts[0].iov_len + parts[1].iov_len > 0) {
		ssize_t sent = sendmsg(h->fd, &message, MSG_NOSIGNAL);

		if (sent < 0 && errno == EINTR)
			continue;
		if (sent < 0)
			return errno == EPIPE || errno == ECONNRESET
				       ? false
				       : fail("link to the host", error);
		gsize first = MIN((gsize)sent, parts[0].iov_len);

		advance(&parts[0], first);
		advance(&parts[1], (gsize)sent - first);
	}
	return true;
}

enum host_state host_listen(host *h, int64_t timeout_ns, GError **error)
{
	struct pollfd waiting = { .fd = h->fd, .events = POLLIN };
	struct timespec timeout = { timeout_ns / 1000000000, timeout_ns % 1000000000 };
	guint8 bytes[4096];

	if (ppoll(&waiting, 1, timeout_ns < 0 ? NULL : &timeout, NULL) < 0 && errno != EINTR) {
		fail("waiting for the host", error);
		return HOST_BROKEN;
	}
	if (waiting.revents == 0)
		return HOST_IDLE;
	ssize_t got = recv(h->fd, bytes, sizeof bytes, 0);

	if (got == 0 || (got < 0 && errno == ECONNRESET))
		return HOST_GONE;
	if (got < 0 && errno != EINTR) {
		fail("link from the host", error);
		return HOST_BROKEN;
	}
	if (got > 0)
		g_byte_array_append(h->in, bytes, (guint)got);
	return HOST_TALKS;
}

bool host_next(host *h, struct link_header *ret_header, const guint8 **ret_payload, GError **error)
{
	if (h->taken > 0)
		g_byte_array_remove_range(h->in, 0, (guint)h->taken);
	h->taken = 0;
	if (h->in->len < sizeof *ret_header)
		return false;
	memcpy(ret_header, h->in->data, sizeof *ret_header);
	if (ret_header->length > COMMAND_MAX) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"the host sent a message of %u bytes and kind %u", ret_header->length,
			ret_header->kind);
		return false;
	}
	if (h->in->len < sizeof *ret_header + ret_header->length)
		return false;
	*ret_payload = h->in->data + sizeof *ret_header;
	h->taken = sizeof *ret_header + ret_header->length;
	return true;
}
