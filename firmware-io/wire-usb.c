/* A lidar on USB (libusb): SICK TiM, whose telegrams come by bulk transfers, and Hokuyo, which calls itself a modem (CDC-ACM).
 *
 * A thread of its own handles libusb's events. So many reads are queued at once that the bus never waits for us, each is stamped as it
 * comes back and queued again at once. */
#include "firmware-io/devices.h"
#include "firmware-io/inbox.h"
#include "firmware-io/parts.h"
#include <libusb.h>
#include <string.h>

#define READS          8
#define READ_BYTES     16384 /* a multiple of every packet size */
#define ROOM           (1u << 20)
#define WRITE_MS       1000
#define CONTROL_MS     1000
#define EVENTS_US      200000
#define FAILED_AT_ONCE 20 /* transfers in a row that fail, before it is taken for lost */

/* USB Class Definitions for Communications Devices 1.2, PSTN subclass 1.2, 6.3. */
#define CDC_SET_LINE_CODING        0x20
#define CDC_SET_CONTROL_LINE_STATE 0x22
#define CDC_DTR                    1
#define CDC_RTS                    2

static const struct usb_make {
	const char *scheme, *name;
	uint16_t vendor, product;
	int control_interface, data_interface; /* control below 0: none */
} makes[] = {
	{ "tim", "SICK TiM", 0x19a2, 0x5001, -1, 0 },
	{ "scip", "Hokuyo", 0x15d1, 0x0000, 0, 1 },
};

struct usb_wire {
	wire base;
	const struct usb_make *make;
	char *port; /* "1-1.2"; "": any */
	libusb_context *context;
	libusb_device_handle *handle;
	uint8_t in, out; /* endpoints */
	struct libusb_transfer *reads[READS];
	GThread *thread;
	inbox *inbox;
	struct wire_line line;
	gint stop, stalled,
		flying; /* atomic: a thread that writes handles events too, while it waits */
	int failed;     /* of callbacks, of which one runs at a time */
};

/* ---- words ---- */

static bool say(enum wire_error code, GError **error, const char *format, ...) G_GNUC_PRINTF(3, 4);
static bool say(enum wire_error code, GError **error, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *text = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_set_error_literal(error, WIRE_ERROR, code, text);
	return false;
}

static char *port_of(libusb_device *device)
{
	uint8_t numbers[8];
	int n = libusb_get_port_numbers(device, numbers, sizeof numbers);
	GString *text = g_string_new(NULL);
	g_string_printf(text, "%u", libusb_get_bus_number(device));
	for (int i = 0; i < n; i++)
		g_string_append_printf(text, "%c%u", i ? '.' : '-', numbers[i]);
	return g_string_free(text, FALSE);
}

static bool refuse_open(const struct usb_wire *u, libusb_device *device, int code, GError **error)
{
	g_autofree char *port = port_of(device);
	switch (code) {
	case LIBUSB_ERROR_ACCESS:
		return say(WIRE_ERROR_GONE, error,
			"the %s on USB port %s may not be opened: whoever scans must be in the "
			"group 'plugdev', and pleinair's udev "
			"rules installed (pleinair doctor tells more)",
			u->make->name, port);
	case LIBUSB_ERROR_BUSY:
		return say(WIRE_ERROR_GONE, error,
			"the %s on USB port %s is in use by another program", u->make->name, port);
	case LIBUSB_ERROR_NO_DEVICE:
	case LIBUSB_ERROR_NOT_FOUND:
		return say(WIRE_ERROR_GONE, error, "the %s on USB port %s was unplugged",
			u->make->name, port);
	default:
		return say(WIRE_ERROR_GONE, error, "the %s on USB port %s cannot be used: %s",
			u->make->name, port, libusb_strerror(code));
	}
}

/* ---- the thread ---- */

static void give_up(struct usb_wire *u, const char *what)
{
	inbox_fail(u->inbox, g_error_new_literal(WIRE_ERROR, WIRE_ERROR_GONE, what));
	g_atomic_int_set(&u->stop, 1);
}

