#include "render/painter.h"
#include <gio/gio.h>

struct painter {
	const struct painter_ops *ops;
	enum backend_wish wish;
	backend_choice choice;
	void *state;
};

static bool cpu_draw(void *state, const frame *f, struct picture_buffer *to,
	struct draw_times *ret_times, GError **error)
{
	(void)error;
	draw_frame(state, f, to, ret_times);
	return true;
}

static void *cpu_open(const backend_choice *choice, GError **error)
{
	(void)choice;
	(void)error;
	return draw_room_new();
}

static void cpu_close(void *state)
{
	draw_room_free(state);
}

static uint32_t cpu_side_most(const void *state)
{
	(void)state;
	return CAMERA_SIDE_MAX;
}

const struct painter_ops painter_cpu = { "cpu", cpu_open, cpu_draw, cpu_close, cpu_side_most };

/* From here on cpu draws, and says why. */
static void fall_back(painter *p, const GError *error)
{
	p->ops->close(p->state);
	g_free(p->choice.why);
	p->choice.why = g_strdup_printf("cpu: gles failed: %s", error->message);
	p->ops = &painter_cpu;
	p->state = draw_room_new();
}

painter *painter_new(enum backend_wish wish, GError **error)
{
	g_autoptr(painter) p = g_new0(painter, 1);
	g_autoptr(GError) none = NULL;
	p->wish = wish;
	p->ops = &painter_cpu;
	if (!backend_choose_here(wish, &p->choice, error))
		return NULL;
	if (p->choice.backend == BACKEND_GLES)
		p->ops = &painter_gles;
	p->state = p->ops->open(&p->choice, &none);
	if (!p->state && wish == BACKEND_WISH_GLES) {
		g_propagate_error(error, g_steal_pointer(&none));
		return NULL;
	}
	if (!p->state)
		fall_back(p, none);
	return g_steal_pointer(&p);
}

void painter_free(painter *p)
{
	if (!p)
		return;
	p->ops->close(p->state);
	backend_choice_clear(&p->choice);
	g_free(p);
}

const char *painter_why(const painter *p)
{
	return p->choice.why;
}

const char *painter_name(const painter *p)
{
	return p->ops->name;
}

bool painter_takes_processor(const painter *p)
{
	return p->ops == &painter_cpu;
}

uint32_t painter_side_most(const painter *p)
{
	return p->ops->side_most(p->state);
}

bool painter_draw(painter *p, const frame *f, struct picture_buffer *to,
	struct draw_times *ret_times, GError **error)
{
	g_autoptr(GError) failed = NULL;
	bool good = p->ops->draw(p->state, f, to, ret_times, &failed);
	if (frame_is_stopped(f)) {
		g_set_error_literal(error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
			"nobody wants the picture any more");
		return false;
	}
	if (good)
		return true;
	if (p->wish == BACKEND_WISH_GLES) {
		g_propagate_error(error, g_steal_pointer(&failed));
		return false;
	}
	fall_back(p, failed);
	return p->ops->draw(p->state, f, to, ret_times, error);
}
