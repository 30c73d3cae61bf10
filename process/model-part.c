#include "process/model-part.h"
#include "process/model-overlaps.h"
#include "process/model.h"
#include <string.h>

#define RUN_MIN       65536u
#define BYTES_A_POINT (2 * sizeof(struct part_point) + 1) /* sorting takes as much again */

void model_part_free(model_part *p)
{
	if (!p)
		return;
	product_free(p->file);
	g_free(p);
}

/* ---- one point ---- */

/* Where the points of a scan are and what is known of them; one of grid and records, or both. */
struct source {
	const scan_data *data;
	const scan_geometry *geometry; /* NULL: none */
	const uint8_t *dropped;        /* NULL: none */
	const struct model_input *input;
	uint64_t count;
};

static bool has_point(const struct source *s, uint64_t i)
{
	if (s->data->grid)
		return s->data->grid->range_m[i] > 0;
	return s->data->points->record[i].cell == CELL_MEASURED;
}

static void position_of(const struct source *s, uint64_t i, double ret_m[3])
{
	const range_grid *g = s->data->grid;
	if (s->data->points) {
		const struct point_record *r = &s->data->points->record[i];
		double at[3] = { r->x_m, r->y_m, r->z_m };
		memcpy(ret_m, at, sizeof at);
	} else {
		double at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		memcpy(ret_m, at, sizeof at);
	}
	pose_apply(&s->input->pose, ret_m, ret_m);
}

static uint16_t tenth_mm(float length_m, uint16_t max)
{
	return length_m > 0 ? (uint16_t)fminf(roundf(length_m * 1e4f), max) : 0;
}

static void take_normal(const struct source *s, uint64_t i, int16_t ret[2])
{
	float n[3];
	model_unpack_normal(s->geometry->normal[i], n);
	double turned[3] = { n[0], n[1], n[2] };
	pose_rotate(&s->input->pose, turned, turned);
	model_pack_normal((float[3]){ (float)turned[0], (float)turned[1], (float)turned[2] }, ret);
}

static void take_geometry(const struct source *s, uint64_t i, struct part_point *p)
{
	p->normal[0] = p->normal[1] = MODEL_NORMAL_NONE;
	p->plane_error = MODEL_ERROR_NONE;
	if (s->data->grid)
		p->size = tenth_mm(range_grid_point_size_m(s->data->grid, i), UINT16_MAX);
	if (!s->geometry)
		return;
	take_normal(s, i, p->normal);
	if (isfinite(s->geometry->plane_error_m[i]))
		p->plane_error = tenth_mm(s->geometry->plane_error_m[i], MODEL_ERROR_NONE - 1);
	if (isfinite(s->geometry->point_size_m[i]))
		p->size = tenth_mm(s->geometry->point_size_m[i], UINT16_MAX);
}

static void take_look_of_record(const points *all, uint64_t i, struct part_point *p)
{
	const struct point_record *r = &all->record[i];
	p->classification = r->classification;
	p->intensity = r->intensity;
	if (!(all->have & POINTS_HAVE_COLOUR))
		return;
	memcpy(p->rgba, r->rgb, 3);
	p->rgba[3] = 255;
}

static void take_look_of_cell(const range_grid *g, uint64_t i, struct part_point *p)
{
	p->intensity = g->intensity ? g->intensity[i] : 0;
	if (!g->rgb)
		return;
	memcpy(p->rgba, g->rgb + 3 * i, 3);
	p->rgba[3] = 255;
}

/* false: outside the lattice. */
static bool take_point(
	const struct source *s, uint64_t i, double cell_m, struct part_point *ret, double *reach_m)
{
	double at[3];
	struct morton_place place;
	position_of(s, i, at);
	for (int k = 0; k < 3; k++)
		*reach_m = fmax(*reach_m, fabs(at[k]));
	if (!morton_from_point(at, cell_m, &place))
		return false;
	*ret = (struct part_point){ .code = place.code };
	memcpy(ret->within, place.within, sizeof ret->within);
	take_geometry(s, i, ret);
	if (s->data->points)
		take_look_of_record(s->data->points, i, ret);
	else
		take_look_of_cell(s->data->grid, i, ret);
	return true;
}

/* ---- the file ---- */

struct maker {
	struct source source;
	double cell_m, reach_m;
	struct part_point *run;
	size_t run_points, run_max;
	GArray *run_end; /* of uint64_t */
	uint64_t count, redundant;
};

static bool write_run(struct maker *m, product_writer *w, GError **error)
{
	if (!m->run_points)
		return true;
	part_points_sort(m->run, m->run_points);
	m->count += m->run_points;
	g_array_append_val(m->run_end, m->count);
	bool ok = product_writer_append(w, m->run, m->run_points, error);
	m->run_points = 0;
	return ok;
}

