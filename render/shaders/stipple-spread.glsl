#version 310 es
/* One pass of spreading depths to the eight texels around (stipple-texture.h). */
precision highp int;
layout(local_size_x = 16, local_size_y = 16) in;
layout(std430, binding = 6) readonly buffer From {
	uint from[];
};
layout(std430, binding = 5) writeonly buffer To {
	uint to[];
};
layout(location = 4) uniform ivec4 grid; /* columns, rows, pitch */
layout(location = 5) uniform ivec4 keys; /* z: step */

void main()
{
	ivec2 at = ivec2(gl_GlobalInvocationID.xy) + 1;
	if (any(greaterThanEqual(at, grid.xy - 1)))
		return;
	int place = at.y * grid.z + at.x;
	uint least = from[place];
	for (int row = -grid.z; row <= grid.z; row += grid.z)
		for (int column = -1; column <= 1; column++)
			least = min(least, from[place + row + column]);
	to[place] = min(from[place], least + uint(keys.z));
}
