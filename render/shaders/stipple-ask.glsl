#version 310 es
/* Whether the points of stippled leaves are seen on a plane, and how many texels around are their own; what the eye sees goes into
 * the light's quadtree. Groups: some x views. */
layout(local_size_x = 256) in;
layout(std430, binding = 4) readonly buffer Light {
	uint lit[];
};
layout(std430, binding = 5) buffer Tree {
	uint tree[];
};
layout(std430, binding = 6) readonly buffer Keys {
	uint texels[];
};
layout(location = 7) uniform uvec4 tree_of; /* levels, level, the light's pitch, 1: put what is seen into it */

bool is_seen(int place, uint key)
{
	for (int row = -grid.z; row <= grid.z; row += grid.z)
		for (int column = -1; column <= 1; column++)
			if (texels[place + row + column] > key)
				return true;
	return false;
}

uint count_own(int place, uint key)
{
	uint count = 0u;
	for (int row = -keys.w; row <= keys.w; row++)
		for (int column = -keys.w; column <= keys.w; column++) {
			int ring = max(abs(row), abs(column));
			uint own = key + uint(ring * keys.z);
			count += texels[place + row * grid.z + column] == own ? 1u : 0u;
		}
	return count;
}

void ask(uint at)
{
	uint place = spots[at + PLACE], key = spots[at + KEY];
	if (place == OUTSIDE || !is_seen(int(place), key)) {
		spots[at + ANSWER] = UNSEEN;
		return;
	}
	spots[at + ANSWER] = count_own(int(place), key);
	if (tree_of.w != 0u && lit[at + PLACE] != OUTSIDE)
		atomicMin(tree[tree_place(tree_of.x, tree_of.x, texel_of(lit[at + PLACE], tree_of.z))],
			lit[at + KEY]);
}

void main()
{
	uint n = first_view + gl_WorkGroupID.y;
	if (parts[views[n].pipeline.y].z != 0u)
		for (ALL_POINTS(n, i))
			ask(parts[views[n].pipeline.y].x + i);
}
