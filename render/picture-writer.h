#ifndef RENDER_PICTURE_WRITER_H
#define RENDER_PICTURE_WRITER_H
/* A picture's file, written from above to below without ever holding all of it: PNG, or TIFF where the name ends in .tif or .tiff (Deflate,
 * with a predictor). Three bytes a pixel, sRGB.
 *
 * The file appears under its name when it is whole; one that is not finished leaves what was there before. One thread. Errors of
 * G_IO_ERROR, one sentence that begins with the path. */
#include "render/frame.h"

typedef struct picture_writer picture_writer;
/* dpi: pixels an inch on paper; 0: it has no size there. */
picture_writer *picture_writer_new(
	const char *path, uint32_t width, uint32_t height, double dpi, GError **error);
/* The next rows; as wide as the picture. */
bool picture_writer_add(picture_writer *w, const struct picture_buffer *rows, GError **error);
/* After all of them: it is on the disk. */
bool picture_writer_finish(picture_writer *w, GError **error);
void picture_writer_free(picture_writer *w); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(picture_writer, picture_writer_free)

#endif
