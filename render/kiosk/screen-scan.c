#include "render/kiosk/screens.h"

GtkWidget *screen_scan_new(kiosk *k)
{
	(void)k;
	return kit_text("Scan", "title");
}
