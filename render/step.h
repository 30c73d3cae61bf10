#ifndef RENDER_STEP_H
#define RENDER_STEP_H
/* The steps that drawings are made of. A pipeline is a list of them, run by stages:
 *
 *     mask -> layers (which points x which primitive x tone x direction) -> filters -> depth inpainting -> composite
 *
 * A kind of step is one row of the table step_kinds: its name, its parameters with their ranges and units, how far around a pixel
 * it looks, and what runs it on each backend. To add an effect is to add a row. Parameters are read (style.h) into a plain
 * struct of the kind, below; zero is no default: step_defaults fills in the table's.
 *
 * Lengths in px are of a picture 1200 px high and scale with the picture's height, so that a drawing looks the same at any size.
 * Angles on the screen: degrees, counterclockwise from the right. */
#include "render/step-filters.h"

#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum step_stage {
	STEP_MASK,
	STEP_LAYER,
	STEP_FILTER,
	STEP_COMPOSITE, /* how pictures become one; at most one of a kind in a pipeline */
};

enum parameter_type {
	PARAMETER_NUMBER,  /* float */
	PARAMETER_CHOICE,  /* int32_t: which of choices */
	PARAMETER_BOOLEAN, /* int32_t: 0 or 1 */
	PARAMETER_COLOUR,  /* uint8_t[4], sRGB, the last 255; in files "#rrggbb" */
	PARAMETER_TEXTURE, /* const char *, interned: a name of stroke-texture.h, or the path of a PNG */
	PARAMETER_XTOON, /* const char *, interned: stops as JSON, or the path of a PNG (xtoon.h) */
	PARAMETER_MODEL, /* const char *, interned: the path of an ONNX file; "": none */
	PARAMETER_PENCILS, /* const char *, interned: a list of colours as JSON (pencil-box.h); "[]": none */
};

struct step_parameter {
	const char *name;
	enum parameter_type type;
	size_t offset;      /* in the kind's struct */
	double least, most; /* legal */
	double slider_least,
		slider_most; /* what is offered to people first, within the legal ones; both 0: no slider */
	double fallback;            /* a number, a choice, 0xrrggbb */
	const char *fallback_name;  /* of a texture */
	const char *const *choices; /* NULL-terminated */
	const char *unit, *help;    /* unit "" for none */
};

/* The visibility mask (Xu & Chen 2004, section 6.1): every point a disc of its own projected size, pushed back along the ray, so
 * that what lies on a surface is not hidden by it. */
enum mask_backs {
	BACKS_SHOWN,
	BACKS_HIDDEN, /* surface that is seen from behind is not there (section 3: back-face culling) */
};
struct mask_step {
	float disc;            /* factor on the diameter of a point's patch */
	float offset_m;        /* at least this far back */
	float offset_relative; /* and this part of the distance */
	int32_t backs;         /* enum mask_backs */
	int32_t planes; /* walls, ground and roofs are polygons with a texture, in place of their points (scene-planes.h) */
};

/* Which points a layer draws (section 5, figure 2). */
enum ink_points {
	INK_ALL,
	INK_SURFACE, /* all but feature points */
	INK_FEATURES,
	INK_DIRECTIONAL,
	INK_NON_DIRECTIONAL,
	INK_DITHERING, /* with TONE_COLOUR: where these are too few for the tone, all others help */
};
enum ink_tone {
	TONE_EVEN,   /* as dense everywhere */
	TONE_COLOUR, /* as dense as the points are dark */
};
enum ink_direction {
	DIRECTION_EDGE,   /* along the point's line; points without one as DIRECTION_SCREEN */
	DIRECTION_SCREEN, /* angle_deg on the screen */
	DIRECTION_LINE, /* as DIRECTION_EDGE, and non-directional points along the line that suits them best */
};
enum ink_colour { COLOUR_INK, COLOUR_POINT };
enum ink_blend {
	BLEND_MULTIPLY, /* ink darkens what is below */
	BLEND_PAINT,    /* paint covers it; strokes that overlap mix */
};

