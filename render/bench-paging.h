#ifndef RENDER_BENCH_PAGING_H
#define RENDER_BENCH_PAGING_H
/* pleinair bench paging: what it is to move through a site that is larger than the memory it may take (scene-pager.h).
 *
 * The site is a person's, or a town of so many points (process/bench-town.h) of a simulated courtyard. The camera flies through it in real
 * time, over the ground from one end of it to the other in waves, turning as it goes, then rises until all of it is in view. Each
 * frame is what the touch screen draws while fingers move: a turn of the pager and a picture of half of its size. In the end the
 * camera stands still. Told are
 *
 *     open     until the model is open and the scene there, and until the first frame is drawn
 *     frames   median, 95 of 100, and the worst; their number
 *     missing  points that should have been in a frame and were not there yet, of all that should: mean of the frames
 *     read     from the file, by the pager
 *     still    of the first place, the middle of the way and the end, at the whole size: until the view is complete
 *     memory   of the process at most, and how much of that is the program's own; what the points may take */
#include "render/bench-place.h"

struct bench_paging_options {
	struct bench_place_options place;
	double million_points;  /* of the town, when place has no site */
	uint64_t memory_bytes;  /* 0: as scene_new_within */
	double seconds;         /* of the flight */
	uint32_t width, height; /* of the whole picture */
	const char *style, *backend;
	bool json;
};
bool bench_paging(const struct bench_paging_options *options, GError **error);

#endif
