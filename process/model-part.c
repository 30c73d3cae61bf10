#include "process/model-part.h"
#include "firmware-io/crc32c.h"
#include "process/model-overlaps.h"
#include "process/part-point.h"
#include <json-glib/json-glib.h>
#include <string.h>

#define RUN_MIN 65536u
#define AT_ONCE 65536u /* points that threads share */
#define BYTES_A_POINT                                                                              \
	(sizeof(struct part_point) + sizeof(uint32_t) + PART_SORT_BYTES) /* with its cell */

void model_part_free(model_part *p)
{
	if (!p)
		return;
	product_free(p->file);
	product_free(p->overlaps);
	g_free(p);
}

/* ---- the file ---- */

struct maker {
	struct part_source source;
	double cell_m, reach_m;
	struct part_point *run;
	uint32_t *run_cell; /* NULL for a cloud */
	size_t run_points, run_max;
	GArray *run_end; /* of uint64_t */
	GArray *cell;    /* of uint32_t, of all runs */
	GArray *sum;     /* of struct part_sum */
	uint64_t count;
};

/* Points of a run in their order; cell NULL: they are of a cloud. */
static void sum_points(
	struct maker *m, const struct part_point *point, const uint32_t *cell, size_t count)
{
	for (size_t i = 0, n; i < count; i += n) {
		uint32_t at = (uint32_t)((m->count + i) % MODEL_PART_SUM_POINTS);
		n = MIN(MODEL_PART_SUM_POINTS - at, count - i);
		if (at == 0)
			g_array_set_size(m->sum, m->sum->len + 1);
		struct part_sum *s = &g_array_index(m->sum, struct part_sum, m->sum->len - 1);
		s->points = crc32c(s->points, &point[i], n * sizeof *point);
		if (cell)
			s->cells = crc32c(s->cells, &cell[i], n * sizeof *cell);
	}
}

static bool write_some(struct maker *m, product_writer *w, const uint32_t *order, size_t count,
	struct part_point *room, GError **error)
{
	part_points_gather(m->run, order, count, room);
	guint from = m->cell->len;
	for (size_t i = 0; m->run_cell && i < count; i++)
		g_array_append_val(m->cell, m->run_cell[order[i]]);
	sum_points(m, room, m->run_cell ? &g_array_index(m->cell, uint32_t, from) : NULL, count);
	m->count += count;
	return product_writer_append(w, room, count, error);
}

static bool write_run(struct maker *m, product_writer *w, GError **error)
{
	if (!m->run_points)
		return true;
	g_autofree uint32_t *order = part_points_order(m->run, m->run_points);
	g_autofree struct part_point *room = g_new(struct part_point, AT_ONCE);
	for (size_t i = 0; i < m->run_points; i += AT_ONCE)
		if (!write_some(m, w, order + i, MIN(AT_ONCE, m->run_points - i), room, error))
			return false;
	g_array_append_val(m->run_end, m->count);
	m->run_points = 0;
	return true;
}

/* Of the next points of the scan, from *at on, as many as there is room for in the run, and all threads are busy with: where they are. */
static size_t list_next(const struct maker *m, uint64_t *at, uint64_t *ret)
{
	const size_t most = MIN(AT_ONCE, m->run_max - m->run_points);
	size_t count = 0;
	for (; *at < m->source.points.count && count < most; ++*at)
		if (scan_points_has(&m->source.points, *at))
			ret[count++] = *at;
	return count;
}

/* Puts those that the lattice holds together. */
static void close_up(struct maker *m, const uint64_t *listed, const bool *is_taken, size_t count)
{
	size_t to = m->run_points;
	for (size_t i = 0; i < count; i++) {
		if (!is_taken[i])
			continue;
		if (to != m->run_points + i)
			m->run[to] = m->run[m->run_points + i];
		if (m->run_cell)
			m->run_cell[to] = (uint32_t)listed[i];
		to++;
	}
	m->run_points = to;
}

static void take_listed(struct maker *m, const uint64_t *listed, bool *is_taken, size_t count)
{
	double reach_m = m->reach_m;
#pragma omp parallel for schedule(dynamic, 1024) reduction(max : reach_m)
	for (size_t i = 0; i < count; i++)
		is_taken[i] = part_point_take(
			&m->source, listed[i], m->cell_m, &m->run[m->run_points + i], &reach_m);
	m->reach_m = reach_m;
	close_up(m, listed, is_taken, count);
}

