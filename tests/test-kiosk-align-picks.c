/* Pairs of picked cells: which one a tap completes, undoing by copies, and files. */
#include "render/kiosk/align-picks.h"
#include "tests/simulated.h"
#include <glib/gstdio.h>

static const struct align_pick *pair_at(const align_picks *p, guint n)
{
	return &g_array_index(p->pairs, struct align_pick, n);
}

static void test_add(void)
{
	g_autoptr(align_picks) p = align_picks_new();
	g_assert_cmpuint(align_picks_add(p, 0, 10, 20), ==, 0);
	g_assert_cmpuint(align_picks_add(p, 0, 11, 21), ==, 1);
	g_assert_cmpuint(align_picks_whole(p), ==, 0);
	/* The other side completes them in their order. */
	g_assert_cmpuint(align_picks_add(p, 1, 30, 40), ==, 0);
	g_assert_cmpuint(align_picks_add(p, 1, 31, 41), ==, 1);
	g_assert_cmpuint(align_picks_add(p, 1, 32, 42), ==, 2);
	g_assert_cmpuint(align_picks_whole(p), ==, 2);
	g_assert_cmpuint(align_picks_add(p, 0, 12, 22), ==, 2);
	g_assert_cmpuint(align_picks_whole(p), ==, 3);
	g_autoptr(align_picks) before = align_picks_copy(p);
	align_picks_move(p, 1, 0, 99, 98);
	align_picks_remove(p, 0);
	g_assert_cmpuint(p->pairs->len, ==, 2);
	g_assert_cmpuint(pair_at(p, 0)->column[0], ==, 99);
	g_assert_cmpuint(pair_at(p, 0)->row[0], ==, 98);
	g_assert_cmpuint(pair_at(p, 0)->column[1], ==, 31);
	g_assert_cmpuint(before->pairs->len, ==, 3);
	g_assert_cmpuint(pair_at(before, 1)->column[0], ==, 11);
}

static void test_files(void)
{
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "pairs", NULL);
	g_autoptr(GError) error = NULL;
	g_autoptr(align_picks) p = align_picks_new(), none = align_picks_load(path);
	g_assert_cmpuint(none->pairs->len, ==, 0);
	for (uint32_t n = 0; n < 5; n++) {
		align_picks_add(p, 0, 10 + n, 20 + n);
		align_picks_add(p, 1, 30 + n, 40 + n);
	}
	g_assert_true(align_picks_save(p, path, &error));
	g_assert_no_error(error);
	g_autoptr(align_picks) again = align_picks_load(path);
	g_assert_cmpuint(again->pairs->len, ==, 5);
	for (guint n = 0; n < 5; n++)
		g_assert_cmpmem(pair_at(again, n), sizeof(struct align_pick), pair_at(p, n),
			sizeof(struct align_pick));
	/* A file that is none is no pairs. */
	g_assert_true(g_file_set_contents(path, "10 20 thirty 40\n\x01", -1, NULL));
	g_autoptr(align_picks) broken = align_picks_load(path);
	g_assert_cmpuint(broken->pairs->len, ==, 0);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/align-picks/add", test_add);
	g_test_add_func("/align-picks/files", test_files);
	return g_test_run();
}
