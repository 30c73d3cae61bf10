#include "render/gles-ink.h"

/* Groups that go through a layer's strokes, as many at once as any GPU has processors for. */
#define GROUPS 2048u
/* As bits of a float: nothing has been drawn where the least counts. */
#define BARE 0x3f800000u

_Static_assert(GLES_STROKES_PUT - GLES_SPRITES_PUT == KERNEL_TEXTURE, "in the order of kernels");

/* Words of a pixel, as ink-put.glsl has them. */
static uint32_t planes_of(enum band_blend blend)
{
	switch (blend) {
	case BAND_COLOURED: return 3;
	case BAND_PAINTED: return 5;
	case BAND_LAID: return 7;
	default: return 1;
	}
}

static int64_t bytes_of(const gles_draw *d, enum band_blend blend)
{
	return (int64_t)d->targets.width * d->targets.height * 4 * planes_of(blend);
}

bool gles_ink_is_summed(const gles_draw *d, const struct frame_layer *l)
{
	/* Pixels are counted by ints. */
	int64_t most = MIN(d->c->about.limits.storage_block_bytes, INT32_MAX);
	return d->sums_ink && bytes_of(d, band_blend_of(l)) <= most;
}

static void put(gles_draw *d, uint32_t layer, bool finds_power)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->Uniform1ui(0, layer);
	gl->Uniform1ui(1, finds_power);
	gl->DispatchCompute(GROUPS, 1, 1);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

bool gles_ink_put(gles_draw *d, const struct frame_layer *l, uint32_t layer, GError **error)
{
	const struct gles_functions *gl = &d->c->gl;
	enum band_blend blend = band_blend_of(l);
	enum gles_use use = GLES_SPRITES_PUT + band_kernel_of(l);
	int64_t bytes = bytes_of(d, blend);
	bool is_least = blend == BAND_STRONGEST || blend == BAND_COVERING;
	if (!gles_programs_want(d->c, d->program, use, error) ||
		!gles_programs_want(d->c, d->program, GLES_COMBINE_SUMS, error) ||
		!gles_buffer_reserve(d->c, &d->ink, bytes, "the ink of a layer", error))
		return false;
	gles_draw_fill(d, &d->ink, (uint32_t)(bytes / 4), is_least ? BARE : 0);
	gl->UseProgram(d->program[use]);
	if (l->texture || l->paint)
		gles_draw_bind_texture(d, 1, GL_TEXTURE_2D_ARRAY, d->layers.texture[layer]);
	gles_draw_bind_storage(d, 2, d->ink.name);
	gles_draw_bind_storage(d, 3, d->strokes[layer].name);
	gles_draw_bind_storage(d, 4, d->commands.name);
	if (blend == BAND_LAID)
		put(d, layer, true);
	put(d, layer, false);
	gl->BindFramebuffer(GL_FRAMEBUFFER, d->targets.canvas.frame);
	gl->UseProgram(d->program[GLES_COMBINE_SUMS]);
	gl->Enable(GL_BLEND);
	gles_draw_combine(d, blend);
	gl->Disable(GL_BLEND);
	/* The next layer begins with the same words. */
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	return true;
}
