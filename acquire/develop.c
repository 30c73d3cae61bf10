#include "acquire/develop.h"
#include "acquire/brackets.h"
#include "acquire/colour.h"
#include "acquire/lidar-delay.h"
#include "acquire/panorama-means.h"
#include <math.h>
#include <string.h>

/* Gaps up to this many cells are filled: a lidar with beams a third of a degree apart leaves two
 * rows of a fine grid. */
#define FILL_REACH               4u
#define FRACTION_LEARN           0.2
#define FRACTION_PLACE           0.25
#define ENTRIES_BETWEEN_PROGRESS 256

struct developing {
	panorama *panorama;
	GArray *beams;      /* of struct panorama_beam, in it */
	GArray *photos;     /* of struct photo, pixels its own */
	brackets *brackets; /* photos of stops */
	bool at_stop;
	lidar_delay *delay; /* NULL once it is known */
};

static void take_line(
	const struct scanline *line, const struct placed_line *placed, gpointer user_data)
{
	struct developing *d = user_data;
	bool forth = placed->turn_rad >= 0,
	     usable = placement_is_usable(placed, d->panorama->desc.columns);
	if (d->delay && (usable || !forth))
		lidar_delay_add(d->delay, line, placed);
	if (!usable || !forth)
		return;
	panorama_add_and_keep(d->panorama, placed->azimuth_rad, placed->elevation_rad,
		placed->range_m, placed->intensity, placed->beams, d->beams);
}

static void take_frame(const struct camera_frame_info *info, const uint8_t *pixels,
	double front_rad, bool locked, gpointer user_data)
{
	struct developing *d = user_data;
	if (d->at_stop)
		brackets_add(d->brackets, info, pixels, front_rad);
	if (!locked || d->at_stop)
		return;
	struct photo photo = { *info, g_memdup2(pixels, camera_frame_bytes(info)), front_rad };
	g_array_append_val(d->photos, photo);
}

static void take_stop(const struct exposures *exposures, gpointer user_data)
{
	struct developing *d = user_data;
	brackets_stop(d->brackets, exposures);
	d->at_stop = exposures->count > 0;
}

static void free_photo(gpointer data)
{
	g_free((gpointer)((struct photo *)data)->pixels);
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

/* All beams onto the grid; what went back over it tells how late the lidar's stamps are. */
static bool place_all(stream *s, struct developing *d, const char *path,
	const struct develop_options *o, double from, struct develop_result *result,
	record_reader **ret_reader, GError **error)
{
	g_array_set_size(d->photos, 0);
	g_array_set_size(d->beams, 0);
	g_clear_pointer(&d->brackets, brackets_free);
	d->brackets = brackets_new();
	d->at_stop = false;
	stream_rewind(s);
	return feed_all(s, path, o, from, FRACTION_PLACE, result, ret_reader, error);
}

/* Once more, with the delay taken off. */
static bool place_on_time(stream *s, struct developing *d, const char *path,
	const struct develop_options *o, struct develop_result *result, record_reader **reader,
	GError **error)
{
	result->delay_known = lidar_delay_estimate(d->delay, d->panorama, &result->delay);
	d->delay = NULL;
	if (!result->delay_known)
		return true;
	panorama *again = panorama_new(&o->desc, error);
	if (!again)
		return false;
	panorama_free(d->panorama);
	d->panorama = again;
	g_clear_pointer(reader, record_reader_free);
	stream_advance_lidar(s, llround(result->delay.delay_s * 1e9));
	return place_all(s, d, path, o, FRACTION_LEARN + FRACTION_PLACE, result, reader, error);
}

static void finish(stream *s, struct developing *d, struct develop_result *result)
{
	fill_result(s, result);
	panorama_set_means(d->panorama, d->beams);
	panorama_fill(d->panorama, FILL_REACH);
	result->merged_photos = brackets_take(d->brackets, d->photos);
	if (stream_calibration(s) && stream_calibration(s)->has_camera)
		colour_panorama(d->panorama, (const struct photo *)(void *)d->photos->data,
			d->photos->len, stream_calibration(s));
	result->photos = d->photos->len;
}

panorama *develop_record(const char *path, const struct develop_options *o,
	struct develop_result *ret_result, GError **error)
{
	struct develop_result result = { 0 };
	g_autoptr(GArray) photos = g_array_new(FALSE, FALSE, sizeof(struct photo));
	g_array_set_clear_func(photos, free_photo);
	g_autoptr(lidar_delay) delay = lidar_delay_new();
	g_autoptr(GArray) beams = g_array_new(FALSE, FALSE, sizeof(struct panorama_beam));
	struct developing d = { .panorama = panorama_new(&o->desc, error),
		.beams = beams,
		.photos = photos,
		.delay = delay };
	struct stream_sink sink = {
		.line = take_line, .frame = take_frame, .stop = take_stop, .user_data = &d
	};
	g_autoptr(stream) s = stream_new(STREAM_LEARN_FIRST, &sink);
	g_autoptr(record_reader) first = NULL, second = NULL;
	bool good = d.panorama && feed_all(s, path, o, 0, FRACTION_LEARN, &result, &first, error) &&
		    place_all(s, &d, path, o, FRACTION_LEARN, &result, &second, error) &&
		    place_on_time(s, &d, path, o, &result, &second, error);
	g_autoptr(panorama) p = d.panorama;
	g_autoptr(brackets) stops = d.brackets;
	if (!good)
		return NULL;
	finish(s, &d, &result);
	say(o, 1);
	if (ret_result)
		*ret_result = result;
	else
		develop_result_clear(&result);
	return g_steal_pointer(&p);
}
