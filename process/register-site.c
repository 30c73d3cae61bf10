#include "process/register-site.h"
#include "process/align-store.h"
#include "process/register-choose.h"
#include "process/scan-data.h"
#include <glib/gstdio.h>
#include <string.h>

/* Scans that nobody uses just now; a scan of any size takes some 20 MB. */
#define STORE_BYTES  ((uint64_t)1 << 30)
#define THREADS_MAX  8
#define AHEAD_MOST   8 /* scans */
#define SAVE_EACH_US (2 * G_USEC_PER_SEC)
#define WAIT_US      100000

struct work {
	site *site;
	scan_graph *graph;
	GArray *given;             /* of struct scan_given */
	GPtrArray *prints;         /* fingerprints, in the order of given */
	char *inputs, *unfinished; /* path of what was done so far */
	alikes *known;
	align_store *store;
	const struct register_options *options;
	/* Under the mutex while pairs are being aligned: */
	GMutex mutex;
	GCond changed;
	GError *error; /* the first */
	bool stop;
	uint32_t tried, pairs,
		ended; /* in all; of this round; of these, with or without a result */
	double fraction;
};

/* ---- what is there ---- */

static bool list_scans(const site *s, GArray **ret_given, GPtrArray **ret_prints, GError **error)
{
	g_autoptr(GArray) numbers = site_scans(s, error);
	if (!numbers)
		return false;
	*ret_given = g_array_new(FALSE, TRUE, sizeof(struct scan_given));
	*ret_prints = g_ptr_array_new_with_free_func(g_free);
	for (guint i = 0; i < numbers->len; i++) {
		uint32_t number = g_array_index(numbers, uint32_t, i);
		g_autoptr(scan_data) d = scan_data_peek(s, number, error);
		if (!d)
			return false;
		struct scan_given entry = { number, d->has_given_pose, d->given_pose };
		g_array_append_val(*ret_given, entry);
		g_ptr_array_add(*ret_prints, g_steal_pointer(&d->fingerprint));
	}
	return true;
}

/* A line for the method, then one for each scan. */
static char *describe_inputs(const GArray *given, const GPtrArray *prints)
{
	g_autofree char *method = align_inputs("", "", EDGE_AUTOMATIC);
	GString *text = g_string_new(method);
	for (guint i = 0; i < given->len; i++)
		g_string_append_printf(text, "\n%u=%.16s",
			g_array_index(given, struct scan_given, i).number,
			(const char *)prints->pdata[i]);
	return g_string_free(text, FALSE);
}

static bool has_scan(char **lines, const char *line, bool whole)
{
	size_t length = whole ? strlen(line) + 1 : (size_t)(strchrnul(line, '=') - line) + 1;
	for (char **l = lines + 1; *l; l++)
		if (strncmp(*l, line, length) == 0)
			return true;
	return false;
}

static char *tell_scan(const char *line, const char *what)
{
	return g_strdup_printf("scan %.*s %s", (int)(strchrnul(line, '=') - line), line, what);
}

/* In a few words; NULL: nothing. */
static char *what_changed(const char *before, const char *now)
{
	if (!before)
		return g_strdup("for the first time");
	g_auto(GStrv) old = g_strsplit(before, "\n", -1), new = g_strsplit(now, "\n", -1);
	if (!old[0] || strcmp(old[0], new[0]) != 0)
		return g_strdup("this version registers better");
	for (char **l = new + 1; *l; l++)
		if (!has_scan(old, *l, true))
			return tell_scan(*l, has_scan(old, *l, false) ? "has changed" : "is new");
	for (char **l = old + 1; *l; l++)
		if (!has_scan(new, *l, false))
			return tell_scan(*l, "is gone");
	return NULL;
}

bool register_site_is_due(const site *s, bool *ret_due, char **ret_why, GError **error)
{
	g_autoptr(GArray) given = NULL;
	g_autoptr(GPtrArray) prints = NULL;
	g_autoptr(scan_graph) g = scan_graph_load(s, error);
	if (!g || !list_scans(s, &given, &prints, error))
		return false;
	g_autofree char *inputs = describe_inputs(given, prints);
	*ret_why = given->len || g->edges->len ? what_changed(g->inputs, inputs) : NULL;
	*ret_due = *ret_why != NULL;
	return true;
}

