/* LAS 1.0 to 1.4 (ASPRS), point formats 0 to 3 and 6 to 8. One file is one cloud. */
#include "acquire/panorama.h"
#include "process/import.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define HEADER_BYTES     375 /* of 1.4; 227 of 1.2 and older, 235 of 1.3 */
#define BLOCK_BYTES      (1u << 20)
#define COORDINATE_MAX_M 1e9
/* Coordinates beyond are of a map, and get an origin. */
#define LOCAL_MAX_M 1000.0

/* Where the fields of a point format lie; colour 0: none. */
struct layout {
	bool known;
	uint16_t bytes, colour;
	bool extended; /* formats from 6 on */
};
static const struct layout layouts[] = { [0] = { true, 20, 0, false },
	[1] = { true, 28, 0, false },
	[2] = { true, 26, 20, false },
	[3] = { true, 34, 28, false },
	[6] = { true, 30, 0, true },
	[7] = { true, 36, 30, true },
	[8] = { true, 38, 30, true } };
#define FORMATS 11 /* 0 to 10; 4, 5, 9 and 10 have waveforms */

struct las {
	import_source *file;
	const struct layout *layout;
	uint8_t minor, format;
	uint16_t record_bytes;
	uint64_t first, count,
		at; /* byte of the first record; records, and how many of them were read */
	double scale[3], offset_m[3];
	bool narrow_colour; /* 8 bit in fields of 16 */
	bool begun, has_origin;
	uint8_t *block;
	size_t block_records; /* at most */
	struct import_scan scan;
};

#define refuse(error, r, ...) import_refuse(error, (r)->file, G_IO_ERROR_INVALID_DATA, __VA_ARGS__)

static uint16_t u16(const uint8_t *at)
{
	uint16_t value;
	memcpy(&value, at, sizeof value);
	return GUINT16_FROM_LE(value);
}

static uint32_t u32(const uint8_t *at)
{
	uint32_t value;
	memcpy(&value, at, sizeof value);
	return GUINT32_FROM_LE(value);
}

static uint64_t u64(const uint8_t *at)
{
	uint64_t value;
	memcpy(&value, at, sizeof value);
	return GUINT64_FROM_LE(value);
}

