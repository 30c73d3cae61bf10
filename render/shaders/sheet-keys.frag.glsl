#version 310 es
/* Keys from a buffer into the texture that all that is drawn looks them up in. */
layout(location = 0) out uint key;
layout(std430, binding = 2) readonly buffer Keys {
	uint keys[];
};

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	key = keys[at.y * int(size.x) + at.x];
}
