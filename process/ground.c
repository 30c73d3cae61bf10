#include "process/ground.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define UP            0.7f /* least z of a normal */
#define FLOOR_ERROR_M 0.05f
#define FLOOR_SHARE   0.5f
#define STEP_M        0.2  /* a kerb, a stair */
#define SLOPE_MOST    0.75 /* of a bank */
#define WANDER        0.08 /* how far the ground may leave its slope, per metre */
#define REACH_M       1.5  /* over what hides the ground, and two columns at least */
#define SEED_RADIUS_M 3.5
#define SEED_WINDOW_M 40.0
#define PATCH_AREA_M2 3.0
#define PATCH_FAR_M   30.0
#define CELLS_MAX     (32u << 20)

/* GROUND was walked to; ADDED is a patch that goes on from it. */
enum surfel_state { SURFEL_OPEN, SURFEL_GROUND, SURFEL_ADDED, SURFEL_NO_FLOOR, SURFEL_PATCH };

struct layer {
	float z_m, slope[2]; /* at the column's middle */
	bool is_walked;
	uint32_t surfel;
};

struct ground {
	voxels *surfels;     /* of points that face up */
	voxel_columns *plan; /* of the surfels */
	voxels *rest;        /* of the others, on the same lattice: leaves face anywhere */
	uint8_t *state;      /* enum surfel_state */
	/* columns */
	int32_t low[2];
	uint32_t columns, rows;
	unsigned coarser; /* columns are 2^coarser cells wide */
	uint32_t *first;  /* of each column's layers, from the lowest; columns * rows + 1 */
	struct layer *layer;
	uint32_t *nearest; /* column with ground; VOXEL_NONE: there is none at all */
};

ground *ground_new(double cell_m)
{
	ground *g = g_new0(ground, 1);
	g->surfels = voxels_new(cell_m);
	g->rest = voxels_new(cell_m);
	return g;
}

void ground_free(ground *g)
{
	if (!g)
		return;
	voxels_free(g->surfels);
	voxel_columns_free(g->plan);
	voxels_free(g->rest);
	g_free(g->state);
	g_free(g->first);
	g_free(g->layer);
	g_free(g->nearest);
	g_free(g);
}

void ground_add(ground *g, const struct voxel_point *p)
{
	voxels_add(p->normal[2] >= UP ? g->surfels : g->rest, p);
}

void ground_merge(ground *g, const ground *from)
{
	voxels_merge(g->surfels, from->surfels);
	voxels_merge(g->rest, from->rest);
}

const voxels *ground_surfels(const ground *g)
{
	return g->surfels;
}

const voxel_columns *ground_plan(const ground *g)
{
	return g->plan;
}

bool ground_is(const ground *g, uint32_t surfel)
{
	return g->state[surfel] == SURFEL_GROUND || g->state[surfel] == SURFEL_ADDED;
}

/* ---- the walk ---- */

static void slope_of(const struct voxel *s, double ret[2])
{
	double steep = hypot(s->normal[0], s->normal[1]) / s->normal[2];
	double scale = steep > SLOPE_MOST ? SLOPE_MOST / steep : 1;
	for (int k = 0; k < 2; k++)
		ret[k] = -s->normal[k] / s->normal[2] * scale;
}

/* Whether b lies where one comes to from a: on the slope that both have, but for a step. */
static bool goes_on(const ground *g, uint32_t a, uint32_t b)
{
	double from[3], to[3], slope_a[2], slope_b[2];
	voxel_point_m(g->surfels, a, from);
	voxel_point_m(g->surfels, b, to);
	slope_of(&g->surfels->voxel[a], slope_a);
	slope_of(&g->surfels->voxel[b], slope_b);
	double dx = to[0] - from[0], dy = to[1] - from[1], dz = to[2] - from[2];
	double rise_a = slope_a[0] * dx + slope_a[1] * dy,
	       rise_b = slope_b[0] * dx + slope_b[1] * dy;
	double most = STEP_M + WANDER * hypot(dx, dy);
	return fabs(dz - rise_a) <= most && fabs(dz - rise_b) <= most;
}

typedef bool (*visit_func)(const ground *g, uint32_t from, uint32_t to, void *user_data);