/* ---- edges that stay ---- */

static guint index_of(const struct work *w, uint32_t number)
{
	guint i = 0;
	while (i < w->given->len && g_array_index(w->given, struct scan_given, i).number != number)
		i++;
	return i;
}

static bool is_current(const struct work *w, const struct edge *e)
{
	guint a = index_of(w, e->a), b = index_of(w, e->b);
	if (a == w->given->len || b == w->given->len)
		return false;
	if (e->decision != DECISION_NONE || e->origin == EDGE_PICKED)
		return true;
	g_autofree char *inputs = align_inputs(w->prints->pdata[a], w->prints->pdata[b], e->origin);
	return g_strcmp0(inputs, e->inputs) == 0;
}

static void drop_stale(struct work *w)
{
	GArray *edges = w->graph->edges;
	for (guint i = edges->len; i-- > 0;)
		if (!is_current(w, &g_array_index(edges, struct edge, i)))
			g_array_remove_index(edges, i);
}

/* What a run that was stopped or killed had found. A damaged file counts for nothing: all of it can be found again. */
static void take_unfinished(struct work *w)
{
	g_autoptr(scan_graph) before = scan_graph_load_file(w->unfinished, NULL);
	for (guint i = 0; before && i < before->edges->len; i++) {
		struct edge *e = &g_array_index(before->edges, struct edge, i);
		if (!is_current(w, e) || scan_graph_edge(w->graph, e->a, e->b))
			continue;
		struct edge copy = *e;
		copy.inputs = g_strdup(e->inputs);
		scan_graph_set_edge(w->graph, &copy);
	}
}

static bool save_unfinished(struct work *w, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(w->unfinished);
	return g_mkdir_with_parents(folder, 0777) == 0 &&
	       scan_graph_save_file(w->graph, w->unfinished, error);
}

/* ---- one pair ---- */

static const struct scan_given *given_of(const struct work *w, uint32_t number)
{
	return &g_array_index(w->given, struct scan_given, index_of(w, number));
}

/* Poses that came with the files are checked; where they do not hold, the scans themselves are asked. */
static bool align_given(const align_scan *a, const align_scan *b, const struct scan_given *at_a,
	const struct scan_given *at_b, struct edge *ret, GError **error)
{
	struct pose between = pose_between(&at_a->pose, &at_b->pose);
	struct edge found;
	if (!align_scans_check(a, b, &between, ret, error))
		return false;
	if (ret->verification.verdict != VERDICT_CONFLICT)
		return true;
	if (!align_scans(a, b, NULL, EDGE_AUTOMATIC, &found, error))
		return edge_clear(ret), false;
	bool better = found.verification.verdict == VERDICT_ACCEPTED;
	edge_clear(better ? ret : &found);
	if (better)
		*ret = found;
	return true;
}

static bool align_pair(
	struct work *w, const struct scan_pair *pair, struct edge *ret, GError **error)
{
	const struct scan_given *at_a = given_of(w, pair->a), *at_b = given_of(w, pair->b);
	const align_scan *a = align_store_get(w->store, pair->a, error);
	const align_scan *b = a ? align_store_get(w->store, pair->b, error) : NULL;
	bool good = false;
	if (a && b)
		good = at_a->has_pose && at_b->has_pose
			       ? align_given(a, b, at_a, at_b, ret, error)
			       : align_scans(a, b, NULL, EDGE_AUTOMATIC, ret, error);
	align_store_give_back(w->store, a);
	align_store_give_back(w->store, b);
	return good;
}

static bool is_over(struct work *w)
{
	g_mutex_lock(&w->mutex);
	bool is = w->stop || w->error;
	g_mutex_unlock(&w->mutex);
	return is;
}

