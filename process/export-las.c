/* LAS 1.4, point format 7 (ASPRS): all points in the coordinates of the site, or of its map. Which station saw one is its source id;
 * where the stations stand tells a record of ours. No coordinate system is named: the site does not know of any. */
#include "acquire/version.h"
#include "process/export-verify.h"
#include "process/pose-json.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

#define HEADER_BYTES 375
#define VLR_BYTES    54
#define POINT_BYTES  36
#define POINT_FORMAT 7
#define STEP_M       1e-4
/* Seconds from 1970 to the beginning of GPS time, less the leap seconds since; LAS takes another 1e9 off. */
#define GPS_BEGAN_S (315964800.0 - 18)
/* GPS time less 1e9 s; a coordinate system would be named in WKT, as it must be said of these point formats. */
#define GLOBAL_ENCODING (1 | 16)

struct export_las {
	const struct export_job *job;
	FILE *file;
	const struct export_station *station;
	double offset_m[3];
	uint64_t by_return[15];
};

static void put_u16(uint8_t *at, unsigned value)
{
	uint16_t bytes = GUINT16_TO_LE((uint16_t)value);
	memcpy(at, &bytes, sizeof bytes);
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

static void put_f64(uint8_t *at, double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	put_u64(at, bits);
}

/* ---- the header ---- */

struct extent {
	double low_m[3], high_m[3];
	uint64_t points;
};

static struct extent extent_of(const struct export_job *j)
{
	struct extent e = { .points = 0 };
	for (guint i = 0; i < j->stations->len; i++) {
		const struct export_survey *s = &export_station_at(j, i)->survey;
		for (int k = 0; k < 3; k++) {
			e.low_m[k] = i ? fmin(e.low_m[k], s->low_m[k]) : s->low_m[k];
			e.high_m[k] = i ? fmax(e.high_m[k], s->high_m[k]) : s->high_m[k];
		}
		e.points += s->points;
	}
	return e;
}

/* Whole metres near the middle; steps of 0.1 mm reach 200 km from there. */
static bool find_offset(struct export_las *w, const struct extent *e, GError **error)
{
	for (int k = 0; k < 3; k++) {
		w->offset_m[k] = rint((e->low_m[k] + e->high_m[k]) / 2);
		double reach = fmax(e->high_m[k] - w->offset_m[k], w->offset_m[k] - e->low_m[k]);
		if (reach / STEP_M < INT32_MAX)
			continue;
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_SUPPORTED,
			"%s: reaches over %.0f km, too far for LAS in steps of 0.1 mm",
			site_path(w->job->site), (e->high_m[k] - e->low_m[k]) / 1000);
		return false;
	}
	return true;
}

static void put_guid(uint8_t at[16], const struct export_job *j)
{
	g_autofree char *guid = export_guid(j, 0, "las");
	const char *digit = guid;
	for (int i = 0; i < 16; i++) {
		digit += strspn(digit, "{-}");
		at[i] = (uint8_t)(g_ascii_xdigit_value(digit[0]) << 4 |
				  g_ascii_xdigit_value(digit[1]));
		digit += 2;
	}
}

static void put_day(uint8_t *h)
{
	g_autoptr(GDateTime) now = g_date_time_new_now_utc();
	put_u16(h + 90, (unsigned)g_date_time_get_day_of_year(now));
	put_u16(h + 92, (unsigned)g_date_time_get_year(now));
}

static void put_counts(const struct export_las *w, uint8_t *h, uint64_t count)
{
	put_u64(h + 247, count);
	for (int i = 0; i < 15; i++)
		put_u64(h + 255 + 8 * i, w->by_return[i]);
}

/* As a point there reads. */
static double stepped(const struct export_las *w, double at_m, int axis)
{
	return rint((at_m - w->offset_m[axis]) / STEP_M) * STEP_M + w->offset_m[axis];
}

/* Legacy counts stay 0: point format 7 is none of theirs. */
static void put_header(const struct export_las *w, const struct extent *e, size_t record_bytes)
{
	uint8_t h[HEADER_BYTES] = "LASF";
	put_u16(h + 6, GLOBAL_ENCODING);
	put_guid(h + 8, w->job);
	h[24] = 1;
	h[25] = 4;
	memcpy(h + 26, "pleinair", 8);
	memcpy(h + 58, "pleinair " PLEINAIR_VERSION, sizeof "pleinair " PLEINAIR_VERSION - 1);
	put_day(h);
	put_u16(h + 94, HEADER_BYTES);
	put_u32(h + 96, (uint32_t)(HEADER_BYTES + VLR_BYTES + record_bytes));
	put_u32(h + 100, 1);
	h[104] = POINT_FORMAT;
	put_u16(h + 105, POINT_BYTES);
	for (int k = 0; k < 3; k++) {
		put_f64(h + 131 + 8 * k, STEP_M);
		put_f64(h + 155 + 8 * k, w->offset_m[k]);
		put_f64(h + 179 + 16 * k, stepped(w, e->high_m[k], k));
		put_f64(h + 187 + 16 * k, stepped(w, e->low_m[k], k));
	}
	put_counts(w, h, e->points);
	fseeko(w->file, 0, SEEK_SET);
	fwrite(h, 1, sizeof h, w->file);
}

