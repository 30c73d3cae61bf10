#include "process/faces.h"
#include "acquire/manifest.h"
#include <json-glib/json-glib.h>
#include <string.h>

#define ENTRIES_BETWEEN_PROGRESS 512
/* A head's own parts: nothing that is measured is nearer. */
#define RANGE_MIN_M 0.3f

static void take_line(
	const struct scanline *line, const struct placed_line *placed, gpointer user_data)
{
	struct faces *f = user_data;
	struct face_line l = { .first = f->range_m->len,
		.beams = line->beams,
		.front_rad = placed->front_first_rad,
		.first_angle_rad = line->first_angle_rad,
		.angle_step_rad = line->angle_step_rad,
		.pace_rad_s = placed->turn_rad * line->scan_rate_hz };
	if (placed->suspect || line->beams < 2)
		return;
	l.front_step_rad = (placed->front_last_rad - placed->front_first_rad) / (line->beams - 1);
	g_array_set_size(f->range_m, l.first + l.beams);
	float *range = &g_array_index(f->range_m, float, l.first);
	for (uint32_t i = 0; i < line->beams; i++) {
		range[i] = scanline_has_range(line, i) ? (float)line->range_mm[i] * 1e-3f : 0;
		range[i] = range[i] < RANGE_MIN_M ? 0 : range[i];
	}
	g_array_append_val(f->lines, l);
}

static void take_frame(const struct camera_frame_info *info, const uint8_t *pixels,
	double front_rad, bool locked, gpointer user_data)
{
	struct faces *f = user_data;
	struct photo photo = { *info, pixels, front_rad };
	if (locked)
		g_array_append_val(f->photos, photo);
}

static void keep_certificate(struct faces *f, const struct record_entry *e)
{
	g_autoptr(manifest) m = manifest_parse(e->payload, e->length, "session", 0, NULL);
	JsonNode *node = m ? manifest_get_node(m, "calibration") : NULL;
	g_free(f->certificate);
	f->certificate = node ? json_to_string(node, FALSE) : NULL;
}

struct reading {
	const char *path;
	faces_progress progress;
	gpointer user_data;
};

static bool may_go_on(const struct reading *r, double fraction, GError **error)
{
	if (!r->progress || !r->progress(fraction, r->user_data))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "%s: stopped", r->path);
	return false;
}

/* One pass over the record; what is behind a cut was never whole. */
static bool feed_all(
	struct faces *f, stream *s, const struct reading *r, double from, GError **error)
{
	g_autoptr(record_reader) reader = record_open(r->path, error);
	struct record_entry e;
	enum record_result got = RECORD_BAD;
	for (uint32_t n = 0; reader && (got = record_next(reader, &e, error)) == RECORD_ENTRY;
		n++) {
		double share =
			(double)record_reader_position(reader) / (double)record_reader_size(reader);
		if (!stream_feed(s, &e, error))
			return g_prefix_error(error, "%s: ", r->path), false;
		if (e.kind == RECORD_SESSION)
			keep_certificate(f, &e);
		if (n % ENTRIES_BETWEEN_PROGRESS == 0 && !may_go_on(r, from + share / 2, error))
			return false;
	}
	g_clear_pointer(&f->record, record_reader_free);
	f->record = g_steal_pointer(&reader);
	return got != RECORD_BAD;
}

static bool finish(struct faces *f, const stream *s, const char *path, GError **error)
{
	f->report = stream_get_report(s);
	if (stream_calibration(s) && f->certificate && f->lines->len > 0) {
		f->calibration = *stream_calibration(s);
		return true;
	}
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
		"%s: there is no turn of the lidar in it that could be placed", path);
	return false;
}

struct faces *faces_read(
	const char *record_path, faces_progress progress, gpointer user_data, GError **error)
{
	g_autoptr(faces) f = g_new0(struct faces, 1);
	struct stream_sink sink = { .line = take_line, .frame = take_frame, .user_data = f };
	struct reading r = { record_path, progress, user_data };
	f->lines = g_array_new(FALSE, FALSE, sizeof(struct face_line));
	f->range_m = g_array_new(FALSE, FALSE, sizeof(float));
	f->photos = g_array_new(FALSE, FALSE, sizeof(struct photo));
	g_autoptr(stream) s = stream_new(STREAM_LEARN_FIRST, &sink);
	if (!feed_all(f, s, &r, 0, error))
		return NULL;
	stream_rewind(s);
	if (!feed_all(f, s, &r, 0.5, error) || !finish(f, s, record_path, error))
		return NULL;
	return g_steal_pointer(&f);
}

void faces_free(struct faces *f)
{
	if (!f)
		return;
	g_array_unref(f->lines);
	g_array_unref(f->range_m);
	g_array_unref(f->photos);
	record_reader_free(f->record);
	g_free(f->certificate);
	g_free(f);
}
