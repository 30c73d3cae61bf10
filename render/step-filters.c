/* The parameters of the steps that work on pictures. */
#include "render/step-private.h"

#define CHOICE(kind, field, names, start, text)                                                    \
	{                                                                                          \
		.name = #field, .type = PARAMETER_CHOICE, .offset = offsetof(struct kind, field),  \
		.fallback = (start), .choices = (names), .unit = "", .help = (text)                \
	}
#define YES_NO(kind, field, start, text)                                                           \
	{                                                                                          \
		.name = #field, .type = PARAMETER_BOOLEAN, .offset = offsetof(struct kind, field), \
		.fallback = (start), .unit = "", .help = (text)                                    \
	}
#define COLOUR(kind, field, start, text)                                                           \
	{                                                                                          \
		.name = #field, .type = PARAMETER_COLOUR, .offset = offsetof(struct kind, field),  \
		.fallback = (start), .unit = "", .help = (text)                                    \
	}
#define WHERE(kind, start)                                                                         \
	CHOICE(kind, where, where_names, start,                                                    \
		"with a focus: all over, only away from it, or only near it")
#define PASSES(kind, start) NUMBER(kind, passes, RANGE(1, 16, 1, 8), start, "", "how often")

static const char *const where_names[] = {
	[WHERE_ALL] = "all", [WHERE_AWAY] = "away", [WHERE_NEAR] = "near", NULL
};
static const char *const quantise_names[] = {
	[QUANTISE_LIGHTNESS] = "lightness", [QUANTISE_CHANNELS] = "channels", NULL
};
static const char *const composite_names[] = { [COMPOSITE_INPAINTED] = "inpainted-depth",
	[COMPOSITE_DEPTH] = "depth",
	[COMPOSITE_LAYERS] = "layers",
	NULL };