static void read_again(struct usb_wire *u, struct libusb_transfer *t)
{
	if (g_atomic_int_get(&u->stop) || g_atomic_int_get(&u->stalled))
		return;
	int code = libusb_submit_transfer(t);
	if (code == 0)
		g_atomic_int_inc(&u->flying);
	else if (code == LIBUSB_ERROR_PIPE)
		g_atomic_int_set(&u->stalled, 1);
	else
		give_up(u, code == LIBUSB_ERROR_NO_DEVICE
				   ? "the lidar was unplugged"
				   : "the lidar's USB port does not take reads any more");
}

static void LIBUSB_CALL read_is_back(struct libusb_transfer *t)
{
	struct usb_wire *u = t->user_data;
	int64_t now_ns = inbox_now_ns();
	g_atomic_int_add(&u->flying, -1);
	if (t->actual_length > 0)
		inbox_put(u->inbox, t->buffer, (size_t)t->actual_length, now_ns);
	switch (t->status) {
	case LIBUSB_TRANSFER_COMPLETED:
	case LIBUSB_TRANSFER_TIMED_OUT: u->failed = 0; break;
	case LIBUSB_TRANSFER_CANCELLED: return;
	case LIBUSB_TRANSFER_STALL: g_atomic_int_set(&u->stalled, 1); return;
	case LIBUSB_TRANSFER_NO_DEVICE: give_up(u, "the lidar was unplugged"); return;
	default:
		/* A plug that is being pulled fails a while before it is gone. */
		if (++u->failed > FAILED_AT_ONCE) {
			give_up(u, "the lidar's USB line fails again and again: try another cable "
				   "or port");
			return;
		}
	}
	read_again(u, t);
}

/* An endpoint that is halted says nothing more until it is told to. What was under way is lost to the lidar's own telegrams, which the decoder
 * sees. */
static void clear_stall(struct usb_wire *u)
{
	int code = libusb_clear_halt(u->handle, u->in);
	if (code < 0) {
		give_up(u, code == LIBUSB_ERROR_NO_DEVICE
				   ? "the lidar was unplugged"
				   : "the lidar's USB endpoint stays halted");
		return;
	}
	g_atomic_int_set(&u->stalled, 0);
	for (int i = 0; i < READS; i++)
		read_again(u, u->reads[i]);
}

static void handle_events(struct usb_wire *u)
{
	libusb_handle_events_timeout_completed(
		u->context, &(struct timeval){ .tv_usec = EVENTS_US }, NULL);
}

static void cancel_all(struct usb_wire *u)
{
	for (int i = 0; i < READS; i++)
		libusb_cancel_transfer(u->reads[i]);
}

static gpointer run_events(gpointer data)
{
	struct usb_wire *u = data;
	pthread_setschedparam(
		pthread_self(), SCHED_FIFO, &(struct sched_param){ .sched_priority = 50 });
	for (int i = 0; i < READS; i++)
		read_again(u, u->reads[i]);
	while (!g_atomic_int_get(&u->stop)) {
		handle_events(u);
		if (g_atomic_int_get(&u->stalled) && g_atomic_int_get(&u->flying) > 0)
			cancel_all(u);
		else if (g_atomic_int_get(&u->stalled))
			clear_stall(u);
	}
	cancel_all(u);
	while (g_atomic_int_get(&u->flying) > 0)
		handle_events(u);
	return NULL;
}

/* ---- opening ---- */

static bool matches(const struct usb_wire *u, libusb_device *device)
{
	struct libusb_device_descriptor d;
	if (libusb_get_device_descriptor(device, &d) < 0 || d.idVendor != u->make->vendor ||
		d.idProduct != u->make->product)
		return false;
	g_autofree char *port = port_of(device);
	return !*u->port || strcmp(port, u->port) == 0;
}

/* A reference, or NULL. */
static libusb_device *find_device(const struct usb_wire *u, GError **error)
{
	libusb_device **list, *found = NULL;
	ssize_t n = libusb_get_device_list(u->context, &list);
	for (ssize_t i = 0; i < n && !found; i++)
		if (matches(u, list[i]))
			found = libusb_ref_device(list[i]);
	if (n >= 0)
		libusb_free_device_list(list, 1);
	if (!found) {
		g_autofree char *power = devices_over_current();
		say(WIRE_ERROR_GONE, error,
			"the lidar is not there: no %s is on %s%s; check its plug and its "
			"power%s%s",
			u->make->name, *u->port ? "USB port " : "any USB port", u->port,
			power ? ". " : "", power ? power : "");
	}
	return found;
}