static void run_pair(const struct scan_pair *pair, struct work *w)
{
	struct edge e = { 0 };
	GError *error = NULL;
	bool skip = is_over(w);
	bool good = !skip && align_pair(w, pair, &e, &error);
	g_mutex_lock(&w->mutex);
	if (good) {
		scan_graph_set_edge(w->graph, &e);
		w->tried++;
	} else if (error && !w->error)
		w->error = error;
	else
		g_clear_error(&error);
	w->ended++;
	g_cond_signal(&w->changed);
	g_mutex_unlock(&w->mutex);
}

/* ---- ahead of the pairs ---- */

/* Whatever is wrong with it is told by the pair that needs it. */
static void prepare(uint32_t number, struct work *w)
{
	if (!is_over(w))
		align_store_give_back(w->store, align_store_get(w->store, number, NULL));
}

/* A pair, or with the same number twice a scan that one will need. */
static void run_task(gpointer data, gpointer user_data)
{
	const struct scan_pair *task = data;
	if (task->a == task->b)
		prepare(task->a, user_data);
	else
		run_pair(task, user_data);
}

static void add_scan(GArray *scans, uint32_t number)
{
	struct scan_pair task = { number, number };
	for (guint i = 0; i < scans->len; i++)
		if (g_array_index(scans, struct scan_pair, i).a == number)
			return;
	g_array_append_val(scans, task);
}

/* Where there are more threads than pairs: the scans of these, and those that one of them may be tried with next, the last scanned first.
 * To prepare a scan takes longer than to align a pair. */
static GArray *scans_ahead(const struct work *w, const GArray *pairs, int threads)
{
	GArray *scans = g_array_new(FALSE, FALSE, sizeof(struct scan_pair));
	for (guint i = 0; (int)pairs->len < threads && i < pairs->len; i++) {
		const struct scan_pair *pair = &g_array_index(pairs, struct scan_pair, i);
		add_scan(scans, pair->b);
		add_scan(scans, pair->a);
		for (guint k = w->given->len; k-- > 0 && scans->len < AHEAD_MOST;) {
			uint32_t other = g_array_index(w->given, struct scan_given, k).number;
			if (other != pair->b && !scan_graph_edge(w->graph, other, pair->b))
				add_scan(scans, other);
		}
	}
	return scans;
}

/* ---- rounds ---- */

/* How many pairs there will be nobody knows before; three for each scan is usual. */
static bool tell_progress(struct work *w)
{
	const struct register_options *o = w->options;
	guint scans = w->given->len, all = scans * (scans - MIN(scans, 1)) / 2;
	double expected = MAX(MIN(all, 3 * scans), w->tried + w->pairs - w->ended);
	g_autofree char *doing = g_strdup_printf("pair %u", w->tried + 1);
	w->fraction = MAX(w->fraction, MIN(1, w->tried / MAX(expected, 1)));
	return !o || !o->progress || o->progress(w->fraction, doing, o->user_data);
}

/* With the mutex held. */
static void watch(struct work *w)
{
	gint64 saved_us = g_get_monotonic_time();
	uint32_t saved = w->tried;
	while (w->ended < w->pairs) {
		g_cond_wait_until(&w->changed, &w->mutex, g_get_monotonic_time() + WAIT_US);
		w->stop |= !tell_progress(w);
		gint64 now_us = g_get_monotonic_time();
		if (w->tried == saved || now_us < saved_us + SAVE_EACH_US)
			continue;
		if (!save_unfinished(w, w->error ? NULL : &w->error))
			w->stop = true;
		saved_us = now_us;
		saved = w->tried;
	}
}

static void run_round(struct work *w, GArray *pairs)
{
	int threads = (int)MIN(g_get_num_processors(), THREADS_MAX);
	GThreadPool *pool = g_thread_pool_new(run_task, w, threads, FALSE, NULL);
	g_autoptr(GArray) ahead = scans_ahead(w, pairs, threads);
	w->pairs = pairs->len;
	w->ended = 0;
	g_mutex_lock(&w->mutex);
	for (guint i = 0; i < pairs->len; i++)
		g_thread_pool_push(pool, &g_array_index(pairs, struct scan_pair, i), NULL);
	for (guint i = 0; i < ahead->len; i++)
		g_thread_pool_push(pool, &g_array_index(ahead, struct scan_pair, i), NULL);
	watch(w);
	g_mutex_unlock(&w->mutex);
	g_thread_pool_free(pool, FALSE, TRUE);
}

