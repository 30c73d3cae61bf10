/* Stippling (stipple.h): what its programs share. A spot is a point on a plane: its texel, its key, and what was asked of them. */
layout(std430, binding = 2) readonly buffer Parts {
	uvec4 parts[]; /* of each chunk: the slot of its first point, how many take part, whether the light sees it, texels to a metre there */
};
layout(std430, binding = 3) buffer Spots {
	uint spots[];
};
layout(location = 3) uniform vec4 plane; /* scale, middle x and y, near_m */
layout(location = 4) uniform ivec4 grid; /* columns, rows, pitch, 1: parallel */
layout(location = 5) uniform ivec4 keys; /* low, shift, step, rings */

layout(location = 10) uniform uint all_spots; /* words of each of the three are together: nearly all passes ask for some of them */

#define PLACE 0u
#define KEY all_spots
#define ANSWER (2u * all_spots)
const uint OUTSIDE = 0xffffffffu, UNSEEN = 255u;
/* Instead of a count, once it is decided. */
const uint NOT_DRAWN = 0u, WHOLE = 1u, LEFT_OUT = 2u;
const int TIE_BITS = 12, DEPTH_MOST = 131071, BORDER = 8;
const float EDGE = 2.0;

/* Of the i-th point of a view's chunk; false: it takes no part. */
bool spot_of(uint n, uint i, out uint at)
{
	uvec4 part = parts[views[n].pipeline.y];
	at = part.x + i;
	return i < part.y;
}

/* Groups are so many for a view: each goes on until its points are through. */
#define ALL_POINTS(n, i) uint i = gl_WorkGroupID.x * 256u + gl_LocalInvocationIndex; i < parts[views[n].pipeline.y].y; i += gl_NumWorkGroups.x * 256u

/* Formula (2). */
uint tree_place(uint levels, uint level, uvec2 texel)
{
	uint begin = (2u << levels) - (2u << level), up = levels - level;
	return (texel.y >> up << (levels + 1u)) + begin + (texel.x >> up);
}

uvec2 texel_of(uint place, uint pitch)
{
	return uvec2(place % pitch, place / pitch) - uint(BORDER);
}
