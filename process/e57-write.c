#include "process/e57-write.h"
#include "firmware-io/crc32c.h"
#include <string.h>

struct e57_write {
	FILE *file;
	uint8_t page[E57_PAGE_BYTES]; /* the one that is being filled */
	size_t filled;
	uint64_t pages; /* before it */
};

/* ---- pages ---- */

static void seal(uint8_t page[E57_PAGE_BYTES])
{
	uint32_t sum = GUINT32_TO_BE(crc32c(0, page, E57_PAGE_PAYLOAD));
	memcpy(page + E57_PAGE_PAYLOAD, &sum, sizeof sum);
}

static void put_page(e57_write *w)
{
	memset(w->page + w->filled, 0, E57_PAGE_PAYLOAD - w->filled);
	seal(w->page);
	fwrite(w->page, 1, E57_PAGE_BYTES, w->file);
	w->pages++;
	w->filled = 0;
}

void e57_write_bytes(e57_write *w, const void *bytes, size_t length)
{
	for (const uint8_t *from = bytes; length;) {
		size_t some = MIN(length, E57_PAGE_PAYLOAD - w->filled);
		memcpy(w->page + w->filled, from, some);
		w->filled += some;
		from += some;
		length -= some;
		if (w->filled == E57_PAGE_PAYLOAD)
			put_page(w);
	}
}

static void fill_to_four(e57_write *w)
{
	static const uint8_t zeros[4];
	e57_write_bytes(w, zeros, (4 - e57_write_at(w) % 4) % 4);
}

uint64_t e57_write_at(const e57_write *w)
{
	return w->pages * E57_PAGE_PAYLOAD + w->filled;
}

/* Of a page that is on the disk already. */
static void patch_page(e57_write *w, uint64_t number, size_t at, const void *bytes, size_t length)
{
	uint8_t page[E57_PAGE_BYTES] = { 0 };
	fseeko(w->file, (off_t)(number * E57_PAGE_BYTES), SEEK_SET);
	if (fread(page, 1, sizeof page, w->file) == sizeof page) {
		memcpy(page + at, bytes, length);
		seal(page);
		fseeko(w->file, (off_t)(number * E57_PAGE_BYTES), SEEK_SET);
		fwrite(page, 1, sizeof page, w->file);
	}
	fseeko(w->file, 0, SEEK_END);
}

static void patch(e57_write *w, uint64_t logical, const void *bytes, size_t length)
{
	for (const uint8_t *from = bytes; length;) {
		uint64_t number = logical / E57_PAGE_PAYLOAD;
		size_t at = (size_t)(logical % E57_PAGE_PAYLOAD),
		       some = MIN(length, E57_PAGE_PAYLOAD - at);
		if (number == w->pages)
			memcpy(w->page + at, from, some);
		else
			patch_page(w, number, at, from, some);
		from += some;
		logical += some;
		length -= some;
	}
}

static void put_u16(uint8_t *at, uint16_t value)
{
	value = GUINT16_TO_LE(value);
	memcpy(at, &value, sizeof value);
}

static void put_u32(uint8_t *at, uint32_t value)
{
	value = GUINT32_TO_LE(value);
	memcpy(at, &value, sizeof value);
}

static void put_u64(uint8_t *at, uint64_t value)
{
	value = GUINT64_TO_LE(value);
	memcpy(at, &value, sizeof value);
}

e57_write *e57_write_new(FILE *file)
{
	uint8_t header[E57_HEADER_BYTES] = { 0 };
	e57_write *w = g_new0(e57_write, 1);
	w->file = file;
	e57_write_bytes(w, header, sizeof header);
	return w;
}

void e57_write_free(e57_write *w)
{
	g_free(w);
}

uint64_t e57_write_blob(e57_write *w, const void *bytes, size_t length)
{
	uint8_t h[E57_BLOB_BYTES] = { E57_BLOB_ID };
	fill_to_four(w);
	uint64_t at = e57_write_at(w);
	put_u64(h + 8, (sizeof h + length + 3) / 4 * 4);
	e57_write_bytes(w, h, sizeof h);
	e57_write_bytes(w, bytes, length);
	fill_to_four(w);
	return e57_physical(at);
}

void e57_write_end(e57_write *w, const char *xml, size_t length)
{
	uint8_t h[E57_HEADER_BYTES] = E57_SIGNATURE;
	fill_to_four(w);
	uint64_t at = e57_write_at(w);
	e57_write_bytes(w, xml, length);
	if (w->filled)
		put_page(w);
	put_u32(h + 8, 1);
	put_u64(h + 16, w->pages * E57_PAGE_BYTES);
	put_u64(h + 24, e57_physical(at));
	put_u64(h + 32, length);
	put_u64(h + 40, E57_PAGE_BYTES);
	patch(w, 0, h, sizeof h);
}

