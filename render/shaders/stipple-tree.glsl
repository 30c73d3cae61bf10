#version 310 es
/* A level of the quadtree from the one below (stipple-quadtree.h): formula (1). */
precision highp int;
layout(local_size_x = 16, local_size_y = 16) in;
layout(std430, binding = 5) buffer Tree {
	uint tree[];
};
layout(location = 7) uniform uvec4 tree_of; /* levels, the level that is made */

void main()
{
	uvec2 at = gl_GlobalInvocationID.xy;
	uint pitch = 2u << tree_of.x, to = pitch - (2u << tree_of.y), from = pitch - (4u << tree_of.y);
	if (any(greaterThanEqual(at, uvec2(1u << tree_of.y))))
		return;
	from += 2u * at.y * pitch + 2u * at.x;
	tree[to + at.y * pitch + at.x] =
		min(min(tree[from], tree[from + 1u]), min(tree[from + pitch], tree[from + pitch + 1u]));
}
