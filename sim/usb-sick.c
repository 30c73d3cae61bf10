#include "sim/usb.h"

/* A maximum packet of 64 bytes, as of full speed: what the units have is not known; this splits more. */
static const uint8_t configuration[] = {
	9, 2, 32, 0, 1, 1, 0, 0xc0, 50,     /* self-powered, 100 mA */
	9, 4, 0, 0, 2, 0xff, 0xff, 0xff, 0, /* interface 0: vendor-specific, two endpoints */
	7, 5, 0x81, 2, 64, 0, 0,            /* bulk IN */
	7, 5, 0x02, 2, 64, 0, 0,            /* bulk OUT */
};

const struct usb_gadget usb_sick = { .name = "sick",
	.full_speed = true,
	.vendor = 0x19a2,
	.product = 0x5001,
	.release = 0x0100,
	.configuration = configuration,
	.configuration_length = sizeof configuration,
	.strings = { NULL, "SICK AG", "TiM5xx", NULL },
	.in = 0x81,
	.out = 0x02,
	.packet = 64 };
