/* Any text as a tree of segments: what is accepted is one tree, of which any question has an answer, and is written so that it reads
 * back the same. */
#include "firmware-io/files.h"
#include "process/segments.h"
#include <glib/gstdio.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A site's folder, made once. */
static const char *site_folder(void)
{
	static char *path;
	if (!path) {
		path = g_strdup_printf("%s/fuzz-segments.%d", g_get_tmp_dir(), getpid());
		g_autofree char *inside = g_build_filename(path, "segments", NULL);
		g_assert_cmpint(g_mkdir_with_parents(inside, 0700), ==, 0);
	}
	return path;
}

static void remove_folder(void)
{
	files_remove_tree(site_folder(), NULL);
}

static void check_node(const segments *s, const struct segment *node)
{
	g_autofree char *name = segments_name(s, node->id);
	g_assert_true(segments_find(s, node->id) == node);
	g_assert_true(segments_is_above(s, SEGMENT_SITE, node->id));
	g_assert_true(node->id == SEGMENT_SITE || !segments_is_leaf(s, node->parent));
	g_assert_nonnull(name);
}

static void check_same(const segments *a, const segments *b)
{
	g_assert_cmpuint(a->nodes->len, ==, b->nodes->len);
	g_assert_cmpstr(a->key, ==, b->key);
	for (guint i = 0; i < a->nodes->len; i++) {
		const struct segment *p = &g_array_index(a->nodes, struct segment, i),
				     *q = &g_array_index(b->nodes, struct segment, i);
		g_assert_true(p->id == q->id && p->parent == q->parent && p->class == q->class);
		g_assert_cmpuint(p->points, ==, q->points);
		g_assert_cmpstr(p->name, ==, q->name);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static bool registered;
	static const double low[3] = { 0 }, high[3] = { 1, 1, 1 };
	g_autoptr(GError) error = NULL;
	g_autofree char *path = segments_path(site_folder());
	if (!registered)
		registered = !atexit(remove_folder);
	g_assert_true(g_file_set_contents(path, (const char *)data, (gssize)size, NULL));
	g_autoptr(segments) s = segments_load(site_folder(), &error);
	g_assert_true((s == NULL) == (error != NULL));
	if (!s)
		return 0;
	for (guint i = 0; i < s->nodes->len; i++)
		check_node(s, &g_array_index(s->nodes, struct segment, i));
	g_assert_true(segments_save(s, site_folder(), &error));
	g_autoptr(segments) again = segments_load(site_folder(), &error);
	g_assert_no_error(error);
	check_same(s, again);
	uint32_t id = segments_add(s, segment_of_class(CLASS_WATER), "Pond", "user");
	if (id) {
		segments_count(s, id, 1, low, high, 1);
		segments_remove(s, id);
	}
	return 0;
}
