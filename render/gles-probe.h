#ifndef RENDER_GLES_PROBE_H
#define RENDER_GLES_PROBE_H
/* Whether there is an OpenGL ES 3.1 that works, found out by children: drivers have been seen to crash, to hang and to draw
 * nothing when they are first used, and none of that may take the program with it. For each platform in turn a child opens a
 * context on each of its displays, draws (gles-trial.h), and says through a pipe what it found. The first GPU ends the
 * search; failing one, it is the first software renderer. So a machine whose Mesa knows llvmpipe alone gets its NVIDIA GPU.
 *
 * The child is a fork without an exec. Of a process with threads it has only the one that called, and a lock that another one
 * held is held for ever; a child that hangs of it is ended, and its platform counts as hanging. Probe before threads are started
 * and before the first context is opened. The child has no core file, no words on stderr (unless debug messages are shown),
 * none of the handlers of signals and exit; it dies with its parent's thread. Its descriptors that are not close-on-exec are
 * copies until it ends.
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
