#include "process/spacing.h"
#include <math.h>
#include <string.h>

/* Cells are so small that none has two points: their diagonal is the spacing. So what is too near lies at most two cells away. Cells
 * stand in blocks of 4 x 4 x 4, of which eight hold all that are so near; a block knows which of its cells have a point. */
#define SIDE  4
#define REACH 2
#define STEPS 255.0 /* of a place in its cell */
/* Rounding to them never brings two points nearer than the spacing. */
#define MARGIN 0.0021
#define CHUNK  (1u << 16)
#define NONE   UINT32_MAX

struct place {
	uint32_t next; /* in the block */
	uint8_t cell, step[3];
};

struct block {
	uint64_t key; /* 0: free */
	uint64_t cells;
	uint32_t first;
};

struct spacing {
	double spacing_m, cell_m, reach; /* reach: in cells, what is too near */
	uint64_t capacity, used;         /* blocks; capacity a power of two */
	struct block *blocks;
	GPtrArray *chunks; /* of CHUNK places */
	uint64_t count;
	uint64_t plane[3][1 << SIDE]; /* of cells of a block whose coordinate is one of a set */
};

/* ---- blocks ---- */

static uint64_t key_of(const int64_t at[3])
{
	uint64_t h = 0x9e3779b97f4a7c15u;
	for (int i = 0; i < 3; i++) {
		h ^= (uint64_t)at[i];
		h *= 0xbf58476d1ce4e5b9u;
		h ^= h >> 32;
		h *= 0x94d049bb133111ebu;
		h ^= h >> 29;
	}
	return h ? h : 1;
}

/* Where the key is, or would be. */
static struct block *block_of(const spacing *s, uint64_t key)
{
	uint64_t at = key & (s->capacity - 1);
	while (s->blocks[at].key && s->blocks[at].key != key)
		at = (at + 1) & (s->capacity - 1);
	return &s->blocks[at];
}

static void make_room(spacing *s)
{
	struct block *old = s->blocks;
	uint64_t capacity = s->capacity;
	s->capacity *= 2;
	s->blocks = g_new0(struct block, s->capacity);
	for (uint64_t i = 0; i < capacity; i++)
		if (old[i].key)
			*block_of(s, old[i].key) = old[i];
	g_free(old);
}

static struct place *place_at(const spacing *s, uint32_t i)
{
	return (struct place *)s->chunks->pdata[i / CHUNK] + i % CHUNK;
}

/* ---- the set ---- */

spacing *spacing_new(double spacing_m)
{
	spacing *s = g_new0(spacing, 1);
	s->spacing_m = spacing_m;
	s->cell_m = spacing_m / sqrt(3) * (1 - 1e-9);
	s->reach = spacing_m / s->cell_m * (1 + MARGIN);
	s->capacity = 1 << 10;
	s->blocks = g_new0(struct block, s->capacity);
	s->chunks = g_ptr_array_new_with_free_func(g_free);
	for (unsigned cell = 0; cell < SIDE * SIDE * SIDE; cell++)
		for (unsigned set = 0; set < 1 << SIDE; set++)
			for (int axis = 0; axis < 3; axis++)
				if (set >> (cell >> 2 * axis & 3) & 1)
					s->plane[axis][set] |= UINT64_C(1) << cell;
	return s;
}

void spacing_free(spacing *s)
{
	if (!s)
		return;
	g_free(s->blocks);
	g_ptr_array_unref(s->chunks);
	g_free(s);
}

/* A point: its cell, and its place in it in cells. */
struct point {
	int64_t block[3];
	int cell[3];
	double in[3];
};

static struct point locate(const spacing *s, const double at_m[3])
{
	struct point p;
	for (int i = 0; i < 3; i++) {
		double cells = CLAMP(at_m[i] / s->cell_m, -9e15, 9e15);
		int64_t cell = (int64_t)floor(cells);
		p.in[i] = cells - floor(cells);
		p.block[i] = cell >> 2;
		p.cell[i] = (int)(cell & 3);
	}
	return p;
}

static bool is_near(
	const spacing *s, const struct point *p, const struct place *other, const int off[3])
{
	double squares = 0;
	for (int i = 0; i < 3; i++) {
		int cells = SIDE * off[i] + (other->cell >> 2 * i & 3) - p->cell[i];
		double apart = cells + other->step[i] / STEPS - p->in[i];
		squares += apart * apart;
	}
	return squares < s->reach * s->reach;
}

/* Coordinates of a block's cells, a bit each, that are in reach. */
static unsigned reached(int cell, int off)
{
	unsigned set = 0;
	for (int c = 0; c < SIDE; c++)
		set |= (unsigned)(ABS(SIDE * off + c - cell) <= REACH) << c;
	return set;
}

static bool is_in_the_way(const spacing *s, const struct point *p, const int off[3])
{
	int64_t there[3] = { p->block[0] + off[0], p->block[1] + off[1], p->block[2] + off[2] };
	const struct block *b = block_of(s, key_of(there));
	uint64_t cells = b->key ? b->cells : 0;
	for (int i = 0; i < 3 && cells; i++)
		cells &= s->plane[i][reached(p->cell[i], off[i])];
	for (uint32_t at = b->first; cells; at = place_at(s, at)->next) {
		const struct place *other = place_at(s, at);
		if (!(cells >> other->cell & 1))
			continue;
		if (is_near(s, p, other, off))
			return true;
		cells &= ~(UINT64_C(1) << other->cell);
	}
	return false;
}

static void put(spacing *s, const struct point *p)
{
	struct block *b = block_of(s, key_of(p->block));
	if (!b->key) {
		if (++s->used > s->capacity / 4 * 3) {
			make_room(s);
			b = block_of(s, key_of(p->block));
		}
		*b = (struct block){ key_of(p->block), 0, NONE };
	}
	if (s->count % CHUNK == 0)
		g_ptr_array_add(s->chunks, g_new(struct place, CHUNK));
	struct place *at = place_at(s, (uint32_t)s->count);
	*at = (struct place){ .next = b->first };
	for (int i = 0; i < 3; i++) {
		at->cell |= (uint8_t)(p->cell[i] << 2 * i);
		at->step[i] = (uint8_t)(p->in[i] * STEPS + 0.5);
	}
	b->first = (uint32_t)s->count++;
	b->cells |= UINT64_C(1) << at->cell;
}

bool spacing_take(spacing *s, const double at_m[3])
{
	struct point p = locate(s, at_m);
	/* Two cells reach into the next block on one side. The own block comes first: it is the likeliest to refuse. */
	for (unsigned i = 0; i < 8; i++) {
		int off[3];
		for (int k = 0; k < 3; k++)
			off[k] = i >> k & 1 ? (p.cell[k] < REACH ? -1 : 1) : 0;
		if (is_in_the_way(s, &p, off))
			return false;
	}
	g_assert(s->count < NONE);
	put(s, &p);
	return true;
}

uint64_t spacing_count(const spacing *s)
{
	return s->count;
}
