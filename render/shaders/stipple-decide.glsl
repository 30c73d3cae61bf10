#version 310 es
/* Which points are drawn, and which the light leaves out, as stipple.c has it. Groups: some x views. */
layout(local_size_x = 256) in;
layout(std430, binding = 4) readonly buffer Light {
	uint lit[];
};
layout(std430, binding = 5) readonly buffer Tree {
	uint tree[];
};
layout(location = 6) uniform vec4 share;   /* texels around on the eye's plane and the light's, epsilon, metres between points of spacing 1 */
layout(location = 7) uniform uvec4 tree_of; /* levels, level, the light's pitch, 1: there is a light */

float share_of(uint count, float most, float wide)
{
	return float(count) / min(max(wide * wide, 1.0), most);
}

bool is_highlight(uint n, uint i, uint own, uint from)
{
	uvec4 point = points[views[n].at.x + i];
	float apart_m = float(point.y >> 16) * share.w;
	float from_light = share_of(from, share.y, apart_m * uintBitsToFloat(parts[views[n].pipeline.y].w));
	float deep = rays.x > 0.0 ? place_of(n, point).z : 1.0;
	float from_eye = share_of(own, share.x, apart_m * plane.x / deep);
	return share.z > 0.0 && from_light - from_eye > share.z;
}

uint decided(uint n, uint i, uint at)
{
	uint own = spots[at + ANSWER];
	if (own == UNSEEN)
		return NOT_DRAWN;
	if (tree_of.w == 0u || lit[at + ANSWER] == UNSEEN)
		return WHOLE;
	uint texel = tree_place(tree_of.x, tree_of.y, texel_of(lit[at + PLACE], tree_of.z));
	return tree[texel] == lit[at + KEY] || is_highlight(n, i, own, lit[at + ANSWER]) ? LEFT_OUT : WHOLE;
}

void main()
{
	uint n = first_view + gl_WorkGroupID.y;
	for (ALL_POINTS(n, i)) {
		uint at = parts[views[n].pipeline.y].x + i;
		spots[at + ANSWER] = decided(n, i, at);
	}
}
