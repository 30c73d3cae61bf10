/* A scan that is killed at any moment: 200 times SIGKILL, now and then with a torn last entry on
 * top. What was recorded before the cut is read back unchanged, no manifest is ever half-written,
 * and going on with it ends in a whole panorama. */
#include "acquire/scan.h"
#include "firmware-io/record.h"
#include "tests/simulated.h"
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef __SANITIZE_ADDRESS__
#define KILLS 40 /* what is tested here is the disk, not the memory: a few under sanitizers do */
#else
#define KILLS 200
#endif
#define DESCRIPTION "hall?seed=3&ares=360&camera=64x96&divergence_mrad=0"

struct field {
	char *folder, *site, *socket;
	GPid simulator;
	GRand *random;
	/* The record as it was after the last kill: its whole entries. */
	uint64_t whole_bytes, entries;
	char *hash;
	uint32_t kills, finished, torn, cut_in_write;
};

static void start_simulator(struct field *f)
{
	g_autofree char *program = g_build_filename(g_getenv("PLEINAIR_BIN"), "pleinair-sim", NULL);
	char *argv[] = { program, (char *)"--listen", f->socket, (char *)DESCRIPTION, NULL };
	g_autoptr(GError) error = NULL;
	g_spawn_async(
		NULL, argv, NULL, G_SPAWN_DO_NOT_REAP_CHILD, NULL, NULL, &f->simulator, &error);
	g_assert_no_error(error);
	for (int i = 0; i < 600 && !g_file_test(f->socket, G_FILE_TEST_EXISTS); i++)
		g_usleep(50000);
	g_assert_true(g_file_test(f->socket, G_FILE_TEST_EXISTS));
}

static GPid start_scan(const struct field *f, bool resume)
{
	g_autofree char *program =
		g_build_filename(g_getenv("PLEINAIR_BIN"), "pleinair-scan", NULL);
	g_autofree char *device = g_strconcat("sim:", f->socket, NULL);
	char *argv[] = { program, f->site, (char *)"--device", device, (char *)"--preset",
		(char *)"draft", resume ? (char *)"--resume" : NULL, NULL };
	GPid pid;
	g_autoptr(GError) error = NULL;
	g_spawn_async(NULL, argv, NULL,
		G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_STDOUT_TO_DEV_NULL | G_SPAWN_STDERR_TO_DEV_NULL,
		NULL, NULL, &pid, &error);
	g_assert_no_error(error);
	return pid;
}

static uint32_t find_partial(const struct field *f)
{
	uint32_t number = 0;
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(f->site, NULL);
	if (s)
		g_assert_true(site_find_partial(s, &number, &error));
	g_assert_no_error(error);
	return number;
}

/* Every manifest of the site reads; raw.rec is whole but for its end. */
static void check_manifests(const struct field *f)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *path = g_build_filename(f->site, "site.json", NULL);
	if (!g_file_test(path, G_FILE_TEST_EXISTS))
		return;
	g_autoptr(site) s = site_open(f->site, &error);
	g_assert_no_error(error);
	uint32_t partial = find_partial(f);
	if (partial) {
		g_autofree char *folder = site_partial_path(s, partial);
		g_autofree char *scan = g_build_filename(folder, "scan.json", NULL);
		g_autoptr(manifest) m = manifest_load(scan, SCAN_SCHEMA, &error);
		g_assert_no_error(error);
	}
	g_autoptr(GArray) scans = site_scans(s, &error);
	g_assert_no_error(error);
	for (guint i = 0; i < scans->len; i++) {
		g_autofree char *folder = site_scan_path(s, g_array_index(scans, uint32_t, i));
		g_autofree char *scan = g_build_filename(folder, "scan.json", NULL);
		g_autoptr(manifest) m = manifest_load(scan, SCAN_SCHEMA, &error);
		g_assert_no_error(error);
		g_assert_cmpstr(manifest_get_string(m, "state", NULL), ==, "complete");
	}
}

static char *hash_prefix(const char *path, uint64_t bytes)
{
	g_autoptr(GMappedFile) file = g_mapped_file_new(path, FALSE, NULL);
	g_assert_cmpuint(g_mapped_file_get_length(file), >=, bytes);
	return g_compute_checksum_for_data(
		G_CHECKSUM_SHA1, (const guchar *)g_mapped_file_get_contents(file), bytes);
}

/* Counts whole entries; their end in bytes. */
static enum record_result read_all(const char *path, uint64_t *ret_entries, uint64_t *ret_bytes)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(record_reader) r = record_open(path, &error);
	g_assert_no_error(error);
	struct record_entry e;
	enum record_result got;
	*ret_entries = 0;
	*ret_bytes = record_reader_position(r);
	while ((got = record_next(r, &e, &error)) == RECORD_ENTRY) {
		g_assert_cmpuint(e.sequence, ==, *ret_entries);
		++*ret_entries;
		*ret_bytes = record_reader_position(r);
	}
	g_assert_no_error(error);
	return got;
}

