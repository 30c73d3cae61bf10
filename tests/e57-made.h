#ifndef TESTS_E57_MADE_H
#define TESTS_E57_MADE_H
/* E57 files made by tests, by the layout of the standard and with nothing of the product's: its own pages, its own checksum and one
 * bit put after the other. */
#include <gio/gio.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum made_kind { MADE_WHOLE, MADE_SCALED, MADE_FLOAT32, MADE_FLOAT64, MADE_STRING };

struct made_field {
	const char *name; /* "cartesianX", "ext:class" */
	enum made_kind kind;
	int64_t least, most;  /* of whole numbers */
	double scale, offset; /* of MADE_SCALED */
	const char *in;       /* a Structure around it; NULL: none */
};

union made_value {
	int64_t whole;
	double real;
	const char *text;
};
#define WHOLE(v)                                                                                   \
	{                                                                                          \
		.whole = (v)                                                                       \
	}
#define REAL(v)                                                                                    \
	{                                                                                          \
		.real = (v)                                                                        \
	}

struct made_points {
	const struct made_field *field;
	unsigned fields;
	uint64_t count;
	/* Of record i; NULL: value is a table of count rows. */
	union made_value (*of)(gconstpointer data, uint64_t i, unsigned field);
	gconstpointer data;
	const union made_value *value;
	unsigned packets; /* at least so many */
	unsigned apart;   /* packets that every third stream is ahead, and the next twice so many */
	bool with_between; /* an index packet and an empty one behind every packet */
};

/* Sections behind the header; the XML names the physical offset of section n as %n. */
struct made {
	GByteArray *bytes; /* logical */
	uint64_t section[10], data[10];
	unsigned sections;
};

/* ---- bytes ---- */

static inline void made_put(GByteArray *b, uint64_t value, unsigned bytes)
{
	for (unsigned i = 0; i < bytes; i++)
		g_byte_array_append(b, &(uint8_t){ (uint8_t)(i < 8 ? value >> (8 * i) : 0) }, 1);
}

static inline void made_set(uint8_t *at, uint64_t value, unsigned bytes)
{
	for (unsigned i = 0; i < bytes; i++)
		at[i] = (uint8_t)(value >> (8 * i));
}

static inline void made_align(GByteArray *b)
{
	while (b->len % 4)
		made_put(b, 0, 1);
}

static inline uint64_t made_physical(uint64_t logical)
{
	return logical / 1020 * 1024 + logical % 1020;
}

static inline uint32_t made_checksum(const uint8_t *at, size_t length)
{
	uint32_t c = 0xffffffff;
	for (size_t i = 0; i < length; i++) {
		c ^= at[i];
		for (int bit = 0; bit < 8; bit++)
			c = c & 1 ? c >> 1 ^ 0x82f63b78 : c >> 1;
	}
	return ~c;
}

/* Makes the checksum of every page right. */
static inline void made_seal(GByteArray *file)
{
	for (size_t page = 0; page + 1024 <= file->len; page += 1024) {
		uint32_t c = made_checksum(file->data + page, 1020);
		for (int i = 0; i < 4; i++)
			file->data[page + 1020 + i] = (uint8_t)(c >> (24 - 8 * i));
	}
}

/* ---- streams ---- */

struct made_bits {
	GByteArray *bytes;
	unsigned used; /* of the last byte; 0: all */
};

static inline void made_bit(struct made_bits *b, bool set)
{
	if (b->used == 0)
		made_put(b->bytes, 0, 1);
	if (set)
		b->bytes->data[b->bytes->len - 1] |= (uint8_t)(1 << b->used);
	b->used = (b->used + 1) % 8;
}

/* The least number of bits that tell the numbers of the range apart. */
static inline unsigned made_width(const struct made_field *f)
{
	uint64_t span = (uint64_t)f->most - (uint64_t)f->least;
	unsigned bits = 0;
	for (; span; span >>= 1)
		bits++;
	return bits;
}

static inline void made_text(GByteArray *b, const char *text)
{
	size_t length = strlen(text);
	if (length < 128)
		made_put(b, length << 1, 1);
	else
		made_put(b, length << 1 | 1, 8);
	g_byte_array_append(b, (const uint8_t *)text, (guint)length);
}

static inline void made_value(
	struct made_bits *b, const struct made_field *f, union made_value value)
{
	uint64_t bits;
	uint32_t narrow;
	float real = (float)value.real;
	switch (f->kind) {
	case MADE_FLOAT32:
		memcpy(&narrow, &real, 4);
		made_put(b->bytes, narrow, 4);
		return;
	case MADE_FLOAT64:
		memcpy(&bits, &value.real, 8);
		made_put(b->bytes, bits, 8);
		return;
	case MADE_STRING: made_text(b->bytes, value.text); return;
	default: break;
	}
	bits = (uint64_t)value.whole - (uint64_t)f->least;
	for (unsigned i = 0; i < made_width(f); i++)
		made_bit(b, bits >> i & 1);
}