/* ---- vectors ---- */

struct field_stream {
	unsigned bits;
	uint64_t *numbers; /* of the records of this packet */
};

struct e57_vector_write {
	e57_write *to;
	unsigned count;
	struct field_stream *streams;
	uint64_t *record;        /* one a field */
	size_t filled, room;     /* records of this packet */
	uint64_t section, first; /* logical */
	bool begun;              /* record holds numbers */
	uint8_t packet[E57_PACKET_MAX];
};

e57_vector_write *e57_vector_write_new(e57_write *w, const unsigned *bits, unsigned fields)
{
	uint8_t h[E57_VECTOR_BYTES] = { E57_VECTOR_ID };
	e57_vector_write *v = g_new0(e57_vector_write, 1);
	uint64_t all = 0;
	v->to = w;
	v->count = fields;
	v->record = g_new0(uint64_t, fields);
	v->streams = g_new0(struct field_stream, fields);
	for (unsigned i = 0; i < fields; i++)
		all += bits[i];
	/* By eight, so that each packet begins at a whole byte of every stream. */
	v->room = (size_t)((E57_PACKET_MAX - 16 - 2 * fields) * UINT64_C(8) / MAX(all, 1) / 8 * 8);
	v->room = MIN(v->room, 32768);
	for (unsigned i = 0; i < fields; i++) {
		v->streams[i].bits = bits[i];
		v->streams[i].numbers = g_new(uint64_t, v->room);
	}
	fill_to_four(w);
	v->section = e57_write_at(w);
	e57_write_bytes(w, h, sizeof h);
	v->first = e57_write_at(w);
	return v;
}

void e57_vector_write_free(e57_vector_write *v)
{
	if (!v)
		return;
	for (unsigned i = 0; i < v->count; i++)
		g_free(v->streams[i].numbers);
	g_free(v->streams);
	g_free(v->record);
	g_free(v);
}

/* The lowest bits first; returns the bytes. */
static size_t pack(uint8_t *into, const uint64_t *numbers, size_t count, unsigned bits)
{
	uint8_t *at = into;
	uint64_t held = 0;
	unsigned holds = 0;
	for (size_t i = 0; i < count && bits; i++) {
		held |= numbers[i] << holds;
		if (holds + bits >= 64) {
			put_u64(at, held);
			at += 8;
			held = holds ? numbers[i] >> (64 - holds) : 0;
			holds = holds + bits - 64;
		} else {
			holds += bits;
		}
	}
	for (; holds; holds = holds > 8 ? holds - 8 : 0, held >>= 8)
		*at++ = (uint8_t)held;
	return (size_t)(at - into);
}

static void put_packet(e57_vector_write *v)
{
	uint8_t *p = v->packet;
	size_t at = 6 + 2u * v->count;
	if (!v->filled)
		return;
	for (unsigned i = 0; i < v->count; i++) {
		size_t bytes = pack(p + at, v->streams[i].numbers, v->filled, v->streams[i].bits);
		put_u16(p + 6 + 2u * i, (uint16_t)bytes);
		at += bytes;
	}
	for (; at % 4; at++)
		p[at] = 0;
	p[0] = E57_PACKET_DATA;
	p[1] = 0;
	put_u16(p + 2, (uint16_t)(at - 1));
	put_u16(p + 4, (uint16_t)v->count);
	e57_write_bytes(v->to, p, at);
	v->filled = 0;
}

static void take_record(e57_vector_write *v)
{
	for (unsigned i = 0; i < v->count && v->begun; i++)
		v->streams[i].numbers[v->filled] = v->record[i];
	v->filled += v->begun;
	v->begun = false;
	if (v->filled == v->room)
		put_packet(v);
}

uint64_t *e57_vector_write_next(e57_vector_write *v)
{
	take_record(v);
	v->begun = true;
	return v->record;
}

/* One entry, for the first packet: readers that want an index want one at all. */
static void put_index(e57_vector_write *v)
{
	uint8_t p[32] = { E57_PACKET_INDEX };
	put_u16(p + 2, sizeof p - 1);
	put_u16(p + 4, 1);
	put_u64(p + 24, e57_physical(v->first));
	e57_write_bytes(v->to, p, sizeof p);
}

uint64_t e57_vector_write_end(e57_vector_write *v)
{
	uint8_t h[E57_VECTOR_BYTES] = { E57_VECTOR_ID };
	take_record(v);
	put_packet(v);
	uint64_t index = e57_write_at(v->to);
	put_index(v);
	put_u64(h + 8, e57_write_at(v->to) - v->section);
	put_u64(h + 16, e57_physical(v->first));
	put_u64(h + 24, e57_physical(index));
	patch(v->to, v->section, h, sizeof h);
	return e57_physical(v->section);
}
