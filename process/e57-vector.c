#include "process/e57-vector.h"
#include <string.h>

/* Of all streams: a file whose streams run further apart than this is not one that a writer makes. */
#define QUEUE_MAX (64u << 20)
/* Loads of eight bytes may reach so far beyond the last one. */
#define BEHIND 16u

/* Bytes of one field that came and were not taken yet. */
struct stream {
	bool wanted;
	unsigned bits; /* of a record */
	uint8_t *bytes;
	size_t filled, capacity;
	uint64_t at; /* bit */
	double *numbers;
};

struct e57_vector {
	e57_pages *pages;
	const struct e57_scan *scan;
	unsigned count; /* of streams */
	struct stream *streams;
	uint64_t next, end; /* logical: of the next packet, behind the last one */
	uint64_t done;      /* records */
	uint8_t packet[E57_PACKET_MAX];
};

static const struct e57_field *field_at(const e57_vector *v, unsigned i)
{
	return &g_array_index(v->scan->fields, struct e57_field, i);
}

/* ---- packets ---- */

static void forget_taken(struct stream *s)
{
	size_t bytes = (size_t)(s->at / 8);
	if (bytes < s->filled / 2)
		return;
	memmove(s->bytes, s->bytes + bytes, s->filled - bytes);
	s->filled -= bytes;
	s->at %= 8;
}

static void append(struct stream *s, const uint8_t *bytes, size_t length)
{
	if (s->filled)
		forget_taken(s);
	if (s->filled + length + BEHIND > s->capacity) {
		s->capacity = MAX(2 * s->capacity, s->filled + length + BEHIND);
		s->bytes = g_realloc(s->bytes, s->capacity);
	}
	memcpy(s->bytes + s->filled, bytes, length);
	s->filled += length;
	memset(s->bytes + s->filled, 0, BEHIND);
}

static uint16_t u16_at(const uint8_t *at)
{
	uint16_t value;
	memcpy(&value, at, sizeof value);
	return GUINT16_FROM_LE(value);
}

static bool take_data(e57_vector *v, size_t length, GError **error)
{
	unsigned count = u16_at(v->packet + 4);
	size_t at = 6 + 2u * (size_t)count, queued = 0;
	if (count != v->count || at > length)
		return e57_pages_refuse(error, v->pages, v->next,
			"a packet of %u streams, and the points have %u fields", count, v->count);
	for (unsigned i = 0; i < count; i++) {
		size_t bytes = u16_at(v->packet + 6 + 2u * i);
		struct stream *s = &v->streams[i];
		if (bytes > length - at)
			return e57_pages_refuse(error, v->pages, v->next,
				"the streams of a packet are longer than it is, %zu bytes", length);
		if (s->wanted && s->bits)
			append(s, v->packet + at, bytes);
		queued += s->filled;
		at += bytes;
	}
	return queued <= QUEUE_MAX ||
	       e57_pages_refuse(error, v->pages, v->next,
		       "some of the streams have much that the others have not yet");
}

static bool next_packet(e57_vector *v, GError **error)
{
	uint8_t *p = v->packet;
	if (v->next + 4 > v->end)
		return e57_pages_refuse(error, v->pages, v->end,
			"the points end here, after %" G_GUINT64_FORMAT " of %" G_GUINT64_FORMAT,
			v->done, v->scan->count);
	if (!e57_pages_read(v->pages, v->next, p, 4, error))
		return false;
	size_t length = (size_t)u16_at(p + 2) + 1;
	if (length < 8 || length > v->end - v->next || p[0] > E57_PACKET_EMPTY)
		return e57_pages_refuse(error, v->pages, v->next,
			"a packet of kind %u and %zu bytes cannot be here", p[0], length);
	if (!e57_pages_read(v->pages, v->next, p, length, error) ||
		(p[0] == E57_PACKET_DATA && !take_data(v, length, error)))
		return false;
	v->next += length;
	return true;
}

/* ---- numbers ---- */

static size_t records_there(const e57_vector *v)
{
	uint64_t least = UINT64_MAX;
	for (unsigned i = 0; i < v->count; i++) {
		const struct stream *s = &v->streams[i];
		if (s->wanted && s->bits)
			least = MIN(least, (8 * (uint64_t)s->filled - s->at) / s->bits);
	}
	return (size_t)MIN(least, E57_BLOCK_RECORDS);
}

static inline uint64_t bits_at(const uint8_t *bytes, uint64_t at, unsigned bits, uint64_t mask)
{
	uint64_t low;
	unsigned shift = at % 8;
	memcpy(&low, bytes + at / 8, sizeof low);
	low = GUINT64_FROM_LE(low) >> shift;
	if (shift + bits > 64)
		low |= (uint64_t)bytes[at / 8 + 8] << (64 - shift);
	return low & mask;
}

static void take_whole(struct stream *s, const struct e57_field *f, size_t count)
{
	uint64_t mask = s->bits < 64 ? (UINT64_C(1) << s->bits) - 1 : UINT64_MAX;
	for (size_t i = 0; i < count; i++, s->at += s->bits) {
		/* The sum is of the range, so it does not overflow. */
		int64_t whole =
			(int64_t)((uint64_t)f->minimum + bits_at(s->bytes, s->at, s->bits, mask));
		s->numbers[i] = (double)whole * f->scale + f->offset;
	}
}

