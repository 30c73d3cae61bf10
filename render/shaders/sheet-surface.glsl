#version 310 es
/* What each pixel is of (surface-pass.h): sums of normals in fixed point and the nearest depth of the discs that show; then, of those that
 * are as near, the segment. Groups: slices of 256 points x views. */
layout(local_size_x = 256) in;
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
			int at = y * int(size.x) + x, bits = floatBitsToInt(depth_m);
			if (finds_leaf != 0u) {
				if (nearest[at] == bits)
					atomicMax(leaves[at], views[n].pipeline.z);
				continue;
			}
			ivec3 add = ivec3(floor(normal * w * ONE + 0.5));
			atomicAdd(sums[3 * at], add.x);
			atomicAdd(sums[3 * at + 1], add.y);
			atomicAdd(sums[3 * at + 2], add.z);
			atomicMin(nearest[at], bits);
		}
}
