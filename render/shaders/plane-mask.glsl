#version 310 es
/* Plane surfaces into the visibility mask. */
layout(local_size_x = 64) in;
layout(std430, binding = 2) buffer Keys {
	uint keys[];
};

void main()
{
	ivec4 s = spans[first_span + gl_WorkGroupID.x];
	uint n = uint(s.w);
	vec4 rule = planes[n].rule;
	for (int x = s.y + int(gl_LocalInvocationIndex); x < s.z; x += 64) {
		float steep, depth_m = plane_depth(n, ray_of(x, s.x), steep);
		depth_m += min(rule.x * steep, PLANE_BACK_MOST * depth_m);
		depth_m = depth_m * (1.0 + rule.z) + rule.y;
		uint key = (floatBitsToUint(depth_m) & 0xffffff00u) | planes[n].of.x;
		atomicMin(keys[uint(s.x) * uint(size.x) + uint(x)], key);
	}
}
