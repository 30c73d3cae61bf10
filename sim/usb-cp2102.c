#include "sim/usb.h"
#include <string.h>

/* Silicon Labs AN571, "CP210x Virtual COM Port Interface": what a driver asks a CP2102. */
static const uint8_t configuration[] = {
	9,
	2,
	32,
	0,
	1,
	1,
	0,
	0x80,
	50,
	9,
	4,
	0,
	0,
	2,
	0xff,
	0,
	0,
	2,
	7,
	5,
	0x81,
	2,
	64,
	0,
	0,
	7,
	5,
	0x01,
	2,
	64,
	0,
	0,
};

enum request {
	IFC_ENABLE = 0x00,
	SET_BAUDDIV = 0x01,
	SET_LINE_CTL = 0x03,
	GET_LINE_CTL = 0x04,
	SET_BREAK = 0x05,
	SET_MHS = 0x07,
	GET_MDMSTS = 0x08,
	SET_XON = 0x09,
	SET_XOFF = 0x0a,
	GET_PROPS = 0x0f,
	GET_COMM_STATUS = 0x10,
	RESET = 0x11,
	PURGE = 0x12,
	SET_FLOW = 0x13,
	GET_FLOW = 0x14,
	SET_CHARS = 0x19,
	GET_BAUDRATE = 0x1d,
	SET_BAUDRATE = 0x1e,
	VENDOR_SPECIFIC = 0xff,
};
#define GET_PARTNUM 0x370b /* the value of a VENDOR_SPECIFIC request */
#define PART_CP2102 0x02
#define BAUD_BASE   3686400 /* of SET_BAUDDIV */

static int reply(uint8_t *data, gsize length, uint32_t first)
{
	memset(data, 0, length);
	for (gsize i = 0; i < MIN(length, 4); i++)
		data[i] = (uint8_t)(first >> 8 * i);
	return (int)length;
}

/* SET_LINE_CTL: stop bits in bits 0-3, parity in 4-7, data bits in 8-15. */
static int set_line(struct usb_line *line, uint16_t value)
{
	line->stop_bits = value & 15;
	line->parity = value >> 4 & 15;
	line->data_bits = (uint8_t)(value >> 8);
	return line->data_bits < 5 || line->data_bits > 8 ? -1 : 0;
}

static int get(const struct usb_line *line, const struct usb_setup *setup, uint8_t *data)
{
	switch (setup->request) {
	case GET_LINE_CTL:
		return reply(data, 2, line->stop_bits | line->parity << 4 | line->data_bits << 8);
	case GET_MDMSTS:
		return reply(data, 1, 0x30 | (line->open ? 3 : 0)); /* CTS, DSR; DTR, RTS */
	case GET_PROPS: return reply(data, 64, 64);
	case GET_COMM_STATUS: return reply(data, 19, 0); /* no errors, empty queues */
	case GET_FLOW: return reply(data, 16, 0);
	case GET_BAUDRATE: return reply(data, 4, line->baud);
	case VENDOR_SPECIFIC: return setup->value == GET_PARTNUM ? reply(data, 1, PART_CP2102) : -1;
	default: return -1;
	}
}

static int set(
	struct usb_line *line, const struct usb_setup *setup, const uint8_t *data, gsize length)
{
	switch (setup->request) {
	case IFC_ENABLE: line->open = setup->value & 1; return 0;
	case SET_BAUDRATE:
		if (length < 4)
			return -1;
		line->baud = data[0] | data[1] << 8 | data[2] << 16 | (uint32_t)data[3] << 24;
		return 0;
	case SET_BAUDDIV: line->baud = setup->value ? BAUD_BASE / setup->value : 0; return 0;
	case SET_LINE_CTL: return set_line(line, setup->value);
	case SET_MHS:
		/* DTR in bit 0, if bit 8 says that it is meant. */
		line->dtr = setup->value & 0x100 ? setup->value & 1 : line->dtr;
		return 0;
	case SET_BREAK:
	case SET_XON:
	case SET_XOFF:
	case RESET:
	case PURGE:
	case SET_FLOW:
	case SET_CHARS: return 0;
	default: return -1;
	}
}

static int control(
	struct usb_line *line, const struct usb_setup *setup, uint8_t *data, gsize length)
{
	if ((setup->request_type & USB_TYPE_MASK) != USB_TYPE_VENDOR)
		return -1;
	return setup->request_type & 0x80 ? get(line, setup, data) : set(line, setup, data, length);
}

const struct usb_gadget usb_cp2102 = { .name = "cp2102",
	.full_speed = true,
	.vendor = 0x10c4,
	.product = 0xea60,
	.release = 0x0100,
	.configuration = configuration,
	.configuration_length = sizeof configuration,
	.strings = { NULL, "Silicon Labs", "CP2102 USB to UART Bridge Controller", "0001" },
	.in = 0x81,
	.out = 0x01,
	.packet = 64,
	.is_line = true,
	.control = control };
