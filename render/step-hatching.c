/* The parameters of hatching and of contours. */
#include "render/step-private.h"

#define HATCHING_CHOICE(field, names, start, text)                                                 \
	{                                                                                          \
		.name = #field, .type = PARAMETER_CHOICE,                                          \
		.offset = offsetof(struct hatching_step, field), .fallback = (start),              \
		.choices = (names), .unit = "", .help = (text)                                     \
	}
#define TEXT(field, kind, start, text)                                                             \
	{                                                                                          \
		.name = #field, .type = (kind), .offset = offsetof(struct hatching_step, field),   \
		.fallback_name = (start), .unit = "", .help = (text)                               \
	}

static const char *const follow_names[] = { [FOLLOWS_UNIFORM] = "uniform",
	[FOLLOWS_CURVATURE] = "curvature",
	[FOLLOWS_SCREEN] = "screen",
	NULL };
static const char *const colouring_names[] = { [COLOURING_INK] = "ink",
	[COLOURING_XTOON] = "xtoon",
	[COLOURING_POINT] = "point",
	[COLOURING_BLEND] = "blend",
	NULL };
static const char *const tone_by_names[] = {
	[TONE_CHANCE] = "chance", [TONE_TRUE] = "darkness", NULL
};

const struct step_parameter hatching_parameters[] = {
	WHICH(INK_ALL),
	TEXT(xtoon, PARAMETER_XTOON,
		"[{\"brightness\":0.1,\"chance\":1},{\"brightness\":0.9,\"chance\":0}]",
		"what chance strokes have to be drawn, and in what colour, by how light a point is "
		"and how far away: a list of stops, or the path of a PNG"),
	HATCHING_CHOICE(tone_by, tone_by_names, TONE_CHANCE,
		"whether the X-Toon tells what part of the strokes is drawn, or how dark they make "
		"it"),
	NUMBER(hatching_step, density, PART, 1, "", "part of all strokes that may be drawn"),
	SPACING(3.2),
	LENGTH(16),
	WIDTH(1.6, 10),
	LENGTH_VARIATION(0.3),
	NUMBER(hatching_step, cross, PART, 0, "",
		"chance of a second stroke across the first, where all are drawn; where fewer are, "
		"it is less"),
	HATCHING_CHOICE(follows, follow_names, FOLLOWS_UNIFORM,
		"whether strokes lie along one direction of the site, as surfaces are bent, or "
		"along "
		"one direction of the picture"),
	NUMBER(hatching_step, line_azimuth_deg, RANGE(-360, 360, 0, 360), 35, "degrees",
		"of the uniform direction: clockwise from the site's y axis"),
	NUMBER(hatching_step, line_elevation_deg, RANGE(-90, 90, -90, 90), 50, "degrees",
		"of the uniform direction: above the ground"),
	NUMBER(hatching_step, line_angle_deg, RANGE(-180, 180, -90, 90), 0, "degrees",
		"how far strokes are turned on their surfaces, or from the picture's right"),
	ANGLE_VARIATION(4),
	NUMBER(hatching_step, curvature, RANGE(0, 10, 0, 2), 0.5, "",
		"how much shorter strokes are where a surface is bent along them"),
	NUMBER(hatching_step, own_tone, PART, 0.4, "",
		"how much of their own lightness points keep; 0: all is as white as plaster"),
	NUMBER(ink_step, tone_levels, PART, 0.8, "",
		"how much their own lightness is stretched to all that the site has"),
	NUMBER(hatching_step, shine, RANGE(0, 4, 0, 1), 0, "",
		"how bright the light's reflection is"),
	NUMBER(hatching_step, shine_exponent, RANGE(1, 1000, 2, 100), 20, "",
		"the larger the smaller the light's reflection"),
	NUMBER(hatching_step, near_m, RANGE(0, 100000, 0, 100), 0, "m",
		"depth up to which the near end of the X-Toon counts"),
	NUMBER(hatching_step, far_m, RANGE(0, 100000, 0, 500), 0, "m",
		"depth from which on its far end counts; 0: as far as the site is large"),
	NUMBER(hatching_step, abstraction, RANGE(0, 20, 0, 4), 0, "",
		"so much larger and fewer strokes become from near to far: 1 is twice as large"),
	HATCHING_CHOICE(colouring, colouring_names, COLOURING_INK,
		"that of ink, of the X-Toon, each point's own, or these two blended"),
	EXPOSURE(hatching_step),
	NUMBER(hatching_step, mix, PART, 0.5, "",
		"blended: 0 is the point's colour, 1 that of the X-Toon"),
	NUMBER(hatching_step, hue_shift_deg, RANGE(-360, 360, -180, 180), 0, "degrees",
		"how far all hues are turned"),
	TEXT(pencils, PARAMETER_PENCILS, "[]",
		"the colours that there are to draw with; of two neighbours chance takes one"),
	BLEND,
	INK_COLOUR(0x2b2b2b),
	SATURATION,
	TEXTURE("pencil"),
	OPACITY(0.8),
	OPACITY_VARIATION(0.3),
	NUMBER(hatching_step, pressure, PART, 0.5, "",
		"how much fainter strokes are where few are drawn"),
	GROW,
	COPIES,
	SCATTER,
	REACH_OVER,
	DEGREE(0),
	SURROUNDINGS(0.3),
	{ NULL },
};

