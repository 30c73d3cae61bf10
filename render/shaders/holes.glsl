#version 310 es
/* The mask as what reads it has it: of its keys, with holes filled (mask.c). A pixel between two that are nearer, one or two pixels
 * wide, belongs to them. */
layout(local_size_x = 32, local_size_y = 8) in;
layout(r32ui, binding = 0) writeonly uniform highp uimage2D filled;
layout(std430, binding = 2) readonly buffer Keys {
	uint keys[];
};

const float HOLE = 1.05;

/* Outside of the picture there is nothing. */
uint key_at(ivec2 at)
{
	bool is_in = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(size.xy)));
	return is_in ? keys[uint(at.y) * uint(size.x) + uint(at.x)] : MASK_EMPTY;
}

void main()
{
	const ivec4 pairs[8] = ivec4[8](ivec4(-1, 0, 1, 0), ivec4(0, -1, 0, 1), ivec4(-1, -1, 1, 1),
		ivec4(1, -1, -1, 1), ivec4(-2, 0, 1, 0), ivec4(-1, 0, 2, 0), ivec4(0, -2, 0, 1),
		ivec4(0, -1, 0, 2));
	ivec2 at = ivec2(gl_GlobalInvocationID.xy);
	if (any(greaterThanEqual(at, ivec2(size.xy))))
		return;
	uint own = key_at(at), between = own;
	for (int n = 0; n < 8; n++)
		between = min(between, max(key_at(at + pairs[n].xy), key_at(at + pairs[n].zw)));
	bool is_hole = uintBitsToFloat(between) * HOLE < uintBitsToFloat(own);
	imageStore(filled, at, uvec4(is_hole ? between : own));
}
