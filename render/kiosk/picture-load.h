#ifndef RENDER_KIOSK_PICTURE_LOAD_H
#define RENDER_KIOSK_PICTURE_LOAD_H
/* Pictures from files, read and made smaller beside the main thread. Main thread. */
#include "render/kiosk/kit.h"

/* picture shows the file once it is read, no larger than width x height; one that cannot be read shows nothing. What is
 * asked for later wins. */
void picture_load(GtkWidget *picture, const char *path, int width, int height);

#endif
