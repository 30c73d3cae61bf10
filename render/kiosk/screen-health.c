#include "render/kiosk/health.h"
#include "render/kiosk/screens.h"

GtkWidget *screen_health_new(kiosk *k)
{
	GtkWidget *box = kit_column(16, health_devices_new(k), health_check_new(k),
		health_doctor_new(k), kit_grow(health_box_new(k), true, true), NULL);
	GtkWidget *rest = kit_column(
		16, health_settings_new(k), kit_grow(health_log_new(k), true, true), NULL);
	GtkWidget *screen = kit_margin(kit_sides(16, kit_scroll(box), rest, NULL), 16);
	gtk_box_set_homogeneous(GTK_BOX(screen), TRUE);
	return screen;
}