static bool write_points(struct maker *m, product_writer *w, GError **error)
{
	g_autofree uint64_t *listed = g_new(uint64_t, AT_ONCE);
	g_autofree bool *is_taken = g_new(bool, AT_ONCE);
	size_t count;
	for (uint64_t at = 0; (count = list_next(m, &at, listed)) > 0;) {
		take_listed(m, listed, is_taken, count);
		if (m->run_points == m->run_max && !write_run(m, w, error))
			return false;
	}
	return write_run(m, w, error);
}

static unsigned level_for(double reach_m)
{
	unsigned level = 0;
	while (level < MORTON_LEVEL_MAX && reach_m >= morton_cell_m(level) * (MORTON_HALF - 1))
		level++;
	return level;
}

static bool write_rest(struct maker *m, product_writer *w, GError **error)
{
	return product_writer_begin(w, "run_end", sizeof(uint64_t), error) &&
	       product_writer_append(w, m->run_end->data, m->run_end->len, error) &&
	       product_writer_begin(w, "cell", sizeof(uint32_t), error) &&
	       product_writer_append(w, m->cell->data, m->cell->len, error) &&
	       product_writer_begin(w, "sum", sizeof(struct part_sum), error) &&
	       product_writer_append(w, m->sum->data, m->sum->len, error);
}

static bool write_part(struct maker *m, const char *path, const char *key, GError **error)
{
	g_autoptr(product_writer) w = product_writer_new(path, error);
	if (!w || !product_writer_begin(w, "points", sizeof *m->run, error) ||
		!write_points(m, w, error) || !write_rest(m, w, error))
		return false;
	JsonObject *made = json_object_new();
	json_object_set_string_member(made, "key", key);
	json_object_set_int_member(made, "level_needed", level_for(m->reach_m));
	return product_writer_finish(w, MODEL_PART_KIND, MODEL_PART_VERSION, made, error);
}

/* Of all that decides about the bytes of the part. */
static char *key_of(const struct model_input *input, unsigned level)
{
	g_autofree char *text = g_strdup_printf("%s %u", input->part_key, level);
	return g_compute_checksum_for_string(G_CHECKSUM_SHA256, text, -1);
}

static void maker_init(struct maker *m, uint64_t memory_bytes, unsigned level)
{
	m->cell_m = morton_cell_m(level);
	m->run_max = CLAMP(
		memory_bytes / 2 / BYTES_A_POINT, RUN_MIN, MAX(m->source.points.count, RUN_MIN));
	m->run = g_new(struct part_point, m->run_max);
	m->run_cell = m->source.points.data->grid ? g_new(uint32_t, m->run_max) : NULL;
	m->run_end = g_array_new(FALSE, FALSE, sizeof(uint64_t));
	m->cell = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	m->sum = g_array_new(FALSE, TRUE, sizeof(struct part_sum));
}

static void maker_clear(struct maker *m)
{
	g_free(m->run);
	g_free(m->run_cell);
	g_array_unref(m->run_end);
	g_array_unref(m->cell);
	g_array_unref(m->sum);
}

static bool make_part(const site *s, const struct model_input *input, unsigned level,
	uint64_t memory_bytes, const char *key, GError **error)
{
	g_autofree char *path = model_part_path(s, input->number, "part");
	g_autoptr(scan_data) d = scan_data_load(s, input->number, error);
	g_autoptr(scan_geometry) geometry = NULL;
	g_autoptr(scan_segments) labels = NULL;
	g_autoptr(scan_features) degrees = NULL;
	if (!d || !model_input_geometry(s, input, d, &geometry, error) ||
		!model_input_segments(s, input, d, &labels, error) ||
		!model_input_features(s, input, d, &degrees, error))
		return false;
	struct maker m = { .source = {
				   scan_points_of(d, geometry, &input->pose), labels, degrees } };
	maker_init(&m, memory_bytes, level);
	bool ok = write_part(&m, path, key, error);
	maker_clear(&m);
	return ok;
}

/* ---- reading ---- */

