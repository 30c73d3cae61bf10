#include "firmware-io/devices.h"
#include <fcntl.h>
#include <grp.h>
#include <gudev/gudev.h>
#include <linux/gpio.h>
#include <linux/videodev2.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

/* USB devices that matter, and what talks to them: a URI for libusb, or the kernel's driver that makes a serial line of them. */
static const struct {
	uint16_t vendor, product;
	const char *name, *uri, *driver;
} known[] = {
	{ 0x19a2, 0x5001, "SICK TiM", "tim:", NULL },
	{ 0x15d1, 0x0000, "Hokuyo", "scip:", "cdc_acm" },
	{ 0x10c4, 0xea60, "CP210x, the bridge of RPLIDARs and LD06, LD19, STL-27L", NULL,
		"cp210x" },
};

void found_device_free(struct found_device *d)
{
	if (!d)
		return;
	g_free(d->node);
	g_free(d->title);
	g_free(d->uri);
	g_free(d->group);
	g_free(d->trouble);
	g_free(d);
}

/* ---- what is common ---- */

/* Whom the node is for. */
static void look_at_rights(struct found_device *d)
{
	struct stat s;
	d->may_open = d->node && access(d->node, R_OK | W_OK) == 0;
	if (!d->node || stat(d->node, &s) < 0)
		return;
	struct group *g = s.st_mode & S_IWGRP && s.st_gid != 0 ? getgrgid(s.st_gid) : NULL;
	d->group = g ? g_strdup(g->gr_name) : NULL;
	if (d->may_open)
		return;
	d->trouble =
		d->group ? g_strdup_printf(
				   "may not be opened: its group is '%s', and you are not in it",
				   d->group)
			 : g_strdup("may not be opened: no group owns it, so pleinair's udev rules "
				    "are not installed");
}

static struct found_device *new_device(enum device_kind kind, GUdevDevice *g)
{
	struct found_device *d = g_new0(struct found_device, 1);
	d->kind = kind;
	d->node = g_strdup(g_udev_device_get_device_file(g));
	look_at_rights(d);
	return d;
}

static uint16_t hex_of(GUdevDevice *g, const char *attribute)
{
	const char *text = g_udev_device_get_sysfs_attr(g, attribute);
	return text ? (uint16_t)g_ascii_strtoull(text, NULL, 16) : 0;
}

static int known_row(GUdevDevice *usb)
{
	uint16_t vendor = hex_of(usb, "idVendor"), product = hex_of(usb, "idProduct");
	for (size_t i = 0; i < G_N_ELEMENTS(known); i++)
		if (known[i].vendor == vendor && known[i].product == product)
			return (int)i;
	return -1;
}

/* Caller frees the list and its devices. */
static GList *all_of(GUdevClient *client, const char *subsystem)
{
	return g_udev_client_query_by_subsystem(client, subsystem);
}

static void free_list(GList *list)
{
	g_list_free_full(list, g_object_unref);
}

/* ---- USB ---- */

/* A port that sleeps wakes too slowly: revolutions are lost. */
static void look_at_power(struct found_device *d, GUdevDevice *g)
{
	const char *control = g_udev_device_get_sysfs_attr(g, "power/control");
	if (!d->trouble && control && strcmp(control, "auto") == 0)
		d->trouble = g_strdup("may be put to sleep by the kernel, and lose revolutions "
				      "then: pleinair's udev rules, which "
				      "forbid that, are not installed");
}

static void add_usb(GPtrArray *all, GUdevDevice *g)
{
	int row = known_row(g);
	if (row < 0 || !known[row].uri ||
		g_strcmp0(g_udev_device_get_devtype(g), "usb_device") != 0)
		return;
	struct found_device *d = new_device(DEVICE_USB_LIDAR, g);
	d->vendor = known[row].vendor;
	d->product = known[row].product;
	d->uri = g_strdup(known[row].uri);
	d->title = g_strdup_printf("%s (%04x:%04x) on USB port %s", known[row].name, d->vendor,
		d->product, g_udev_device_get_name(g));
	look_at_power(d, g);
	g_ptr_array_add(all, d);
}

static void add_serial(GPtrArray *all, GUdevDevice *g)
{
	g_autoptr(GUdevDevice) usb =
		g_udev_device_get_parent_with_subsystem(g, "usb", "usb_device");
	if (!usb)
		return;
	int row = known_row(usb);
	const char *product = g_udev_device_get_sysfs_attr(usb, "product");
	struct found_device *d = new_device(DEVICE_SERIAL, g);
	d->vendor = hex_of(usb, "idVendor");
	d->product = hex_of(usb, "idProduct");
	/* A Hokuyo is spoken to through either. */
	d->uri = row >= 0 && known[row].uri ? g_strconcat(known[row].uri, d->node, NULL) : NULL;
	d->title = g_strdup_printf("%s (%04x:%04x) on USB port %s",
		row >= 0  ? known[row].name
		: product ? product
			  : "a serial line",
		d->vendor, d->product, g_udev_device_get_name(usb));
	g_ptr_array_add(all, d);
}

