/* Which voxels are linked. In their order, which is Morton's, voxels of a cube of 4 x 4 x 4 places stand one after another: its first
 * one and a bit for each place tell where any is. So a voxel looks into 27 cubes, which it shares with those beside it, instead of
 * hundreds of places of which nearly all are empty where points are sparse. */
#include "process/voxels.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CUBE_SHIFT 2
#define CUBE       (1 << CUBE_SHIFT)
#define CUBE_NONE  UINT32_MAX
_Static_assert(VOXELS_REACH <= CUBE, "no voxel reaches beyond the cubes beside its own");

struct cube {
	int32_t at[3];
	uint32_t first;     /* voxel */
	uint64_t is_filled; /* a bit for each place */
};

struct linker {
	const voxels *v;
	uint8_t *reach; /* of each voxel */
	GArray *cubes;  /* of struct cube, and one behind the last */
	uint32_t *slot, slots;
};

/* ---- cubes ---- */

/* Bit of a place in its cube. */
static inline unsigned place_bit(int x, int y, int z)
{
	static const uint8_t spread[CUBE] = { 0, 1, 8, 9 };
	return spread[x] | spread[y] << 1 | spread[z] << 2;
}

/* Bits of the places of a cube with these y and z. */
static inline uint64_t row_bits(int y, int z)
{
	return (1ull << 0 | 1ull << 1 | 1ull << 8 | 1ull << 9) << place_bit(0, y, z);
}

static const struct cube *cube_at(const struct linker *l, guint i)
{
	return &g_array_index(l->cubes, struct cube, i);
}

static bool is_at(const struct cube *c, const int32_t at[3])
{
	return c->at[0] == at[0] && c->at[1] == at[1] && c->at[2] == at[2];
}

static uint32_t find_slot(const struct linker *l, const int32_t at[3])
{
	uint32_t s = voxel_hash(at) & (l->slots - 1);
	while (l->slot[s] != CUBE_NONE && !is_at(cube_at(l, l->slot[s]), at))
		s = (s + 1) & (l->slots - 1);
	return s;
}

static void gather_cubes(struct linker *l)
{
	struct cube c = { .first = 0 };
	for (uint32_t i = 0; i < l->v->count; i++) {
		const int32_t *at = l->v->voxel[i].at;
		int32_t in[3] = { at[0] >> CUBE_SHIFT, at[1] >> CUBE_SHIFT, at[2] >> CUBE_SHIFT };
		if (i && !is_at(&c, in))
			g_array_append_val(l->cubes, c);
		if (!i || !is_at(&c, in))
			c = (struct cube){ { in[0], in[1], in[2] }, i, 0 };
		c.is_filled |= 1ull << place_bit(at[0] & 3, at[1] & 3, at[2] & 3);
	}
	if (l->v->count)
		g_array_append_val(l->cubes, c);
	for (l->slots = 2; l->slots < 2 * l->cubes->len;)
		l->slots *= 2;
	l->slot = g_new(uint32_t, l->slots);
	memset(l->slot, 0xFF, l->slots * sizeof *l->slot);
	for (guint i = 0; i < l->cubes->len; i++)
		l->slot[find_slot(l, cube_at(l, i)->at)] = i;
	c = (struct cube){ .first = l->v->count };
	g_array_append_val(l->cubes, c);
}

/* A cube and those beside it, x first; where there is none, an empty one. */
static void look_around(const struct linker *l, const struct cube *c, struct cube ret[27])
{
	for (int k = 0; k < 27; k++) {
		int32_t at[3] = { c->at[0] + k % 3 - 1, c->at[1] + k / 3 % 3 - 1,
			c->at[2] + k / 9 - 1 };
		uint32_t other = l->slot[find_slot(l, at)];
		ret[k] = other == CUBE_NONE ? (struct cube){ .first = 0 } : *cube_at(l, other);
	}
}

/* ---- links ---- */

static void find_reach(struct linker *l, double gap_points)
{
	for (uint32_t i = 0; i < l->v->count; i++) {
		double reach = ceil(l->v->voxel[i].size_m * gap_points / l->v->size_m);
		l->reach[i] = (uint8_t)fmin(fmax(reach, 1), VOXELS_REACH);
	}
}

