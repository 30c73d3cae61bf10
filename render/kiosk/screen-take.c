#include "render/kiosk/screens.h"

GtkWidget *screen_take_new(kiosk *k, const char *site)
{
	(void)k;
	(void)site;
	return kit_text("Take home", "title");
}
