#ifndef RENDER_STEP_PRIVATE_H
#define RENDER_STEP_PRIVATE_H
/* Rows of tables of parameters. What kinds share has one spelling, one range and one help. Internal to step.c and step-*.c. */
#include "render/step.h"

extern const char *const step_point_names[];
extern const char *const step_tone_names[];
extern const char *const step_direction_names[];
extern const char *const step_colour_names[];
extern const char *const step_blend_names[];
extern const struct step_parameter hatching_parameters[], contours_parameters[], cut_parameters[],
	paint_parameters[], profile_parameters[];
extern const struct step_parameter kuwahara_parameters[], anisotropic_parameters[],
	bilateral_parameters[], gaussian_parameters[], gaps_parameters[], quantise_parameters[],
	dog_parameters[], edges_parameters[], watercolour_parameters[], flow_parameters[],
	oil_parameters[], pencil_parameters[], grade_parameters[], warp_parameters[],
	occlusion_parameters[], neural_parameters[], inpaint_parameters[], composite_parameters[];

#define RANGE(a, b, c, d) .least = (a), .most = (b), .slider_least = (c), .slider_most = (d)
#define NUMBER(kind, field, range, start, in, text)                                                \
	{                                                                                          \
		.name = #field, .type = PARAMETER_NUMBER, .offset = offsetof(struct kind, field),  \
		range, .fallback = (start), .unit = (in), .help = (text)                           \
	}
#define INK_CHOICE(field, names, start, text)                                                      \
	{                                                                                          \
		.name = #field, .type = PARAMETER_CHOICE,                                          \
		.offset = offsetof(struct ink_step, field), .fallback = (start),                   \
		.choices = (names), .unit = "", .help = (text)                                     \
	}
#define PART RANGE(0, 1, 0, 1)

/* ---- ink ---- */

#define WHICH(start)                                                                               \
	INK_CHOICE(points, step_point_names, start,                                                \
		"which points: surface is all but features, features are directional or not, "     \
		"dithering are those that show tones")
#define TONE(start)                                                                                \
	INK_CHOICE(tone, step_tone_names, start,                                                   \
		"as dense everywhere, or as dense as points are dark")
#define SPACING(start)                                                                             \
	NUMBER(ink_step, spacing_px, RANGE(0.5, 200, 2, 40), start, "px",                          \
		"mean distance of neighbours; with the tone of the colour, the least there is")
#define DIAMETER(start)                                                                            \
	NUMBER(ink_step, length_px, RANGE(0.5, 100, 1, 12), start, "px", "diameter of a dot")
#define LENGTH(start)                                                                              \
	NUMBER(ink_step, length_px, RANGE(1, 400, 4, 80), start, "px", "along the stroke")
#define WIDTH(start, high)                                                                         \
	NUMBER(ink_step, width_px, RANGE(0.2, 100, 0.5, high), start, "px", "across the stroke")
#define LENGTH_VARIATION(start)                                                                    \
	NUMBER(ink_step, length_variation, PART, start, "",                                        \
		"how much lengths differ from each other")
#define OPACITY_VARIATION(start)                                                                   \
	NUMBER(ink_step, opacity_variation, PART, start, "",                                       \
		"how much opacities differ from each other")
#define DIRECTION(start)                                                                           \
	INK_CHOICE(direction, step_direction_names, start,                                         \
		"along the edge that a point is of, or as angle_deg tells; line: along an edge "   \
		"even if "                                                                         \
		"it is not sure")
#define ANGLE(start)                                                                               \
	NUMBER(ink_step, angle_deg, RANGE(-360, 360, -90, 90), start, "degrees",                   \
		"on the screen, counterclockwise from the right")
#define ANGLE_VARIATION(start)                                                                     \
	NUMBER(ink_step, angle_variation_deg, RANGE(0, 180, 0, 45), start, "degrees",              \
		"how much directions differ from each other")
#define TEXTURE(start)                                                                             \
	{                                                                                          \
		.name = "texture", .type = PARAMETER_TEXTURE,                                      \
		.offset = offsetof(struct ink_step, texture), .fallback_name = (start),            \
		.unit = "", .help = "of the stroke: a name, or the path of a PNG"                  \
	}
#define INK_COLOUR(start)                                                                          \
	{                                                                                          \
		.name = "ink", .type = PARAMETER_COLOUR, .offset = offsetof(struct ink_step, ink), \
		.fallback = (start), .unit = "", .help = "the colour of the ink"                   \
	}
#define BLEND                                                                                      \
	INK_CHOICE(blend, step_blend_names, BLEND_MULTIPLY,                                        \
		"ink darkens what is below, paint covers it")
#define SATURATION                                                                                 \
	NUMBER(ink_step, saturation, RANGE(0, 4, 0, 2), 1, "",                                     \
		"of points' own colours: 0 is grey, 1 as they are")
#define EXPOSURE(of)                                                                               \
	NUMBER(of, exposure, PART, 0, "",                                                          \
		"how much sites that are all dark are lightened, as if photographed for longer")
#define INK(start)                                                                                 \
	INK_CHOICE(colour, step_colour_names, COLOUR_INK, "that of ink, or each point's own"),     \
		INK_COLOUR(start), BLEND, SATURATION
#define OPACITY(start) NUMBER(ink_step, opacity, PART, start, "", "of the ink")
#define GROW                                                                                       \
	NUMBER(ink_step, grow, RANGE(1, 8, 1, 4), 2, "",                                           \
		"how much larger they may be where points are too few")
#define SCATTER                                                                                    \
	NUMBER(ink_step, scatter, PART, 1, "",                                                     \
		"how far points of surface are moved, so that rows of beams do not show")
#define COPIES                                                                                     \
	NUMBER(ink_step, copies, RANGE(1, 64, 1, 32), 16, "",                                      \
		"strokes that a point of surface may give, in its patch, where points are too "    \
		"few")
#define DEGREE(start)                                                                              \
	NUMBER(ink_step, degree, PART, start, "",                                                  \
		"how much fainter weak features are than strong ones")
#define TONE_CURVE                                                                                 \
	NUMBER(ink_step, tone_strength, PART, 0.8, "",                                             \
		"with the tone of the colour: how much of the paper's lightness black takes"),     \
		NUMBER(ink_step, tone_white, RANGE(0, 1, 0.5, 1), 0.95, "",                        \
			"with the tone of the colour: nothing is drawn from this lightness on"),   \
		NUMBER(ink_step, tone_gamma, RANGE(0.1, 10, 0.4, 3), 1, "",                        \
			"with the tone of the colour: above 1 middle tones stay lighter"),         \
		NUMBER(ink_step, tone_levels, PART, 0, "",                                         \
			"with the tone of the colour: how much lightness is stretched to all "     \
			"that the site has")
#define REACH_OVER                                                                                 \
	NUMBER(ink_step, reach_m, RANGE(0, 10, 0, 1), 0, "m",                                      \
		"how much nearer than the point may be what a stroke lies over, as among leaves; " \
		"0: nothing that is nearer")
#define SURROUNDINGS(grain)                                                                        \
	NUMBER(ink_step, fade_m, RANGE(0, 100000, 0, 200), 0, "m",                                 \
		"distance in which ink fades to half; 0: it does not"),                            \
		NUMBER(ink_step, tooth, PART, grain, "",                                           \
			"how much the paper's grain shows in it"),                                 \
	{                                                                                          \
		.name = "over", .type = PARAMETER_BOOLEAN,                                         \
		.offset = offsetof(struct ink_step, over), .unit = "",                             \
		.help = "drawn over what filters made of the picture"                              \
	}

#endif
