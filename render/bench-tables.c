#include "render/bench-tables.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WHO 2

/* ---- a table ---- */

static bench_tables_table *table_new(const char *title)
{
	bench_tables_table *t = g_new0(bench_tables_table, 1);
	t->title = g_strdelimit(g_strdup(title), "_", ' ');
	t->columns = g_ptr_array_new_with_free_func(g_free);
	t->rows = g_ptr_array_new_with_free_func((GDestroyNotify)g_ptr_array_unref);
	t->numbers = g_array_new(FALSE, TRUE, sizeof(bool));
	return t;
}

void bench_tables_table_free(bench_tables_table *t)
{
	if (!t)
		return;
	g_free(t->title);
	g_ptr_array_unref(t->columns);
	g_ptr_array_unref(t->rows);
	g_array_unref(t->numbers);
	g_free(t);
}

static guint column_of(bench_tables_table *t, const char *name)
{
	guint at;
	const bool yes = true;
	g_autofree char *title = g_strdelimit(g_strdup(name), "_", ' ');
	if (g_ptr_array_find_with_equal_func(t->columns, title, g_str_equal, &at))
		return at;
	g_ptr_array_add(t->columns, g_steal_pointer(&title));
	g_array_append_val(t->numbers, yes);
	return t->columns->len - 1;
}

static void put(bench_tables_table *t, GPtrArray *row, const char *name, char *taken, bool number)
{
	guint at = column_of(t, name);
	while (row->len <= at)
		g_ptr_array_add(row, g_strdup(""));
	g_free(row->pdata[at]);
	row->pdata[at] = taken;
	if (!number)
		g_array_index(t->numbers, bool, at) = false;
}

static void pad_rows(bench_tables_table *t)
{
	for (guint n = 0; n < t->rows->len; n++) {
		GPtrArray *row = t->rows->pdata[n];
		while (row->len < t->columns->len)
			g_ptr_array_add(row, g_strdup(""));
	}
}

/* ---- values ---- */

static char *number_text(double value)
{
	double size = fabs(value);
	if (size == floor(size) && size < 1e15)
		return g_strdup_printf("%.0f", value);
	int digits = size >= 1000 ? 0 : size >= 1 ? 3 - (int)floor(log10(size)) : 4;
	return size < 1e-4 ? g_strdup_printf("%.2g", value)
			   : g_strdup_printf("%.*f", digits, value);
}

static char *value_text(JsonNode *node, bool *ret_number)
{
	GType type = JSON_NODE_HOLDS_VALUE(node) ? json_node_get_value_type(node) : 0;
	*ret_number = type == G_TYPE_INT64 || type == G_TYPE_DOUBLE;
	if (type == G_TYPE_INT64)
		return g_strdup_printf("%" G_GINT64_FORMAT, (gint64)json_node_get_int(node));
	if (type == G_TYPE_DOUBLE)
		return number_text(json_node_get_double(node));
	if (type == G_TYPE_BOOLEAN)
		return g_strdup(json_node_get_boolean(node) ? "yes" : "no");
	return type == G_TYPE_STRING ? json_node_dup_string(node) : g_strdup("");
}

static bool holds_objects(JsonNode *node)
{
	JsonArray *a = JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	return a && json_array_get_length(a) &&
	       JSON_NODE_HOLDS_OBJECT(json_array_get_element(a, 0));
}

static char *joined(JsonArray *a)
{
	GString *text = g_string_new(NULL);
	for (guint n = 0; n < json_array_get_length(a); n++) {
		bool number;
		g_autofree char *one = value_text(json_array_get_element(a, n), &number);
		g_string_append_printf(text, "%s%s", n ? ", " : "", one);
	}
	return g_string_free(text, FALSE);
}

/* ---- walking ---- */

static char *inside(const char *title, const char *name)
{
	return *title ? g_strdup_printf("%s, %s", title, name) : g_strdup(name);
}

/* Members of an object within a row are columns too: "iou building". */
static void put_members(bench_tables_table *t, GPtrArray *row, const char *before, JsonObject *o)
{
	g_autoptr(GList) names = json_object_get_members(o);
	for (GList *l = names; l; l = l->next) {
		JsonNode *node = json_object_get_member(o, l->data);
		g_autofree char *name = *before ? g_strdup_printf("%s %s", before, (char *)l->data)
						: g_strdup(l->data);
		bool number = false;
		if (JSON_NODE_HOLDS_OBJECT(node)) {
			put_members(t, row, name, json_node_get_object(node));
		} else if (JSON_NODE_HOLDS_ARRAY(node) && !holds_objects(node)) {
			char *text = joined(json_node_get_array(node));
			put(t, row, name, text, false);
		} else if (!holds_objects(node)) {
			char *text = value_text(node, &number);
			put(t, row, name, text, number);
		}
	}
}

/* What tells a row from the others: what stands first in it, if that is a name or a whole number. */
static void put_who(bench_tables_table *t, GPtrArray *row, JsonObject *o)
{
	g_autoptr(GList) names = json_object_get_members(o);
	guint count = 0;
	for (GList *l = names; l && count < WHO; l = l->next, count++) {
		JsonNode *node = json_object_get_member(o, l->data);
		GType type = JSON_NODE_HOLDS_VALUE(node) ? json_node_get_value_type(node) : 0;
		if (type != G_TYPE_STRING && type != G_TYPE_INT64)
			return;
		bool number;
		char *text = value_text(node, &number);
		put(t, row, l->data, text, number);
	}
}

