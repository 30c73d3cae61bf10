#ifndef TESTS_KIOSK_RIG_H
#define TESTS_KIOSK_RIG_H
/* A rig holds a GTK program under weston without a screen, on a bus of its own, and touches it as fingers would: what a test
 * does goes through weston (weston-touch.c), Wayland and GTK's gestures, and what it asks is answered by the program
 * (render/kiosk/kiosk-probe.h, which the program must serve). Names are those that widgets were given.
 *
 * What goes wrong ends the test program, and says what was waited for and what the program shows. Every process of the rig
 * dies with the test program, however that ends; its folder, with weston's messages, then stays. Times are limits and never
 * how long a machine is thought to take. Lengths are pixels of the screen, angles radians. One thread. */
#include <glib.h>
#include <stdbool.h>

typedef struct rig rig;

struct rig_desc {
	const char *program;          /* a path */
	const char *const *arguments; /* after its name; NULL: none */
	const char *const *
		environment; /* NAME=VALUE; goes before what the rig sets. With DBUS_SESSION_BUS_ADDRESS
	                                       * the program is on that bus and the rig makes none */
	const char *services; /* a folder of .service files for the rig's bus; NULL: none */
	int width, height;    /* 0: 1280, 800 */
};

/* Why there is no rig here: weston or its module is missing. NULL where there is one; static. */
const char *rig_missing(void);
/* For main: the programs of $PLEINAIR_BIN are found, and false where no rig can be had, which is then told as TAP wants it. */
bool rig_tests_begin(int *argc, char ***argv);
/* Starts it all, and the program as rig_start does. The caller frees it. */
rig *rig_new(const struct rig_desc *desc);
/* Ends the program, weston and the bus, and removes the folder. NULL is fine. */
void rig_free(rig *r);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(rig, rig_free)

/* The rig's folder, which is the program's home; lasts as long as the rig. */
const char *rig_folder(const rig *r);
/* Starts the program anew, which must not run, and waits until its probe answers and a widget with a name is shown. */
void rig_start(rig *r);
/* SIGKILL, as when power of the program alone fails; returns when it is gone. */
void rig_kill(rig *r);
bool rig_runs(rig *r);

struct rig_place {
	double x, y, width, height;
	bool reachable, sensitive;
};
/* False where no such widget is shown. */
bool rig_find(rig *r, const char *name, struct rig_place *place);
/* Until it is shown, reachable, sensitive and stands still; where it then is. */
struct rig_place rig_wait_for(rig *r, const char *name, double seconds);
/* Until none of that name is shown. */
void rig_wait_gone(rig *r, const char *name, double seconds);
/* What a shown widget says; the caller frees it. */
char *rig_text(rig *r, const char *name);
/* The program's kiosk_probe_set of KEY; NULL where there is none; the caller frees it. */
char *rig_state(rig *r, const char *key);
/* Until that is VALUE. */
void rig_wait_state(rig *r, const char *key, const char *value, double seconds);
void rig_wait_text(rig *r, const char *name, const char *text, double seconds);
/* Until PART is in it. */
void rig_wait_words(rig *r, const char *name, const char *part, double seconds);
/* All widgets with a name, a line each, as kiosk-probe.h says; the caller frees it. */
char *rig_list(rig *r);
/* All that keys should reach and what screen readers say of it, as kiosk-probe.h says; the caller frees it. */
char *rig_controls(rig *r);
/* The name of what keys go to; the caller frees it. */
char *rig_focus(rig *r);
/* How many frames the program has painted. */
guint64 rig_frames(rig *r);
/* The screen as a PNG, once the program has painted nothing new for a moment (but after a second at the latest). */
void rig_shot(rig *r, const char *path);
/* The same into the folder $PLEINAIR_SHOTS, as NAME.png; nothing without it. */
void rig_keep_shot(rig *r, const char *name);

/* These wait for their widget, 20 s at most, and touch its middle. */
void rig_tap(rig *r, const char *name);
void rig_double_tap(rig *r, const char *name);
void rig_hold(rig *r, const char *name, double seconds);

/* Drags what scrolls, named LIST, until NAME inside it is reachable. NAME must be a widget already. */
void rig_scroll_to(rig *r, const char *list, const char *name);

void rig_tap_at(rig *r, double x, double y);
/* One finger, in about the given time; it rests at the end, so that nothing is flung. */
void rig_drag(rig *r, double from_x, double from_y, double to_x, double to_y, double seconds);
/* Two fingers level about a middle, from one distance of each other to another. */
void rig_pinch(rig *r, double x, double y, double from, double to, double seconds);
/* Two fingers about a middle, turned by an angle, clockwise on the screen. */
void rig_twist(rig *r, double x, double y, double distance, double angle, double seconds);
/* Two fingers 120 apart, side by side. */
void rig_two_finger_pan(
	rig *r, double from_x, double from_y, double to_x, double to_y, double seconds);

/* Keys of a US keyboard, for which the text must be printable ASCII, \b, \t or \n. */
void rig_type(rig *r, const char *text);
/* A key by its number in linux/input-event-codes.h. */
void rig_key(rig *r, unsigned code);

#endif
