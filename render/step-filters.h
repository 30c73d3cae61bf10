#ifndef RENDER_STEP_FILTERS_H
#define RENDER_STEP_FILTERS_H
/* Parameters of the steps that work on pictures (filter.h). Each is one effect with its source; what papers call one filter, a
 * cartoon or oil paint, a style makes of several of them. */
#include <stdint.h>

/* Where a filter acts when the style has a focus (Redmond & Dingliana 2007, section 4): all over, the more the farther away from it,
 * or the more the nearer to it. Without a focus: all over. */
enum filter_where { WHERE_ALL, WHERE_AWAY, WHERE_NEAR };

/* Kuwahara's filter (1976; Redmond & Dingliana 2007, section 3.1): of four squares that meet in the pixel, the mean of that with the least
 * variance. Squares have radius + 1 pixels a side. Softness: instead of that the mean of all four, weighted by the inverse fourth power of
 * their variances, so that two that are as even do not take turns from frame to frame (Papari, Petkov & Campisi 2007). */
#define KUWAHARA_EVEN 2.f /* levels^2 of variance that are as good as none */
struct kuwahara_step {
	float radius_px, softness, passes;
	int32_t where;
};

/* The same with sectors of an ellipse along what the picture shows (Kyprianidis, Kang & Doellner 2009, "Image and Video Abstraction by
 * Anisotropic Kuwahara Filtering"; polynomial weights of Kyprianidis et al. 2010). */
struct anisotropic_step {
	float radius_px, sharpness, stretch, tensor_px, passes;
	int32_t where;
};

/* Bilateral filter in CIELab, along rows, then columns (Winnemoeller et al. 2006, section 3.1). */
struct bilateral_step {
	float sigma_px, sigma_tone, passes;
	int32_t where;
};

struct gaussian_step {
	float sigma_px;
	int32_t where;
};

/* What is empty between pixels that are not becomes their mean, depth and all. */
struct gaps_step {
	float radius_px;
};

/* Steps of lightness (soft: Winnemoeller et al. 2006, section 3.3), or of each colour (posterisation). Which step it is, is told by what is
 * smoothed; finer detail stays as it is, for steps make more of noise: smooth_px 0 has none of that. */
enum quantise_by { QUANTISE_LIGHTNESS, QUANTISE_CHANNELS };
struct quantise_step {
	int32_t by;
	float levels, softness, smooth_px;
	int32_t where;
};

/* Difference of Gaussians (Redmond & Dingliana 2007, section 3.2): dark where lightness is less than around it. Along the flow: Kang et al.
 * 2007, "Coherent Line Drawing"; sharpness and threshold: Winnemoeller et al. 2012, "XDoG". */
struct dog_step {
	float sigma_px, ratio, sharpness, threshold, contrast, flow_px;
	float opacity;
	uint8_t colour[4];
	int32_t alone; /* on bare paper */
	int32_t where;
};

/* Lines where depth, slant or segment change from pixel to pixel (Saito & Takahashi 1990). */
struct edges_step {
	float width_px, depth, bend_deg;
	int32_t segments;
	float wobble_px, opacity;
	uint8_t colour[4];
	int32_t where;
};

/* Watercolour (Bousseau et al. 2006): density of pigment that varies by paper, turbulence and dispersion, darker edges, wobbling. */
struct watercolour_step {
	float wobble_px, darkening, turbulence, turbulence_px, dispersion, grain;
};

/* Smooths along what the picture shows, a little across (Semmo et al. 2016, section 3.2). */
struct flow_step {
	float length_px, across_px, tensor_px;
	int32_t where;
};

/* Oil (Semmo et al. 2016, section 3.4): bristles along the flow, as a relief that light falls on. */
struct oil_step {
	float length_px, width_px, tensor_px, relief, shine, variation, canvas;
};

/* Strokes of a pencil along surfaces, the more layers of them the darker it is. */
struct pencil_step {
	float spacing_px, width_px, layers, angle_deg, wobble_px, pressure, own_colour;
	uint8_t colour[4];
};

struct grade_step {
	float brightness, contrast, gamma, saturation, warmth, hue_shift_deg;
	uint8_t tint[4];
	float tint_amount, segments;
	int32_t where;
};

/* Everything sways with time (Wegen et al. 2024, section 5.1, "Animations via Warp Filtering"). */
struct warp_step {
	float amplitude_px, wavelength_px, angle_deg, direction_deg, period_s;
};

/* Darkens what lies between things that stand before it. */
struct occlusion_step {
	float strength, radius_m;
};

/* A network of the user's that makes one picture of another (ONNX). */
struct neural_step {
	const char *model; /* interned */
	float amount, side_px;
	int32_t where;
};

/* Depth inpainting (Wegen et al. 2024, section 3.1, listing 1). */
struct inpaint_step {
	float threshold; /* 0: by itself */
	float radius_px; /* 0: by itself */
};

/* How the pictures of pipelines become one (Wegen et al. 2024, section 5.2, figure 12). */
enum composite_by { COMPOSITE_INPAINTED, COMPOSITE_DEPTH, COMPOSITE_LAYERS };
struct composite_step {
	int32_t by;
};

#endif
