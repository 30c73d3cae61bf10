#include "render/gles-filter.h"
#include "render/filter-tables.h"
#include <math.h>
#include <string.h>

/* Filter of filter.glsl. */
struct rules_block {
	int32_t area[4], extent[4];
	float bare[4], acting[4];
	float by[GLES_PASS_BY][4];
	int32_t whole[GLES_PASS_WHOLE][4];
};

/* ---- passes ---- */

GLuint gles_filter_room(struct gles_filter_job *j, uint32_t n, int64_t bytes)
{
	struct gles_buffer *b = &j->d->filters.plane[n];
	g_assert(n < GLES_FILTER_PLANES);
	if (j->error || !gles_buffer_reserve(j->d->c, b, bytes, "filters of a picture", &j->error))
		return 0;
	return b->name;
}

GLuint gles_filter_plane(struct gles_filter_job *j, uint32_t n, uint32_t floats)
{
	return gles_filter_room(j, n, (int64_t)j->image.width * j->image.height * floats * 4);
}

static bool set_rules(struct gles_filter_job *j, const struct gles_pass *p)
{
	const struct gles_filter_image *i = &j->image;
	bool is_acting = p->where != WHERE_ALL && i->away;
	struct rules_block r = {
		.area = { (int32_t)i->width, (int32_t)i->height, (int32_t)i->left,
			(int32_t)i->top },
		.extent = { (int32_t)(p->width ? p->width : i->width),
			(int32_t)(p->height ? p->height : i->height), p->mode, 0 },
		.bare = { j->paper[0], j->paper[1], j->paper[2], j->px },
		.acting = { is_acting ? (float)p->where : 0, j->f->focus.filters, p->times,
			p->less },
	};
	memcpy(r.by, p->by, sizeof r.by);
	memcpy(r.whole, p->whole, sizeof r.whole);
	struct gles_buffer *to = &j->d->filters.rules;
	if (!gles_buffer_put(j->d->c, to, &r, sizeof r, "filters of a picture", &j->error))
		return false;
	j->d->c->gl.BindBufferBase(GL_UNIFORM_BUFFER, 2, to->name);
	return true;
}

static void bind(struct gles_filter_job *j, const struct gles_pass *p)
{
	const struct gles_filter_image *i = &j->image;
	bool is_filter = p->use < GLES_SHEET_SURFACE;
	for (GLuint n = 0; n < G_N_ELEMENTS(p->own) && !is_filter; n++)
		gles_draw_bind_storage(j->d, n, p->own[n]);
	if (!is_filter)
		return;
	GLuint pixels[4] = { p->from ? p->from : i->pixels->name, p->to ? p->to : i->spare->name,
		i->depth->name, i->away ? i->away->name : i->depth->name };
	for (GLuint n = 0; n < 4; n++) {
		gles_draw_bind_storage(j->d, n, pixels[n]);
		gles_draw_bind_storage(j->d, 4 + n, p->plane[n]);
	}
}

