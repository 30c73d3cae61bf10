#include "render/kiosk/screens.h"

GtkWidget *screen_align_new(kiosk *k, const char *site, uint32_t a, uint32_t b)
{
	(void)k;
	(void)site;
	(void)a;
	(void)b;
	return kit_text("Align", "title");
}
