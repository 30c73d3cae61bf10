/* Site folders: made, locked, filled, and left half-way at every point. */
#include "acquire/site.h"
#include "firmware-io/files.h"
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { KILLS = 200 };

struct folder {
	char *path, *oak; /* a folder, and a site in it that is not yet made */
};

static void set_up(struct folder *f, gconstpointer data)
{
	(void)data;
	f->path = g_dir_make_tmp("site-XXXXXX", NULL);
	f->oak = g_build_filename(f->path, "oak", NULL);
}

static void tear_down(struct folder *f, gconstpointer data)
{
	(void)data;
	g_assert_true(files_remove_tree(f->path, NULL));
	g_free(f->oak);
	g_free(f->path);
}

static site *open_for_writing(const char *path)
{
	g_autoptr(GError) error = NULL;
	site *s = site_open_for_writing(path, &error);
	g_assert_no_error(error);
	return s;
}

static bool there(const struct folder *f, const char *name)
{
	g_autofree char *path = g_build_filename(f->oak, name, NULL);
	return g_file_test(path, G_FILE_TEST_EXISTS);
}

static void put_file(const struct folder *f, const char *name, const char *text)
{
	g_autofree char *path = g_build_filename(f->oak, name, NULL);
	g_autofree char *parent = g_path_get_dirname(path);
	g_assert_cmpint(g_mkdir_with_parents(parent, 0777), ==, 0);
	g_assert_true(g_file_set_contents(path, text, -1, NULL));
}

static void put_folder(const struct folder *f, const char *name)
{
	g_autofree char *path = g_build_filename(f->oak, name, NULL);
	g_assert_cmpint(g_mkdir_with_parents(path, 0777), ==, 0);
}

static uint32_t begin(site *s)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(manifest) scan = manifest_new("scan.json");
	manifest_set_int(scan, "schema", 1);
	uint32_t number = 0;
	g_assert_true(site_begin_scan(s, scan, &number, &error));
	g_assert_no_error(error);
	return number;
}

static uint32_t partial_of(const site *s)
{
	g_autoptr(GError) error = NULL;
	uint32_t number = 42;
	g_assert_true(site_find_partial(s, &number, &error));
	return number;
}

static void assert_ends(GError **error, const char *sentence)
{
	g_assert_nonnull(*error);
	if (!g_str_has_suffix((*error)->message, sentence))
		g_assert_cmpstr((*error)->message, ==, sentence);
	g_clear_error(error);
}