static void solve(struct work *w)
{
	scan_graph_solve(w->graph, (const struct scan_given *)w->given->data, w->given->len);
}

static void run_rounds(struct work *w)
{
	while (!w->stop && !w->error) {
		solve(w);
		g_autoptr(GArray) pairs = register_choose(
			w->graph, (const struct scan_given *)w->given->data, w->given->len);
		if (!pairs->len)
			return;
		run_round(w, pairs);
	}
}

/* ---- the whole ---- */

static char *describe_change(const struct work *w, const char *why)
{
	uint32_t used = 0, placed = 0;
	for (guint i = 0; i < w->graph->edges->len; i++)
		used += edge_is_used(&g_array_index(w->graph->edges, struct edge, i));
	for (guint i = 0; i < w->graph->scans->len; i++)
		placed += g_array_index(w->graph->scans, struct placed_scan, i).group > 0;
	return g_strdup_printf("registered (%s): %u of %u scans placed by %u of %u pairs",
		why ? why : "anew", placed, w->graph->scans->len, used, w->graph->edges->len);
}

static bool finish(struct work *w, GError **error)
{
	g_autoptr(scan_graph) before = scan_graph_load(w->site, error);
	if (!before)
		return false;
	g_autofree char *why = what_changed(before->inputs, w->inputs);
	g_autofree char *change = describe_change(w, why);
	g_free(w->graph->inputs);
	w->graph->inputs = g_steal_pointer(&w->inputs);
	if ((!before->revision || !scan_graph_equal(before, w->graph)) &&
		!scan_graph_save(w->graph, w->site, change, error))
		return false;
	g_remove(w->unfinished);
	return !w->tried ||
	       alikes_save(w->known, (char *const *)w->prints->pdata, w->prints->len, error);
}

static bool begin(struct work *w, GError **error)
{
	w->graph = scan_graph_load(w->site, error);
	if (!w->graph || !list_scans(w->site, &w->given, &w->prints, error))
		return false;
	w->inputs = describe_inputs(w->given, w->prints);
	w->unfinished = g_build_filename(site_path(w->site), "poses", ".unfinished.json", NULL);
	g_autofree char *method = align_inputs("", "", EDGE_AUTOMATIC);
	w->known = alikes_load(w->site, method);
	w->store = align_store_new(w->site, STORE_BYTES, w->known);
	drop_stale(w);
	take_unfinished(w);
	return true;
}

static void clear(struct work *w)
{
	scan_graph_free(w->graph);
	align_store_free(w->store);
	alikes_free(w->known);
	g_clear_pointer(&w->given, g_array_unref);
	g_clear_pointer(&w->prints, g_ptr_array_unref);
	g_free(w->inputs);
	g_free(w->unfinished);
	g_clear_error(&w->error);
	g_mutex_clear(&w->mutex);
	g_cond_clear(&w->changed);
}

static bool run(struct work *w, bool *ret_stopped, GError **error)
{
	if (!begin(w, error))
		return false;
	run_rounds(w);
	if ((w->stop || w->error) && w->tried)
		save_unfinished(w, w->error ? NULL : &w->error);
	if (w->error) {
		g_propagate_error(error, g_steal_pointer(&w->error));
		return false;
	}
	*ret_stopped = w->stop;
	solve(w);
	return w->stop || finish(w, error);
}

scan_graph *register_site(
	site *s, const struct register_options *options, bool *ret_stopped, GError **error)
{
	struct work w = { .site = s, .options = options };
	g_mutex_init(&w.mutex);
	g_cond_init(&w.changed);
	scan_graph *ret = run(&w, ret_stopped, error) ? g_steal_pointer(&w.graph) : NULL;
	clear(&w);
	return ret;
}
