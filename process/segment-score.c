#include "process/segment-score.h"

#define RANGE_OFF_M   0.15
#define WATER_ANSWERS 0.9848f /* cosine of the incidence */
#define CELLS_LEAST   100     /* of a class that counts */
#define TREE_CELLS    200
#define TREE_HIGH_M   2.5
#define INSTANCES     65536

struct score_plants {
	double of_leaf[SEGMENTS_MAX + 1]; /* cells with a truth */
	struct {
		double cells, iou;
		float low_m, high_m;
	} instance[INSTANCES]; /* of vegetation */
	GHashTable *pairs;     /* instance << 16 | leaf: cells */
};

segment_score *segment_score_new(void)
{
	segment_score *s = g_new0(segment_score, 1);
	s->plants = g_new0(struct score_plants, 1);
	s->plants->pairs = g_hash_table_new(NULL, NULL);
	return s;
}

void segment_score_free(segment_score *s)
{
	if (!s)
		return;
	g_hash_table_unref(s->plants->pairs);
	g_free(s->plants);
	g_free(s);
}

/* ---- counting ---- */

static void count_plant(struct score_plants *p, uint32_t instance, uint32_t leaf, float z_m)
{
	gpointer key = GUINT_TO_POINTER(instance << 16 | leaf);
	gsize cells = GPOINTER_TO_SIZE(g_hash_table_lookup(p->pairs, key));
	g_hash_table_insert(p->pairs, key, GSIZE_TO_POINTER(cells + 1));
	if (!p->instance[instance].cells++)
		p->instance[instance].low_m = p->instance[instance].high_m = z_m;
	p->instance[instance].low_m = fminf(p->instance[instance].low_m, z_m);
	p->instance[instance].high_m = fmaxf(p->instance[instance].high_m, z_m);
}

/* Whether the point is one of what the middle of its beam meets. Where that is water met aslant, an edge of the beam met the shore. */
static bool is_known(const struct bench_truth_cell *c, const range_grid *g, size_t i)
{
	const bool behind_glass =
		c->optics == BENCH_TRUTH_GLASS && c->class == BENCH_TRUTH_BUILDING;
	const float range_m = g->range_m[i], *n = c->normal;
	const float facing = fabsf(n[0] * g->x_m[i] + n[1] * g->y_m[i] + n[2] * g->z_m[i]);
	if (c->optics == BENCH_TRUTH_WATER && !(facing >= WATER_ANSWERS * range_m))
		return false;
	return c->class != BENCH_TRUTH_NOTHING && c->class < BENCH_TRUTH_CLASSES &&
	       (behind_glass || fabsf(c->range_m - range_m) <= RANGE_OFF_M);
}

void segment_score_count(segment_score *s, const segments *tree, const struct scan_points *p,
	const uint16_t *leaf, const struct bench_truth_cell *truth)
{
	for (uint64_t i = 0; i < p->count; i++) {
		double at[3];
		s->points += leaf[i] != SEGMENT_NONE;
		if (leaf[i] == SEGMENT_NONE || !is_known(&truth[i], p->data->grid, i))
			continue;
		scan_points_position(p, i, at);
		s->cells[truth[i].class][segments_find(tree, leaf[i])->class]++;
		s->plants->of_leaf[leaf[i]]++;
		if (truth[i].class == BENCH_TRUTH_VEGETATION)
			count_plant(s->plants, truth[i].instance, leaf[i], (float)at[2]);
	}
}

void segment_score_count_told(
	segment_score *s, const segments *tree, const struct scan_points *p, const uint16_t *leaf)
{
	for (uint64_t i = 0; i < p->count; i++) {
		int told = segment_class_from_las(scan_points_classification(p, i));
		s->points += leaf[i] != SEGMENT_NONE;
		if (leaf[i] != SEGMENT_NONE && told >= 0)
			s->cells[told][segments_find(tree, leaf[i])->class]++;
	}
}