/* Layers of sprites, lines and strokes (section 6.2). All primitives have constant size on the screen. */
struct ink_step {
	int32_t points, tone, direction, colour, blend;
	/* Mean distance of neighbours: one stroke in the square of it, or, of directional points, one to each such length of an edge. Of
	 * TONE_COLOUR it is the closest that strokes ever stand. */
	float spacing_px;
	float length_px, width_px; /* sprites: length is the diameter */
	float length_variation, angle_variation_deg,
		opacity_variation; /* 0..1, degrees, 0..1; by point */
	float angle_deg;
	const char *texture; /* strokes */
	uint8_t ink[4];
	float opacity;
	float saturation; /* of COLOUR_POINT: 0 grey, 1 as it is */
	float grow; /* factor: so much larger they may be where there are too few points to be as dense as wanted */
	/* So many strokes a point of surface gives where points are too few: itself, and copies that lie scattered in its patch. */
	float copies;
	float scatter; /* 0..1: how far points of surface are moved inside their patches, so that rows of beams do not show */
	float degree;  /* 0..1: how much fainter points of a low feature degree are */
	float tone_strength; /* TONE_COLOUR: how much of the paper's lightness black takes away */
	float tone_white;    /* lightness from which on nothing is drawn */
	float tone_gamma;    /* above 1: middle tones stay lighter */
	float tone_levels; /* 0..1: how much lightness is stretched to what the site has, from dark to light */
	float fade_m; /* distance in which ink fades to half; 0: does not */
	float tooth;  /* 0..1: how much the paper's grain shows in it */
	/* So much nearer than its point may be what a stroke lies over: leaves, that hang before others, hide points but not strokes. */
	float reach_m;
	int32_t over; /* not filtered, but drawn over what filters made */
};

/* What a stroke of hatching lies along, in the plane of its point. */
enum hatching_follows {
	FOLLOWS_UNIFORM, /* one direction of the site, projected into the plane */
	FOLLOWS_CURVATURE, /* the one in which the surface is bent most; where it is not bent, as above */
	FOLLOWS_SCREEN, /* one direction of the picture, and as long there on any surface: dots are round */
};
enum hatching_colouring {
	COLOURING_INK,
	COLOURING_XTOON,
	COLOURING_POINT,
	COLOURING_BLEND, /* the point's with the X-Toon's */
};
enum hatching_tone {
	TONE_CHANCE, /* alpha of the X-Toon is the part of the strokes that are drawn, as the paper has it */
	TONE_TRUE, /* it is how dark the surface becomes, 1 being as dark as ink */
};

/* Art-directed hatching (Wagner et al. 2022): every point becomes a stroke in its plane, or two that cross each other, if chance lets it.
 * What chance, and in what colour, an X-Toon texture tells by how light the point is and how far away. Of ink, points, texture and what
 * is random mean what they mean of strokes; tone, direction, colour and angle_deg are not used. */
struct hatching_step {
	struct ink_step ink; /* first, so that all inks begin alike */
	const char *xtoon;
	const char *pencils;
	int32_t follows, colouring, tone_by;
	float line_azimuth_deg, line_elevation_deg; /* of the uniform direction: as a light's */
	float line_angle_deg;                       /* turned so much in the plane */
	float density;                              /* 0..1: part of all strokes */
	float cross;                                /* 0..1: h of section 3.5 */
	float pressure;  /* 0..1: how much fainter strokes of a low chance are */
	float curvature; /* 0..: how much shorter strokes are where surface is bent along them */
	float own_tone;  /* 0..1: how much of its own lightness a point keeps */
	float exposure;  /* scene_exposure_of(), of points' colours */
	float shine, shine_exponent; /* Phong's highlight */
	float near_m,
		far_m;     /* depths 0 and 1 of the X-Toon; far_m 0: as far as the site is large */
	float abstraction; /* so much larger, and fewer, strokes are at depth 1 */
	float mix;         /* COLOURING_BLEND: 0 the point's, 1 the X-Toon's */
	float hue_shift_deg;
};

/* Lines where smooth surface turns away from the eye, and where it nearly does (DeCarlo et al. 2003, "Suggestive Contours for Conveying
 * Shape"): strokes of the points that are near, told by curvatures (Wagner et al. 2022, section 5). Edges are no matter of this: they are
 * feature points. Of ink it uses what hatching does, but for points, grow and scatter; spacing_px is along the line. */
