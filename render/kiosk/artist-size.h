#ifndef RENDER_KIOSK_ARTIST_SIZE_H
#define RENDER_KIOSK_ARTIST_SIZE_H
/* How small pictures of a moving view must be, so that this machine draws enough of them: learnt from those before. */
#include <stdint.h>

#define ARTIST_SIZES 5
extern const double artist_sizes[ARTIST_SIZES];
/* Of a drawing that was never seen moving: a picture that is too large comes too late, one that is too small soon grows. */
#define ARTIST_SIZE_FIRST (ARTIST_SIZES - 1)
/* Between them a moving picture's time is right. */
#define ARTIST_SECONDS_LEAST 0.020
#define ARTIST_SECONDS_MOST  0.040

/* The size for the next picture, after one of this size took so long. */
uint32_t artist_size_next(uint32_t size, double seconds);

#endif
