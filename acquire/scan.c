#include "acquire/scan.h"
#include "acquire/planes.h"
#include "acquire/scan-manifest.h"
#include "firmware-io/files.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* Kept free beyond what a scan is predicted to take, for the rest of the machine. */
#define SPARE_BYTES (UINT64_C(32) << 20)

struct recording {
	site *site;
	const struct scan_options *options;
	const struct preset *preset;
	bool hdr;
	head *head;
	run *run;
	record_writer *record;
	manifest *scan;
	uint32_t number;
	char *folder, *raw;
	bool recalled; /* what was recorded before is good to go on with */
};

char *scan_size_text(uint64_t bytes)
{
	double mb = (double)bytes * 1e-6;
	return mb < 1000 ? g_strdup_printf("%.1f MB", mb) : g_strdup_printf("%.2f GB", mb * 1e-3);
}

bool scan_check_space(const char *folder, uint64_t need_bytes, GError **error)
{
	struct statvfs v;
	if (statvfs(folder, &v) < 0) {
		g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s", folder,
			g_strerror(errno));
		return false;
	}
	uint64_t free_bytes = (uint64_t)v.f_bavail * v.f_frsize;
	if (free_bytes >= need_bytes && free_bytes - need_bytes >= SPARE_BYTES)
		return true;
	g_autofree char *need = scan_size_text(need_bytes), *have = scan_size_text(free_bytes),
			*spare = scan_size_text(SPARE_BYTES);
	g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_NOSPC,
		"%s: there is not enough space: the scan needs %s, and %s must stay free, but "
		"there are %s",
		folder, need, spare, have);
	return false;
}

static void recording_clear(struct recording *r)
{
	run_free(r->run);
	if (r->head)
		head_attach_record(r->head, NULL);
	record_writer_free(r->record);
	head_close(r->head);
	manifest_free(r->scan);
	g_free(r->folder);
	g_free(r->raw);
}

/* ---- a new scan, or the one to go on with ---- */

static bool name_paths(struct recording *r)
{
	r->folder = site_partial_path(r->site, r->number);
	r->raw = g_build_filename(r->folder, "raw.rec", NULL);
	return true;
}

static bool load_manifest(struct recording *r, GError **error)
{
	g_autofree char *path = g_build_filename(r->folder, "scan.json", NULL);
	g_clear_pointer(&r->scan, manifest_free);
	r->scan = manifest_load(path, SCAN_SCHEMA, error);
	return r->scan != NULL;
}

static bool begin_new(struct recording *r, GError **error)
{
	uint32_t partial;
	if (!site_find_partial(r->site, &partial, error))
		return false;
	if (partial) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_EXIST,
			"%s: scan %04u was begun and not finished: resume or discard it first",
			site_path(r->site), partial);
		return false;
	}
	if (r->options->hdr && !r->head->camera) {
		g_set_error_literal(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"the head has no camera that is calibrated to it: HDR is not for it");
		return false;
	}
	r->preset = r->options->preset;
	r->hdr = r->options->hdr;
	r->scan = scan_manifest_begin(r->preset, r->hdr, r->options->device);
	return site_begin_scan(r->site, r->scan, &r->number, error) && name_paths(r) &&
	       load_manifest(r, error);
}

static bool begin_resumed(struct recording *r, GError **error)
{
	if (!site_find_partial(r->site, &r->number, error))
		return false;
	if (r->number == 0) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT,
			"%s: there is no partial scan to resume", site_path(r->site));
		return false;
	}
	/* What developing will need is asked for now: after the scan it would be too late. */
	struct panorama_desc grid;
	name_paths(r);
	r->preset = load_manifest(r, error) && scan_manifest_grid(r->scan, &grid, error)
			    ? scan_manifest_preset(r->scan, error)
			    : NULL;
	r->hdr = r->preset && scan_manifest_is_hdr(r->scan);
	return r->preset != NULL;
}

char *scan_partial_device(const site *s, GError **error)
{
	struct recording r = { .site = (site *)s };
	const char *device =
		begin_resumed(&r, error) ? manifest_get_string(r.scan, "device", error) : NULL;
	char *copy = g_strdup(device);
	recording_clear(&r);
	return copy;
}

static bool copy_whole(const char *from, const char *to, GError **error)
{
	g_autoptr(record_reader) reader = record_open(from, error);
	g_autoptr(record_writer) writer = reader ? record_create(to, error) : NULL;
	struct record_entry e;
	if (!writer)
		return false;
	for (;;) {
		enum record_result got = record_next(reader, &e, NULL);
		if (got == RECORD_BAD && record_skip_damage(reader))
			continue;
		if (got != RECORD_ENTRY)
			break;
		if (!record_write(writer, e.kind, e.time_ns, e.payload, e.length, NULL, 0, error))
			return false;
	}
	return record_close(g_steal_pointer(&writer), error);
}

