#include "acquire/bench-decoders.h"
#include "acquire/driver.h"
#include "acquire/pump.h"
#include "acquire/scan-manifest.h"
#include <string.h>
#include <time.h>
#include <unistd.h>

#define SPOKEN_NS   INT64_C(3000000000)
#define MEASURED_NS INT64_C(500000000)
#define HALL(rest)  "sim:hall?camera=none&divergence_mrad=0&lidar=" rest

const struct bench_decoder bench_decoders[] = {
	{ "scip", "SCIP with intensity", "scip", HALL("scip") },
	{ "cola", "CoLa-A with intensity", "cola", HALL("cola") },
	{ "ld", "LD06 and the like", "ld", HALL("stl27l") },
	{ "rplidar_standard", "RPLIDAR standard", "rplidar", HALL("rplidar-s2&format=standard") },
	{ "rplidar_express", "RPLIDAR express", "rplidar", HALL("rplidar-s2&format=express") },
	{ "rplidar_ultra", "RPLIDAR ultra", "rplidar", HALL("rplidar-a3") },
	{ "rplidar_dense", "RPLIDAR dense", "rplidar", HALL("rplidar-s2") },
	{ "rplidar_ultra_dense", "RPLIDAR ultra-dense", "rplidar", HALL("rplidar-s3") },
	{ "rplidar_hq", "RPLIDAR HQ", "rplidar", HALL("rplidar-s2&format=hq") },
	{ NULL },
};

static int64_t processor_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

static void take_reply(const struct lidar_reply *reply, gpointer user_data)
{
	pump_take_reply(user_data, reply);
}

/* What is read from the record is what the lidar said. */
static bool keep_what_it_said(const char *path, GByteArray *bytes, GError **error)
{
	struct record_entry e;
	g_autoptr(record_reader) reader = record_open(path, error);
	if (!reader)
		return false;
	while (record_next(reader, &e, NULL) == RECORD_ENTRY)
		if (e.kind == RECORD_LIDAR_IN)
			g_byte_array_append(bytes, e.payload, e.length);
	return true;
}

static bool talk(struct pump *p, const char *uri, GError **error)
{
	g_autofree char *text = scan_session_text(uri, p->head);
	struct record_entry session = { .kind = RECORD_SESSION,
		.length = strlen(text),
		.time_ns = head_now_ns(p->head),
		.payload = text };
	return stream_feed(p->stream, &session, error) && pump_open_lidar(p, error) &&
	       p->driver->prepare(p, error) && p->driver->start(p, error) &&
	       pump_for(p, SPOKEN_NS, error);
}

static bool listen(
	const struct bench_decoder *d, const char *path, GByteArray *bytes, GError **error)
{
	g_autoptr(record_writer) record = record_create(path, error);
	g_autoptr(head) h = record ? head_open(d->uri, error) : NULL;
	if (!h)
		return false;
	struct pump p = { .head = h, .driver = driver_find(d->protocol) };
	struct stream_sink sink = { .reply = take_reply, .user_data = &p };
	g_autoptr(stream) s = p.stream = stream_new(STREAM_LIVE, &sink);
	head_attach_record(h, record);
	bool good = talk(&p, d->uri, error);
	head_attach_record(h, NULL);
	pump_clear(&p);
	return good && record_close(g_steal_pointer(&record), error) &&
	       keep_what_it_said(path, bytes, error);
}

static void count_beams(const struct scanline *line, gpointer user_data)
{
	*(uint64_t *)user_data += line->beams;
}

static double decode_again_and_again(const char *protocol, const GByteArray *bytes)
{
	uint64_t beams = 0;
	double fed = 0;
	struct decoder_sink sink = { .scanline = count_beams, .user_data = &beams };
	int64_t start_ns = processor_ns(), spent_ns = 0;
	while (spent_ns < MEASURED_NS) {
		g_autoptr(decoder) d = decoder_new(protocol, &sink);
		/* As a wire gives them: some at a time. */
		for (guint at = 0; at < bytes->len; at += 4096)
			decoder_feed(d, bytes->data + at, MIN(4096, bytes->len - at), 0);
		fed += bytes->len;
		spent_ns = processor_ns() - start_ns;
	}
	return beams ? fed * 1e3 / (double)spent_ns : 0;
}

bool bench_decoder_measure(const struct bench_decoder *d, double *ret_mb_s, GError **error)
{
	g_autoptr(GByteArray) bytes = g_byte_array_new();
	g_autofree char *folder = g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	if (!folder)
		return false;
	g_autofree char *path = g_build_filename(folder, "raw.rec", NULL);
	bool good = listen(d, path, bytes, error);
	unlink(path);
	rmdir(folder);
	if (good)
		*ret_mb_s = decode_again_and_again(d->protocol, bytes);
	else
		g_prefix_error(error, "%s: ", d->title);
	return good;
}
