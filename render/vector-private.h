#ifndef RENDER_VECTOR_PRIVATE_H
#define RENDER_VECTOR_PRIVATE_H
/* What the writers of pages share. */
#include "render/vector-page.h"
#include <cairo.h>

/* The ground as a picture of cairo's; caller destroys it. */
cairo_surface_t *vector_ground_surface(const struct picture_buffer *p);
/* Of what cairo said; false: there is an error. */
bool vector_check(cairo_status_t status, const char *path, GError **error);
/* A cairo_write_func_t: into a GByteArray. */
cairo_status_t vector_append(void *bytes, const unsigned char *more, unsigned length);

#endif
