#include "render/gles-draw.h"
#include "render/painter.h"

struct state {
	gles_context *context;
	gles_draw *draw;
};

static void gles_close(void *state)
{
	struct state *s = state;
	if (!s)
		return;
	if (s->draw && gles_context_use(s->context, NULL))
		gles_draw_free(s->draw);
	gles_context_free(s->context);
	g_free(s);
}

static void *gles_open(const backend_choice *choice, GError **error)
{
	struct state *s = g_new0(struct state, 1);
	s->context = gles_context_open(&choice->found, error);
	s->draw = s->context ? gles_draw_new(s->context, error) : NULL;
	if (s->draw)
		return s;
	gles_close(s);
	return NULL;
}

static bool gles_draw_here(void *state, const frame *f, struct picture_buffer *to,
	struct draw_times *ret_times, GError **error)
{
	struct state *s = state;
	return gles_context_use(s->context, error) &&
	       gles_draw_frame(s->draw, f, to, ret_times, error);
}

static uint32_t gles_side_most(const void *state)
{
	const struct gles_limits *l = &((const struct state *)state)->context->about.limits;
	return MIN((uint32_t)MIN(l->texture_size, l->viewport_size), CAMERA_SIDE_MAX);
}

const struct painter_ops painter_gles = { "gles", gles_open, gles_draw_here, gles_close,
	gles_side_most };
