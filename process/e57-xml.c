#include "process/e57-xml.h"
#include <gio/gio.h>
#include <libxml/parser.h>
#include <string.h>

/* Thousands of scans make a few MB. What is made of each byte may be thirty. */
#define XML_BYTES_MAX (32u << 20)
#define NODES_MAX     2000000u
/* Each is held against each other one. */
#define ATTRIBUTES_MAX 1000u

struct reading {
	e57_pages *pages;
	import_source *file;
};

#define refuse(error, r, ...) import_refuse(error, (r)->file, G_IO_ERROR_INVALID_DATA, __VA_ARGS__)

/* ---- XML ---- */

/* What would take the parser very much memory or time is no E57. */
static bool check_weight(const struct reading *r, const char *xml, size_t length, GError **error)
{
	unsigned nodes = 0, in_tag = 0;
	for (size_t i = 0; i < length; i++) {
		if (xml[i] == 0)
			return refuse(error, r, "byte %zu of its XML is 0: it should be UTF-8", i);
		in_tag = xml[i] == '<' ? 0 : in_tag + (xml[i] == '=');
		nodes += xml[i] == '<' || xml[i] == '=';
		if (in_tag > ATTRIBUTES_MAX)
			return refuse(error, r, "its XML has more than %u attributes in a tag",
				ATTRIBUTES_MAX);
		if (nodes > NODES_MAX)
			return refuse(error, r, "its XML has more than %u tags and attributes",
				NODES_MAX);
	}
	return true;
}

/* Only with it can an XML grow when it is read. */
static void stop_at_document_type(
	void *context, const xmlChar *name, const xmlChar *external, const xmlChar *system)
{
	(void)name, (void)external, (void)system;
	xmlStopParser(context);
}

static bool refuse_xml(const struct reading *r, xmlParserCtxt *context, GError **error)
{
	const xmlError *why = xmlCtxtGetLastError(context);
	g_autofree char *what = g_strdup(why && why->message ? why->message : "it is empty");
	if (context->errNo == XML_ERR_USER_STOP)
		return refuse(error, r, "its XML has a document type, which no E57 has");
	return refuse(error, r, "line %d of its XML: %s", why ? why->line : 1, g_strstrip(what));
}

static xmlDoc *parse(const struct reading *r, const char *xml, size_t length, GError **error)
{
	/* No entities, no network; what is wrong is told once, by us. The parser's own limits, 10 MB for one, are too narrow. */
	int options = XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING |
		      XML_PARSE_NOCDATA | XML_PARSE_HUGE;
	while (length && xml[length - 1] == 0) /* some fill the page up */
		length--;
	if (!check_weight(r, xml, length, error))
		return NULL;
	xmlParserCtxt *context = xmlNewParserCtxt();
	context->sax->internalSubset = stop_at_document_type;
	xmlDoc *doc = xmlCtxtReadMemory(context, xml, (int)length, NULL, NULL, options);
	if (!doc || !xmlDocGetRootElement(doc)) {
		refuse_xml(r, context, error);
		g_clear_pointer(&doc, xmlFreeDoc);
	}
	xmlFreeParserCtxt(context);
	return doc;
}

/* ---- the header ---- */

static uint64_t u64_at(const uint8_t *at)
{
	uint64_t value;
	memcpy(&value, at, sizeof value);
	return GUINT64_FROM_LE(value);
}

static bool check_header(const struct reading *r, const uint8_t *h, GError **error)
{
	uint64_t size = import_source_size(r->file), told = u64_at(h + 16), page = u64_at(h + 40);
	uint32_t major;
	memcpy(&major, h + 8, sizeof major);
	major = GUINT32_FROM_LE(major);
	if (memcmp(h, E57_SIGNATURE, 8) != 0)
		return refuse(error, r, "does not begin with ASTM-E57, as E57 files do");
	if (major != 1)
		return import_refuse(error, r->file, G_IO_ERROR_NOT_SUPPORTED,
			"is E57 version %u; version 1 is read", major);
	if (page != E57_PAGE_BYTES)
		return refuse(error, r,
			"byte 40: pages of %" G_GUINT64_FORMAT " bytes cannot be; they have 1024",
			page);
	if (told > size)
		return refuse(error, r,
			"is cut short: its header tells of %" G_GUINT64_FORMAT
			" bytes, and it has %" G_GUINT64_FORMAT,
			told, size);
	return true;
}

xmlDoc *e57_xml_read(e57_pages *pages, import_source *file, GError **error)
{
	struct reading reading = { pages, file }, *r = &reading;
	uint8_t h[E57_HEADER_BYTES];
	size_t got;
	/* Also of a file whose first page is damaged, it can be told that it is E57. */
	if (!import_source_read(r->file, 0, h, sizeof h, &got, error))
		return NULL;
	if (got < sizeof h)
		return refuse(error, r, "is cut short in its header, at byte %zu", got), NULL;
	if (!check_header(r, h, error) || !e57_pages_read(r->pages, 0, h, sizeof h, error))
		return NULL;
	uint64_t at = e57_logical(u64_at(h + 24)), length = u64_at(h + 32);
	if (length == 0 || length > XML_BYTES_MAX)
		return refuse(error, r, "byte 32: an XML of %" G_GUINT64_FORMAT " bytes cannot be",
			       length),
		       NULL;
	if (u64_at(h + 24) >= import_source_size(r->file) || length > e57_pages_size(r->pages) - at)
		return refuse(error, r,
			       "byte 24: its XML of %" G_GUINT64_FORMAT
			       " bytes cannot begin at byte %" G_GUINT64_FORMAT
			       ": the file has %" G_GUINT64_FORMAT,
			       length, u64_at(h + 24), import_source_size(r->file)),
		       NULL;
	g_autofree char *xml = g_malloc(length);
	return e57_pages_read(r->pages, at, xml, length, error) ? parse(r, xml, length, error)
								: NULL;
}
