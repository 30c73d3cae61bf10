#include "process/alikes.h"
#include "acquire/strict-json.h"
#include "firmware-io/files.h"
#include "process/pose-json.h"
#include <string.h>

#define BYTES_MAX ((size_t)16 << 20)
#define NUMBERS   12 /* of a pose */

struct alikes {
	char *path, *method;
	GHashTable *of; /* fingerprint -> struct pair_alikes */
	bool is_changed;
};

void alikes_free(alikes *a)
{
	if (!a)
		return;
	g_hash_table_unref(a->of);
	g_free(a->path);
	g_free(a->method);
	g_free(a);
}

/* As the bits were: what is made of them must be the same. */
static bool read_poses(JsonNode *node, struct pair_alikes *ret)
{
	double n[PAIR_ALIKES_MOST * NUMBERS];
	JsonArray *a = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	guint count = a ? json_array_get_length(a) : 1;
	if (count % NUMBERS || count > G_N_ELEMENTS(n) || !json_read_numbers(node, count, n))
		return false;
	ret->count = count / NUMBERS;
	for (uint32_t i = 0; i < ret->count; i++) {
		struct pose *p = &ret->pose[i];
		memcpy(p->rotation, n + (size_t)i * NUMBERS, sizeof p->rotation);
		memcpy(p->translation_m, n + (size_t)i * NUMBERS + 9, sizeof p->translation_m);
	}
	return true;
}

static void take_scan(JsonObject *o, const char *fingerprint, JsonNode *node, gpointer user_data)
{
	struct pair_alikes is = { 0 };
	(void)o;
	if (read_poses(node, &is))
		alikes_set(user_data, fingerprint, &is);
}

alikes *alikes_load(const site *s, const char *method)
{
	alikes *a = g_new0(alikes, 1);
	size_t length;
	a->path = g_build_filename(site_path(s), "poses", ".alikes.json", NULL);
	a->method = g_strdup(method);
	a->of = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
	g_autofree char *text = files_read(a->path, BYTES_MAX, &length, NULL);
	g_autoptr(JsonNode) root = text ? strict_json_read(text, length, NULL) : NULL;
	JsonObject *o = root && JSON_NODE_HOLDS_OBJECT(root) ? json_node_get_object(root) : NULL;
	JsonNode *scans = o ? json_object_get_member(o, "scans") : NULL;
	JsonNode *by = o ? json_object_get_member(o, "method") : NULL;
	if (scans && JSON_NODE_HOLDS_OBJECT(scans) && by && JSON_NODE_HOLDS_VALUE(by) &&
		g_strcmp0(json_node_get_string(by), method) == 0)
		json_object_foreach_member(json_node_get_object(scans), take_scan, a);
	a->is_changed = false;
	return a;
}

const struct pair_alikes *alikes_get(const alikes *a, const char *fingerprint)
{
	return g_hash_table_lookup(a->of, fingerprint);
}

void alikes_set(alikes *a, const char *fingerprint, const struct pair_alikes *is)
{
	g_hash_table_insert(a->of, g_strdup(fingerprint), g_memdup2(is, sizeof *is));
	a->is_changed = true;
}

static JsonNode *write_poses(const struct pair_alikes *is)
{
	double n[PAIR_ALIKES_MOST * NUMBERS];
	for (uint32_t i = 0; i < is->count; i++) {
		const struct pose *p = &is->pose[i];
		memcpy(n + (size_t)i * NUMBERS, p->rotation, sizeof p->rotation);
		memcpy(n + (size_t)i * NUMBERS + 9, p->translation_m, sizeof p->translation_m);
	}
	return json_write_numbers(n, (size_t)is->count * NUMBERS);
}

bool alikes_save(alikes *a, char *const *fingerprints, guint count, GError **error)
{
	JsonObject *o = json_object_new(), *scans = json_object_new();
	g_autoptr(JsonNode) root = json_node_new(JSON_NODE_OBJECT);
	json_node_take_object(root, o);
	json_object_set_string_member(o, "method", a->method);
	json_object_set_object_member(o, "scans", scans);
	for (guint i = 0; i < count; i++) {
		const struct pair_alikes *is = alikes_get(a, fingerprints[i]);
		if (is)
			json_object_set_member(scans, fingerprints[i], write_poses(is));
	}
	g_autofree char *text = a->is_changed ? strict_json_write(root) : NULL;
	a->is_changed = false;
	return !text || files_write(a->path, text, strlen(text), error);
}
