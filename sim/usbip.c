#include "sim/usbip.h"
#include <string.h>

#define VERSION     0x0111
#define BUSID       "1-1"
#define BUSID_SIZE  32
#define DEVICE_SIZE 312
#define HEADER_SIZE 48 /* of a URB's message, either way */
#define URB_MAX     (1u << 20)
#define WAITING_MAX (256u << 10)
#define UNREAD_NS   INT64_C(300000000) /* nobody reads: the device was closed */

enum op { REQ_DEVLIST = 0x8005, REP_DEVLIST = 0x0005, REQ_IMPORT = 0x8003, REP_IMPORT = 0x0003 };
enum command { CMD_SUBMIT = 1, CMD_UNLINK = 2, RET_SUBMIT = 3, RET_UNLINK = 4 };
enum state { ASKS, IMPORTS, ATTACHED, OVER };
/* Linux's numbers, whatever this is built for: they go over the wire. */
enum { WIRE_EPIPE = 32, WIRE_EOVERFLOW = 75, WIRE_ECONNRESET = 104 };

struct urb {
	uint32_t seqnum, length;
};

struct usbip {
	const struct usb_gadget *gadget;
	const struct usbip_behind *behind;
	gpointer data;
	enum state state;
	struct usb_state usb;
	struct usb_line line;
	GByteArray *in, *out;
	GArray *reads;     /* struct urb, of the bulk endpoint to the host */
	GArray *notices;   /* struct urb, of the interrupt endpoint: never answered */
	GQueue waiting;    /* GBytes: deliveries */
	gsize taken;       /* of the first of them */
	gsize waits;       /* bytes in all of them */
	int64_t unread_ns; /* since when nobody reads */
	struct usbip_counts counts;
};

usbip *usbip_new(const struct usb_gadget *gadget, const struct usbip_behind *behind, gpointer data)
{
	usbip *u = g_new0(usbip, 1);

	u->gadget = gadget;
	u->behind = behind;
	u->data = data;
	u->line = (struct usb_line){ .baud = 9600, .data_bits = 8 };
	u->in = g_byte_array_new();
	u->out = g_byte_array_new();
	u->reads = g_array_new(FALSE, FALSE, sizeof(struct urb));
	u->notices = g_array_new(FALSE, FALSE, sizeof(struct urb));
	g_queue_init(&u->waiting);
	return u;
}

static void forget_waiting(usbip *u)
{
	g_queue_clear_full(&u->waiting, (GDestroyNotify)g_bytes_unref);
	u->taken = u->waits = 0;
}

void usbip_free(usbip *u)
{
	if (!u)
		return;
	forget_waiting(u);
	g_byte_array_unref(u->in);
	g_byte_array_unref(u->out);
	g_array_unref(u->reads);
	g_array_unref(u->notices);
	g_free(u);
}

GByteArray *usbip_output(usbip *u)
{
	return u->out;
}

bool usbip_is_attached(const usbip *u)
{
	return u->state == ATTACHED;
}

struct usbip_counts usbip_counts(const usbip *u)
{
	return u->counts;
}

static uint16_t read16(const uint8_t *p)
{
	return (uint16_t)(p[0] << 8 | p[1]);
}

static uint32_t read32(const uint8_t *p)
{
	return (uint32_t)read16(p) << 16 | read16(p + 2);
}

static void write16(uint8_t *p, uint32_t value)
{
	p[0] = (uint8_t)(value >> 8);
	p[1] = (uint8_t)value;
}

static void write32(uint8_t *p, uint32_t value)
{
	write16(p, value >> 16);
	write16(p + 2, value);
}

static void say_op(usbip *u, enum op code, uint32_t status)
{
	uint8_t head[8];

	write16(head, VERSION);
	write16(head + 2, code);
	write32(head + 4, status);
	g_byte_array_append(u->out, head, sizeof head);
}

static void say_device(usbip *u)
{
	const struct usb_gadget *g = u->gadget;
	uint8_t device[DEVICE_SIZE] = { 0 };

	g_strlcpy((char *)device, "/sys/devices/pleinair/usb1/" BUSID, 256);
	g_strlcpy((char *)device + 256, BUSID, BUSID_SIZE);
	write32(device + 288, 1); /* bus */
	write32(device + 292, 2); /* device */
	write32(device + 296, g->full_speed ? 2 : 3);
	write16(device + 300, g->vendor);
	write16(device + 302, g->product);
	write16(device + 304, g->release);
	device[306] = g->device_class;
	device[309] = u->usb.configured;
	device[310] = 1; /* configurations */
	device[311] = g->configuration[4];
	g_byte_array_append(u->out, device, sizeof device);
}

/* Class, subclass and protocol of each interface, found by walking through the descriptors. */
static void say_interfaces(usbip *u)
{
	const uint8_t *at = u->gadget->configuration;

	for (gsize i = 0; i < u->gadget->configuration_length; i += at[i]) {
		if (at[i + 1] == 4) {
			const uint8_t four[4] = { at[i + 5], at[i + 6], at[i + 7], 0 };

			g_byte_array_append(u->out, four, sizeof four);
		}
	}
}

