/* A change that is drawn: cells of one scan, and what the others have there. */
#include "process/segment-sums.h"

#define DRAWN_VOXEL_M 0.12
/* Of a leaf that was drawn in: with this much of what the scan shows of it, it is meant as a whole. */
#define WHOLE_SHARE 0.7

struct drawing {
	segment_state *s;
	guint scan;           /* that was drawn in */
	uint8_t *selected;    /* of its cells */
	voxels *inside, *all; /* where it has points that are selected, and any */
	uint8_t *is_whole;    /* of each leaf */
	uint16_t into;
};

static bool mark_cells(struct drawing *d, const segment_edit *e, GError **error)
{
	const struct segment_label *l = &d->s->label[d->scan];
	uint64_t marked = 0;
	d->selected = g_new0(uint8_t, l->count + 1);
	for (guint i = 0; i < e->runs->len; i++) {
		const struct cell_run *r = &g_array_index(e->runs, struct cell_run, i);
		for (uint64_t k = r->first; k < (uint64_t)r->first + r->count && k < l->count; k++)
			marked += d->selected[k] = l->leaf[k] != SEGMENT_NONE;
	}
	return marked || segment_state_refuse(error, "no point of scan %u is selected", e->scan);
}

/* What lies where the drawing is, and which leaves are meant as a whole. */
static bool look_at_drawing(struct drawing *d, GError **error)
{
	const struct segment_label *l = &d->s->label[d->scan];
	g_autofree uint64_t *all = g_new0(uint64_t, SEGMENTS_MAX + 1),
			    *in = g_new0(uint64_t, SEGMENTS_MAX + 1);
	struct segmentation_scan scan;
	if (!segment_scans_open(d->s->scans, d->scan, &scan, error))
		return false;
	d->inside = voxels_new(DRAWN_VOXEL_M);
	d->all = voxels_new(DRAWN_VOXEL_M);
	for (uint64_t k = 0; k < l->count; k++) {
		struct voxel_point p;
		if (l->leaf[k] == SEGMENT_NONE)
			continue;
		all[l->leaf[k]]++;
		in[l->leaf[k]] += d->selected[k];
		segmentation_point(&scan, 0, k, &p);
		voxels_add(d->all, &p);
		if (d->selected[k])
			voxels_add(d->inside, &p);
	}
	d->is_whole = g_new0(uint8_t, SEGMENTS_MAX + 1);
	for (uint32_t leaf = 1; leaf <= SEGMENTS_MAX; leaf++)
		d->is_whole[leaf] = in[leaf] && (double)in[leaf] >= WHOLE_SHARE * (double)all[leaf];
	return true;
}

static bool is_drawn(const struct drawing *d, const double at_m[3])
{
	uint32_t in = voxels_find_point(d->inside, at_m), all = voxels_find_point(d->all, at_m);
	return in != VOXEL_NONE && 2 * d->inside->voxel[in].points > d->all->voxel[all].points;
}

/* Other scans in the same frame have at these places what was drawn, too. */
static bool draw_scan(struct drawing *d, guint i, uint8_t *which, GError **error)
{
	struct segment_label *l = &d->s->label[i];
	struct segmentation_scan scan;
	if (segment_scans_at(d->s->scans, i)->frame !=
		segment_scans_at(d->s->scans, d->scan)->frame)
		return true;
	if (!segment_scans_open(d->s->scans, i, &scan, error))
		return false;
	for (uint64_t k = 0; k < l->count; k++) {
		double at[3];
		bool is = i == d->scan && d->selected[k];
		if (l->leaf[k] == SEGMENT_NONE || l->leaf[k] == d->into)
			continue;
		if (i != d->scan) {
			scan_points_position(&scan.points, k, at);
			is = d->is_whole[l->leaf[k]] || is_drawn(d, at);
		}
		if (!is)
			continue;
		which[l->leaf[k]] = 1;
		l->leaf[k] = d->into;
	}
	return true;
}

static void drawing_clear(struct drawing *d)
{
	g_free(d->selected);
	g_free(d->is_whole);
	voxels_free(d->inside);
	voxels_free(d->all);
}

static bool find_scan(const segment_state *s, uint32_t number, guint *ret, GError **error)
{
	for (*ret = 0; *ret < s->scans->scans->len; ++*ret)
		if (segment_scans_at(s->scans, *ret)->number == number)
			return true;
	return segment_state_refuse(error, "there is no scan %u", number);
}

/* The leaf that it goes into, which may be a new one. */
static bool find_target(segment_state *s, const segment_edit *e, uint16_t *ret, GError **error)
{
	uint32_t id;
	if (e->class < 0) {
		if (!segment_state_find(s, e, 0, &id, error))
			return false;
		*ret = (uint16_t)id;
		return (id >= SEGMENT_FIRST && segments_is_leaf(s->tree, id)) ||
		       segment_state_refuse(
			       error, "segment %u has parts: draw into one of these", id);
	}
	g_autofree char *name =
		e->name ? g_strdup(e->name) : g_strdup_printf("Drawn %u", e->number);
	id = segments_add(s->tree, segment_of_class((enum segment_class)e->class), name, "user");
	*ret = (uint16_t)id;
	return id || segment_state_refuse(error, "there are more than %u segments", SEGMENTS_MAX);
}

static bool draw_all(struct drawing *d, const segment_edit *e, GError **error)
{
	if (!mark_cells(d, e, error) || !look_at_drawing(d, error) ||
		!find_target(d->s, e, &d->into, error))
		return false;
	g_autofree struct leaf_sum *sum = segment_sums_new(d->s->tree);
	g_autofree uint8_t *which = g_new0(uint8_t, SEGMENTS_MAX + 1);
	for (guint i = 0; i < d->s->scans->scans->len; i++)
		if (!draw_scan(d, i, which, error))
			return false;
	which[d->into] = 1;
	if (!segment_sums_measure(d->s, which, sum, error))
		return false;
	segment_sums_finish(d->s->tree, sum);
	return true;
}

bool segment_state_draw(segment_state *s, const segment_edit *e, GError **error)
{
	struct drawing d = { .s = s };
	if (!find_scan(s, e->scan, &d.scan, error))
		return false;
	bool good = draw_all(&d, e, error);
	drawing_clear(&d);
	return good;
}
