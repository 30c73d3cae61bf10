#include "process/scribble-floor.h"
#include <string.h>

/* Cosine of the steepest slope that one stands on. */
#define LEVEL_COSINE 0.87f
/* As scribble-edges.h has them: what still hangs together. */
#define JOINED 0.35f
/* The height of floors is kept in squares of this size, as far as that. */
#define SQUARE_M 0.4f
#define SQUARES  500
/* What lies this little above or below a floor is part of it. */
#define BESIDE_M  0.07f
#define NO_SQUARE G_MAXUINT32

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
	a = root_of(parent, a);
	b = root_of(parent, b);
	parent[MAX(a, b)] = MIN(a, b);
}

/* Of the level patch that a cell sees. */
static float area_m2(const range_grid *g, size_t i)
{
	float range = g->range_m[i], sine = fabsf(g->z_m[i]) / range,
	      level = sqrtf(g->x_m[i] * g->x_m[i] + g->y_m[i] * g->y_m[i]) / range;
	return range * range * (float)(g->column_rad * g->row_rad) * level / fmaxf(sine, 0.02f);
}

static bool is_level(const range_grid *g, const geometry *n, size_t i)
{
	return g->range_m[i] > 0 && n->normal_z[i] > LEVEL_COSINE;
}

static uint32_t *join_level(
	const range_grid *g, const geometry *normals, const struct scribble_edges *edges)
{
	size_t n = range_grid_cells(g);
	uint32_t *parent = g_new(uint32_t, n);
	for (size_t i = 0; i < n; i++)
		parent[i] = (uint32_t)i;
	for (size_t i = 0; i < n; i++) {
		if (!is_level(g, normals, i))
			continue;
		size_t right = i % g->columns + 1 < g->columns ? i + 1 : i + 1 - g->columns,
		       below = i + g->columns;
		if (edges->step_right[i] < JOINED && is_level(g, normals, right))
			join(parent, (uint32_t)i, (uint32_t)right);
		if (below < n && edges->step_down[i] < JOINED && is_level(g, normals, below))
			join(parent, (uint32_t)i, (uint32_t)below);
	}
	return parent;
}

/* Roots come before what hangs on them, so that one pass numbers all. */
static uint16_t *number_large(
	const range_grid *g, const geometry *normals, uint32_t *parent, uint32_t *ret_floors)
{
	size_t n = range_grid_cells(g);
	uint16_t *floor = g_new0(uint16_t, n);
	g_autofree float *area = g_new0(float, n);
	for (size_t i = 0; i < n; i++)
		if (is_level(g, normals, i))
			area[root_of(parent, (uint32_t)i)] += area_m2(g, i);
	*ret_floors = 0;
	for (size_t i = 0; i < n; i++) {
		uint32_t root = root_of(parent, (uint32_t)i);
		if (!(area[root] >= SCRIBBLE_FLOOR_M2))
			continue;
		if (root == i)
			*ret_floors += *ret_floors < G_MAXUINT16;
		floor[i] = root == i ? (uint16_t)*ret_floors : floor[root];
	}
	return floor;
}

struct square {
	float z_m;
	uint16_t floor; /* 0: none */
};

static uint32_t square_of(const range_grid *g, size_t i)
{
	float x = g->x_m[i] / SQUARE_M + SQUARES / 2, y = g->y_m[i] / SQUARE_M + SQUARES / 2;
	if (!(x >= 0 && x < SQUARES && y >= 0 && y < SQUARES))
		return NO_SQUARE;
	return (uint32_t)y * SQUARES + (uint32_t)x;
}

/* Each square takes the lowest of its floor's cells: floors rise towards walls by noise alone. */
static struct square *lay_squares(const range_grid *g, const uint16_t *floor)
{
	struct square *square = g_new0(struct square, SQUARES * SQUARES);
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		uint32_t at = floor[i] ? square_of(g, i) : NO_SQUARE;
		if (at == NO_SQUARE)
			continue;
		if (!square[at].floor || g->z_m[i] < square[at].z_m)
			square[at] = (struct square){ g->z_m[i], floor[i] };
	}
	return square;
}

static uint16_t floor_beside(const struct square *square, uint32_t at, float z_m)
{
	for (int dy = -1; dy <= 1; dy++)
		for (int dx = -1; dx <= 1; dx++) {
			uint32_t x = at % SQUARES + (uint32_t)dx, y = at / SQUARES + (uint32_t)dy;
			if (x >= SQUARES || y >= SQUARES)
				continue;
			const struct square *s = &square[y * SQUARES + x];
			if (s->floor && fabsf(z_m - s->z_m) < BESIDE_M)
				return s->floor;
		}
	return 0;
}

uint16_t *scribble_floors_find(const range_grid *g, const geometry *normals,
	const struct scribble_edges *edges, uint32_t *ret_floors)
{
	uint32_t floors;
	g_autofree uint32_t *parent = join_level(g, normals, edges);
	uint16_t *floor = number_large(g, normals, parent, &floors);
	g_autofree struct square *square = lay_squares(g, floor);
	for (size_t i = 0; i < range_grid_cells(g); i++) {
		uint32_t at = !floor[i] && g->range_m[i] > 0 ? square_of(g, i) : NO_SQUARE;
		if (at != NO_SQUARE)
			floor[i] = floor_beside(square, at, g->z_m[i]);
	}
	if (ret_floors)
		*ret_floors = floors;
	return floor;
}
