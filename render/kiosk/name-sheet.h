#ifndef RENDER_KIOSK_NAME_SHEET_H
#define RENDER_KIOSK_NAME_SHEET_H
/* Asks for a name, with letters to tap. */
#include "render/kiosk/kiosk.h"

struct name_sheet {
	const char *id;                  /* of its widgets: ID-name, ID-cancel, ID-yes */
	const char *title, *label, *yes; /* label: of the entry, to a screen reader */
	const char *name;                /* to begin with */
	/* With a name that a site can have; the sheet is still open. */
	void (*done)(const char *name, gpointer user_data);
	gpointer user_data;
	GDestroyNotify user_data_free; /* with the sheet; may be NULL */
};
void name_sheet_open(kiosk *k, const struct name_sheet *desc);

#endif
