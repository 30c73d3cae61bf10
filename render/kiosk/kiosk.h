#ifndef RENDER_KIOSK_KIOSK_H
#define RENDER_KIOSK_KIOSK_H
/* The window of the touch screen: a bar, a stack of screens, one sheet above them, and what is said to people at its foot. A screen
 * is a widget; it lives until it is left. Main thread. */
#include "render/backend-choice.h"
#include "render/kiosk/kit.h"
#include "render/kiosk/services.h"

struct kiosk_options {
	const char *folder; /* of sites */
	bool fullscreen, dark;
	bool owns_screen; /* nothing else is on it, and it is the kiosk's to turn (systemd/kiosk-screen) */
	int width, height;
	double asleep_after_s; /* 0: never */
	enum backend_wish backend;
	char *const *
		drives; /* folders whose folders are drives; NULL: those that are mounted as such */
};

typedef struct kiosk kiosk;
/* Takes s. closed: people have closed the window; kiosk_free is then due. */
kiosk *kiosk_new(services *s, const struct kiosk_options *options,
	void (*closed)(gpointer user_data), gpointer user_data);
void kiosk_free(kiosk *k); /* NULL is fine */

/* As if people had closed the window. */
void kiosk_close(kiosk *k);

services *kiosk_services(kiosk *k);
const struct kiosk_options *kiosk_options_of(const kiosk *k);

struct journal *kiosk_journal(kiosk *k);

/* ---- as people like it; kept by who asks (settings.h) ---- */

void kiosk_set_dark(kiosk *k, bool dark);
void kiosk_set_asleep_after(kiosk *k, double seconds);
/* Builds everything anew from the first screen on, in the language that is chosen now. Soon: screens that are there live on until the
 * main loop is reached. */
void kiosk_start_over(kiosk *k);

/* The screen comes to the front, with a way back to the one before. name is of the screen's kind ("site"). */
void kiosk_push(kiosk *k, GtkWidget *screen, const char *name, const char *title);
void kiosk_back(kiosk *k);
/* Of the screen at the front. */
const char *kiosk_screen(const kiosk *k);

/* ---- what is said (kiosk-say.c) ---- */

/* A few seconds at the foot of the window, and a line in the journal. */
void kiosk_say(kiosk *k, const char *sentence);
/* Stays until it is put away. advice (may be NULL): what to do about it. */
void kiosk_complain(kiosk *k, const char *sentence, const char *advice);
/* A complaint with this sentence is put away: it is said elsewhere on the screen, or is over. */
void kiosk_hush(kiosk *k, const char *sentence);
/* The sentence of a D-Bus error without its name; of others their message. Does nothing for NULL and for what was cancelled. */
void kiosk_complain_of(kiosk *k, const GError *error);
/* In the middle of the window, with everything else out of reach; one at a time. A tap beside it puts it away. */
void kiosk_open_sheet(kiosk *k, GtkWidget *content);
void kiosk_close_sheet(kiosk *k);
/* A question before something that cannot be undone. yes says what is done ("Remove"). */
void kiosk_ask(kiosk *k, const char *title, const char *text, const char *yes, GCallback done,
	gpointer user_data);

/* ---- undo ---- */

/* did: what was done ("Tree 4 in red"); undo is called at most once, data_free always. owner: the screen that it is undone on. */
void kiosk_did(kiosk *k, const char *did, void (*undo)(gpointer data), gpointer data,
	GDestroyNotify data_free, gpointer owner);
/* The owner goes: what it did can no more be undone. */
void kiosk_forget_undo(kiosk *k, gpointer owner);

#endif
