#include "process/model-merge.h"
#include "process/model-thin.h"
#include <json-glib/json-glib.h>

#define STEP_POINTS  (1u << 18)
#define WINDOW_BYTES ((size_t)1 << 20)
#define WINDOW_MIN   ((size_t)64 << 10)

/* A sorted run of a part. */
struct run {
	const struct part_point *next, *stop, *end, /* stop: of the range that is being merged */
		*kept;                              /* from here on the mapping is in memory */
	uint64_t next_sum;                          /* of the part: those before it were checked */
	const model_part *part;
	uint32_t order; /* of equal points, the lower order comes first */
};

struct merge {
	struct run *all;   /* by order */
	struct run **heap; /* those with points in the range, the least on top; [0] */
	size_t all_runs, runs;
	size_t window_points;
	model_writer *to;
	model_thin *thin; /* NULL: there are no clouds */
	const struct build_progress *progress;
	uint64_t total, done; /* points that stay; of these, added to the model or taken over */
	uint64_t next_step;   /* of done */
	uint64_t points, redundant; /* in the model; left out */
	uint64_t taken_over;        /* of those in the model */
};

static bool comes_before(const struct run *a, const struct run *b)
{
	int by_place = part_point_compare(a->next, b->next);
	return by_place ? by_place < 0 : a->order < b->order;
}

static void sift_down(struct merge *m, size_t at)
{
	struct run *moving = m->heap[at];
	for (size_t child; (child = 2 * at + 1) < m->runs; at = child) {
		if (child + 1 < m->runs && comes_before(m->heap[child + 1], m->heap[child]))
			child++;
		if (!comes_before(m->heap[child], moving))
			break;
		m->heap[at] = m->heap[child];
	}
	m->heap[at] = moving;
}

static void add_runs(struct merge *m, const model_part *p)
{
	uint64_t from = 0;
	for (uint64_t i = 0; i < p->runs; from = p->run_end[i++]) {
		const struct part_point *first = p->points + from, *end = p->points + p->run_end[i];
		m->all[m->all_runs] = (struct run){ .next = first,
			.stop = first,
			.end = end,
			.kept = first,
			.next_sum = from / MODEL_PART_SUM_POINTS,
			.part = p,
			.order = (uint32_t)m->all_runs };
		m->all_runs++;
	}
}

static void merge_init(
	struct merge *m, model_part *const *part, size_t parts, uint64_t memory_bytes)
{
	size_t runs = 0;
	for (size_t i = 0; i < parts; i++)
		runs += part[i]->runs;
	m->all = g_new(struct run, runs + 1);
	m->heap = g_new(struct run *, runs + 1);
	m->window_points = CLAMP(memory_bytes / 4 / (runs + 1), WINDOW_MIN, WINDOW_BYTES) /
			   sizeof(struct part_point);
	for (size_t i = 0; i < parts; i++)
		add_runs(m, part[i]);
}

static void merge_clear(struct merge *m)
{
	g_free(m->all);
	g_free(m->heap);
	model_thin_free(m->thin);
}

static void forget(struct run *r, size_t least_points)
{
	size_t passed = (size_t)(r->next - r->kept);
	if (passed < least_points)
		return;
	model_part_forget(r->part, r->kept, passed);
	r->kept = r->next;
}

/* From next on to a point that stays, checking what it passes. */
static bool settle(const struct merge *m, struct run *r, GError **error)
{
	for (; r->next < r->stop; r->next++) {
		uint64_t i = (uint64_t)(r->next - r->part->points), sum = i / MODEL_PART_SUM_POINTS;
		if (sum >= r->next_sum) {
			if (!model_part_verify_points(r->part, sum, error) ||
				!model_part_verify_cells(r->part, sum, error))
				return false;
			r->next_sum = sum + 1;
			forget(r, m->window_points);
		}
		if (!model_part_is_dropped(r->part, i))
			break;
	}
	return true;
}

/* Goes on to the next point of the run on top. */
static bool advance(struct merge *m, GError **error)
{
	struct run *top = m->heap[0];
	top->next++;
	if (!settle(m, top, error))
		return false;
	if (top->next == top->stop)
		m->heap[0] = m->heap[--m->runs];
	if (m->runs)
		sift_down(m, 0);
	return true;
}