void gles_pass_run(struct gles_filter_job *j, const struct gles_pass *p)
{
	const struct gles_filter_image *i = &j->image;
	const struct gles_functions *gl = &j->d->c->gl;
	if (j->error || !gles_programs_want(j->d->c, j->d->program, p->use, &j->error) ||
		!set_rules(j, p))
		return;
	gl->UseProgram(j->d->program[p->use]);
	bind(j, p);
	uint32_t width = p->width ? p->width : i->width, height = p->height ? p->height : i->height;
	gl->DispatchCompute((width + 31) / 32, (height + 7) / 8, 1);
	gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void gles_filter_swap(struct gles_filter_image *i)
{
	struct gles_buffer was = *i->pixels;
	*i->pixels = *i->spare;
	*i->spare = was;
}

void gles_filter_take(struct gles_filter_job *j, struct gles_buffer *b, uint32_t plane)
{
	struct gles_buffer was = *b;
	if (j->error)
		return;
	*b = j->d->filters.plane[plane];
	j->d->filters.plane[plane] = was;
}

void gles_filter_finish(struct gles_filter_job *j, int32_t where, float times, float less)
{
	struct gles_pass p = {
		.use = GLES_FILTER_FINISH, .where = where, .times = times, .less = less
	};
	if (where != WHERE_ALL && j->image.away && j->f->focus.filters > 0)
		gles_pass_run(j, &p);
	gles_filter_swap(&j->image);
}

void gles_filters_clear(const gles_context *c, struct gles_filters *f)
{
	for (int n = 0; n < GLES_FILTER_PLANES; n++)
		gles_buffer_clear(c, &f->plane[n]);
	gles_buffer_clear(c, &f->taps);
	gles_buffer_clear(c, &f->rules);
}

/* ---- Gaussian means ---- */

enum { BLUR_FROM_PIXELS = 1, BLUR_TO_PIXELS = 2 };

static void weigh(struct gles_pass *p, float sigma_px)
{
	float weight[FILTER_BLUR_RADIUS_MOST + 1];
	uint32_t radius = filter_blur_weigh(sigma_px, weight);
	p->whole[0][0] = (int32_t)radius;
	for (uint32_t k = 0; k <= radius; k++)
		p->by[k / 4][k % 4] = weight[k];
}

void gles_blur_run(struct gles_filter_job *j, const struct gles_blur *b, float sigma_px)
{
	struct gles_pass p = { .use = GLES_FILTER_BLUR, .width = b->width, .height = b->height };
	GLuint between = gles_filter_plane(j, b->between, b->channels);
	weigh(&p, sigma_px);
	p.whole[0][1] = (int32_t)b->channels;
	p.whole[0][3] = b->from ? 0 : BLUR_FROM_PIXELS;
	p.plane[0] = b->from;
	p.plane[1] = between;
	gles_pass_run(j, &p);
	p.whole[0][2] = 1;
	p.whole[0][3] = b->to ? 0 : BLUR_TO_PIXELS;
	p.plane[0] = between;
	p.plane[1] = b->to;
	gles_pass_run(j, &p);
}

/* ---- numbers of pixels ---- */

enum { NUMBERS_LIGHTNESS, NUMBERS_COUNT, NUMBERS_SOLID, NUMBERS_CALM_ACROSS, NUMBERS_CALM_DOWN };

GLuint gles_lightness(struct gles_filter_job *j, uint32_t plane)
{
	struct gles_pass p = { .use = GLES_FILTER_NUMBERS, .mode = NUMBERS_LIGHTNESS };
	p.plane[1] = gles_filter_plane(j, plane, 1);
	gles_pass_run(j, &p);
	return p.plane[1];
}

GLuint gles_counts(struct gles_filter_job *j, uint32_t plane)
{
	struct gles_pass p = { .use = GLES_FILTER_NUMBERS,
		.mode = NUMBERS_COUNT,
		.width = (j->image.width + FILTER_SOLID_BLOCK - 1) / FILTER_SOLID_BLOCK,
		.height = (j->image.height + FILTER_SOLID_BLOCK - 1) / FILTER_SOLID_BLOCK };
	p.plane[1] = gles_filter_plane(j, plane, 1);
	gles_pass_run(j, &p);
	return p.plane[1];
}

GLuint gles_solidity(struct gles_filter_job *j, uint32_t plane)
{
	uint32_t width = (j->image.width + FILTER_SOLID_BLOCK - 1) / FILTER_SOLID_BLOCK,
		 height = (j->image.height + FILTER_SOLID_BLOCK - 1) / FILTER_SOLID_BLOCK;
	GLuint own = gles_counts(j, plane), other = gles_filter_plane(j, 0, 1);
	struct gles_pass p = {
		.use = GLES_FILTER_NUMBERS, .mode = NUMBERS_SOLID, .width = width, .height = height
	};
	gles_blur_run(j, &(struct gles_blur){ own, other, width, height, 1, 1 },
		filter_solid_sigma(j->px));
	p.plane[0] = other;
	p.plane[1] = own;
	gles_pass_run(j, &p);
	return own;
}

GLuint gles_calm_depth(struct gles_filter_job *j, uint32_t plane, uint32_t between)
{
	struct gles_pass p = { .use = GLES_FILTER_NUMBERS, .mode = NUMBERS_CALM_ACROSS };
	p.plane[1] = gles_filter_plane(j, between, 1);
	gles_pass_run(j, &p);
	p.mode = NUMBERS_CALM_DOWN;
	p.plane[0] = p.plane[1];
	p.plane[1] = gles_filter_plane(j, plane, 1);
	gles_pass_run(j, &p);
	return p.plane[1];
}

GLuint gles_noise(
	struct gles_filter_job *j, uint32_t plane, float grain_px, uint32_t seed, GLuint calm)
{
	struct filter_noise_job n;
	struct gles_pass p = { .use = GLES_FILTER_NOISE };
	_Static_assert(FILTER_NOISE_LOWEST == -24 && FILTER_NOISE_OCTAVES == 48,
		"as filter-noise.glsl has it");
	filter_noise_look(&n, j->f);
	p.by[0][0] = fmaxf(grain_px, 1);
	for (int o = 0; o < FILTER_NOISE_OCTAVES; o++)
		for (int k = 0; k < 3; k++) {
			p.by[1 + o][k] = n.within[k][o];
			p.whole[o][k] = n.cell[k][o];
		}
	p.whole[FILTER_NOISE_OCTAVES][0] = (int32_t)seed;
	p.plane[0] = calm;
	p.plane[1] = gles_filter_plane(j, plane, 1);
	gles_pass_run(j, &p);
	return p.plane[1];
}

GLuint gles_waves(struct gles_filter_job *j, uint32_t plane, float shortest_px, GLuint calm)
{
	struct filter_waves_job w;
	struct gles_pass p = { .use = GLES_FILTER_WAVES };
	_Static_assert(
		FILTER_WAVES_LOWEST == -12 && FILTER_WAVES == 20, "as filter-waves.glsl has it");
	filter_waves_look(&w, j->f);
	p.by[0][0] = shortest_px;
	for (int n = 0; n < FILTER_WAVES; n++) {
		memcpy(p.by[1 + n], w.way[n], sizeof w.way[n]);
		p.by[1 + n][3] = w.at_eye[n];
	}
	p.plane[0] = calm;
	p.plane[1] = gles_filter_plane(j, plane, 1);
	gles_pass_run(j, &p);
	return p.plane[1];
}

/* ---- depth inpainting ---- */

enum { INPAINT_GREY, INPAINT_DEPTH };

void gles_inpaint_begin(struct gles_filter_job *j)
{
	struct gles_pass p = { .use = GLES_FILTER_INPAINT, .mode = INPAINT_GREY };
	p.plane[0] = j->image.grey->name;
	gles_pass_run(j, &p);
}

GLuint gles_inpaint(struct gles_filter_job *j, float threshold, int radius, uint32_t plane)
{
	struct gles_pass p = { .use = GLES_FILTER_INPAINT, .mode = INPAINT_DEPTH };
	p.by[0][0] = threshold * 255;
	p.whole[0][0] = radius;
	p.plane[0] = j->image.grey->name;
	p.plane[1] = gles_filter_plane(j, plane, 1);
	gles_pass_run(j, &p);
	return p.plane[1];
}

/* ---- what runs where ---- */

enum { FLOW_HALVE, FLOW_TENSOR, FLOW_FIND };

GLuint gles_flow_find(struct gles_filter_job *j, float sigma_px)
{
	uint32_t width = (j->image.width + 1) / 2, height = (j->image.height + 1) / 2;
	GLuint half = gles_filter_plane(j, 0, 3), tensor = gles_filter_plane(j, 1, 3);
	struct gles_pass p = {
		.use = GLES_FILTER_FLOW, .mode = FLOW_HALVE, .width = width, .height = height
	};
	p.plane[1] = half;
	gles_pass_run(j, &p);
	p.mode = FLOW_TENSOR;
	p.plane[0] = half;
	p.plane[1] = tensor;
	gles_pass_run(j, &p);
	gles_blur_run(
		j, &(struct gles_blur){ tensor, half, width, height, 3, 2 }, sigma_px * j->px / 2);
	p.mode = FLOW_FIND;
	p.plane[0] = half;
	p.plane[1] = gles_filter_plane(j, 2, 3);
	gles_pass_run(j, &p);
	return p.plane[1];
}

void gles_trace_run(struct gles_filter_job *j, const struct gles_trace *t)
{
	struct filter_trace weights;
	struct gles_pass p = { .use = GLES_FILTER_TRACE };
	filter_trace_weigh(&weights, t->sigma);
	for (int n = 0; n <= weights.steps; n++)
		p.by[n / 4][n % 4] = weights.weight[n];
	p.whole[0][0] = weights.steps;
	p.whole[0][1] = t->by;
	p.whole[0][2] = t->is_across;
	p.whole[0][3] = t->is_pixels;
	p.whole[1][0] = (int32_t)((j->image.width + 1) / 2);
	p.plane[2] = t->flow;
	if (t->is_pixels) {
		p.from = t->from;
		p.to = t->to;
	} else {
		p.plane[0] = t->from;
		p.plane[1] = t->to;
	}
	gles_pass_run(j, &p);
}
