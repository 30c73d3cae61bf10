#version 310 es
/* Coloured points (splat.h): sums of light and weights in fixed point, so that the order does not matter. Groups: slices of 256
 * points x views. */
layout(local_size_x = 256) in;
layout(std430, binding = 2) buffer Sums {
	uint sums[]; /* r g b weight of each pixel of the strip */
};
layout(std430, binding = 3) readonly buffer Looks {
	uvec2 looks[]; /* rgba, direction */
};
layout(location = 1) uniform ivec2 strip; /* rows: from, and the first one that is not */

const float ONE = 65536.0;

void main()
{
	uint n = first_view + gl_WorkGroupID.y;
	uint i = gl_WorkGroupID.x * 256u + gl_LocalInvocationIndex;
	disc d;
	if (i >= disc_end(n) || !disc_of(n, i, views[n].splat.x, views[n].splat.y, d))
		return;
	/* Those of the last ranks come and go softly. */
	float weight = min(4.0 * (1.0 - d.rank) + 1e-3, 1.0), steep = 1.0 / (d.radius * d.radius);
	uint rgba = looks[views[n].at.x + i].x;
	if (light_from.w > 0.0) {
		uvec3 lit = uvec3(vec3(uvec3(rgba, rgba >> 8, rgba >> 16) & 255u) *
				  lit_of(turned(points[views[n].at.x + i].w)));
		rgba = lit.x | lit.y << 8 | lit.z << 16;
	}
	vec3 colour = light_of_bytes(rgba);
	uint pipeline = views[n].pipeline.x, width = uint(size.x);
	for (int y = max(d.box.y, strip.x); y <= min(d.box.w, strip.y - 1); y++)
		for (int x = d.box.x; x <= d.box.z; x++) {
			vec2 from = vec2(float(x), float(y)) + 0.5 - d.at;
			float w = max(1.0 - disc_away2(d, from) * steep, 0.0) * weight;
			uint key = texelFetch(mask_keys, ivec2(x, y), 0).r;
			if (!(w > 0.0) || (key & 255u) != pipeline ||
				uintBitsToFloat(key) < d.depth_m + dot(d.tilt, from))
				continue;
			uint at = (uint(y - strip.x) * width + uint(x)) * 4u;
			uvec4 add = uvec4(vec4(colour * w, w) * ONE + 0.5);
			atomicAdd(sums[at], add.x);
			atomicAdd(sums[at + 1u], add.y);
			atomicAdd(sums[at + 2u], add.z);
			atomicAdd(sums[at + 3u], add.w);
		}
}
