#ifndef SIM_USBIP_H
#define SIM_USBIP_H
/* One connection of a USB/IP client (Linux: vhci_hcd, whose devices are to a host's drivers what a
 * plugged one is) with a gadget (usb.h): bytes in, bytes out, nothing of sockets. The client first
 * asks what there is and imports it, as busid 1-1; from then on it sends transfers (URBs), which are
 * answered in the order in which they can be.
 *
 * What the lidar says comes in deliveries. Each is a transfer of the device: packets, the last of
 * them short, if need be empty. An URB to the host ends with a short packet or when it is full, as
 * with a real controller; while none is asked for, deliveries wait, up to 256 KiB, and are lost
 * beyond that, whole. No bandwidth is kept to: all that is ready goes at once.
 *
 * Numbers are big-endian (Linux: Documentation/usb/usbip_protocol.rst). One owner; not thread-safe. */
#include "sim/usb.h"

/* What is behind the plug. Each is called from within usbip_receive(). */
struct usbip_behind {
	void (*import)(gpointer data); /* wants the device: usbip_admit() answers, now or later */
	/* The host begins anew: it set the configuration, or nobody read for a while, or it opened the
	 * line. What was not yet read is gone. */
	void (*begin)(gpointer data);
	void (*line)(gpointer data, const struct usb_line *line); /* how it was set last */
	void (*write)(gpointer data, const uint8_t *bytes, gsize length);
};

typedef struct usbip usbip;
usbip *usbip_new(const struct usb_gadget *gadget, const struct usbip_behind *behind, gpointer data);
void usbip_free(usbip *u); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(usbip, usbip_free)

/* From the client, at a time of the caller's clock. False: it speaks nonsense, or has been told all
 * it wanted; hang up once the output is sent. */
bool usbip_receive(usbip *u, int64_t now_ns, const uint8_t *bytes, gsize length);
/* For the client; the caller takes from its front what it could send. */
GByteArray *usbip_output(usbip *u);

void usbip_admit(usbip *u, bool present);
bool usbip_is_attached(const usbip *u);
void usbip_deliver(usbip *u, const uint8_t *bytes, gsize length);
/* The bulk endpoint to the host halts: what waits is lost, every URB for it fails with EPIPE until the
 * host clears the halt. */
void usbip_halt(usbip *u);

struct usbip_counts {
	uint64_t transfers, bytes_in, bytes_out,
		lost;       /* URBs ended; from and to the lidar; deliveries */
	gsize most_waiting; /* bytes */
};
struct usbip_counts usbip_counts(const usbip *u);

#endif
