/* Planes that filters leave to each other; what they have, each filter says. */
layout(std430, binding = 4) buffer PlaneA {
	float a[];
};
layout(std430, binding = 5) buffer PlaneB {
	float b[];
};
layout(std430, binding = 6) buffer PlaneC {
	float c[];
};
layout(std430, binding = 7) buffer PlaneD {
	float d[];
};

/* filter_between(), of a plane with so many columns and rows. */
#define BETWEEN(name, plane)                                                         \
	float name(ivec2 size_of, vec2 p)                                            \
	{                                                                            \
		p = clamp(p, vec2(0.0), vec2(size_of - 1));                          \
		ivec2 first = ivec2(p), last = min(first + 1, size_of - 1);          \
		vec2 part = p - vec2(first);                                         \
		int above = first.y * size_of.x, below = last.y * size_of.x;         \
		float upper = mix(plane[above + first.x], plane[above + last.x], part.x); \
		float lower = mix(plane[below + first.x], plane[below + last.x], part.x); \
		return mix(upper, lower, part.y);                                    \
	}
