#include "process/align-store.h"

/* So many scans at a time are in memory as a whole; a fine one takes 70 MB. */
#define READ_AT_ONCE 2

struct entry {
	align_scan *scan; /* NULL: a thread is making it */
	uint32_t number, users;
	uint64_t used; /* when it was last given back */
};

struct align_store {
	const site *site;
	alikes *known; /* under the mutex */
	uint64_t bytes_max, bytes, clock;
	uint32_t reading; /* scans that are in memory as a whole */
	GMutex mutex;
	GCond made, read;
	GHashTable *entries; /* number -> struct entry */
};

static void free_entry(gpointer data)
{
	struct entry *e = data;
	align_scan_free(e->scan);
	g_free(e);
}

align_store *align_store_new(const site *s, uint64_t bytes_max, alikes *known)
{
	align_store *store = g_new0(align_store, 1);
	store->site = s;
	store->known = known;
	store->bytes_max = bytes_max;
	g_mutex_init(&store->mutex);
	g_cond_init(&store->made);
	g_cond_init(&store->read);
	store->entries = g_hash_table_new_full(NULL, NULL, NULL, free_entry);
	return store;
}

void align_store_free(align_store *store)
{
	if (!store)
		return;
	g_hash_table_unref(store->entries);
	g_mutex_clear(&store->mutex);
	g_cond_clear(&store->made);
	g_cond_clear(&store->read);
	g_free(store);
}

static bool find_known(align_store *store, const char *fingerprint, struct pair_alikes *ret)
{
	g_mutex_lock(&store->mutex);
	const struct pair_alikes *is = alikes_get(store->known, fingerprint);
	if (is)
		*ret = *is;
	g_mutex_unlock(&store->mutex);
	return is;
}

static align_scan *read_scan(align_store *store, uint32_t number, GError **error)
{
	struct pair_alikes known;
	g_autoptr(scan_data) d = scan_data_load(store->site, number, error);
	bool is_known = d && find_known(store, d->fingerprint, &known);
	return d ? align_scan_new_known(d, is_known ? &known : NULL, error) : NULL;
}

/* With the mutex held. */
static void learn(align_store *store, const align_scan *scan)
{
	struct pair_alikes is;
	const char *fingerprint = align_scan_fingerprint(scan);
	if (align_scan_alikes(scan, &is) && !alikes_get(store->known, fingerprint))
		alikes_set(store->known, fingerprint, &is);
}

static struct entry *least_used(align_store *store)
{
	GHashTableIter iter;
	gpointer value;
	struct entry *least = NULL;
	g_hash_table_iter_init(&iter, store->entries);
	while (g_hash_table_iter_next(&iter, NULL, &value)) {
		struct entry *e = value;
		if (e->scan && !e->users && (!least || e->used < least->used))
			least = e;
	}
	return least;
}

static void make_room(align_store *store)
{
	struct entry *e;
	while (store->bytes > store->bytes_max && (e = least_used(store))) {
		store->bytes -= align_scan_bytes(e->scan);
		g_hash_table_remove(store->entries, GUINT_TO_POINTER(e->number));
	}
}

/* With the mutex held, which is let go meanwhile. */
static struct entry *make_entry(align_store *store, uint32_t number, GError **error)
{
	struct entry *e = g_new0(struct entry, 1);
	e->number = number;
	g_hash_table_insert(store->entries, GUINT_TO_POINTER(number), e);
	while (store->reading == READ_AT_ONCE)
		g_cond_wait(&store->read, &store->mutex);
	store->reading++;
	g_mutex_unlock(&store->mutex);
	align_scan *scan = read_scan(store, number, error);
	g_mutex_lock(&store->mutex);
	store->reading--;
	g_cond_signal(&store->read);
	e->scan = scan;
	if (scan) {
		store->bytes += align_scan_bytes(scan);
		learn(store, scan);
	} else
		g_hash_table_remove(store->entries, GUINT_TO_POINTER(number));
	g_cond_broadcast(&store->made);
	return scan ? e : NULL;
}

const align_scan *align_store_get(align_store *store, uint32_t number, GError **error)
{
	struct entry *e;
	g_mutex_lock(&store->mutex);
	while ((e = g_hash_table_lookup(store->entries, GUINT_TO_POINTER(number))) && !e->scan)
		g_cond_wait(&store->made, &store->mutex);
	if (!e)
		e = make_entry(store, number, error);
	const align_scan *scan = e ? e->scan : NULL;
	if (e) {
		e->users++;
		make_room(store);
	}
	g_mutex_unlock(&store->mutex);
	return scan;
}

void align_store_give_back(align_store *store, const align_scan *scan)
{
	if (!scan)
		return;
	g_mutex_lock(&store->mutex);
	struct entry *e =
		g_hash_table_lookup(store->entries, GUINT_TO_POINTER(align_scan_number(scan)));
	e->users--;
	e->used = ++store->clock;
	make_room(store);
	g_mutex_unlock(&store->mutex);
}