/* Plugged in, but nobody made a serial line of it. */
static void add_undriven(GPtrArray *all, GUdevDevice *g)
{
	int row = known_row(g);
	if (row < 0 || !known[row].driver ||
		g_strcmp0(g_udev_device_get_devtype(g), "usb_device") != 0)
		return;
	g_autofree char *port = g_strdup_printf(" on USB port %s", g_udev_device_get_name(g));
	for (guint i = 0; i < all->len; i++) {
		const struct found_device *d = all->pdata[i];
		if (d->kind == DEVICE_SERIAL && g_str_has_suffix(d->title, port))
			return;
	}
	if (known[row].uri)
		return; /* libusb needs no driver */
	struct found_device *d = new_device(DEVICE_SERIAL, g);
	g_clear_pointer(&d->trouble, g_free);
	d->may_open = false;
	d->title = g_strdup_printf(
		"%s (%04x:%04x)%s", known[row].name, known[row].vendor, known[row].product, port);
	d->trouble = g_strdup_printf(
		"has no serial line: the kernel's driver %s is not loaded (modprobe %s)",
		known[row].driver, known[row].driver);
	g_ptr_array_add(all, d);
}

/* ---- cameras and pins ---- */

/* A camera has nodes besides that give no pictures. */
static bool gives_pictures(const struct found_device *d)
{
	struct v4l2_capability c = { 0 };
	int fd = d->may_open ? open(d->node, O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
	if (fd < 0)
		return true; /* nobody knows */
	bool asked = ioctl(fd, VIDIOC_QUERYCAP, &c) == 0;
	uint32_t can = c.capabilities & V4L2_CAP_DEVICE_CAPS ? c.device_caps : c.capabilities;
	close(fd);
	return asked && can & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE) &&
	       can & V4L2_CAP_STREAMING;
}

static void add_camera(GPtrArray *all, GUdevDevice *g)
{
	if (!g_str_has_prefix(g_udev_device_get_name(g), "video"))
		return;
	const char *name = g_udev_device_get_sysfs_attr(g, "name");
	struct found_device *d = new_device(DEVICE_CAMERA, g);
	d->title = g_strdup(name ? name : "a camera");
	if (gives_pictures(d))
		g_ptr_array_add(all, d);
	else
		found_device_free(d);
}

static void add_pins(GPtrArray *all, GUdevDevice *g)
{
	struct gpiochip_info info = { 0 };
	if (!g_udev_device_get_device_file(g) ||
		!g_str_has_prefix(g_udev_device_get_name(g), "gpiochip"))
		return;
	struct found_device *d = new_device(DEVICE_PINS, g);
	int fd = d->may_open ? open(d->node, O_RDWR | O_CLOEXEC) : -1;
	if (fd >= 0 && ioctl(fd, GPIO_GET_CHIPINFO_IOCTL, &info) == 0)
		d->title = g_strdup_printf(
			"%.*s, %u pins", (int)sizeof info.label, info.label, info.lines);
	else
		d->title = g_strdup("pins");
	if (fd >= 0)
		close(fd);
	g_ptr_array_add(all, d);
}

/* ---- all ---- */

GPtrArray *devices_find(void)
{
	static const struct {
		const char *subsystem;
		void (*add)(GPtrArray *all, GUdevDevice *g);
	} looks[] = { { "usb", add_usb }, { "tty", add_serial }, { "usb", add_undriven },
		{ "video4linux", add_camera }, { "gpio", add_pins } };
	GPtrArray *all = g_ptr_array_new_with_free_func((GDestroyNotify)found_device_free);
	g_autoptr(GUdevClient) client = g_udev_client_new(NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(looks); i++) {
		GList *list = all_of(client, looks[i].subsystem);
		for (GList *l = list; l; l = l->next)
			looks[i].add(all, l->data);
		free_list(list);
	}
	return all;
}

#define PORTS "/sys/bus/usb/devices"

/* Ports are folders of the interfaces of hubs: 1-0:1.0/usb1-port1. */
static void add_over_current(GString *ports, const char *interface)
{
	g_autofree char *folder = g_build_filename(PORTS, interface, NULL);
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	for (const char *name; dir && (name = g_dir_read_name(dir));) {
		g_autofree char *path = g_build_filename(folder, name, "over_current_count", NULL),
				*count = NULL;
		if (strstr(name, "-port") && g_file_get_contents(path, &count, NULL, NULL) &&
			g_ascii_strtoull(count, NULL, 10) > 0)
			g_string_append_printf(ports, "%s%s", ports->len ? ", " : "", name);
	}
}

char *devices_over_current(void)
{
	g_autoptr(GString) ports = g_string_new(NULL);
	g_autoptr(GDir) dir = g_dir_open(PORTS, 0, NULL);
	for (const char *name; dir && (name = g_dir_read_name(dir));)
		if (strchr(name, ':'))
			add_over_current(ports, name);
	return ports->len ? g_strdup_printf("A USB port took too much current and was switched off "
					    "(%s): give the device power of its own, "
					    "or another port.",
				    ports->str)
			  : NULL;
}
