#include "render/kiosk/screens.h"

GtkWidget *screen_draw_new(kiosk *k, const char *site)
{
	(void)k;
	(void)site;
	return kit_text("Draw", "title");
}