static bool write_points(struct maker *m, product_writer *w, GError **error)
{
	for (uint64_t i = 0; i < m->source.count; i++) {
		if (!has_point(&m->source, i))
			continue;
		if (m->source.dropped && m->source.dropped[i])
			m->redundant++;
		else if (take_point(&m->source, i, m->cell_m, &m->run[m->run_points], &m->reach_m))
			m->run_points++;
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

static bool write_part(struct maker *m, const char *path, const char *key, GError **error)
{
	g_autoptr(product_writer) w = product_writer_new(path, error);
	if (!w || !product_writer_begin(w, "points", sizeof *m->run, error) ||
		!write_points(m, w, error) ||
		!product_writer_begin(w, "run_end", sizeof(uint64_t), error) ||
		!product_writer_append(w, m->run_end->data, m->run_end->len, error))
		return false;
	JsonObject *made = json_object_new();
	json_object_set_string_member(made, "key", key);
	json_object_set_int_member(made, "redundant", (gint64)m->redundant);
	json_object_set_int_member(made, "level_needed", level_for(m->reach_m));
	return product_writer_finish(w, MODEL_PART_KIND, MODEL_PART_VERSION, made, error);
}

/* Of all that decides about the bytes of the part. */
static char *key_of(
	const struct model_input *input, unsigned level, const uint8_t *dropped, uint64_t cells)
{
	g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
	g_autofree char *head = g_strdup_printf("%s %u ", input->key, level);
	g_checksum_update(sum, (const guchar *)head, -1);
	for (uint64_t at = 0; at < cells; at += 1 << 30)
		g_checksum_update(sum, dropped + at, (gssize)MIN(cells - at, 1u << 30));
	return g_strdup(g_checksum_get_string(sum));
}

static bool make_part(const site *s, const struct model_input *input, unsigned level,
	const uint8_t *dropped, uint64_t memory_bytes, const char *key, GError **error)
{
	g_autofree char *path = model_part_path(s, input->number, "part");
	g_autoptr(scan_data) d = scan_data_load(s, input->number, error);
	g_autoptr(scan_geometry) geometry = NULL;
	if (!d || !model_input_geometry(s, input, d, &geometry, error))
		return false;
	uint64_t count = d->grid ? range_grid_cells(d->grid) : d->points->count;
	struct maker m = { .source = { d, geometry, dropped, input, count },
		.cell_m = morton_cell_m(level),
		.run_max = CLAMP(memory_bytes / 2 / BYTES_A_POINT, RUN_MIN, MAX(count, RUN_MIN)),
		.run_end = g_array_new(FALSE, FALSE, sizeof(uint64_t)) };
	m.run = g_new(struct part_point, m.run_max);
	bool ok = write_part(&m, path, key, error);
	g_array_unref(m.run_end);
	g_free(m.run);
	return ok;
}

static bool take_sections(model_part *p, GError **error)
{
	uint64_t before = 0;
	if (!(p->points = product_section(
		      p->file, "points", sizeof *p->points, &p->count, error)) ||
		!(p->run_end = product_section(p->file, "run_end", 8, &p->runs, error)))
		return false;
	for (uint64_t i = 0; i < p->runs; before = p->run_end[i++])
		if (p->run_end[i] <= before || p->run_end[i] > p->count)
			return false;
	return before == p->count;
}

static model_part *open_part(const char *path, const char *key)
{
	g_autoptr(model_part) p = g_new0(model_part, 1);
	p->file = product_open(path, MODEL_PART_KIND, MODEL_PART_VERSION, NULL);
	if (!p->file || !take_sections(p, NULL))
		return NULL;
	JsonObject *m = product_manifest(p->file);
	if (strcmp(json_object_get_string_member_with_default(m, "key", ""), key))
		return NULL;
	p->redundant = (uint64_t)json_object_get_int_member_with_default(m, "redundant", 0);
	p->level_needed = (unsigned)CLAMP(
		json_object_get_int_member_with_default(m, "level_needed", 0), 0, MORTON_LEVEL_MAX);
	return g_steal_pointer(&p);
}

model_part *model_part_open(const site *s, const struct model_input *input, unsigned level)
{
	g_autofree uint8_t *dropped = NULL;
	uint64_t cells;
	if (!model_overlaps_load(s, input, &dropped, &cells, NULL))
		return NULL;
	g_autofree char *key = key_of(input, level, dropped, cells);
	g_autofree char *path = model_part_path(s, input->number, "part");
	model_part *p = open_part(path, key);
	if (!p)
		return NULL;
	p->scan = input->number;
	p->is_cloud = input->kind == SCAN_CLOUD;
	return p;
}

bool model_part_update(const site *s, const struct model_input *input, unsigned level,
	uint64_t memory_bytes, bool *ret_made, GError **error)
{
	g_autofree uint8_t *dropped = NULL;
	uint64_t cells;
	if (!model_overlaps_load(s, input, &dropped, &cells, error))
		return false;
	g_autofree char *key = key_of(input, level, dropped, cells);
	g_autofree char *path = model_part_path(s, input->number, "part");
	g_autoptr(model_part) there = open_part(path, key);
	*ret_made = !there || !product_verify(there->file, NULL);
	return !*ret_made || make_part(s, input, level, dropped, memory_bytes, key, error);
}
