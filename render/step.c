#include "render/step-private.h"
#include <math.h>
#include <string.h>

const char *const step_point_names[] = { [INK_ALL] = "all",
	[INK_SURFACE] = "surface",
	[INK_FEATURES] = "features",
	[INK_DIRECTIONAL] = "directional",
	[INK_NON_DIRECTIONAL] = "non-directional",
	[INK_DITHERING] = "dithering",
	NULL };
const char *const step_tone_names[] = { [TONE_EVEN] = "even", [TONE_COLOUR] = "colour", NULL };
const char *const step_direction_names[] = {
	[DIRECTION_EDGE] = "edge", [DIRECTION_SCREEN] = "screen", [DIRECTION_LINE] = "line", NULL
};
const char *const step_colour_names[] = { [COLOUR_INK] = "ink", [COLOUR_POINT] = "point", NULL };
const char *const step_blend_names[] = {
	[BLEND_MULTIPLY] = "multiply", [BLEND_PAINT] = "paint", NULL
};

static const struct step_parameter sprite_parameters[] = {
	WHICH(INK_FEATURES),
	TONE(TONE_EVEN),
	SPACING(4),
	DIAMETER(2.5),
	LENGTH_VARIATION(0.2),
	GROW,
	COPIES,
	SCATTER,
	REACH_OVER,
	INK(0x2b2b2b),
	OPACITY(0.8),
	OPACITY_VARIATION(0.2),
	DEGREE(0.5),
	TONE_CURVE,
	SURROUNDINGS(0.2),
	{ NULL },
};

static const struct step_parameter line_parameters[] = {
	WHICH(INK_NON_DIRECTIONAL),
	TONE(TONE_EVEN),
	DIRECTION(DIRECTION_SCREEN),
	ANGLE(45),
	ANGLE_VARIATION(4),
	SPACING(6),
	LENGTH(12),
	WIDTH(1.2, 6),
	LENGTH_VARIATION(0.2),
	GROW,
	COPIES,
	SCATTER,
	REACH_OVER,
	INK(0x2b2b2b),
	OPACITY(0.7),
	OPACITY_VARIATION(0.2),
	DEGREE(0.5),
	TONE_CURVE,
	SURROUNDINGS(0.2),
	{ NULL },
};

static const struct step_parameter stroke_parameters[] = {
	WHICH(INK_DIRECTIONAL),
	TONE(TONE_EVEN),
	DIRECTION(DIRECTION_EDGE),
	ANGLE(45),
	ANGLE_VARIATION(3),
	SPACING(9),
	LENGTH(30),
	WIDTH(4.5, 20),
	LENGTH_VARIATION(0.2),
	GROW,
	COPIES,
	SCATTER,
	REACH_OVER,
	TEXTURE("pencil"),
	INK(0x2b2b2b),
	OPACITY(0.8),
	OPACITY_VARIATION(0.2),
	DEGREE(0.5),
	TONE_CURVE,
	SURROUNDINGS(0.3),
	{ NULL },
};

static const struct step_parameter stipple_parameters[] = {
	NUMBER(stipple_step, level, RANGE(0, 10, 5, 10), 9, "",
		"seen from the light, a point is left out in each cell of a grid that has 2^level "
		"cells a side"),
	NUMBER(stipple_step, epsilon, RANGE(0, 1, 0, 0.6), 0.3, "",
		"a highlight is where surface faces the light so much more than the eye; less "
		"leaves more out, 0 nothing"),
	NUMBER(stipple_step, passes, RANGE(0, 16, 0, 8), 0, "",
		"how often depths spread to what is beside them, to hide what is behind; 0: as "
		"points are far apart"),
	NUMBER(stipple_step, behind_px, RANGE(0.5, 200, 5, 60), 25.6, "px",
		"so much deeper do depths become each time, in widths of a pixel there"),
	NUMBER(stipple_step, light_distance, RANGE(0, 100, 0, 10), 0, "",
		"of the light from the middle of the site, in its radii; 0: far away"),
	NUMBER(stipple_step, most_points, RANGE(1, 8000, 50, 2000), 600, "",
		"in thousands: of more points a uniform part is drawn"),
	DIAMETER(2.6),
	NUMBER(ink_step, grow, RANGE(1, 8, 1, 4), 1, "",
		"how much larger dots may be where points are farther apart than dots are wide"),
	INK_COLOUR(0x161616),
	OPACITY(0.95),
	NUMBER(ink_step, tooth, PART, 0, "", "how much the paper's grain shows in it"),
	{ NULL },
};

