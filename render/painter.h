#ifndef RENDER_PAINTER_H
#define RENDER_PAINTER_H
/* Draws frames, on the processor or a GPU: one picture, two backends. cpu (draw.h) is always there, and is the reference; gles is what
 * a GPU is used by. When gles was chosen by itself and fails, cpu takes over.
 *
 * Used on one thread at a time; of gles on the one that opened it. */
#include "render/backend-choice.h"
#include "render/draw.h"

/* A backend: what differs. state is its own. */
struct painter_ops {
	const char *name;
	void *(*open)(const backend_choice *choice, GError **error);
	/* What it keeps of the scene it keeps between frames of the same scene. */
	bool (*draw)(void *state, const frame *f, struct picture_buffer *to,
		struct draw_times *ret_times, GError **error);
	void (*close)(void *state);               /* NULL is fine */
	uint32_t (*side_most)(const void *state); /* pixels of a picture that it draws at once */
};
extern const struct painter_ops painter_cpu, painter_gles;

typedef struct painter painter;
/* Fails only when gles was asked for by name and is not there. */
painter *painter_new(enum backend_wish wish, GError **error);
void painter_free(painter *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(painter, painter_free)
/* One line on who draws, and why; another one after gles has failed. */
const char *painter_why(const painter *p);
/* Of the backend that draws: "cpu", "gles". */
const char *painter_name(const painter *p);
/* Whether that takes all of the processor while it draws. */
bool painter_takes_processor(const painter *p);
/* Pixels a side that it draws at once. */
uint32_t painter_side_most(const painter *p);
/* Into a picture of the camera's size. ret_times may be NULL. G_IO_ERROR_CANCELLED: f->stop was set. */
bool painter_draw(painter *p, const frame *f, struct picture_buffer *to,
	struct draw_times *ret_times, GError **error);

#endif