/* Endpoints are read from the descriptors: 0x81 and 0x02 on the TiMs that were seen. */
static bool find_endpoints(struct usb_wire *u, libusb_device *device)
{
	struct libusb_config_descriptor *c;
	u->in = u->out = 0;
	if (libusb_get_active_config_descriptor(device, &c) < 0)
		return false;
	for (int i = 0; i < c->bNumInterfaces; i++) {
		const struct libusb_interface_descriptor *d =
			c->interface[i].num_altsetting > 0 ? c->interface[i].altsetting : NULL;
		for (int e = 0;
			d && d->bInterfaceNumber == u->make->data_interface && e < d->bNumEndpoints;
			e++) {
			const struct libusb_endpoint_descriptor *p = &d->endpoint[e];
			if ((p->bmAttributes & 3) != LIBUSB_TRANSFER_TYPE_BULK)
				continue;
			if (p->bEndpointAddress & LIBUSB_ENDPOINT_IN)
				u->in = p->bEndpointAddress;
			else
				u->out = p->bEndpointAddress;
		}
	}
	libusb_free_config_descriptor(c);
	return u->in && u->out;
}

static int claim(struct usb_wire *u)
{
	int code = 0;
	/* The kernel's driver of modems gives the lidar back when we are done. */
	libusb_set_auto_detach_kernel_driver(u->handle, 1);
	if (u->make->control_interface >= 0)
		code = libusb_claim_interface(u->handle, u->make->control_interface);
	return code < 0 ? code : libusb_claim_interface(u->handle, u->make->data_interface);
}

/* Lines of modems have a speed, which means nothing here, and a pin that says that somebody listens. */
static bool apply_line(struct usb_wire *u, GError **error)
{
	const struct wire_line *l = &u->line;
	uint8_t coding[7] = { (uint8_t)l->baud, (uint8_t)(l->baud >> 8), (uint8_t)(l->baud >> 16),
		(uint8_t)(l->baud >> 24), 0, 0, 8 };
	uint16_t pins = (l->dtr ? CDC_DTR : 0) | CDC_RTS,
		 interface = (uint16_t)u->make->control_interface;
	const uint8_t type = LIBUSB_REQUEST_TYPE_CLASS | LIBUSB_RECIPIENT_INTERFACE;
	if (u->make->control_interface < 0)
		return true;
	int code = libusb_control_transfer(u->handle, type, CDC_SET_LINE_CODING, 0, interface,
		coding, sizeof coding, CONTROL_MS);
	if (code >= 0)
		code = libusb_control_transfer(u->handle, type, CDC_SET_CONTROL_LINE_STATE, pins,
			interface, NULL, 0, CONTROL_MS);
	return code >= 0 || refuse_open(u, libusb_get_device(u->handle), code, error);
}

static bool open_device(struct usb_wire *u, libusb_device *device, GError **error)
{
	int code = libusb_open(device, &u->handle);
	if (code == 0)
		code = claim(u);
	if (code < 0)
		return refuse_open(u, device, code, error);
	if (!find_endpoints(u, device))
		return say(WIRE_ERROR_BROKEN, error,
			"the %s has no endpoints to talk through: is it one?", u->make->name);
	/* Whoever had it last may have left it halted. */
	libusb_clear_halt(u->handle, u->in);
	return apply_line(u, error);
}

static void usb_close(wire *w)
{
	struct usb_wire *u = (struct usb_wire *)w;
	g_atomic_int_set(&u->stop, 1);
	if (u->thread)
		g_thread_join(g_steal_pointer(&u->thread));
	g_clear_pointer(&u->handle, libusb_close);
	inbox_clear(u->inbox);
}

