#include "render/gles-draw-private.h"
#include "render/mask.h"

/* Views that are dispatched at once: of each as many groups as the one of them wants that wants most. */
#define AT_ONCE 1024u

void gles_draw_points_of(gles_draw *d, const struct gles_run *r)
{
	const struct gles_functions *gl = &d->c->gl;
	gles_draw_bind_storage(d, 0, d->scene.slab[r->slab].points);
	for (uint32_t n = 0; n < r->count; n += AT_ONCE) {
		uint32_t views = MIN(r->count - n, AT_ONCE);
		const uint8_t *slices = d->views.slices->data + r->first + n;
		GLuint most = 0;
		for (uint32_t k = 0; k < views; k++)
			most = MAX(most, slices[k]);
		if (!most)
			continue;
		gl->Uniform1ui(0, r->first + n);
		gl->DispatchCompute(most, views, 1);
	}
}

void gles_draw_keys(gles_draw *d, enum gles_use use)
{
	const struct gles_functions *gl = &d->c->gl;
	/* The image may have been read as a texture by a sheet before. */
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
	gl->UseProgram(d->program[use]);
	gl->BindImageTexture(0, d->targets.keys, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
	gl->DispatchCompute((d->targets.width + 31) / 32, (d->targets.height + 7) / 8, 1);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
	gles_draw_bind_texture(d, 0, GL_TEXTURE_2D, d->targets.keys);
}

/* Plane surfaces, which are other buffers than those of chunks. */
static bool add_planes(gles_draw *d, const frame *f, GError **error)
{
	if (!gles_planes_fill(d->c, &d->planes, f, d->views.view, d->views.count, error))
		return false;
	if (!d->planes.spans)
		return true;
	if (!gles_programs_want(d->c, d->program, GLES_PLANE_MASK, error))
		return false;
	d->c->gl.UseProgram(d->program[GLES_PLANE_MASK]);
	gles_draw_bind_storage(d, 2, d->keys.name);
	gles_planes_draw(d->c, &d->planes);
	return true;
}

bool gles_draw_mask(gles_draw *d, const frame *f, GError **error)
{
	int64_t pixels = (int64_t)d->targets.width * d->targets.height;
	if (!gles_buffer_reserve(d->c, &d->keys, pixels * 4, "the depths of such a picture", error))
		return false;
	gles_draw_fill(d, &d->keys, (uint32_t)pixels, MASK_EMPTY);
	if (!add_planes(d, f, error))
		return false;
	d->c->gl.UseProgram(d->program[GLES_MASK]);
	gles_draw_bind_storage(d, 1, d->views.buffer.name);
	gles_draw_bind_storage(d, 2, d->keys.name);
	for (guint n = 0; n < d->views.runs->len; n++)
		gles_draw_points_of(d, gles_draw_run(d, n));
	gles_draw_keys(d, GLES_HOLES);
	return true;
}

bool gles_draw_hide(gles_draw *d, GError **error)
{
	const struct gles_functions *gl = &d->c->gl;
	GLuint across = (d->targets.width + MASK_TILE - 1) / MASK_TILE,
	       down = (d->targets.height + MASK_TILE - 1) / MASK_TILE;
	_Static_assert(MASK_TILE == 16, "as deepest.glsl and hide.glsl have it");
	if (!gles_buffer_reserve(d->c, &d->deepest, (int64_t)across * down * 4,
		    "the depths of such a picture", error))
		return false;
	gl->UseProgram(d->program[GLES_DEEPEST]);
	gles_draw_bind_storage(d, 2, d->deepest.name);
	gl->DispatchCompute(across, down, 1);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	gl->UseProgram(d->program[GLES_HIDE]);
	gles_draw_bind_storage(d, 1, d->views.buffer.name);
	gles_draw_bind_storage(d, 3, d->views.buffer.name);
	gl->Uniform1ui(1, d->views.count);
	gl->DispatchCompute((d->views.count + 63) / 64, 1, 1);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	return true;
}

/* ---- coloured points, and what lies around them ---- */

static void add_colours_of_planes(gles_draw *d, uint32_t from, uint32_t end)
{
	d->c->gl.UseProgram(d->program[GLES_PLANE_POINTS]);
	d->c->gl.Uniform2i(1, (GLint)from, (GLint)end);
	gles_draw_bind_storage(d, 2, d->sums.name);
	gles_draw_bind_storage(d, 3, d->planes.texels.name);
	gles_planes_draw(d->c, &d->planes);
}

static void add_points(gles_draw *d, uint32_t from, uint32_t end)
{
	const struct gles_functions *gl = &d->c->gl;
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT); /* the strip before has been read */
	gles_draw_fill(d, &d->sums, (end - from) * d->targets.width * 4, 0);
	if (d->planes.spans)
		add_colours_of_planes(d, from, end);
	gl->UseProgram(d->program[GLES_POINTS]);
	gl->Uniform2i(1, (GLint)from, (GLint)end);
	gles_draw_bind_storage(d, 1, d->views.buffer.name);
	gles_draw_bind_storage(d, 2, d->sums.name);
	for (guint n = 0; n < d->views.runs->len; n++) {
		const struct gles_run *r = gles_draw_run(d, n);
		if (!r->has_points)
			continue;
		gles_draw_bind_storage(d, 3, d->scene.slab[r->slab].looks);
		gles_draw_points_of(d, r);
	}
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

static void draw_strip(gles_draw *d, uint32_t from, uint32_t end, bool is_flat)
{
	const struct gles_functions *gl = &d->c->gl;
	if (d->layers.has_points)
		add_points(d, from, end);
	gl->UseProgram(d->program[GLES_GROUND]);
	gl->Uniform2i(1, (GLint)from, (GLint)end);
	gl->Uniform1ui(2, d->layers.has_points);
	gl->Uniform1ui(3, is_flat);
	gles_draw_bind_storage(d, 2, d->layers.has_points ? d->sums.name : d->keys.name);
	gl->Scissor(0, (GLint)from, (GLsizei)d->targets.width, (GLsizei)(end - from));
	gl->DrawArrays(GL_TRIANGLES, 0, 3);
}

bool gles_draw_ground(gles_draw *d, bool is_flat, GError **error)
{
	const struct gles_functions *gl = &d->c->gl;
	int64_t row = (int64_t)d->targets.width * 16,
		most = MIN(d->c->about.limits.storage_block_bytes, GLES_BLOCK_BYTES);
	uint32_t rows = (uint32_t)CLAMP(most / row, 1, d->targets.height);
	if (!d->layers.has_points)
		rows = d->targets.height;
	else if (rows < d->targets.height &&
		 rows > BAND_ROWS) /* whole bands, for holes are filled inside of them */
		rows -= rows % BAND_ROWS;
	if (d->layers.has_points &&
		!gles_buffer_reserve(d->c, &d->sums, row * rows, "sums of points", error))
		return false;
	if (d->layers.has_points && d->planes.spans &&
		!gles_programs_want(d->c, d->program, GLES_PLANE_POINTS, error))
		return false;
	gl->BindFramebuffer(GL_FRAMEBUFFER, d->targets.canvas.frame);
	gles_layers_bind_pipelines(d->c, &d->layers);
	gles_draw_bind_texture(d, 2, GL_TEXTURE_2D, d->layers.relief);
	gl->Enable(GL_SCISSOR_TEST);
	for (uint32_t from = 0; from < d->targets.height; from += rows)
		draw_strip(d, from, MIN(from + rows, d->targets.height), is_flat);
	gl->Disable(GL_SCISSOR_TEST);
	return true;
}
