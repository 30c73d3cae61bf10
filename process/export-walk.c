#include "process/export-walk.h"
#include "acquire/scan.h"
#include "process/scan-segments.h"
#include <gio/gio.h>
#include <string.h>

/* So many columns of a mapped grid are gone through before its memory is given back: their records share pages. */
#define FORGET_COLUMNS 128u
#define FORGET_RECORDS (1u << 20)

struct export_walk {
	const struct export_job *job;
	const struct export_station *station;
	enum export_walk_order order;
	bool moved;         /* into the file's coordinates */
	panorama *recorded; /* one of these */
	points *imported;
	scan_segments *labels;  /* NULL: none that are up to date */
	uint8_t *class_of_leaf; /* enum segment_class */
	uint64_t done, forgotten;
	struct export_point block[EXPORT_BLOCK];
	uint64_t index[EXPORT_BLOCK];
};

enum export_walk_order export_order_of(const struct export_job *j, const struct export_station *s)
{
	if (!s->columns)
		return EXPORT_WALK_POINTS;
	return j->one_grid ? EXPORT_WALK_ROWS : j->format->order;
}

/* ---- opening ---- */

static bool open_points(export_walk *w, GError **error)
{
	const site *of = w->job->site;
	uint32_t number = w->station->number;
	if (w->station->kind == SCAN_RECORDED) {
		w->recorded = scan_load(of, number, false, error);
		return w->recorded;
	}
	g_autofree char *folder = site_scan_path(of, number),
			*path = g_build_filename(folder, "points.ply", NULL);
	w->imported = points_open(path, error);
	if (!w->imported)
		return false;
	if (w->imported->count == w->station->cells && w->imported->columns == w->station->columns)
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
		"%s: is not as scan.json beside it says", path);
	return false;
}

/* Segments that do not belong to these points, or none at all, are no classes. */
static void open_labels(export_walk *w)
{
	g_autoptr(segments) tree = segments_load(site_path(w->job->site), NULL);
	g_autoptr(scan_segments) labels =
		scan_segments_open(w->job->site, w->station->number, NULL);
	if (!tree || !labels || labels->count != w->station->cells ||
		!segments_has_labels(tree, w->station->number, scan_segments_leaf_checksum(labels)))
		return;
	w->class_of_leaf = g_malloc0(SEGMENTS_MAX + 1);
	for (guint i = 0; i < tree->nodes->len; i++) {
		const struct segment *node = &g_array_index(tree->nodes, struct segment, i);
		w->class_of_leaf[node->id] = (uint8_t)node->class;
	}
	w->labels = g_steal_pointer(&labels);
}

export_walk *export_walk_open(const struct export_job *j, const struct export_station *s,
	enum export_walk_order order, GError **error)
{
	g_autoptr(export_walk) w = g_new0(export_walk, 1);
	w->job = j;
	w->station = s;
	w->order = order;
	w->moved = export_is_merged(j) && s->has_pose;
	if (!open_points(w, error))
		return NULL;
	open_labels(w);
	return g_steal_pointer(&w);
}

void export_walk_free(export_walk *w)
{
	if (!w)
		return;
	panorama_free(w->recorded);
	points_free(w->imported);
	scan_segments_free(w->labels);
	g_free(w->class_of_leaf);
	g_free(w);
}

uint64_t export_walk_done(const export_walk *w)
{
	return w->done;
}

uint64_t export_walk_index(const export_walk *w, size_t i)
{
	return w->index[i];
}

/* ---- a point ---- */

static uint64_t index_of(const export_walk *w, uint64_t at)
{
	const struct export_station *s = w->station;
	return w->order == EXPORT_WALK_COLUMNS ? at % s->rows * s->columns + at / s->rows : at;
}

static bool is_kept(const export_walk *w, uint64_t i)
{
	const uint8_t *kept = w->station->survey.kept;
	return !kept || (kept[i / 8] >> i % 8 & 1);
}

static bool is_there(const export_walk *w, uint64_t i)
{
	uint8_t cell = w->recorded ? w->recorded->cell[i] : w->imported->record[i].cell;
	return cell == CELL_MEASURED && is_kept(w, i);
}

static void take_recorded(const export_walk *w, uint64_t i, struct export_point *p)
{
	const panorama *from = w->recorded;
	panorama_point(from, p->row, p->column, p->at_m);
	p->intensity = from->intensity[i];
	if (from->rgb)
		memcpy(p->rgb, from->rgb + 3 * i, sizeof p->rgb);
	p->return_number = 1;
}

static void take_imported(const export_walk *w, uint64_t i, struct export_point *p)
{
	const struct point_record *r = &w->imported->record[i];
	double at_m[3] = { r->x_m, r->y_m, r->z_m };
	memcpy(p->at_m, at_m, sizeof at_m);
	p->intensity = r->intensity;
	memcpy(p->rgb, r->rgb, sizeof p->rgb);
	p->classification = r->classification;
	p->return_number = MAX(r->return_number, 1);
}

/* A class that came with the points stays as long as nobody found another one. */
static uint8_t class_of(const export_walk *w, uint64_t i, uint8_t came)
{
	uint16_t leaf = w->labels ? w->labels->leaf[i] : SEGMENT_NONE;
	if (leaf == SEGMENT_NONE)
		return came;
	return segment_class_to_las(w->class_of_leaf[leaf], came);
}

static void take(export_walk *w, uint64_t i, struct export_point *p)
{
	uint32_t columns = w->station->columns;
	*p = (struct export_point){ .is_point = is_there(w, i) };
	p->row = columns ? (uint32_t)(i / columns) : 0;
	p->column = columns ? (uint32_t)(i % columns) : 0;
	if (!p->is_point)
		return;
	if (w->recorded)
		take_recorded(w, i, p);
	else
		take_imported(w, i, p);
	p->classification = class_of(w, i, p->classification);
	if (w->moved)
		pose_apply(&w->station->pose, p->at_m, p->at_m);
}

/* ---- walking ---- */

/* What was read of mapped files, so that memory does not grow with them. */
static void forget(export_walk *w)
{
	uint64_t step = w->order == EXPORT_WALK_COLUMNS
				? (uint64_t)FORGET_COLUMNS * w->station->rows
				: FORGET_RECORDS;
	if (w->done - w->forgotten < step)
		return;
	bool all = w->order == EXPORT_WALK_COLUMNS;
	uint64_t first = all ? 0 : w->forgotten,
		 count = (all ? w->station->cells : w->done) - first;
	if (w->imported)
		points_forget(w->imported, first, count);
	if (w->labels)
		product_forget(
			w->labels->file, w->labels->leaf + first, count * sizeof *w->labels->leaf);
	w->forgotten = w->done;
}

bool export_walk_next(
	export_walk *w, const struct export_point **ret, size_t *ret_count, GError **error)
{
	uint64_t cells = w->station->cells, before = w->done;
	size_t count = 0;
	for (; count < EXPORT_BLOCK && w->done < cells && w->done - before < 16 * EXPORT_BLOCK;
		w->done++) {
		uint64_t i = index_of(w, w->done);
		if (w->order == EXPORT_WALK_POINTS && !is_there(w, i))
			continue;
		w->index[count] = i;
		take(w, i, &w->block[count++]);
	}
	forget(w);
	*ret = w->block;
	*ret_count = count;
	if (!export_step(w->job, w->done - before, error))
		return false;
	/* A long way without any point. */
	return count || w->done == cells || export_walk_next(w, ret, ret_count, error);
}