const struct step_parameter contours_parameters[] = {
	NUMBER(contours_step, outlines, PART, 1, "",
		"how strong lines are where surface turns away"),
	NUMBER(contours_step, steps, PART, 0.8, "",
		"how strong lines are where what is beside lies far behind"),
	NUMBER(contours_step, suggestive, PART, 0.8, "",
		"how strong lines are where it would turn away, seen from a little beside"),
	NUMBER(contours_step, band_px, RANGE(0.5, 40, 1, 10), 4.5, "px",
		"how far from the line points still give strokes"),
	NUMBER(contours_step, slant_least, PART, 0.75, "",
		"cosine of the angle to the eye from which on nothing is suggested"),
	NUMBER(contours_step, bent_least_per_m, RANGE(0, 1000, 0, 20), 0.5, "1/m",
		"what is bent less has no such lines; more is more abstract"),
	SPACING(2.5),
	LENGTH(14),
	WIDTH(1.8, 10),
	LENGTH_VARIATION(0.3),
	ANGLE_VARIATION(4),
	BLEND,
	INK_COLOUR(0x2b2b2b),
	TEXTURE("pencil"),
	OPACITY(0.85),
	OPACITY_VARIATION(0.3),
	SURROUNDINGS(0.3),
	{ NULL },
};

const struct step_parameter cut_parameters[] = {
	NUMBER(cut_step, thick_m, RANGE(0, 10, 0, 0.2), 0, "m",
		"what lies so near the cut is cut; 0: as the points' spacing asks for"),
	LENGTH(5),
	WIDTH(2.8, 10),
	LENGTH_VARIATION(0),
	ANGLE_VARIATION(0),
	BLEND,
	INK_COLOUR(0x141414),
	TEXTURE("line"),
	OPACITY(1),
	OPACITY_VARIATION(0),
	{ NULL },
};

const struct step_parameter profile_parameters[] = {
	WIDTH(1.5, 8),
	NUMBER(profile_step, outlines, RANGE(0.2, 10, 1, 4), 1.7, "",
		"so much broader are lines where a surface ends or turns away"),
	NUMBER(profile_step, creases, PART, 0.85, "", "how strong lines are where faces meet"),
	NUMBER(profile_step, marks, PART, 0.5, "",
		"how strong lines are where colours differ on a face"),
	NUMBER(profile_step, thin, PART, 0.7, "", "how strong lines of poles and rails are"),
	NUMBER(profile_step, least_px, RANGE(0, 2000, 0, 100), 14, "px",
		"lines that are shorter in the picture are left out"),
	NUMBER(profile_step, room_px, RANGE(0, 400, 0, 30), 5, "px",
		"of lines that are nearer to each other those that count less are left out"),
	NUMBER(profile_step, sure, PART, 0.3, "", "lines that are less sure are left out"),
	NUMBER(profile_step, hidden, PART, 0, "",
		"how strong the dots are with which hidden parts are drawn; 0: they are left out"),
	NUMBER(profile_step, dash_px, RANGE(2, 200, 4, 40), 9, "px",
		"of a dot of hidden parts with the gap behind it, at least"),
	NUMBER(profile_step, taper_px, RANGE(0, 190, 0, 120), 30, "px",
		"in which the pen comes down where a line begins, and is lifted where it ends"),
	NUMBER(profile_step, pressure, PART, 0.35, "", "how much the width varies along a line"),
	NUMBER(profile_step, wobble_px, RANGE(0, 40, 0, 4), 0.7, "px", "how far the hand strays"),
	NUMBER(profile_step, wave_px, RANGE(4, 1000, 10, 200), 70, "px",
		"in about what distance the hand has come back"),
	NUMBER(profile_step, overshoot_px, RANGE(0, 200, 0, 30), 0, "px",
		"how far lines go on beyond their ends, as at corners of a draft"),
	BLEND,
	INK_COLOUR(0x1c1c1e),
	OPACITY(0.95),
	OPACITY_VARIATION(0.15),
	SURROUNDINGS(0.2),
	{ NULL },
};
