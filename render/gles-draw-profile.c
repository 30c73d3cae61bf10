#include "render/gles-draw-private.h"
#include "render/profile-links.h"

#define GROUP 64u

/* Over all links, as many groups at a time as a dispatch may have. */
static void run(gles_draw *d, enum gles_use use, uint32_t count, uint32_t lift)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->UseProgram(d->program[use]);
	gl->Uniform1ui(1, lift);
	for (uint32_t from = 0; from < count; from += GLES_GROUPS_MAX * GROUP) {
		uint32_t left = (count - from + GROUP - 1) / GROUP;
		gl->Uniform2ui(0, from, count);
		gl->DispatchCompute(MIN(left, GLES_GROUPS_MAX), 1, 1);
	}
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

/* Nothing reads them any more: how many strokes the part before had was asked for (gles_draw_strokes). */
static void tell_count(gles_draw *d, uint32_t layer, uint32_t count)
{
	const struct gles_functions *gl = &d->c->gl;
	uint32_t command[4] = { 4, count };
	gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	gl->BindBuffer(GL_COPY_WRITE_BUFFER, d->commands.name);
	gl->BufferSubData(GL_COPY_WRITE_BUFFER,
		(GLintptr)offsetof(struct gles_commands, command[layer]), sizeof command, command);
	gl->BufferSubData(GL_COPY_WRITE_BUFFER,
		(GLintptr)offsetof(struct gles_commands, total[layer]), sizeof count, &count);
}

bool gles_draw_profile(gles_draw *d, const frame *f, uint32_t layer, GError **error)
{
	g_autoptr(GArray) links = profile_links_new(f, &f->layer[layer]);
	uint32_t count = links->len;
	if (!gles_programs_want(d->c, d->program, GLES_PROFILE_SEE, error) ||
		!gles_programs_want(d->c, d->program, GLES_PROFILE_WRITE, error) ||
		!gles_buffer_reserve(d->c, &d->strokes[layer],
			MAX((int64_t)count, 1) * 4 * GLES_STROKE_WORDS, "the strokes of a layer",
			error) ||
		!gles_buffer_reserve(d->c, &d->shown, MAX((int64_t)count, 1) * 4,
			"what is seen of lines", error) ||
		!gles_buffer_put(d->c, &d->links, links->data,
			(int64_t)(count * sizeof(struct profile_link)), "profile lines", error))
		return false;
	tell_count(d, layer, count);
	gles_draw_bind_storage(d, 2, d->links.name);
	gles_draw_bind_storage(d, 3, d->shown.name);
	gles_draw_bind_storage(d, 6, d->strokes[layer].name);
	run(d, GLES_PROFILE_SEE, count, 0);
	run(d, GLES_PROFILE_WRITE, count, profile_lift(&f->layer[layer]));
	return true;
}
