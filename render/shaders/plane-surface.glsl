#version 310 es
/* Plane surfaces as surface for filters (sheet-surface.glsl). */
layout(local_size_x = 64) in;
layout(std430, binding = 2) buffer Sums {
	int sums[]; /* three of each pixel */
};
layout(std430, binding = 3) buffer Nearest {
	int nearest[]; /* bits of metres, which are in their order */
};
layout(std430, binding = 4) buffer Leaves {
	uint leaves[];
};
layout(location = 2) uniform uint finds_leaf;

const float ONE = 65536.0;

void main()
{
	ivec4 s = spans[first_span + gl_WorkGroupID.x];
	uint n = uint(s.w);
	ivec3 add = ivec3(floor(planes[n].normal.xyz * (PLANE_WEIGHT * ONE) + 0.5));
	for (int x = s.y + int(gl_LocalInvocationIndex); x < s.z; x += 64) {
		float steep, depth_m = plane_depth(n, ray_of(x, s.x), steep);
		if (!plane_shows(n, x, s.x, depth_m))
			continue;
		int at = s.x * int(size.x) + x, bits = floatBitsToInt(depth_m);
		if (finds_leaf != 0u) {
			if (nearest[at] == bits)
				atomicMax(leaves[at], planes[n].of.y);
			continue;
		}
		atomicAdd(sums[3 * at], add.x);
		atomicAdd(sums[3 * at + 1], add.y);
		atomicAdd(sums[3 * at + 2], add.z);
		atomicMin(nearest[at], bits);
	}
}
