#version 310 es
/* What lies under the ink: paper, then coloured points, then shading by depth. */
layout(location = 0) out vec4 canvas;
layout(std430, binding = 2) readonly buffer Sums {
	uint sums[]; /* r g b weight of each pixel of the strip */
};
layout(std140, binding = 1) uniform Pipelines {
	vec4 points[256]; /* brightness, contrast, saturation; 1 where it shows points */
	vec4 edl[256];    /* strength, radius_px; 0 0: none */
};
layout(location = 1) uniform ivec2 strip;
layout(location = 2) uniform uint has_points;

float to_srgb(float l)
{
	return l <= 0.0031308 ? l * 12.92 : 1.055 * pow(l, 1.0 / 2.4) - 0.055;
}

float of_srgb(float s)
{
	return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

vec3 shown(vec4 rule, vec3 linear)
{
	vec3 s = (vec3(to_srgb(linear.r), to_srgb(linear.g), to_srgb(linear.b)) - 0.5) * rule.y + 0.5;
	s *= rule.x;
	float grey = dot(s, vec3(0.299, 0.587, 0.114));
	s = clamp(grey + rule.z * (s - grey), 0.0, 1.0);
	return vec3(of_srgb(s.r), of_srgb(s.g), of_srgb(s.b));
}

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	uint key = texelFetch(mask_keys, at, 0).r, pipeline = key & 255u;
	vec3 c = min(paper.rgb * (1.0 + 0.5 * paper.a * relief_at(gl_FragCoord.xy)), 1.0);
	uint i = (uint(at.y - strip.x) * uint(size.x) + uint(at.x)) * 4u;
	if (has_points != 0u && sums[i + 3u] != 0u) {
		vec4 rule = points[pipeline];
		c = vec3(uvec3(sums[i], sums[i + 1u], sums[i + 2u])) / float(sums[i + 3u]);
		if (rule.w > 0.0 && rule.xyz != vec3(1.0))
			c = shown(rule, c);
	}
	if (key < MASK_EMPTY && edl[pipeline].y > 0.0)
		c *= edl_shade(at, edl[pipeline].xy);
	canvas = vec4(c, 1.0);
}
