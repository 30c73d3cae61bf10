#ifndef FIRMWARE_IO_DEVICES_H
#define FIRMWARE_IO_DEVICES_H
/* What is plugged into this machine that a head could be made of, as the kernel tells (sysfs, by GUdev). Looking opens nothing that another
 * program may be using, but for cameras and pins, which are asked for their names. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

enum device_kind {
	DEVICE_USB_LIDAR, /* speaks through libusb */
	DEVICE_SERIAL,    /* a serial line on USB, which may be a lidar's */
	DEVICE_CAMERA,
	DEVICE_PINS,
};

struct found_device {
	enum device_kind kind;
	char *node;  /* "/dev/ttyUSB0" */
	char *title; /* "SICK TiM (19a2:5001) on USB port 1-1" */
	char *uri;   /* of lidars whose make is known: "tim:"; else NULL */
	char *group; /* whose members may open it; NULL: nobody's */
	bool may_open;
	char *trouble;            /* what is wrong with it, as a sentence; NULL: nothing */
	uint16_t vendor, product; /* of USB; 0 elsewhere */
};
void found_device_free(struct found_device *d); /* NULL is fine */

/* Of struct found_device, lidars first; caller unrefs. */
GPtrArray *devices_find(void);

/* USB ports that were switched off since they took too much current, as a sentence; NULL: none. Caller frees. */
char *devices_over_current(void);

#endif
