/* Any bytes as the entries of a record, as developing a scan reads them: both passes, then live.
 * All that says where a beam went has to come out finite, and the panorama as planes_load would
 * take it. Marks, lengths, sequence and checksums are mended first: fuzz-record looks after those.
 */
#include "acquire/brackets.h"
#include "acquire/stream.h"
#include "firmware-io/record-format.h"
#include <math.h>
#include <string.h>

#define COLUMNS    48u
#define ROWS       24u
#define PHOTOS_MAX 8u

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct sink {
	panorama *panorama;
	GArray *photos; /* of struct photo */
	brackets *stops;
	uint64_t sum; /* so that all that is lent is read */
};

static void mend_entry(uint8_t *at, size_t room, uint32_t sequence)
{
	struct record_head h;
	memcpy(&h, at, sizeof h);
	h.mark = GUINT32_TO_LE(RECORD_ENTRY_MARK);
	h.kind = GUINT32_TO_LE(1 + GUINT32_FROM_LE(h.kind) % (RECORD_KINDS - 1));
	h.length = GUINT32_TO_LE(MIN(GUINT32_FROM_LE(h.length), room - sizeof h));
	h.sequence = GUINT32_TO_LE(sequence);
	h.zero = 0;
	size_t length = GUINT32_FROM_LE(h.length);
	memset(at + sizeof h + length, 0, MIN(record_padding(length), room - sizeof h - length));
	h.crc = GUINT32_TO_LE(crc32c(record_head_crc(&h), at + sizeof h, length));
	memcpy(at, &h, sizeof h);
}

static void mend(uint8_t *bytes, size_t size)
{
	struct record_file_header file = { .version = GUINT32_TO_LE(RECORD_FILE_VERSION) };
	memcpy(file.magic, RECORD_FILE_MAGIC, sizeof file.magic);
	file.crc = GUINT32_TO_LE(record_file_header_crc(&file));
	memcpy(bytes, &file, sizeof file);
	uint32_t sequence = 0;
	for (size_t at = sizeof file; at + sizeof(struct record_head) <= size;) {
		struct record_head h;
		mend_entry(bytes + at, size - at, sequence++);
		memcpy(&h, bytes + at, sizeof h);
		size_t length = GUINT32_FROM_LE(h.length);
		at += sizeof h + length + record_padding(length);
	}
}

static void take_line(const struct scanline *line, const struct placed_line *placed, gpointer data)
{
	struct sink *s = data;
	for (uint32_t i = 0; i < placed->beams; i++) {
		g_assert_true(placed->azimuth_rad[i] >= 0 && placed->azimuth_rad[i] < 2 * G_PI);
		g_assert_true(fabsf(placed->elevation_rad[i]) < 1.6f);
		s->sum += line->range_mm[i] + placed->intensity[i];
	}
	if (!placed->suspect)
		panorama_add(s->panorama, placed->azimuth_rad, placed->elevation_rad,
			placed->range_m, placed->intensity, placed->beams);
}

static void take_frame(const struct camera_frame_info *info, const uint8_t *pixels,
	double front_rad, bool locked, gpointer data)
{
	struct sink *s = data;
	for (size_t i = 0; i < camera_frame_bytes(info); i++)
		s->sum += pixels[i];
	g_assert_true(isfinite(front_rad));
	s->sum += locked;
	brackets_add(s->stops, info, pixels, front_rad);
	if (s->photos->len >= PHOTOS_MAX)
		return;
	struct photo photo = { *info, g_memdup2(pixels, camera_frame_bytes(info)), front_rad };
	g_array_append_val(s->photos, photo);
}

static void take_stop(const struct exposures *exposures, gpointer data)
{
	struct sink *s = data;
	brackets_stop(s->stops, exposures);
}

static void free_photo(gpointer data)
{
	g_free((gpointer)((struct photo *)data)->pixels);
}

static void take_reply(const struct lidar_reply *reply, gpointer data)
{
	struct sink *s = data;
	s->sum += strlen(reply->command) + strlen(reply->status) + strlen(reply->text);
}

static void feed_all(stream *s, GBytes *bytes)
{
	g_autoptr(record_reader) reader = record_open_bytes(bytes, "x", NULL);
	struct record_entry e;
	while (record_next(reader, &e, NULL) == RECORD_ENTRY) {
		g_autoptr(GError) error = NULL;
		if (!stream_feed(s, &e, &error)) {
			g_assert_nonnull(error);
			return;
		}
	}
}

static void check_panorama(const panorama *p)
{
	for (size_t i = 0; i < COLUMNS * ROWS; i++) {
		bool wants = p->cell[i] == CELL_MEASURED || p->cell[i] == CELL_FILLED;
		g_assert_true(
			wants ? p->range_m[i] > 0 && p->range_m[i] < 1e6f : p->range_m[i] == 0);
	}
}

static void develop(GBytes *bytes, enum stream_mode mode)
{
	struct panorama_desc desc = panorama_desc_for(COLUMNS, ROWS);
	g_autoptr(panorama) p = panorama_new(&desc, NULL);
	g_autoptr(GArray) photos = g_array_new(FALSE, FALSE, sizeof(struct photo));
	g_array_set_clear_func(photos, free_photo);
	g_autoptr(brackets) stops = brackets_new();
	struct sink sink = { p, photos, stops, 0 };
	struct stream_sink calls = { .line = take_line,
		.frame = take_frame,
		.reply = take_reply,
		.stop = take_stop,
		.user_data = &sink };
	g_autoptr(stream) s = stream_new(mode, &calls);
	feed_all(s, bytes);
	if (mode == STREAM_LEARN_FIRST) {
		stream_rewind(s);
		feed_all(s, bytes);
	}
	struct stream_report report = stream_get_report(s);
	g_autoptr(GArray) losses = stream_losses(s);
	g_assert_true(isfinite(report.drift_ppm));
	panorama_fill(p, 4);
	brackets_take(stops, photos);
	if (stream_calibration(s) && stream_calibration(s)->has_camera)
		colour_panorama(p, (const struct photo *)(void *)photos->data, photos->len,
			stream_calibration(s));
	check_panorama(p);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (size < sizeof(struct record_file_header))
		return 0;
	g_autofree uint8_t *copy = g_memdup2(data, size);
	mend(copy, size);
	g_autoptr(GBytes) bytes = g_bytes_new(copy, size);
	develop(bytes, STREAM_LEARN_FIRST);
	develop(bytes, STREAM_LIVE);
	return 0;
}
