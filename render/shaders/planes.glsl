/* Plane surfaces as spans of rows (plane-view.h): the rules of plane-lanes.c. Groups: a span each. */
struct plane_view {
	vec4 normal;  /* as the camera sees it; along */
	vec4 u, v;    /* texels of the first level at a place, and what is added */
	vec4 rule;    /* back_m, offset_m, offset_relative, texel_m */
	uvec4 of;     /* pipeline, leaf, levels, 1 where colours are shown */
	vec4 light;   /* what is left of it */
	uvec4 texture[14]; /* of each level: first texel, width, height */
};
layout(std430, binding = 0) readonly buffer Spans {
	ivec4 spans[]; /* row, from, end, view */
};
layout(std430, binding = 1) readonly buffer Planes {
	plane_view planes[];
};
layout(location = 0) uniform uint first_span;

const float PLANE_WEIGHT = 4.0;
const float PLANE_BACK_MOST = 0.1;

/* Where the ray of a pixel goes through at depth 1. */
vec2 ray_of(int x, int y)
{
	return (vec2(float(x), float(y)) + 0.5 - lens.yz) * (1.0 / lens.x);
}

/* steep: by how much more depth grows than what one goes off the plane. */
float plane_depth(uint n, vec2 ray, out float steep)
{
	vec4 normal = planes[n].normal;
	float slant = dot(normal.xy, ray), straight = rays.x * slant + normal.z;
	steep = 1.0 / abs(straight);
	return (normal.w - rays.y * slant) / straight;
}

/* Whether the mask has it there. */
bool plane_shows(uint n, int x, int y, float depth_m)
{
	uint key = texelFetch(mask_keys, ivec2(x, y), 0).r;
	return (key & 255u) == planes[n].of.x && uintBitsToFloat(key) >= depth_m;
}
