#include "render/gles-draw-private.h"

/* Strokes of a layer that there is room for at first. */
#define STROKES_LEAST (1u << 16)

/* Of marks.glsl: words of a view, and for all; views that a group goes through where they are those of few. */
#define MARKS      259
#define MARKS_MORE 1
#define AT_ONCE    8u

/* A command of choose-count.glsl. */
struct asked {
	uint32_t groups[3];
};

static uint32_t capacity_of(const struct gles_buffer *b)
{
	return (uint32_t)(b->bytes / (4 * GLES_STROKE_WORDS));
}

static bool reserve(gles_draw *d, uint32_t layer, int64_t strokes, GError **error)
{
	return gles_buffer_reserve(d->c, &d->strokes[layer], strokes * 4 * GLES_STROKE_WORDS,
		"the strokes of a layer", error);
}

/* Views of a layer: runs of its pipeline stand together. */
struct choice {
	uint32_t layer, capacity;
	guint run, run_end;
	uint32_t view, count;
	bool is_stipple, is_paint;
};

/* Nothing where it is not wanted. */
static struct choice choice_of(const gles_draw *d, const frame *f, uint32_t layer, uint64_t layers)
{
	struct choice c = { .layer = layer,
		.capacity = capacity_of(&d->strokes[layer]),
		.is_stipple = f->layer[layer].stipple,
		.is_paint = f->layer[layer].paint };
	const GArray *runs = d->views.runs;
	if (!(layers >> layer & 1))
		return c;
	while (c.run < runs->len && gles_draw_run(d, c.run)->pipeline != f->layer[layer].pipeline)
		c.run++;
	c.view = c.run < runs->len ? gles_draw_run(d, c.run)->first : 0;
	for (c.run_end = c.run; c.run_end < runs->len &&
				gles_draw_run(d, c.run_end)->pipeline == f->layer[layer].pipeline;
		c.run_end++)
		c.count += gles_draw_run(d, c.run_end)->count;
	return c;
}

/* Views of one run that one dispatch goes through, since it has not more groups. */
struct window {
	const struct gles_run *run;
	uint32_t first, count;
};

static GArray *windows_of(const gles_draw *d, const struct choice *c)
{
	GArray *ret = g_array_new(FALSE, FALSE, sizeof(struct window));
	for (guint k = c->run; k < c->run_end; k++) {
		const struct gles_run *r = gles_draw_run(d, k);
		for (uint32_t n = 0; n < r->count; n += GLES_GROUPS_MAX) {
			struct window w = { r, r->first + n, MIN(r->count - n, GLES_GROUPS_MAX) };
			g_array_append_val(ret, w);
		}
	}
	return ret;
}

static void bind_points(gles_draw *d, const struct choice *c, const struct gles_run *r)
{
	const struct gles_slab *slab = &d->scene.slab[r->slab];
	gles_draw_bind_storage(d, 0, slab->points);
	if (c->is_stipple)
		return;
	gles_draw_bind_storage(d, 3, slab->looks);
	gles_draw_bind_storage(d, 4, slab->lists);
	gles_draw_bind_storage(d, 7,
		c->is_paint   ? slab->paint
		: slab->bends ? slab->bends
			      : slab->lists);
}

/* Those of few, or all others, of which the GPU knows how many there are. */
static void go_through_windows(
	gles_draw *d, const struct choice *c, const GArray *windows, bool few)
{
	const struct gles_functions *gl = &d->c->gl;
	for (guint k = 0; k < windows->len; k++) {
		const struct window *w = &g_array_index(windows, struct window, k);
		bind_points(d, c, w->run);
		gl->Uniform1ui(0, w->first);
		gl->Uniform3ui(9, few, w->first + w->count, k);
		if (few)
			gl->DispatchCompute((w->count + AT_ONCE - 1) / AT_ONCE, 1, 1);
		else
			gl->DispatchComputeIndirect((GLintptr)(k * sizeof(struct asked)));
	}
}