static void say_devices(usbip *u)
{
	uint8_t count[4];

	write32(count, 1);
	say_op(u, REP_DEVLIST, 0);
	g_byte_array_append(u->out, count, sizeof count);
	say_device(u);
	say_interfaces(u);
	u->state = OVER;
}

void usbip_admit(usbip *u, bool present)
{
	if (u->state != IMPORTS)
		return;
	say_op(u, REP_IMPORT, present ? 0 : 1);
	u->state = present ? ATTACHED : OVER;
	if (present)
		say_device(u);
}

/* Bytes of the request that were understood; 0: not all of it is there; -1: nonsense. */
static gssize take_op(usbip *u, const uint8_t *bytes, gsize length)
{
	if (length < 8)
		return 0;
	if (read16(bytes) != VERSION)
		return -1;
	if (read16(bytes + 2) == REQ_DEVLIST) {
		say_devices(u);
		return 8;
	}
	if (read16(bytes + 2) != REQ_IMPORT)
		return -1;
	if (length < 8 + BUSID_SIZE)
		return 0;
	u->state = IMPORTS;
	if (strncmp((const char *)bytes + 8, BUSID, BUSID_SIZE) == 0)
		u->behind->import(u->data);
	else
		usbip_admit(u, false);
	return 8 + BUSID_SIZE;
}

static void say_ret(usbip *u, enum command command, uint32_t seqnum, int status, uint32_t actual)
{
	uint8_t head[HEADER_SIZE] = { 0 };

	write32(head, command);
	write32(head + 4, seqnum);
	write32(head + 20, (uint32_t)status);
	write32(head + 24, actual);
	g_byte_array_append(u->out, head, sizeof head);
	u->counts.transfers += command == RET_SUBMIT;
}

/* Fills one URB from the first delivery, which ends in a short packet: an empty one, if it is a multiple of
 * full ones. An URB that is no multiple of packets may be too short for the next of them, which is then lost. */
static void answer_read(usbip *u, const struct urb *urb)
{
	gsize whole, packet = u->gadget->packet;
	const uint8_t *bytes = g_bytes_get_data(g_queue_peek_head(&u->waiting), &whole);
	gsize left = whole - u->taken;
	bool overflows = left > urb->length && urb->length % packet != 0;
	gsize length = overflows ? urb->length - urb->length % packet : MIN(left, urb->length);
	gsize gone = overflows ? MIN(length + packet, left) : length;

	say_ret(u, RET_SUBMIT, urb->seqnum, overflows ? -WIRE_EOVERFLOW : 0, (uint32_t)length);
	g_byte_array_append(u->out, bytes + u->taken, (guint)length);
	u->counts.bytes_in += length;
	u->taken += gone;
	u->waits -= gone;
	if (left > urb->length || (left == urb->length && left % packet == 0))
		return;
	u->taken = 0;
	g_bytes_unref(g_queue_pop_head(&u->waiting));
}

static void answer_reads(usbip *u)
{
	guint answered = 0;

	while (answered < u->reads->len && (u->usb.in_halted || u->waiting.length > 0)) {
		struct urb urb = g_array_index(u->reads, struct urb, answered++);

		if (u->usb.in_halted)
			say_ret(u, RET_SUBMIT, urb.seqnum, -WIRE_EPIPE, 0);
		else
			answer_read(u, &urb);
	}
	g_array_remove_range(u->reads, 0, answered);
}

void usbip_deliver(usbip *u, const uint8_t *bytes, gsize length)
{
	if (u->state != ATTACHED || u->usb.in_halted || (u->gadget->is_line && !u->line.open))
		return;
	if (u->waits + length > WAITING_MAX) {
		u->counts.lost++;
		return;
	}
	g_queue_push_tail(&u->waiting, g_bytes_new(bytes, length));
	u->waits += length;
	u->counts.most_waiting = MAX(u->counts.most_waiting, u->waits);
	answer_reads(u);
}

void usbip_halt(usbip *u)
{
	u->usb.in_halted = true;
	forget_waiting(u);
	answer_reads(u);
}

static void begin(usbip *u)
{
	forget_waiting(u);
	u->behind->begin(u->data);
}

static int answer_control(usbip *u, const struct usb_setup *setup, uint8_t *data, gsize length)
{
	enum usb_change change;
	struct usb_line before = u->line;
	int got;

	if ((setup->request_type & USB_TYPE_MASK) == 0) {
		got = usb_standard(u->gadget, &u->usb, setup, data, &change);
		if (change == USB_CONFIGURED)
			begin(u);
		return got;
	}
	got = u->gadget->control ? u->gadget->control(&u->line, setup, data, length) : -1;
	if (u->line.open && !before.open)
		begin(u);
	if (memcmp(&before, &u->line, sizeof before) != 0)
		u->behind->line(u->data, &u->line);
	return got;
}

