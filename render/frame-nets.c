#include "render/frame-nets.h"
#include "firmware-io/files.h"
#include <string.h>

#define NET_BYTES_MAX (512u << 20)
#define TRIED         64u

struct frame_nets {
	GHashTable *by_path; /* of semantic_net; paths are interned */
};

/* A grey picture becomes a picture of the same size. */
static bool try_net(semantic_net *n, const char *path, GError **error)
{
	size_t numbers = 3 * TRIED * TRIED;
	g_autofree float *in = g_new(float, numbers), *out = g_new(float, numbers);
	for (size_t k = 0; k < numbers; k++)
		in[k] = 128;
	return semantic_net_run(n, in, 3, TRIED, TRIED, 3, out, path, error);
}

static bool add(frame_nets *n, const char *path, GError **error)
{
	size_t length;
	if (g_hash_table_contains(n->by_path, path))
		return true;
	if (!*path) {
		g_set_error(error, STYLE_ERROR, STYLE_ERROR_FIELD,
			"a step 'neural' needs a \"model\", the path of a .onnx");
		return false;
	}
	g_autofree char *bytes = files_read(path, NET_BYTES_MAX, &length, error);
	g_autoptr(semantic_net) net =
		bytes ? semantic_net_new((const uint8_t *)bytes, length, path, error) : NULL;
	if (!net || !try_net(net, path, error))
		return false;
	g_hash_table_insert(n->by_path, (gpointer)path, g_steal_pointer(&net));
	return true;
}

static bool add_all(frame_nets *n, const struct pipeline *p, GError **error)
{
	for (uint32_t k = p->layers; k < p->layers + p->filters; k++)
		if (strcmp(p->steps[k].kind->name, "neural") == 0 &&
			!add(n, p->steps[k].neural.model, error))
			return false;
	return true;
}

frame_nets *frame_nets_new(const drawing *d, GError **error)
{
	frame_nets *n = g_new0(frame_nets, 1);
	bool good = true;
	n->by_path = g_hash_table_new_full(
		g_direct_hash, g_direct_equal, NULL, (GDestroyNotify)semantic_net_free);
	for (guint k = 0; good && k < d->pipelines->len; k++)
		good = add_all(n, &g_array_index(d->pipelines, struct pipeline, k), error);
	good = good && add_all(n, &d->picture, error);
	if (good && g_hash_table_size(n->by_path))
		return n;
	frame_nets_free(n);
	return NULL;
}

void frame_nets_free(frame_nets *n)
{
	if (!n)
		return;
	g_hash_table_unref(n->by_path);
	g_free(n);
}

semantic_net *frame_nets_find(const frame_nets *n, const char *model)
{
	return n ? g_hash_table_lookup(n->by_path, model) : NULL;
}
