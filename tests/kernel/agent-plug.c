#include "tests/kernel/agent.h"
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* What `usbip attach` does, and again whenever the device is gone; no shell could do it as soon. Ports of the
 * hub stand in vhci_hcd's file `status`, a line each: hub, port, state (4: free), ... */
#define VHCI     "/sys/devices/platform/vhci_hcd.0"
#define RETRY_US 200000
#define FREE     4

struct plug {
	char *host;
	uint16_t port;
};
static GMutex taking; /* of a port, and of what follows */
static bool plugged[64], over;

/* The state of a port, and the first that is free. */
static int port_state(int port, int *ret_free)
{
	g_autofree char *text = NULL;
	int found = -1;

	*ret_free = -1;
	if (!g_file_get_contents(VHCI "/status", &text, NULL, NULL))
		return -1;
	for (const char *line = text; line && *line;
		line = strchr(line, '\n'), line = line ? line + 1 : NULL) {
		int number, state;

		if (sscanf(line, "hs %d %d", &number, &state) != 2)
			continue;
		if (number == port)
			found = state;
		if (state == FREE && *ret_free < 0)
			*ret_free = number;
	}
	return found;
}

static bool receive_exactly(int fd, void *bytes, gsize length)
{
	return recv(fd, bytes, length, MSG_WAITALL) == (ssize_t)length;
}

static uint32_t number_at(const uint8_t *p)
{
	return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* A connection with the device imported, or -1. */
static int import(const struct plug *plug, uint32_t *ret_id, uint32_t *ret_speed)
{
	struct sockaddr_in address = { .sin_family = AF_INET, .sin_port = htons(plug->port) };
	uint8_t request[40] = { 0x01, 0x11, 0x80, 0x03, 0, 0, 0, 0, '1', '-', '1' }, reply[8],
		device[312];
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), at_once = 1;

	inet_aton(plug->host, &address.sin_addr);
	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
	if (connect(fd, (struct sockaddr *)&address, sizeof address) == 0 &&
		send(fd, request, sizeof request, 0) == sizeof request &&
		receive_exactly(fd, reply, sizeof reply) && number_at(reply + 4) == 0 &&
		receive_exactly(fd, device, sizeof device)) {
		*ret_id = number_at(device + 288) << 16 | number_at(device + 292);
		*ret_speed = number_at(device + 296);
		return fd;
	}
	close(fd);
	return -1;
}

/* The port that it is plugged into, or -1. */
static int attach(const struct plug *plug)
{
	uint32_t id, speed;
	int fd = import(plug, &id, &speed), port;

	if (fd < 0)
		return -1;
	g_mutex_lock(&taking);
	port_state(-1, &port);
	int file = open(VHCI "/attach", O_WRONLY | O_CLOEXEC);

	if (over || dprintf(file, "%d %d %u %u", port, fd, id, speed) < 0)
		port = -1;
	else if (port < (int)G_N_ELEMENTS(plugged))
		plugged[port] = true;
	g_mutex_unlock(&taking);
	close(file);
	close(fd); /* the kernel holds it */
	return port;
}

static gpointer keep(gpointer data)
{
	const struct plug *plug = data;
	int port = -1, unused;

	for (;; g_usleep(RETRY_US)) {
		if (port >= 0 && port_state(port, &unused) != FREE)
			continue;
		if (port >= 0)
			g_printerr("agent: the device of port %u is gone\n", plug->port);
		port = attach(plug);
		if (port >= 0)
			g_printerr("agent: the device of port %u is plugged in\n", plug->port);
	}
	return NULL;
}

void plug_keep(const char *host, uint16_t port)
{
	struct plug *plug = g_new(struct plug, 1);

	*plug = (struct plug){ g_strdup(host), port };
	g_thread_unref(g_thread_new("plug", keep, plug));
}

void plug_pull(void)
{
	int unused;

	g_mutex_lock(&taking);
	over = true;
	for (int port = 0; port < (int)G_N_ELEMENTS(plugged); port++) {
		int file = plugged[port] && port_state(port, &unused) != FREE
				   ? open(VHCI "/detach", O_WRONLY | O_CLOEXEC)
				   : -1;

		if (file >= 0 && dprintf(file, "%d", port) < 0)
			g_printerr(
				"agent: port %d stays plugged in: %s\n", port, g_strerror(errno));
		if (file >= 0)
			close(file);
	}
	g_mutex_unlock(&taking);
}