static void test_made(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_autofree char *with_slash = g_strconcat(f->oak, "/", NULL);
	g_autoptr(site) s = open_for_writing(with_slash);
	const manifest *m = site_manifest(s);
	const char *created = manifest_get_string(m, "created", NULL);
	g_assert_cmpstr(manifest_get_string(m, "name", NULL), ==, "oak");
	g_assert_cmpstr(manifest_get_string(m, "units", NULL), ==, "metres");
	g_assert_true(g_uuid_string_is_valid(manifest_get_string(m, "id", NULL)));
	g_autoptr(GDateTime) time = g_date_time_new_from_iso8601(created, NULL);
	g_autoptr(GDateTime) now = g_date_time_new_now_utc();
	g_assert_true(g_str_has_suffix(created, "Z"));
	g_assert_cmpint(ABS(g_date_time_difference(now, time)), <, 60 * G_TIME_SPAN_SECOND);
	g_autofree char *id = g_strdup(manifest_get_string(m, "id", NULL));
	g_clear_pointer(&s, site_free);

	s = open_for_writing(f->oak);
	g_assert_cmpstr(manifest_get_string(site_manifest(s), "id", NULL), ==, id);
	g_autoptr(site) reader = site_open(f->oak, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(site_path(reader), ==, f->oak);
}

static void test_refused(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_assert_null(site_open(f->oak, &error));
	assert_ends(&error, "oak: cannot open the folder: No such file or directory");
	g_autofree char *far = g_build_filename(f->oak, "a", "b", NULL);
	g_assert_null(site_open_for_writing(far, &error));
	assert_ends(&error, "oak/a/b: cannot make the folder: No such file or directory");
	put_file(f, "holiday.jpg", "x");
	g_assert_null(site_open(f->oak, &error));
	assert_ends(&error, "oak: is not a site: there is no site.json in it");
	g_assert_null(site_open_for_writing(f->oak, &error));
	assert_ends(&error, "oak: is not a site: it has files but no site.json");
	g_autoptr(GPtrArray) names = files_names(f->oak, NULL);
	g_assert_cmpuint(names->len, ==, 1);
	g_autofree char *file = g_build_filename(f->oak, "holiday.jpg", NULL);
	g_assert_null(site_open_for_writing(file, &error));
	assert_ends(&error, "holiday.jpg: cannot open the folder: Not a directory");
}

static void test_bad_manifest(struct folder *f, gconstpointer data)
{
	(void)data;
	static const char *const cases[][2] = {
		{ "", "oak/site.json: is empty" },
		{ "{", "oak/site.json: line 1, column 2: a text in quotation marks is expected "
		       "here" },
		{ "{\"schema\":9}", "oak/site.json: was written by a later version (schema 9; this "
				    "program knows 1)" },
		{ "{\"schema\":1}", "oak/site.json: 'units' is missing" },
		{ "{\"schema\":1,\"units\":\"metres\",\"name\":\"oak\"}",
			"oak/site.json: 'id' is missing" },
		{ "{\"schema\":1,\"units\":\"feet\",\"name\":\"\",\"id\":\"\",\"created\":\"\"}",
			"oak/site.json: 'units' is \"feet\"; this program knows \"metres\"" },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
		g_autoptr(GError) reading = NULL, writing = NULL;
		put_file(f, "site.json", cases[i][0]);
		g_assert_null(site_open(f->oak, &reading));
		assert_ends(&reading, cases[i][1]);
		g_assert_null(site_open_for_writing(f->oak, &writing));
		assert_ends(&writing, cases[i][1]);
		g_assert_false(there(f, "scans"));
	}
}

/* What a killed maker leaves is made into a site; what has a scan in it is not. */
static void test_half_made(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	put_folder(f, "scans");
	put_folder(f, "lost+found");
	put_file(f, ".site.json.new", "{\"sche");
	g_autoptr(site) s = open_for_writing(f->oak);
	g_assert_false(there(f, ".site.json.new"));
	g_clear_pointer(&s, site_free);
	put_file(f, "scans/0001/scan.json", "{}");
	g_autofree char *manifest_file = g_build_filename(f->oak, "site.json", NULL);
	g_remove(manifest_file);
	g_assert_null(site_open_for_writing(f->oak, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_EMPTY);
}

static void test_scans(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = open_for_writing(f->oak);
	g_autoptr(GArray) none = site_scans(s, &error);
	g_assert_cmpuint(none->len, ==, 0);
	g_assert_cmpuint(partial_of(s), ==, 0);
	for (uint32_t i = 1; i <= 3; i++) {
		g_assert_cmpuint(begin(s), ==, i);
		g_assert_cmpuint(partial_of(s), ==, i);
		g_autofree char *partial = site_partial_path(s, i);
		g_autofree char *json = g_build_filename(partial, "scan.json", NULL);
		g_autoptr(manifest) m = manifest_load(json, 1, &error);
		g_assert_no_error(error);
		g_assert_nonnull(m);
		g_assert_true(site_finish_scan(s, i, &error));
		g_autofree char *whole = site_scan_path(s, i);
		g_assert_true(g_file_test(whole, G_FILE_TEST_IS_DIR));
	}
	g_autoptr(GArray) scans = site_scans(s, &error);
	g_assert_cmpuint(scans->len, ==, 3);
	for (uint32_t i = 0; i < 3; i++)
		g_assert_cmpuint(g_array_index(scans, uint32_t, i), ==, i + 1);
	g_autoptr(GPtrArray) names = files_names(f->oak, NULL);
	g_assert_cmpuint(names->len, ==, 2);
}

static void test_unfinished(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = open_for_writing(f->oak);
	g_autoptr(manifest) scan = manifest_new("scan.json");
	uint32_t number = begin(s), other = 42;
	g_assert_false(site_begin_scan(s, scan, &other, &error));
	g_assert_cmpstr(error->message, ==,
		"site oak: scan 0001 is not finished; resume or discard it first");
	g_clear_error(&error);
	put_file(f, "scans/0001/scan.json", "{}");
	g_assert_false(site_finish_scan(s, number, &error));
	assert_ends(&error, "oak/scans/0001: exists already");
	g_assert_false(site_finish_scan(s, 7, &error));
	assert_ends(&error, "oak/scans/.0007.partial: is not a scan's folder");
	put_file(f, "scans/.0002.partial/scan.json", "{}");
	g_assert_false(site_find_partial(s, &other, &error));
	g_assert_cmpstr(error->message, ==,
		"site oak: scans 0001 and 0002 are both partial; there can be one");
	g_assert_cmpuint(other, ==, 42);
}

static void test_discard(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = open_for_writing(f->oak);
	put_file(f, "precious.txt", "x");
	g_assert_cmpuint(begin(s), ==, 1);
	put_file(f, "scans/.0001.partial/range.tiff/a/b/c", "x");
	g_autofree char *link = g_build_filename(f->oak, "scans/.0001.partial/link", NULL);
	g_autofree char *file_link = g_build_filename(f->oak, "scans/.0001.partial/a", NULL);
	g_assert_cmpint(symlink(f->oak, link), ==, 0);
	g_assert_cmpint(symlink("../../precious.txt", file_link), ==, 0);
	put_file(f, "scans/.0001.discarded/raw.rec", "from an earlier one");
	g_assert_true(site_discard_partial(s, 1, &error));
	g_assert_no_error(error);
	g_autofree char *scans = g_build_filename(f->oak, "scans", NULL);
	g_autoptr(GPtrArray) names = files_names(scans, NULL);
	g_assert_cmpuint(names->len, ==, 0);
	g_assert_true(there(f, "precious.txt"));
	g_assert_false(site_discard_partial(s, 1, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_assert_cmpuint(begin(s), ==, 1);
}

static const char *const foreign[] = { "0000", "3", "00003", "0004 (copy)", "000x", ".DS_Store",
	".0005.partial.bak", ".0006.new.", ".0006.new.abcdefg", "readme.txt" };
static const char *const remains[] = { ".0007.new.AbCdEf", ".0008.discarded" };

static void test_names(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = open_for_writing(f->oak);
	for (size_t i = 0; i < G_N_ELEMENTS(foreign); i++) {
		g_autofree char *name = g_build_filename("scans", foreign[i], "x", NULL);
		put_file(f, name, "x");
	}
	for (size_t i = 0; i < G_N_ELEMENTS(remains); i++) {
		g_autofree char *name = g_build_filename("scans", remains[i], "x", NULL);
		put_file(f, name, "x");
	}
	g_clear_pointer(&s, site_free);
	s = open_for_writing(f->oak);
	g_autofree char *scans_path = g_build_filename(f->oak, "scans", NULL);
	g_autoptr(GPtrArray) names = files_names(scans_path, NULL);
	g_assert_cmpuint(names->len, ==, G_N_ELEMENTS(foreign));
	g_autoptr(GArray) scans = site_scans(s, &error);
	g_assert_cmpuint(scans->len, ==, 0);
	g_assert_cmpuint(partial_of(s), ==, 0);

	put_folder(f, "scans/0009");
	g_assert_null(site_scans(s, &error));
	assert_ends(&error, "oak/scans/0009: is not a scan: there is no scan.json in it");
	put_file(f, "scans/0009/scan.json", "{}");
	put_file(f, "scans/0010", "x");
	g_assert_null(site_scans(s, &error));
	assert_ends(&error, "oak/scans/0010: is not a scan's folder");
	g_assert_cmpuint(begin(s), ==, 11);
}

static void test_last_number(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = open_for_writing(f->oak);
	g_autoptr(manifest) scan = manifest_new("scan.json");
	uint32_t number;
	put_file(f, "scans/9998/scan.json", "{}");
	g_assert_cmpuint(begin(s), ==, 9999);
	g_assert_true(site_finish_scan(s, 9999, NULL));
	g_assert_false(site_begin_scan(s, scan, &number, &error));
	g_assert_cmpstr(error->message, ==, "site oak: has a scan 9999, and numbers end there");
}

static void test_lock(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	int ready[2], status;
	g_assert_cmpint(pipe(ready), ==, 0);
	pid_t child = fork();
	if (child == 0) {
		alarm(60); /* should the parent end first */
		site *s = site_open_for_writing(f->oak, NULL);
		g_assert_cmpint(write(ready[1], s ? "y" : "n", 1), ==, 1);
		pause();
	}
	char answer;
	g_assert_cmpint(read(ready[0], &answer, 1), ==, 1);
	g_assert_cmpint(answer, ==, 'y');
	g_assert_null(site_open_for_writing(f->oak, &error));
	g_assert_cmpstr(error->message, ==, "site oak: another program is writing to it");
	g_autoptr(site) reader = site_open(f->oak, NULL);
	g_assert_nonnull(reader);
	kill(child, SIGKILL);
	g_assert_cmpint(waitpid(child, &status, 0), ==, child);
	g_autoptr(site) writer = open_for_writing(f->oak);
	g_assert_nonnull(writer);
	g_assert_null(site_open_for_writing(f->oak, NULL));
	close(ready[0]);
	close(ready[1]);
}

static void test_read_only(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	if (geteuid() == 0) {
		g_test_skip("root can write everywhere");
		return;
	}
	put_folder(f, ".");
	g_assert_cmpint(g_chmod(f->oak, 0500), ==, 0);
	g_assert_null(site_open_for_writing(f->oak, &error));
	assert_ends(&error, "oak: cannot write in the folder: Permission denied");
	g_assert_cmpint(g_chmod(f->oak, 0700), ==, 0);
}

/* Begins, finishes and discards scans in turn. */
static void scan_until_killed(const char *path)
{
	alarm(60); /* should the parent end first */
	site *s = site_open_for_writing(path, NULL);
	g_autoptr(manifest) scan = manifest_new("scan.json");
	manifest_set_int(scan, "schema", 1);
	uint32_t number = 0;
	if (!s || !site_find_partial(s, &number, NULL))
		_exit(1);
	for (int i = 0;; i++) {
		if (number && (i % 3 ? !site_finish_scan(s, number, NULL)
				     : !site_discard_partial(s, number, NULL)))
			_exit(1);
		if (!site_begin_scan(s, scan, &number, NULL))
			_exit(1);
	}
}

/* Whatever a kill leaves is a site whose scans are whole, or nothing yet. */
static void check_after_kill(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = open_for_writing(path);
	g_autoptr(GArray) scans = site_scans(s, &error);
	g_assert_no_error(error);
	uint32_t last = scans->len ? g_array_index(scans, uint32_t, scans->len - 1) : 0;
	g_assert_cmpuint(last, ==, scans->len);
	uint32_t partial = partial_of(s);
	g_assert_true(partial == 0 || partial == last + 1);
	for (uint32_t i = 1; i <= scans->len + (partial > 0); i++) {
		g_autofree char *folder = i > last ? site_partial_path(s, i) : site_scan_path(s, i);
		g_autofree char *json = g_build_filename(folder, "scan.json", NULL);
		g_autoptr(manifest) m = manifest_load(json, 1, &error);
		g_assert_no_error(error);
		g_assert_nonnull(m);
	}
	g_autofree char *scans_path = g_build_filename(path, "scans", NULL);
	g_autoptr(GPtrArray) names = files_names(scans_path, NULL);
	g_assert_cmpuint(names->len, ==, scans->len + (partial > 0));
}

static void test_kills(struct folder *f, gconstpointer data)
{
	(void)data;
	for (int i = 0; i < KILLS; i++) {
		int status;
		if (i % 10 == 0) /* making the site is to be killed as well */
			g_assert_true(files_remove_tree(f->oak, NULL));
		pid_t child = fork();
		if (child == 0)
			scan_until_killed(f->oak);
		g_usleep((gulong)g_test_rand_int_range(0, i % 10 ? 20000 : 3000));
		kill(child, SIGKILL);
		g_assert_cmpint(waitpid(child, &status, 0), ==, child);
		g_assert_true(WIFSIGNALED(status));
		check_after_kill(f->oak);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
#define ADD(name, test) g_test_add("/site/" name, struct folder, NULL, set_up, test, tear_down)
	ADD("made", test_made);
	ADD("refused", test_refused);
	ADD("bad-manifest", test_bad_manifest);
	ADD("half-made", test_half_made);
	ADD("scans", test_scans);
	ADD("unfinished", test_unfinished);
	ADD("discard", test_discard);
	ADD("names", test_names);
	ADD("last-number", test_last_number);
	ADD("lock", test_lock);
	ADD("read-only", test_read_only);
	ADD("kills", test_kills);
	return g_test_run();
}
