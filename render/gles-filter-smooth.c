/* Filters that smooth, as passes: beside the functions of the same names in filter-*.c, whose shaders say what planes are. */
#include "render/filter-tables.h"
#include "render/gles-filter.h"
#include <math.h>
#include <string.h>

enum { KUWAHARA_ACROSS, KUWAHARA_DOWN, KUWAHARA_TAKE };

void gles_kuwahara(struct gles_filter_job *j, const struct step *s)
{
	const struct kuwahara_step *k = &s->kuwahara;
	uint32_t radius = (uint32_t)kuwahara_radius(k, j->px), width = j->image.width + radius,
		 height = j->image.height + radius;
	GLuint sums = gles_filter_room(j, 0, (int64_t)width * j->image.height * 16),
	       squares = gles_filter_room(j, 1, (int64_t)width * height * 8);
	for (int n = 0; n < (int)k->passes; n++) {
		struct gles_pass p = { .use = GLES_FILTER_KUWAHARA,
			.mode = KUWAHARA_ACROSS,
			.width = width,
			.height = j->image.height,
			.plane = { sums, squares },
			.by = { { k->softness } },
			.whole = { { (int32_t)radius } } };
		gles_pass_run(j, &p);
		p.mode = KUWAHARA_DOWN;
		p.height = height;
		gles_pass_run(j, &p);
		p.mode = KUWAHARA_TAKE;
		p.width = p.height = 0;
		gles_pass_run(j, &p);
		gles_filter_finish(j, k->where, k->passes, (float)n);
	}
}

/* As filter-anisotropic.glsl reads them: x, y, the weight's bits, and where a sector begins. */
static void hold_taps(struct gles_filter_job *j, float radius)
{
	struct gles_filters *f = &j->d->filters;
	if (f->taps.name && f->taps_radius == radius)
		return;
	struct anisotropic_pass p = { .reach = anisotropic_reach(radius) };
	p.pitch = 2 * p.reach + 1;
	g_autoptr(GArray) taps = anisotropic_taps(&p, radius);
	size_t count = MAX(taps->len, G_N_ELEMENTS(p.first));
	g_autofree int32_t(*to)[4] = g_malloc0_n(count, sizeof *to);
	for (guint n = 0; n < taps->len; n++) {
		int32_t side = (int32_t)p.pitch, reach = (int32_t)p.reach,
			place = p.tap[n].offset + reach * side + reach;
		to[n][0] = place % side - reach;
		to[n][1] = place / side - reach;
		memcpy(&to[n][2], &p.tap[n].weight, sizeof p.tap[n].weight);
	}
	for (size_t n = 0; n < G_N_ELEMENTS(p.first); n++)
		to[n][3] = (int32_t)p.first[n];
	if (gles_buffer_put(j->d->c, &f->taps, to, (int64_t)(count * sizeof *to),
		    "the places of a filter", &j->error))
		f->taps_radius = radius;
}

void gles_anisotropic(struct gles_filter_job *j, const struct step *s)
{
	const struct anisotropic_step *k = &s->anisotropic;
	_Static_assert(ANISOTROPIC_WAYS == 48 && ANISOTROPIC_LENGTHS == 8,
		"as filter-anisotropic.glsl has it");
	hold_taps(j, fmaxf(k->radius_px * j->px, 1));
	for (int n = 0; n < (int)k->passes; n++) {
		struct gles_pass p = { .use = GLES_FILTER_ANISOTROPIC,
			.plane = { 0, 0, gles_flow_find(j, k->tensor_px), j->d->filters.taps.name },
			.by = { { k->stretch, k->sharpness } },
			.whole = { { (int32_t)((j->image.width + 1) / 2) } } };
		gles_pass_run(j, &p);
		gles_filter_finish(j, k->where, k->passes, (float)n);
	}
}

enum { BILATERAL_TO_LAB, BILATERAL_ACROSS, BILATERAL_DOWN, BILATERAL_OF_LAB };

GLuint gles_to_lab(struct gles_filter_job *j, uint32_t plane)
{
	struct gles_pass p = { .use = GLES_FILTER_BILATERAL,
		.mode = BILATERAL_TO_LAB,
		.plane = { 0, gles_filter_plane(j, plane, 3) } };
	gles_pass_run(j, &p);
	return p.plane[1];
}

void gles_bilateral(struct gles_filter_job *j, const struct step *s)
{
	const struct bilateral_step *k = &s->bilateral;
	float weight[BILATERAL_RADIUS_MOST + 1];
	uint32_t radius = bilateral_weigh(fmaxf(k->sigma_px * j->px, 0.5f), weight);
	GLuint one = gles_to_lab(j, 0), other = gles_filter_plane(j, 1, 3);
	struct gles_pass p = { .use = GLES_FILTER_BILATERAL,
		.by = { { 0.5f / (k->sigma_tone * k->sigma_tone) } },
		.whole = { { (int32_t)radius } } };
	for (uint32_t n = 0; n <= radius; n++)
		p.by[1 + n / 4][n % 4] = weight[n];
	for (int n = 0; n < (int)k->passes; n++)
		for (int down = 0; down < 2; down++) {
			p.mode = down ? BILATERAL_DOWN : BILATERAL_ACROSS;
			p.plane[0] = down ? other : one;
			p.plane[1] = down ? one : other;
			gles_pass_run(j, &p);
		}
	p.mode = BILATERAL_OF_LAB;
	p.plane[0] = one;
	gles_pass_run(j, &p);
	gles_filter_finish(j, k->where, 1, 0);
}

void gles_gaussian(struct gles_filter_job *j, const struct step *s)
{
	gles_blur_run(j, &(struct gles_blur){ .channels = 4 }, s->gaussian.sigma_px * j->px);
	gles_filter_finish(j, s->gaussian.where, 1, 0);
}

void gles_gaps(struct gles_filter_job *j, const struct step *s)
{
	int32_t radius = gaps_radius(&s->gaps, j->px, j->spacing_px);
	struct gles_pass p = { .use = GLES_FILTER_GAPS,
		.plane = { 0, gles_filter_plane(j, 0, 1), gles_counts(j, 1) },
		.whole = { { radius, gaps_step_px(radius) } } };
	gles_pass_run(j, &p);
	gles_filter_take(j, j->image.depth, 0);
	gles_filter_swap(&j->image);
}

void gles_flow(struct gles_filter_job *j, const struct step *s)
{
	const struct flow_step *k = &s->flow;
	float across = k->across_px * j->px;
	struct gles_trace t = { .flow = gles_flow_find(j, k->tensor_px), .is_pixels = true };
	if (across >= 0.3f) {
		t.to = gles_filter_plane(j, 3, 1);
		t.is_across = true;
		t.sigma = across;
		gles_trace_run(j, &t);
		t.from = t.to;
		t.to = 0;
		t.is_across = false;
	}
	t.sigma = fmaxf(k->length_px * j->px / 2, 0.5f);
	gles_trace_run(j, &t);
	gles_filter_finish(j, k->where, 1, 0);
}
