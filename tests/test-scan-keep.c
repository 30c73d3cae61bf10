/* Scans that are kept for who asks again: the same one, not another's, and no more than may be. */
#include "process/scan-data.h"
#include "tests/built-model.h"

static scan_data *load(const char *path, uint32_t number)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = site_open(path, &error);
	scan_data *d = scan_data_load(s, number, &error);
	g_assert_no_error(error);
	return d;
}

static void test_same(void)
{
	g_autofree char *path = fresh_site(), *other = fresh_site();
	g_autoptr(scan_data) not_kept = load(path, 1);
	scan_data_keep((uint64_t)1 << 30);
	g_autoptr(scan_data) a = load(path, 1), b = load(path, 1), c = load(path, 2),
			     d = load(other, 1);
	g_assert_true(a == b);
	g_assert_true(a != c && a != d && a != not_kept);
	g_assert_cmpuint(c->number, ==, 2);
	g_assert_cmpmem(a->grid->range_m, range_grid_cells(a->grid) * sizeof(float),
		not_kept->grid->range_m, range_grid_cells(not_kept->grid) * sizeof(float));
	/* Nobody else has it, and it is there all the same. */
	const range_grid *grid = c->grid;
	g_clear_pointer(&c, scan_data_free);
	c = load(path, 2);
	g_assert_true(c->grid == grid);
}

/* Points that are others now are not those that are kept. */
static void test_changed(void)
{
	g_autofree char *path = fresh_site(), *command = NULL;
	scan_data_keep((uint64_t)1 << 30);
	g_autoptr(scan_data) a = load(path, 1);
	command = g_strdup_printf("cp -R '%s/scans/0002/.' '%s/scans/0001'", path, path);
	g_assert_cmpint(system(command), ==, 0);
	g_autoptr(scan_data) b = load(path, 1);
	g_assert_true(a != b);
	g_assert_cmpstr(a->fingerprint, !=, b->fingerprint);
}

/* Room for two. */
static void test_room(void)
{
	g_autofree char *path = fresh_site();
	scan_data *first = load(path, 1);
	const uint64_t bytes = first->kept_bytes;
	g_assert_cmpuint(bytes, >=, range_grid_cells(first->grid) * 22);
	scan_data_keep(2 * bytes);
	scan_data_free(load(path, 2));
	scan_data_free(load(path, 3));
	g_autoptr(scan_data) again = load(path, 1);
	g_assert_true(again != first); /* which its owner still has */
	g_assert_cmpfloat(first->grid->range_m[0], ==, again->grid->range_m[0]);
	scan_data_free(first);
	scan_data_keep(bytes - 1);
	g_autoptr(scan_data) too_large = load(path, 2);
	g_assert_null(too_large->kept_of);
}

static gpointer load_some(gpointer path)
{
	for (uint32_t k = 0; k < 12; k++) {
		g_autoptr(scan_data) d = load(path, k % SCANS + 1);
		g_assert_cmpuint(d->number, ==, k % SCANS + 1);
	}
	return NULL;
}

static void test_threads(void)
{
	g_autofree char *path = fresh_site();
	GThread *thread[3];
	g_autoptr(scan_data) d = load(path, 1);
	scan_data_keep(2 * range_grid_cells(d->grid) * 22);
	for (size_t i = 0; i < G_N_ELEMENTS(thread); i++)
		thread[i] = g_thread_new("loads", load_some, path);
	for (size_t i = 0; i < G_N_ELEMENTS(thread); i++)
		g_thread_join(thread[i]);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/scan-keep/same", test_same);
	g_test_add_func("/scan-keep/changed", test_changed);
	g_test_add_func("/scan-keep/room", test_room);
	g_test_add_func("/scan-keep/threads", test_threads);
	return g_test_run();
}