struct contours_step {
	struct ink_step ink; /* first */
	float band_px;       /* how far from the line points still give strokes */
	float outlines;      /* 0..1: how strong they are */
	/* The same of lines where what is seen beside a point lies far behind it, smooth or not: within CONTOURS_REACH bands. */
	float steps;
	float suggestive;  /* the same of suggestive contours */
	float slant_least; /* cosine of the angle to the eye from which on no contour is suggested */
	float bent_least_per_m; /* what is bent less has no contours: the more the more abstract */
};
#define CONTOURS_REACH 2.f

/* Lines where the view cuts through things (struct camera): the cut of a plan or a section. Strokes along the cut through each surface, of
 * all points that lie in a slab behind it, moved in their planes onto the cut itself; so they run through corners, and are as sharp as
 * points and normals are. Surface that the slab lies in is not drawn, since it is cut nowhere, nor leaves. Of ink it uses what contours
 * do, but for spacing_px and fade_m. */
struct cut_step {
	struct ink_step ink; /* first */
	float thick_m;       /* of the slab; 0: as the points' spacing asks for */
};

/* Profile lines (Xu & Chen 2004, section 9): long lines along the edges of things, drawn by a hand (profile-links.h). Of ink it uses width,
 * ink, blend, opacity, opacity_variation, fade_m, tooth and over; where lines lie on each other the stronger one counts. */
struct profile_step {
	struct ink_step ink; /* first */
	float outlines;      /* so much broader are lines where surface ends or turns away */
	float creases, marks,
		thin; /* 0..1: how strong lines are where faces meet, where colours differ, of poles and rails */
	float least_px;     /* lines that are shorter on the screen are left out */
	float room_px;      /* and those that are so near one that counts more */
	float sure;         /* 0..1: and those of less confidence */
	float hidden;       /* 0..1: how strong dots are of what is hidden; 0: it is left out */
	float dash_px;      /* of these */
	float taper_px;     /* in which the pen comes down and is lifted */
	float pressure;     /* 0..1: how much the width varies along a line */
	float wobble_px;    /* how far the hand strays */
	float wave_px;      /* in about what distance it comes back */
	float overshoot_px; /* how far lines go on beyond their ends */
};

/* Whether strokes of paint lie on surfaces, and are foreshortened with them, or stand on the screen. */
enum paint_lies {
	LIES_SURFACE,
	LIES_SCREEN,
};

/* Brush strokes of many sizes (Meier 1996, "Painterly Rendering for Animation"; the layers of Hertzmann 1998, chosen by what points know
 * of themselves). A point's stroke has the size that its rank says: the first ones are broad, and those that the view asks for last
 * are fine and lie on top (paint-need.h). So coming nearer a stroke grows with the surface that it is on, until it is one of the
 * broad ones, and finer ones come over it; nothing is painted again.
 *
 * Of ink it uses what strokes do, but tone, direction, colour, ink, blend, degree and spacing_px: length_px and width_px are those of
 * the broadest strokes, and paint has the points' colours. Where strokes overlap, the one that lies higher hides the other. */
struct paint_step {
	struct ink_step ink; /* first */
	int32_t lies;
	float cover;  /* strokes at every place of what needs none but broad ones */
	float gap_px; /* so far from strokes paper between them takes their colours */
	float fine;   /* 0..1: how large the finest are, as a part of the broadest */
	float detail; /* 0..1: how far only places with details have fine ones; 0: all places have */
	float follow; /* 0..1: how far strokes turn along edges that are near, and as surface is bent */
	float even; /* 0..1: how much of their colours broad strokes take from all around that is as large as they are */
	float exposure; /* scene_exposure_of() */
	float contrast;
	float warmth; /* what is light becomes warmer, what is dark colder; below 0 the other way round */
	float hue_variation_deg, light_variation; /* by stroke */
	const char *palette;                      /* pencil-box.h */
	float thickness_px, shine;                /* of the paint, which light falls on */
	float wet;                                /* 0..1: how much strokes that overlap mix */
	float spill; /* part of the distance: so far behind their own are places that strokes still reach over */
};

