/* What is remembered of how scans are like themselves: bit by bit what was found, or nothing. */
#include "firmware-io/files.h"
#include "process/alikes.h"
#include "tests/simulated.h"
#include <stdio.h>
#include <string.h>

static site *fresh(char **ret_file)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "site", NULL),
			*poses = g_build_filename(path, "poses", NULL);
	site *s = site_open_for_writing(path, &error);
	g_assert_no_error(error);
	g_assert_true(files_make_folder(poses, NULL));
	*ret_file = g_build_filename(poses, ".alikes.json", NULL);
	return s;
}

static struct pair_alikes some(uint32_t count)
{
	struct pair_alikes is = { .count = count };
	for (uint32_t i = 0; i < count; i++) {
		is.pose[i] = pose_perturb(&POSE_IDENTITY,
			(double[6]){ 0.1 * i, -1e-17, G_PI / 3, 1e-9 / 3, -7.0 / (i + 1), -0.0 });
		is.pose[i].translation_m[2] = 1e300 / 7;
	}
	return is;
}

static void test_remembered(void)
{
	char *names[] = { "a", "b", "c" };
	g_autofree char *file = NULL;
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = fresh(&file);
	{
		g_autoptr(alikes) a = alikes_load(s, "method 1");
		g_assert_null(alikes_get(a, "a"));
		for (uint32_t i = 0; i < 3; i++) {
			struct pair_alikes is = some(2 * i);
			alikes_set(a, names[i], &is);
		}
		g_assert_true(alikes_save(a, names, 3, &error));
	}
	g_autoptr(alikes) a = alikes_load(s, "method 1");
	for (uint32_t i = 0; i < 3; i++) {
		const struct pair_alikes is = some(2 * i), *found = alikes_get(a, names[i]);
		g_assert_nonnull(found);
		g_assert_cmpuint(found->count, ==, is.count);
		g_assert_cmpmem(found->pose, is.count * sizeof *is.pose, is.pose,
			is.count * sizeof *is.pose);
	}
	/* Nothing new: nothing is written. */
	g_assert_cmpint(remove(file), ==, 0);
	g_assert_true(alikes_save(a, names, 3, &error));
	g_assert_false(g_file_test(file, G_FILE_TEST_EXISTS));
}

/* Only those of scans that are there. */
static void test_gone(void)
{
	char *names[] = { "a", "b" };
	g_autofree char *file = NULL;
	g_autoptr(site) s = fresh(&file);
	g_autoptr(alikes) a = alikes_load(s, "method 1");
	struct pair_alikes is = some(1);
	alikes_set(a, "a", &is);
	alikes_set(a, "b", &is);
	g_assert_true(alikes_save(a, names + 1, 1, NULL));
	g_autoptr(alikes) again = alikes_load(s, "method 1");
	g_assert_null(alikes_get(again, "a"));
	g_assert_nonnull(alikes_get(again, "b"));
	g_autoptr(alikes) other = alikes_load(s, "method 2");
	g_assert_null(alikes_get(other, "b"));
}

static void test_damaged(void)
{
	static const char *const texts[] = { "", "{", "[]", "{\"method\": \"method 1\"}",
		"{\"method\": \"method 1\", \"scans\": []}",
		"{\"method\": \"method 1\", \"scans\": {\"a\": 7}}",
		"{\"method\": \"method 1\", \"scans\": {\"a\": [1, 2, 3]}}",
		"{\"method\": \"method 1\", \"scans\": {\"a\": [1,2,3,4,5,6,7,8,9,10,11,\"x\"]}}",
		"{\"method\": 7, \"scans\": {\"a\": []}}" };
	g_autofree char *file = NULL;
	g_autoptr(site) s = fresh(&file);
	for (size_t i = 0; i < G_N_ELEMENTS(texts); i++) {
		g_assert_true(g_file_set_contents(file, texts[i], -1, NULL));
		g_autoptr(alikes) a = alikes_load(s, "method 1");
		g_assert_null(alikes_get(a, "a"));
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/alikes/remembered", test_remembered);
	g_test_add_func("/alikes/gone", test_gone);
	g_test_add_func("/alikes/damaged", test_damaged);
	return g_test_run();
}
