#include "acquire/rate-check.h"
#include "acquire/driver.h"
#include "acquire/pump.h"
#include "acquire/scan-manifest.h"
#include <glib/gstdio.h>
#include <string.h>
#include <sys/resource.h>

#define SECOND_NS INT64_C(1000000000)

struct checking {
	struct pump pump;
	int64_t begun_ns;
	double seconds;
	bool (*goes_on)(double fraction, gpointer user_data);
	gpointer user_data;
};

static double cpu_seconds(void)
{
	struct rusage u;
	getrusage(RUSAGE_SELF, &u);
	return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
	       1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static void take_reply(const struct lidar_reply *reply, gpointer user_data)
{
	pump_take_reply(&((struct checking *)user_data)->pump, reply);
}

static bool each_turn(gpointer user_data, GError **error)
{
	struct checking *c = user_data;
	double gone_s = (double)(head_now_ns(c->pump.head) - c->begun_ns) * 1e-9;
	if (!c->begun_ns || !c->goes_on ||
		c->goes_on(CLAMP(gone_s / c->seconds, 0, 1), c->user_data))
		return true;
	g_set_error_literal(error, PUMP_ERROR, PUMP_ERROR_STOPPED, "the check was stopped");
	return false;
}

static bool begin(struct checking *c, const char *uri, record_writer *record, GError **error)
{
	head *h = c->pump.head;
	g_autofree char *text = scan_session_text(uri, h);
	struct record_entry e = { .kind = RECORD_SESSION,
		.length = strlen(text),
		.time_ns = head_now_ns(h),
		.payload = text };
	if (!c->pump.driver) {
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
			"there is no driver for lidars that speak '%s'", h->lidar_protocol);
		return false;
	}
	head_attach_record(h, record);
	return record_write(record, e.kind, e.time_ns, text, e.length, NULL, 0, error) &&
	       stream_feed(c->pump.stream, &e, error) && pump_open_lidar(&c->pump, error) &&
	       pump_prepare_lidar(&c->pump, error) && pump_start_lidar(&c->pump, error);
}

static bool stream_for_a_while(struct checking *c, struct rate_check *ret, GError **error)
{
	head *h = c->pump.head;
	struct stream_report before = stream_get_report(c->pump.stream);
	double cpu_s = cpu_seconds();
	c->begun_ns = head_now_ns(h);
	if (!pump_for(&c->pump, (int64_t)(c->seconds * SECOND_NS), error))
		return false;
	ret->seconds = (double)(head_now_ns(h) - c->begun_ns) * 1e-9;
	ret->core_percent = 100 * (cpu_seconds() - cpu_s) / ret->seconds;
	ret->report = stream_get_report(c->pump.stream);
	ret->report.revolutions -= before.revolutions;
	ret->counts = wire_count(h->lidar);
	ret->lidar = *stream_lidar(c->pump.stream);
	return pump_stop_lidar(&c->pump, error);
}

static bool check(struct checking *c, const char *uri, const char *path, struct rate_check *ret,
	GError **error)
{
	g_autoptr(head) h = head_open(uri, error);
	g_autoptr(record_writer) record = h ? record_create(path, error) : NULL;
	if (!record)
		return false;
	c->pump.head = h;
	c->pump.driver = driver_find(h->lidar_protocol);
	bool good = begin(c, uri, record, error) && stream_for_a_while(c, ret, error);
	head_attach_record(h, NULL);
	return good && record_close(g_steal_pointer(&record), error);
}

bool rate_check(const char *uri, double seconds,
	bool (*goes_on)(double fraction, gpointer user_data), gpointer user_data,
	struct rate_check *ret, GError **error)
{
	struct checking c = { .seconds = seconds, .goes_on = goes_on, .user_data = user_data };
	struct stream_sink sink = { .reply = take_reply, .user_data = &c };
	g_autofree char *folder = g_dir_make_tmp("pleinair-rate-XXXXXX", error);
	if (!folder)
		return false;
	g_autofree char *path = g_build_filename(folder, "raw.rec", NULL);
	c.pump = (struct pump){
		.stream = stream_new(STREAM_LIVE, &sink), .each_turn = each_turn, .user_data = &c
	};
	bool good = check(&c, uri, path, ret, error);
	pump_clear(&c.pump);
	stream_free(c.pump.stream);
	g_unlink(path);
	g_rmdir(folder);
	return good;
}