/* The first point that is not before the limit. Looks close by first: ranges follow each other. */
static const struct part_point *find_from(
	const struct part_point *from, const struct part_point *end, const struct part_point *limit)
{
	size_t low = 0, count = (size_t)(end - from), step = 1;
	while (step < count && part_point_compare(&from[step - 1], limit) < 0) {
		low = step;
		step *= 2;
	}
	for (size_t high = MIN(step, count); low < high;) {
		size_t middle = low + (high - low) / 2;
		if (part_point_compare(&from[middle], limit) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return from + low;
}

/* NULL: from the begin, to the end. */
static bool enter_range(struct merge *m, const struct part_point *first,
	const struct part_point *limit, GError **error)
{
	m->runs = 0;
	for (size_t i = 0; i < m->all_runs; i++) {
		struct run *r = &m->all[i];
		r->next = first ? find_from(r->next, r->end, first) : r->next;
		r->stop = limit ? find_from(r->next, r->end, limit) : r->end;
		/* Where it was searched too. */
		model_part_forget(r->part, r->kept, (size_t)(r->end - r->kept));
		r->kept = r->next;
		if (!settle(m, r, error))
			return false;
		if (r->next < r->stop)
			m->heap[m->runs++] = r;
	}
	for (size_t i = m->runs / 2; i--;)
		sift_down(m, i);
	return true;
}

static bool take_step(struct merge *m, GError **error)
{
	if (m->done < m->next_step)
		return true;
	m->next_step = m->done + STEP_POINTS;
	double fraction = (double)m->done / (double)MAX(m->total, 1);
	return build_progress_step(m->progress, fmin(fraction, 1), "merging the points", error);
}

static bool merge_range(struct merge *m, const struct part_point *first,
	const struct part_point *limit, GError **error)
{
	if (!enter_range(m, first, limit, error))
		return false;
	while (m->runs) {
		const struct run *top = m->heap[0];
		uint16_t scan = (uint16_t)top->part->scan;
		if (!take_step(m, error) ||
			!(m->thin ? model_thin_add(m->thin, top->next, scan, error)
				  : model_writer_add(m->to, top->next, scan, error)) ||
			!advance(m, error))
			return false;
		m->done++;
	}
	return !m->thin || model_thin_flush(m->thin, error);
}

/* ---- what stays ---- */

static struct part_point begin_of(const struct model_piece *p)
{
	return (struct part_point){ .code = p->code, .leaf = (uint16_t)p->leaf };
}

/* *ret_taken: false when it is stale, or its points are damaged. */
static bool take_piece(
	struct merge *m, const model_stale *s, uint64_t i, bool *ret_taken, GError **error)
{
	uint64_t before = model_writer_count(m->to);
	*ret_taken = false;
	if (!take_step(m, error))
		return false;
	if (!s->is_stale[i] && !model_writer_take(m->to, s->was, &s->piece[i],
				       model_stale_end(s, i), ret_taken, error))
		return false;
	m->done += model_writer_count(m->to) - before;
	m->taken_over += model_writer_count(m->to) - before;
	return true;
}

/* Piece by piece; stale ones that follow each other are merged at once. */
static bool merge_stale(struct merge *m, const model_stale *s, GError **error)
{
	for (uint64_t i = 0, end; i < s->pieces; i = end) {
		bool is_taken;
		end = i + 1;
		if (!take_piece(m, s, i, &is_taken, error))
			return false;
		if (is_taken)
			continue;
		while (end < s->pieces && s->is_stale[end])
			end++;
		bool is_last = end == s->pieces;
		struct part_point first = begin_of(&s->piece[i]);
		struct part_point limit = is_last ? first : begin_of(&s->piece[end]);
		if (!merge_range(m, &first, is_last ? NULL : &limit, error))
			return false;
	}
	return true;
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

static uint64_t count_dropped(const model_part *p)
{
	uint64_t dropped = 0;
	for (uint64_t i = 0; i < p->words; i++)
		dropped += (uint64_t)__builtin_popcountll(p->dropped[i]);
	return dropped;
}

static bool write_model(struct merge *m, const char *path, model_part *const *part, size_t parts,
	unsigned level, const model_stale *stale, JsonObject *manifest_json, GError **error)
{
	g_autoptr(JsonObject) made = manifest_json;
	uint64_t measured = 0;
	g_autoptr(model_writer) w = m->to = model_writer_new(path, level, error);
	if (!w)
		return false;
	m->thin = thin_new(part, parts, w, level);
	for (size_t i = 0; i < parts; i++) {
		measured += part[i]->count;
		m->total += part[i]->count - MIN(part[i]->count, count_dropped(part[i]));
	}
	if (!(stale ? merge_stale(m, stale, error) : merge_range(m, NULL, NULL, error)))
		return false;
	m->points = model_writer_count(w);
	m->redundant = measured - m->points;
	json_object_set_int_member(made, "points", (gint64)m->points);
	json_object_set_int_member(made, "redundant", (gint64)m->redundant);
	return model_writer_finish(w, part, parts, g_steal_pointer(&made), error);
}

bool model_merge(const char *path, model_part *const *part, size_t parts, unsigned level,
	const model_stale *stale, JsonObject *manifest_json, const struct build_progress *progress,
	struct build_result *result, GError **error)
{
	struct merge m = { .progress = progress };
	merge_init(&m, part, parts, build_memory(progress->options));
	bool ok = write_model(&m, path, part, parts, level, stale, manifest_json, error);
	merge_clear(&m);
	result->points = m.points;
	result->redundant = m.redundant;
	result->points_taken_over = m.taken_over;
	return ok;
}
