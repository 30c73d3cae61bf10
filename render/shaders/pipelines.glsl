/* What is told of each pipeline (gles-layers.h). */
layout(std140, binding = 1) uniform Pipelines {
	vec4 points[256]; /* brightness, contrast, saturation; times that they are exposed, 0 where it shows no points */
	vec4 edl[256];    /* strength, radius_px; 0 0: none; 1: what the focus is on; spacing_median_m of points */
};
