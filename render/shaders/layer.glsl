/* What one layer draws (frame_layer), lengths in the picture's pixels. */
layout(std140, binding = 1) uniform Layer {
	vec4 wanted_per_px[64], dithering_per_m2[64]; /* by lightness, four in one */
	vec4 shape;       /* length_px, width_px, spacing_px, length_variation */
	vec4 look;        /* grow, scatter, saturation, tooth */
	vec4 opacity;     /* opacity, opacity_variation, degree, fade_m */
	vec4 wanted_most; /* of each kind, where rays are as long as the depth */
	vec4 ink_linear;
	vec4 own_way;    /* cosine and sine of its own angle, on the screen; dithering points to a square metre of black, where they are without others, else 0; reach_m */
	vec4 turns[128]; /* cosine and sine of 256 turns within its variation */
	vec4 texels;  /* of the texture: length, width, variants; how the layer is lit: enum frame_lit */
	uvec4 which;  /* bits of kinds, from 8 on of those together; dithering with tone; bits of kinds along lines; in points' colours */
	/* Of hatching (frame-hatch.h). */
	vec4 hatch_way;   /* the uniform direction in the site; 0: it is no hatching, 2: with curvatures */
	vec4 hatch_tone;  /* own_tone, tone_levels, darkest, 1 / (lightest - darkest) */
	vec4 hatch_light; /* shine, shine_exponent, near_m, 1 / metres from near to far */
	vec4 hatch_shape; /* cross, pressure, curvature, abstraction */
	vec4 hatch_line;  /* cosine and sine of the angle in the plane, mix, sixths of the circle that hues are turned */
	vec4 hatch_own;   /* times that points' colours are exposed */
	vec4 pencils[48]; /* red, green, blue, hue */
	uvec4 hatch_which; /* rows of the X-Toon; enum hatching_follows; enum hatching_colouring; how many pencils */
	vec4 contour;       /* of contours 1, band_px, outlines, suggestive */
	vec4 contour_least; /* slant_least, bent_least_per_m, steps; 1: with curvatures */
	vec4 cut;           /* of cuts 1, thick_m or 0: by the points' spacing */
	/* Of paint (frame-paint.h). */
	vec4 paint_size;  /* 1: it is some; fine, detail, follow */
	vec4 paint_look;  /* even, contrast, warmth, sixths of the circle that hues differ by */
	vec4 paint_lay;   /* octaves of a place, of paint; how far behind it reaches, factor and metres */
	vec4 paint_thick; /* half its thickness in pixels, shine, light_variation; 1: lies on the screen */
	vec4 paint_hole;  /* hole_px, broad, times that colours are exposed, gap_px */
	vec4 paint_part[64]; /* by detail, four in one */
	uvec4 paint_of;      /* the pipeline */
	uvec4 colour; /* the ink's bytes; how it blends: enum band_blend; how many strokes a point gives; 1: of what the focus is on */
};
/* enum band_blend */
const uint INKED = 0u, STRONGEST = 1u, COVERING = 2u, COLOURED = 3u, PAINTED = 4u, LAID = 5u;
