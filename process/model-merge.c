#include "process/model-merge.h"
#include "process/model-thin.h"

#define STEP_POINTS  (1u << 18)
#define WINDOW_BYTES ((size_t)1 << 20)
#define WINDOW_MIN   ((size_t)64 << 10)

/* A sorted run of a part. */
struct run {
	const struct part_point *next, *end,
		*kept; /* kept: from here on the mapping is in memory */
	const model_part *part;
	uint32_t order; /* of equal points, the lower order comes first */
};

struct merge {
	struct run *heap; /* the least on top; [0] */
	size_t runs;
	size_t window;
	uint64_t total, done;
};

static bool comes_before(const struct run *a, const struct run *b)
{
	int by_place = part_point_compare(a->next, b->next);
	return by_place ? by_place < 0 : a->order < b->order;
}

static void sift_down(struct merge *m, size_t at)
{
	struct run moving = m->heap[at];
	for (size_t child; (child = 2 * at + 1) < m->runs; at = child) {
		if (child + 1 < m->runs && comes_before(&m->heap[child + 1], &m->heap[child]))
			child++;
		if (!comes_before(&m->heap[child], &moving))
			break;
		m->heap[at] = m->heap[child];
	}
	m->heap[at] = moving;
}

static void add_runs(struct merge *m, const model_part *p)
{
	uint64_t from = 0;
	for (uint64_t i = 0; i < p->runs; from = p->run_end[i++]) {
		const struct part_point *first = p->points + from;
		m->heap[m->runs] = (struct run){ first, p->points + p->run_end[i], first, p,
			(uint32_t)m->runs };
		m->runs++;
	}
	m->total += p->count;
}

static struct merge merge_new(model_part *const *part, size_t parts, uint64_t memory_bytes)
{
	size_t runs = 0;
	for (size_t i = 0; i < parts; i++)
		runs += part[i]->runs;
	struct merge m = { .heap = g_new(struct run, runs + 1) };
	m.window = CLAMP(memory_bytes / 4 / (runs + 1), WINDOW_MIN, WINDOW_BYTES);
	for (size_t i = 0; i < parts; i++)
		add_runs(&m, part[i]);
	for (size_t i = m.runs / 2; i--;)
		sift_down(&m, i);
	return m;
}

static void forget(const struct merge *m, struct run *r)
{
	size_t bytes = (size_t)((const char *)r->next - (const char *)r->kept);
	if (bytes < m->window)
		return;
	product_forget(r->part->file, r->kept, bytes);
	r->kept = r->next;
}

/* Goes on to the next point of the run on top. */
static void advance(struct merge *m)
{
	struct run *top = &m->heap[0];
	top->next++;
	forget(m, top);
	if (top->next == top->end)
		*top = m->heap[--m->runs];
	if (m->runs)
		sift_down(m, 0);
	m->done++;
}

static bool merge_all(struct merge *m, model_writer *w, model_thin *thin,
	const struct build_progress *progress, GError **error)
{
	while (m->runs) {
		const struct run *top = &m->heap[0];
		uint16_t scan = (uint16_t)top->part->scan;
		if (m->done % STEP_POINTS == 0 &&
			!build_progress_step(progress, (double)m->done / (double)m->total,
				"merging the points", error))
			return false;
		if (!(thin ? model_thin_add(thin, top->next, scan, error)
			   : model_writer_add(w, top->next, scan, error)))
			return false;
		advance(m);
	}
	return !thin || model_thin_flush(thin, error);
}

/* NULL: there are no clouds. */
static model_thin *thin_new(model_part *const *part, size_t parts, model_writer *w, unsigned level)
{
	g_autoptr(GHashTable) clouds = g_hash_table_new(NULL, NULL);
	for (size_t i = 0; i < parts; i++)
		if (part[i]->is_cloud)
			g_hash_table_add(clouds, GUINT_TO_POINTER(part[i]->scan));
	return g_hash_table_size(clouds) ? model_thin_new(w, level, clouds) : NULL;
}

bool model_merge(const char *path, model_part *const *part, size_t parts, unsigned level,
	JsonObject *manifest_json, const struct build_progress *progress,
	struct build_result *result, GError **error)
{
	g_autoptr(JsonObject) made = manifest_json;
	g_autoptr(model_writer) w = model_writer_new(path, level, error);
	if (!w)
		return false;
	g_autoptr(model_thin) thin = thin_new(part, parts, w, level);
	struct merge m = merge_new(part, parts, build_memory(progress->options));
	bool ok = merge_all(&m, w, thin, progress, error);
	g_free(m.heap);
	if (!ok)
		return false;
	result->points = model_writer_count(w);
	result->redundant += thin ? model_thin_redundant(thin) : 0;
	json_object_set_int_member(made, "points", (gint64)result->points);
	json_object_set_int_member(made, "redundant", (gint64)result->redundant);
	return model_writer_finish(w, g_steal_pointer(&made), error);
}
