#ifndef FIRMWARE_IO_HOTPLUG_H
#define FIRMWARE_IO_HOTPLUG_H
/* Tells when something that a head could be made of was plugged in or out. One owner, whose thread runs a main loop. */
#include <glib.h>

typedef struct hotplug hotplug;

/* changed is called from the loop, once for a plug with all that belongs to it: a second after the last of it. */
hotplug *hotplug_new(void (*changed)(gpointer user_data), gpointer user_data);
void hotplug_free(hotplug *h); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(hotplug, hotplug_free)

#endif
