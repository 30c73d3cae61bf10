#include "render/kiosk/artist-size.h"

const double artist_sizes[ARTIST_SIZES] = { 1, 0.7, 0.5, 0.35, 0.25 };

uint32_t artist_size_next(uint32_t size, double seconds)
{
	if (seconds > ARTIST_SECONDS_MOST && size + 1 < ARTIST_SIZES)
		return size + 1;
	/* All of the time may go with the pixels: only when the larger one will do then too. */
	if (size > 0) {
		double factor = artist_sizes[size - 1] / artist_sizes[size];
		if (seconds < ARTIST_SECONDS_LEAST &&
			seconds * factor * factor < ARTIST_SECONDS_MOST)
			return size - 1;
	}
	return size;
}