/* of: of each row; NULL, or the objects that these arrays stand in, whose names come first. */
static void put_rows(bench_tables_table *t, JsonArray *a, JsonObject *of)
{
	for (guint n = 0; n < json_array_get_length(a); n++) {
		JsonNode *node = json_array_get_element(a, n);
		GPtrArray *row = g_ptr_array_new_with_free_func(g_free);
		if (of)
			put_who(t, row, of);
		if (JSON_NODE_HOLDS_OBJECT(node))
			put_members(t, row, "", json_node_get_object(node));
		g_ptr_array_add(t->rows, row);
	}
}

/* Arrays of objects within the objects of an array: those of one name are one table. */
static void add_inner(GPtrArray *to, const char *title, JsonArray *a)
{
	g_autoptr(GHashTable) tables = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	for (guint n = 0; n < json_array_get_length(a); n++) {
		JsonNode *element = json_array_get_element(a, n);
		JsonObject *o =
			JSON_NODE_HOLDS_OBJECT(element) ? json_node_get_object(element) : NULL;
		g_autoptr(GList) names = o ? json_object_get_members(o) : NULL;
		for (GList *l = names; l; l = l->next) {
			JsonNode *node = json_object_get_member(o, l->data);
			bench_tables_table *t = g_hash_table_lookup(tables, l->data);
			if (!holds_objects(node))
				continue;
			if (!t) {
				g_autofree char *inner = inside(title, l->data);
				g_ptr_array_add(to, t = table_new(inner));
				g_hash_table_insert(tables, g_strdup(l->data), t);
			}
			put_rows(t, json_node_get_array(node), o);
			pad_rows(t);
		}
	}
}

static void add_array(GPtrArray *to, const char *title, JsonArray *a)
{
	bench_tables_table *t = table_new(title);
	g_ptr_array_add(to, t);
	put_rows(t, a, NULL);
	pad_rows(t);
	add_inner(to, title, a);
}

/* Plain members first, as rows of name and value. */
static void add_object(GPtrArray *to, const char *title, JsonObject *o)
{
	g_autoptr(GList) names = json_object_get_members(o);
	bench_tables_table *t = table_new(title);
	static const bool numbers[] = { false, true };
	g_ptr_array_add(to, t);
	g_array_append_vals(t->numbers, numbers, 2);
	for (GList *l = names; l; l = l->next) {
		JsonNode *node = json_object_get_member(o, l->data);
		bool number;
		if (JSON_NODE_HOLDS_OBJECT(node) || holds_objects(node))
			continue;
		GPtrArray *row = g_ptr_array_new_with_free_func(g_free);
		g_ptr_array_add(row, g_strdelimit(g_strdup(l->data), "_", ' '));
		g_ptr_array_add(row, JSON_NODE_HOLDS_ARRAY(node) ? joined(json_node_get_array(node))
								 : value_text(node, &number));
		g_ptr_array_add(t->rows, row);
	}
	if (!t->rows->len)
		g_ptr_array_remove(to, t);
	for (GList *l = names; l; l = l->next) {
		JsonNode *node = json_object_get_member(o, l->data);
		g_autofree char *inner = inside(title, l->data);
		if (JSON_NODE_HOLDS_OBJECT(node))
			add_object(to, inner, json_node_get_object(node));
		else if (holds_objects(node))
			add_array(to, inner, json_node_get_array(node));
	}
}

GPtrArray *bench_tables_of(JsonObject *result)
{
	GPtrArray *all = g_ptr_array_new_with_free_func((GDestroyNotify)bench_tables_table_free);
	add_object(all, "", result);
	return all;
}

/* ---- printing ---- */

static int width_of(const bench_tables_table *t, guint column)
{
	glong width = t->columns->len ? g_utf8_strlen(t->columns->pdata[column], -1) : 0;
	for (guint n = 0; n < t->rows->len; n++) {
		const GPtrArray *row = t->rows->pdata[n];
		width = MAX(width, g_utf8_strlen(row->pdata[column], -1));
	}
	return (int)width;
}

static void print_cells(const bench_tables_table *t, const GPtrArray *cells)
{
	g_autoptr(GString) line = g_string_new(" ");
	for (guint c = 0; c < cells->len; c++) {
		int space = width_of(t, c) - (int)g_utf8_strlen(cells->pdata[c], -1);
		bool right = g_array_index(t->numbers, bool, c);
		g_string_append_printf(line, " %*s%s%*s", right ? space : 0, "",
			(char *)cells->pdata[c], right ? 0 : space, "");
	}
	puts(g_strchomp(line->str));
}

void bench_tables_print(JsonObject *result)
{
	g_autoptr(GPtrArray) all = bench_tables_of(result);
	for (guint n = 0; n < all->len; n++) {
		const bench_tables_table *t = all->pdata[n];
		if (*t->title)
			printf(" %s\n", t->title);
		if (t->columns->len)
			print_cells(t, t->columns);
		for (guint r = 0; r < t->rows->len; r++)
			print_cells(t, t->rows->pdata[r]);
	}
}
