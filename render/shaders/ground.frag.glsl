#version 310 es
/* What lies under the ink: paper, then coloured points, then shading by depth. */
layout(location = 0) out vec4 canvas;
layout(std430, binding = 2) readonly buffer Sums {
	uint sums[]; /* r g b weight of each pixel of the strip */
};
layout(location = 1) uniform ivec2 strip;
layout(location = 2) uniform uint has_points;
layout(location = 3) uniform uint is_flat; /* without grain, and nothing fades: what filters work on */

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
	vec3 s = exposed(rule.w, vec3(to_srgb(linear.r), to_srgb(linear.g), to_srgb(linear.b)));
	s = (s - 0.5) * rule.y + 0.5;
	s *= rule.x;
	float grey = dot(s, vec3(0.299, 0.587, 0.114));
	s = clamp(grey + rule.z * (s - grey), 0.0, 1.0);
	return vec3(of_srgb(s.r), of_srgb(s.g), of_srgb(s.b));
}

uvec4 sums_at(ivec2 at)
{
	uint i = (uint(at.y - strip.x) * uint(size.x) + uint(at.x)) * 4u;
	return uvec4(sums[i], sums[i + 1u], sums[i + 2u], sums[i + 3u]);
}

/* Where a hole of the mask was filled in: of the pixels around that points cover, in its band (draw.c). */
vec4 light_around(ivec2 at, float depth_m)
{
	const int BAND_ROWS = 32;
	int band = at.y / BAND_ROWS * BAND_ROWS;
	ivec2 from = max(at - 2, ivec2(0, max(band, strip.x)));
	ivec2 end = min(at + 3, ivec2(int(size.x), min(band + BAND_ROWS, strip.y)));
	vec4 sum = vec4(0.0);
	for (int y = from.y; y < end.y; y++)
		for (int x = from.x; x < end.x; x++) {
			float there_m = mask_depth(texelFetch(mask_keys, ivec2(x, y), 0).r);
			if (abs(there_m - depth_m) <= 0.05 * depth_m)
				sum += vec4(sums_at(ivec2(x, y)));
		}
	return sum;
}

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	uint key = texelFetch(mask_keys, at, 0).r, pipeline = key & 255u;
	float grain = is_flat != 0u ? 0.0 : paper.a;
	vec3 bare = min(paper.rgb * (1.0 + 0.5 * grain * relief_at(gl_FragCoord.xy)), 1.0), c = bare;
	vec4 rule = points[pipeline], sum = vec4(0.0);
	if (has_points != 0u && key < MASK_EMPTY && rule.w > 0.0) {
		sum = vec4(sums_at(at));
		if (!(sum.w > 0.0))
			sum = light_around(at, mask_depth(key));
	}
	if (sum.w > 0.0) {
		c = sum.rgb / sum.w;
		if (rule != vec4(1.0))
			c = shown(rule, c);
	}
	if (key < MASK_EMPTY && edl[pipeline].y > 0.0)
		c *= edl_shade(at, edl[pipeline].xyw);
	if (key < MASK_EMPTY && is_flat == 0u && focus.w > 0.0) {
		vec3 place = seen_place(gl_FragCoord.xy, mask_depth(key));
		c += focus.w * away_of(place, edl[pipeline].z > 0.0) * (bare - c);
	}
	canvas = vec4(c, 1.0);
}