/* Source ids and poses, for whoever wants to know. */
static char *stations_text(const struct export_job *j)
{
	JsonArray *array = json_array_new();
	for (guint i = 0; i < j->stations->len; i++) {
		const struct export_station *s = export_station_at(j, i);
		JsonObject *o = json_object_new();
		json_object_set_int_member(o, "source_id", s->number);
		json_object_set_string_member(o, "name", s->name);
		if (s->has_pose)
			json_object_set_member(o, "pose", json_write_pose(&s->pose));
		json_array_add_object_element(array, o);
	}
	g_autoptr(JsonNode) node = json_node_new(JSON_NODE_ARRAY);
	json_node_take_array(node, array);
	return json_to_string(node, false);
}

static void put_record(const struct export_las *w, const char *text, size_t length)
{
	uint8_t v[VLR_BYTES] = { 0 };
	memcpy(v + 2, "pleinair", 8);
	put_u16(v + 18, 1);
	put_u16(v + 20, (unsigned)length);
	memcpy(v + 22, "stations: source ids and poses", 30);
	fwrite(v, 1, sizeof v, w->file);
	fwrite(text, 1, length, w->file);
}

static size_t record_length(const char *text)
{
	size_t length = strlen(text);
	return length <= UINT16_MAX ? length : 0; /* of hundreds of stations: left out */
}

/* ---- points ---- */

/* Of the station's begin: of single points no time is kept. */
static double gps_time_of(const struct export_station *s)
{
	return isfinite(s->started_s) ? s->started_s - GPS_BEGAN_S - 1e9 : 0;
}

static void encode(gpointer user_data, const struct export_station *s, const struct export_point *p,
	uint8_t *at)
{
	const struct export_las *w = user_data;
	unsigned echo = MIN(p->return_number, 15);
	memset(at, 0, POINT_BYTES);
	for (int k = 0; k < 3; k++)
		put_u32(at + 4 * k,
			(uint32_t)(int32_t)rint((p->at_m[k] - w->offset_m[k]) / STEP_M));
	put_u16(at + 12, p->intensity);
	at[14] = (uint8_t)(echo | echo << 4);
	at[16] = p->classification;
	put_u16(at + 20, s->number);
	put_f64(at + 22, gps_time_of(s));
	for (int k = 0; k < 3; k++)
		put_u16(at + 30 + 2 * k, p->rgb[k] * 257u);
}

static bool write_points(
	export_writer *writer, const struct export_point *p, size_t count, GError **error)
{
	struct export_las *w = (struct export_las *)writer;
	uint8_t block[64 * POINT_BYTES];
	(void)error;
	for (size_t i = 0; i < count;) {
		size_t some = 0;
		for (; some < 64 && i < count; some++, i++) {
			encode(w, w->station, &p[i], block + some * POINT_BYTES);
			w->by_return[MIN(p[i].return_number, 15) - 1]++;
		}
		fwrite(block, POINT_BYTES, some, w->file);
	}
	return true;
}

static bool begin_station(export_writer *writer, const struct export_station *s, GError **error)
{
	struct export_las *w = (struct export_las *)writer;
	(void)error;
	w->station = s;
	return true;
}

static bool end_station(export_writer *writer, GError **error)
{
	(void)writer;
	(void)error;
	return true;
}

/* ---- the format ---- */

static bool finish(export_writer *writer, GError **error)
{
	struct export_las *w = (struct export_las *)writer;
	struct extent e = extent_of(w->job);
	g_autofree char *text = stations_text(w->job);
	(void)error;
	put_header(w, &e, record_length(text));
	return true;
}

static export_writer *open_writer(const struct export_job *j, FILE *file, GError **error)
{
	struct export_las *w = g_new0(struct export_las, 1);
	struct extent e = extent_of(j);
	g_autofree char *text = stations_text(j);
	size_t length = record_length(text);
	w->job = j;
	w->file = file;
	if (!find_offset(w, &e, error)) {
		g_free(w);
		return NULL;
	}
	put_header(w, &e, length);
	put_record(w, text, length);
	g_ptr_array_add(
		j->notes, g_strdup("no coordinate system is named in it, on purpose: which one the "
				   "coordinates are of is not known to the site"));
	return (export_writer *)w;
}

static void close_writer(export_writer *writer)
{
	g_free(writer);
}

static double resolution_m(const struct export_job *j)
{
	(void)j;
	return STEP_M;
}

static bool verify(const struct export_job *j, const char *path, GError **error)
{
	struct export_las w = { .job = j };
	struct extent e = extent_of(j);
	g_autofree char *text = stations_text(j);
	struct export_records records = { .header_bytes =
						  HEADER_BYTES + VLR_BYTES + record_length(text),
		.record_bytes = POINT_BYTES,
		.encode = encode,
		.user_data = &w };
	return find_offset(&w, &e, error) && export_verify_records(j, &records, path, error) &&
	       export_verify_by_import(j, &import_las, path, true, error);
}

const struct export_format export_las = { .name = "LAS",
	.extension = "las",
	.merged = true,
	.has_map = true,
	.order = EXPORT_WALK_POINTS,
	.open = open_writer,
	.begin = begin_station,
	.write = write_points,
	.end = end_station,
	.finish = finish,
	.close = close_writer,
	.verify = verify,
	.resolution_m = resolution_m };
