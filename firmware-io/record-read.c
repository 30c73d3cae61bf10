#include "firmware-io/files.h"
#include "firmware-io/record-format.h"
#include "firmware-io/record.h"
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

G_DEFINE_QUARK(record - error - quark, record_error)

struct record_reader {
	GBytes *bytes;
	const uint8_t *base;
	char *name;
	uint64_t size, position;
	uint32_t sequence; /* that the entry at position must have */
	uint64_t resume; /* the whole entry behind the damage at position, once it was searched for;
			    else 0 */
	uint64_t crc_budget; /* bytes that may yet be summed in vain */
};

/* What can be wrong with an entry, cheapest first. */
enum fault {
	WHOLE,
	NO_MARK,
	PAST_END,
	TOO_LONG,
	ODD_RESERVED,
	ODD_KIND,
	ODD_SEQUENCE,
	ODD_CHECKSUM
};

static bool fail(GError **error, int code, const char *name, const char *format, ...)
	G_GNUC_PRINTF(4, 5);

static bool fail(GError **error, int code, const char *name, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(error, RECORD_ERROR, code, "%s: %s", name, what);
	return false;
}

/* As text where it is text, so that a wrong file can be recognised. */
static char *beginning(const uint8_t *bytes, size_t length)
{
	GString *text = g_string_new(NULL), *hex = g_string_new(NULL);
	bool printable = true;
	for (size_t i = 0; i < MIN(length, 8); i++) {
		printable &= g_ascii_isprint(bytes[i]);
		g_string_append_c(text, (char)bytes[i]);
		g_string_append_printf(hex, "%s%02x", i ? " " : "", bytes[i]);
	}
	char *shown = printable ? g_strdup_printf("\"%s\"", text->str) : g_strdup(hex->str);
	g_string_free(text, true);
	g_string_free(hex, true);
	return shown;
}

static bool check_header(const record_reader *r, GError **error)
{
	struct record_file_header h;
	if (r->size == 0)
		return fail(error, RECORD_ERROR_NOT_A_RECORD, r->name, "is empty");
	if (memcmp(r->base, RECORD_FILE_MAGIC, MIN(r->size, sizeof h.magic))) {
		g_autofree char *shown = beginning(r->base, r->size);
		return fail(error, RECORD_ERROR_NOT_A_RECORD, r->name,
			"is not a pleinair record (it begins with %s)", shown);
	}
	if (r->size < sizeof h)
		return fail(error, RECORD_ERROR_DAMAGED, r->name,
			"ends after %u of the %u bytes of its header", (unsigned)r->size,
			(unsigned)sizeof h);
	memcpy(&h, r->base, sizeof h);
	if (GUINT32_FROM_LE(h.crc) != record_file_header_crc(&h))
		return fail(error, RECORD_ERROR_DAMAGED, r->name,
			"the checksum of its header does not match");
	if (GUINT32_FROM_LE(h.version) != RECORD_FILE_VERSION)
		return fail(error, RECORD_ERROR_NOT_A_RECORD, r->name,
			"is a record of version %u; this program reads version %u",
			GUINT32_FROM_LE(h.version), RECORD_FILE_VERSION);
	return true;
}

record_reader *record_open_bytes(GBytes *bytes, const char *name, GError **error)
{
	g_autoptr(record_reader) r = g_new0(record_reader, 1);
	size_t size;
	const void *base = g_bytes_get_data(bytes, &size);
	/* Part of other bytes may begin anywhere; a copy begins where payloads are aligned. */
	r->bytes = (uintptr_t)base % 8 ? g_bytes_new(base, size) : g_bytes_ref(bytes);
	r->base = g_bytes_get_data(r->bytes, NULL);
	r->name = g_strdup(name);
	r->size = size;
	r->crc_budget = 8 * r->size + RECORD_PAYLOAD_MAX;
	if (!check_header(r, error))
		return NULL;
	r->position = sizeof(struct record_file_header);
	return g_steal_pointer(&r);
}

record_reader *record_open(const char *path, GError **error)
{
	int fd = files_open_plain(path, NULL, error);
	if (fd < 0)
		return NULL;
	g_autoptr(GMappedFile) file = g_mapped_file_new_from_fd(fd, false, error);
	close(fd);
	if (!file)
		return g_prefix_error(error, "%s: ", path), NULL;
	g_autoptr(GBytes) bytes = g_mapped_file_get_bytes(file);
	return record_open_bytes(bytes, path, error);
}

void record_reader_free(record_reader *r)
{
	if (!r)
		return;
	g_clear_pointer(&r->bytes, g_bytes_unref);
	g_free(r->name);
	g_free(r);
}

uint64_t record_reader_size(const record_reader *r)
{
	return r->size;
}

uint64_t record_reader_position(const record_reader *r)
{
	return r->position;
}

static void load_head(const record_reader *r, uint64_t offset, struct record_head *ret)
{
	memcpy(ret, r->base + offset, sizeof *ret);
}

