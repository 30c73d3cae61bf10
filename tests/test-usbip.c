/* A lidar's plug over USB/IP, by a client that knows the protocol from its document alone and no socket. */
#include "sim/usbip.h"
#include <string.h>

#define SECOND INT64_C(1000000000)

enum { SUBMIT = 1, UNLINK = 2 };

struct host {
	usbip *usb;
	int64_t now_ns;
	guint imports, begins, lines;
	struct usb_line line;
	GString *written;
	uint32_t seqnum;
	gsize taken; /* of what it said */
};

static void on_import(gpointer data)
{
	((struct host *)data)->imports++;
}

static void on_begin(gpointer data)
{
	((struct host *)data)->begins++;
}

static void on_line(gpointer data, const struct usb_line *line)
{
	((struct host *)data)->lines++;
	((struct host *)data)->line = *line;
}

static void on_write(gpointer data, const uint8_t *bytes, gsize length)
{
	g_string_append_len(((struct host *)data)->written, (const char *)bytes, (gssize)length);
}

static const struct usbip_behind behind = { on_import, on_begin, on_line, on_write };

static uint32_t read32(const uint8_t *p)
{
	return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static void write32(uint8_t *p, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		p[i] = (uint8_t)(value >> (24 - 8 * i));
}

/* What was said since last asked. */
static const uint8_t *heard(struct host *h, gsize length)
{
	GByteArray *out = usbip_output(h->usb);

	g_assert_cmpuint(out->len - h->taken, >=, length);
	h->taken += length;
	return out->data + h->taken - length;
}

static gsize unheard(struct host *h)
{
	return usbip_output(h->usb)->len - h->taken;
}

static bool say(struct host *h, const void *bytes, gsize length)
{
	return usbip_receive(h->usb, h->now_ns, bytes, length);
}

static void ask_import(struct host *h, const char *busid)
{
	uint8_t request[40] = { 0x01, 0x11, 0x80, 0x03 };

	g_strlcpy((char *)request + 8, busid, 32);
	say(h, request, 7); /* in pieces, as a network may */
	say(h, request + 7, sizeof request - 7);
}

static struct host *plugged(const struct usb_gadget *gadget)
{
	struct host *h = g_new0(struct host, 1);

	h->now_ns = SECOND;
	h->written = g_string_new(NULL);
	h->usb = usbip_new(gadget, &behind, h);
	ask_import(h, "1-1");
	g_assert_cmpuint(h->imports, ==, 1);
	g_assert_cmpuint(unheard(h), ==, 0);
	usbip_admit(h->usb, true);
	const uint8_t *reply = heard(h, 8 + 312);

	g_assert_cmpuint(read32(reply), ==, 0x01110003);
	g_assert_cmpuint(read32(reply + 4), ==, 0);
	g_assert_cmpuint(
		read32(reply + 8 + 300), ==, (uint32_t)gadget->vendor << 16 | gadget->product);
	g_assert_true(usbip_is_attached(h->usb));
	return h;
}

static void unplug(struct host *h)
{
	usbip_free(h->usb);
	g_string_free(h->written, TRUE);
	g_free(h);
}

static uint32_t submit(
	struct host *h, uint8_t endpoint, const uint8_t *setup, const void *data, uint32_t length)
{
	uint8_t message[48] = { 0 };
	bool to_host = endpoint & 0x80;

	write32(message, SUBMIT);
	write32(message + 4, ++h->seqnum);
	write32(message + 12, to_host);
	write32(message + 16, endpoint & 15);
	write32(message + 24, length);
	if (setup)
		memcpy(message + 40, setup, 8);
	g_assert_true(say(h, message, sizeof message));
	if (!to_host && length)
		g_assert_true(say(h, data, length));
	return h->seqnum;
}

/* The next answer: the number of its bytes, or its error, below 0. */
static int answer(struct host *h, uint32_t seqnum, const uint8_t **ret_bytes)
{
	const uint8_t *head = heard(h, 48);
	int status = (int)read32(head + 20), actual = (int)read32(head + 24);

	g_assert_cmpuint(read32(head), ==, 3);
	g_assert_cmpuint(read32(head + 4), ==, seqnum);
	if (ret_bytes)
		*ret_bytes = heard(h, (gsize)actual);
	return status ? status : actual;
}

static int control(struct host *h, uint8_t type, uint8_t request, uint16_t value, uint16_t index,
	const void *data, uint16_t length, const uint8_t **ret_bytes)
{
	const uint8_t setup[8] = { type, request, (uint8_t)value, value >> 8, (uint8_t)index,
		index >> 8, (uint8_t)length, length >> 8 };
	uint32_t seqnum = submit(h, type & 0x80, setup, data, length);

	return answer(h, seqnum, type & 0x80 ? ret_bytes : NULL);
}

static void test_list(void)
{
	g_autoptr(usbip) usb = usbip_new(&usb_hokuyo, &behind, NULL);
	const uint8_t request[8] = { 0x01, 0x11, 0x80, 0x05 };

	g_assert_false(usbip_receive(usb, 0, request, sizeof request)); /* all is told */
	const GByteArray *out = usbip_output(usb);

	g_assert_cmpuint(out->len, ==, 12 + 312 + 2 * 4);
	g_assert_cmpuint(read32(out->data), ==, 0x01110005);
	g_assert_cmpstr((const char *)out->data + 12 + 256, ==, "1-1");
	g_assert_cmpuint(read32(out->data + 12 + 300), ==, 0x15d10000);
	g_assert_cmpmem(
		out->data + 12 + 312, 8, "\x02\x02\x00\x00\x0a\x00\x00\x00", 8); /* control, data */
}

static void test_refusals(void)
{
	struct host h = { .usb = usbip_new(&usb_sick, &behind, &h) };

	ask_import(&h, "1-2");
	g_assert_cmpuint(h.imports, ==, 0);
	g_assert_cmpuint(read32(heard(&h, 8) + 4), ==, 1);
	usbip_free(h.usb);
	h = (struct host){ .usb = usbip_new(&usb_sick, &behind, &h) };
	ask_import(&h, "1-1");
	usbip_admit(h.usb, false);
	g_assert_cmpuint(read32(heard(&h, 8) + 4), ==, 1);
	g_assert_false(usbip_is_attached(h.usb));
	usbip_free(h.usb);
	h = (struct host){ .usb = usbip_new(&usb_sick, &behind, &h) };
	g_assert_false(say(&h, "GET / HTTP/1.0\r\n\r\n", 18));
	usbip_free(h.usb);
}

static void test_enumeration(void)
{
	struct host *h = plugged(&usb_sick);
	const uint8_t *bytes;

	g_assert_cmpint(control(h, 0x80, 6, 0x0100, 0, NULL, 64, &bytes), ==, 18);
	g_assert_cmpmem(bytes + 8, 4, "\xa2\x19\x01\x50", 4);
	g_assert_cmpint(control(h, 0x80, 6, 0x0200, 0, NULL, 9, &bytes), ==,
		9); /* only as much as was asked for */
	int total = bytes[2];

	g_assert_cmpint(control(h, 0x80, 6, 0x0200, 0, NULL, 255, &bytes), ==, total);
	g_assert_cmpmem(
		bytes + 18, 14, "\x07\x05\x81\x02\x40\x00\x00\x07\x05\x02\x02\x40\x00\x00", 14);
	g_assert_cmpint(control(h, 0x80, 6, 0x0301, 0x409, NULL, 255, &bytes), ==, 2 + 2 * 7);
	g_assert_cmpmem(bytes + 2, 14, "S\0I\0C\0K\0 \0A\0G", 14);
	g_assert_cmpint(control(h, 0x80, 6, 0x0600, 0, NULL, 10, &bytes), ==,
		-32); /* a qualifier: full speed only */
	g_assert_cmpint(control(h, 0x80, 8, 0, 0, NULL, 1, &bytes), ==, 1);
	g_assert_cmpuint(bytes[0], ==, 0);
	g_assert_cmpint(control(h, 0, 9, 1, 0, NULL, 0, NULL), ==, 0);
	g_assert_cmpuint(h->begins, ==, 1);
	g_assert_cmpint(control(h, 0x80, 8, 0, 0, NULL, 1, &bytes), ==, 1);
	g_assert_cmpuint(bytes[0], ==, 1);
	g_assert_cmpint(
		control(h, 0, 9, 2, 0, NULL, 0, NULL), ==, -32); /* there is no second one */
	unplug(h);
}

static void deliver(struct host *h, gsize length)
{
	g_autofree uint8_t *bytes = g_malloc(length + 1);

	for (gsize i = 0; i < length; i++)
		bytes[i] = (uint8_t)(i * 7);
	usbip_deliver(h->usb, bytes, length);
}

static void test_transfers(void)
{
	struct host *h = plugged(&usb_sick);
	const uint8_t *bytes;
	uint32_t first = submit(h, 0x81, NULL, NULL, 65536),
		 second = submit(h, 0x81, NULL, NULL, 65536);

	g_assert_cmpuint(unheard(h), ==, 0); /* nothing there: they wait */
	deliver(h, 100);
	g_assert_cmpint(answer(h, first, &bytes), ==, 100);
	g_assert_cmpuint(bytes[99], ==, (uint8_t)(99 * 7));
	/* A multiple of packets: ended by an empty one, within the same URB. */
	deliver(h, 128);
	g_assert_cmpint(answer(h, second, &bytes), ==, 128);
	/* One that fills URBs to their end leaves the empty packet to the next. */
	deliver(h, 128);
	g_assert_cmpint(answer(h, submit(h, 0x81, NULL, NULL, 64), &bytes), ==, 64);
	g_assert_cmpint(answer(h, submit(h, 0x81, NULL, NULL, 64), &bytes), ==, 64);
	g_assert_cmpuint(bytes[0], ==, (uint8_t)(64 * 7));
	g_assert_cmpint(answer(h, submit(h, 0x81, NULL, NULL, 64), &bytes), ==, 0);
	/* A read that is no multiple of packets has no room for the next. */
	deliver(h, 200);
	g_assert_cmpint(answer(h, submit(h, 0x81, NULL, NULL, 100), NULL), ==, -75);
	heard(h, 64); /* the packet that fitted */
	g_assert_cmpint(answer(h, submit(h, 0x81, NULL, NULL, 100), &bytes), ==, 72);
	g_assert_cmpint(answer(h, submit(h, 0x02, NULL, "\2sRI0\3", 6), NULL), ==, 6);
	g_assert_cmpstr(h->written->str, ==, "\2sRI0\3");
	g_assert_cmpint(
		answer(h, submit(h, 0x05, NULL, "x", 1), NULL), ==, -32); /* no such endpoint */
	unplug(h);
}

static void take_back(struct host *h, uint32_t which, int expect)
{
	uint8_t message[48] = { 0 };

	write32(message, UNLINK);
	write32(message + 4, ++h->seqnum);
	write32(message + 20, which);
	g_assert_true(say(h, message, sizeof message));
	const uint8_t *reply = heard(h, 48);

	g_assert_cmpuint(read32(reply), ==, 4);
	g_assert_cmpuint(read32(reply + 4), ==, h->seqnum);
	g_assert_cmpint((int)read32(reply + 20), ==, expect);
}

static void test_unlink(void)
{
	struct host *h = plugged(&usb_sick);
	uint32_t first = submit(h, 0x81, NULL, NULL, 512),
		 second = submit(h, 0x81, NULL, NULL, 512);

	take_back(h, first, -104);
	take_back(h, first, 0); /* is no more */
	deliver(h, 10);
	g_assert_cmpint(answer(h, second, NULL), ==, 10);
	heard(h, 10);
	unplug(h);
}

/* Whoever closes the device takes its reads back; opening it again, he finds nothing of before. A reader that
 * gives up each second and reads again loses nothing. */
static void test_opening(void)
{
	struct host *h = plugged(&usb_sick);

	take_back(h, submit(h, 0x81, NULL, NULL, 512), -104);
	h->now_ns += SECOND / 100;
	submit(h, 0x81, NULL, NULL, 512);
	g_assert_cmpuint(h->begins, ==, 0);
	take_back(h, h->seqnum, -104);
	deliver(h, 30);
	h->now_ns += SECOND;
	g_assert_cmpint(answer(h, submit(h, 0x02, NULL, "a", 1), NULL), ==, 1);
	g_assert_cmpuint(h->begins, ==, 1);
	submit(h, 0x81, NULL, NULL, 512);
	g_assert_cmpuint(h->begins, ==, 1);
	g_assert_cmpuint(unheard(h), ==, 0);
	unplug(h);
}

static void test_halt(void)
{
	struct host *h = plugged(&usb_sick);
	uint32_t waits = submit(h, 0x81, NULL, NULL, 512);
	const uint8_t *bytes;

	usbip_halt(h->usb);
	g_assert_cmpint(answer(h, waits, NULL), ==, -32);
	deliver(h, 20);
	g_assert_cmpint(answer(h, submit(h, 0x81, NULL, NULL, 512), NULL), ==, -32);
	g_assert_cmpint(control(h, 0x82, 0, 0, 0x81, NULL, 2, &bytes), ==, 2);
	g_assert_cmpuint(bytes[0], ==, 1);
	g_assert_cmpint(control(h, 0x02, 1, 0, 0x81, NULL, 0, NULL), ==, 0);
	waits = submit(h, 0x81, NULL, NULL, 512);
	deliver(h, 21);
	g_assert_cmpint(answer(h, waits, NULL), ==, 21);
	heard(h, 21);
	unplug(h);
}

static void test_nobody_reads(void)
{
	struct host *h = plugged(&usb_sick);

	for (int i = 0; i < 70; i++)
		deliver(h, 4000);
	struct usbip_counts counts = usbip_counts(h->usb);

	g_assert_cmpuint(counts.lost, ==, 70 - (256 << 10) / 4000);
	g_assert_cmpint(answer(h, submit(h, 0x81, NULL, NULL, 65536), NULL), ==, 4000);
	heard(h, 4000);
	unplug(h);
}

static void test_hokuyo_line(void)
{
	struct host *h = plugged(&usb_hokuyo);
	const uint8_t *bytes;
	uint32_t notice = submit(h, 0x82, NULL, NULL, 8);

	deliver(h, 10); /* nobody has the port open */
	g_assert_cmpint(
		control(h, 0x21, 0x20, 0, 0, "\x00\xc2\x01\x00\x00\x00\x08", 7, NULL), ==, 7);
	g_assert_cmpuint(h->line.baud, ==, 115200);
	g_assert_cmpuint(h->begins, ==, 0);
	g_assert_cmpint(control(h, 0xa1, 0x21, 0, 0, NULL, 7, &bytes), ==, 7);
	g_assert_cmpmem(bytes, 7, "\x00\xc2\x01\x00\x00\x00\x08", 7);
	g_assert_cmpint(control(h, 0x21, 0x22, 3, 0, NULL, 0, NULL), ==, 0);
	g_assert_true(h->line.open);
	g_assert_cmpuint(h->begins, ==, 1);
	uint32_t waits = submit(h, 0x81, NULL, NULL, 128);

	deliver(h, 11);
	g_assert_cmpint(answer(h, waits, NULL), ==, 11);
	heard(h, 11);
	g_assert_cmpint(control(h, 0x21, 0x22, 0, 0, NULL, 0, NULL), ==, 0);
	g_assert_false(h->line.open);
	g_assert_cmpint(control(h, 0x21, 0x42, 0, 0, NULL, 0, NULL), ==, -32);
	take_back(h, notice, -104);
	unplug(h);
}

static void test_bridge_line(void)
{
	struct host *h = plugged(&usb_cp2102);
	const uint8_t *bytes;

	g_assert_cmpint(control(h, 0xc0, 0xff, 0x370b, 0, NULL, 1, &bytes), ==, 1);
	g_assert_cmpuint(bytes[0], ==, 2);
	g_assert_cmpint(control(h, 0x41, 0x00, 1, 0, NULL, 0, NULL), ==, 0);
	g_assert_true(h->line.open);
	g_assert_cmpint(control(h, 0x41, 0x1e, 0, 0, "\x00\x10\x0e\x00", 4, NULL), ==, 4);
	g_assert_cmpuint(h->line.baud, ==, 921600);
	g_assert_cmpint(control(h, 0xc1, 0x1d, 0, 0, NULL, 4, &bytes), ==, 4);
	g_assert_cmpmem(bytes, 4, "\x00\x10\x0e\x00", 4);
	g_assert_cmpint(control(h, 0x41, 0x03, 0x0800, 0, NULL, 0, NULL), ==, 0);
	g_assert_cmpint(control(h, 0xc1, 0x10, 0, 0, NULL, 19, &bytes), ==, 19);
	g_assert_cmpint(control(h, 0xc1, 0x08, 0, 0, NULL, 1, &bytes), ==, 1);
	g_assert_cmpint(control(h, 0x41, 0x00, 0, 0, NULL, 0, NULL), ==, 0);
	g_assert_false(h->line.open);
	unplug(h);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/usbip/list", test_list);
	g_test_add_func("/usbip/refusals", test_refusals);
	g_test_add_func("/usbip/enumeration", test_enumeration);
	g_test_add_func("/usbip/transfers", test_transfers);
	g_test_add_func("/usbip/unlink", test_unlink);
	g_test_add_func("/usbip/opening", test_opening);
	g_test_add_func("/usbip/halt", test_halt);
	g_test_add_func("/usbip/nobody-reads", test_nobody_reads);
	g_test_add_func("/usbip/hokuyo-line", test_hokuyo_line);
	g_test_add_func("/usbip/bridge-line", test_bridge_line);
	return g_test_run();
}