static double f64(const uint8_t *at)
{
	uint64_t bits = u64(at);
	double value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

/* ---- the header ---- */

static bool check_version(const struct las *r, const uint8_t *h, size_t length, GError **error)
{
	static const uint16_t header_bytes[] = { 227, 227, 227, 235, 375 };
	if (length < 4 || memcmp(h, "LASF", 4) != 0)
		return refuse(error, r, "does not begin with LASF, as LAS files do");
	if (length < header_bytes[0])
		return refuse(error, r, "is cut short in its header, at byte %zu", length);
	if (h[24] != 1 || h[25] > 4)
		return import_refuse(error, r->file, G_IO_ERROR_NOT_SUPPORTED,
			"is LAS %u.%u; LAS 1.0 to 1.4 are read", h[24], h[25]);
	uint16_t need = header_bytes[h[25]], told = u16(h + 94);
	if (length < need)
		return refuse(error, r, "is cut short in its header, at byte %zu", length);
	if (told < need)
		return refuse(error, r, "byte 94: a header of LAS 1.%u has %u bytes, not %u", h[25],
			need, told);
	if (u32(h + 96) < told || u32(h + 96) > import_source_size(r->file))
		return refuse(error, r,
			"byte 96: the points cannot begin at byte %u: the header has %u bytes and "
			"the "
			"file %" G_GUINT64_FORMAT,
			u32(h + 96), told, import_source_size(r->file));
	return true;
}

static bool read_format(struct las *r, const uint8_t *h, GError **error)
{
	r->minor = h[25];
	r->format = h[104];
	r->record_bytes = u16(h + 105);
	r->first = u32(h + 96);
	if (r->format & 0xc0)
		return import_refuse(error, r->file, G_IO_ERROR_NOT_SUPPORTED,
			"is LAZ, compressed LAS, which is not read here: make it LAS first, as "
			"with "
			"'laszip -i FILE.laz -o FILE.las'");
	if (r->format >= FORMATS)
		return refuse(error, r, "byte 104: there is no point format %u", r->format);
	if (r->format >= G_N_ELEMENTS(layouts) || !layouts[r->format].known)
		return import_refuse(error, r->file, G_IO_ERROR_NOT_SUPPORTED,
			"has points of format %u, with waveforms; formats 0 to 3 and 6 to 8 are "
			"read",
			r->format);
	r->layout = &layouts[r->format];
	if (r->record_bytes < r->layout->bytes)
		return refuse(error, r,
			"byte 105: a point of format %u has %u bytes or more, not %u", r->format,
			r->layout->bytes, r->record_bytes);
	return true;
}

/* LAS 1.4 has a count of 64 bits beside that of 32, which is 0 where it cannot say it. */
static bool read_count(struct las *r, const uint8_t *h, GError **error)
{
	uint64_t legacy = u32(h + 107);
	r->count = r->minor >= 4 ? u64(h + 247) : legacy;
	if (r->minor >= 4 && r->count == 0)
		r->count = legacy;
	else if (legacy && legacy != r->count)
		return refuse(error, r,
			"bytes 107 and 247 do not agree: %" G_GUINT64_FORMAT
			" points, and %" G_GUINT64_FORMAT,
			legacy, r->count);
	return r->count || refuse(error, r, "has no points");
}

/* Behind the points there may be extended records, from 1.4 on. */
static uint64_t end_of_points(const struct las *r, const uint8_t *h)
{
	uint64_t size = import_source_size(r->file), end = size;
	if (r->minor >= 4 && u32(h + 243))
		end = MIN(end, u64(h + 235));
	return end;
}

static bool check_room(const struct las *r, const uint8_t *h, GError **error)
{
	uint64_t size = import_source_size(r->file), end = end_of_points(r, h);
	uint64_t room = (size - r->first) / r->record_bytes;
	if (r->count > room)
		return refuse(error, r,
			"its header tells of %" G_GUINT64_FORMAT
			" points, and the file ends at byte %" G_GUINT64_FORMAT
			" after %" G_GUINT64_FORMAT " of them",
			r->count, size, room);
	uint64_t behind = r->first + r->count * r->record_bytes;
	if (end < behind)
		return refuse(error, r,
			"its %" G_GUINT64_FORMAT " points reach to byte %" G_GUINT64_FORMAT
			", beyond byte %" G_GUINT64_FORMAT
			", where the header says that something else begins",
			r->count, behind, end);
	if (end - behind < r->record_bytes)
		return true;
	return refuse(error, r,
		"its header tells of %" G_GUINT64_FORMAT " points, and from byte %" G_GUINT64_FORMAT
		" on there is room for %" G_GUINT64_FORMAT " more",
		r->count, behind, (end - behind) / r->record_bytes);
}

static bool read_scales(struct las *r, const uint8_t *h, GError **error)
{
	for (int i = 0; i < 3; i++) {
		r->scale[i] = f64(h + 131 + 8 * i);
		r->offset_m[i] = f64(h + 155 + 8 * i);
		if (!(r->scale[i] > 0) || !isfinite(r->scale[i]))
			return refuse(error, r, "byte %d: a scale of %g cannot be", 131 + 8 * i,
				r->scale[i]);
		if (!(fabs(r->offset_m[i]) <= COORDINATE_MAX_M))
			return refuse(error, r, "byte %d: an offset of %g m cannot be", 155 + 8 * i,
				r->offset_m[i]);
	}
	return true;
}

/* ---- points ---- */

static size_t records_in_block(const struct las *r)
{
	return (size_t)MIN(r->block_records, r->count - r->at);
}

static bool read_block(struct las *r, size_t records, GError **error)
{
	uint64_t from = r->first + r->at * r->record_bytes;
	size_t got, need = records * r->record_bytes;
	if (!import_source_read(r->file, from, r->block, need, &got, error))
		return false;
	return got == need ||
	       refuse(error, r, "is cut short at byte %" G_GUINT64_FORMAT, from + got);
}

/* Colours should have 16 bits, and some writers give 8: then none is above 255. */
static bool find_colour_depth(struct las *r, GError **error)
{
	uint16_t all = 0;
	for (r->at = 0; r->layout->colour && r->at < r->count && all <= 255;) {
		size_t records = records_in_block(r);
		if (!read_block(r, records, error))
			return false;
		for (size_t i = 0; i < records; i++) {
			const uint8_t *at = r->block + i * r->record_bytes + r->layout->colour;
			all |= u16(at) | u16(at + 2) | u16(at + 4);
		}
		r->at += records;
	}
	r->at = 0;
	r->narrow_colour = all <= 255;
	return true;
}

static bool is_withheld(const struct las *r, const uint8_t *record)
{
	return r->layout->extended ? record[15] & 4 : record[15] & 0x80;
}

static uint8_t colour8(const struct las *r, uint16_t value)
{
	return (uint8_t)(r->narrow_colour ? value : (value * 255u + 32767) / 65535);
}

/* The numbers of the file, as any reader of doubles has them. */
static bool locate(struct las *r, const uint8_t *record, double ret[3], GError **error)
{
	for (int i = 0; i < 3; i++) {
		ret[i] = (int32_t)u32(record + 4 * i) * r->scale[i] + r->offset_m[i];
		if (!(fabs(ret[i]) <= COORDINATE_MAX_M))
			return refuse(error, r,
				"point %" G_GUINT64_FORMAT ": %g m is too far to be a point",
				r->at + 1, ret[i]);
	}
	if (r->has_origin)
		return true;
	r->has_origin = true;
	bool local = fabs(ret[0]) <= LOCAL_MAX_M && fabs(ret[1]) <= LOCAL_MAX_M &&
		     fabs(ret[2]) <= LOCAL_MAX_M;
	for (int i = 0; i < 3 && !local; i++)
		r->scan.origin_m[i] = rint(ret[i]);
	return true;
}

static bool take(struct las *r, const uint8_t *record, struct point_record *into, GError **error)
{
	bool extended = r->layout->extended;
	double xyz[3];
	if (!locate(r, record, xyz, error))
		return false;
	*into = (struct point_record){ .x_m = xyz[0] - r->scan.origin_m[0],
		.y_m = xyz[1] - r->scan.origin_m[1],
		.z_m = xyz[2] - r->scan.origin_m[2],
		.intensity = u16(record + 12),
		.classification = extended ? record[16] : record[15] & 31,
		.cell = CELL_MEASURED,
		.return_number = MAX(record[14] & (extended ? 15 : 7), 1) };
	const uint8_t *colour = record + r->layout->colour;
	for (int i = 0; i < 3 && r->layout->colour; i++)
		into->rgb[i] = colour8(r, u16(colour + 2 * i));
	return true;
}

static bool las_read(import_reader *reader, struct point_record *into, size_t max,
	size_t *ret_count, GError **error)
{
	struct las *r = (struct las *)reader;
	*ret_count = 0;
	while (*ret_count == 0 && r->at < r->count) {
		size_t records = MIN(records_in_block(r), max);
		if (!read_block(r, records, error))
			return false;
		for (size_t i = 0; i < records; i++, r->at++) {
			const uint8_t *record = r->block + i * r->record_bytes;
			if (is_withheld(r, record))
				r->scan.left_out++;
			else if (!take(r, record, &into[(*ret_count)++], error))
				return false;
		}
	}
	if (*ret_count == 0 && r->scan.left_out == r->count)
		return refuse(error, r, "has no points but withheld ones");
	return true;
}

static enum import_result las_next_scan(
	import_reader *reader, const struct import_scan **ret, GError **error)
{
	struct las *r = (struct las *)reader;
	(void)error;
	if (r->begun)
		return IMPORT_END;
	r->begun = true;
	r->scan =
		(struct import_scan){ .count = r->count, .has_pose = true, .pose = POSE_IDENTITY };
	*ret = &r->scan;
	return IMPORT_SCAN;
}

/* ---- the format ---- */

static bool las_probe(const uint8_t *start, size_t length)
{
	return length >= 4 && memcmp(start, "LASF", 4) == 0;
}

static void las_close(import_reader *reader)
{
	struct las *r = (struct las *)reader;
	if (!r)
		return;
	g_free(r->block);
	g_free(r);
}

static bool read_header(struct las *r, GError **error)
{
	uint8_t h[HEADER_BYTES] = { 0 };
	size_t length;
	if (!import_source_read(r->file, 0, h, sizeof h, &length, error) ||
		!check_version(r, h, length, error) || !read_format(r, h, error) ||
		!read_count(r, h, error) || !check_room(r, h, error) || !read_scales(r, h, error))
		return false;
	r->block_records = MAX(BLOCK_BYTES / r->record_bytes, 1);
	r->block = g_malloc(r->block_records * r->record_bytes);
	return find_colour_depth(r, error);
}

static import_reader *las_open(
	import_source *file, const struct import_options *options, GError **error)
{
	(void)options;
	struct las *r = g_new0(struct las, 1);
	r->file = file;
	if (read_header(r, error))
		return (import_reader *)r;
	las_close((import_reader *)r);
	return NULL;
}

static double las_fraction(const import_reader *reader)
{
	const struct las *r = (const struct las *)reader;
	return (double)r->at / (double)r->count;
}

const struct import_format import_las = { "LAS", "las", las_probe, las_open, las_next_scan,
	las_read, las_fraction, las_close };
