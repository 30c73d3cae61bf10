#version 310 es
/* Keys from a buffer into the texture that all that is drawn looks them up in. */
layout(local_size_x = 32, local_size_y = 8) in;
layout(r32ui, binding = 0) writeonly uniform highp uimage2D key;
layout(std430, binding = 2) readonly buffer Keys {
	uint keys[];
};

void main()
{
	ivec2 at = ivec2(gl_GlobalInvocationID.xy);
	if (all(lessThan(at, ivec2(size.xy))))
		imageStore(key, at, uvec4(keys[at.y * int(size.x) + at.x]));
}
