#include "firmware-io/hotplug.h"
#include <gudev/gudev.h>
#include <stdbool.h>

/* A plug brings a device, its interfaces, their nodes, and then the rights to them. */
#define CALM_MS 1000

struct hotplug {
	GUdevClient *client;
	guint calm;
	void (*changed)(gpointer user_data);
	gpointer user_data;
};

static gboolean is_calm(gpointer user_data)
{
	hotplug *h = user_data;
	h->calm = 0;
	h->changed(h->user_data);
	return G_SOURCE_REMOVE;
}

/* Whoever takes a lidar from the kernel's driver of modems makes its serial line go, and come back: that is no plug. */
static bool is_plug(const char *action, GUdevDevice *device)
{
	bool usb = g_strcmp0(g_udev_device_get_subsystem(device), "usb") == 0;
	return (g_strcmp0(action, "add") == 0 || g_strcmp0(action, "remove") == 0) &&
	       (!usb || g_strcmp0(g_udev_device_get_devtype(device), "usb_device") == 0);
}

static void heard(GUdevClient *client, const char *action, GUdevDevice *device, gpointer user_data)
{
	hotplug *h = user_data;
	(void)client;
	if (!is_plug(action, device))
		return;
	g_clear_handle_id(&h->calm, g_source_remove);
	h->calm = g_timeout_add(CALM_MS, is_calm, h);
}

hotplug *hotplug_new(void (*changed)(gpointer user_data), gpointer user_data)
{
	static const char *const subsystems[] = { "usb", "video4linux", "gpio", NULL };
	hotplug *h = g_new0(hotplug, 1);
	h->changed = changed;
	h->user_data = user_data;
	h->client = g_udev_client_new(subsystems);
	g_signal_connect(h->client, "uevent", G_CALLBACK(heard), h);
	return h;
}

void hotplug_free(hotplug *h)
{
	if (!h)
		return;
	g_clear_handle_id(&h->calm, g_source_remove);
	g_signal_handlers_disconnect_by_data(h->client, h);
	g_object_unref(h->client);
	g_free(h);
}
