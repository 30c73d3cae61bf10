#ifndef RENDER_KIOSK_SETTINGS_H
#define RENDER_KIOSK_SETTINGS_H
/* What people chose for good: kiosk.conf in the user's folder of configurations. One that cannot be written is no error: a choice
 * then holds until the program ends. One thread at a time. */
#include <stdbool.h>

char *settings_string(
	const char *group, const char *key); /* NULL: nobody has chosen; caller frees */
double settings_number(const char *group, const char *key, double fallback);
bool settings_switch(const char *group, const char *key, bool fallback);
/* value NULL: forgets the choice. */
void settings_keep_string(const char *group, const char *key, const char *value);
void settings_keep_number(const char *group, const char *key, double value);
void settings_keep_switch(const char *group, const char *key, bool value);

#endif
