#include "process/product.h"
#include "acquire/strict-json.h"
#include "firmware-io/crc32c.h"
#include "firmware-io/files.h"
#include "process/product-format.h"
#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* Pages that were summed up are given back, so that checking a great file does not fill the memory. */
#define VERIFY_BYTES ((size_t)16 << 20)
/* One fault maps all that was read from the disk at once, up to so much of the file, what was given back before too. So all of
 * it is given back each time; otherwise it stays and adds up. */
#define FOLIO_BYTES ((size_t)2 << 20)

struct product {
	char *path;
	const uint8_t *bytes;
	size_t length;
	dev_t device; /* which file it is */
	ino_t inode;
	const struct product_header *header;
	const struct product_entry *table;
	JsonNode *manifest;
};

G_DEFINE_QUARK(pleinair - product, product_error)

static bool damaged(const product *p, GError **error, const char *format, ...) G_GNUC_PRINTF(3, 4);
static bool damaged(const product *p, GError **error, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED, "%s: %s", p->path, what);
	return false;
}

static bool check_header(product *p, GError **error)
{
	const struct product_header *h = p->header = (const struct product_header *)p->bytes;
	if (p->length < sizeof *h || memcmp(h->magic, PRODUCT_MAGIC, sizeof h->magic))
		return damaged(p, error, "is not a product file");
	if (crc32c(0, h, offsetof(struct product_header, header_crc32c)) != h->header_crc32c)
		return damaged(p, error, "the header is damaged");
	if (h->container > PRODUCT_CONTAINER) {
		g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_VERSION,
			"%s: was written by a later version of this program (container %u)",
			p->path, h->container);
		return false;
	}
	if (h->file_bytes != p->length)
		return damaged(p, error, "has %zu bytes, but was written with %" G_GUINT64_FORMAT,
			p->length, h->file_bytes);
	return true;
}

static bool check_table(product *p, GError **error)
{
	const struct product_header *h = p->header;
	size_t bytes = (size_t)h->sections * sizeof *p->table;
	if (h->sections < 1 || h->sections > PRODUCT_SECTIONS_MAX)
		return damaged(p, error, "has %u sections", h->sections);
	if (h->table_offset % PRODUCT_ALIGNMENT || h->table_offset < sizeof *h ||
		h->table_offset > p->length || bytes != p->length - h->table_offset)
		return damaged(p, error, "the table of sections is not at the end of the file");
	p->table = (const struct product_entry *)(p->bytes + h->table_offset);
	if (crc32c(0, p->table, bytes) != h->table_crc32c)
		return damaged(p, error, "the table of sections is damaged");
	return true;
}

static const struct product_entry *find(const product *p, const char *name, uint32_t before)
{
	for (uint32_t i = 0; i < before; i++)
		if (strcmp(p->table[i].name, name) == 0)
			return &p->table[i];
	return NULL;
}

/* from: where the section before ended. */
static bool check_entry(const product *p, uint32_t which, uint64_t from, GError **error)
{
	const struct product_entry *e = &p->table[which];
	uint64_t bytes;
	if (!e->name[0] || e->name[sizeof e->name - 1] || !g_utf8_validate(e->name, -1, NULL) ||
		find(p, e->name, which))
		return damaged(p, error, "section %u has no name of its own", which + 1);
	if (!e->element_bytes || e->offset % PRODUCT_ALIGNMENT || e->offset < from ||
		e->offset > p->header->table_offset ||
		__builtin_mul_overflow(e->elements, e->element_bytes, &bytes) ||
		bytes > p->header->table_offset - e->offset)
		return damaged(p, error, "section '%s' does not lie inside the file", e->name);
	return true;
}

static bool check_entries(const product *p, GError **error)
{
	uint64_t from = sizeof *p->header;
	for (uint32_t i = 0; i < p->header->sections; i++) {
		if (!check_entry(p, i, from, error))
			return false;
		from = p->table[i].offset + p->table[i].elements * p->table[i].element_bytes;
	}
	return true;
}

static bool parse_manifest(product *p, GError **error)
{
	const struct product_entry *e = find(p, PRODUCT_MANIFEST, p->header->sections);
	if (!e || e->element_bytes != 1 || e->elements > PRODUCT_MANIFEST_MAX)
		return damaged(p, error, "has no manifest");
	const char *text = (const char *)p->bytes + e->offset;
	if (crc32c(0, text, e->elements) != e->crc32c)
		return damaged(p, error, "the manifest is damaged");
	p->manifest = strict_json_read(text, e->elements, error);
	if (!p->manifest)
		return g_prefix_error(error, "%s: manifest: ", p->path), false;
	return JSON_NODE_HOLDS_OBJECT(p->manifest) ||
	       damaged(p, error, "the manifest is no object");
}

