#ifndef RENDER_KIOSK_THEME_H
#define RENDER_KIOSK_THEME_H
/* Colours and sizes of all widgets: kiosk.css with light.css or dark.css, from ../share/pleinair/kiosk. Main thread. */
#include <stdbool.h>

void theme_use(bool dark);
/* What was used last; fallback where nobody has chosen yet. */
bool theme_kept(bool fallback);
void theme_keep(bool dark);

#endif