static bool take_sections(model_part *p)
{
	uint64_t before = 0, cells, sums;
	if (!(p->points = product_section(p->file, "points", sizeof *p->points, &p->count, NULL)) ||
		!(p->run_end = product_section(p->file, "run_end", 8, &p->runs, NULL)) ||
		!(p->cell = product_section(p->file, "cell", sizeof *p->cell, &cells, NULL)) ||
		!(p->sum = product_section(p->file, "sum", sizeof *p->sum, &sums, NULL)) ||
		(cells && cells != p->count) ||
		sums != (p->count + MODEL_PART_SUM_POINTS - 1) / MODEL_PART_SUM_POINTS)
		return false;
	p->cell = cells ? p->cell : NULL;
	for (uint64_t i = 0; i < p->runs; before = p->run_end[i++])
		if (p->run_end[i] <= before || p->run_end[i] > p->count)
			return false;
	return before == p->count;
}

static model_part *open_part(const site *s, const struct model_input *input, const char *key)
{
	g_autofree char *path = model_part_path(s, input->number, "part");
	g_autoptr(model_part) p = g_new0(model_part, 1);
	p->scan = input->number;
	p->is_cloud = input->kind == SCAN_CLOUD;
	p->file = product_open(path, MODEL_PART_KIND, MODEL_PART_VERSION, NULL);
	if (!p->file || !take_sections(p) || (!p->cell && p->count && !p->is_cloud))
		return NULL;
	JsonObject *m = product_manifest(p->file);
	/* An earlier version's points are not what this one would make. */
	if (json_object_get_int_member(m, "version") != MODEL_PART_VERSION ||
		strcmp(json_object_get_string_member_with_default(m, "key", ""), key))
		return NULL;
	p->level_needed = (unsigned)CLAMP(
		json_object_get_int_member_with_default(m, "level_needed", 0), 0, MORTON_LEVEL_MAX);
	return g_steal_pointer(&p);
}

model_part *model_part_open(const site *s, const struct model_input *input, unsigned level)
{
	g_autofree char *key = key_of(input, level);
	g_autoptr(model_part) p = open_part(s, input, key);
	if (!p || p->is_cloud)
		return g_steal_pointer(&p);
	p->overlaps = model_overlaps_open(s, input, &p->dropped, &p->words);
	return p->overlaps ? g_steal_pointer(&p) : NULL;
}

static bool damaged(const model_part *p, uint64_t sum, GError **error)
{
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: the points from %" G_GUINT64_FORMAT " on are damaged", product_path(p->file),
		sum * MODEL_PART_SUM_POINTS);
	return false;
}

bool model_part_verify_points(const model_part *p, uint64_t sum, GError **error)
{
	const struct part_point *first = p->points + sum * MODEL_PART_SUM_POINTS;
	uint32_t crc = crc32c(0, first, model_part_sum_points(p, sum) * sizeof *first);
	return crc == p->sum[sum].points || damaged(p, sum, error);
}

bool model_part_verify_cells(const model_part *p, uint64_t sum, GError **error)
{
	if (!p->cell)
		return true;
	const uint32_t *first = p->cell + sum * MODEL_PART_SUM_POINTS;
	size_t n = model_part_sum_points(p, sum);
	bool are_in_grid = true;
	for (size_t i = 0; i < n; i++)
		are_in_grid &= first[i] / 64 < p->words;
	return (are_in_grid && crc32c(0, first, n * sizeof *first) == p->sum[sum].cells) ||
	       damaged(p, sum, error);
}

void model_part_forget(const model_part *p, const struct part_point *from, size_t count)
{
	product_forget(p->file, from, count * sizeof *from);
	if (p->cell)
		product_forget(p->file, p->cell + (from - p->points), count * sizeof *p->cell);
}

bool model_part_update(const site *s, const struct model_input *input, unsigned level,
	bool is_doubtful, uint64_t memory_bytes, bool *ret_made, GError **error)
{
	g_autofree char *key = key_of(input, level);
	g_autoptr(model_part) there = open_part(s, input, key);
	*ret_made = !there || (is_doubtful && !product_verify(there->file, NULL));
	return !*ret_made || make_part(s, input, level, memory_bytes, key, error);
}
