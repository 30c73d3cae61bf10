#include "process/bench-register.h"
#include "acquire/cli.h"
#include "process/bench-coarse.h"
#include "process/bench-table.h"
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>

/* A round: all sites of one seed. */
#define STATIONS       9
#define MOVED_STATIONS 3
#define FEW_STATIONS   5
#define NONE_A_ROUND   60
#define SITES          6
#define TRIALS_A_ROUND 230

struct work {
	const struct bench_register_options *o;
	const struct preset *preset;
	const char *folder;
	struct bench_site sites[SITES];
	GMutex mutex;
	GError *error;      /* the first */
	GArray *for_others; /* of struct bench_coarse_pair */
	uint32_t done;      /* sites or trials of this round */
	double fraction_before, fraction_each;
	const char *doing;
};

static bool is_stopped(struct work *w)
{
	g_mutex_lock(&w->mutex);
	bool stop = w->error != NULL || (w->o->stop && w->o->stop());
	g_mutex_unlock(&w->mutex);
	return stop;
}

static void count_done(struct work *w)
{
	g_mutex_lock(&w->mutex);
	w->done++;
	if (w->o->progress)
		w->o->progress(w->fraction_before + w->done * w->fraction_each, w->doing);
	g_mutex_unlock(&w->mutex);
}

static void make_site(gpointer data, gpointer user_data)
{
	struct work *w = user_data;
	g_autoptr(GError) error = NULL;
	if (is_stopped(w))
		return;
	if (!bench_site_make(data, w->folder, w->preset, w->o->stop, &error)) {
		g_mutex_lock(&w->mutex);
		if (!w->error)
			w->error = g_steal_pointer(&error);
		g_mutex_unlock(&w->mutex);
	}
	count_done(w);
}

static void run_trial(gpointer data, gpointer user_data)
{
	struct work *w = user_data;
	if (is_stopped(w))
		return;
	trial_run(data);
	count_done(w);
}

/* Runs func on each of the items, on all processors. */
static void run_all(struct work *w, GFunc func, void *items, size_t size, uint32_t count)
{
	GThreadPool *pool = g_thread_pool_new(func, w, (gint)g_get_num_processors(), FALSE, NULL);
	w->done = 0;
	for (uint32_t i = 0; i < count; i++)
		g_thread_pool_push(pool, (char *)items + i * size, NULL);
	g_thread_pool_free(pool, FALSE, TRUE);
}

static void name_sites(struct work *w, uint64_t seed)
{
	static const char *const scenes[] = { "court", "street", "bridge", "hall" };
	for (int i = 0; i < 4; i++)
		w->sites[i] = (struct bench_site){ .scene = scenes[i],
			.seed = seed,
			.stations = STATIONS,
			.moved_stations = MOVED_STATIONS };
	/* Another seed: else the walls would be those of the plain ones. */
	w->sites[4] = (struct bench_site){ .scene = "hall",
		.variant = "symmetric",
		.seed = seed + 500000,
		.stations = FEW_STATIONS };
	w->sites[5] = (struct bench_site){ .scene = "street",
		.variant = "repeated",
		.seed = seed + 500000,
		.stations = FEW_STATIONS };
}

static void remove_folder(const char *path)
{
	g_autoptr(GSubprocess) rm =
		g_subprocess_new(G_SUBPROCESS_FLAGS_NONE, NULL, "rm", "-rf", "--", path, NULL);
	if (rm)
		g_subprocess_wait(rm, NULL, NULL);
}

/* ---- programs of others ---- */

static void clear_pair(gpointer data)
{
	struct bench_coarse_pair *p = data;
	range_grid_free(p->a);
	range_grid_free(p->b);
}

/* Pairs that overlap as long as some are wanted; their sites are here yet. */
static bool take_for_others(struct work *w, const GArray *trials, GError **error)
{
	for (guint i = 0; i < trials->len && w->for_others->len < w->o->pairs_of_others; i++) {
		const struct trial *t = &g_array_index(trials, struct trial, i);
		const struct pair_result *r = &t->result;
		if (t->kind != TRIAL_OVERLAP)
			continue;
		struct bench_coarse_pair p = { .truth = pose_between(&t->a->truth, &t->b->truth),
			.ours_right = t->outcome == TRIAL_RIGHT || t->outcome == TRIAL_REFUSED,
			.ours_cpu_s = r->coarse_s + r->fine_s + r->verify_s };
		p.a = bench_site_grid(t->site_a, w->folder, w->preset, t->a, error);
		p.b = p.a ? bench_site_grid(t->site_b, w->folder, w->preset, t->b, error) : NULL;
		g_array_append_val(w->for_others, p);
		if (!p.b)
			return false;
	}
	return true;
}

