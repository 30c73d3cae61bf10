#include "render/filter-kuwahara.h"
#include "render/filter-tables.h"
#include "render/filter-trace.h"
#include <math.h>
#include <string.h>

/* Noise is rarely more than 1, and never much. */
#define NOISE_MOST 1.5f

static float blur_looks(float sigma_px)
{
	float weight[FILTER_BLUR_RADIUS_MOST + 1];
	return (float)filter_blur_weigh(sigma_px, weight);
}

/* It is found in a picture half as large, by what is beside each pixel there. */
static float flow_looks(float sigma_px)
{
	return 2 * (blur_looks(sigma_px / 2) + 2);
}

static float trace_looks(float sigma_px)
{
	return fminf(ceilf(2 * sigma_px), FILTER_TRACE_MOST) + 1;
}

static float solid_looks(float px)
{
	return FILTER_SOLID_BLOCK * (blur_looks(filter_solid_sigma(px)) + 2);
}

/* Along rows, then columns. */
#define CALM_LOOKS (FILTER_CALM_REACH + 1)

static float kuwahara_looks(const struct step *s, float px)
{
	return s->kuwahara.passes * ((float)kuwahara_radius(&s->kuwahara, px) + 1);
}

static float anisotropic_looks(const struct step *s, float px)
{
	const struct anisotropic_step *k = &s->anisotropic;
	return k->passes * ((float)anisotropic_reach(fmaxf(k->radius_px * px, 1)) +
				   flow_looks(k->tensor_px * px));
}

static float bilateral_looks(const struct step *s, float px)
{
	float weight[BILATERAL_RADIUS_MOST + 1];
	return s->bilateral.passes *
	       (float)bilateral_weigh(fmaxf(s->bilateral.sigma_px * px, 0.5f), weight);
}

static float gaussian_looks(const struct step *s, float px)
{
	return blur_looks(s->gaussian.sigma_px * px);
}

static float gaps_looks(const struct step *s, float px)
{
	return (s->gaps.radius_px > 0 ? s->gaps.radius_px : GAPS_RADIUS_MOST_PX) * px + 8;
}

static float quantise_looks(const struct step *s, float px)
{
	return blur_looks(s->quantise.smooth_px * px) + 1;
}

static float dog_looks(const struct step *s, float px)
{
	const struct dog_step *k = &s->dog;
	float sigma = fmaxf(k->sigma_px * px, 0.3f);
	float found = k->flow_px > 0
			      ? flow_looks(dog_tensor_px(k) * px) + trace_looks(sigma * k->ratio) +
					trace_looks(k->flow_px * px)
			      : blur_looks(sigma * k->ratio);
	return found + solid_looks(px);
}

static float edges_looks(const struct step *s, float px)
{
	const struct edges_step *k = &s->edges;
	return 2 * NOISE_MOST * k->wobble_px * px + k->width_px * px / 2 + solid_looks(px) +
	       CALM_LOOKS + EDGES_REACH + 8;
}

static float watercolour_looks(const struct step *s, float px)
{
	return NOISE_MOST * s->watercolour.wobble_px * px + blur_looks(1.2f * px) + CALM_LOOKS + 2;
}

static float brush_looks(const struct step *s, float px)
{
	return flow_looks(s->flow.tensor_px * px) + trace_looks(s->flow.across_px * px) +
	       trace_looks(s->flow.length_px * px / 2);
}

static float oil_looks(const struct step *s, float px)
{
	return flow_looks(s->oil.tensor_px * px) + trace_looks(s->oil.length_px * px / 2) +
	       CALM_LOOKS + 2;
}

static float pencil_looks(const struct step *s, float px)
{
	(void)s;
	return solid_looks(px) + CALM_LOOKS;
}

static float occlusion_looks(const struct step *s, float px)
{
	(void)s;
	return OCCLUSION_REACH_MOST_PX * px + blur_looks(2) + 1;
}

/* What others draw reaches no farther than they look. */
static float reach_looks(const struct step *s, float px)
{
	return s->kind->radius_px(s->bytes) * px + 8;
}

static float whole_looks(const struct step *s, float px)
{
	(void)s;
	(void)px;
	return INFINITY;
}

static const struct row {
	const char *name; /* of the kind */
	float (*looks_px)(const struct step *s, float px);
} rows[] = {
	{ "kuwahara", kuwahara_looks },
	{ "anisotropic-kuwahara", anisotropic_looks },
	{ "bilateral", bilateral_looks },
	{ "gaussian", gaussian_looks },
	{ "gaps", gaps_looks },
	{ "quantise", quantise_looks },
	{ "dog", dog_looks },
	{ "edges", edges_looks },
	{ "watercolour", watercolour_looks },
	{ "flow", brush_looks },
	{ "oil", oil_looks },
	{ "pencil", pencil_looks },
	{ "occlusion", occlusion_looks },
	{ "neural", whole_looks },
};

static float looks_px(const struct step *s, float px)
{
	for (size_t n = 0; n < G_N_ELEMENTS(rows); n++)
		if (strcmp(rows[n].name, s->kind->name) == 0)
			return rows[n].looks_px(s, px);
	return reach_looks(s, px);
}

uint32_t filter_looks(const struct step *filters, uint32_t count, float px)
{
	float sum = 0;
	for (uint32_t n = 0; n < count; n++)
		sum += step_is_filter(&filters[n]) ? looks_px(&filters[n], px) : 0;
	return isfinite(sum) ? (uint32_t)ceilf(sum) : UINT32_MAX;
}
