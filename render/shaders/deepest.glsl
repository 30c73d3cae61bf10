#version 310 es
/* How deep the deepest pixel of each tile of the mask is (MASK_TILE of mask.h). A group: a tile. */
layout(local_size_x = 16, local_size_y = 16) in;
layout(std430, binding = 2) writeonly buffer Deepest {
	uint deepest[]; /* keys */
};
shared uint most;

void main()
{
	ivec2 at = ivec2(gl_GlobalInvocationID.xy);
	if (gl_LocalInvocationIndex == 0u)
		most = 0u;
	memoryBarrierShared();
	barrier();
	if (all(lessThan(at, ivec2(size.xy))))
		atomicMax(most, texelFetch(mask_keys, at, 0).r);
	memoryBarrierShared();
	barrier();
	if (gl_LocalInvocationIndex == 0u)
		deepest[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = most;
}
