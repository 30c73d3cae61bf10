/* Links of profile lines (profile-links.h), and how far each is seen. */
struct link {
	vec4 pen;   /* x y, from its middle to its end */
	vec4 place; /* x y and depth on the line itself; half_width_px */
	vec4 look;  /* alpha where it is seen, where it is not; line and flags, as bits */
};
layout(std430, binding = 2) readonly buffer Links {
	link links[];
};
layout(location = 0) uniform uvec2 first_count; /* the first link of the dispatch, all */
layout(location = 1) uniform uint lift;
const uint FIRST = 1u, LAST = 2u, BEGINS = 4u, ENDS = 8u;

uint flags_of(uint n)
{
	return floatBitsToUint(links[n].look.w);
}
