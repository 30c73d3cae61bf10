/* Processing that is killed at any moment, again and again, by SIGKILL. What people made (scans, site.json) is never touched, no
 * poses are half-written, every run goes on from where the last one was cut, and what comes out is, byte for byte, what an
 * undisturbed run makes. */
#include "acquire/scan.h"
#include "process/build-model.h"
#include "process/model-look.h"
#include "process/model.h"
#include "process/scan-geometry.h"
#include "tests/commands.h"
#include "tests/simulated.h"

#ifdef __SANITIZE_ADDRESS__
#define KILLS 3 /* what is tested here is the disk, not the memory: a few under sanitizers do */
#else
#define KILLS 20 /* PLEINAIR_KILLS=100 for more */
#endif
#define STATIONS 2

static uint32_t kills_wanted(void)
{
	const char *text = g_getenv("PLEINAIR_KILLS");
	return text ? (uint32_t)g_ascii_strtoull(text, NULL, 10) : KILLS;
}

struct field {
	char *folder, *fresh, *undisturbed,
		*site; /* sites: scans only; processed in one go; the one that is cut */
	GRand *random;
	uint32_t kills, finished, looks;
};

static void scan_stations(const struct field *f)
{
	struct scan_options options = { .preset = preset_find("draft") };
	for (int station = 1; station <= STATIONS; station++) {
		struct scan_result result;
		uint32_t partial;
		g_autoptr(GError) error = NULL;
		g_autofree char *description = g_strdup_printf(
			"hall?seed=4&ares=360&camera=none&divergence_mrad=0&station=%d", station);
		simulated_scan(
			f->fresh, description, &options, NULL, NULL, &result, &partial, &error);
		g_assert_no_error(error);
	}
}

/* to: the last stage; NULL: all. */
static GPid start_process(const char *path, const char *to)
{
	g_autofree char *program = commands_program("pleinair-process");
	char *argv[] = { program, (char *)path, to ? "--to" : NULL, (char *)to, NULL };
	GPid pid;
	g_autoptr(GError) error = NULL;
	g_spawn_async(NULL, argv, NULL, G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_STDOUT_TO_DEV_NULL,
		commands_follow, NULL, &pid, &error);
	g_assert_no_error(error);
	return pid;
}

static double process_whole(const char *path)
{
	int64_t start_us = g_get_monotonic_time();
	int status;
	waitpid(start_process(path, NULL), &status, 0);
	g_assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
	return (double)(g_get_monotonic_time() - start_us) * 1e-6;
}

static char *snapshot_of(const char *of, const char *folder)
{
	g_autofree char *path = g_build_filename(of, folder, NULL);
	return commands_snapshot(path);
}

/* The graph reads, and says nothing that an undisturbed run does not say. */
static void check_graph(const struct field *f)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(f->site, &error), whole = site_open(f->undisturbed, &error);
	g_autoptr(scan_graph) g = scan_graph_load(s, &error), all = scan_graph_load(whole, &error);
	g_assert_no_error(error);
	for (guint i = 0; i < g->edges->len; i++) {
		const struct edge *e = &g_array_index(g->edges, struct edge, i),
				  *same = scan_graph_edge(all, e->a, e->b);
		g_assert_nonnull(same);
		g_assert_cmpint(e->verification.verdict, ==, same->verification.verdict);
		g_assert_cmpmem(&e->pose, sizeof e->pose, &same->pose, sizeof same->pose);
	}
}

static void check_products(const struct field *f)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(f->site, &error);
	g_autofree char *path = g_build_filename(f->site, "model", "points.model", NULL);
	for (uint32_t number = 1; number <= STATIONS; number++) {
		g_autofree char *file =
			g_strdup_printf("%s/geometry/%04u.geometry", f->site, number);
		g_autoptr(scan_geometry) g = g_file_test(file, G_FILE_TEST_EXISTS)
						     ? scan_geometry_open(s, number, &error)
						     : NULL;
		g_assert_no_error(error);
		g_assert_true(!g || product_verify(g->file, &error));
	}
	if (!g_file_test(path, G_FILE_TEST_EXISTS))
		return;
	g_autoptr(model) m = model_open(f->site, &error);
	g_assert_no_error(error);
	g_assert_true(model_verify(m, &error));
}