static bool is_tree(const struct score_plants *p, uint32_t instance)
{
	return p->instance[instance].cells >= TREE_CELLS &&
	       p->instance[instance].high_m - p->instance[instance].low_m > TREE_HIGH_M;
}

void segment_score_count_trees(segment_score *s)
{
	struct score_plants *p = s->plants;
	GHashTableIter iter;
	gpointer key, value;
	g_hash_table_iter_init(&iter, p->pairs);
	while (g_hash_table_iter_next(&iter, &key, &value)) {
		uint32_t instance = GPOINTER_TO_UINT(key) >> 16,
			 leaf = GPOINTER_TO_UINT(key) & 0xFFFF;
		double both = (double)GPOINTER_TO_SIZE(value);
		double iou = both / (p->instance[instance].cells + p->of_leaf[leaf] - both);
		p->instance[instance].iou = fmax(p->instance[instance].iou, iou);
	}
	for (uint32_t i = 0; i < INSTANCES; i++) {
		s->trees += is_tree(p, i);
		s->trees_found += is_tree(p, i) && p->instance[i].iou >= 0.5;
	}
}

/* ---- what comes out ---- */

double segment_score_of(const segment_score *s, int class, bool f1)
{
	double both = s->cells[class][class], is = 0, told = 0;
	for (int k = 0; k < SEGMENT_CLASSES; k++)
		is += s->cells[class][k];
	for (int k = 0; k < BENCH_TRUTH_CLASSES; k++)
		told += s->cells[k][class];
	if (is < CELLS_LEAST)
		return NAN;
	return f1 ? 2 * both / (is + told) : both / (is + told - both);
}

double segment_score_mean(const segment_score *s, bool f1)
{
	double sum = 0, classes = 0;
	for (int c = 1; c < SEGMENT_CLASSES; c++)
		if (!isnan(segment_score_of(s, c, f1))) {
			sum += segment_score_of(s, c, f1);
			classes++;
		}
	return sum / classes;
}

const char *segment_score_row(int row, bool f1)
{
	return f1 && row < SEGMENT_CLASSES ? segment_classes[row].name : bench_truth_names[row];
}

static void add_trees(GString *text, const segment_score *s)
{
	const struct score_plants *p = s->plants;
	for (uint32_t i = 0; i < INSTANCES; i++)
		if (is_tree(p, i) && p->instance[i].iou < 0.5)
			g_string_append_printf(text, "\n  tree %u, %.0f cells, %.1f m: IoU %.2f", i,
				p->instance[i].cells, p->instance[i].high_m - p->instance[i].low_m,
				p->instance[i].iou);
	g_string_append_printf(text,
		"\n  mean IoU %.3f (reach: >= 0.85), trees %u of %u (>= 90 %%)",
		segment_score_mean(s, false), s->trees_found, s->trees);
}

char *segment_score_text(const segment_score *s, bool f1)
{
	g_autoptr(GString) text = g_string_new(NULL);
	g_string_printf(text, "%-12s", "");
	for (int k = 0; k < SEGMENT_CLASSES; k++)
		g_string_append_printf(text, " %10s", segment_classes[k].name);
	g_string_append_printf(text, " %6s", f1 ? "F1" : "IoU");
	for (int c = f1 ? 0 : 1; c < (f1 ? SEGMENT_CLASSES : BENCH_TRUTH_CLASSES); c++) {
		g_string_append_printf(text, "\n  %-10s", segment_score_row(c, f1));
		for (int k = 0; k < SEGMENT_CLASSES; k++)
			g_string_append_printf(text, " %10.0f", s->cells[c][k]);
		if (c < SEGMENT_CLASSES && !isnan(segment_score_of(s, c, f1)))
			g_string_append_printf(text, " %6.3f", segment_score_of(s, c, f1));
	}
	if (f1)
		g_string_append_printf(text, "\n  mean F1 %.3f", segment_score_mean(s, true));
	else
		add_trees(text, s);
	return g_string_free(g_steal_pointer(&text), FALSE);
}