static bool run_others(const struct work *w, JsonArray *json, GError **error)
{
	const GArray *pairs = w->for_others;
	return !pairs->len || bench_coarse((const struct bench_coarse_pair *)(void *)pairs->data,
				      pairs->len, json, error);
}

/* ---- rounds ---- */

/* One round's trials go to the table, without their sites. */
static bool run_round(struct work *w, uint32_t round, struct bench_table *table, GError **error)
{
	uint32_t left = w->o->trials - bench_table_count(table);
	uint64_t seed = w->o->seed + round;
	double share = fmin(1, (double)left / TRIALS_A_ROUND) * TRIALS_A_ROUND / w->o->trials;
	g_autoptr(GRand) chance = g_rand_new_with_seed((guint32)seed);
	w->fraction_before = (double)bench_table_count(table) / w->o->trials;
	w->fraction_each = 0.6 * share / SITES;
	w->doing = "scanning sites";
	name_sites(w, seed);
	run_all(w, make_site, w->sites, sizeof *w->sites, SITES);
	if (!w->error) {
		g_autoptr(GArray) trials = trials_list(w->sites, SITES, NONE_A_ROUND, chance);
		g_array_set_size(trials, MIN(trials->len, left));
		w->fraction_before += 0.6 * share;
		w->fraction_each = 0.4 * share / MAX(trials->len, 1);
		w->doing = "aligning pairs";
		run_all(w, run_trial, trials->data, sizeof(struct trial), trials->len);
		if (!is_stopped(w) && take_for_others(w, trials, &w->error))
			bench_table_add(table, trials);
		else if (!w->error)
			g_set_error(&w->error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
	}
	for (int i = 0; i < SITES; i++)
		bench_site_clear(&w->sites[i]);
	if (w->error)
		g_propagate_error(error, g_steal_pointer(&w->error));
	return !*error;
}

static bool run_rounds(struct work *w, struct bench_table *table, GError **error)
{
	for (uint32_t round = 0; bench_table_count(table) < w->o->trials; round++) {
		g_autofree char *name = g_strdup_printf("round-%u", round);
		g_autofree char *folder = g_build_filename(w->folder, name, NULL);
		const char *all = w->folder;
		if (!w->o->keep) {
			if (g_mkdir(folder, 0700) != 0) {
				g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED,
					"%s: cannot be made", folder);
				return false;
			}
			w->folder = folder;
		}
		GError *failed = NULL;
		bool good = run_round(w, round, table, &failed);
		w->folder = all;
		if (!w->o->keep)
			remove_folder(folder);
		if (!good) {
			g_propagate_error(error, failed);
			return false;
		}
	}
	return true;
}

bool bench_register(const struct bench_register_options *o, GError **error)
{
	struct work w = { .o = o, .preset = preset_find(o->preset), .folder = o->keep };
	g_autofree char *temporary = NULL;
	if (!o->keep && !(w.folder = temporary = g_dir_make_tmp("pleinair-bench-XXXXXX", error)))
		return false;
	if (o->keep && g_mkdir_with_parents(o->keep, 0777) != 0) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: cannot be made", o->keep);
		return false;
	}
	g_mutex_init(&w.mutex);
	w.for_others = g_array_new(FALSE, FALSE, sizeof(struct bench_coarse_pair));
	g_array_set_clear_func(w.for_others, clear_pair);
	struct bench_table *table = bench_table_new();
	bool good = run_rounds(&w, table, error);
	if (o->progress)
		o->progress(1, NULL);
	JsonArray *others = o->json ? json_array_new() : NULL;
	if (good && o->json)
		good = run_others(&w, others, error);
	if (good)
		bench_table_print(table, others);
	if (good && !o->json)
		good = run_others(&w, NULL, error);
	g_clear_pointer(&others, json_array_unref);
	if (o->keep && bench_table_count(table)) {
		g_autofree char *path = g_build_filename(o->keep, "trials.tsv", NULL);
		good = bench_table_save(table, path, good ? error : NULL) && good;
	}
	if (good && bench_table_wrong(table)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED,
			"%u wrong poses were accepted; none may be", bench_table_wrong(table));
		good = false;
	}
	bench_table_free(table);
	g_array_unref(w.for_others);
	if (temporary)
		remove_folder(temporary);
	g_mutex_clear(&w.mutex);
	return good;
}
