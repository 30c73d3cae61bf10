#include "process/model-part.h"

#define DIGIT_BITS 11
#define DIGITS     (1u << DIGIT_BITS)

struct sort_key {
	uint64_t code;
	uint32_t index;
	uint16_t leaf;
};
_Static_assert(2 * sizeof(struct sort_key) == PART_SORT_BYTES, "there and back");

static uint32_t digit_of(const struct sort_key *k, unsigned pass)
{
	uint64_t value = pass < 6 ? k->code >> DIGIT_BITS * pass
				  : (uint64_t)k->leaf >> DIGIT_BITS * (pass - 6);
	return value & (DIGITS - 1);
}

/* false: all have the same digit, and nothing was moved. */
static bool sort_by_digit(
	const struct sort_key *from, struct sort_key *to, size_t count, unsigned pass)
{
	size_t start[DIGITS + 1] = { 0 };
	for (size_t i = 0; i < count; i++)
		start[digit_of(&from[i], pass) + 1]++;
	if (start[digit_of(&from[0], pass) + 1] == count)
		return false;
	for (uint32_t d = 0; d < DIGITS; d++)
		start[d + 1] += start[d];
	for (size_t i = 0; i < count; i++)
		to[start[digit_of(&from[i], pass)]++] = from[i];
	return true;
}

/* Puts the points in order by following the cycles of the permutation. */
static void permute(struct part_point *point, uint32_t *cell, struct sort_key *keys, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		struct part_point first = point[i];
		uint32_t first_cell = cell ? cell[i] : 0;
		size_t at = i;
		while (keys[at].index != i) {
			size_t next = keys[at].index;
			point[at] = point[next];
			if (cell)
				cell[at] = cell[next];
			keys[at].index = (uint32_t)at;
			at = next;
		}
		point[at] = first;
		if (cell)
			cell[at] = first_cell;
		keys[at].index = (uint32_t)at;
	}
}

void part_points_sort(struct part_point *point, uint32_t *cell, size_t count)
{
	g_assert(count <= UINT32_MAX);
	if (count < 2)
		return;
	g_autofree struct sort_key *keys = g_new(struct sort_key, count);
	g_autofree struct sort_key *other = g_new(struct sort_key, count);
	for (size_t i = 0; i < count; i++)
		keys[i] = (struct sort_key){ point[i].code, (uint32_t)i, point[i].leaf };
	for (unsigned pass = 0; pass < 8; pass++)
		if (sort_by_digit(keys, other, count, pass)) {
			struct sort_key *swap = keys;
			keys = other;
			other = swap;
		}
	permute(point, cell, keys, count);
}