static bool is_damaged(const char *path)
{
	g_autoptr(record_reader) reader = record_open(path, NULL);
	enum record_result got = RECORD_ENTRY;
	struct record_entry e;
	while (reader && got == RECORD_ENTRY)
		got = record_next(reader, &e, NULL);
	return got == RECORD_BAD;
}

/* raw.rec.damaged, or the first of raw.rec.damaged.2 and so on that is not there; caller frees. */
static char *name_for_damaged(const char *raw)
{
	char *name = g_strconcat(raw, ".damaged", NULL);
	for (int i = 2; g_file_test(name, G_FILE_TEST_EXISTS); i++) {
		g_free(name);
		name = g_strdup_printf("%s.damaged.%d", raw, i);
	}
	return name;
}

/* There is a raw.rec at any moment, where the file system has links. */
static bool put_aside(const char *raw, const char *damaged, GError **error)
{
	return link(raw, damaged) == 0 || rename(raw, damaged) == 0 ||
	       files_fail(error, raw, "rename it");
}

/* A new record of what is whole takes the damaged one's place; that stays beside it. */
static bool salvage_record(struct recording *r, GError **error)
{
	g_autofree char *fresh = g_strconcat(r->raw, ".new", NULL),
			*damaged = name_for_damaged(r->raw);
	if (!is_damaged(r->raw))
		return true;
	unlink(fresh);
	if (copy_whole(r->raw, fresh, error) && put_aside(r->raw, damaged, error)) {
		if (rename(fresh, r->raw) == 0)
			return files_sync_folder(r->folder, error);
		files_fail(error, r->raw, "write");
	}
	unlink(fresh);
	return false;
}

/* Gives the run all that was recorded before. */
static bool recall(struct recording *r, GError **error)
{
	g_autoptr(record_reader) reader = record_open(r->raw, error);
	struct record_entry e;
	enum record_result got = RECORD_BAD;
	while (reader && (got = record_next(reader, &e, error)) == RECORD_ENTRY)
		if (!run_recall(r->run, &e, error))
			return g_prefix_error(error, "%s: ", r->raw), false;
	return got != RECORD_BAD;
}

static bool open_record(struct recording *r, GError **error)
{
	bool exists = g_file_test(r->raw, G_FILE_TEST_EXISTS);
	if (exists && ((r->options->salvage && !salvage_record(r, error)) || !recall(r, error)))
		return false;
	r->recalled = true;
	r->record = exists ? record_append_to(r->raw, NULL, error) : record_create(r->raw, error);
	return r->record != NULL;
}

static bool open_head(struct recording *r, GError **error)
{
	if (!r->head)
		r->head = head_open(r->options->device, error);
	if (!r->head)
		return false;
	struct calibration c;
	if (!calibration_parse(r->head->calibration, "the head's calibration", &c, error))
		return false;
	if (!c.has_camera)
		r->head->camera = NULL;
	return true;
}

/* Going on with another head would mix two calibrations in one panorama. */
static bool check_same_head(struct recording *r, GError **error)
{
	const struct calibration *before = run_calibration(r->run);
	struct calibration now;
	if (!before ||
		!calibration_parse(r->head->calibration, "the head's calibration", &now, NULL) ||
		strcmp(before->serial, now.serial) == 0)
		return true;
	g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
		"scan %04u was begun with head %s, and this is head %s: resume it with the first, "
		"or discard it",
		r->number, before->serial, now.serial);
	return false;
}

/* The session's header goes first into the record, then into the run. */
static bool begin_session(struct recording *r, GError **error)
{
	g_autofree char *text = scan_session_text(r->options->device, r->head);
	struct record_entry e = { .kind = RECORD_SESSION,
		.length = strlen(text),
		.time_ns = head_now_ns(r->head),
		.payload = text };
	head_attach_record(r->head, r->record);
	return record_write(r->record, e.kind, e.time_ns, e.payload, e.length, NULL, 0, error) &&
	       run_begin(r->run, &e, error);
}

/* ---- the end ---- */

static bool finish_record(struct recording *r, GError **error)
{
	int64_t now_ns = head_now_ns(r->head);
	head_attach_record(r->head, NULL);
	if (!record_write(r->record, RECORD_END, now_ns, NULL, 0, NULL, 0, error))
		return false;
	return record_close(g_steal_pointer(&r->record), error);
}

/* Panorama, planes and manifest of what stands in folder. */
static bool develop_into(
	const char *folder, manifest *scan, struct scan_result *result, GError **error)
{
	struct develop_options o = { 0 };
	struct develop_result d = { 0 };
	g_autofree char *raw = g_build_filename(folder, "raw.rec", NULL);
	if (!scan_manifest_grid(scan, &o.desc, error))
		return false;
	g_autoptr(panorama) p = develop_record(raw, &o, &d, error);
	bool good = p && planes_save(p, folder, error) &&
		    scan_manifest_finish(scan, folder, p, &d, error);
	if (good)
		*result = (struct scan_result){ .columns = p->desc.columns,
			.rows = p->desc.rows,
			.counts = panorama_count(p),
			.report = d.report,
			.photos = d.photos,
			.hdr = scan_manifest_is_hdr(scan),
			.merged_photos = d.merged_photos };
	develop_result_clear(&d);
	return good && manifest_save(scan, error);
}

