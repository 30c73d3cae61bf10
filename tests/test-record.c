/* The record file: what is written comes back, and no damage makes it come back wrong. */
#include "firmware-io/files.h"
#include "firmware-io/record-format.h"
#include "firmware-io/record.h"
#include "tests/known-entries.h"
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <unistd.h>

enum { SMALL = 40 }; /* longest payload of the records that are damaged at every place */

/* Thousands of small records are made here; whether the disk keeps them is a matter for
 * test-record-faults. */
int fsync(int fd)
{
	(void)fd;
	return 0;
}

int fdatasync(int fd)
{
	(void)fd;
	return 0;
}

struct folder {
	char *path, *file;
};

static void set_up(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	f->path = g_dir_make_tmp("record-XXXXXX", &error);
	g_assert_no_error(error);
	f->file = g_build_filename(f->path, "raw.rec", NULL);
}

static void tear_down(struct folder *f, gconstpointer data)
{
	(void)data;
	g_assert_true(files_remove_tree(f->path, NULL));
	g_free(f->file);
	g_free(f->path);
}

static void write_known(const char *path, uint32_t count, uint32_t longest)
{
	g_autoptr(GError) error = NULL;
	record_writer *w = record_create(path, &error);
	g_assert_no_error(error);
	for (uint32_t i = 0; i < count; i++)
		g_assert_true(known_write(w, i, longest, NULL));
	uint64_t size = record_writer_size(w);
	record_close(w, &error);
	g_assert_no_error(error);
	GStatBuf st;
	g_assert_cmpint(g_stat(path, &st), ==, 0);
	g_assert_cmpuint((uint64_t)st.st_size, ==, size);
}

static GByteArray *contents(const char *path)
{
	char *bytes;
	size_t length;
	g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
	return g_byte_array_new_take((guint8 *)bytes, length);
}

static void replace(const char *path, const void *bytes, size_t length)
{
	g_assert_true(g_file_set_contents(path, bytes, (gssize)length, NULL));
}

static record_reader *open_copy(const void *bytes, size_t length, GError **error)
{
	g_autoptr(GBytes) copy = g_bytes_new(bytes, length);
	return record_open_bytes(copy, "x.rec", error);
}

/* Entries 0 .. *ret_count - 1 are there and right; how the record ends. */
static enum record_result read_known(record_reader *r, uint32_t longest, uint32_t *ret_count)
{
	struct record_entry e;
	enum record_result result;
	*ret_count = 0;
	while ((result = record_next(r, &e, NULL)) == RECORD_ENTRY) {
		g_assert_cmpuint(e.sequence, ==, (*ret_count)++);
		known_check(&e, longest);
	}
	if (result == RECORD_CUT)
		g_assert_cmpuint(e.offset, ==, record_reader_position(r));
	return result;
}

static void assert_whole(const char *path, uint32_t longest, uint32_t count)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(record_reader) r = record_open(path, &error);
	g_assert_no_error(error);
	uint32_t read;
	g_assert_cmpint(read_known(r, longest, &read), ==, RECORD_AT_END);
	g_assert_cmpuint(read, ==, count);
	g_assert_cmpuint(record_reader_position(r), ==, record_reader_size(r));
}

/* offsets[i] is entry i's; offsets[count] the file's size. */
static GArray *entry_offsets(const GByteArray *file)
{
	g_autoptr(record_reader) r = open_copy(file->data, file->len, NULL);
	GArray *offsets = g_array_new(false, false, sizeof(uint64_t));
	uint64_t at = record_reader_position(r);
	struct record_entry e;
	g_array_append_val(offsets, at);
	while (record_next(r, &e, NULL) == RECORD_ENTRY) {
		at = record_reader_position(r);
		g_array_append_val(offsets, at);
	}
	return offsets;
}

static void test_round_trip(struct folder *f, gconstpointer data)
{
	(void)data;
	write_known(f->file, 500, 5000);
	assert_whole(f->file, 5000, 500);
	for (uint32_t i = 500; i < 900; i += 100) {
		uint64_t cut = 1;
		g_autoptr(GError) error = NULL;
		record_writer *w = record_append_to(f->file, &cut, &error);
		g_assert_no_error(error);
		g_assert_cmpuint(cut, ==, 0);
		for (uint32_t n = i; n < i + 100; n++)
			g_assert_true(known_write(w, n, 5000, NULL));
		g_assert_true(record_close(w, NULL));
	}
	assert_whole(f->file, 5000, 900);
}

