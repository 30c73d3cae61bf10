#include "process/e57-pages.h"
#include "firmware-io/crc32c.h"
#include <gio/gio.h>
#include <string.h>

#define CACHE_PAGES 64u

struct e57_pages {
	import_source *file;
	uint64_t size;                               /* logical */
	uint64_t first, count;                       /* pages in the cache */
	uint8_t cache[CACHE_PAGES * E57_PAGE_BYTES]; /* their bytes, checked */
};

e57_pages *e57_pages_new(import_source *file)
{
	e57_pages *p = g_new0(e57_pages, 1);
	uint64_t size = import_source_size(file), rest = size % E57_PAGE_BYTES;
	p->file = file;
	p->size = size / E57_PAGE_BYTES * E57_PAGE_PAYLOAD + MIN(rest, E57_PAGE_PAYLOAD);
	return p;
}

void e57_pages_free(e57_pages *p)
{
	g_free(p);
}

uint64_t e57_pages_size(const e57_pages *p)
{
	return p->size;
}

bool e57_pages_refuse(GError **error, const e57_pages *p, uint64_t logical, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	return import_refuse(error, p->file, G_IO_ERROR_INVALID_DATA,
		"byte %" G_GUINT64_FORMAT ": %s", e57_physical(logical), what);
}

static bool check_page(const e57_pages *p, uint64_t page, const uint8_t *bytes, GError **error)
{
	uint32_t told;
	memcpy(&told, bytes + E57_PAGE_PAYLOAD, sizeof told);
	if (GUINT32_FROM_BE(told) == crc32c(0, bytes, E57_PAGE_PAYLOAD))
		return true;
	return e57_pages_refuse(error, p, page * E57_PAGE_PAYLOAD,
		"the page of 1024 bytes that begins here is damaged: its checksum is another");
}

static bool load(e57_pages *p, uint64_t page, GError **error)
{
	size_t got;
	p->count = 0;
	if (!import_source_read(
		    p->file, page * E57_PAGE_BYTES, p->cache, sizeof p->cache, &got, error))
		return false;
	uint64_t whole = got / E57_PAGE_BYTES;
	if (whole == 0)
		return e57_pages_refuse(error, p, page * E57_PAGE_PAYLOAD,
			"the file is cut short in the page of 1024 bytes that begins here");
	for (uint64_t i = 0; i < whole; i++)
		if (!check_page(
			    p, page + i, p->cache + i * E57_PAGE_BYTES, i == 0 ? error : NULL)) {
			/* Those before it are good; that one is refused when it is wanted. */
			whole = i;
			break;
		}
	p->first = page;
	p->count = whole;
	return whole > 0;
}

bool e57_pages_read(e57_pages *p, uint64_t logical, void *into, size_t length, GError **error)
{
	if (logical > p->size || length > p->size - logical)
		return e57_pages_refuse(error, p, MIN(logical, p->size),
			"the file is cut short: it ends at byte %" G_GUINT64_FORMAT
			", and %zu more bytes should stand here",
			import_source_size(p->file), length);
	for (uint8_t *at = into; length;) {
		uint64_t page = logical / E57_PAGE_PAYLOAD, in_page = logical % E57_PAGE_PAYLOAD;
		size_t some = (size_t)MIN(length, E57_PAGE_PAYLOAD - in_page);
		if ((page < p->first || page - p->first >= p->count) && !load(p, page, error))
			return false;
		memcpy(at, p->cache + (page - p->first) * E57_PAGE_BYTES + in_page, some);
		at += some;
		logical += some;
		length -= some;
	}
	return true;
}