static void submit_control(usbip *u, uint32_t seqnum, const uint8_t *message, gsize length)
{
	const uint8_t *raw = message + 40; /* as it is on the bus: little-endian */
	struct usb_setup setup = { raw[0], raw[1], (uint16_t)(raw[2] | raw[3] << 8),
		(uint16_t)(raw[4] | raw[5] << 8), (uint16_t)(raw[6] | raw[7] << 8) };
	uint8_t data[USB_REPLY_MAX] = { 0 };
	bool to_host = setup.request_type & 0x80;

	if (!to_host)
		memcpy(data, message + HEADER_SIZE, MIN(length, sizeof data));
	int got = answer_control(u, &setup, data, MIN(length, sizeof data));
	uint32_t reply = to_host && got > 0 ? (uint32_t)MIN((gsize)got, length) : 0;

	say_ret(u, RET_SUBMIT, seqnum, got < 0 ? -WIRE_EPIPE : 0,
		to_host || got < 0 ? reply : (uint32_t)length);
	g_byte_array_append(u->out, data, reply);
}

/* Whoever closes a device takes its URBs back. Reading and then writing again, it is open anew. */
static void notice_opening(usbip *u, int64_t now_ns)
{
	if (u->reads->len == 0 && u->unread_ns && now_ns - u->unread_ns > UNREAD_NS &&
		!u->gadget->is_line)
		begin(u);
	u->unread_ns = 0;
}

static void submit_bulk(usbip *u, int64_t now_ns, const struct urb *urb, const uint8_t *bytes)
{
	notice_opening(u, now_ns);
	if (!bytes) {
		g_array_append_val(u->reads, *urb);
		answer_reads(u);
	} else if (u->usb.out_halted) {
		say_ret(u, RET_SUBMIT, urb->seqnum, -WIRE_EPIPE, 0);
	} else {
		u->counts.bytes_out += urb->length;
		u->behind->write(u->data, bytes, urb->length);
		say_ret(u, RET_SUBMIT, urb->seqnum, 0, urb->length);
	}
	if (u->reads->len == 0)
		u->unread_ns = now_ns;
}

static void submit(usbip *u, int64_t now_ns, const uint8_t *message, const struct urb *urb)
{
	bool to_host = read32(message + 12) != 0;
	uint8_t endpoint = (uint8_t)(read32(message + 16) & 15) | (to_host ? 0x80 : 0);

	if ((endpoint & 15) == 0)
		submit_control(u, urb->seqnum, message, urb->length);
	else if (endpoint == u->gadget->in)
		submit_bulk(u, now_ns, urb, NULL);
	else if (endpoint == u->gadget->out)
		submit_bulk(u, now_ns, urb, message + HEADER_SIZE);
	else if (endpoint == u->gadget->notify)
		g_array_append_val(u->notices, *urb);
	else
		say_ret(u, RET_SUBMIT, urb->seqnum, -WIRE_EPIPE, 0);
}

static bool forget_urb(GArray *urbs, uint32_t seqnum)
{
	for (guint i = 0; i < urbs->len; i++)
		if (g_array_index(urbs, struct urb, i).seqnum == seqnum) {
			g_array_remove_index(urbs, i);
			return true;
		}
	return false;
}

static void unlink_urb(usbip *u, int64_t now_ns, uint32_t seqnum, uint32_t which)
{
	bool was_reading = u->reads->len > 0;
	bool found = forget_urb(u->reads, which) || forget_urb(u->notices, which);

	if (was_reading && u->reads->len == 0)
		u->unread_ns = now_ns;
	say_ret(u, RET_UNLINK, seqnum, found ? -WIRE_ECONNRESET : 0, 0);
}

/* As take_op(). */
static gssize take_urb(usbip *u, int64_t now_ns, const uint8_t *bytes, gsize length)
{
	if (length < HEADER_SIZE)
		return 0;
	uint32_t command = read32(bytes);
	struct urb urb = { read32(bytes + 4), read32(bytes + 24) };

	if (command == CMD_UNLINK) {
		unlink_urb(u, now_ns, urb.seqnum, read32(bytes + 20));
		return HEADER_SIZE;
	}
	if (command != CMD_SUBMIT || urb.length > URB_MAX)
		return -1;
	gsize follows = read32(bytes + 12) == 0 ? urb.length : 0;

	if (length < HEADER_SIZE + follows)
		return 0;
	submit(u, now_ns, bytes, &urb);
	return (gssize)(HEADER_SIZE + follows);
}

bool usbip_receive(usbip *u, int64_t now_ns, const uint8_t *bytes, gsize length)
{
	gsize at = 0;
	gssize took = 1;

	g_byte_array_append(u->in, bytes, (guint)length);
	while (took > 0 && (u->state == ASKS || u->state == ATTACHED)) {
		const uint8_t *next = u->in->data + at;
		gsize left = u->in->len - at;

		took = u->state == ASKS ? take_op(u, next, left) : take_urb(u, now_ns, next, left);
		at += took > 0 ? (gsize)took : 0;
	}
	g_byte_array_remove_range(u->in, 0, (guint)at);
	if (took < 0 || (u->state == IMPORTS && u->in->len > 0))
		u->state = OVER;
	return u->state != OVER;
}
