/* Things of simulated sites are selected by strokes like those of a hand: one along a third of the thing, then such that mend what is
 * most wrong. */
#include "process/scribble.h"
#include "sim/truth.h"
#include "tests/simulated.h"
#include <stdlib.h>
#include <string.h>

/* ---- scans ---- */

struct seen {
	panorama *panorama;
	range_grid *grid;
	geometry *normals;
	uint16_t *instance; /* the true one of each measured cell; 0 */
	uint16_t *shown;    /* the same with lines between beams closed, as a person sees it */
	uint8_t *class_of;  /* of each instance */
};

enum { INSTANCES = 1 << 16 };

static panorama *scan_once(const char *description, const char *preset)
{
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	struct scan_options options = { .preset = preset_find(preset) };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	simulated_scan(path, description, &options, NULL, NULL, &result, &partial, &error);
	g_assert_no_error(error);
	g_autoptr(site) s = site_open(path, &error);
	panorama *p = scan_load(s, result.number, false, &error);
	g_assert_no_error(error);
	return p;
}

static struct seen look(const char *description, const char *preset)
{
	g_autoptr(GError) error = NULL;
	struct seen s = { .panorama = scan_once(description, preset) };
	s.grid = range_grid_from_panorama(s.panorama);
	s.normals = geometry_estimate(s.grid, NULL);
	g_autoptr(truth) t = truth_new(description, &error);
	g_assert_no_error(error);
	size_t n = range_grid_cells(s.grid);
	s.instance = g_new0(uint16_t, n);
	s.class_of = g_new0(uint8_t, INSTANCES);
	for (uint32_t i = 0; i < n; i++) {
		if (!(s.grid->range_m[i] > 0))
			continue;
		uint32_t row = i / s.grid->columns, column = i % s.grid->columns;
		struct truth_cell c = truth_look(t, panorama_azimuth_rad(s.panorama, row, column),
			panorama_elevation_rad(s.panorama, row, column));
		s.instance[i] = c.instance;
		s.class_of[c.instance] = c.class;
	}
	s.shown = g_memdup2(s.instance, n * sizeof *s.shown);
	for (size_t i = s.grid->columns; i + s.grid->columns < n; i++)
		if (s.grid->cell[i] == CELL_FILLED)
			s.shown[i] = s.instance[i - s.grid->columns];
	return s;
}

static void seen_clear(struct seen *s)
{
	panorama_free(s->panorama);
	range_grid_free(s->grid);
	geometry_free(s->normals);
	g_free(s->instance);
	g_free(s->shown);
	g_free(s->class_of);
}

/* ---- a hand ---- */

/* What hangs together, as a box of cells whose columns run on over the seam. */
struct part {
	long column0, row0, columns, rows;
	uint8_t *in;     /* of the box */
	uint16_t *depth; /* cells to the nearest one outside */
	size_t cells;
};

static void part_clear(struct part *p)
{
	g_free(p->in);
	g_free(p->depth);
}

struct spot {
	long column, row;
};

/* Cells that hang together with a first one, with columns that run on over the seam. */
static GArray *gather(const range_grid *g, const uint8_t *set, uint8_t *taken, uint32_t first)
{
	GArray *at = g_array_new(false, false, sizeof(struct spot));
	struct spot start = { first % g->columns, first / g->columns };
	g_array_append_val(at, start);
	taken[first] = 1;
	for (guint k = 0; k < at->len; k++) {
		struct spot from = g_array_index(at, struct spot, k);
		for (int d = 0; d < 8; d++) {
			static const int around[8][2] = { { 0, 1 }, { 1, 0 }, { 0, -1 }, { -1, 0 },
				{ 1, 1 }, { -1, 1 }, { 1, -1 }, { -1, -1 } };
			struct spot to = { from.column + around[d][0], from.row + around[d][1] };
			long columns = g->columns,
			     wrapped = (to.column % columns + columns) % columns;
			if (to.row < 0 || to.row >= (long)g->rows)
				continue;
			size_t i = (size_t)(to.row * columns + wrapped);
			if (!set[i] || taken[i])
				continue;
			taken[i] = 1;
			g_array_append_val(at, to);
		}
	}
	return at;
}

