#include "process/segment-names.h"
#include <string.h>

/* "Tree 4" below node 4: "4/Tree" and 4. */
struct kind {
	char *key;      /* caller frees */
	guint64 number; /* 0: it has none */
};

static struct kind kind_of(const struct segment *node)
{
	const char *space = strrchr(node->name, ' ');
	guint64 number = 0;
	bool has = space && g_ascii_string_to_unsigned(space + 1, 10, 1, G_MAXINT64, &number, NULL);
	int length = (int)(has ? space - node->name : (long)strlen(node->name));
	return (struct kind){ g_strdup_printf("%u/%.*s", node->parent, length, node->name),
		has ? number : 0 };
}

/* The largest number of each kind. */
static GHashTable *count_kinds(const segments *was)
{
	GHashTable *last = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	for (guint i = 0; i < was->nodes->len; i++) {
		struct kind k = kind_of(&g_array_index(was->nodes, struct segment, i));
		gsize before = GPOINTER_TO_SIZE(g_hash_table_lookup(last, k.key));
		g_hash_table_replace(last, k.key, GSIZE_TO_POINTER(MAX(before, k.number)));
	}
	return last;
}

static bool take_name(const struct segment *was, const struct kind *now, char **name)
{
	g_autofree char *key = NULL;
	if (!was)
		return false;
	struct kind before = kind_of(was);
	key = before.key;
	if (!before.number || strcmp(before.key, now->key))
		return false;
	g_free(*name);
	*name = g_strdup(was->name);
	return true;
}

/* Takes the key. */
static void next_name(GHashTable *last, struct kind *k, char **name)
{
	gsize number = GPOINTER_TO_SIZE(g_hash_table_lookup(last, k->key)) + 1;
	char *numbered = g_strdup_printf("%s %" G_GSIZE_FORMAT, strchr(k->key, '/') + 1, number);
	g_free(*name);
	*name = numbered;
	g_hash_table_replace(last, g_steal_pointer(&k->key), GSIZE_TO_POINTER(number));
}

void segment_names_keep(const segments *was, segments *now)
{
	g_autoptr(GHashTable) last = count_kinds(was);
	for (guint i = 0; i < now->nodes->len; i++) {
		struct segment *node = &g_array_index(now->nodes, struct segment, i);
		struct kind k = kind_of(node);
		if (k.number && !take_name(segments_find(was, node->id), &k, &node->name))
			next_name(last, &k, &node->name);
		g_free(k.key);
	}
}
