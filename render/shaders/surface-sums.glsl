/* What a pixel is of (surface-pass.h): sums of normals in fixed point and the nearest depth of what shows; then the segment of what is as near. */
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

void add_surface(int at, float depth_m, vec3 normal, uint leaf)
{
	int bits = floatBitsToInt(depth_m);
	if (finds_leaf != 0u) {
		if (nearest[at] == bits)
			atomicMax(leaves[at], leaf);
		return;
	}
	ivec3 add = ivec3(floor(normal * ONE + 0.5));
	atomicAdd(sums[3 * at], add.x);
	atomicAdd(sums[3 * at + 1], add.y);
	atomicAdd(sums[3 * at + 2], add.z);
	atomicMin(nearest[at], bits);
}
