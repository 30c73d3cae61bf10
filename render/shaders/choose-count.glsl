#version 310 es
/* Marks the points of each view that are drawn, and counts them (marks.glsl). */
layout(local_size_x = 256) in;
layout(std430, binding = 6) buffer Asked {
	uint asked[]; /* of each window, the command that goes through its views of more than a few */
};
shared uint total[8]; /* of each view: THREADS / LANES */

uint many_of(uvec4 from, uvec4 to)
{
	uvec4 many = to - from;
	return many.x + many.y + many.z + many.w;
}

uint entry_of(uint k, uvec4 from, uvec4 to)
{
	for (uint kind = 0u; kind < 4u; kind++) {
		uint many = to[kind] - from[kind];
		if (k < many)
			return from[kind] + k;
		k -= many;
	}
	return 0xffffffffu;
}

/* A point of that slice is asked. */
bool has_asked(uint slice, uvec4 from, uvec4 to)
{
	uvec4 begin = uvec4(slice * THREADS);
	return any(bvec4(uvec4(lessThan(begin, to)) & uvec4(lessThan(from, begin + THREADS))));
}

/* How many strokes the thread's points give; marks them. */
uint count_here(uint n, uint lane, uvec4 from, uvec4 to)
{
	uint many = are_few() ? many_of(from, to) : views[n].at.z, step = are_few() ? LANES : THREADS;
	uint mark = 0u, own = 0u;
	for (uint slice = 0u; slice * step < many; slice++) {
		uint k = slice * step + lane;
		if (are_few() ? k >= many : !has_asked(slice, from, to))
			continue;
		uint i = are_few() ? entry_of(k, from, to) : k, given = strokes_at(n, i);
		if (are_few())
			marks[row_at(n) + k] = i | given << 16;
		else if (given != 0u)
			mark |= 1u << slice;
		own += given;
	}
	if (!are_few())
		marks[row_at(n) + lane] = mark | own << 16;
	return own;
}

void main()
{
	uint lane, n = view_here(lane), thread = gl_LocalInvocationIndex;
	uvec4 from, to;
	bool goes = n < pass_of.y;
	if (goes)
		asked_of(n, from, to);
	if (goes && are_few()) {
		uint many = many_of(from, to);
		goes = many <= FEW;
		if (lane == 0u)
			marks[few_at(n)] = goes ? many + 1u : 0u;
		if (lane == 0u && !goes)
			marks[list_at(first_view) + atomicAdd(asked[3u * pass_of.z], 1u)] = n;
	}
	if (thread < THREADS / LANES)
		total[thread] = 0u;
	memoryBarrierShared();
	barrier();
	uint own = goes ? count_here(n, lane, from, to) : 0u, of = are_few() ? thread / LANES : 0u;
	if (own != 0u)
		atomicAdd(total[of], own);
	memoryBarrierShared();
	barrier();
	if (goes && lane == 0u)
		marks[total_at(n)] = total[of];
}