/* What the last kill left is still there, to the byte, and what came since is whole. */
static void check_record(struct field *f)
{
	uint32_t partial = find_partial(f);
	g_autofree char *raw = g_strdup_printf("%s/scans/.%04u.partial/raw.rec", f->site, partial);
	uint64_t entries, bytes;
	if (!partial || !g_file_test(raw, G_FILE_TEST_EXISTS)) {
		f->whole_bytes = f->entries = 0;
		return;
	}
	f->cut_in_write += read_all(raw, &entries, &bytes) == RECORD_CUT;
	g_assert_cmpuint(bytes, >=, f->whole_bytes);
	g_assert_cmpuint(entries, >=, f->entries);
	if (f->whole_bytes) {
		g_autofree char *now = hash_prefix(raw, f->whole_bytes);
		g_assert_cmpstr(now, ==, f->hash);
	}
	g_free(f->hash);
	f->hash = hash_prefix(raw, bytes);
	f->whole_bytes = bytes;
	f->entries = entries;
}

/* A power cut may leave half an entry, or an entry with holes: one in four kills gets such an end.
 */
static void tear(struct field *f)
{
	uint32_t partial = find_partial(f);
	g_autofree char *raw = g_strdup_printf("%s/scans/.%04u.partial/raw.rec", f->site, partial);
	if (!partial || !f->whole_bytes || g_rand_int_range(f->random, 0, 4))
		return;
	uint8_t half[300] = { 0xb8, 0x52, 0xcd, 0x3e, RECORD_LIDAR_IN, 0, 0, 0, 0x00, 0x40 };
	FILE *file = fopen(raw, "ab");
	g_assert_nonnull(file);
	fwrite(half, 1, g_rand_int_range(f->random, 1, sizeof half), file);
	fclose(file);
	f->torn++;
}

static void scan_and_kill(struct field *f, double longest_s)
{
	bool resume = find_partial(f) != 0;
	GPid pid = start_scan(f, resume);
	g_usleep((gulong)(g_rand_double_range(f->random, 0, longest_s) * G_USEC_PER_SEC));
	kill(pid, SIGKILL);
	int status;
	waitpid(pid, &status, 0);
	f->kills += WIFSIGNALED(status);
	f->finished += WIFEXITED(status) && WEXITSTATUS(status) == 0;
	/* A scan that ended by itself must have ended well: nothing else was wrong. */
	g_assert_true(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
	if (WIFEXITED(status))
		f->whole_bytes = f->entries = 0;
	check_manifests(f);
	check_record(f);
	tear(f);
}

/* How long an undisturbed scan takes here: kills fall evenly into that. */
static double measure(struct field *f)
{
	int64_t start_us = g_get_monotonic_time();
	int status;
	waitpid(start_scan(f, false), &status, 0);
	g_assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
	return (g_get_monotonic_time() - start_us) * 1e-6;
}

/* The first scan was not disturbed: the others must be as complete. */
static void check_all_scans(const struct field *f)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(f->site, &error);
	g_autoptr(GArray) scans = site_scans(s, &error);
	size_t empty_at_first = 0;
	g_assert_no_error(error);
	for (guint i = 0; i < scans->len; i++) {
		g_autoptr(panorama) p =
			scan_load(s, g_array_index(scans, uint32_t, i), true, &error);
		g_assert_no_error(error);
		struct panorama_counts n = panorama_count(p);
		empty_at_first = i ? empty_at_first : n.empty;
		g_assert_cmpuint(n.empty, <=, empty_at_first + p->desc.rows / 2);
	}
}

static void test_kills(void)
{
	struct field f = { .random = g_rand_new_with_seed(20261121) };
	f.folder = simulated_folder();
	f.site = g_build_filename(f.folder, "site", NULL);
	f.socket = g_build_filename(f.folder, "sim", NULL);
	start_simulator(&f);
	/* The first scan waits for the simulator's caches to fill. */
	double first_s = measure(&f), second_s = measure(&f), whole_s = MIN(first_s, second_s);
	/* Other tests come and go beside this one: the moments follow the pace of the scans. */
	for (double longest_s = 1.2 * whole_s; f.kills < KILLS;) {
		uint32_t finished = f.finished;
		scan_and_kill(&f, longest_s);
		longest_s *= f.finished > finished ? 0.9 : 1.01;
	}
	if (find_partial(&f)) {
		int status;
		waitpid(start_scan(&f, true), &status, 0);
		g_assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
	}
	check_manifests(&f);
	check_all_scans(&f);
	g_test_message("a scan takes %.2f s; %u kills, %u of them inside an entry, %u torn ends; "
		       "%u scans were finished in between",
		whole_s, f.kills, f.cut_in_write, f.torn, f.finished);
	g_assert_cmpuint(f.finished, >, 0);
	kill(f.simulator, SIGTERM);
	waitpid(f.simulator, NULL, 0);
	g_rand_free(f.random);
	g_free(f.hash);
	g_free(f.folder);
	g_free(f.site);
	g_free(f.socket);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	if (!g_getenv("PLEINAIR_BIN"))
		g_setenv("PLEINAIR_BIN", "build/bin", TRUE);
	g_test_add_func("/scan/two-hundred-kills", test_kills);
	return g_test_run();
}
