/* What the marks say (marks.glsl), when strokes are written. */
/* A bit for each of the thread's points that give strokes; how many, in the upper half. */
uint word_of_few(uint n, uint lane)
{
	uint word = 0u, many = n < pass_of.y ? marks[few_at(n)] : 0u;
	for (uint k = lane, bit = 1u; k + 1u < many; k += LANES, bit <<= 1) {
		uint given = marks[row_at(n) + k] >> 16;
		if (given != 0u)
			word += bit | given << 16;
	}
	return word;
}

/* Where those of this thread begin, and its word. False: its group has none. All of a group call it at once. */
bool strokes_begin(uint n, uint lane, out uint word, out uint at)
{
	uint thread = gl_LocalInvocationIndex, first = thread - lane;
	at = n < pass_of.y ? marks[total_at(n)] : 0u;
	if (!are_few() && at == marks[total_at(n) + 1u])
		return false;
	word = are_few() ? word_of_few(n, lane) : marks[row_at(n) + lane];
	at += before(thread, word >> 16);
	/* Which counts from the group's first view on; its sums are still there. */
	if (first != 0u)
		at -= sums[first - 1u];
	return true;
}

/* for (uint mark = word & 0xffffu; mark != 0u; mark = next_mark(mark)): point_at(n, mark, lane) */
uint next_mark(uint mark)
{
	return mark & (mark - 1u);
}

uint point_at(uint n, uint mark, uint lane)
{
	uint slice = uint(findLSB(mark));
	return are_few() ? marks[row_at(n) + slice * LANES + lane] & 0xffffu : slice * THREADS + lane;
}
