/* What one layer draws (frame_layer), lengths in the picture's pixels. */
layout(std140, binding = 1) uniform Layer {
	vec4 wanted_per_px[64], dithering_per_m2[64]; /* by lightness, four in one */
	vec4 shape;       /* length_px, width_px, spacing_px, length_variation */
	vec4 look;        /* grow, scatter, saturation, tooth */
	vec4 opacity;     /* opacity, opacity_variation, degree, fade_m */
	vec4 wanted_most; /* of each kind, where rays are as long as the depth */
	vec4 ink_linear;
	vec4 own_way;    /* cosine and sine of its own angle, on the screen */
	vec4 turns[128]; /* cosine and sine of 256 turns within its variation */
	vec4 texels;  /* of the texture: length, width, variants; how the layer is lit: enum frame_lit */
	uvec4 which;  /* bits of kinds; dithering with tone; bits of kinds along lines; in points' colours */
	uvec4 colour; /* the ink's bytes; how it blends: enum band_blend; how many strokes a point gives */
};
