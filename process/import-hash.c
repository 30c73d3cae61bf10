#include "process/import-hash.h"
#include "firmware-io/sha256.h"
#include "process/import.h"

#define BLOCK_BYTES (256u << 10)

struct import_hash {
	char *path, *sum;
	GThread *thread;
	GError *error;
	int stop; /* atomic */
};

static gpointer hash(gpointer data)
{
	import_hash *h = data;
	g_autoptr(import_source) file = import_source_open(h->path, &h->error);
	g_autoptr(sha256) sum = sha256_new();
	g_autofree uint8_t *block = g_malloc(BLOCK_BYTES);
	uint64_t at = 0;
	for (size_t got = 1; file && got && !g_atomic_int_get(&h->stop); at += got) {
		if (!import_source_read(file, at, block, BLOCK_BYTES, &got, &h->error))
			return NULL;
		sha256_update(sum, block, got);
	}
	if (file)
		h->sum = sha256_end(sum);
	return NULL;
}

import_hash *import_hash_begin(const char *path)
{
	import_hash *h = g_new0(import_hash, 1);
	h->path = g_strdup(path);
	h->thread = g_thread_new("hash", hash, h);
	return h;
}

static void join(import_hash *h)
{
	if (h->thread)
		g_thread_join(g_steal_pointer(&h->thread));
}

char *import_hash_end(import_hash *h, GError **error)
{
	join(h);
	char *sum = g_steal_pointer(&h->sum);
	if (h->error)
		g_propagate_error(error, g_steal_pointer(&h->error));
	import_hash_free(h);
	return sum;
}

void import_hash_free(import_hash *h)
{
	if (!h)
		return;
	g_atomic_int_set(&h->stop, 1);
	join(h);
	g_clear_error(&h->error);
	g_free(h->sum);
	g_free(h->path);
	g_free(h);
}
