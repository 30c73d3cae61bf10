#include "firmware-io/parts.h"
#include <math.h>
#include <string.h>

#define FILE_NAME "/etc/pleinair.conf"

/* Every key that there is; what they mean stands in pleinair.conf. */
static const struct {
	const char *group, *keys[32];
} rows[] = {
	{ "head", { "device", "certificate" } },
	{ "stage", { "chip", "step", "dir", "enable", "home", "index", "estop", "interlock",
			   "button", "sync", "led_ready", "led_emitting", "led_fault", "active_low",
			   "steps_per_turn", "index_slots", "rate_max", "counted", "priority" } },
	{ "camera", { "node", "width", "height", "format", "timestamps", "readout_us", "focus" } },
};

struct parts {
	GKeyFile *file;
	char *path, *rest;
	GHashTable *texts; /* "group.key" */
};

static bool is_known(const char *group, const char *key)
{
	for (size_t i = 0; i < G_N_ELEMENTS(rows); i++)
		for (size_t k = 0; strcmp(rows[i].group, group) == 0 && rows[i].keys[k]; k++)
			if (strcmp(rows[i].keys[k], key) == 0)
				return true;
	return false;
}

static bool refuse_key(const char *where, const char *group, const char *key, GError **error)
{
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
		"%s: there is no key '%s' in [%s]: see pleinair.conf(5)", where, key, group);
	return false;
}

static bool take_group(parts *p, const char *group, GError **error)
{
	g_auto(GStrv) keys = g_key_file_get_keys(p->file, group, NULL, NULL);
	for (char **key = keys; key && *key; key++) {
		if (!is_known(group, *key))
			return refuse_key(p->path, group, *key, error);
		g_hash_table_insert(p->texts, g_strdup_printf("%s.%s", group, *key),
			g_key_file_get_string(p->file, group, *key, NULL));
	}
	return true;
}

/* A machine without the file has no more than its URI says. */
static bool take_file(parts *p, GError **error)
{
	g_autoptr(GError) failed = NULL;
	if (!g_key_file_load_from_file(p->file, p->path, G_KEY_FILE_NONE, &failed)) {
		if (g_error_matches(failed, G_FILE_ERROR, G_FILE_ERROR_NOENT) &&
			!g_getenv("PLEINAIR_CONF"))
			return true;
		g_set_error(
			error, WIRE_ERROR, WIRE_ERROR_BROKEN, "%s: %s", p->path, failed->message);
		return false;
	}
	g_auto(GStrv) groups = g_key_file_get_groups(p->file, NULL);
	for (char **group = groups; *group; group++)
		if (!take_group(p, *group, error))
			return false;
	return true;
}

static bool take_pair(parts *p, const char *uri, const char *pair, GError **error)
{
	const char *dot = strchr(pair, '.'), *equals = dot ? strchr(dot, '=') : NULL;
	if (!equals) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
			"device '%s': '%s' is not of the form group.key=value", uri, pair);
		return false;
	}
	g_autofree char *group = g_strndup(pair, dot - pair),
			*key = g_strndup(dot + 1, equals - dot - 1);
	if (!is_known(group, key))
		return refuse_key(uri, group, key, error);
	g_hash_table_insert(p->texts, g_strndup(pair, equals - pair), g_strdup(equals + 1));
	return true;
}

parts *parts_read(const char *uri, GError **error)
{
	g_autoptr(parts) p = g_new0(parts, 1);
	const char *conf = g_getenv("PLEINAIR_CONF"), *colon = strchr(uri, ':'),
		   *mark = strchr(uri, '?');
	p->file = g_key_file_new();
	p->path = g_strdup(conf ? conf : FILE_NAME);
	p->texts = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
	const char *from = colon ? colon + 1 : uri;
	p->rest = mark && mark >= from ? g_strndup(from, mark - from) : g_strdup(from);
	if (!take_file(p, error))
		return NULL;
	g_auto(GStrv) pairs = g_strsplit(mark ? mark + 1 : "", "&", -1);
	for (char **pair = pairs; *pair; pair++)
		if (**pair && !take_pair(p, uri, *pair, error))
			return NULL;
	return g_steal_pointer(&p);
}

void parts_free(parts *p)
{
	if (!p)
		return;
	g_key_file_free(p->file);
	g_hash_table_unref(p->texts);
	g_free(p->path);
	g_free(p->rest);
	g_free(p);
}

const char *parts_rest(const parts *p)
{
	return p->rest;
}

const char *parts_text(const parts *p, const char *group, const char *key)
{
	g_assert(is_known(group, key));
	g_autofree char *name = g_strdup_printf("%s.%s", group, key);
	const char *text = g_hash_table_lookup(p->texts, name);
	return text && *text ? text : NULL;
}

bool parts_number(const parts *p, const char *group, const char *key, double min, double max,
	double otherwise, double *ret, GError **error)
{
	const char *text = parts_text(p, group, key);
	char *end;
	*ret = otherwise;
	if (!text)
		return true;
	double number = g_ascii_strtod(text, &end);
	if (end == text || *end || !(number >= min && number <= max)) {
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
			"%s: [%s] %s=%s is not a number from %g to %g", p->path, group, key, text,
			min, max);
		return false;
	}
	*ret = number;
	return true;
}

bool parts_flag(const parts *p, const char *group, const char *key, bool otherwise, bool *ret,
	GError **error)
{
	const char *text = parts_text(p, group, key);
	*ret = text ? strcmp(text, "1") == 0 || strcmp(text, "yes") == 0 ||
			       strcmp(text, "true") == 0
		    : otherwise;
	if (!text || *ret || strcmp(text, "0") == 0 || strcmp(text, "no") == 0 ||
		strcmp(text, "false") == 0)
		return true;
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN, "%s: [%s] %s=%s is neither yes nor no",
		p->path, group, key, text);
	return false;
}
