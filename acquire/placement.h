#ifndef ACQUIRE_PLACEMENT_H
#define ACQUIRE_PLACEMENT_H
/* Placement turns a scanline into directions and ranges in the scanner frame: each beam at the
 * stage angle of its own instant, through the head's calibration. One owner; not thread-safe. */
#include "acquire/calibration.h"
#include "acquire/scanline.h"
#include "firmware-io/stage-track.h"

typedef struct placement placement;

/* Which beam of a sweep the device's stamp belongs to (DEVICES 2.1.8: a per-model fact). */
enum stamp_instant { STAMP_FIRST_BEAM, STAMP_LAST_BEAM };

/* Beams that have a place. Cells of the arrays beyond `beams` are undefined; they live until the
 * next call. */
struct placed_line {
	uint32_t beams;
	const float *elevation_rad; /* -pi/2..pi/2 */
	const double *azimuth_rad;  /* 0..2 pi, clockwise from the scanner frame's y */
	const float *range_m;       /* 0 = no return */
	const uint16_t *intensity;  /* 0 where the device sends none */
	double front_first_rad,
		front_last_rad; /* stage angle at the first and last beam, not wrapped */
	double turn_rad;        /* how far the stage goes in one turn of the mirror; signed */
	bool suspect;           /* the stage had lost steps */
};

placement *placement_new(const struct calibration *calibration);
void placement_free(placement *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(placement, placement_free)

/* Host times of the first and the last beam, from the host time of the stamp. */
void placement_sweep(const struct scanline *line, enum stamp_instant stamp, int64_t stamp_ns,
	int64_t *ret_first_ns, int64_t *ret_last_ns);

void placement_place(placement *p, const struct scanline *line, const stage_track *track,
	int64_t first_ns, int64_t last_ns, struct placed_line *ret);

/* The line may make a panorama of so many columns: the stage was where it said, and slow enough
 * that an error of a millisecond stays far below a column. Lines on the way from one place to
 * another are not. */
bool placement_is_usable(const struct placed_line *placed, uint32_t columns);

#endif
