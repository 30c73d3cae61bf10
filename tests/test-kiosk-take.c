/* What is taken home: the service for jobs accepts all that the screen asks it for. */
#include "firmware-io/files.h"
#include "process/job-kinds.h"
#include "render/kiosk/take-preset.h"
#include "render/kiosk/take-words.h"
#include <string.h>

static const enum export_kind all_kinds[] = { EXPORT_PICTURE, EXPORT_DRAWING, EXPORT_FILM,
	EXPORT_REPORT, EXPORT_POINTS };

static char *folder;

static GStrv arguments(enum export_kind kind, const struct take_preset *p, const char *view)
{
	const struct job_limits limits = { .folder = folder };
	g_autoptr(GError) error = NULL;
	const struct job_kind *job = job_kind_find(take_job(kind), &error);
	g_assert_no_error(error);
	g_autofree char *stem = take_stem(kind, p, "figure-7c", view),
			*oak = g_build_filename(folder, "oak", NULL),
			*path = g_strdup_printf("%s/exports/%s.%s", oak, stem, p->ending);
	g_assert_null(strpbrk(stem, ":/"));
	g_autoptr(GVariant) options =
		g_variant_ref_sink(take_options(kind, p, "figure-7c", view, path));
	GStrv all = job_kind_arguments(job, oak, options, &limits, &error);
	g_assert_no_error(error);
	return all;
}

static bool has(GStrv all, const char *option, const char *value)
{
	for (char **a = all; *a; a++)
		if (!strcmp(*a, option) && a[1] && !strcmp(a[1], value))
			return true;
		else if (g_str_has_prefix(*a, option) && (*a)[strlen(option)] == '=' &&
			 !strcmp(*a + strlen(option) + 1, value))
			return true;
	return false;
}

static void test_jobs_accept_all(void)
{
	for (size_t k = 0; k < G_N_ELEMENTS(all_kinds); k++)
		for (const struct take_preset *p = take_presets(all_kinds[k]); p->id; p++) {
			g_auto(GStrv) plan = arguments(all_kinds[k], p, "plan:1.2");
			g_auto(GStrv) walk = arguments(all_kinds[k], p, "walk");
		}
}

/* On paper a plan has a scale; films move, and have perspective. */
static void test_plans(void)
{
	const struct take_preset *pdf = take_preset_find(EXPORT_DRAWING, "pdf-a3"),
				 *film = take_preset_find(EXPORT_FILM, "orbit");
	g_auto(GStrv) page = arguments(EXPORT_DRAWING, pdf, "section-a");
	g_auto(GStrv) moves = arguments(EXPORT_FILM, film, "section-a");
	g_assert_true(has(page, "--view", "section-a") && has(page, "--size", "A3-landscape"));
	g_assert_true(has(moves, "--view", "overview"));
	g_autofree char *cut = words_view("plan:1.2"), *along = words_view("section-a");
	g_assert_cmpstr(cut, ==, "Plan at 1.2 m");
	g_assert_cmpstr(along, ==, "Section along the building");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/kiosk-take/jobs", test_jobs_accept_all);
	g_test_add_func("/kiosk-take/plans", test_plans);
	folder = g_dir_make_tmp("test-take-XXXXXX", NULL);
	g_autofree char *oak = g_build_filename(folder, "oak", NULL),
			*exports = g_build_filename(oak, "exports", NULL);
	g_assert_true(files_make_folder(oak, NULL) && files_make_folder(exports, NULL));
	int status = g_test_run();
	files_remove_tree(folder, NULL);
	g_free(folder);
	return status;
}
