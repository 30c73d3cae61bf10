/* What the marks say (marks.glsl), when strokes are written. */
/* It is a view of this pass. */
bool goes_here(uint n)
{
	return n < pass_of.y && (!are_few() || marks[few_at(n)] != 0u);
}

/* Where those of this thread begin, and its word. False: its group has none. All of a group call it at once. */
bool strokes_begin(uint n, uint lane, out uint word, out uint at)
{
	word = 0u;
	at = 0u;
	if (!are_few()) {
		at = marks[total_at(n)];
		if (at == marks[total_at(n) + 1u])
			return false;
		word = marks[row_at(n) + lane];
		at += before(lane, word >> 16);
	} else if (goes_here(n)) {
		at = marks[total_at(n)];
		word = marks[row_at(n) + lane];
		for (uint k = 0u; k < lane; k++)
			at += marks[row_at(n) + k] >> 16;
	}
	return true;
}

/* for (uint mark = first_mark(word); mark != 0u; mark = next_mark(mark)): point_at(word, mark, lane) */
uint first_mark(uint word)
{
	return are_few() ? min(word >> 16, 1u) : word & 0xffffu;
}

uint next_mark(uint mark)
{
	return mark & (mark - 1u);
}

uint point_at(uint word, uint mark, uint lane)
{
	return are_few() ? word & 0xffffu : uint(findLSB(mark)) * THREADS + lane;
}