/* A dot is as wide as it is long. */
static float ink_radius_px(const void *step)
{
	const struct ink_step *s = step;
	float length_px = s->length_px * (1 + s->length_variation);
	return s->width_px > 0 ? 0.5f * hypotf(length_px, s->width_px) : 0.5f * length_px;
}

/* ---- the others ---- */

static const char *const back_names[] = {
	[BACKS_SHOWN] = "shown", [BACKS_HIDDEN] = "hidden", NULL
};
static const struct step_parameter mask_parameters[] = {
	NUMBER(mask_step, disc, RANGE(0, 8, 0.5, 3), 1.5, "",
		"how large points are when they hide others; 1: as they were measured"),
	NUMBER(mask_step, offset_m, RANGE(0, 10, 0, 0.5), 0.05, "m",
		"what lies no farther behind is not hidden"),
	NUMBER(mask_step, offset_relative, RANGE(0, 0.5, 0, 0.05), 0.004, "",
		"and so much more, as a part of the distance"),
	{ .name = "backs",
		.type = PARAMETER_CHOICE,
		.offset = offsetof(struct mask_step, backs),
		.choices = back_names,
		.fallback = BACKS_SHOWN,
		.unit = "",
		.help = "whether surface is there that is seen from behind" },
	{ .name = "planes",
		.type = PARAMETER_BOOLEAN,
		.offset = offsetof(struct mask_step, planes),
		.unit = "",
		.help = "walls, ground and roofs are plane surfaces with clean edges, in place of "
			"their points" },
	{ NULL },
};

static const struct step_parameter point_parameters[] = {
	NUMBER(points_step, size, RANGE(0.1, 20, 0.5, 4), 1.6, "",
		"how large points are; 1: as they were measured"),
	NUMBER(points_step, least_px, RANGE(0, 64, 0.5, 8), 1.6, "px",
		"diameter that no point is smaller than"),
	EXPOSURE(points_step),
	NUMBER(points_step, brightness, RANGE(0, 4, 0.5, 2), 1, "", "factor on lightness"),
	NUMBER(points_step, contrast, RANGE(0, 4, 0.5, 2), 1, "",
		"factor on what differs from grey"),
	NUMBER(points_step, saturation, RANGE(0, 4, 0, 2), 1, "", "0 is grey, 1 as they are"),
	{ NULL },
};

static const struct step_parameter edl_parameters[] = {
	NUMBER(edl_step, strength, RANGE(0, 10, 0, 4), 1, "", "how dark what lies deeper becomes"),
	NUMBER(edl_step, radius_px, RANGE(0.5, 32, 1, 6), 1.5, "px", "how far away neighbours are"),
	{ NULL },
};

static float point_radius_px(const void *step)
{
	const struct points_step *s = step;
	return 0.5f * s->least_px;
}

static float profile_radius_px(const void *step)
{
	const struct profile_step *s = step;
	/* Where the pen is lifted hangs on what hides the line so far away; and a little on what hides it beside. */
	return 0.5f * s->ink.width_px * s->outlines * (1 + 0.6f * s->pressure) + 2 * s->wobble_px +
	       s->overshoot_px + s->taper_px + 15;
}

static float edl_radius_px(const void *step)
{
	const struct edl_step *s = step;
	return s->radius_px;
}

static float no_radius_px(const void *step)
{
	(void)step;
	return 0;
}

/* ---- filters ---- */

#define REACH(of, px)                                                                              \
	static float of##_radius_px(const void *step)                                              \
	{                                                                                          \
		const struct of##_step *s = step;                                                  \
		return px;                                                                         \
	}
REACH(kuwahara, s->passes * s->radius_px)
REACH(anisotropic, s->passes * 2 * s->radius_px)
REACH(bilateral, s->passes * 2 * s->sigma_px)
REACH(gaussian, 3 * s->sigma_px)
REACH(gaps, s->radius_px > 0 ? s->radius_px : 4)
REACH(dog, 3 * s->sigma_px * s->ratio + 2 * s->flow_px)
REACH(edges, s->width_px + s->wobble_px)
REACH(watercolour, s->wobble_px + 2)
REACH(flow, s->length_px + s->across_px)
REACH(oil, s->length_px)
REACH(warp, s->amplitude_px)

