#include "acquire/strict-json.h"
#include "firmware-io/crc32c.h"
#include "firmware-io/files.h"
#include "process/product-format.h"
#include "process/product.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define BUFFER_BYTES ((size_t)1 << 20)

struct product_writer {
	char *path, *beside; /* beside: .NAME.new, until it is whole */
	int fd;
	uint64_t at; /* bytes that were appended, those in the buffer too */
	uint8_t *buffer;
	size_t buffered;
	GArray *table; /* of struct product_entry; the last one is open */
	bool is_open, has_failed;
};

static bool failed(product_writer *w, GError **error)
{
	w->has_failed = true;
	return files_fail(error, w->path, "write");
}

static bool write_bytes(product_writer *w, const uint8_t *bytes, size_t length, GError **error)
{
	while (length) {
		ssize_t n = write(w->fd, bytes, length);
		if (n < 0 && errno != EINTR)
			return failed(w, error);
		bytes += n > 0 ? n : 0;
		length -= n > 0 ? (size_t)n : 0;
	}
	return true;
}

static bool flush(product_writer *w, GError **error)
{
	size_t length = w->buffered;
	w->buffered = 0;
	return write_bytes(w, w->buffer, length, error);
}

static bool put(product_writer *w, const void *bytes, size_t length, GError **error)
{
	w->at += length;
	if (length > BUFFER_BYTES - w->buffered && !flush(w, error))
		return false;
	if (length > BUFFER_BYTES)
		return write_bytes(w, bytes, length, error);
	if (length)
		memcpy(w->buffer + w->buffered, bytes, length);
	w->buffered += length;
	return true;
}

static bool pad(product_writer *w, GError **error)
{
	static const uint8_t zeros[PRODUCT_ALIGNMENT];
	return put(w, zeros, -w->at % PRODUCT_ALIGNMENT, error);
}

product_writer *product_writer_new(const char *path, GError **error)
{
	g_autoptr(product_writer) w = g_new0(product_writer, 1);
	g_autofree char *folder = g_path_get_dirname(path), *base = g_path_get_basename(path);
	g_autofree char *name = g_strdup_printf(".%s.new", base);
	g_autofree char *beside = g_build_filename(folder, name, NULL);
	w->path = g_strdup(path);
	w->fd = open(beside, O_RDWR | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
	if (w->fd < 0)
		return files_fail(error, path, "write"), NULL;
	w->beside = g_steal_pointer(&beside);
	w->buffer = g_malloc(BUFFER_BYTES);
	w->table = g_array_new(FALSE, TRUE, sizeof(struct product_entry));
	/* The header's place; it is known last. */
	static const struct product_header empty;
	return put(w, &empty, sizeof empty, error) ? g_steal_pointer(&w) : NULL;
}

bool product_writer_begin(
	product_writer *w, const char *name, uint32_t element_bytes, GError **error)
{
	g_assert(w->table && w->table->len < PRODUCT_SECTIONS_MAX && element_bytes > 0);
	if (!pad(w, error))
		return false;
	struct product_entry e = { .element_bytes = element_bytes, .offset = w->at };
	g_assert(name[0] && strlen(name) < sizeof e.name);
	for (guint i = 0; i < w->table->len; i++)
		g_assert(strcmp(g_array_index(w->table, struct product_entry, i).name, name));
	strcpy(e.name, name);
	g_array_append_val(w->table, e);
	w->is_open = true;
	return true;
}

bool product_writer_append(product_writer *w, const void *elements, uint64_t count, GError **error)
{
	g_assert(w->is_open);
	struct product_entry *e = &g_array_index(w->table, struct product_entry, w->table->len - 1);
	size_t bytes;
	g_assert(!__builtin_mul_overflow(count, e->element_bytes, &bytes));
	e->crc32c = crc32c(e->crc32c, elements, bytes);
	e->elements += count;
	return put(w, elements, bytes, error);
}

static bool write_manifest(
	product_writer *w, const char *kind, int version, JsonObject *manifest, GError **error)
{
	g_autoptr(JsonNode) root = json_node_new(JSON_NODE_OBJECT);
	json_object_set_string_member(manifest, "kind", kind);
	json_object_set_int_member(manifest, "version", version);
	json_node_set_object(root, manifest);
	g_autofree char *text = strict_json_write(root);
	g_assert(strlen(text) <= PRODUCT_MANIFEST_MAX);
	return product_writer_begin(w, PRODUCT_MANIFEST, 1, error) &&
	       product_writer_append(w, text, strlen(text), error);
}

static bool write_table(product_writer *w, GError **error)
{
	if (!pad(w, error))
		return false;
	size_t bytes = w->table->len * sizeof(struct product_entry);
	struct product_header h = { .magic = PRODUCT_MAGIC,
		.container = PRODUCT_CONTAINER,
		.sections = w->table->len,
		.table_offset = w->at,
		.file_bytes = w->at + bytes,
		.table_crc32c = crc32c(0, w->table->data, bytes) };
	h.header_crc32c = crc32c(0, &h, offsetof(struct product_header, header_crc32c));
	return put(w, w->table->data, bytes, error) && flush(w, error) &&
	       (pwrite(w->fd, &h, sizeof h, 0) == sizeof h || failed(w, error));
}

static bool rename_whole(product_writer *w, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(w->path);
	if (fsync(w->fd) || rename(w->beside, w->path))
		return failed(w, error);
	g_clear_pointer(&w->beside, g_free);
	return files_sync_folder(folder, error);
}

bool product_writer_finish(
	product_writer *w, const char *kind, int version, JsonObject *manifest, GError **error)
{
	g_autoptr(JsonObject) m = manifest;
	if (w->has_failed) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: could not be written whole",
			w->path);
		return false;
	}
	return write_manifest(w, kind, version, m, error) && write_table(w, error) &&
	       rename_whole(w, error);
}

void product_writer_free(product_writer *w)
{
	if (!w)
		return;
	if (w->fd >= 0)
		close(w->fd);
	if (w->beside)
		unlink(w->beside);
	if (w->table)
		g_array_unref(w->table);
	g_free(w->buffer);
	g_free(w->beside);
	g_free(w->path);
	g_free(w);
}
