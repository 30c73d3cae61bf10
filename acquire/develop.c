#include "acquire/develop.h"
#include "acquire/colour.h"
#include <math.h>
#include <string.h>

/* Gaps up to this many cells are filled: a lidar with beams a third of a degree apart leaves two
 * rows of a fine grid. */
#define FILL_REACH               4u
#define FRACTION_LEARN           0.3
#define FRACTION_PLACE           0.4
#define ENTRIES_BETWEEN_PROGRESS 256

struct developing {
	panorama *panorama;
	GArray *photos; /* of struct photo, pixels in the mapped record */
};

static void take_line(
	const struct scanline *line, const struct placed_line *placed, gpointer user_data)
{
	struct developing *d = user_data;
	(void)line;
	if (placement_is_usable(placed, d->panorama->desc.columns))
		panorama_add(d->panorama, placed->azimuth_rad, placed->elevation_rad,
			placed->range_m, placed->intensity, placed->beams);
}

static void take_frame(const struct camera_frame_info *info, const uint8_t *pixels,
	double front_rad, bool locked, gpointer user_data)
{
	struct developing *d = user_data;
	struct photo photo = { *info, pixels, front_rad };
	if (locked)
		g_array_append_val(d->photos, photo);
}

void develop_result_clear(struct develop_result *r)
{
	g_clear_pointer(&r->losses, g_array_unref);
}

static void say(const struct develop_options *o, double fraction)
{
	if (o->progress)
		o->progress(fraction, o->user_data);
}

/* One pass over the record. */
static bool feed_all(stream *s, const char *path, const struct develop_options *o, double from,
	double share, struct develop_result *result, record_reader **ret_reader, GError **error)
{
	g_autoptr(record_reader) reader = record_open(path, error);
	struct record_entry e;
	if (!reader)
		return false;
	double size = (double)record_reader_size(reader);
	for (uint32_t n = 0;; n++) {
		enum record_result got = record_next(reader, &e, error);
		if (got == RECORD_BAD)
			return false;
		result->cut = got == RECORD_CUT;
		if (got != RECORD_ENTRY)
			break;
		if (!stream_feed(s, &e, error)) {
			g_prefix_error(error, "%s: ", path);
			return false;
		}
		if (n % ENTRIES_BETWEEN_PROGRESS == 0)
			say(o, from + share * (double)record_reader_position(reader) / size);
	}
	*ret_reader = g_steal_pointer(&reader);
	return true;
}

static void fill_result(stream *s, struct develop_result *result)
{
	result->report = stream_get_report(s);
	result->losses = stream_losses(s);
	if (stream_calibration(s))
		result->calibration = *stream_calibration(s);
	if (stream_lidar(s))
		result->lidar = *stream_lidar(s);
	g_strlcpy(result->protocol, stream_protocol(s), sizeof result->protocol);
}

panorama *develop_record(const char *path, const struct develop_options *o,
	struct develop_result *ret_result, GError **error)
{
	struct develop_result result = { 0 };
	g_autoptr(panorama) p = panorama_new(&o->desc, error);
	if (!p)
		return NULL;
	g_autoptr(GArray) photos = g_array_new(FALSE, FALSE, sizeof(struct photo));
	struct developing d = { p, photos };
	struct stream_sink sink = { .line = take_line, .frame = take_frame, .user_data = &d };
	g_autoptr(stream) s = stream_new(STREAM_LEARN_FIRST, &sink);
	g_autoptr(record_reader) first = NULL, second = NULL;
	if (!feed_all(s, path, o, 0, FRACTION_LEARN, &result, &first, error))
		return NULL;
	stream_rewind(s);
	if (!feed_all(s, path, o, FRACTION_LEARN, FRACTION_PLACE, &result, &second, error))
		return NULL;
	fill_result(s, &result);
	panorama_fill(p, FILL_REACH);
	if (stream_calibration(s) && stream_calibration(s)->has_camera)
		colour_panorama(p, (const struct photo *)(void *)photos->data, photos->len,
			stream_calibration(s));
	result.photos = photos->len;
	say(o, 1);
	if (ret_result)
		*ret_result = result;
	else
		develop_result_clear(&result);
	return g_steal_pointer(&p);
}
