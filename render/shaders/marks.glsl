/* How the strokes of a layer are chosen: first each view tells how many it gives (choose-count.glsl), then where they are written is known
 * (choose-scan.glsl), then they are (choose-write.glsl). What is far away has few points to ask, so views of FEW at most are gone through by
 * FEW threads each; they list the others, which get a group each.
 *
 * Of each view of the layer a word: how many strokes, and later how many before, one more at the end; then the list; then which views are
 * those of few; then a word of each thread: how many strokes above, below a bit for each slice in which its point gives some, or of a few
 * that point. */
layout(std430, binding = 5) buffer Marks {
	uint marks[];
};
layout(location = 1) uniform uvec2 layer_views; /* the first, how many */
layout(location = 9) uniform uvec3 pass_of;      /* 1: views of few; which view is the first behind it; its number */

const uint THREADS = 256u, FEW = 16u;

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
	lane = are_few() ? thread % FEW : thread;
	return are_few() ? first_view + (gl_WorkGroupID.x * THREADS + thread) / FEW : marks[list_at(first_view) + gl_WorkGroupID.x];
}
