#version 310 es
/* Which views the mask hides, by their boxes (mask_hides() of mask.h): no disc of them is drawn again, no point is asked for strokes. A
 * thread: a view. */
layout(local_size_x = 64) in;
layout(std430, binding = 2) readonly buffer Deepest {
	uint deepest[];
};
layout(std430, binding = 3) writeonly buffer Words {
	uint words[]; /* of the views themselves */
};
layout(location = 1) uniform uint count;

/* HIDDEN_BEHIND of stroke.c; discs are held against keys, which are deeper by the bits of a pipeline. */
const float STROKES_BEHIND = 1.03, DISCS_BEHIND = 1.0001;
const int TILE = 16;

void main()
{
	uint n = gl_GlobalInvocationID.x;
	if (n >= count)
		return;
	vec4 box = views[n].box;
	if (any(lessThan(box.zw, vec2(0.0))) || any(greaterThanEqual(box.xy, size.xy)))
		return;
	ivec2 low = ivec2(max(box.xy, vec2(0.0))) / TILE, high = ivec2(min(box.zw, size.xy - 1.0)) / TILE;
	int across = (int(size.x) + TILE - 1) / TILE;
	float nearest_m = views[n].axis[0].w, most_m = 0.0;
	for (int y = low.y; y <= high.y && most_m * DISCS_BEHIND < nearest_m; y++)
		for (int x = low.x; x <= high.x; x++)
			most_m = max(most_m, mask_depth(deepest[y * across + x]));
	uint at = n * VIEW_WORDS + VIEW_DISCS, discs = views[n].at.w;
	if (most_m * STROKES_BEHIND < nearest_m)
		words[at] = (discs & PLANES_STAND) | NO_STROKES;
	else if (most_m * DISCS_BEHIND < nearest_m)
		words[at] = discs & PLANES_STAND;
}
