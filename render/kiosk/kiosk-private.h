#ifndef RENDER_KIOSK_KIOSK_PRIVATE_H
#define RENDER_KIOSK_KIOSK_PRIVATE_H
/* What the files of the window share. */
#include "render/kiosk/journal.h"
#include "render/kiosk/kiosk.h"
#include "render/kiosk/status.h"

struct undo {
	char *did;
	void (*undo)(gpointer data);
	gpointer data;
	GDestroyNotify data_free;
	gpointer owner;
};

struct kiosk {
	struct kiosk_options options;
	services *services;
	void (*closed)(gpointer user_data);
	gpointer closed_data;
	journal *journal;
	status *status;
	GtkWidget *window, *overlay, *stack, *back, *title, *undo, *theme;
	GtkWidget *toast, *toast_box, *toast_text, *toast_advice; /* a revealer and what is in it */
	GQueue toasts; /* of char *: what is said after the one that is shown */
	guint toast_timer, start_over;
	GtkWidget *shade, *sheet_box; /* visible while there is a sheet */
	GtkWidget *under;             /* all that a sheet lies over: keys do not go there */
	GtkWidget *focus_before;      /* weak: what had the focus before the sheet came */
	GPtrArray *titles;            /* of the screens, the last is at the front */
	GPtrArray *undos;             /* of struct undo, the last was done last */
};

void kiosk_build_says(kiosk *k);

#endif