/* All but the payload's checksum. The entry's sequence must lie in first .. first + span. */
static enum fault check_head(const record_reader *r, uint64_t offset, uint32_t first, uint64_t span)
{
	struct record_head h;
	load_head(r, offset, &h);
	if (GUINT32_FROM_LE(h.mark) != RECORD_ENTRY_MARK)
		return NO_MARK;
	uint64_t length = GUINT32_FROM_LE(h.length);
	if (length + record_padding(length) > r->size - offset - sizeof h)
		return PAST_END;
	if (length > RECORD_PAYLOAD_MAX)
		return TOO_LONG;
	if (h.zero)
		return ODD_RESERVED;
	if (!h.kind || GUINT32_FROM_LE(h.kind) >= RECORD_KINDS)
		return ODD_KIND;
	return GUINT32_FROM_LE(h.sequence) - first > span ? ODD_SEQUENCE : WHOLE;
}

/* A failed sum goes off the budget: in an honest file that is next to nothing. One made of marks
 * that each claim megabytes would otherwise cost the square of its size. */
static enum fault check_entry(record_reader *r, uint64_t offset, uint32_t first, uint64_t span)
{
	enum fault fault = check_head(r, offset, first, span);
	if (fault)
		return fault;
	struct record_head h;
	load_head(r, offset, &h);
	uint32_t length = GUINT32_FROM_LE(h.length);
	if (crc32c(record_head_crc(&h), r->base + offset + sizeof h, length) ==
		GUINT32_FROM_LE(h.crc))
		return WHOLE;
	r->crc_budget -= MIN(r->crc_budget, length + sizeof h);
	return ODD_CHECKSUM;
}

/* The whole entry behind the damage at position, or 0. Entries are counted, so between the damage
 * and what may be believed lie no more numbers than entries have room: remains of an older file do
 * not pass. */
static uint64_t find_whole(record_reader *r)
{
	const uint64_t head = sizeof(struct record_head);
	for (uint64_t o = r->position + 8; o + head <= r->size && r->crc_budget; o += 8)
		if (check_entry(r, o, r->sequence, (o - r->position) / head) == WHOLE)
			return o;
	return 0;
}

static char *describe(const record_reader *r, enum fault fault)
{
	struct record_head h;
	load_head(r, r->position, &h);
	uint32_t length = GUINT32_FROM_LE(h.length);
	switch (fault) {
	case NO_MARK: return g_strdup("no entry begins there");
	case PAST_END:
		return g_strdup_printf("it claims %u bytes, but the file ends after %" PRIu64,
			length, r->size - r->position - sizeof h);
	case TOO_LONG:
		return g_strdup_printf("it claims %u bytes, but an entry has at most %u", length,
			RECORD_PAYLOAD_MAX);
	case ODD_RESERVED: return g_strdup("its reserved bytes are not zero");
	case ODD_KIND:
		return g_strdup_printf("there is no kind %u of entry", GUINT32_FROM_LE(h.kind));
	case ODD_SEQUENCE: return g_strdup_printf("it is numbered %u", GUINT32_FROM_LE(h.sequence));
	default: return g_strdup("its checksum does not match");
	}
}

static enum record_result cut_here(const record_reader *r, struct record_entry *ret_entry)
{
	*ret_entry = (struct record_entry){ .offset = r->position, .sequence = r->sequence };
	return RECORD_CUT;
}

static enum record_result report_damage(
	record_reader *r, enum fault fault, struct record_entry *ret_entry, GError **error)
{
	if (!r->resume)
		r->resume = find_whole(r);
	if (!r->resume && r->crc_budget)
		return cut_here(r, ret_entry);
	g_autofree char *what = describe(r, fault);
	fail(error, RECORD_ERROR_DAMAGED, r->name, "entry %u at byte %" PRIu64 ": %s", r->sequence,
		r->position, what);
	return RECORD_BAD;
}

enum record_result record_next(record_reader *r, struct record_entry *ret_entry, GError **error)
{
	struct record_head h;
	if (r->position == r->size)
		return RECORD_AT_END;
	if (r->size - r->position < sizeof h)
		return cut_here(r, ret_entry);
	enum fault fault = check_entry(r, r->position, r->sequence, 0);
	if (fault)
		return report_damage(r, fault, ret_entry, error);
	load_head(r, r->position, &h);
	*ret_entry = (struct record_entry){
		.kind = GUINT32_FROM_LE(h.kind),
		.length = GUINT32_FROM_LE(h.length),
		.time_ns = (int64_t)GUINT64_FROM_LE(h.time_ns),
		.payload = r->base + r->position + sizeof h,
		.offset = r->position,
		.sequence = r->sequence++,
	};
	r->position += sizeof h + ret_entry->length + record_padding(ret_entry->length);
	return RECORD_ENTRY;
}

uint64_t record_skip_damage(record_reader *r)
{
	if (!r->resume)
		return 0;
	struct record_head h;
	uint64_t passed = r->resume - r->position;
	load_head(r, r->resume, &h);
	r->position = r->resume;
	r->sequence = GUINT32_FROM_LE(h.sequence);
	r->resume = 0;
	return passed;
}