static bool usb_open(wire *w, GError **error)
{
	struct usb_wire *u = (struct usb_wire *)w;
	usb_close(w);
	libusb_device *device = find_device(u, error);
	bool good = device && open_device(u, device, error);
	if (device)
		libusb_unref_device(device);
	if (!good) {
		usb_close(w);
		return false;
	}
	for (int i = 0; i < READS; i++)
		libusb_fill_bulk_transfer(u->reads[i], u->handle, u->in, u->reads[i]->buffer,
			READ_BYTES, read_is_back, u, 0);
	u->stop = u->stalled = u->flying = u->failed = 0;
	u->thread = g_thread_new("usb-events", run_events, u);
	return true;
}

/* ---- the rest of a wire ---- */

static gssize usb_read(wire *w, void *bytes, size_t size, int64_t *ret_arrival_ns, GError **error)
{
	return inbox_take(((struct usb_wire *)w)->inbox, bytes, size, ret_arrival_ns, error);
}

static bool usb_write(wire *w, const void *bytes, size_t length, GError **error)
{
	struct usb_wire *u = (struct usb_wire *)w;
	for (size_t sent = 0; sent < length;) {
		int n = 0;
		int code =
			u->handle ? libusb_bulk_transfer(u->handle, u->out, (uint8_t *)bytes + sent,
					    (int)(length - sent), &n, WRITE_MS)
				  : LIBUSB_ERROR_NO_DEVICE;
		sent += (size_t)n;
		if (code == LIBUSB_ERROR_PIPE && libusb_clear_halt(u->handle, u->out) == 0)
			code = 0;
		if (code == LIBUSB_ERROR_TIMEOUT && n > 0)
			code = 0;
		if (code == LIBUSB_ERROR_TIMEOUT)
			return say(WIRE_ERROR_GONE, error,
				"the lidar takes no commands: it is plugged in, but does not "
				"listen");
		if (code < 0)
			return say(WIRE_ERROR_GONE, error, "the lidar was unplugged");
	}
	return true;
}

static bool usb_set_line(wire *w, const struct wire_line *line, GError **error)
{
	struct usb_wire *u = (struct usb_wire *)w;
	u->line = *line;
	return !u->handle || apply_line(u, error);
}

static void usb_count(wire *w, struct wire_counts *ret)
{
	inbox_count(((struct usb_wire *)w)->inbox, ret);
}

static int usb_wait_fd(wire *w)
{
	return inbox_fd(((struct usb_wire *)w)->inbox);
}

static void usb_free(wire *w)
{
	struct usb_wire *u = (struct usb_wire *)w;
	usb_close(w);
	for (int i = 0; i < READS; i++) {
		if (u->reads[i])
			g_free(u->reads[i]->buffer);
		libusb_free_transfer(u->reads[i]);
	}
	if (u->context)
		libusb_exit(u->context);
	inbox_free(u->inbox);
	g_free(u->port);
	g_free(u);
}

static const struct wire_ops usb_ops = { .open = usb_open,
	.read = usb_read,
	.write = usb_write,
	.close = usb_close,
	.set_line = usb_set_line,
	.count = usb_count,
	.wait_fd = usb_wait_fd,
	.free = usb_free };

wire *wire_new_usb(head *h, const parts *p, const char *scheme, GError **error)
{
	struct usb_wire *u = g_new0(struct usb_wire, 1);
	u->base = (wire){ &usb_ops, h };
	u->port = g_strdup(parts_rest(p));
	u->inbox = inbox_new(ROOM);
	u->line = (struct wire_line){ 115200, true };
	for (size_t i = 0; i < G_N_ELEMENTS(makes); i++)
		if (strcmp(makes[i].scheme, scheme) == 0)
			u->make = &makes[i];
	g_assert(u->make);
	int code = libusb_init(&u->context);
	if (code < 0) {
		u->context = NULL;
		say(WIRE_ERROR_BROKEN, error, "this machine's USB cannot be used: %s",
			libusb_strerror(code));
		usb_free(&u->base);
		return NULL;
	}
	for (int i = 0; i < READS; i++) {
		u->reads[i] = libusb_alloc_transfer(0);
		u->reads[i]->buffer = g_malloc(READ_BYTES);
	}
	return &u->base;
}