#define FILTER(name, title, help, of, radius, glsl)                                                \
	{                                                                                          \
		name, title, help, STEP_FILTER, sizeof(struct of##_step), of##_parameters, radius, \
			glsl                                                                       \
	}

const struct step_kind step_kinds[] = {
	{ "mask", "Visibility mask", "what is hidden by what; there is one in every pipeline",
		STEP_MASK, sizeof(struct mask_step), mask_parameters, no_radius_px, "mask" },
	{ "points", "Points", "all points in their colours", STEP_LAYER, sizeof(struct points_step),
		point_parameters, point_radius_px, "points" },
	{ "sprites", "Dots", "round dots of one size on the screen", STEP_LAYER,
		sizeof(struct ink_step), sprite_parameters, ink_radius_px, "sprites" },
	{ "lines", "Lines", "thin straight lines", STEP_LAYER, sizeof(struct ink_step),
		line_parameters, ink_radius_px, "lines" },
	{ "strokes", "Strokes", "strokes with a texture", STEP_LAYER, sizeof(struct ink_step),
		stroke_parameters, ink_radius_px, "strokes" },
	{ "hatching", "Hatching",
		"strokes that lie on surfaces, one or two to a point, left out where it is light",
		STEP_LAYER, sizeof(struct hatching_step), hatching_parameters, ink_radius_px,
		"strokes" },
	{ "contours", "Contours", "strokes where smooth surfaces turn away, or nearly do",
		STEP_LAYER, sizeof(struct contours_step), contours_parameters, ink_radius_px,
		"strokes" },
	{ "cut", "Cut", "lines where a plan or section cuts through things", STEP_LAYER,
		sizeof(struct cut_step), cut_parameters, ink_radius_px, "strokes" },
	{ "profile", "Profile lines", "long lines along the edges of things, as a hand draws them",
		STEP_LAYER, sizeof(struct profile_step), profile_parameters, profile_radius_px,
		"lines" },
	{ "paint", "Brush strokes",
		"strokes of paint, broad and fine, that lie on each other and follow the form",
		STEP_LAYER, sizeof(struct paint_step), paint_parameters, ink_radius_px, "strokes" },
	{ "edl", "Eye-dome lighting", "darkens what lies deeper than what is beside it",
		STEP_FILTER, sizeof(struct edl_step), edl_parameters, edl_radius_px, "edl" },
	{ "stipple", "Stippling without normals",
		"dots where points are, fewer in the light; asks for nothing but their places",
		STEP_LAYER, sizeof(struct stipple_step), stipple_parameters, ink_radius_px,
		"stipple" },
	FILTER("kuwahara", "Kuwahara", "even patches with sharp borders, as if painted", kuwahara,
		kuwahara_radius_px, "filter-kuwahara"),
	FILTER("anisotropic-kuwahara", "Painted patches",
		"even patches that run along what the picture shows", anisotropic,
		anisotropic_radius_px, "filter-anisotropic"),
	FILTER("bilateral", "Even colours", "smooths colours and keeps their borders", bilateral,
		bilateral_radius_px, "filter-bilateral"),
	FILTER("gaussian", "Blur", "smooths all", gaussian, gaussian_radius_px, "filter-blur"),
	FILTER("gaps", "Closed gaps", "closes gaps between points", gaps, gaps_radius_px,
		"filter-gaps"),
	FILTER("quantise", "Steps of tone", "few tones, as a cartoon or a poster has", quantise,
		no_radius_px, "filter-quantise"),
	FILTER("dog", "Lines of the picture", "lines where the picture is darker than around it",
		dog, dog_radius_px, "filter-dog"),
	FILTER("edges", "Edges of things", "lines where depth, slant or segment change", edges,
		edges_radius_px, "filter-edges"),
	FILTER("watercolour", "Watercolour", "pigment that gathers at edges and in the paper",
		watercolour, watercolour_radius_px, "filter-watercolour"),
	FILTER("flow", "Drawn-out colours", "smooths along what the picture shows", flow,
		flow_radius_px, "filter-trace"),
	FILTER("oil", "Oil", "traces of a brush that light falls on", oil, oil_radius_px,
		"filter-oil"),
	FILTER("pencil", "Pencil", "strokes of a pencil across the picture, as dark as it is",
		pencil, no_radius_px, "filter-pencil"),
	FILTER("grade", "Colours", "other colours", grade, no_radius_px, "filter-grade"),
	FILTER("warp", "Swaying", "things sway with time", warp, warp_radius_px, "filter-warp"),
	FILTER("occlusion", "Shade in corners", "darkens what lies between things before it",
		occlusion, no_radius_px, "filter-shade"),
	FILTER("neural", "Network", "what a network of one's own makes of the picture", neural,
		no_radius_px, NULL),
	{ "inpaint", "Depth inpainting",
		"gives a depth to what filters drew beside things, so that it hides and is hidden",
		STEP_COMPOSITE, sizeof(struct inpaint_step), inpaint_parameters, no_radius_px,
		"filter-inpaint" },
	{ "composite", "Composition",
		"how the pictures of segments become one; for \"picture\" alone", STEP_COMPOSITE,
		sizeof(struct composite_step), composite_parameters, no_radius_px, "sheet-merge" },
	{ NULL },
};

/* ---- rows ---- */

const struct step_kind *step_kind_find(const char *name)
{
	for (const struct step_kind *k = step_kinds; k->name; k++)
		if (strcmp(k->name, name) == 0)
			return k;
	return NULL;
}

const struct step_parameter *step_parameter_find(
	const struct step_parameter *parameters, const char *name)
{
	for (const struct step_parameter *p = parameters; p->name; p++)
		if (strcmp(p->name, name) == 0)
			return p;
	return NULL;
}

static void fill(const struct step_parameter *p, void *at)
{
	uint32_t rgb = (uint32_t)p->fallback;
	switch (p->type) {
	case PARAMETER_NUMBER: *(float *)at = (float)p->fallback; break;
	case PARAMETER_CHOICE:
	case PARAMETER_BOOLEAN: *(int32_t *)at = (int32_t)p->fallback; break;
	case PARAMETER_COLOUR:
		memcpy(at,
			(uint8_t[4]){
				(uint8_t)(rgb >> 16), (uint8_t)(rgb >> 8), (uint8_t)rgb, 255 },
			4);
		break;
	case PARAMETER_TEXTURE:
	case PARAMETER_MODEL:
	case PARAMETER_XTOON:
	case PARAMETER_PENCILS:
		*(const char **)at = g_intern_static_string(p->fallback_name);
		break;
	}
}

void step_parameters_fill(const struct step_parameter *parameters, void *into)
{
	for (const struct step_parameter *p = parameters; p->name; p++)
		fill(p, (char *)into + p->offset);
}

struct step step_defaults(const struct step_kind *kind)
{
	struct step s;
	memset(&s, 0, sizeof s); /* padding too, for steps are compared */
	s.kind = kind;
	s.id = g_intern_static_string(kind->name);
	step_parameters_fill(kind->parameters, s.bytes);
	return s;
}

bool step_is_hatching(const struct step *s)
{
	return s->kind->parameters == hatching_parameters;
}

bool step_is_contours(const struct step *s)
{
	return s->kind->parameters == contours_parameters;
}

bool step_is_cut(const struct step *s)
{
	return s->kind->parameters == cut_parameters;
}

bool step_is_profile(const struct step *s)
{
	return s->kind->parameters == profile_parameters;
}

bool step_is_paint(const struct step *s)
{
	return s->kind->parameters == paint_parameters;
}

bool step_is_ink(const struct step *s)
{
	return s->kind == step_kind_find("sprites") || s->kind == step_kind_find("lines") ||
	       s->kind == step_kind_find("strokes") || s->kind == step_kind_find("stipple") ||
	       step_is_hatching(s) || step_is_contours(s) || step_is_cut(s) || step_is_profile(s) ||
	       step_is_paint(s);
}

bool step_draws_nothing(const struct step *s)
{
	const struct contours_step *c = &s->contours;
	bool has_opacity = step_parameter_find(s->kind->parameters, "opacity");
	return step_is_ink(s) && ((has_opacity && s->ink.opacity <= 0) ||
					 (step_is_contours(s) && c->outlines <= 0 &&
						 c->steps <= 0 && c->suggestive <= 0));
}

bool step_is_filter(const struct step *s)
{
	return s->kind->stage == STEP_FILTER && s->kind->parameters != edl_parameters;
}

bool step_is_dots(const struct step *s)
{
	return s->kind == step_kind_find("sprites") || s->kind == step_kind_find("stipple");
}