/* Calls visit with all surfels that one comes to from s, at most reach columns away; nearer ones first. */
static void around(const ground *g, uint32_t s, int reach, visit_func visit, void *user_data)
{
	const struct voxel *v = &g->surfels->voxel[s];
	for (int ring = 0; ring <= reach; ring++) {
		unsigned found = 0;
		int up = 1 + (int)ceil(SLOPE_MOST * ring);
		for (int y = -ring; y <= ring; y++)
			for (int x = -ring; x <= ring;
				x += abs(y) == ring || x == ring ? 1 : 2 * ring) {
				const uint32_t *other = NULL;
				uint32_t count = voxel_columns_find(g->plan, v->at[0] + x,
					v->at[1] + y, v->at[2] - up, v->at[2] + up, &other);
				for (uint32_t k = 0; k < count; k++)
					if (other[k] != s && goes_on(g, s, other[k]))
						found += visit(g, s, other[k], user_data);
			}
		/* what lies behind the next ground is reached from there */
		if (ring > 1 ? found > 0 : found >= 6)
			return;
	}
}

struct walk {
	GArray *queue;
	uint8_t *mark; /* of each surfel: 0 not yet */
	uint8_t as;
};

static bool step(const ground *g, uint32_t from, uint32_t to, void *user_data)
{
	struct walk *w = user_data;
	(void)g, (void)from;
	if (!w->mark[to]) {
		w->mark[to] = w->as;
		g_array_append_val(w->queue, to);
	}
	return w->mark[to] == w->as;
}

static void walk_on(const ground *g, struct walk *w, int reach)
{
	for (guint i = 0; i < w->queue->len; i++)
		around(g, g_array_index(w->queue, uint32_t, i), reach, step, w);
}

static void set_out(struct walk *w, uint32_t from)
{
	if (w->mark[from])
		return;
	w->mark[from] = w->as;
	g_array_append_val(w->queue, from);
}

/* Most points of a floor face up; of a shrub, few. A crown seen from above faces up too, but fits no plane. */
static bool is_floor(const ground *g, uint32_t s)
{
	const struct voxel *v = &g->surfels->voxel[s];
	uint32_t other = voxels_find(g->rest, v->at);
	uint32_t rest = other == VOXEL_NONE ? 0 : g->rest->voxel[other].points;
	return v->points > FLOOR_SHARE * (float)(v->points + rest) && v->error_m < FLOOR_ERROR_M;
}

/* ---- where it begins ---- */

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* What a tripod stands on is most of what is flat around it. */
static void seed_station(const ground *g, const double station_m[3], struct walk *w)
{
	g_autoptr(GArray) near = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	g_autoptr(GArray) height = g_array_new(FALSE, FALSE, sizeof(double));
	for (uint32_t i = 0; i < g->surfels->count; i++) {
		double at[3];
		voxel_point_m(g->surfels, i, at);
		double below = station_m[2] - at[2];
		if (hypot(at[0] - station_m[0], at[1] - station_m[1]) > SEED_RADIUS_M ||
			below < 0.6 || below > 3 || g->surfels->voxel[i].normal[2] < 0.85f)
			continue;
		g_array_append_val(near, i);
		g_array_append_val(height, at[2]);
	}
	if (!near->len)
		return;
	qsort(height->data, height->len, sizeof(double), by_value);
	double middle = g_array_index(height, double, height->len / 2);
	for (guint k = 0; k < near->len; k++) {
		double at[3];
		voxel_point_m(g->surfels, g_array_index(near, uint32_t, k), at);
		if (fabs(at[2] - middle) < 0.15)
			set_out(w, g_array_index(near, uint32_t, k));
	}
}

static bool count_neighbour(const ground *g, uint32_t from, uint32_t to, void *user_data)
{
	(void)g, (void)from, (void)to;
	++*(unsigned *)user_data;
	return true;
}

/* Windows of equal size all over the plan: one that stands over its edge might hold a roof alone. */
struct windows {
	double low_m[2], size_m[2];
	gint64 count[2];
};

