/* Any bytes as a record: reading ends, stays inside the file, and what record_append_to accepts can
 * be gone on with. The last byte says whether checksums are mended first; without that few inputs
 * would get past them. */
#include "firmware-io/record-format.h"
#include "firmware-io/record.h"
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void mend(uint8_t *bytes, size_t size)
{
	struct record_file_header file;
	struct record_head h;
	if (size < sizeof file)
		return;
	memcpy(&file, bytes, sizeof file);
	file.crc = GUINT32_TO_LE(record_file_header_crc(&file));
	memcpy(bytes, &file, sizeof file);
	for (size_t at = sizeof file; at + sizeof h <= size; at += 8) {
		memcpy(&h, bytes + at, sizeof h);
		size_t length = GUINT32_FROM_LE(h.length);
		if (GUINT32_FROM_LE(h.mark) != RECORD_ENTRY_MARK || length > size - at - sizeof h)
			continue;
		h.crc = GUINT32_TO_LE(crc32c(record_head_crc(&h), bytes + at + sizeof h, length));
		memcpy(bytes + at, &h, sizeof h);
	}
}

/* The whole entries up to the first that is not; sums up what they hold, so that all of it is read.
 */
static uint32_t walk(record_reader *r, bool skip, enum record_result *ret_result)
{
	struct record_entry e;
	uint32_t entries = 0, sum = 0;
	for (;;) {
		uint64_t before = record_reader_position(r);
		g_autoptr(GError) error = NULL;
		*ret_result = record_next(r, &e, &error);
		g_assert_true((*ret_result == RECORD_BAD) == (error != NULL));
		if (*ret_result == RECORD_BAD && skip && record_skip_damage(r)) {
			g_assert_cmpuint(record_reader_position(r), >, before);
			continue;
		}
		if (*ret_result != RECORD_ENTRY)
			break;
		g_assert_cmpuint(e.offset, ==, before);
		g_assert_cmpuint((uintptr_t)e.payload % 8, ==, 0);
		g_assert_cmpuint(e.offset + 32 + e.length, <=, record_reader_size(r));
		sum = crc32c(sum, e.payload, e.length);
		entries++;
	}
	g_assert_cmpuint(entries, <=, record_reader_size(r) / 32);
	return entries + (sum == 1);
}

static record_reader *open_record(const void *bytes, size_t size)
{
	g_autoptr(GBytes) copy = g_bytes_new(bytes, size);
	return record_open_bytes(copy, "x", NULL);
}

static void go_on(const uint8_t *bytes, size_t size)
{
	int fd = memfd_create("record", MFD_CLOEXEC);
	g_autofree char *path = g_strdup_printf("/proc/self/fd/%d", fd);
	g_assert_cmpint(write(fd, bytes, size), ==, (ssize_t)size);
	enum record_result result;
	g_autoptr(record_reader) before = open_record(bytes, size);
	uint32_t entries = before ? walk(before, false, &result) : 0;
	record_writer *w = record_append_to(path, NULL, NULL);
	g_assert_true((w != NULL) == (before && result != RECORD_BAD));
	if (w) {
		g_assert_true(record_write(w, RECORD_END, 0, "abc", 3, NULL, 0, NULL));
		g_assert_true(record_close(w, NULL));
		g_autoptr(record_reader) after = record_open(path, NULL);
		g_assert_cmpuint(walk(after, false, &result), ==, entries + 1);
		g_assert_cmpint(result, ==, RECORD_AT_END);
	}
	close(fd);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autofree uint8_t *bytes = g_memdup2(data, size);
	if (size && bytes[--size] & 1)
		mend(bytes, size);
	enum record_result result;
	g_autoptr(record_reader) r = open_record(bytes, size);
	if (r)
		walk(r, true, &result);
	go_on(bytes, size);
	return 0;
}
