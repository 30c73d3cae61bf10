#include "render/kiosk/screens.h"

GtkWidget *screen_sites_new(kiosk *k)
{
	(void)k;
	return kit_text("Sites", "title");
}
