#ifndef RENDER_BACKEND_CHOICE_H
#define RENDER_BACKEND_CHOICE_H
/* Who draws: the processor or a GPU. On a GPU, gles is faster; OpenGL in software is many times slower than cpu, so that it is
 * only taken when asked for by name, as tests do. */
#include "render/gles-about.h"

enum backend { BACKEND_CPU, BACKEND_GLES };
enum backend_wish { BACKEND_WISH_AUTO, BACKEND_WISH_CPU, BACKEND_WISH_GLES };

typedef struct backend_choice backend_choice;
struct backend_choice {
	enum backend backend;
	struct gles_about found; /* for gles_context_open, where backend is BACKEND_GLES */
	char *why; /* one line: "gles: NVIDIA H200, OpenGL ES 3.2 by EGL device", "cpu: there is no libEGL.so.1 on this machine" */
};
void backend_choice_clear(backend_choice *c);
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(backend_choice, backend_choice_clear)

/* "auto", "cpu", "gles", as --backend takes them. NULL is auto. G_OPTION_ERROR_BAD_VALUE otherwise. */
bool backend_wish_parse(const char *text, enum backend_wish *ret, GError **error);

/* found: what gles_context_probe found, else NULL and why_none what it said; neither is looked at where the wish is cpu. Fails only
 * where gles is wished and none is there, with why_none's code. */
bool backend_choose(enum backend_wish wish, const struct gles_about *found, const GError *why_none,
	backend_choice *ret, GError **error);

/* By the files of drivers in devices, which is /dev but in tests; true where that cannot be read. */
bool backend_may_have_gpu(const char *devices);

/* Probes this machine, where it may have a GPU or gles is wished: read gles-probe.h for when. */
bool backend_choose_here(enum backend_wish wish, backend_choice *ret, GError **error);

#endif
