#version 310 es
/* Puts points on a plane: the least key at each texel. Groups: some x views. */
layout(local_size_x = 256) in;
layout(std430, binding = 6) buffer Keys {
	uint texels[];
};

layout(location = 8) uniform float reach_m; /* nothing farther is seen */

uint key_of(float depth_m, uint point)
{
	int steps = clamp((floatBitsToInt(depth_m) - keys.x) >> keys.y, 0, DEPTH_MOST);
	return uint(steps) << TIE_BITS | (point * 0x9E3779B9u) >> (32 - TIE_BITS);
}

uint place_on_plane(vec3 at)
{
	vec2 there = plane.yz + at.xy * (grid.w != 0 ? plane.x : plane.x / at.z);
	if (!(at.z >= plane.w && at.z <= reach_m) || any(lessThan(there, vec2(EDGE))) ||
		any(greaterThanEqual(there, vec2(grid.xy) - EDGE)))
		return OUTSIDE;
	return uint(int(there.y) * grid.z + int(there.x));
}

void put(uint n, uint i)
{
	uint at = parts[views[n].pipeline.y].x + i;
	vec3 seen = place_of(n, points[views[n].at.x + i]);
	uint place = place_on_plane(seen), key = key_of(seen.z, views[n].at.y + i);
	spots[at + PLACE] = place;
	spots[at + KEY] = key;
	if (place != OUTSIDE && key < texels[place])
		atomicMin(texels[place], key);
}

void main()
{
	uint n = first_view + gl_WorkGroupID.y;
	for (ALL_POINTS(n, i))
		put(n, i);
}
