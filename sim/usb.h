#ifndef SIM_USB_H
#define SIM_USB_H
/* What a lidar's USB plug is, as the kernel of a host sees it: descriptors, the answers to control
 * requests, one bulk endpoint each way that carries the lidar's bytes. A table of constants and a
 * function per make, one file each (usb-NAME.c); usbip.h puts it on a wire.
 *
 * Sources: USB 2.0, chapter 9; for what the makes are, DEVICES 2.1.1, 2.2, 2.3. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define USB_REPLY_MAX 512 /* no control request is answered with more */

/* As the first eight bytes of a control transfer have it. */
struct usb_setup {
	uint8_t request_type, request;
	uint16_t value, index, length;
};
#define USB_TYPE_MASK      0x60
#define USB_TYPE_CLASS     0x20
#define USB_TYPE_VENDOR    0x40
#define USB_RECIPIENT_MASK 0x1f

/* A serial line behind the plug, as the host set it. */
struct usb_line {
	uint32_t baud;
	uint8_t stop_bits, parity, data_bits; /* as CDC's line coding codes them */
	bool open; /* somebody has the port open: DTR, or the bridge is enabled */
	bool dtr;  /* asserted */
};

struct usb_gadget {
	const char *name;
	bool full_speed; /* else high speed */
	uint16_t vendor, product, release;
	uint8_t device_class;
	const uint8_t
		*configuration; /* the whole descriptor: interfaces, endpoints, functional ones */
	gsize configuration_length;
	const char *strings[4]; /* ASCII; 1 the maker, 2 the product, 3 the serial number */
	uint8_t in, out;        /* addresses of the bulk endpoints */
	uint8_t notify;         /* of an interrupt endpoint, on which nothing comes; 0: none */
	uint16_t packet;        /* bytes, of the bulk endpoints */
	bool is_line; /* a serial line, which the host opens and closes by control requests */
	/* Class and vendor requests. Data is what the host sends, or room for USB_REPLY_MAX bytes; the
	 * number of bytes of the reply, or -1: the device knows no such request. NULL: knows none. */
	int (*control)(
		struct usb_line *line, const struct usb_setup *setup, uint8_t *data, gsize length);
};

extern const struct usb_gadget usb_sick;   /* TiM5xx: vendor bulk */
extern const struct usb_gadget usb_hokuyo; /* URG, UTM: CDC-ACM */
extern const struct usb_gadget usb_cp2102; /* Silicon Labs' bridge before an UART: RPLIDAR, LD06 */

/* The state of a plug in a host, and the answers that all devices give (USB 2.0, 9.4). */
struct usb_state {
	uint8_t configured;
	bool in_halted, out_halted;
};
enum usb_change {
	USB_SAME,
	USB_CONFIGURED, /* also anew: whoever does so begins from the beginning */
	USB_IN_CLEARED, /* the halt of the bulk endpoint to the host was cleared */
};
/* The number of bytes of the reply, or -1: no such request or thing. */
int usb_standard(const struct usb_gadget *gadget, struct usb_state *state,
	const struct usb_setup *setup, uint8_t *data, enum usb_change *ret_change);

/* By its name (sick, hokuyo, cp2102), or NULL. */
const struct usb_gadget *usb_gadget_by_name(const char *name);
/* The one that a lidar of this protocol has. */
const struct usb_gadget *usb_gadget_of(const char *protocol);

#endif
