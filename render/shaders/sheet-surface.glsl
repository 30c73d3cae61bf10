#version 310 es
/* Discs as surface for filters (surface-sums.glsl). Groups: slices of 256 points x views. */
layout(local_size_x = 256) in;

void main()
{
	uint n = first_view + gl_WorkGroupID.y;
	uint i = gl_WorkGroupID.x * 256u + gl_LocalInvocationIndex;
	disc d;
	if (i >= disc_end(n) || !disc_of(n, i, views[n].mask.x, 0.72, d))
		return;
	vec3 normal = turned(points[views[n].at.x + i].w);
	float steep = 1.0 / (d.radius * d.radius);
	for (int y = d.box.y; y <= d.box.w; y++)
		for (int x = d.box.x; x <= d.box.z; x++) {
			vec2 from = vec2(float(x), float(y)) + 0.5 - d.at;
			float w = 1.0 - disc_away2(d, from) * steep, depth_m = d.depth_m + dot(d.tilt, from);
			uint key = texelFetch(mask_keys, ivec2(x, y), 0).r;
			if (!(w > 0.0) || (key & 255u) != views[n].pipeline.x || uintBitsToFloat(key) < depth_m)
				continue;
			add_surface(y * int(size.x) + x, depth_m, normal * w, views[n].pipeline.z);
		}
}
