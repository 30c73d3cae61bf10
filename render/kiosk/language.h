#ifndef RENDER_KIOSK_LANGUAGE_H
#define RENDER_KIOSK_LANGUAGE_H
/* Which language people read: that of the surroundings (LANG), or the one that was chosen here. Translations are in
 * ../share/locale from the program. Main thread, and no other may run yet or ask for a translation meanwhile. */

/* After setlocale, before GTK. */
void language_start(void);
/* "de"; NULL: that of the surroundings. Texts that are shown already stay as they are. Kept for good. */
void language_choose(const char *code);
/* What was chosen; NULL: nothing. Caller frees. */
char *language_chosen(void);

struct language {
	const char *code, *name; /* name: in itself */
};
extern const struct language languages[]; /* ends with a row without code */

#endif