static void take_floats(struct stream *s, const struct e57_field *f, size_t count)
{
	const uint8_t *at = s->bytes + s->at / 8;
	for (size_t i = 0; i < count && f->kind == E57_FLOAT32; i++) {
		uint32_t bits;
		float value;
		memcpy(&bits, at + 4 * i, sizeof bits);
		bits = GUINT32_FROM_LE(bits);
		memcpy(&value, &bits, sizeof value);
		s->numbers[i] = (double)value;
	}
	for (size_t i = 0; i < count && f->kind == E57_FLOAT64; i++) {
		uint64_t bits;
		memcpy(&bits, at + 8 * i, sizeof bits);
		bits = GUINT64_FROM_LE(bits);
		memcpy(&s->numbers[i], &bits, sizeof bits);
	}
	s->at += (uint64_t)count * s->bits;
}

static void take(struct stream *s, const struct e57_field *f, size_t count)
{
	if (!s->bits)
		for (size_t i = 0; i < count; i++)
			s->numbers[i] = (double)f->minimum * f->scale + f->offset;
	else if (f->kind == E57_INTEGER || f->kind == E57_SCALED)
		take_whole(s, f, count);
	else
		take_floats(s, f, count);
}

bool e57_vector_read(e57_vector *v, size_t max, size_t *ret_count, GError **error)
{
	size_t there;
	*ret_count = 0;
	max = (size_t)MIN(max, v->scan->count - v->done);
	if (!max)
		return true;
	while (!(there = records_there(v)))
		if (!next_packet(v, error))
			return false;
	*ret_count = MIN(there, max);
	for (unsigned i = 0; i < v->count; i++)
		if (v->streams[i].wanted)
			take(&v->streams[i], field_at(v, i), *ret_count);
	v->done += *ret_count;
	return true;
}

const double *e57_vector_numbers(const e57_vector *v, unsigned field)
{
	return v->streams[field].numbers;
}

double e57_vector_fraction(const e57_vector *v)
{
	return (double)v->done / (double)v->scan->count;
}

uint64_t e57_vector_bytes(const e57_vector *v)
{
	return v->end - v->scan->section;
}

/* ---- opening ---- */

static unsigned bits_of(const struct e57_field *f)
{
	switch (f->kind) {
	case E57_FLOAT32: return 32;
	case E57_FLOAT64: return 64;
	case E57_STRING: return 0;
	default: return e57_bits(f->minimum, f->maximum);
	}
}

static uint64_t u64_at(const uint8_t *at)
{
	uint64_t value;
	memcpy(&value, at, sizeof value);
	return GUINT64_FROM_LE(value);
}

static bool read_section(e57_vector *v, GError **error)
{
	uint8_t h[E57_VECTOR_BYTES];
	uint64_t at = v->scan->section, room = e57_pages_size(v->pages) - at;
	if (!e57_pages_read(v->pages, at, h, sizeof h, error))
		return false;
	uint64_t length = u64_at(h + 8), first = e57_logical(u64_at(h + 16));
	if (h[0] != E57_VECTOR_ID)
		return e57_pages_refuse(
			error, v->pages, at, "there are no points here, as its XML tells");
	if (length < sizeof h || length > room)
		return e57_pages_refuse(error, v->pages, at,
			"points of %" G_GUINT64_FORMAT " bytes, and the file has %" G_GUINT64_FORMAT
			" more",
			length, room);
	if (first < at + sizeof h || first > at + length)
		return e57_pages_refuse(error, v->pages, at,
			"its first points cannot begin at byte %" G_GUINT64_FORMAT, u64_at(h + 16));
	v->next = first;
	v->end = at + length;
	return true;
}

/* So much that no stream could ever come to its end is a lie: told before anything is made for it. Of all streams: those that are
 * wanted may all have no bits. */
static bool check_count(const e57_vector *v, GError **error)
{
	uint64_t bits = 0, bytes = v->end - v->next;
	for (unsigned i = 0; i < v->count; i++)
		bits += v->streams[i].bits;
	if (bits && v->scan->count / 8 <= bytes / bits)
		return true;
	return e57_pages_refuse(error, v->pages, v->scan->section,
		"%" G_GUINT64_FORMAT " points cannot stand in %" G_GUINT64_FORMAT " bytes",
		v->scan->count, bytes);
}

e57_vector *e57_vector_open(
	e57_pages *pages, const struct e57_scan *scan, const bool *wanted, GError **error)
{
	g_autoptr(e57_vector) v = g_new0(e57_vector, 1);
	v->pages = pages;
	v->scan = scan;
	v->count = scan->fields->len;
	v->streams = g_new0(struct stream, MAX(v->count, 1));
	for (unsigned i = 0; i < v->count; i++) {
		struct stream *s = &v->streams[i];
		s->wanted = wanted[i];
		s->bits = bits_of(field_at(v, i));
		s->numbers = s->wanted ? g_new0(double, E57_BLOCK_RECORDS) : NULL;
	}
	if (!read_section(v, error) || !check_count(v, error))
		return NULL;
	return g_steal_pointer(&v);
}

void e57_vector_free(e57_vector *v)
{
	if (!v)
		return;
	for (unsigned i = 0; i < v->count; i++) {
		g_free(v->streams[i].bytes);
		g_free(v->streams[i].numbers);
	}
	g_free(v->streams);
	g_free(v);
}
