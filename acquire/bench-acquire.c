#include "acquire/bench-acquire.h"
#include "acquire/bench-decoders.h"
#include "acquire/cli.h"
#include "acquire/driver.h"
#include "acquire/run.h"
#include "acquire/scan-manifest.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

struct figures {
	double wall_s, cpu_s, peak_mib;
	struct stream_report report;
	uint64_t bytes;
	double decode_mb_s[16]; /* of bench_decoders */
};

static double cpu_seconds(void)
{
	struct rusage u;
	getrusage(RUSAGE_SELF, &u);
	return u.ru_utime.tv_sec + u.ru_stime.tv_sec +
	       1e-6 * (u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static double peak_mib(void)
{
	struct rusage u;
	getrusage(RUSAGE_SELF, &u);
	return u.ru_maxrss / 1024.0;
}

struct limit {
	int64_t end_us;
};

/* The scan is stopped by the clock, not by its being complete. */
static bool is_over(const struct run_progress *p, gpointer user_data)
{
	const struct limit *l = user_data;
	(void)p;
	return g_get_monotonic_time() > l->end_us;
}

/* All that a scan does up to the last beam: dialogue, stage, record, placing, coverage, preview. */
static bool measure_recording(
	const struct bench_acquire_options *o, const char *path, struct figures *f, GError **error)
{
	struct limit limit = { 0 };
	g_autofree char *uri = g_strdup_printf(
		"sim:hall?speed=1&ares=%u&camera=none&divergence_mrad=0", (o->beams - 1) / 3 * 4);
	struct run_options options = {
		.preset = preset_find("fine"), .progress = is_over, .user_data = &limit
	};
	g_autoptr(GError) stopped = NULL;
	g_autoptr(record_writer) record = record_create(path, error);
	g_autoptr(head) h = record ? head_open(uri, error) : NULL;
	if (!h)
		return false;
	h->camera = NULL;
	g_autoptr(run) r = run_new(h, &options);
	g_autofree char *text = scan_session_text(uri, h);
	struct record_entry e = { .kind = RECORD_SESSION,
		.length = strlen(text),
		.time_ns = head_now_ns(h),
		.payload = text };
	head_attach_record(h, record);
	limit.end_us = INT64_MAX;
	if (!record_write(record, e.kind, e.time_ns, text, e.length, NULL, 0, error) ||
		!run_begin(r, &e, error) || !run_prepare(r, error))
		return false;
	double cpu = cpu_seconds();
	int64_t start_us = g_get_monotonic_time();
	limit.end_us = start_us + (int64_t)(o->seconds * G_USEC_PER_SEC);
	if (!run_scan(r, &stopped) && !g_error_matches(stopped, PUMP_ERROR, PUMP_ERROR_STOPPED)) {
		g_propagate_error(error, g_steal_pointer(&stopped));
		return false;
	}
	f->wall_s = (double)(g_get_monotonic_time() - start_us) * 1e-6;
	f->cpu_s = cpu_seconds() - cpu;
	f->peak_mib = peak_mib();
	f->report = run_report(r);
	f->bytes = record_writer_size(record);
	head_attach_record(h, NULL);
	return record_close(g_steal_pointer(&record), error);
}

static void print(const struct bench_acquire_options *o, const struct figures *f)
{
	double core = 100 * f->cpu_s / f->wall_s;
	if (!o->json) {
		printf("acquire: SCIP, 40 Hz x %u beams with intensity, simulated in real time\n",
			o->beams);
		printf("  %-28s %10.1f s\n", "recorded", f->wall_s);
		printf("  %-28s %10" G_GUINT64_FORMAT "\n", "revolutions", f->report.revolutions);
		printf("  %-28s %10" G_GUINT64_FORMAT "      (reach: 0)\n", "revolutions lost",
			f->report.lost_revolutions);
		printf("  %-28s %10.2f %%    (reach: <= 10)\n", "of one core", core);
		printf("  %-28s %10.1f MiB  (reach: <= 64)\n", "peak resident memory", f->peak_mib);
		printf("  %-28s %10.2f MB/s\n", "written", (double)f->bytes * 1e-6 / f->wall_s);
		printf("decoders, one core each\n");
		for (size_t i = 0; bench_decoders[i].key; i++)
			printf("  %-28s %10.0f MB/s (reach: >= 200)\n", bench_decoders[i].title,
				f->decode_mb_s[i]);
		return;
	}
	JsonObject *j = json_object_new();
	json_object_set_double_member(j, "seconds", f->wall_s);
	json_object_set_int_member(j, "beams", o->beams);
	json_object_set_int_member(j, "revolutions", (int64_t)f->report.revolutions);
	json_object_set_int_member(j, "revolutions_lost", (int64_t)f->report.lost_revolutions);
	json_object_set_double_member(j, "core_percent", core);
	json_object_set_double_member(j, "peak_mib", f->peak_mib);
	JsonObject *decoders = json_object_new();
	for (size_t i = 0; bench_decoders[i].key; i++)
		json_object_set_double_member(decoders, bench_decoders[i].key, f->decode_mb_s[i]);
	json_object_set_object_member(j, "decode_mb_s", decoders);
	cli_print_json(j);
}

bool bench_acquire(const struct bench_acquire_options *o, GError **error)
{
	struct figures f = { 0 };
	g_autofree char *folder = g_dir_make_tmp("pleinair-bench-XXXXXX", error);
	if (!folder)
		return false;
	g_autofree char *path = g_build_filename(folder, "raw.rec", NULL);
	bool good = measure_recording(o, path, &f, error);
	for (size_t i = 0; good && bench_decoders[i].key; i++)
		good = bench_decoder_measure(&bench_decoders[i], &f.decode_mb_s[i], error);
	unlink(path);
	rmdir(folder);
	if (good)
		print(o, &f);
	return good;
}
