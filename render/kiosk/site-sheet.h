#ifndef RENDER_KIOSK_SITE_SHEET_H
#define RENDER_KIOSK_SITE_SHEET_H
/* What can be done with a site as a whole: another name, or away with it. Both can be undone. */
#include "render/kiosk/kiosk.h"

struct site_sheet {
	const char *path, *name;
	const char *facts; /* a line for people */
	/* Something has changed; the owner of what it did is user_data, as of kiosk_did. */
	void (*changed)(gpointer user_data);
	gpointer user_data;
};
void site_sheet_open(kiosk *k, const struct site_sheet *desc);
/* Deletes what was removed so long ago that nobody takes it back any more, on a thread. */
void site_sheet_clear_removed(kiosk *k);

#endif