/* Points as they are: the colours of all points, blended where surfaces are the same. */
struct points_step {
	float size;                             /* factor on the diameter of a point's patch */
	float least_px;                         /* diameter on the screen */
	float exposure;                         /* scene_exposure_of() */
	float brightness, contrast, saturation; /* factors: 1 is as it is */
};

/* Eye-dome lighting (Boucheny 2009): darkens what lies deeper than its neighbours on the screen. */
struct edl_step {
	float strength, radius_px;
};

/* Stippling without normals (Awano et al. 2010): points as they are, of which some are left out (stipple.h). */
struct stipple_step {
	struct ink_step ink; /* dots: length_px, grow, ink, opacity, tooth; else 0 */
	float level;         /* of the quadtree: a point of each texel is left out */
	float epsilon;       /* difference of shares; 0: there are no highlights */
	float passes; /* of the hidden-points textures; 0: as many as the points' spacing asks for */
	float behind_px;      /* so many texels deeper is what a pass writes around a point */
	float light_distance; /* from the middle of the site, in its radii; 0: far away */
	float most_points;    /* thousands; a uniform part of more points */
};

struct step_kind {
	const char *name, *title, *help;
	enum step_stage stage;
	size_t size;                             /* of its struct */
	const struct step_parameter *parameters; /* ends with a row without a name */
	/* How far around a pixel it looks or draws; points as large as they come by distance are not counted. */
	float (*radius_px)(const void *step);
	const char *
		glsl; /* what runs it on gles: shaders/GLSL.glsl; on cpu it is what draw.h or filter.h lead to; NULL: there too */
};
#define STEP_KINDS_MAX 40 /* rows that step_kinds has at most */
extern const struct step_kind step_kinds
	[]; /* "mask", "points", "sprites", "lines", "strokes", "hatching", "contours", "cut", "profile", "paint", "edl", "stipple", then filters; ends
	     * with a row without a name */
const struct step_kind *step_kind_find(const char *name); /* NULL: there is none */
/* In a table of parameters: that of a kind, or of a section (style.h). NULL: there is none. */
const struct step_parameter *step_parameter_find(
	const struct step_parameter *parameters, const char *name);
/* Sets the fallback of every parameter of the table; what else is in the struct stays. */
void step_parameters_fill(const struct step_parameter *parameters, void *into);

#define STEP_SIZE_MAX 256
struct step {
	const struct step_kind *kind;
	const char *id; /* interned; what overrides name it by */
	union {
		struct mask_step mask;
		struct ink_step ink;
		struct hatching_step hatching;
		struct contours_step contours;
		struct cut_step cut;
		struct profile_step profile;
		struct paint_step paint;
		struct points_step points;
		struct edl_step edl;
		struct stipple_step stipple;
		struct kuwahara_step kuwahara;
		struct anisotropic_step anisotropic;
		struct bilateral_step bilateral;
		struct gaussian_step gaussian;
		struct gaps_step gaps;
		struct quantise_step quantise;
		struct dog_step dog;
		struct edges_step edges;
		struct watercolour_step watercolour;
		struct flow_step flow;
		struct oil_step oil;
		struct pencil_step pencil;
		struct grade_step grade;
		struct warp_step warp;
		struct occlusion_step occlusion;
		struct neural_step neural;
		struct inpaint_step inpaint;
		struct composite_step composite;
		uint8_t bytes[STEP_SIZE_MAX]; /* unused ones are 0, so steps can be compared */
	};
};
_Static_assert(sizeof(struct hatching_step) <= STEP_SIZE_MAX, "the union's size");
_Static_assert(sizeof(struct paint_step) <= STEP_SIZE_MAX, "the union's size");
/* With the kind's name as id; parameters that the kind does not have, and padding, are 0. */
bool step_is_ink(const struct step *s); /* all but points */
bool step_is_hatching(const struct step *s);
bool step_is_contours(const struct step *s);
bool step_is_cut(const struct step *s);
bool step_is_profile(const struct step *s);
bool step_is_paint(const struct step *s);
bool step_draws_nothing(const struct step *s); /* ink, for a segment that has none of it */
bool step_is_filter(const struct step *s);     /* of pictures: not "edl", which belongs to points */
bool step_is_dots(const struct step *s);       /* sprites or stipple: round */
struct step step_defaults(const struct step_kind *kind);

#endif