static void measure_depth(struct part *p)
{
	p->depth = g_new0(uint16_t, (size_t)(p->columns * p->rows));
	for (int pass = 0; pass < 2; pass++)
		for (long k = 0; k < p->columns * p->rows; k++) {
			long i = pass ? p->columns * p->rows - 1 - k : k, r = i / p->columns,
			     c = i % p->columns, by = pass ? 1 : -1;
			if (!p->in[i])
				continue;
			long least = pass ? p->depth[i] : G_MAXUINT16;
			for (long dx = -1; dx <= 1; dx++) {
				long x = c + dx, y = r + by;
				bool inside = x >= 0 && x < p->columns && y >= 0 && y < p->rows;
				least = MIN(least, inside ? p->depth[y * p->columns + x] + 1 : 1);
			}
			long x = c + by;
			bool inside = x >= 0 && x < p->columns;
			least = MIN(least, inside ? p->depth[r * p->columns + x] + 1 : 1);
			p->depth[i] = (uint16_t)least;
		}
}

static struct part largest_part(const range_grid *g, const uint8_t *set)
{
	size_t n = range_grid_cells(g);
	g_autofree uint8_t *taken = g_new0(uint8_t, n);
	g_autoptr(GArray) best = NULL;
	for (uint32_t i = 0; i < n; i++) {
		if (!set[i] || taken[i])
			continue;
		g_autoptr(GArray) at = gather(g, set, taken, i);
		if (!best || at->len > best->len) {
			g_clear_pointer(&best, g_array_unref);
			best = g_steal_pointer(&at);
		}
	}
	struct part p = { 0 };
	if (!best)
		return p;
	struct spot low = { G_MAXLONG, G_MAXLONG }, high = { G_MINLONG, G_MINLONG };
	for (guint k = 0; k < best->len; k++) {
		struct spot at = g_array_index(best, struct spot, k);
		low = (struct spot){ MIN(low.column, at.column), MIN(low.row, at.row) };
		high = (struct spot){ MAX(high.column, at.column), MAX(high.row, at.row) };
	}
	p = (struct part){ low.column, low.row, high.column - low.column + 1,
		high.row - low.row + 1 };
	p.in = g_new0(uint8_t, (size_t)(p.columns * p.rows));
	p.cells = best->len;
	for (guint k = 0; k < best->len; k++) {
		struct spot at = g_array_index(best, struct spot, k);
		p.in[(at.row - low.row) * p.columns + at.column - low.column] = 1;
	}
	measure_depth(&p);
	return p;
}

enum { POINTS = 4 };
struct hand {
	struct scribble_point point[POINTS];
	struct scribble_stroke stroke;
};

/* Along the longer direction of the part, over the middle third of it, where it is deepest inside. */
static void draw_by_hand(const struct part *p, enum scribble_side side, struct hand *ret)
{
	double mean[2] = { 0 }, xx = 0, xy = 0, yy = 0;
	for (long i = 0; i < p->columns * p->rows; i++)
		if (p->in[i]) {
			mean[0] += (double)(i % p->columns) / (double)p->cells;
			mean[1] += (double)(i / p->columns) / (double)p->cells;
		}
	for (long i = 0; i < p->columns * p->rows; i++)
		if (p->in[i]) {
			double dx = (double)(i % p->columns) - mean[0],
			       dy = (double)(i / p->columns) - mean[1];
			xx += dx * dx;
			xy += dx * dy;
			yy += dy * dy;
		}
	double angle = 0.5 * atan2(2 * xy, xx - yy), along[2] = { cos(angle), sin(angle) };
	double low = INFINITY, high = -INFINITY;
	for (long i = 0; i < p->columns * p->rows; i++)
		if (p->in[i]) {
			double t = (double)(i % p->columns) * along[0] +
				   (double)(i / p->columns) * along[1];
			low = fmin(low, t);
			high = fmax(high, t);
		}
	uint16_t depths[POINTS] = { 0 };
	for (long i = 0; i < p->columns * p->rows; i++) {
		if (!p->in[i])
			continue;
		double t =
			(double)(i % p->columns) * along[0] + (double)(i / p->columns) * along[1];
		for (int k = 0; k < POINTS; k++) {
			double at = low + (high - low) * (1.0 / 3 + k / (3.0 * (POINTS - 1)));
			if (fabs(t - at) > 0.8 || p->depth[i] <= depths[k])
				continue;
			depths[k] = p->depth[i];
			ret->point[k] = (struct scribble_point){
				(float)(p->column0 + i % p->columns) + 0.5f,
				(float)(p->row0 + i / p->columns) + 0.5f
			};
		}
	}
	size_t count = 0;
	uint16_t shallow = G_MAXUINT16;
	for (int k = 0; k < POINTS; k++)
		if (depths[k]) {
			shallow = MIN(shallow, depths[k]);
			ret->point[count++] = ret->point[k];
		}
	ret->stroke = (struct scribble_stroke){ .side = side,
		.point = ret->point,
		.points = count,
		.radius = fminf((float)(shallow - 1) / 2, 3) };
}

