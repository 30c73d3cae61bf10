#include "process/spacing.h"
#include <math.h>
#include <string.h>

/* Cells are so small that none has two points: their diagonal is the spacing. Points up to two cells away may be too near, but for
 * the corners. */
#define REACH      2
#define NEIGHBOURS 117
#define STEPS      65535.0 /* of a place in its cell */
/* Rounding to them never brings two points nearer than the spacing. */
#define MARGIN 3e-5

struct entry_place {
	uint16_t step[3];
};

struct spacing {
	double spacing_m, cell_m;
	uint64_t capacity, count; /* capacity a power of two */
	uint64_t *key;            /* 0: free */
	struct entry_place *place;
	int8_t neighbour[NEIGHBOURS][3]; /* the nearest first */
};

static uint64_t key_of(const int64_t cell[3])
{
	uint64_t h = 0x9e3779b97f4a7c15u;
	for (int i = 0; i < 3; i++) {
		h ^= (uint64_t)cell[i];
		h *= 0xbf58476d1ce4e5b9u;
		h ^= h >> 32;
		h *= 0x94d049bb133111ebu;
		h ^= h >> 29;
	}
	return h ? h : 1;
}

/* Where the key is, or would be. */
static uint64_t slot_of(const spacing *s, uint64_t key)
{
	uint64_t at = key & (s->capacity - 1);
	while (s->key[at] && s->key[at] != key)
		at = (at + 1) & (s->capacity - 1);
	return at;
}

static void make_room(spacing *s)
{
	spacing old = *s;
	s->capacity *= 2;
	s->key = g_new0(uint64_t, s->capacity);
	s->place = g_new(struct entry_place, s->capacity);
	for (uint64_t i = 0; i < old.capacity; i++) {
		if (!old.key[i])
			continue;
		uint64_t at = slot_of(s, old.key[i]);
		s->key[at] = old.key[i];
		s->place[at] = old.place[i];
	}
	g_free(old.key);
	g_free(old.place);
}

static int nearness(const int8_t *n)
{
	return n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
}

static int by_nearness(const void *a, const void *b)
{
	return nearness(a) - nearness(b);
}

spacing *spacing_new(double spacing_m)
{
	spacing *s = g_new0(spacing, 1);
	unsigned count = 0;
	s->spacing_m = spacing_m;
	s->cell_m = spacing_m / sqrt(3) * (1 - 1e-9);
	s->capacity = 1 << 12;
	s->key = g_new0(uint64_t, s->capacity);
	s->place = g_new(struct entry_place, s->capacity);
	for (int x = -REACH; x <= REACH; x++)
		for (int y = -REACH; y <= REACH; y++)
			for (int z = -REACH; z <= REACH; z++) {
				int8_t n[3] = { (int8_t)x, (int8_t)y, (int8_t)z };
				if (abs(x * y * z) != REACH * REACH * REACH)
					memcpy(s->neighbour[count++], n, sizeof n);
			}
	g_assert(count == NEIGHBOURS);
	qsort(s->neighbour, count, sizeof s->neighbour[0], by_nearness);
	return s;
}

void spacing_free(spacing *s)
{
	if (!s)
		return;
	g_free(s->key);
	g_free(s->place);
	g_free(s);
}

/* in: place in its own cell, in cells. */
static bool is_in_the_way(
	const spacing *s, const int64_t cell[3], const double in[3], const int8_t n[3])
{
	int64_t there[3] = { cell[0] + n[0], cell[1] + n[1], cell[2] + n[2] };
	uint64_t key = key_of(there), at = slot_of(s, key);
	double squares = 0, reach = s->spacing_m / s->cell_m * (1 + MARGIN);
	if (!s->key[at])
		return false;
	for (int i = 0; i < 3; i++) {
		double apart = n[i] + s->place[at].step[i] / STEPS - in[i];
		squares += apart * apart;
	}
	return squares < reach * reach;
}

bool spacing_take(spacing *s, const double at_m[3])
{
	int64_t cell[3];
	double in[3];
	for (int i = 0; i < 3; i++) {
		double cells = CLAMP(at_m[i] / s->cell_m, -9e15, 9e15);
		cell[i] = (int64_t)floor(cells);
		in[i] = cells - floor(cells);
	}
	for (int i = 0; i < NEIGHBOURS; i++)
		if (is_in_the_way(s, cell, in, s->neighbour[i]))
			return false;
	if (++s->count > s->capacity / 5 * 3)
		make_room(s);
	uint64_t key = key_of(cell), at = slot_of(s, key);
	s->key[at] = key;
	for (int i = 0; i < 3; i++)
		s->place[at].step[i] = (uint16_t)(in[i] * STEPS + 0.5);
	return true;
}

uint64_t spacing_count(const spacing *s)
{
	return s->count;
}