static void go_through(
	gles_draw *d, const struct choice *c, const GArray *windows, enum gles_use use)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->UseProgram(d->program[use]);
	gl->Uniform2ui(1, c->view, c->count);
	if (use == GLES_WRITE || use == GLES_STIPPLE_WRITE)
		gl->Uniform1ui(2, c->capacity);
	go_through_windows(d, c, windows, true);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
	go_through_windows(d, c, windows, false);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

static void number(gles_draw *d, const struct choice *c)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->UseProgram(d->program[GLES_SCAN]);
	gl->Uniform1ui(0, c->count);
	gl->Uniform1ui(1, c->layer);
	gl->Uniform1ui(2, c->capacity);
	gles_draw_bind_storage(d, 6, d->commands.name);
	gl->DispatchCompute(1, 1, 1);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

static bool choose_layer(gles_draw *d, const struct choice *c, GError **error)
{
	g_autoptr(GArray) windows = windows_of(d, c);
	g_autofree struct asked *none = g_new(struct asked, windows->len);
	for (guint k = 0; k < windows->len; k++)
		none[k] = (struct asked){ { 0, 1, 1 } };
	if (!gles_buffer_put(d->c, &d->asked, none, windows->len * sizeof *none,
		    "the chunks in view", error))
		return false;
	d->c->gl.BindBuffer(GL_DISPATCH_INDIRECT_BUFFER, d->asked.name);
	gles_draw_bind_storage(d, 1, d->views.buffer.name);
	gles_draw_bind_storage(d, 5, d->marks.name);
	gles_draw_bind_storage(d, 6, d->asked.name);
	go_through(d, c, windows, c->is_stipple ? GLES_STIPPLE_COUNT : GLES_COUNT);
	number(d, c);
	gles_draw_bind_storage(d, 6, d->strokes[c->layer].name);
	go_through(d, c, windows, c->is_stipple ? GLES_STIPPLE_WRITE : GLES_WRITE);
	return true;
}

bool gles_draw_choose(gles_draw *d, const frame *f, uint64_t layers, GError **error)
{
	int64_t marks = ((int64_t)d->views.count * MARKS + MARKS_MORE) * 4;
	if (!gles_buffer_reserve(d->c, &d->marks, marks, "the chunks in view", error) ||
		!gles_buffer_reserve(
			d->c, &d->commands, sizeof(struct gles_commands), "the layers", error))
		return false;
	for (uint32_t n = 0; n < f->layers; n++) {
		if (!d->strokes[n].name && !reserve(d, n, STROKES_LEAST, error))
			return false;
		struct choice c = choice_of(d, f, n, layers);
		gles_layers_bind(d->c, &d->layers, n);
		gles_draw_bind_texture(d, 6, GL_TEXTURE_2D, d->layers.xtoon_colours[n]);
		gles_draw_bind_texture(d, 7, GL_TEXTURE_2D, d->layers.xtoon_wanted[n]);
		if (c.is_stipple && c.count && !gles_draw_stipple(d, f, n, error))
			return false;
		if (f->layer[n].is_profile && c.count) {
			if (!gles_draw_profile(d, f, n, error))
				return false;
		} else if (!choose_layer(d, &c, error))
			return false;
	}
	d->c->gl.MemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_COMMAND_BARRIER_BIT |
			       GL_BUFFER_UPDATE_BARRIER_BIT);
	return true;
}

bool gles_draw_strokes(
	gles_draw *d, uint32_t layers, uint32_t *ret_count, bool *ret_whole, GError **error)
{
	*ret_count = 0;
	*ret_whole = true;
	if (!layers)
		return true;
	struct gles_commands all;
	if (!gles_buffer_read(d->c, &d->commands, sizeof all, &all, error))
		return false;
	for (uint32_t n = 0; n < layers; n++) {
		*ret_count += all.total[n];
		if (all.total[n] <= capacity_of(&d->strokes[n]))
			continue;
		*ret_whole = false;
		if (!reserve(d, n, all.total[n] + (int64_t)all.total[n] / 4, error))
			return false;
	}
	return true;
}