/* ---- how well ---- */

static double overlap(size_t n, const uint8_t *a, const uint8_t *b)
{
	size_t both = 0, either = 0;
	for (size_t i = 0; i < n; i++) {
		both += a[i] && b[i];
		either += a[i] || b[i];
	}
	return (double)both / (double)either;
}

enum { STROKES = 4 };
struct outcome {
	double iou[STROKES], seconds;
	size_t cells;
	int class;
};

/* What is most wrong is stroked over: what is missing, or what should not be there. */
static void mend(const struct seen *s, const uint8_t *mask, scribble *scribbled)
{
	size_t n = range_grid_cells(s->grid);
	const uint8_t *selected = scribble_selected(scribbled);
	g_autofree uint8_t *set = g_new(uint8_t, n);
	struct part best = { 0 };
	enum scribble_side side = SCRIBBLE_INSIDE;
	for (int more = 0; more < 2; more++) {
		for (size_t i = 0; i < n; i++)
			set[i] = more ? selected[i] && !mask[i] : mask[i] && !selected[i];
		for (size_t i = s->grid->columns; i < n; i++)
			if (s->grid->cell[i] == CELL_FILLED)
				set[i] = set[i - s->grid->columns];
		struct part p = largest_part(s->grid, set);
		if (p.cells > best.cells) {
			part_clear(&best);
			best = p;
			side = more ? SCRIBBLE_OUTSIDE : SCRIBBLE_INSIDE;
		} else {
			part_clear(&p);
		}
	}
	struct hand hand;
	if (best.cells) {
		draw_by_hand(&best, side, &hand);
		scribble_draw(scribbled, &hand.stroke);
	}
	part_clear(&best);
}

static struct outcome select_thing(const struct seen *s, scribble *scribbled, uint16_t instance)
{
	size_t n = range_grid_cells(s->grid);
	g_autofree uint8_t *mask = g_new(uint8_t, n);
	struct outcome o = { .class = s->class_of[instance] };
	for (size_t i = 0; i < n; i++)
		o.cells += mask[i] = s->instance[i] == instance;
	g_autofree uint8_t *shown = g_new(uint8_t, n);
	for (size_t i = 0; i < n; i++)
		shown[i] = s->shown[i] == instance;
	struct part p = largest_part(s->grid, shown);
	struct hand hand;
	draw_by_hand(&p, SCRIBBLE_INSIDE, &hand);
	part_clear(&p);
	gint64 from = g_get_monotonic_time();
	scribble_draw(scribbled, &hand.stroke);
	o.seconds = (double)(g_get_monotonic_time() - from) / 1e6;
	for (int k = 0; k < STROKES; k++) {
		if (k)
			mend(s, mask, scribbled);
		o.iou[k] = overlap(n, mask, scribble_selected(scribbled));
	}
	while (scribble_undo(scribbled))
		;
	return o;
}