static struct windows lay_windows(const ground *g)
{
	struct windows w = { { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };
	for (uint32_t i = 0; i < g->surfels->count; i++) {
		double at[3];
		voxel_point_m(g->surfels, i, at);
		for (int k = 0; k < 2; k++) {
			w.low_m[k] = fmin(w.low_m[k], at[k]);
			w.size_m[k] = fmax(w.size_m[k], at[k]);
		}
	}
	for (int k = 0; k < 2; k++) {
		double extent = w.size_m[k] - w.low_m[k];
		w.count[k] = (gint64)fmax(round(extent / SEED_WINDOW_M), 1);
		w.size_m[k] = extent > 0 ? extent / (double)w.count[k] : 1;
	}
	return w;
}

static gint64 window_of(const struct windows *w, const double at_m[3])
{
	gint64 at[2];
	for (int k = 0; k < 2; k++)
		at[k] = MIN((gint64)((at_m[k] - w->low_m[k]) / w->size_m[k]), w->count[k] - 1);
	return at[1] * w->count[0] + at[0];
}

/* The lowest place of each window that others lie beside. */
static void seed_windows(const ground *g, struct walk *w)
{
	struct windows box = lay_windows(g);
	g_autoptr(GHashTable) lowest = g_hash_table_new(g_int64_hash, g_int64_equal);
	g_autofree gint64 *window = g_new(gint64, g->surfels->count + 1);
	for (uint32_t i = 0; i < g->surfels->count; i++) {
		double at[3], was[3] = { 0 };
		unsigned beside = 0;
		voxel_point_m(g->surfels, i, at);
		window[i] = window_of(&box, at);
		gpointer known = g_hash_table_lookup(lowest, &window[i]);
		if (known)
			voxel_point_m(g->surfels, GPOINTER_TO_UINT(known) - 1, was);
		if (g->state[i] != SURFEL_OPEN || (known && was[2] <= at[2]))
			continue;
		around(g, i, 1, count_neighbour, &beside);
		if (beside >= 5)
			g_hash_table_replace(lowest, &window[i], GUINT_TO_POINTER(i + 1));
	}
	GHashTableIter iter;
	gpointer value;
	g_hash_table_iter_init(&iter, lowest);
	while (g_hash_table_iter_next(&iter, NULL, &value))
		set_out(w, GPOINTER_TO_UINT(value) - 1);
}

/* ---- columns ---- */

static double column_m(const ground *g)
{
	return g->surfels->size_m * (double)(1u << g->coarser);
}

static void middle_of(const ground *g, uint32_t column, double ret_m[2])
{
	ret_m[0] = (g->low[0] + (double)(column % g->columns) + 0.5) * column_m(g);
	ret_m[1] = (g->low[1] + (double)(column / g->columns) + 0.5) * column_m(g);
}

static bool column_of(const ground *g, const double at_m[3], uint32_t *ret)
{
	double x = floor(at_m[0] / column_m(g)) - g->low[0],
	       y = floor(at_m[1] / column_m(g)) - g->low[1];
	if (x >= 0 && y >= 0 && x < g->columns && y < g->rows) {
		*ret = (uint32_t)y * g->columns + (uint32_t)x;
		return true;
	}
	x = fmin(fmax(x, 0), g->columns - 1.0);
	y = fmin(fmax(y, 0), g->rows - 1.0);
	*ret = (uint32_t)y * g->columns + (uint32_t)x;
	return false;
}

static void find_box(ground *g)
{
	int32_t high[2] = { INT32_MIN, INT32_MIN };
	g->low[0] = g->low[1] = INT32_MAX;
	for (uint32_t i = 0; i < g->surfels->count; i++)
		for (int k = 0; k < 2; k++) {
			g->low[k] = MIN(g->low[k], g->surfels->voxel[i].at[k]);
			high[k] = MAX(high[k], g->surfels->voxel[i].at[k]);
		}
	for (g->coarser = 0; g->surfels->count; g->coarser++) {
		int64_t columns = (high[0] >> g->coarser) - (g->low[0] >> g->coarser) + 1,
			rows = (high[1] >> g->coarser) - (g->low[1] >> g->coarser) + 1;
		g->columns = (uint32_t)columns;
		g->rows = (uint32_t)rows;
		if (columns * rows <= CELLS_MAX)
			break;
	}
	for (int k = 0; k < 2; k++)
		g->low[k] >>= g->coarser;
}

static int by_height(const void *a, const void *b)
{
	float x = ((const struct layer *)a)->z_m, y = ((const struct layer *)b)->z_m;
	return (x > y) - (x < y);
}

static void fill_layers(ground *g)
{
	size_t cells = (size_t)g->columns * g->rows;
	g_free(g->first);
	g_free(g->layer);
	g->first = g_new0(uint32_t, cells + 2);
	for (uint32_t i = 0; i < g->surfels->count; i++) {
		double at[3];
		uint32_t column;
		voxel_point_m(g->surfels, i, at);
		if (ground_is(g, i) && column_of(g, at, &column))
			g->first[column + 2]++;
	}
	for (size_t c = 0; c < cells; c++)
		g->first[c + 2] += g->first[c + 1];
	g->layer = g_new(struct layer, g->first[cells + 1] + 1);
	for (uint32_t i = 0; i < g->surfels->count; i++) {
		double at[3], slope[2];
		uint32_t column;
		voxel_point_m(g->surfels, i, at);
		if (!ground_is(g, i) || !column_of(g, at, &column))
			continue;
		double middle[2];
		middle_of(g, column, middle);
		double dx = middle[0] - at[0], dy = middle[1] - at[1];
		slope_of(&g->surfels->voxel[i], slope);
		g->layer[g->first[column + 1]++] =
			(struct layer){ (float)(at[2] + slope[0] * dx + slope[1] * dy),
				{ (float)slope[0], (float)slope[1] }, g->state[i] == SURFEL_GROUND,
				i };
	}
	for (size_t c = 0; c < cells; c++)
		qsort(g->layer + g->first[c], g->first[c + 1] - g->first[c], sizeof *g->layer,
			by_height);
}

/* Outwards from all columns with ground at once. */
static void fill_nearest(ground *g)
{
	size_t cells = (size_t)g->columns * g->rows;
	g_autofree uint32_t *queue = g_new(uint32_t, cells + 1);
	size_t from = 0, to = 0;
	g_free(g->nearest);
	g->nearest = g_new(uint32_t, cells + 1);
	for (size_t c = 0; c < cells; c++) {
		bool has = g->first[c + 1] > g->first[c];
		g->nearest[c] = has ? (uint32_t)c : VOXEL_NONE;
		if (has)
			queue[to++] = (uint32_t)c;
	}
	while (from < to) {
		uint32_t c = queue[from++];
		int x = (int)(c % g->columns), y = (int)(c / g->columns);
		for (int k = 0; k < 4; k++) {
			int nx = x + (k == 0) - (k == 1), ny = y + (k == 2) - (k == 3);
			if (nx < 0 || ny < 0 || nx >= (int)g->columns || ny >= (int)g->rows)
				continue;
			uint32_t n = (uint32_t)ny * g->columns + (uint32_t)nx;
			if (g->nearest[n] != VOXEL_NONE)
				continue;
			g->nearest[n] = g->nearest[c];
			queue[to++] = n;
		}
	}
}

static float layer_height_m(
	const ground *g, const struct layer *l, uint32_t column, const double at_m[3])
{
	double middle[2], reach = 2 * column_m(g);
	middle_of(g, column, middle);
	double dx = at_m[0] - middle[0], dy = at_m[1] - middle[1];
	dx = dx > reach ? reach : dx < -reach ? -reach : dx;
	dy = dy > reach ? reach : dy < -reach ? -reach : dy;
	return (float)(at_m[2] - l->z_m - l->slope[0] * dx - l->slope[1] * dy);
}

/* A layer this much above a point is still below it: the point may be in a dip. */
#define DIP_M 0.3f

/* NULL: there is no ground at all. */
static const struct layer *layer_below(const ground *g, const double at_m[3], float *ret_height_m)
{
	uint32_t here, column;
	if (!g->columns)
		return NULL;
	column_of(g, at_m, &here);
	column = g->nearest[here];
	if (column == VOXEL_NONE)
		return NULL;
	const struct layer *best = &g->layer[g->first[column]];
	*ret_height_m = layer_height_m(g, best, column, at_m);
	for (uint32_t l = g->first[column] + 1; l < g->first[column + 1]; l++) {
		float h = layer_height_m(g, &g->layer[l], column, at_m);
		if (h < -DIP_M || (h >= *ret_height_m && *ret_height_m >= -DIP_M))
			continue;
		*ret_height_m = h;
		best = &g->layer[l];
	}
	return best;
}

float ground_height_m(const ground *g, const double at_m[3])
{
	float height;
	return layer_below(g, at_m, &height) ? height : NAN;
}

uint32_t ground_surfel(const ground *g, const double at_m[3])
{
	float height;
	const struct layer *l = layer_below(g, at_m, &height);
	return l ? l->surfel : VOXEL_NONE;
}

float ground_above_m(const ground *g, const double at_m[3])
{
	uint32_t column;
	if (!g->columns || !column_of(g, at_m, &column))
		return INFINITY;
	for (uint32_t l = g->first[column]; l < g->first[column + 1]; l++) {
		float h = layer_height_m(g, &g->layer[l], column, at_m);
		if (h < -DIP_M && g->layer[l].is_walked)
			return -h;
	}
	return INFINITY;
}

uint32_t ground_top(const ground *g, const double at_m[2])
{
	double at[3] = { at_m[0], at_m[1], 0 };
	uint32_t column;
	if (!g->columns || !column_of(g, at, &column) || g->first[column] == g->first[column + 1])
		return VOXEL_NONE;
	return g->layer[g->first[column + 1] - 1].surfel;
}

bool ground_is_seen(const ground *g, const double at_m[3])
{
	uint32_t column;
	return g->columns && column_of(g, at_m, &column) && g->nearest[column] == column;
}

/* ---- patches that no walk reaches ---- */

static bool patch_is_ground(const ground *g, const GArray *patch)
{
	double cell = g->surfels->size_m;
	if (patch->len * cell * cell < PATCH_AREA_M2)
		return false;
	double nearest_m = INFINITY, step_m = 0;
	unsigned above = 0;
	for (guint i = 0; i < patch->len; i++) {
		double at[3];
		uint32_t column;
		voxel_point_m(g->surfels, g_array_index(patch, uint32_t, i), at);
		if (!column_of(g, at, &column) || g->nearest[column] == VOXEL_NONE)
			return false;
		uint32_t n = g->nearest[column];
		double far = column_m(g) *
			     hypot((double)(n % g->columns) - (double)(column % g->columns),
				     (double)(n / g->columns) - (double)(column / g->columns));
		above += n == column;
		if (far < nearest_m) {
			nearest_m = far;
			step_m = fabsf(ground_height_m(g, at));
		}
	}
	return above * 5 < patch->len && nearest_m < PATCH_FAR_M &&
	       step_m < 0.35 + 0.12 * nearest_m;
}

static void free_array(gpointer data)
{
	g_array_unref(data);
}

static GPtrArray *find_patches(ground *g)
{
	GPtrArray *patches = g_ptr_array_new_with_free_func(free_array);
	for (uint32_t i = 0; i < g->surfels->count; i++) {
		if (g->state[i] != SURFEL_OPEN)
			continue;
		GArray *patch = g_array_new(FALSE, FALSE, sizeof(uint32_t));
		struct walk w = { patch, g->state, SURFEL_PATCH };
		set_out(&w, i);
		walk_on(g, &w, 2);
		g_ptr_array_add(patches, patch);
	}
	return patches;
}

/* Until nothing is added: one patch leads to the next. */
static void add_patches(ground *g)
{
	g_autoptr(GPtrArray) patches = find_patches(g);
	for (bool more = true; more;) {
		more = false;
		for (guint i = patches->len; i--;) {
			GArray *patch = patches->pdata[i];
			if (!patch_is_ground(g, patch))
				continue;
			for (guint k = 0; k < patch->len; k++)
				g->state[g_array_index(patch, uint32_t, k)] = SURFEL_ADDED;
			g_ptr_array_remove_index_fast(patches, i);
			more = true;
		}
		if (more) {
			fill_layers(g);
			fill_nearest(g);
		}
	}
}

void ground_find(ground *g, const double (*station_m)[3], size_t stations)
{
	voxels_finish(g->surfels);
	g->plan = voxel_columns_new(g->surfels);
	g_autoptr(GArray) queue = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	g->state = g_new0(uint8_t, g->surfels->count + 1);
	for (uint32_t i = 0; i < g->surfels->count; i++)
		g->state[i] = is_floor(g, i) ? SURFEL_OPEN : SURFEL_NO_FLOOR;
	voxels_free(g->rest);
	g->rest = NULL;
	struct walk w = { queue, g->state, SURFEL_GROUND };
	for (size_t i = 0; i < stations; i++)
		seed_station(g, station_m[i], &w);
	if (!queue->len)
		seed_windows(g, &w);
	walk_on(g, &w, (int)fmax(round(REACH_M / g->surfels->size_m), 2));
	find_box(g);
	fill_layers(g);
	fill_nearest(g);
	add_patches(g);
}
