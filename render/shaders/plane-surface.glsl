#version 310 es
/* Plane surfaces as surface for filters (surface-sums.glsl). */
layout(local_size_x = 64) in;

void main()
{
	ivec4 s = spans[first_span + gl_WorkGroupID.x];
	uint n = uint(s.w);
	for (int x = s.y + int(gl_LocalInvocationIndex); x < s.z; x += 64) {
		float steep, depth_m = plane_depth(n, ray_of(x, s.x), steep);
		if (plane_shows(n, x, s.x, depth_m))
			add_surface(s.x * int(size.x) + x, depth_m, planes[n].normal.xyz * PLANE_WEIGHT, planes[n].of.y);
	}
}
