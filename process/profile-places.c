#include "process/profile-places.h"
#include <string.h>

/* Places of pieces are looked up by cubes of this edge, which is also how often along a piece they are. */
#define CELL_M      0.2
#define CUBES_FIRST 4096u

struct cube {
	uint64_t key;  /* UINT64_MAX: none */
	uint32_t last; /* of entries; UINT32_MAX: none */
};
struct entry {
	uint32_t piece, before;
};

void places_init(struct places *p)
{
	p->mask = CUBES_FIRST - 1;
	p->cubes = 0;
	p->cube = g_new(struct cube, (size_t)p->mask + 1);
	memset(p->cube, 0xff, ((size_t)p->mask + 1) * sizeof *p->cube);
	p->entries = g_array_new(FALSE, FALSE, sizeof(struct entry));
}

void places_clear(struct places *p)
{
	g_free(p->cube);
	g_array_unref(p->entries);
}

static uint64_t key_of(const double at[3], int dx, int dy, int dz)
{
	int64_t x = (int64_t)floor(at[0] / CELL_M) + dx, y = (int64_t)floor(at[1] / CELL_M) + dy,
		z = (int64_t)floor(at[2] / CELL_M) + dz;
	return ((uint64_t)x & 0x1fffff) << 42 | ((uint64_t)y & 0x1fffff) << 21 |
	       ((uint64_t)z & 0x1fffff);
}

static struct cube *cube_of(const struct places *p, uint64_t key)
{
	uint32_t slot = (uint32_t)(key * 0x9E3779B97F4A7C15u >> 32) & p->mask;
	while (p->cube[slot].key != key && p->cube[slot].key != UINT64_MAX)
		slot = (slot + 1) & p->mask;
	return &p->cube[slot];
}

static void widen(struct places *p)
{
	struct cube *was = p->cube;
	uint32_t mask = p->mask;
	p->mask = 2 * mask + 1;
	p->cube = g_new(struct cube, (size_t)p->mask + 1);
	memset(p->cube, 0xff, ((size_t)p->mask + 1) * sizeof *p->cube);
	for (uint32_t n = 0; n <= mask; n++)
		if (was[n].key != UINT64_MAX)
			*cube_of(p, was[n].key) = was[n];
	g_free(was);
}

void places_add_at(struct places *p, const double at[3], uint32_t piece)
{
	struct cube *in = cube_of(p, key_of(at, 0, 0, 0));
	if (in->key == UINT64_MAX) {
		*in = (struct cube){ key_of(at, 0, 0, 0), UINT32_MAX };
		if (++p->cubes > p->mask / 2) {
			widen(p);
			in = cube_of(p, key_of(at, 0, 0, 0));
		}
	}
	if (in->last != UINT32_MAX &&
		g_array_index(p->entries, struct entry, in->last).piece == piece)
		return;
	struct entry entry = { piece, in->last };
	in->last = p->entries->len;
	g_array_append_val(p->entries, entry);
}

uint32_t places_steps(double from_m, double to_m)
{
	return (uint32_t)ceil((to_m - from_m) / CELL_M);
}

void places_add(struct places *p, const struct profile_piece *piece, double from_m, double to_m,
	uint32_t number)
{
	uint32_t steps = places_steps(from_m, to_m);
	for (uint32_t s = 0; s <= steps && to_m > from_m; s++) {
		double at[3];
		straight_place(&piece->line, from_m + (to_m - from_m) * s / MAX(steps, 1), at);
		places_add_at(p, at, number);
	}
}

struct places_found places_found_new(uint32_t numbers)
{
	uint32_t words = numbers / 64 + 1;
	return (struct places_found){ g_new0(uint64_t, words), words };
}

GArray *places_found_take(struct places_found *f)
{
	GArray *ret = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	for (uint32_t n = 0; n < f->words; n++)
		for (uint64_t left = f->is_in[n]; left; left &= left - 1) {
			uint32_t number = 64 * n + (uint32_t)__builtin_ctzll(left);
			g_array_append_val(ret, number);
		}
	g_free(f->is_in);
	return ret;
}

void places_find(const struct places *p, const double at[3], struct places_found *ret)
{
	for (int n = 0; n < 27; n++) {
		const struct cube *in = cube_of(p, key_of(at, n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
		for (uint32_t e = in->key == UINT64_MAX ? UINT32_MAX : in->last; e != UINT32_MAX;
			e = g_array_index(p->entries, struct entry, e).before) {
			uint32_t piece = g_array_index(p->entries, struct entry, e).piece;
			ret->is_in[piece / 64] |= 1ull << piece % 64;
		}
	}
}

GArray *places_near(
	const struct places *p, uint32_t numbers, const struct profile_piece *piece, double reach_m)
{
	struct places_found near = places_found_new(numbers);
	double from = piece->from_m - reach_m, to = piece->to_m + reach_m;
	uint32_t steps = places_steps(from, to);
	for (uint32_t s = 0; s <= steps; s++) {
		double at[3];
		straight_place(&piece->line, from + (to - from) * s / MAX(steps, 1), at);
		places_find(p, at, &near);
	}
	return places_found_take(&near);
}
