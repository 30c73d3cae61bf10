/* How the strokes of a layer are chosen: first each view tells how many it gives (choose-count.glsl), then where they are written is known
 * (choose-scan.glsl), then they are (choose-write.glsl). What is far away has few points to ask, so views of FEW at most are gone through by
 * LANES threads each; they list the others, which get a group each.
 *
 * Of each view of the layer a word: how many strokes, and later how many before, one more at the end; then the list; then 1 + how many points
 * those of few are asked of, 0 for others; then a row. There is a word for each thread, how many strokes above, below a bit for each slice
 * in which its point gives some; or for each of a few points, how many strokes above, below which point it is. */
layout(std430, binding = 5) buffer Marks {
	uint marks[];
};
layout(location = 1) uniform uvec2 layer_views; /* the first, how many */
layout(location = 9) uniform uvec3 pass_of;      /* 1: views of few; which view is the first behind it; its number */

const uint THREADS = 256u, LANES = 32u, FEW = 128u;

uint total_at(uint n)
{
	return n - layer_views.x;
}

uint list_at(uint n)
{
	return layer_views.y + 1u + total_at(n);
}

uint few_at(uint n)
{
	return 2u * layer_views.y + 1u + total_at(n);
}

uint row_at(uint n)
{
	return 3u * layer_views.y + 1u + total_at(n) * THREADS;
}

bool are_few()
{
	return pass_of.x != 0u;
}

/* A thread's view, which may be behind the window, and its number there. */
uint view_here(out uint lane)
{
	uint thread = gl_LocalInvocationIndex;
	lane = are_few() ? thread % LANES : thread;
	return are_few() ? first_view + (gl_WorkGroupID.x * THREADS + thread) / LANES : marks[list_at(first_view) + gl_WorkGroupID.x];
}
