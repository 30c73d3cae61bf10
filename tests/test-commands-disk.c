/* Disks that are full, short of space or read-only: one sentence, and what was scanned stays. */
#include "tests/commands.h"
#include "tests/simulated.h"
#include <sys/mount.h>

#define SCAN(at) "scan", at, "--device", simulator.device, "--preset", "draft", "--json"

static char *folder;
static listener simulator;

static char *path_in(const char *name)
{
	return g_build_filename(folder, name, NULL);
}

/* A scan that stopped says why, and how to go on. */
static void assert_kept(const answer *a, const char *at, const char *why)
{
	g_assert_cmpint(a->status, ==, 1);
	g_assert_cmpstr(a->out, ==, "");
	g_auto(GStrv) lines = g_strsplit(a->err, "\n", -1);
	g_test_message("%s", a->err);
	g_assert_cmpuint(g_strv_length(lines), ==, 3);
	g_assert_nonnull(strstr(lines[0], "raw.rec: "));
	g_assert_nonnull(strstr(lines[0], why));
	g_assert_nonnull(strstr(lines[1], "--resume"));
	g_autofree char *names = commands_names(at);
	g_assert_cmpstr(names, ==,
		"scans/ scans/.0001.partial/ scans/.0001.partial/raw.rec "
		"scans/.0001.partial/scan.json site.json");
}

static void assert_resumes(const char *at)
{
	g_auto(answer) a = commands_run("scan", at, "--resume", "--json");
	commands_assert_done(&a);
	g_auto(answer) b = commands_run("panoramas", at, "--verify");
	commands_assert_done(&b);
}

static void test_file_limit(void)
{
	const struct surroundings limited = { .file_bytes_max = 900000 };
	g_autofree char *at = path_in("limited");
	const char *arguments[] = { SCAN(at), NULL };
	g_auto(answer) a = commands_run_in(&limited, arguments);
	assert_kept(&a, at, "File too large");
	assert_resumes(at);
}

/* The planes of a finished scan stay when there is no room to develop it again. */
static void test_develop_without_room(void)
{
	const struct surroundings limited = { .file_bytes_max = 100000 };
	g_autofree char *at = path_in("developed");
	g_auto(answer) a = commands_run(SCAN(at));
	commands_assert_done(&a);
	g_autofree char *before = commands_snapshot(at);
	const char *arguments[] = { "panoramas", at, "--develop", NULL };
	g_auto(answer) b = commands_run_in(&limited, arguments);
	commands_assert_refused(&b, 1, ".tiff: ");
	g_autofree char *after = commands_snapshot(at);
	g_assert_cmpstr(before, ==, after);
}

/* ---- small disks ---- */

/* A disk of so many bytes at folder/disk; false and a skip where this user may not mount. */
static bool mount_disk(const char *at, const char *size)
{
	g_assert_cmpint(g_mkdir_with_parents(at, 0777), ==, 0);
	if (mount("tmpfs", at, "tmpfs", 0, size) == 0)
		return true;
	g_autofree char *why = g_strdup_printf("cannot mount a small disk: %s", g_strerror(errno));
	g_test_skip(why);
	return false;
}

static void test_short_of_space(void)
{
	g_autofree char *disk = path_in("short"), *at = g_build_filename(disk, "site", NULL);
	if (!mount_disk(disk, "size=20m"))
		return;
	g_auto(answer) a = commands_run(SCAN(at));
	commands_assert_refused(&a, 1, "not enough space");
	g_autofree char *names = commands_names(disk);
	g_assert_cmpstr(names, ==, "");
	g_assert_cmpint(umount2(disk, MNT_DETACH), ==, 0);
}

/* Something else fills the disk while the scan runs. */
static void test_full_disk(void)
{
	g_autofree char *disk = path_in("full"), *at = g_build_filename(disk, "site", NULL);
	g_autofree char *raw = g_build_filename(at, "scans", ".0001.partial", "raw.rec", NULL);
	if (!mount_disk(disk, "size=60m"))
		return;
	const char *arguments[] = { SCAN(at), NULL };
	running r = commands_start(arguments);
	commands_wait_for_size(raw, 700000);
	kill(r.pid, SIGSTOP);
	commands_shell("dd if=/dev/zero of='%s/else' bs=4k 2>/dev/null || true", disk);
	kill(r.pid, SIGCONT);
	g_auto(answer) a = commands_end(&r);
	assert_kept(&a, at, "the disk is full");
	commands_shell("rm '%s/else'", disk);
	assert_resumes(at);
	g_assert_cmpint(umount2(disk, MNT_DETACH), ==, 0);
}

