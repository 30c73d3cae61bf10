/* SITE/poses/NNNN.json: a graph for every change, the last one counts; undo appends what was before. */
#include "firmware-io/files.h"
#include "process/scan-graph.h"
#include <gio/gio.h>
#include <string.h>

static char *folder_of(const site *s)
{
	return g_build_filename(site_path(s), "poses", NULL);
}

static char *revision_path(const site *s, uint32_t revision)
{
	g_autofree char *folder = folder_of(s);
	g_autofree char *name = g_strdup_printf("%04u.json", revision);
	return g_build_filename(folder, name, NULL);
}

/* The number of a name like 0007.json; 0: it is none. */
static uint32_t revision_of(const char *name)
{
	uint32_t number = 0;
	for (int i = 0; i < 4; i++) {
		if (!g_ascii_isdigit(name[i]))
			return 0;
		number = 10 * number + (uint32_t)(name[i] - '0');
	}
	return strcmp(name + 4, ".json") == 0 ? number : 0;
}

static bool find_last(const site *s, uint32_t *ret, GError **error)
{
	g_autofree char *folder = folder_of(s);
	*ret = 0;
	if (!g_file_test(folder, G_FILE_TEST_EXISTS))
		return true;
	g_autoptr(GPtrArray) names = files_names(folder, error);
	for (guint i = 0; names && i < names->len; i++)
		*ret = MAX(*ret, revision_of(g_ptr_array_index(names, i)));
	return names != NULL;
}

static scan_graph *load_revision(const site *s, uint32_t revision, GError **error)
{
	g_autofree char *path = revision_path(s, revision);
	g_autoptr(scan_graph) g = scan_graph_load_file(path, error);
	if (!g || g->revision == revision)
		return g_steal_pointer(&g);
	g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE,
		"%s: 'revision' is %u, not that of its name", path, g->revision);
	return NULL;
}

scan_graph *scan_graph_load(const site *s, GError **error)
{
	uint32_t last;
	if (!find_last(s, &last, error))
		return NULL;
	return last ? load_revision(s, last, error) : scan_graph_new();
}

static char *time_now(void)
{
	g_autoptr(GDateTime) now = g_date_time_new_now_utc();
	return g_date_time_format(now, "%Y-%m-%dT%H:%M:%SZ");
}

/* As the revision after the last; g->parent stands. */
static bool append(scan_graph *g, const site *s, const char *change, GError **error)
{
	uint32_t last;
	g_autofree char *folder = folder_of(s);
	if (!files_make_folder(folder, error) || !find_last(s, &last, error))
		return false;
	if (last >= SITE_SCANS_MAX) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NO_SPACE,
			"%s: there are %u revisions, more cannot be numbered; move old ones away",
			folder, last);
		return false;
	}
	g->revision = last + 1;
	g_free(g->change);
	g->change = g_strdup(change);
	g_free(g->time);
	g->time = time_now();
	g_autofree char *path = revision_path(s, g->revision);
	return scan_graph_save_file(g, path, error);
}

bool scan_graph_save(scan_graph *g, const site *s, const char *change, GError **error)
{
	if (!find_last(s, &g->parent, error))
		return false;
	return append(g, s, change, error);
}

static scan_graph *refuse_undo(const site *s, GError **error)
{
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
		"%s: there is no alignment left to undo", site_path(s));
	return NULL;
}

/* What an undo left is what the revision after its parent had made: every other revision's parent is the one before it. */
static char *change_of(const site *s, const scan_graph *last, GError **error)
{
	if (last->parent + 1 == last->revision)
		return g_strdup(last->change);
	g_autoptr(scan_graph) made = load_revision(s, last->parent + 1, error);
	return made ? g_strdup(made->change) : NULL;
}

/* An undone first change leaves a graph without anything, whose parent is 0 as a first one's is. */
scan_graph *scan_graph_undo(const site *s, GError **error)
{
	g_autoptr(scan_graph) last = scan_graph_load(s, error);
	if (!last)
		return NULL;
	if (!last->revision || (!last->parent && !last->edges->len && !last->scans->len))
		return refuse_undo(s, error);
	g_autoptr(scan_graph) before =
		last->parent ? load_revision(s, last->parent, error) : scan_graph_new();
	g_autofree char *undone = before ? change_of(s, last, error) : NULL;
	if (!undone)
		return NULL;
	g_autofree char *change = g_strdup_printf("undone: %s", undone);
	if (!append(before, s, change, error))
		return NULL;
	return g_steal_pointer(&before);
}