static void check_same(const struct field *f)
{
	static const char *const products[] = { "model/points.model" };
	for (size_t i = 0; i < G_N_ELEMENTS(products); i++) {
		g_autofree char *a = g_build_filename(f->site, products[i], NULL),
				*b = g_build_filename(f->undisturbed, products[i], NULL);
		commands_shell("cmp '%s' '%s' >&2", a, b);
	}
	g_autofree char *geometry = snapshot_of(f->site, "geometry"),
			*undisturbed = snapshot_of(f->undisturbed, "geometry");
	g_assert_cmpstr(geometry, ==, undisturbed);
}

static void start_over(struct field *f)
{
	commands_shell("rm -rf '%s' && cp -r '%s' '%s'", f->site, f->fresh, f->site);
}

static void process_and_kill(struct field *f, double longest_s)
{
	g_autofree char *before = snapshot_of(f->site, "scans");
	GPid pid = start_process(f->site, NULL);
	g_usleep((gulong)(g_rand_double_range(f->random, 0, longest_s) * G_USEC_PER_SEC));
	kill(pid, SIGKILL);
	int status;
	waitpid(pid, &status, 0);
	f->kills += WIFSIGNALED(status);
	g_assert_true(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
	g_autofree char *after = snapshot_of(f->site, "scans");
	g_assert_cmpstr(after, ==, before);
	check_graph(f);
	check_products(f);
	if (WIFSIGNALED(status))
		return;
	f->finished++;
	check_same(f);
	start_over(f);
}

/* A first look is whole or not there, and what is computed after it is the same. */
static void look_and_kill(struct field *f, double longest_s)
{
	g_autoptr(GError) error = NULL;
	GPid pid = start_process(f->site, "look");
	g_usleep((gulong)(g_rand_double_range(f->random, 0, longest_s) * G_USEC_PER_SEC));
	kill(pid, SIGKILL);
	int status;
	bool is_look;
	waitpid(pid, &status, 0);
	g_assert_true(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
	check_graph(f);
	check_products(f);
	g_autoptr(site) s = site_open(f->site, NULL);
	g_autoptr(model) m = model_look_open(s, &is_look, &error);
	if (!m)
		g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_assert_true(!m || model_verify(m, NULL));
	f->looks += is_look;
}

static void test_kills(void)
{
	struct field f = { .folder = simulated_folder(), .random = g_rand_new_with_seed(20261121) };
	f.fresh = g_build_filename(f.folder, "fresh", NULL);
	f.undisturbed = g_build_filename(f.folder, "undisturbed", NULL);
	f.site = g_build_filename(f.folder, "site", NULL);
	scan_stations(&f);
	commands_shell("cp -r '%s' '%s'", f.fresh, f.undisturbed);
	double whole_s = process_whole(f.undisturbed);
	start_over(&f);
	/* Moments anywhere in a run; other tests beside this one change its pace. */
	for (double longest_s = 1.1 * whole_s; f.kills < kills_wanted();) {
		uint32_t finished = f.finished;
		if (g_rand_boolean(f.random))
			look_and_kill(&f, longest_s);
		process_and_kill(&f, longest_s);
		longest_s *= f.finished > finished ? 0.9 : 1.01;
	}
	process_whole(f.site);
	check_same(&f);
	g_test_message("a run takes %.2f s; %u kills, %u runs ended in between; %u first looks",
		whole_s, f.kills, f.finished, f.looks);
	commands_shell("rm -rf '%s'", f.folder);
	g_rand_free(f.random);
	g_free(f.folder);
	g_free(f.fresh);
	g_free(f.undisturbed);
	g_free(f.site);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	g_test_add_func("/process/kills", test_kills);
	return g_test_run();
}