const struct step_parameter kuwahara_parameters[] = {
	NUMBER(kuwahara_step, radius_px, RANGE(1, 40, 1, 12), 2, "px",
		"of the window; its four squares have a pixel more a side: 2 is 3 x 3, 4 is 5 x 5"),
	NUMBER(kuwahara_step, softness, PART, 1, "",
		"0: the most even square alone, as it was first told; 1: all, weighted by how even "
		"they are"),
	PASSES(kuwahara_step, 1),
	WHERE(kuwahara_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter anisotropic_parameters[] = {
	NUMBER(anisotropic_step, radius_px, RANGE(1, 24, 2, 12), 5, "px",
		"of the patches that the picture is made of"),
	NUMBER(anisotropic_step, sharpness, RANGE(1, 32, 2, 18), 8, "",
		"how much more even parts count than uneven ones"),
	NUMBER(anisotropic_step, stretch, PART, 1, "",
		"how much longer patches are along what the picture shows"),
	NUMBER(anisotropic_step, tensor_px, RANGE(0.5, 16, 1, 6), 2, "px",
		"around a pixel, in which it is asked what runs where"),
	PASSES(anisotropic_step, 1),
	WHERE(anisotropic_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter bilateral_parameters[] = {
	NUMBER(bilateral_step, sigma_px, RANGE(0.5, 16, 1, 8), 3, "px",
		"standard deviation of distances"),
	NUMBER(bilateral_step, sigma_tone, RANGE(0.5, 100, 1, 20), 4.25, "",
		"standard deviation of colours, in CIELab"),
	PASSES(bilateral_step, 3),
	WHERE(bilateral_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter gaussian_parameters[] = {
	NUMBER(gaussian_step, sigma_px, RANGE(0.3, 40, 0.5, 10), 2, "px", "standard deviation"),
	WHERE(gaussian_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter gaps_parameters[] = {
	NUMBER(gaps_step, radius_px, RANGE(0, 16, 0, 8), 0, "px",
		"half the width of gaps that are closed; 0: as points are far apart"),
	{ NULL },
};

const struct step_parameter quantise_parameters[] = {
	CHOICE(quantise_step, by, quantise_names, QUANTISE_LIGHTNESS,
		"steps of lightness, or of red, green and blue each"),
	NUMBER(quantise_step, levels, RANGE(2, 64, 2, 16), 8, "", "how many there are"),
	NUMBER(quantise_step, softness, PART, 0.65, "",
		"of steps where lightness changes slowly; where it changes fast they are sharp"),
	NUMBER(quantise_step, smooth_px, RANGE(0, 12, 0, 6), 3, "px",
		"which step it is, is told by means of what is so far around; detail stays"),
	WHERE(quantise_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter dog_parameters[] = {
	NUMBER(dog_step, sigma_px, RANGE(0.4, 12, 0.5, 4), 1.2, "px",
		"standard deviation of the finer Gaussian: how broad lines are"),
	NUMBER(dog_step, ratio, RANGE(1.1, 4, 1.2, 2.5), 1.6, "",
		"of the coarser Gaussian to the finer one"),
	NUMBER(dog_step, sharpness, RANGE(0, 200, 0, 60), 0, "",
		"0: the difference alone, which lines are; more: dark parts are filled too"),
	NUMBER(dog_step, threshold, RANGE(-1, 1, -0.1, 0.9), -0.01, "",
		"lines are where the difference is below; with sharpness, what is darker is "
		"filled"),
	NUMBER(dog_step, contrast, RANGE(0.1, 1000, 1, 200), 9, "", "how suddenly they are"),
	NUMBER(dog_step, flow_px, RANGE(0, 24, 0, 12), 0, "px",
		"how far lines are joined along the flow of the picture; 0: not at all"),
	NUMBER(dog_step, opacity, PART, 1, "", "of lines"),
	COLOUR(dog_step, colour, 0x101010, "of lines"),
	YES_NO(dog_step, alone, 0, "lines on bare paper, instead of on the picture"),
	WHERE(dog_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter edges_parameters[] = {
	NUMBER(edges_step, width_px, RANGE(0.5, 24, 1, 8), 2, "px", "of lines"),
	NUMBER(edges_step, depth, RANGE(0, 1, 0, 0.2), 0.04, "",
		"part of the depth that it changes by; 0: depth makes none"),
	NUMBER(edges_step, bend_deg, RANGE(0, 180, 0, 90), 40, "degrees",
		"angle that surface is bent by; 0: bends make none"),
	YES_NO(edges_step, segments, 1, "where segments meet"),
	NUMBER(edges_step, wobble_px, RANGE(0, 12, 0, 6), 0, "px", "how unsteady the hand is"),
	NUMBER(edges_step, opacity, PART, 0.55, "", "of lines"),
	COLOUR(edges_step, colour, 0x101010, "of lines"),
	WHERE(edges_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter watercolour_parameters[] = {
	NUMBER(watercolour_step, wobble_px, RANGE(0, 24, 0, 8), 2.5, "px",
		"how unsteady borders of colours are"),
	NUMBER(watercolour_step, darkening, RANGE(0, 4, 0, 2), 1, "",
		"of edges, where pigment gathers"),
	NUMBER(watercolour_step, turbulence, RANGE(0, 2, 0, 1), 0.5, "",
		"how much washes differ in density"),
	NUMBER(watercolour_step, turbulence_px, RANGE(8, 1000, 40, 400), 160, "px",
		"how far apart they do"),
	NUMBER(watercolour_step, dispersion, RANGE(0, 2, 0, 1), 0.4, "", "how grainy pigment is"),
	NUMBER(watercolour_step, grain, RANGE(0, 2, 0, 1), 0.5, "",
		"how much pigment gathers in the hollows of the paper"),
	{ NULL },
};

const struct step_parameter flow_parameters[] = {
	NUMBER(flow_step, length_px, RANGE(1, 60, 2, 30), 12, "px",
		"how far colours are drawn out along what the picture shows"),
	NUMBER(flow_step, across_px, RANGE(0, 12, 0, 4), 1, "px", "and across it"),
	NUMBER(flow_step, tensor_px, RANGE(0.5, 40, 1, 16), 8, "px",
		"around a pixel, in which it is asked what runs where"),
	WHERE(flow_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter oil_parameters[] = {
	NUMBER(oil_step, length_px, RANGE(2, 80, 6, 40), 26, "px", "of bristles' traces"),
	NUMBER(oil_step, width_px, RANGE(1, 12, 1, 6), 4, "px", "of bristles"),
	NUMBER(oil_step, tensor_px, RANGE(0.5, 40, 2, 20), 12, "px",
		"around a pixel, in which it is asked what runs where"),
	NUMBER(oil_step, relief, RANGE(0, 4, 0, 2), 0.3, "", "how thick paint lies"),
	NUMBER(oil_step, shine, RANGE(0, 2, 0, 1), 0.1, "", "how wet it looks"),
	NUMBER(oil_step, variation, PART, 0.06, "", "how much the traces differ in lightness"),
	NUMBER(oil_step, canvas, PART, 0.25, "", "how much the paper's relief shows in it"),
	{ NULL },
};

const struct step_parameter pencil_parameters[] = {
	NUMBER(pencil_step, spacing_px, RANGE(2, 60, 3, 20), 4.5, "px", "from stroke to stroke"),
	NUMBER(pencil_step, width_px, RANGE(0.4, 12, 0.8, 5), 2.2, "px", "of strokes"),
	NUMBER(pencil_step, layers, RANGE(1, 6, 1, 5), 4, "",
		"one on the other where it is dark, each in another direction"),
	NUMBER(pencil_step, angle_deg, RANGE(-180, 180, -90, 90), 40, "degrees",
		"that the first lean by"),
	NUMBER(pencil_step, wobble_px, RANGE(0, 12, 0, 8), 4, "px", "how unsteady the hand is"),
	NUMBER(pencil_step, pressure, PART, 0.6, "", "how dark strokes are"),
	NUMBER(pencil_step, own_colour, PART, 0, "",
		"from one pencil to one of each colour of the picture"),
	COLOUR(pencil_step, colour, 0x2a2a2e, "of the one pencil"),
	{ NULL },
};

const struct step_parameter grade_parameters[] = {
	NUMBER(grade_step, brightness, RANGE(0, 4, 0.5, 2), 1, "", "factor on lightness"),
	NUMBER(grade_step, contrast, RANGE(0, 4, 0.5, 2), 1, "",
		"factor on what differs from grey"),
	NUMBER(grade_step, gamma, RANGE(0.2, 5, 0.5, 2), 1, "", "above 1 middle tones are lighter"),
	NUMBER(grade_step, saturation, RANGE(0, 4, 0, 2), 1, "", "0 is grey, 1 as it is"),
	NUMBER(grade_step, warmth, RANGE(-1, 1, -1, 1), 0, "", "below 0 bluer, above 0 yellower"),
	NUMBER(grade_step, hue_shift_deg, RANGE(-180, 180, -180, 180), 0, "degrees",
		"turns all hues"),
	COLOUR(grade_step, tint, 0x808080, "what colours are replaced by, as light as they are"),
	NUMBER(grade_step, tint_amount, PART, 0, "", "how much of it"),
	NUMBER(grade_step, segments, PART, 0, "",
		"how much each segment has a colour of its own, as light as it is"),
	WHERE(grade_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter warp_parameters[] = {
	NUMBER(warp_step, amplitude_px, RANGE(0, 200, 0, 60), 20, "px", "how far things sway"),
	NUMBER(warp_step, wavelength_px, RANGE(20, 4000, 100, 1200), 500, "px",
		"from crest to crest"),
	NUMBER(warp_step, angle_deg, RANGE(-180, 180, -90, 90), 0, "degrees",
		"where waves run, counterclockwise from the right"),
	NUMBER(warp_step, direction_deg, RANGE(-180, 180, -90, 90), 90, "degrees",
		"where things are moved"),
	NUMBER(warp_step, period_s, RANGE(0.1, 1000, 0.5, 10), 3, "s", "from crest to crest"),
	{ NULL },
};

const struct step_parameter occlusion_parameters[] = {
	NUMBER(occlusion_step, strength, RANGE(0, 4, 0, 2), 1, "", "how dark corners become"),
	NUMBER(occlusion_step, radius_m, RANGE(0.01, 100, 0.1, 3), 0.6, "m",
		"how far away things darken each other"),
	{ NULL },
};

const struct step_parameter neural_parameters[] = {
	{ .name = "model",
		.type = PARAMETER_MODEL,
		.offset = offsetof(struct neural_step, model),
		.fallback_name = "",
		.unit = "",
		.help = "the path of an ONNX file: a network that makes a picture of a picture" },
	NUMBER(neural_step, amount, PART, 1, "", "how much of its picture"),
	NUMBER(neural_step, side_px, RANGE(32, 4096, 128, 1024), 512, "px",
		"the longer side of what it is shown"),
	WHERE(neural_step, WHERE_ALL),
	{ NULL },
};

const struct step_parameter inpaint_parameters[] = {
	NUMBER(inpaint_step, threshold, RANGE(0, 1, 0, 0.3), 0, "",
		"a pixel whose lightness filters changed by more gets a depth from those around "
		"it; 0: as the picture asks for"),
	NUMBER(inpaint_step, radius_px, RANGE(0, 32, 0, 16), 0, "px",
		"of the circle around it; 0: as points are far apart and filters reach"),
	{ NULL },
};

const struct step_parameter composite_parameters[] = {
	CHOICE(composite_step, by, composite_names, COMPOSITE_INPAINTED,
		"which of the segments' pictures shows: the nearest where filters changed it too, "
		"the nearest where points are, or one on the other"),
	{ NULL },
};
