#version 310 es
/* Writes the dots of the points that were marked, as choose-write.glsl does strokes. */
layout(local_size_x = 256) in;
layout(std430, binding = 6) writeonly buffer Strokes {
	uint strokes[];
};
layout(location = 2) uniform uint capacity;
layout(location = 6) uniform vec4 share; /* w: metres between points of spacing 1 */
const float APART = 1.5;
const uint WORDS = 10u;
/* In front of all that the mask has: what is seen was decided here. */
const float NEAR = 1e20;

float radius_of(uint n, uint i, float depth_m)
{
	float apart_px = float(points[views[n].at.x + i].y >> 16) * share.w * lens.x / scale_m(depth_m);
	return shape.x / 2.0 * min(max(apart_px / (APART * shape.x), 1.0), look.x);
}

void write_dot(uint at, vec3 seen, float half_px, float alpha)
{
	vec2 middle = lens.yz + lens.x * seen.xy / scale_m(seen.z);
	float word[9] = float[9](middle.x, middle.y, half_px, 0.0, half_px, alpha, NEAR, 0.0, 0.0);
	for (uint k = 0u; k < 9u; k++)
		strokes[at * WORDS + k] = floatBitsToUint(word[k]);
	strokes[at * WORDS + 9u] = colour.x & 0xffffffu;
}

void main()
{
	uint lane, n = view_here(lane), word, at;
	if (!strokes_begin(n, lane, word, at))
		return;
	for (uint mark = word & 0xffffu; mark != 0u && at < capacity; mark = next_mark(mark)) {
		vec3 seen;
		uint i = point_at(n, mark, lane);
		float alpha = alpha_of(n, i, seen);
		write_dot(at++, seen, radius_of(n, i, seen.z), alpha);
	}
}
