#include "process/model-thin.h"
#include <string.h>

#define SIZE_UNKNOWN 100 /* 0.1 mm; of points without one */

struct held {
	struct part_point point;
	uint16_t scan;
	bool is_cloud, drop;
};

/* What one scan has in a cell. */
struct share {
	uint16_t scan;
	bool is_cloud;
	uint32_t points;
	double area; /* sum of size^2 */
	double normal[3];
};

struct model_thin {
	model_writer *to;
	GHashTable *clouds;
	double cell_m;
	unsigned block_shift; /* of codes, to that of a block */
	GArray *held;         /* of struct held, of one leaf and block */
	GArray *shares;       /* of struct share */
};

model_thin *model_thin_new(model_writer *w, unsigned level, GHashTable *clouds)
{
	model_thin *t = g_new0(model_thin, 1);
	t->to = w;
	t->clouds = g_hash_table_ref(clouds);
	t->cell_m = morton_cell_m(level);
	t->block_shift = model_cube_shift(MODEL_BLOCK_M, t->cell_m);
	t->held = g_array_new(FALSE, FALSE, sizeof(struct held));
	t->shares = g_array_new(FALSE, TRUE, sizeof(struct share));
	return t;
}

void model_thin_free(model_thin *t)
{
	if (!t)
		return;
	g_hash_table_unref(t->clouds);
	g_array_unref(t->held);
	g_array_unref(t->shares);
	g_free(t);
}

static double size_of(const struct held *h)
{
	return 1e-4 * (h->point.size ? h->point.size : SIZE_UNKNOWN);
}

/* ---- one cell ---- */

static struct share *share_of(GArray *shares, const struct held *h)
{
	for (guint i = 0; i < shares->len; i++)
		if (g_array_index(shares, struct share, i).scan == h->scan)
			return &g_array_index(shares, struct share, i);
	g_array_set_size(shares, shares->len + 1);
	struct share *s = &g_array_index(shares, struct share, shares->len - 1);
	*s = (struct share){ .scan = h->scan, .is_cloud = h->is_cloud };
	return s;
}

static void count_shares(GArray *shares, const struct held *cell, size_t count)
{
	g_array_set_size(shares, 0);
	for (size_t i = 0; i < count; i++) {
		struct share *s = share_of(shares, &cell[i]);
		float n[3];
		model_unpack_normal(cell[i].point.normal, n);
		s->points++;
		s->area += size_of(&cell[i]) * size_of(&cell[i]);
		for (int k = 0; k < 3; k++)
			s->normal[k] += n[k];
	}
}

/* Smallest patches, of those that cover the cell well; of equals, the lowest number. */
static struct share best_of(const GArray *shares)
{
	double covered = 0;
	const struct share *best = NULL;
	for (guint i = 0; i < shares->len; i++)
		covered = fmax(covered, g_array_index(shares, struct share, i).area);
	for (guint i = 0; i < shares->len; i++) {
		const struct share *s = &g_array_index(shares, struct share, i);
		if (s->area < 0.5 * covered)
			continue;
		double mine = s->area / s->points,
		       its = best ? best->area / best->points : INFINITY;
		if (mine < its || (mine == its && s->scan < best->scan))
			best = s;
	}
	return *best;
}

static bool is_other_side(const struct held *h, const struct share *best)
{
	float n[3];
	model_unpack_normal(h->point.normal, n);
	return n[0] * best->normal[0] + n[1] * best->normal[1] + n[2] * best->normal[2] < 0;
}

static void thin_cell(model_thin *t, struct held *cell, size_t count)
{
	count_shares(t->shares, cell, count);
	if (t->shares->len < 2)
		return;
	struct share best = best_of(t->shares);
	for (size_t i = 0; i < count; i++)
		cell[i].drop = cell[i].scan != best.scan && (cell[i].is_cloud || best.is_cloud) &&
			       !is_other_side(&cell[i], &best);
}

/* ---- one block ---- */

/* Mean patch of the clouds' points; 0: there are none, or nothing else is here. */
static double cloud_patch_m(const struct held *held, size_t count)
{
	double area = 0;
	size_t points_of_clouds = 0;
	bool is_shared = false;
	for (size_t i = 0; i < count; i++) {
		is_shared |= held[i].scan != held[0].scan;
		if (!held[i].is_cloud)
			continue;
		area += size_of(&held[i]) * size_of(&held[i]);
		points_of_clouds++;
	}
	return is_shared && points_of_clouds ? sqrt(area / (double)points_of_clouds) : 0;
}

static void thin_block(model_thin *t, struct held *held, size_t count)
{
	double patch = cloud_patch_m(held, count);
	unsigned shift = model_cube_shift(2 * patch, t->cell_m);
	for (size_t i = 0, end; patch > 0 && i < count; i = end) {
		for (end = i + 1; end < count; end++)
			if (held[end].point.code >> shift != held[i].point.code >> shift)
				break;
		thin_cell(t, held + i, end - i);
	}
}

bool model_thin_flush(model_thin *t, GError **error)
{
	struct held *held = (struct held *)(void *)t->held->data;
	thin_block(t, held, t->held->len);
	for (guint i = 0; i < t->held->len; i++) {
		if (!held[i].drop && !model_writer_add(t->to, &held[i].point, held[i].scan, error))
			return false;
	}
	g_array_set_size(t->held, 0);
	return true;
}

bool model_thin_add(model_thin *t, const struct part_point *p, uint16_t scan, GError **error)
{
	const struct held *first = t->held->len ? &g_array_index(t->held, struct held, 0) : NULL;
	bool is_next =
		first && (first->point.leaf != p->leaf ||
				 first->point.code >> t->block_shift != p->code >> t->block_shift ||
				 t->held->len >= MODEL_THIN_MAX);
	if (is_next && !model_thin_flush(t, error))
		return false;
	struct held h = { *p, scan, g_hash_table_contains(t->clouds, GUINT_TO_POINTER(scan)),
		false };
	g_array_append_val(t->held, h);
	return true;
}
