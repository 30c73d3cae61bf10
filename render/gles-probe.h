#ifndef RENDER_GLES_PROBE_H
#define RENDER_GLES_PROBE_H
/* Whether there is an OpenGL ES 3.1 that works, found out by children: drivers have been seen to crash, to hang and to draw
 * nothing when they are first used, and none of that may take the program with it. For each platform in turn a child opens a
 * context on each of its displays, draws (gles-trial.h), and says through a pipe what it found. The first GPU ends the
 * search; failing one, it is the first software renderer. So a machine whose Mesa knows llvmpipe alone gets its NVIDIA GPU.
 *
 * The child is the program itself, started again and taken aside before main(): a driver that was opened before a fork does not
 * work behind it (NVIDIA's loses its context or hangs, and a touch screen has opened it by then), and locks that other threads
 * held would be held for ever. So it may be called at any time, from any thread. A child that hangs is ended, and its platform
 * counts as hanging. It has no core file, no words on stderr (unless debug messages are shown), none of the handlers of signals
 * and exit; it dies with its parent's thread.
 *
 * PLEINAIR_EGL=surfaceless|device|gbm tries that one alone, none tries nothing. */
#include "render/gles-about.h"

struct gles_probe_options {
	unsigned patience_s; /* for each platform; 0: 20 */
};

/* options: NULL is fine. ret: for gles_context_open. Errors are one sentence: GLES_ERROR_NONE "there is no libEGL.so.1 on this
 * machine", "EGL has no OpenGL ES 3.1: by surfaceless, ...; by device, ...; by gbm, ..."; GLES_ERROR_DRIVER the same, where one of
 * them crashed, hung, or drew wrong pixels. */
bool gles_context_probe(
	const struct gles_probe_options *options, struct gles_about *ret, GError **error);

#endif
