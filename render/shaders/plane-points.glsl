#version 310 es
/* Colours of plane surfaces, added to those of points (points.glsl). */
layout(local_size_x = 64) in;
layout(std430, binding = 2) buffer Sums {
	uint sums[]; /* r g b weight of each pixel of the strip */
};
layout(std430, binding = 3) readonly buffer Texels {
	uint texels[]; /* sRGB */
};
layout(location = 1) uniform ivec2 strip; /* rows: from, and the first one that is not */

const float ONE = 65536.0;

vec3 texel_at(uvec4 level, ivec2 at)
{
	at = clamp(at, ivec2(0), ivec2(level.yz) - 1);
	return light_of_bytes(texels[level.x + uint(at.y) * level.y + uint(at.x)]);
}

/* uv in texels of the first level. */
vec3 level_at(uint n, uint l, vec2 uv)
{
	vec2 at = uv / float(1u << l) - 0.5, low = floor(at), part = at - low;
	uvec4 level = planes[n].texture[l];
	ivec2 i = ivec2(low);
	vec3 below = mix(texel_at(level, i), texel_at(level, i + ivec2(1, 0)), part.x);
	vec3 above = mix(texel_at(level, i + ivec2(0, 1)), texel_at(level, i + ivec2(1, 1)), part.x);
	return mix(below, above, part.y);
}

vec3 light_at(uint n, vec3 place, float pixel)
{
	vec2 uv = vec2(dot(planes[n].u.xyz, place) + planes[n].u.w, dot(planes[n].v.xyz, place) + planes[n].v.w);
	float level = clamp(log2(pixel), 0.0, float(planes[n].of.z - 1u));
	uint below = uint(level);
	float part = level - float(below);
	vec3 c = level_at(n, below, uv);
	return part > 0.0 ? mix(c, level_at(n, below + 1u, uv), part) : c;
}

void main()
{
	ivec4 s = spans[first_span + gl_WorkGroupID.x];
	uint n = uint(s.w), width = uint(size.x);
	if (planes[n].of.w == 0u || s.x < strip.x || s.x >= strip.y)
		return;
	for (int x = s.y + int(gl_LocalInvocationIndex); x < s.z; x += 64) {
		vec2 ray = ray_of(x, s.x);
		float steep, depth_m = plane_depth(n, ray, steep);
		if (!plane_shows(n, x, s.x, depth_m))
			continue;
		float long_ray = sqrt(rays.x * dot(ray, ray) + 1.0);
		float pixel = scale_m(depth_m) * (1.0 / lens.x) * sqrt(long_ray * steep) * (1.0 / planes[n].rule.w);
		vec3 c = planes[n].light.x * light_at(n, vec3(ray * scale_m(depth_m), depth_m), pixel);
		uint at = (uint(s.x - strip.x) * width + uint(x)) * 4u;
		uvec4 add = uvec4(vec4(c, 1.0) * (PLANE_WEIGHT * ONE) + 0.5);
		atomicAdd(sums[at], add.x);
		atomicAdd(sums[at + 1u], add.y);
		atomicAdd(sums[at + 2u], add.z);
		atomicAdd(sums[at + 3u], add.w);
	}
}
