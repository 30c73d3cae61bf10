#version 310 es
/* Marks the points of each view that are drawn, and counts them. A group: a view. */
layout(local_size_x = 256) in;
shared uint total;

void main()
{
	uint n = first_view + gl_WorkGroupID.x, row = (n - layer_view) * MARKS;
	uint thread = gl_LocalInvocationIndex, mark = 0u;
	uint count = may_give(n) ? views[n].at.z : 0u;
	if (thread == 0u)
		total = 0u;
	memoryBarrierShared();
	barrier();
	for (uint slice = 0u; slice * THREADS < count; slice++) {
		candidate c;
		if (candidate_of(n, slice * THREADS + thread, c) && choice_of(c).alpha > 0.0)
			mark |= 1u << slice;
	}
	marks[row + thread] = mark;
	if (mark != 0u)
		atomicAdd(total, uint(bitCount(mark)));
	memoryBarrierShared();
	barrier();
	if (thread == 0u)
		marks[row + THREADS] = total;
}
