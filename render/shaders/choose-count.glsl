#version 310 es
/* Marks the points of each view that are drawn, and counts them (marks.glsl). */
layout(local_size_x = 256) in;
layout(std430, binding = 6) buffer Asked {
	uint asked[]; /* of each window, the command that goes through its views of more than a few */
};
shared uint total[16]; /* of each view: THREADS / FEW */

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

/* Its word in the row. */
uint mark_of(uint n, uint lane, uvec4 from, uvec4 to)
{
	uint slices = are_few() ? 1u : (views[n].at.z + THREADS - 1u) / THREADS, mark = 0u, own = 0u;
	for (uint slice = 0u; slice < slices; slice++) {
		if (!are_few() && !has_asked(slice, from, to))
			continue;
		uint i = are_few() ? entry_of(lane, from, to) : slice * THREADS + lane, given = strokes_at(n, i);
		if (given != 0u)
			mark |= are_few() ? i : 1u << slice;
		own += given;
	}
	return mark | own << 16;
}

void main()
{
	uint lane, n = view_here(lane), thread = gl_LocalInvocationIndex;
	uvec4 from, to;
	bool goes = n < pass_of.y;
	if (goes)
		asked_of(n, from, to);
	if (goes && are_few()) {
		bool has_few = many_of(from, to) <= FEW;
		if (lane == 0u)
			marks[few_at(n)] = uint(has_few);
		if (lane == 0u && !has_few)
			marks[list_at(first_view) + atomicAdd(asked[3u * pass_of.z], 1u)] = n;
		goes = has_few;
	}
	if (thread < THREADS / FEW)
		total[thread] = 0u;
	memoryBarrierShared();
	barrier();
	uint of = are_few() ? thread / FEW : 0u;
	if (goes) {
		uint word = mark_of(n, lane, from, to);
		marks[row_at(n) + lane] = word;
		if (word >> 16 != 0u)
			atomicAdd(total[of], word >> 16);
	}
	memoryBarrierShared();
	barrier();
	if (goes && lane == 0u)
		marks[total_at(n)] = total[of];
}
