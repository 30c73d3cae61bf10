#version 310 es
/* The visibility mask (mask.h): the least key of all discs at each pixel. Groups: slices of 256 points x views. */
layout(local_size_x = 256) in;
layout(std430, binding = 2) buffer Keys {
	uint keys[];
};

const float DOT_RADIUS = 0.8;

void main()
{
	uint n = first_view + gl_WorkGroupID.y;
	uint i = gl_WorkGroupID.x * 256u + gl_LocalInvocationIndex;
	vec4 rule = views[n].mask;
	disc d;
	if (i >= disc_end(n) || !disc_of(n, i, rule.x, 0.72, d))
		return;
	/* By what the style says, and by the disc's own size, for it is not quite where its neighbours are. */
	float pushed_m = d.depth_m * (1.0 + rule.z) + rule.y + d.radius * scale_m(d.depth_m) * (1.0 / lens.x);
	uint pipeline = views[n].pipeline.x, width = uint(size.x);
	bool is_dot = d.radius < DOT_RADIUS;
	if (is_dot && (any(lessThan(d.at, vec2(0.0))) || any(greaterThanEqual(d.at, size.xy))))
		return;
	if (is_dot)
		d.box = ivec4(d.at, d.at);
	for (int y = d.box.y; y <= d.box.w; y++)
		for (int x = d.box.x; x <= d.box.z; x++) {
			vec2 from = vec2(float(x), float(y)) + 0.5 - d.at;
			if (!is_dot && disc_away2(d, from) > d.radius * d.radius)
				continue;
			uint key = (floatBitsToUint(pushed_m + dot(d.tilt, from)) & 0xffffff00u) | pipeline;
			uint at = uint(y) * width + uint(x);
			if (key < keys[at])
				atomicMin(keys[at], key);
		}
}