static inline GByteArray *made_stream(const struct made_points *p, unsigned field)
{
	struct made_bits b = { g_byte_array_new(), 0 };
	for (uint64_t i = 0; i < p->count; i++)
		made_value(&b, &p->field[field],
			p->of ? p->of(p->data, i, field) : p->value[i * p->fields + field]);
	return b.bytes;
}

/* ---- packets ---- */

/* How much of a stream stands in packets up to this one. */
static inline size_t made_until(const struct made_points *p, const GByteArray *stream, unsigned k,
	unsigned packet, unsigned of)
{
	uint64_t done = MIN((uint64_t)packet + (packet ? k % 3 * p->apart : 0), of);
	return (size_t)(stream->len * done / of);
}

static inline size_t made_packet_length(
	const struct made_points *p, GByteArray **streams, unsigned packet, unsigned of)
{
	size_t length = 6 + 2 * (size_t)p->fields;
	for (unsigned k = 0; k < p->fields; k++)
		length += made_until(p, streams[k], k, packet + 1, of) -
			  made_until(p, streams[k], k, packet, of);
	return (length + 3) / 4 * 4;
}

static inline void made_packet(GByteArray *b, const struct made_points *p, GByteArray **streams,
	unsigned packet, unsigned of)
{
	size_t end = b->len + made_packet_length(p, streams, packet, of);
	made_put(b, 1, 2);
	made_put(b, end - (b->len - 2) - 1, 2);
	made_put(b, p->fields, 2);
	for (unsigned k = 0; k < p->fields; k++)
		made_put(b,
			made_until(p, streams[k], k, packet + 1, of) -
				made_until(p, streams[k], k, packet, of),
			2);
	for (unsigned k = 0; k < p->fields; k++) {
		size_t from = made_until(p, streams[k], k, packet, of),
		       until = made_until(p, streams[k], k, packet + 1, of);
		if (until > from)
			g_byte_array_append(b, streams[k]->data + from, (guint)(until - from));
	}
	while (b->len < end)
		made_put(b, 0, 1);
}

/* One entry, as writers make it, and a packet with nothing. */
static inline void made_between(GByteArray *b, uint64_t first)
{
	made_put(b, 0, 2);
	made_put(b, 32 - 1, 2);
	made_put(b, 1, 2);
	made_put(b, 0, 10);
	made_put(b, 0, 8);
	made_put(b, made_physical(first), 8);
	made_put(b, 2, 2);
	made_put(b, 12 - 1, 2);
	made_put(b, 0, 8);
}

static inline bool made_fits(const struct made_points *p, GByteArray **streams, unsigned of)
{
	for (unsigned i = 0; i < of; i++)
		if (made_packet_length(p, streams, i, of) > 65536)
			return false;
	return true;
}

/* ---- sections ---- */

static inline struct made made_begin(void)
{
	struct made m = { .bytes = g_byte_array_new() };
	g_byte_array_set_size(m.bytes, 48);
	memset(m.bytes->data, 0, 48);
	return m;
}

static inline unsigned made_vector(struct made *m, const struct made_points *p)
{
	g_autoptr(GPtrArray) all =
		g_ptr_array_new_with_free_func((GDestroyNotify)g_byte_array_unref);
	unsigned of = MAX(p->packets, 1);
	GByteArray *b = m->bytes;
	for (unsigned k = 0; k < p->fields; k++)
		g_ptr_array_add(all, made_stream(p, k));
	GByteArray **streams = (GByteArray **)all->pdata;
	while (!made_fits(p, streams, of))
		of += of / 8 + 1;
	made_align(b);
	uint64_t start = b->len, first = start + 32;
	made_put(b, 1, 8);
	made_put(b, 0, 8);
	made_put(b, made_physical(first), 8);
	made_put(b, 0, 8);
	for (unsigned i = 0; i < of; i++) {
		made_packet(b, p, streams, i, of);
		if (p->with_between)
			made_between(b, first);
	}
	made_set(b->data + start + 8, b->len - start, 8);
	m->section[m->sections] = start;
	m->data[m->sections] = first;
	return m->sections++;
}

static inline unsigned made_blob(struct made *m, const void *bytes, size_t length)
{
	made_align(m->bytes);
	m->section[m->sections] = m->bytes->len;
	made_put(m->bytes, 0, 8);
	made_put(m->bytes, (16 + length + 3) / 4 * 4, 8);
	g_byte_array_append(m->bytes, bytes, (guint)length);
	made_align(m->bytes);
	return m->sections++;
}

/* ---- XML ---- */