static bool check_kind(const product *p, const char *kind, int version, GError **error)
{
	JsonNode *k = json_object_get_member(product_manifest(p), "kind");
	JsonNode *v = json_object_get_member(product_manifest(p), "version");
	const char *found = k && JSON_NODE_HOLDS_VALUE(k) ? json_node_get_string(k) : NULL;
	if (!found || !v || json_node_get_value_type(v) != G_TYPE_INT64 || json_node_get_int(v) < 1)
		return damaged(p, error, "the manifest does not say what the file is");
	if (strcmp(found, kind)) {
		g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_KIND,
			"%s: is a file of kind '%s', not '%s'", p->path, found, kind);
		return false;
	}
	if (json_node_get_int(v) > version) {
		g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_VERSION,
			"%s: was written by a later version of this program (%s %" G_GINT64_FORMAT
			")",
			p->path, kind, json_node_get_int(v));
		return false;
	}
	return true;
}

static bool map(product *p, GError **error)
{
	int fd = files_open_plain(p->path, &p->length, error);
	if (fd < 0)
		return false;
	void *bytes = p->length ? mmap(NULL, p->length, PROT_READ, MAP_SHARED, fd, 0) : NULL;
	struct stat about;
	bool ok = (bytes != MAP_FAILED && fstat(fd, &about) == 0) ||
		  files_fail(error, p->path, "map");
	if (ok) {
		p->device = about.st_dev;
		p->inode = about.st_ino;
	}
	close(fd);
	p->bytes = ok ? bytes : NULL;
	return ok;
}

int product_version(const product *p)
{
	return (int)json_object_get_int_member(product_manifest(p), "version");
}

product *product_open(const char *path, const char *kind, int version, GError **error)
{
	g_autoptr(product) p = g_new0(product, 1);
	p->path = g_strdup(path);
	if (!map(p, error) || !check_header(p, error) || !check_table(p, error) ||
		!check_entries(p, error) || !parse_manifest(p, error) ||
		!check_kind(p, kind, version, error))
		return NULL;
	return g_steal_pointer(&p);
}

void product_free(product *p)
{
	if (!p)
		return;
	if (p->bytes)
		munmap((void *)p->bytes, p->length);
	g_clear_pointer(&p->manifest, json_node_unref);
	g_free(p->path);
	g_free(p);
}

const char *product_path(const product *p)
{
	return p->path;
}

JsonObject *product_manifest(const product *p)
{
	return json_node_get_object(p->manifest);
}

uint32_t product_checksum(const product *p)
{
	return p->header->table_crc32c;
}

const void *product_section(const product *p, const char *name, uint32_t element_bytes,
	uint64_t *ret_elements, GError **error)
{
	const struct product_entry *e = find(p, name, p->header->sections);
	if (!e)
		return damaged(p, error, "has no section '%s'", name), NULL;
	if (e->element_bytes != element_bytes) {
		damaged(p, error, "section '%s' has elements of %u bytes, not %u", name,
			e->element_bytes, element_bytes);
		return NULL;
	}
	*ret_elements = e->elements;
	return p->bytes + e->offset;
}

uint32_t product_section_checksum(const product *p, const char *name)
{
	const struct product_entry *e = find(p, name, p->header->sections);
	return e ? e->crc32c : 0;
}

static bool verify_section(const product *p, const struct product_entry *e, GError **error)
{
	uint32_t crc = 0;
	uint64_t bytes = e->elements * e->element_bytes;
	for (uint64_t at = 0; at < bytes; at += VERIFY_BYTES) {
		size_t n = MIN(VERIFY_BYTES, bytes - at);
		crc = crc32c(crc, p->bytes + e->offset + at, n);
		product_forget(p, p->bytes + e->offset + at, n);
	}
	return crc == e->crc32c || damaged(p, error, "section '%s' is damaged", e->name);
}

bool product_verify(const product *p, GError **error)
{
	for (uint32_t i = 0; i < p->header->sections; i++)
		if (!verify_section(p, &p->table[i], error))
			return false;
	return true;
}

int product_reopen(const product *p, GError **error)
{
	size_t length;
	struct stat about;
	int fd = files_open_plain(p->path, &length, error);
	if (fd < 0)
		return -1;
	if (fstat(fd, &about) == 0 && about.st_dev == p->device && about.st_ino == p->inode)
		return fd;
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: was made anew while it was opened", p->path);
	close(fd);
	return -1;
}

bool product_read(
	const product *p, int fd, const void *from, size_t bytes, void *to, GError **error)
{
	off_t at = (const uint8_t *)from - p->bytes;
	while (bytes) {
		ssize_t n = pread(fd, to, bytes, at);
		if (n < 0 && errno != EINTR)
			return files_fail(error, p->path, "read");
		if (n == 0)
			return damaged(p, error, "is shorter than it was when it was opened");
		if (n < 0)
			continue;
		to = (uint8_t *)to + n;
		at += n;
		bytes -= (size_t)n;
	}
	return true;
}

void product_forget(const product *p, const void *from, size_t bytes)
{
	const uintptr_t base = (uintptr_t)p->bytes;
	g_assert((uintptr_t)from >= base && bytes <= base + p->length - (uintptr_t)from);
	size_t begin = ((uintptr_t)from - base) / FOLIO_BYTES * FOLIO_BYTES;
	size_t end = (uintptr_t)from - base + bytes;
	end = MIN((end + FOLIO_BYTES - 1) / FOLIO_BYTES * FOLIO_BYTES, p->length);
	if (bytes)
		madvise((void *)(base + begin), end - begin, MADV_DONTNEED);
}
