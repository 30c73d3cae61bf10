#include "sim/usb.h"
#include <string.h>

/* USB class definitions for communication devices 1.1, with the subclass PSTN 1.2: an abstract
 * control model without AT commands. */
static const uint8_t configuration[] = {
	9, 2, 67, 0, 2, 1, 0, 0xc0, 50, 9, 4, 0, 0, 1, 2, 2, 0, 0, /* interface 0: control */
	5, 0x24, 0, 0x10, 0x01,                                    /* header: CDC 1.10 */
	5, 0x24, 1, 0, 1,           /* call management: none, by interface 1 */
	4, 0x24, 2, 2,              /* ACM: line coding, control line state */
	5, 0x24, 6, 0, 1,           /* union of 0 and 1 */
	7, 5, 0x82, 3, 8, 0, 16,    /* notifications */
	9, 4, 1, 0, 2, 10, 0, 0, 0, /* interface 1: data */
	7, 5, 0x81, 2, 64, 0, 0,    /* bulk IN */
	7, 5, 0x03, 2, 64, 0, 0,    /* bulk OUT */
};

enum {
	SET_LINE_CODING = 0x20,
	GET_LINE_CODING = 0x21,
	SET_CONTROL_LINE_STATE = 0x22,
	SEND_BREAK = 0x23
};

static int control(
	struct usb_line *line, const struct usb_setup *setup, uint8_t *data, gsize length)
{
	if ((setup->request_type & USB_TYPE_MASK) != USB_TYPE_CLASS)
		return -1;
	switch (setup->request) {
	case SET_LINE_CODING:
		if (length < 7)
			return -1;
		line->baud = data[0] | data[1] << 8 | data[2] << 16 | (uint32_t)data[3] << 24;
		line->stop_bits = data[4];
		line->parity = data[5];
		line->data_bits = data[6];
		return 0;
	case GET_LINE_CODING:
		for (int i = 0; i < 4; i++)
			data[i] = (uint8_t)(line->baud >> 8 * i);
		data[4] = line->stop_bits;
		data[5] = line->parity;
		data[6] = line->data_bits;
		return 7;
	case SET_CONTROL_LINE_STATE: line->open = line->dtr = setup->value & 1; return 0;
	case SEND_BREAK: return 0;
	default: return -1;
	}
}

const struct usb_gadget usb_hokuyo = { .name = "hokuyo",
	.full_speed = true,
	.vendor = 0x15d1,
	.product = 0x0000,
	.release = 0x0100,
	.device_class = 2, /* communications */
	.configuration = configuration,
	.configuration_length = sizeof configuration,
	.strings = { NULL, "Hokuyo Automatic Co, Ltd.", "URG-Series USB Driver", NULL },
	.in = 0x81,
	.out = 0x03,
	.notify = 0x82,
	.packet = 64,
	.is_line = true,
	.control = control };
