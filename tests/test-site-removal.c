/* Sites that are removed can be had back for a while, and are then gone, whatever happens in between. */
#include "acquire/site-removal.h"
#include "acquire/site.h"
#include "process/site-list.h"
#include "tests/simulated.h"
#include <gio/gio.h>
#include <glib/gstdio.h>

struct place {
	char *folder, *oak;
};

static void set_up(struct place *p, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	p->folder = simulated_folder();
	p->oak = g_build_filename(p->folder, "oak", NULL);
	site_free(site_open_for_writing(p->oak, &error));
	g_assert_no_error(error);
}

static void tear_down(struct place *p, gconstpointer data)
{
	(void)data;
	g_free(p->folder);
	g_free(p->oak);
}

static guint listed(const struct place *p)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GPtrArray) all = site_list(p->folder, &error);
	g_assert_no_error(error);
	return all->len;
}

static guint names_there(const struct place *p)
{
	g_autoptr(GDir) d = g_dir_open(p->folder, 0, NULL);
	guint n = 0;
	while (g_dir_read_name(d))
		n++;
	return n;
}

static char *removed(const struct place *p)
{
	g_autoptr(GError) error = NULL;
	char *hidden = NULL;
	g_assert_true(site_remove(p->oak, &hidden, &error));
	g_assert_no_error(error);
	g_assert_false(g_file_test(p->oak, G_FILE_TEST_EXISTS));
	g_assert_true(g_file_test(hidden, G_FILE_TEST_IS_DIR));
	return hidden;
}

static void test_back(struct place *p, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *back = NULL;
	(void)data;
	g_assert_cmpuint(listed(p), ==, 1);
	g_autofree char *hidden = removed(p);
	g_assert_cmpuint(listed(p), ==, 0);
	site_clear_removed(p->folder, 600);
	g_assert_true(site_restore(hidden, &back, &error));
	g_assert_no_error(error);
	g_assert_cmpstr(back, ==, p->oak);
	g_assert_cmpuint(listed(p), ==, 1);
	g_autoptr(site) s = site_open(p->oak, &error);
	g_assert_no_error(error);
}

static void test_gone(struct place *p, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	g_autofree char *hidden = removed(p);
	site_clear_removed(p->folder, 0);
	g_assert_cmpuint(names_there(p), ==, 0);
	g_assert_false(site_restore(hidden, NULL, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_assert_cmpstr(error->message, ==, "oak: is gone for good");
}

/* Another one was called so meanwhile, and was removed too. */
static void test_same_name(struct place *p, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	(void)data;
	g_autofree char *first = removed(p);
	site_free(site_open_for_writing(p->oak, &error));
	g_assert_no_error(error);
	g_assert_false(site_restore(first, NULL, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_EXISTS);
	g_clear_error(&error);
	g_autofree char *second = removed(p);
	g_assert_cmpstr(first, !=, second);
	g_assert_true(site_restore(first, NULL, &error));
	g_assert_true(g_file_test(second, G_FILE_TEST_IS_DIR));
}

static void test_refused(struct place *p, gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *hidden = NULL, *nowhere = g_build_filename(p->folder, "elm", NULL);
	(void)data;
	site *writer = site_open_for_writing(p->oak, &error);
	g_assert_no_error(error);
	g_assert_false(site_remove(p->oak, &hidden, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_BUSY);
	g_clear_error(&error);
	g_assert_true(g_file_test(p->oak, G_FILE_TEST_IS_DIR));
	site_free(writer);
	g_assert_false(site_remove(nowhere, &hidden, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_clear_error(&error);
	/* Nothing is brought back from elsewhere. */
	g_assert_false(site_restore(p->oak, NULL, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
}

static void test_broken(struct place *p, gconstpointer data)
{
	g_autofree char *json = g_build_filename(p->oak, "site.json", NULL);
	(void)data;
	g_assert_true(g_file_set_contents(json, "{", -1, NULL));
	g_autofree char *hidden = removed(p);
	g_assert_cmpuint(listed(p), ==, 0);
}

/* It was being deleted when the power went. */
static void test_cut_off(struct place *p, gconstpointer data)
{
	g_autofree char *half = g_build_filename(p->folder, ".gone-1-oak", NULL);
	g_autofree char *scans = g_build_filename(half, "scans", NULL);
	g_autofree char *other = g_build_filename(p->folder, ".gone", NULL);
	(void)data;
	g_assert_cmpint(g_mkdir_with_parents(scans, 0755), ==, 0);
	g_assert_cmpint(g_mkdir(other, 0755), ==, 0);
	g_autofree char *hidden = removed(p);
	site_clear_removed(p->folder, 600);
	g_assert_false(g_file_test(half, G_FILE_TEST_EXISTS));
	g_assert_true(g_file_test(other, G_FILE_TEST_IS_DIR)); /* not a name of ours */
	g_assert_true(g_file_test(hidden, G_FILE_TEST_IS_DIR));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
#define ADD(name, function)                                                                        \
	g_test_add("/site-removal/" name, struct place, NULL, set_up, function, tear_down)
	ADD("back", test_back);
	ADD("gone", test_gone);
	ADD("same-name", test_same_name);
	ADD("refused", test_refused);
	ADD("broken", test_broken);
	ADD("cut-off", test_cut_off);
	return g_test_run();
}
