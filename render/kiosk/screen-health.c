#include "render/kiosk/screens.h"

GtkWidget *screen_health_new(kiosk *k)
{
	(void)k;
	return kit_text("Health", "title");
}