static void test_limits(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_autoptr(record_writer) w = record_create(f->file, &error);
	g_assert_no_error(error);
	g_autofree char *pixels = g_malloc0(RECORD_PAYLOAD_MAX);
	g_assert_false(
		record_write(w, RECORD_FRAME, 0, pixels, RECORD_PAYLOAD_MAX, pixels, 1, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_MESSAGE_TOO_LARGE);
	g_assert_true(record_write(
		w, RECORD_FRAME, INT64_MIN, pixels, 16, pixels, RECORD_PAYLOAD_MAX - 16, NULL));
	g_assert_true(record_write(w, RECORD_END, -1, NULL, 0, NULL, 0, NULL));
	g_autoptr(record_reader) r = record_open(f->file, NULL);
	struct record_entry e;
	g_assert_cmpint(record_next(r, &e, NULL), ==, RECORD_ENTRY);
	g_assert_cmpuint(e.length, ==, RECORD_PAYLOAD_MAX);
	g_assert_cmpint(e.time_ns, ==, INT64_MIN);
	g_assert_cmpint(record_next(r, &e, NULL), ==, RECORD_ENTRY);
	g_assert_cmpint(e.kind, ==, RECORD_END);
	g_assert_cmpint(record_next(r, &e, NULL), ==, RECORD_AT_END);
}

static void test_create_once(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	write_known(f->file, 3, SMALL);
	g_assert_null(record_create(f->file, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_EXISTS);
	assert_whole(f->file, SMALL, 3);
	g_autoptr(GPtrArray) names = files_names(f->path, NULL);
	g_assert_cmpuint(names->len, ==, 1);
}

static void test_not_a_record(void)
{
	static const struct {
		const char *bytes;
		size_t length;
		const char *message;
	} cases[] = {
		{ "", 0, "x.rec: is empty" },
		{ "P", 1, "x.rec: ends after 1 of the 16 bytes of its header" },
		{ "GIF89a", 6, "x.rec: is not a pleinair record (it begins with \"GIF89a\")" },
		{ "\x89PNG\r\n\x1a\n....", 12,
			"x.rec: is not a pleinair record (it begins with 89 50 4e 47 0d 0a 1a "
			"0a)" },
		{ "PLEINREC\1\0\0\0abcd", 16, "x.rec: the checksum of its header does not match" },
		{ "PLEINREC\2\0\0\0\xe4\xf4\xa5\x01", 16,
			"x.rec: is a record of version 2; this program reads version 1" },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
		g_autoptr(GError) error = NULL;
		struct record_file_header h;
		g_autofree char *bytes = g_memdup2(cases[i].bytes, cases[i].length);
		if (strstr(cases[i].message, "version")) {
			memcpy(&h, bytes, sizeof h);
			h.crc = GUINT32_TO_LE(record_file_header_crc(&h));
			memcpy(bytes, &h, sizeof h);
		}
		g_assert_null(open_copy(bytes, cases[i].length, &error));
		g_assert_cmpstr(error->message, ==, cases[i].message);
	}
}

static void test_other_things(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) folder = NULL, missing = NULL, pipe = NULL;
	g_assert_null(record_open(f->path, &folder));
	g_assert_error(folder, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
	g_assert_null(record_open(f->file, &missing));
	g_assert_error(missing, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_assert_cmpint(mkfifo(f->file, 0600), ==, 0);
	g_assert_null(record_append_to(f->file, NULL, &pipe));
	g_assert_error(pipe, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
}

/* Whatever a flipped bit hits, what is read is right, in order, and all the others are still found.
 */
static void check_flipped(const GByteArray *file, uint32_t count, bool *ret_bad, bool *ret_cut)
{
	g_autoptr(record_reader) r = open_copy(file->data, file->len, NULL);
	struct record_entry e;
	enum record_result result;
	uint32_t read = 0;
	int64_t last = -1;
	while ((result = record_next(r, &e, NULL)) == RECORD_ENTRY || result == RECORD_BAD) {
		if (result == RECORD_BAD) {
			*ret_bad = true;
			g_assert_cmpuint(record_skip_damage(r), >=, 32);
			continue;
		}
		g_assert_cmpint(e.sequence, >, last);
		last = e.sequence;
		known_check(&e, SMALL);
		read++;
	}
	*ret_cut |= result == RECORD_CUT;
	g_assert_cmpuint(read, >=, count - 1);
	g_assert_true(read == count || result == RECORD_CUT || *ret_bad);
}

static void test_each_bit(struct folder *f, gconstpointer data)
{
	(void)data;
	enum { COUNT = 9 };
	bool bad = false, cut = false;
	write_known(f->file, COUNT, SMALL);
	g_autoptr(GByteArray) file = contents(f->file);
	for (uint32_t bit = 0; bit < file->len * 8; bit++) {
		file->data[bit / 8] ^= (guint8)(1 << bit % 8);
		if (bit / 8 < sizeof(struct record_file_header))
			g_assert_null(open_copy(file->data, file->len, NULL));
		else
			check_flipped(file, COUNT, &bad, &cut);
		file->data[bit / 8] ^= (guint8)(1 << bit % 8);
	}
	g_assert_true(bad && cut);
}

static void check_cut(const char *path, const GArray *offsets, uint64_t length, uint32_t whole)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(record_reader) r = record_open(path, &error);
	g_assert_no_error(error);
	uint32_t read;
	uint64_t end = g_array_index(offsets, uint64_t, whole), cut = 0;
	g_assert_cmpint(
		read_known(r, SMALL, &read), ==, end == length ? RECORD_AT_END : RECORD_CUT);
	g_assert_cmpuint(read, ==, whole);
	g_clear_pointer(&r, record_reader_free);

	record_writer *w = record_append_to(path, &cut, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(cut, ==, length - end);
	g_assert_cmpuint(record_writer_size(w), ==, end);
	for (uint32_t i = whole; i < whole + 2; i++)
		g_assert_true(known_write(w, i, SMALL, NULL));
	g_assert_true(record_close(w, NULL));
	assert_whole(path, SMALL, whole + 2);
}

/* What a power cut can leave behind the last whole entry. */
static void test_each_length(struct folder *f, gconstpointer data)
{
	enum tail { NOTHING, ZEROS, GARBAGE } tail = GPOINTER_TO_INT(data);
	write_known(f->file, 9, SMALL);
	g_autoptr(GByteArray) file = contents(f->file);
	g_autoptr(GArray) offsets = entry_offsets(file);
	uint32_t whole = 0;
	for (uint32_t length = 16; length <= file->len; length += tail ? 5 : 1) {
		uint32_t extra = tail ? 1 + length * 7 % 300 : 0;
		g_autofree uint8_t *torn = g_malloc0(length + extra);
		memcpy(torn, file->data, length);
		for (uint32_t i = 0; tail == GARBAGE && i < extra; i++)
			torn[length + i] = (uint8_t)(1 + g_test_rand_int_range(0, 255));
		while (whole + 1 < offsets->len &&
			g_array_index(offsets, uint64_t, whole + 1) <= length)
			whole++;
		/* In the padding it does not matter what it is cut to. */
		if (tail && whole + 1 < offsets->len &&
			g_array_index(offsets, uint64_t, whole + 1) < length + 8)
			continue;
		replace(f->file, torn, length + extra);
		check_cut(f->file, offsets, length + extra, whole);
	}
}

static void put32(uint8_t *at, uint32_t value)
{
	value = GUINT32_TO_LE(value);
	memcpy(at, &value, sizeof value);
}

static const struct {
	size_t field;
	uint32_t value;
	const char *message;
} spoilt_fields[] = {
	{ 0, 0, "no entry begins there" },
	{ 4, 77, "there is no kind 77 of entry" },
	{ 8, 3221225472u, "it claims 3221225472 bytes, but the file ends after 112" },
	{ 8, 4294967295u, "it claims 4294967295 bytes, but the file ends after 112" },
	{ 8, 113, "it claims 113 bytes, but the file ends after 112" },
	{ 8, 1, "its checksum does not match" },
	{ 12, 1, "it is numbered 1" },
	{ 16, 1, "its checksum does not match" },
	{ 24, 1, "its reserved bytes are not zero" },
	{ 28, 1, "its checksum does not match" },
};

/* One field of entry 2 is overwritten; the whole sentence is compared. */
static void test_sentences(struct folder *f, gconstpointer data)
{
	(void)data;
	write_known(f->file, 5, SMALL);
	g_autoptr(GByteArray) file = contents(f->file);
	g_autoptr(GArray) offsets = entry_offsets(file);
	uint64_t at = g_array_index(offsets, uint64_t, 2);
	for (size_t i = 0; i < G_N_ELEMENTS(spoilt_fields); i++) {
		g_autofree uint8_t *bytes = g_memdup2(file->data, file->len);
		g_autofree char *message = g_strdup_printf(
			"x.rec: entry 2 at byte %u: %s", (unsigned)at, spoilt_fields[i].message);
		put32(bytes + at + spoilt_fields[i].field, spoilt_fields[i].value);
		g_autoptr(GError) error = NULL;
		g_autoptr(record_reader) r = open_copy(bytes, file->len, NULL);
		struct record_entry e;
		g_assert_cmpint(record_next(r, &e, NULL), ==, RECORD_ENTRY);
		g_assert_cmpint(record_next(r, &e, NULL), ==, RECORD_ENTRY);
		g_assert_cmpint(record_next(r, &e, &error), ==, RECORD_BAD);
		g_assert_cmpstr(error->message, ==, message);
		g_assert_cmpuint(
			record_skip_damage(r), ==, g_array_index(offsets, uint64_t, 3) - at);
	}
}

static void test_append_refuses_damage(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	write_known(f->file, 5, SMALL);
	g_autoptr(GByteArray) file = contents(f->file);
	file->data[20] ^= 1;
	replace(f->file, file->data, file->len);
	g_assert_null(record_append_to(f->file, NULL, &error));
	g_assert_error(error, RECORD_ERROR, RECORD_ERROR_DAMAGED);
	g_autoptr(GByteArray) after = contents(f->file);
	g_assert_cmpmem(file->data, file->len, after->data, after->len);
}

/* A file system without a journal may show remains of an older record behind a cut. They are whole
 * entries, but their numbers do not fit. */
static void test_remains(struct folder *f, gconstpointer data)
{
	(void)data;
	write_known(f->file, 60, SMALL);
	g_autoptr(GByteArray) file = contents(f->file);
	g_autoptr(GArray) offsets = entry_offsets(file);
	uint64_t cut = g_array_index(offsets, uint64_t, 4) + 8;
	uint64_t older = g_array_index(offsets, uint64_t, 40);
	g_autoptr(GByteArray) mixed = g_byte_array_new();
	g_byte_array_append(mixed, file->data, (guint)cut);
	g_byte_array_append(mixed, file->data + older, file->len - (guint)older);
	replace(f->file, mixed->data, mixed->len);
	check_cut(f->file, offsets, mixed->len, 4);
}

/* Heads every 32 bytes, each with a plausible number and megabytes to sum. */
static void test_hostile(struct folder *f, gconstpointer data)
{
	(void)data;
	const size_t heads = 1 << 20;
	write_known(f->file, 0, SMALL);
	g_autoptr(GByteArray) file = contents(f->file);
	g_byte_array_set_size(file, (guint)(16 + 32 * heads));
	struct record_head h = { GUINT32_TO_LE(RECORD_ENTRY_MARK), GUINT32_TO_LE(1) };
	for (size_t i = 0; i < heads; i++) {
		h.length = GUINT32_TO_LE((uint32_t)(32 * (heads - i - 1)));
		h.sequence = GUINT32_TO_LE((uint32_t)i);
		memcpy(file->data + 16 + 32 * i, &h, sizeof h);
	}
	struct record_entry e;
	g_autoptr(GError) error = NULL;
	g_autoptr(record_reader) r = open_copy(file->data, file->len, NULL);
	int64_t start_us = g_get_monotonic_time();
	g_assert_cmpint(record_next(r, &e, &error), ==, RECORD_BAD);
	g_assert_cmpuint(record_skip_damage(r), ==, 0);
	g_assert_cmpint(g_get_monotonic_time() - start_us, <, 5 * G_USEC_PER_SEC);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/record/not-a-record", test_not_a_record);
#define ADD(name, data, test)                                                                      \
	g_test_add("/record/" name, struct folder, GINT_TO_POINTER(data), set_up, test, tear_down)
	ADD("round-trip", 0, test_round_trip);
	ADD("limits", 0, test_limits);
	ADD("create-once", 0, test_create_once);
	ADD("other-things", 0, test_other_things);
	ADD("each-bit", 0, test_each_bit);
	ADD("each-length", 0, test_each_length);
	ADD("each-length-and-zeros", 1, test_each_length);
	ADD("each-length-and-garbage", 2, test_each_length);
	ADD("sentences", 0, test_sentences);
	ADD("append-refuses-damage", 0, test_append_refuses_damage);
	ADD("remains", 0, test_remains);
	ADD("hostile", 0, test_hostile);
	return g_test_run();
}