static bool run_it(struct recording *r, GError **error)
{
	struct prediction predicted;
	if (!begin_session(r, error) || !run_prepare(r->run, error))
		return false;
	predicted = run_predict(r->run);
	if (r->options->predicted)
		r->options->predicted(&predicted, run_lidar(r->run), r->options->user_data);
	return scan_check_space(r->folder, predicted.bytes, error) && run_scan(r->run, error) &&
	       finish_record(r, error);
}

/* A scan that never got as far as its first turn is no scan: nothing is kept of it. */
static bool is_worth_keeping(struct recording *r)
{
	return r->run &&
	       run_missing_columns(r->run) < r->preset->columns * (r->preset->both_faces ? 2 : 1);
}

static bool record_into(struct recording *r, struct scan_result *result, GError **error)
{
	struct run_options o = { .preset = r->preset,
		.hdr = r->hdr,
		.wait_for_lidar_s = r->options->wait_for_lidar_s,
		.progress = r->options->progress,
		.user_data = r->options->user_data };
	r->run = run_new(r->head, &o);
	if (!open_record(r, error) || !check_same_head(r, error) || !run_it(r, error))
		return false;
	uint32_t missing = run_missing_columns(r->run);
	if (r->options->developing)
		r->options->developing(run_preview(r->run), r->options->user_data);
	if (!develop_into(r->folder, r->scan, result, error) ||
		!site_finish_scan(r->site, r->number, error))
		return false;
	result->number = r->number;
	result->missing_columns = missing;
	return true;
}

bool scan_record(site *s, const struct scan_options *options, struct scan_result *ret_result,
	uint32_t *ret_partial, GError **error)
{
	struct recording r = { .site = s, .options = options, .head = options->head };
	struct scan_result result = { 0 };
	*ret_partial = 0;
	/* A device that is not there must leave the site as it was. */
	bool begun = open_head(&r, error) &&
		     (options->resume ? begin_resumed(&r, error) : begin_new(&r, error));
	bool good = begun && record_into(&r, &result, error);
	if (begun && !good && (options->resume || is_worth_keeping(&r)))
		*ret_partial = r.recalled ? r.number : 0;
	else if (begun && !good)
		site_discard_partial(s, r.number, NULL);
	recording_clear(&r);
	if (good)
		*ret_result = result;
	return good;
}

/* Of a finished scan. NULL with an error; caller frees both. */
static manifest *load_finished(const site *s, uint32_t number, char **ret_folder,
	struct panorama_desc *ret, GError **error)
{
	g_autofree char *folder = site_scan_path(s, number),
			*path = g_build_filename(folder, "scan.json", NULL);
	g_autoptr(manifest) scan = manifest_load(path, SCAN_SCHEMA, error);
	if (!scan || !scan_manifest_grid(scan, ret, error))
		return NULL;
	*ret_folder = g_steal_pointer(&folder);
	return g_steal_pointer(&scan);
}

panorama *scan_load(const site *s, uint32_t number, bool verify, GError **error)
{
	g_autofree char *folder = NULL;
	struct panorama_desc desc;
	g_autoptr(manifest) scan = load_finished(s, number, &folder, &desc, error);
	if (!scan || !(verify ? scan_manifest_verify(scan, folder, error)
			      : scan_manifest_verify_planes(scan, folder, error)))
		return NULL;
	return planes_load(folder, &desc, error);
}

uint32_t scan_hdr_photos(const site *s, uint32_t number)
{
	g_autofree char *folder = NULL;
	struct panorama_desc desc;
	int64_t merged = 0;
	g_autoptr(manifest) scan = load_finished(s, number, &folder, &desc, NULL);
	if (scan)
		manifest_get_int(scan, "hdr.photos", 0, UINT32_MAX, &merged, NULL);
	return (uint32_t)merged;
}

bool scan_check_record(const site *s, uint32_t number, GError **error)
{
	g_autofree char *folder = NULL;
	struct panorama_desc desc;
	g_autoptr(manifest) scan = load_finished(s, number, &folder, &desc, error);
	return scan && scan_manifest_verify_file(scan, folder, "raw.rec", error);
}

bool scan_develop_again(site *s, uint32_t number, GError **error)
{
	g_autofree char *folder = NULL;
	struct panorama_desc desc;
	struct scan_result result;
	g_autoptr(manifest) scan = load_finished(s, number, &folder, &desc, error);
	return scan && scan_manifest_verify_file(scan, folder, "raw.rec", error) &&
	       develop_into(folder, scan, &result, error);
}
