#version 310 es
/* The masks of all sheets in one: the least key. */
layout(local_size_x = 32, local_size_y = 8) in;
layout(std430, binding = 2) buffer Keys {
	uint keys[];
};

void main()
{
	ivec2 p = ivec2(gl_GlobalInvocationID.xy);
	if (any(greaterThanEqual(p, ivec2(size.xy))))
		return;
	int at = p.y * int(size.x) + p.x;
	keys[at] = min(keys[at], texelFetch(mask_keys, p, 0).r);
}