static inline void made_field_xml(GString *xml, const struct made_field *f)
{
	if (f->in)
		g_string_append_printf(xml, "<%s type=\"Structure\">", f->in);
	g_string_append_printf(xml, "<%s", f->name);
	if (f->kind == MADE_WHOLE || f->kind == MADE_SCALED)
		g_string_append_printf(xml,
			" type=\"%s\" minimum=\"%" G_GINT64_FORMAT "\" maximum=\"%" G_GINT64_FORMAT
			"\"",
			f->kind == MADE_WHOLE ? "Integer" : "ScaledInteger", f->least, f->most);
	if (f->kind == MADE_SCALED)
		g_string_append_printf(
			xml, " scale=\"%.17g\" offset=\"%.17g\"", f->scale, f->offset);
	if (f->kind == MADE_FLOAT32 || f->kind == MADE_FLOAT64)
		g_string_append_printf(xml, " type=\"Float\" precision=\"%s\"",
			f->kind == MADE_FLOAT32 ? "single" : "double");
	if (f->kind == MADE_STRING)
		g_string_append(xml, " type=\"String\"");
	g_string_append(xml, "/>");
	if (f->in)
		g_string_append_printf(xml, "</%s>", f->in);
}

/* A scan; what: elements of it besides its points. */
static inline char *made_scan_xml(const struct made_points *p, unsigned section, const char *what)
{
	GString *xml = g_string_new("<vectorChild type=\"Structure\">");
	g_string_append(xml, what ? what : "");
	g_string_append_printf(xml,
		"\n<points type=\"CompressedVector\" fileOffset=\"%%%u\" "
		"recordCount=\"%" G_GUINT64_FORMAT "\">\n<prototype type=\"Structure\">\n",
		section, p->count);
	for (unsigned k = 0; k < p->fields; k++)
		made_field_xml(xml, &p->field[k]);
	g_string_append(xml, "\n</prototype><codecs type=\"Vector\"/></points></vectorChild>\n");
	return g_string_free(xml, false);
}

#define MADE_NAMESPACE "http://www.astm.org/COMMIT/E57/2010-e57-v1.0"

static inline char *made_root_xml(const char *scans, const char *images)
{
	return g_strdup_printf(
		"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
		"<e57Root type=\"Structure\" xmlns=\"" MADE_NAMESPACE "\"\n"
		" xmlns:ext=\"urn:made:ext\">\n"
		"<formatName type=\"String\">ASTM E57 3D Imaging Data File</formatName>\n"
		"<data3D type=\"Vector\">\n%s</data3D>\n"
		"<images2D type=\"Vector\">%s</images2D>\n</e57Root>\n",
		scans, images ? images : "");
}

/* ---- the file ---- */

static inline void made_header(GByteArray *b, uint64_t pages, uint64_t xml, uint64_t xml_length)
{
	memcpy(b->data, "ASTM-E57", 8);
	made_set(b->data + 8, 1, 4);
	made_set(b->data + 12, 0, 4);
	made_set(b->data + 16, pages * 1024, 8);
	made_set(b->data + 24, made_physical(xml), 8);
	made_set(b->data + 32, xml_length, 8);
	made_set(b->data + 40, 1024, 8);
}

static inline GByteArray *made_pages(const GByteArray *logical)
{
	GByteArray *file = g_byte_array_sized_new(logical->len / 1020 * 1024 + 1024);
	uint8_t page[1024];
	for (size_t at = 0; at < logical->len; at += 1020) {
		memset(page, 0, sizeof page);
		memcpy(page, logical->data + at, MIN(1020, logical->len - at));
		g_byte_array_append(file, page, sizeof page);
	}
	made_seal(file);
	return file;
}

/* The physical file; m is empty then. */
static inline GByteArray *made_end(struct made *m, const char *text, size_t length)
{
	g_autoptr(GString) xml = g_string_new_len(text, (gssize)length);
	for (unsigned i = 0; i < m->sections; i++) {
		g_autofree char *name = g_strdup_printf("%%%u", i),
				*offset = g_strdup_printf(
					"%" G_GUINT64_FORMAT, made_physical(m->section[i]));
		g_string_replace(xml, name, offset, 0);
	}
	made_align(m->bytes);
	uint64_t at = m->bytes->len;
	g_byte_array_append(m->bytes, (const uint8_t *)xml->str, (guint)xml->len);
	made_header(m->bytes, (m->bytes->len + 1019) / 1020, at, xml->len);
	GByteArray *file = made_pages(m->bytes);
	g_clear_pointer(&m->bytes, g_byte_array_unref);
	return file;
}

/* Of one scan and nothing else. */
static inline GByteArray *made_one(const struct made_points *p, const char *what)
{
	struct made m = made_begin();
	unsigned section = made_vector(&m, p);
	g_autofree char *scan = made_scan_xml(p, section, what), *xml = made_root_xml(scan, NULL);
	return made_end(&m, xml, strlen(xml));
}

#endif
