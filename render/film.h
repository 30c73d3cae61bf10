#ifndef RENDER_FILM_H
#define RENDER_FILM_H
/* A film of pictures: H.264 in .mp4, VP9 in .webm. The program ffmpeg makes it of what is written to it. It grows as FILE.part and
 * gets its name when it is whole; one that is not finished is removed.
 *
 * One thread. The process must have SIGPIPE ignored (cli_catch_interrupts). */
#include "render/frame.h"
#include <glib.h>

/* Whether a path ends in .mp4 or .webm. */
bool film_is(const char *path);
/* Whether there is an ffmpeg; else one sentence (G_IO_ERROR_NOT_FOUND). */
bool film_can(GError **error);

typedef struct film film;
/* Width and height are even. */
film *film_new(const char *path, uint32_t width, uint32_t height, double fps, GError **error);
void film_free(film *f); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(film, film_free)
/* The next picture, of that size. When ffmpeg has ended, the error is what it said. */
bool film_add(film *f, const struct picture_buffer *p, GError **error);
/* Waits until it is whole. */
bool film_finish(film *f, GError **error);

#endif