static bool is_thing(const struct seen *s, uint16_t instance, size_t cells)
{
	int class = s->class_of[instance];
	return cells >= 150 && cells < range_grid_count(s->grid) / 8 && class != WORLD_NOTHING &&
	       class != WORLD_BUILDING && class != WORLD_TERRAIN && class != WORLD_WATER;
}

/* Adds what comes of each thing of the scan. */
static void select_things(const struct seen *s, const uint16_t *leaf, GArray *outcomes)
{
	gint64 from = g_get_monotonic_time();
	g_autoptr(scribble) scribbled = scribble_new(s->grid, s->normals, leaf, NULL);
	g_test_message("%u x %u cells are ready in %.0f ms", s->grid->columns, s->grid->rows,
		(double)(g_get_monotonic_time() - from) / 1e3);
	g_autofree size_t *cells = g_new0(size_t, INSTANCES);
	for (size_t i = 0; i < range_grid_cells(s->grid); i++)
		cells[s->instance[i]]++;
	for (uint32_t k = 1; k < INSTANCES; k++) {
		if (!is_thing(s, (uint16_t)k, cells[k]))
			continue;
		struct outcome o = select_thing(s, scribbled, (uint16_t)k);
		g_test_message("%4u, class %d, %5zu cells: %.2f %.2f %.2f %.2f; %.0f ms", k,
			o.class, o.cells, o.iou[0], o.iou[1], o.iou[2], o.iou[3], o.seconds * 1e3);
		g_array_append_val(outcomes, o);
	}
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double median_iou(const GArray *outcomes, int stroke, double *ret_mean)
{
	g_autofree double *iou = g_new(double, outcomes->len);
	double mean = 0;
	for (guint i = 0; i < outcomes->len; i++) {
		iou[i] = g_array_index(outcomes, struct outcome, i).iou[stroke];
		mean += iou[i] / outcomes->len;
	}
	qsort(iou, outcomes->len, sizeof *iou, by_value);
	g_test_message("%u things, stroke %d: mean %.3f, quartiles %.3f %.3f %.3f", outcomes->len,
		stroke + 1, mean, iou[outcomes->len / 4], iou[outcomes->len / 2],
		iou[outcomes->len * 3 / 4]);
	if (ret_mean)
		*ret_mean = mean;
	return iou[outcomes->len / 2];
}

static const char *const places[] = {
	"court?seed=5&station=1&ares=720&camera=none",
	"court?seed=5&station=3&ares=720&camera=none",
	"street?seed=5&station=1&ares=720&camera=none",
	"street?seed=5&station=3&ares=720&camera=none",
	"bridge?seed=5&station=1&ares=720&camera=none",
	"bridge?seed=5&station=3&ares=720&camera=none",
};

static void test_things(void)
{
	g_autoptr(GArray) outcomes = g_array_new(false, false, sizeof(struct outcome));
	for (size_t i = 0; i < G_N_ELEMENTS(places); i++) {
		struct seen s = look(places[i], "draft");
		select_things(&s, NULL, outcomes);
		seen_clear(&s);
	}
	double mean[STROKES], median[STROKES];
	for (int k = 0; k < STROKES; k++)
		median[k] = median_iou(outcomes, k, &mean[k]);
	g_assert_cmpuint(outcomes->len, >=, 60);
	g_assert_cmpfloat(median[0], >=, 0.75);
	g_assert_cmpfloat(median[1], >=, 0.82);
	g_assert_cmpfloat(median[2], >=, 0.85);
	g_assert_cmpfloat(mean[0], >=, 0.68);
	g_assert_cmpfloat(mean[1], >=, 0.73);
}

/* What is known of leaves helps. */
static void test_leaves(void)
{
	struct seen s = look(places[2], "draft");
	g_autoptr(GArray) without = g_array_new(false, false, sizeof(struct outcome)),
			  with = g_array_new(false, false, sizeof(struct outcome));
	select_things(&s, NULL, without);
	select_things(&s, s.instance, with);
	double before, after;
	median_iou(without, 0, &before);
	median_iou(with, 0, &after);
	g_assert_cmpfloat(after, >, before);
	seen_clear(&s);
}

/* ---- how it behaves ---- */

static size_t largest_thing(const struct seen *s, uint16_t *ret)
{
	g_autofree size_t *cells = g_new0(size_t, INSTANCES);
	for (size_t i = 0; i < range_grid_cells(s->grid); i++)
		cells[s->instance[i]]++;
	size_t best = 0;
	for (uint32_t k = 1; k < INSTANCES; k++)
		if (is_thing(s, (uint16_t)k, cells[k]) && cells[k] > best) {
			best = cells[k];
			*ret = (uint16_t)k;
		}
	return best;
}

static struct hand hand_over(const struct seen *s, uint16_t instance)
{
	size_t n = range_grid_cells(s->grid);
	g_autofree uint8_t *shown = g_new(uint8_t, n);
	for (size_t i = 0; i < n; i++)
		shown[i] = s->shown[i] == instance;
	struct part p = largest_part(s->grid, shown);
	struct hand hand;
	draw_by_hand(&p, SCRIBBLE_INSIDE, &hand);
	part_clear(&p);
	return hand;
}

static void test_undo(void)
{
	struct seen s = look(places[0], "draft");
	uint16_t instance = 0;
	g_assert_cmpuint(largest_thing(&s, &instance), >, 1000);
	struct hand hand = hand_over(&s, instance);
	hand.stroke.point = hand.point;
	g_autoptr(scribble) scribbled = scribble_new(s.grid, s.normals, NULL, NULL);
	size_t n = range_grid_cells(s.grid);
	g_assert_false(scribble_undo(scribbled));
	scribble_draw(scribbled, &hand.stroke);
	size_t count = scribble_count(scribbled);
	g_autofree uint8_t *first = g_memdup2(scribble_selected(scribbled), n);
	struct scribble_stroke outside = hand.stroke;
	outside.side = SCRIBBLE_OUTSIDE;
	outside.points = 1;
	scribble_draw(scribbled, &outside);
	g_assert_cmpuint(scribble_count(scribbled), <, count);
	g_assert_true(scribble_undo(scribbled));
	g_assert_cmpmem(scribble_selected(scribbled), n, first, n);
	g_assert_true(scribble_undo(scribbled));
	g_assert_cmpuint(scribble_count(scribbled), ==, 0);
	g_assert_false(scribble_undo(scribbled));
	for (size_t i = 0; i < n; i++)
		g_assert_true(!first[i] || s.grid->range_m[i] > 0);
	seen_clear(&s);
}

static void roll_plane(void *plane, size_t bytes, uint32_t columns, uint32_t rows, uint32_t by)
{
	g_autofree uint8_t *row = g_malloc(columns * bytes);
	for (uint32_t r = 0; r < rows && plane; r++) {
		uint8_t *at = (uint8_t *)plane + (size_t)r * columns * bytes;
		memcpy(row, at + by * bytes, (columns - by) * bytes);
		memcpy(row + (columns - by) * bytes, at, by * bytes);
		memcpy(at, row, columns * bytes);
	}
}

static void roll(struct seen *s, uint32_t by)
{
	range_grid *g = s->grid;
	geometry *n = s->normals;
	float *planes[] = { g->x_m, g->y_m, g->z_m, g->range_m, n->normal_x, n->normal_y,
		n->normal_z, n->plane_error_m, n->curvature };
	for (size_t k = 0; k < G_N_ELEMENTS(planes); k++)
		roll_plane(planes[k], sizeof(float), g->columns, g->rows, by);
	roll_plane(g->intensity, sizeof *g->intensity, g->columns, g->rows, by);
	roll_plane(g->cell, 1, g->columns, g->rows, by);
}

/* The seam through the middle of a thing changes next to nothing. */
static void test_seam(void)
{
	struct seen s = look(places[0], "draft");
	uint16_t instance = 0;
	largest_thing(&s, &instance);
	struct hand hand = hand_over(&s, instance);
	hand.stroke.point = hand.point;
	size_t n = range_grid_cells(s.grid);
	g_autoptr(scribble) plain = scribble_new(s.grid, s.normals, NULL, NULL);
	scribble_draw(plain, &hand.stroke);
	g_autofree uint8_t *expected = g_memdup2(scribble_selected(plain), n);
	uint32_t by = (uint32_t)hand.point[0].column % s.grid->columns;
	roll_plane(expected, 1, s.grid->columns, s.grid->rows, by);
	roll(&s, by);
	for (int k = 0; k < POINTS; k++)
		hand.point[k].column -= (float)by;
	g_autoptr(scribble) rolled = scribble_new(s.grid, s.normals, NULL, NULL);
	scribble_draw(rolled, &hand.stroke);
	double same = overlap(n, expected, scribble_selected(rolled));
	g_test_message("%.4f the same", same);
	g_assert_cmpfloat(same, >, 0.98);
	seen_clear(&s);
}

/* A stroke over the ground selects ground, and nothing of what stands there. */
static void test_ground(void)
{
	struct seen s = look(places[0], "draft");
	float row = (float)s.grid->rows - 20;
	struct scribble_point line[2] = { { 20, row }, { 80, row } };
	struct scribble_stroke stroke = { .point = line, .points = 2, .radius = 2 };
	g_autoptr(scribble) scribbled = scribble_new(s.grid, s.normals, NULL, NULL);
	scribble_draw(scribbled, &stroke);
	size_t count = scribble_count(scribbled), ground = 0;
	for (size_t i = 0; i < range_grid_cells(s.grid); i++)
		ground += scribble_selected(scribbled)[i] &&
			  s.class_of[s.instance[i]] == WORLD_TERRAIN;
	g_test_message("%zu of %zu cells are ground", ground, count);
	g_assert_cmpuint(count, >, 2000);
	g_assert_cmpuint(ground * 100, >, count * 95);
	seen_clear(&s);
}

/* Without intensity and without planes; strokes off the grid, through the sky, of one point, of none. */
static void test_bare(void)
{
	struct seen s = look(places[0], "draft");
	uint16_t instance = 0;
	largest_thing(&s, &instance);
	struct hand hand = hand_over(&s, instance);
	hand.stroke.point = hand.point;
	g_aligned_free(s.grid->intensity);
	s.grid->intensity = NULL;
	g_autoptr(scribble) scribbled = scribble_new(s.grid, NULL, NULL, NULL);
	scribble_draw(scribbled, &hand.stroke);
	size_t n = range_grid_cells(s.grid), count = scribble_count(scribbled);
	g_autofree uint8_t *mask = g_new(uint8_t, n);
	for (size_t i = 0; i < n; i++)
		mask[i] = s.instance[i] == instance;
	g_assert_cmpfloat(overlap(n, mask, scribble_selected(scribbled)), >, 0.5);
	static const struct scribble_point far[2] = { { -4000, -50 }, { 9000, -2 } };
	struct scribble_stroke none = { .point = far, .points = 2, .radius = 1 };
	scribble_draw(scribbled, &none);
	none.points = 0;
	scribble_draw(scribbled, &none);
	g_assert_cmpuint(scribble_count(scribbled), ==, count);
	while (scribble_undo(scribbled))
		;
	size_t sky = 0;
	while (sky < n && s.grid->cell[sky] != CELL_NO_RETURN)
		sky++;
	struct scribble_point dab = { (float)(sky % s.grid->columns) + 0.5f,
		(float)(sky / s.grid->columns) + 0.5f };
	struct scribble_stroke up = { .point = &dab, .points = 1 };
	scribble_draw(scribbled, &up);
	g_assert_cmpuint(scribble_count(scribbled), ==, 0);
	seen_clear(&s);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/scribble/things", test_things);
	g_test_add_func("/scribble/leaves", test_leaves);
	g_test_add_func("/scribble/undo", test_undo);
	g_test_add_func("/scribble/seam", test_seam);
	g_test_add_func("/scribble/ground", test_ground);
	g_test_add_func("/scribble/bare", test_bare);
	return g_test_run();
}
