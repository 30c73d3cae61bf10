#ifndef RENDER_CAMERA_PATH_H
#define RENDER_CAMERA_PATH_H
/* A way of the camera as numbered frames, from a view or through several:
 *
 *     orbit[:DEGREES[:FRAMES]]      around the target about the vertical, so many degrees a frame,
 *                                   clockwise seen from above (0.5, 40 frames)
 *     dolly[:FACTOR[:FRAMES]]       towards the target: at the last frame it is FACTOR times as near;
 *                                   the scale grows by the same factor each frame (2, 40 frames)
 *     pan[:PIXELS[:FRAMES]]         turns to the right about the vertical: what is in the middle of a
 *                                   picture is so many pixels aside in the next (8, 40 frames)
 *     stations[:FRAMES]             from station to station, through the views station-1, station-2,
 *                                   ...; so many frames from each to the next (40)
 *     views:A,B,C[:FRAMES]          the same through any saved or built-in views
 *
 * Frame 0 is the view itself, and a path through views meets each of them. Between two, place,
 * heading, elevation and scale go on smoothly: monotone cubic interpolation (Fritsch & Butland 1984),
 * so nothing overshoots, and the ends are at rest; headings turn the shorter way, and nothing rolls.
 * It does not know of walls, and has perspective: parallel views (view.h) are refused.
 *
 * Const after camera_path_parse; any number of threads may ask. */
#include "render/view-find.h"

#define CAMERA_PATH_FRAMES_MAX 100000u

typedef struct camera_path camera_path;
/* The forms above, in one line for help. */
extern const char camera_path_forms[];
/* v: where it starts; not needed later. One sentence (G_IO_ERROR_INVALID_ARGUMENT, or what view_find
 * says) for what is no path, and for one of more than CAMERA_PATH_FRAMES_MAX frames. */
camera_path *camera_path_parse(
	const char *spec, const view *v, const struct view_sources *s, GError **error);
void camera_path_free(camera_path *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(camera_path, camera_path_free)

uint32_t camera_path_frames(const camera_path *p); /* at least 1 */
/* frame: 0 to frames - 1; also between two of them. */
struct camera camera_path_at(const camera_path *p, double frame, uint32_t width, uint32_t height);

#endif