/* ---- without rights ---- */

static const struct surroundings nobody = { .nobody = true };

/* A checkout in somebody's home is closed to others: they get copies of what they run. */
static void open_programs_to_all(void)
{
	g_autofree char *bin = g_build_filename(folder, "bin", NULL);
	g_autofree char *known =
		g_build_filename(g_getenv("PLEINAIR_SOURCE") ?: ".", "tests", "lsan.supp", NULL);
	g_autofree char *leaks =
		g_strdup_printf("suppressions=%s/lsan.supp:print_suppressions=0", bin);
	commands_shell("mkdir '%s'; cp '%s'/pleinair* '%s' '%s'", bin, g_getenv("PLEINAIR_BIN"),
		known, bin);
	commands_shell("chmod -R a+rX '%s'", bin);
	g_setenv("PLEINAIR_BIN", bin, TRUE);
	g_setenv("LSAN_OPTIONS", leaks, TRUE);
}

static bool can_be_nobody(void)
{
	open_programs_to_all();
	const char *arguments[] = { "--version", NULL };
	g_auto(answer) a = commands_run_in(&nobody, arguments);
	if (a.status)
		g_test_skip("another user cannot run the programs here");
	return a.status == 0;
}

static void refuse_as_nobody(const char *at, const char *names, const char *const *arguments)
{
	g_autofree char *before = commands_snapshot(at);
	g_auto(answer) a = commands_run_in(&nobody, arguments);
	commands_assert_refused(&a, 1, names);
	g_autofree char *after = commands_snapshot(at);
	g_assert_cmpstr(before, ==, after);
}

static void test_read_only(void)
{
	if (!can_be_nobody())
		return;
	g_autofree char *at = path_in("read-only"), *out = path_in("out"),
			*raw = g_build_filename(at, "scans", "0001", "raw.rec", NULL);
	g_auto(answer) a = commands_run(SCAN(at));
	commands_assert_done(&a);
	commands_shell("chmod -R a+rX,a-w '%s'; mkdir '%s'; chmod 777 '%s'", at, out, out);
	refuse_as_nobody(at, "read-only: ", (const char *[]){ SCAN(at), NULL });
	refuse_as_nobody(at, "read-only: ", (const char *[]){ "scan", at, "--discard", NULL });
	refuse_as_nobody(at, "read-only: ", (const char *[]){ "panoramas", at, "--develop", NULL });
	refuse_as_nobody(at, "exports", (const char *[]){ "panoramas", at, NULL });
	/* To look at a site nobody needs to write in it. */
	g_auto(answer) b = commands_run_in(
		&nobody, (const char *[]){ "panoramas", at, "--verify", "-o", out, NULL });
	commands_assert_done(&b);
	g_assert_cmpint(g_chmod(raw, 0), ==, 0);
	refuse_as_nobody(
		at, "raw.rec: ", (const char *[]){ "panoramas", at, "--verify", "-o", out, NULL });
	commands_shell("chmod -R u+w '%s'", at);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	folder = simulated_folder();
	g_assert_cmpint(g_chmod(folder, 0755), ==, 0);
	simulator = commands_listen(folder, COMMANDS_SCENE);
	g_assert_cmpint(g_chmod(simulator.socket, 0777), ==, 0);
	g_test_add_func("/disk/file-limit", test_file_limit);
	g_test_add_func("/disk/develop-without-room", test_develop_without_room);
	g_test_add_func("/disk/short-of-space", test_short_of_space);
	g_test_add_func("/disk/full", test_full_disk);
	g_test_add_func("/disk/read-only", test_read_only);
	int status = g_test_run();
	listener_clear(&simulator);
	g_free(folder);
	return status;
}
