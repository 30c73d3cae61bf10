#version 310 es
/* Sets all words of a buffer. */
layout(local_size_x = 256) in;
layout(std430, binding = 2) writeonly buffer Words {
	uint words[];
};
layout(location = 0) uniform uint value;
layout(location = 1) uniform uint count;

void main()
{
	for (uint i = gl_GlobalInvocationID.x; i < count; i += gl_NumWorkGroups.x * 256u)
		words[i] = value;
}