/* Those in the row of places with these steps from a voxel that it is linked to. */
static uint32_t find_in_row(const struct linker *l, uint32_t i, const struct cube around[27], int y,
	int z, uint32_t *ret)
{
	const struct voxel *v = &l->v->voxel[i];
	int mine = l->reach[i], at_x = v->at[0] & 3, at_y = (v->at[1] & 3) + y,
	    at_z = (v->at[2] & 3) + z, beside = MAX(abs(y), abs(z));
	const struct cube *row =
		around + 9 * ((at_z >> CUBE_SHIFT) + 1) + 3 * ((at_y >> CUBE_SHIFT) + 1);
	uint32_t found = 0;
	if (!((row[0].is_filled | row[1].is_filled | row[2].is_filled) &
		    row_bits(at_y & 3, at_z & 3)))
		return 0;
	for (int x = -mine; x <= mine; x++) {
		const struct cube *c = &row[((at_x + x) >> CUBE_SHIFT) + 1];
		uint64_t bit = 1ull << place_bit((at_x + x) & 3, at_y & 3, at_z & 3);
		if (!(c->is_filled & bit))
			continue;
		uint32_t other =
			c->first + (uint32_t)__builtin_popcountll(c->is_filled & (bit - 1));
		int far = MAX(beside, abs(x));
		if (far && (far == 1 || far <= l->reach[other]))
			ret[found++] = other;
	}
	return found;
}

/* The voxels around i, both nearer than either's reach. */
static uint32_t find_links(
	const struct linker *l, uint32_t i, const struct cube around[27], uint32_t *ret)
{
	int mine = l->reach[i];
	uint32_t found = 0;
	for (int z = -mine; z <= mine; z++)
		for (int y = -mine; y <= mine; y++)
			found += find_in_row(l, i, around, y, z, ret + found);
	return found;
}

#define LINKS_MAX ((2 * VOXELS_REACH + 1) * (2 * VOXELS_REACH + 1) * (2 * VOXELS_REACH + 1))
#define CUBES     512u /* that are done at once */

/* Of the voxels of some cubes; counts those of each at first_link[i + 1]. */
static GArray *link_cubes(const struct linker *l, guint from, guint to, uint32_t *first_link)
{
	GArray *found = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	uint32_t links[LINKS_MAX];
	for (guint c = from; c < to; c++) {
		struct cube around[27];
		look_around(l, cube_at(l, c), around);
		for (uint32_t i = cube_at(l, c)->first; i < cube_at(l, c + 1)->first; i++) {
			uint32_t n = find_links(l, i, around, links);
			g_array_append_vals(found, links, n);
			first_link[i + 1] = n;
		}
	}
	return found;
}

static void link_all(const struct linker *l, voxels *v)
{
	guint cubes = l->cubes->len - 1, parts = (cubes + CUBES - 1) / CUBES;
	g_autofree GArray **found = g_new0(GArray *, parts + 1);
#pragma omp parallel for schedule(dynamic)
	for (guint k = 0; k < parts; k++)
		found[k] = link_cubes(l, k * CUBES, MIN(cubes, (k + 1) * CUBES), v->first_link);
	for (uint32_t i = 0; i < v->count; i++)
		v->first_link[i + 1] += v->first_link[i];
	v->link = g_new(uint32_t, v->first_link[v->count] + 1);
	for (guint k = 0; k < parts; k++) {
		uint32_t *to = v->link + v->first_link[cube_at(l, k * CUBES)->first];
		if (found[k]->len)
			memcpy(to, found[k]->data, found[k]->len * sizeof *to);
		g_array_unref(found[k]);
	}
}

void voxels_link(voxels *v, double gap_points)
{
	g_autoptr(GArray) cubes = g_array_new(FALSE, FALSE, sizeof(struct cube));
	g_autofree uint8_t *reach = g_new(uint8_t, v->count + 1);
	struct linker l = { v, reach, cubes, NULL, 0 };
	g_free(v->first_link);
	g_free(v->link);
	v->first_link = g_new0(uint32_t, v->count + 1);
	find_reach(&l, gap_points);
	gather_cubes(&l);
	link_all(&l, v);
	g_free(l.slot);
}
