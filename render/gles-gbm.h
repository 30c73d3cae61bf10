#ifndef RENDER_GLES_GBM_H
#define RENDER_GLES_GBM_H
/* Render nodes of the kernel, /dev/dri/renderD128 and on, as what EGL's platform GBM wants: by libgbm.so.1, loaded when one is
 * asked for. Errors as gles-display.h's. */
#include <glib.h>
#include <stdint.h>

struct gbm_device;

/* The numbers of the nodes that there are, at most max. 0: error says that there is none. */
unsigned gles_gbm_list(uint32_t *ret_number, unsigned max, GError **error);
/* Lives until the process ends; not to be freed. Once for each number (gles-display.h). */
struct gbm_device *gles_gbm_get(uint32_t number, GError **error);

#endif
