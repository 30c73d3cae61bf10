#version 310 es
/* Marks the points of each view that are drawn, and counts them. A group: a view. */
layout(local_size_x = 256) in;
shared uint total;

void main()
{
	uint n = first_view + gl_WorkGroupID.x, row = (n - layer_view) * MARKS;
	uint thread = gl_LocalInvocationIndex, mark = 0u, own = 0u, count = views[n].at.z;
	if (thread == 0u)
		total = 0u;
	memoryBarrierShared();
	barrier();
	uvec4 asked_from, asked_to;
	asked_of(n, asked_from, asked_to);
	for (uint slice = 0u; slice * THREADS < count; slice++) {
		uvec4 from = uvec4(slice * THREADS);
		/* Of nearly all chunks that are far away, the first one alone. */
		if (!any(bvec4(uvec4(lessThan(from, asked_to)) & uvec4(lessThan(asked_from, from + THREADS)))))
			continue;
		uint given = strokes_at(n, slice * THREADS + thread);
		if (given != 0u)
			mark |= 1u << slice;
		own += given;
	}
	marks[row + thread] = mark | own << 16;
	if (own != 0u)
		atomicAdd(total, own);
	memoryBarrierShared();
	barrier();
	if (thread == 0u)
		marks[row + THREADS] = total;
}
