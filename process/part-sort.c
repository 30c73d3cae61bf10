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

uint32_t *part_points_order(const struct part_point *point, size_t count)
{
	g_assert(count <= UINT32_MAX);
	g_autofree struct sort_key *keys = g_new(struct sort_key, count + 1);
	g_autofree struct sort_key *other = g_new(struct sort_key, count + 1);
	for (size_t i = 0; i < count; i++)
		keys[i] = (struct sort_key){ point[i].code, (uint32_t)i, point[i].leaf };
	for (unsigned pass = 0; pass < 8 && count > 1; pass++)
		if (sort_by_digit(keys, other, count, pass)) {
			struct sort_key *swap = keys;
			keys = other;
			other = swap;
		}
	g_clear_pointer(&other, g_free);
	uint32_t *order = g_new(uint32_t, count + 1);
	for (size_t i = 0; i < count; i++)
		order[i] = keys[i].index;
	return order;
}

/* They lie anywhere in memory, so those that come soon are asked for. */
#define AHEAD 16

void part_points_gather(
	const struct part_point *from, const uint32_t *order, size_t count, struct part_point *to)
{
#pragma omp parallel for schedule(static)
	for (size_t i = 0; i < count; i++) {
		__builtin_prefetch(&from[order[MIN(i + AHEAD, count - 1)]]);
		to[i] = from[order[i]];
	}
}

struct part_point *part_points_sorted(const struct part_point *point, size_t count)
{
	g_autofree uint32_t *order = part_points_order(point, count);
	struct part_point *ret = g_new(struct part_point, count + 1);
	part_points_gather(point, order, count, ret);
	return ret;
}
