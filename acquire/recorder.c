#include "acquire/recorder.h"
#include "acquire/driver.h"
#include "acquire/scan-manifest.h"
#include "acquire/service.h"
#include <string.h>

/* A copy of the preview is made so often, while somebody asks for it. */
#define PREVIEW_EVERY_US (G_USEC_PER_SEC / 3)
#define PREVIEW_ASKED_US (3 * G_USEC_PER_SEC)
/* A guess at the time left needs so much of the scan. */
#define PACE_LEAST 0.04

const char *const recorder_state_names[RECORDER_STATES] = { "idle", "starting", "scanning",
	"developing", "pausing", "paused" };

struct recorder {
	struct recorder_watcher watcher;
	GMainContext *context;
	GThread *thread; /* NULL: nothing is under way */
	/* What the thread is to do; not changed while it runs. */
	char *device, *site_path;
	const struct preset *preset;
	bool hdr, resume, salvage, only_check, reset;

	GMutex lock; /* of all below */
	struct recorder_progress now;
	bool stop, keep;
	bool latched; /* until a reset */
	struct identity head;
	panorama *preview;
	uint64_t preview_serial;
	int64_t preview_us, asked_us, scanning_us;
	double begin_fraction, predicted_s;
};

void recorder_progress_clear(struct recorder_progress *p)
{
	g_clear_pointer(&p->site, g_free);
	g_clear_pointer(&p->preset, g_free);
	g_clear_pointer(&p->doing, g_free);
}

/* ---- letters to the owner ---- */

enum letter_kind { LETTER_BEGUN, LETTER_ENDED, LETTER_CHECKED };
struct letter {
	recorder *recorder;
	enum letter_kind kind;
	GError *error;
	char *site;
	uint32_t scan;
	bool partial, stopped;
};

static void letter_free(gpointer data)
{
	struct letter *l = data;
	g_clear_error(&l->error);
	g_free(l->site);
	g_free(l);
}

static void join(recorder *r)
{
	if (r->thread)
		g_thread_join(g_steal_pointer(&r->thread));
}

static gboolean open_letter(gpointer data)
{
	struct letter *l = data;
	recorder *r = l->recorder;
	const struct recorder_watcher *w = &r->watcher;
	if (l->kind == LETTER_BEGUN) {
		w->begun(w->user_data);
		return G_SOURCE_REMOVE;
	}
	join(r);
	if (l->kind == LETTER_ENDED)
		w->ended(l->site, l->scan, l->partial, l->stopped, l->error, w->user_data);
	else
		w->checked(l->error, w->user_data);
	return G_SOURCE_REMOVE;
}

static void send(recorder *r, struct letter letter)
{
	letter.recorder = r;
	g_main_context_invoke_full(r->context, G_PRIORITY_DEFAULT, open_letter,
		g_memdup2(&letter, sizeof letter), letter_free);
}

/* ---- on the thread ---- */

static void set_state(recorder *r, enum recorder_state state)
{
	g_mutex_lock(&r->lock);
	r->now.state = state;
	g_mutex_unlock(&r->lock);
}

static panorama *copy_of(const panorama *p)
{
	size_t n = (size_t)p->desc.columns * p->desc.rows;
	panorama *c = panorama_new(&p->desc, NULL);
	memcpy(c->range_m, p->range_m, n * sizeof *p->range_m);
	memcpy(c->intensity, p->intensity, n * sizeof *p->intensity);
	memcpy(c->cell, p->cell, n);
	c->rgb = p->rgb ? g_memdup2(p->rgb, 3 * n) : NULL;
	return c;
}

/* Under the lock. */
static void keep_preview(recorder *r, const panorama *p, int64_t now_us)
{
	if (r->preview && (now_us - r->preview_us < PREVIEW_EVERY_US ||
				  now_us - r->asked_us > PREVIEW_ASKED_US))
		return;
	panorama_free(r->preview);
	r->preview = copy_of(p);
	r->preview_us = now_us;
	r->preview_serial++;
}

/* Under the lock. By the pace so far; before there is one, by what was predicted. */
static double seconds_left(recorder *r, double fraction, int64_t now_us)
{
	double gone_s = (double)(now_us - r->scanning_us) * 1e-6,
	       done = fraction - r->begin_fraction;
	if (done < PACE_LEAST)
		return r->predicted_s > gone_s ? r->predicted_s - gone_s : -1;
	return gone_s * (1 - fraction) / done;
}

static bool goes_on(const struct run_progress *p, gpointer user_data)
{
	recorder *r = user_data;
	int64_t now_us = g_get_monotonic_time();
	g_mutex_lock(&r->lock);
	struct recorder_progress *n = &r->now;
	n->fraction = p->fraction;
	n->column_fraction = p->column_fraction;
	n->photos_taken = p->photos_taken;
	n->photos_wanted = p->photos_wanted;
	if (g_strcmp0(n->doing, p->doing)) {
		g_free(n->doing);
		n->doing = g_strdup(p->doing);
	}
	if (r->scanning_us)
		n->seconds_left = seconds_left(r, p->fraction, now_us);
	keep_preview(r, p->preview, now_us);
	bool stop = r->stop;
	g_mutex_unlock(&r->lock);
	return stop;
}

static void is_predicted(
	const struct prediction *p, const struct lidar_identity *lidar, gpointer user_data)
{
	recorder *r = user_data;
	g_mutex_lock(&r->lock);
	r->head.lidar = *lidar;
	if (r->now.state == RECORDER_STARTING)
		r->now.state = RECORDER_SCANNING;
	r->scanning_us = g_get_monotonic_time();
	r->begin_fraction = r->now.fraction;
	r->predicted_s = p->seconds;
	g_mutex_unlock(&r->lock);
	send(r, (struct letter){ .kind = LETTER_BEGUN });
}

static void is_developing(const panorama *all, gpointer user_data)
{
	recorder *r = user_data;
	g_mutex_lock(&r->lock);
	r->now.state = RECORDER_DEVELOPING;
	r->preview_us = 0;
	r->asked_us = g_get_monotonic_time();
	keep_preview(r, all, r->asked_us);
	g_mutex_unlock(&r->lock);
}

/* For %n; "auto" is the one that is plugged in. Caller frees. */
static char *device_for(const char *device, uint32_t number, GError **error)
{
	if (strcmp(device, "auto") == 0)
		return identify_find(error);
	g_autofree char *text = g_strdup_printf("%u", number);
	g_auto(GStrv) parts = g_strsplit(device, "%n", -1);
	return g_strjoinv(text, parts);
}

static void set_latched(recorder *r, bool latched)
{
	g_mutex_lock(&r->lock);
	r->latched = latched;
	g_mutex_unlock(&r->lock);
}

static bool unlatch(recorder *r, head *h, GError **error)
{
	if (!pump_reset_stage(h->stage, error))
		return false;
	set_latched(r, false);
	return true;
}

static bool check(recorder *r, GError **error)
{
	g_autofree char *device = device_for(r->device, 1, error);
	g_autoptr(head) h = device ? head_open(device, error) : NULL;
	struct identity known;
	if (!h || (r->reset && !unlatch(r, h, error)) || !identify_opened(h, device, &known, error))
		return false;
	g_mutex_lock(&r->lock);
	r->head = known;
	g_mutex_unlock(&r->lock);
	return true;
}

static uint32_t next_number(const site *s)
{
	g_autoptr(GArray) scans = site_scans(s, NULL);
	return scans && scans->len ? g_array_index(scans, uint32_t, scans->len - 1) + 1 : 1;
}

static bool record(recorder *r, site *s, uint32_t *ret_scan, uint32_t *ret_partial, GError **error)
{
	struct scan_result result = { 0 };
	uint32_t number = next_number(s);
	g_autofree char *device =
		r->resume ? scan_partial_device(s, error) : device_for(r->device, number, error);
	struct scan_options o = { .device = device,
		.preset = r->preset,
		.hdr = r->hdr,
		.resume = r->resume,
		.salvage = r->salvage,
		.progress = goes_on,
		.predicted = is_predicted,
		.developing = is_developing,
		.user_data = r };
	*ret_partial = 0;
	*ret_scan = number;
	if (!device)
		return false;
	g_mutex_lock(&r->lock);
	r->now.scan = number;
	g_mutex_unlock(&r->lock);
	return scan_record(s, &o, &result, ret_partial, error);
}

static struct letter record_site(recorder *r)
{
	struct letter l = { .kind = LETTER_ENDED, .site = g_strdup(r->site_path) };
	uint32_t partial = 0;
	g_autoptr(site) s = r->resume ? site_open_existing(r->site_path, &l.error)
				      : site_open_for_writing(r->site_path, &l.error);
	if (s && !record(r, s, &l.scan, &partial, &l.error) && !partial)
		site_discard_new(s);
	/* One that could not even be gone on with is still there. */
	if (s && r->resume && l.error && !partial)
		site_find_partial(s, &partial, NULL);
	l.stopped = g_error_matches(l.error, PUMP_ERROR, PUMP_ERROR_STOPPED);
	g_mutex_lock(&r->lock);
	bool keep = r->keep;
	g_mutex_unlock(&r->lock);
	if (partial && l.stopped && !keep && site_discard_partial(s, partial, NULL))
		partial = 0;
	l.partial = partial;
	return l;
}

static gpointer work(gpointer data)
{
	recorder *r = data;
	struct letter l = { .kind = LETTER_CHECKED };
	if (r->only_check)
		check(r, &l.error);
	else
		l = record_site(r);
	if (pump_error_is_safety(l.error))
		set_latched(r, true);
	g_mutex_lock(&r->lock);
	r->now.state = l.partial ? RECORDER_PAUSED : RECORDER_IDLE;
	r->now.seconds_left = -1;
	g_mutex_unlock(&r->lock);
	send(r, l);
	return NULL;
}

/* ---- from outside ---- */

recorder *recorder_new(const struct recorder_watcher *watcher)
{
	recorder *r = g_new0(recorder, 1);
	r->watcher = *watcher;
	r->context = g_main_context_ref_thread_default();
	r->now.seconds_left = -1;
	g_mutex_init(&r->lock);
	return r;
}

void recorder_free(recorder *r)
{
	if (!r)
		return;
	g_mutex_lock(&r->lock);
	r->stop = r->keep = true;
	g_mutex_unlock(&r->lock);
	join(r);
	/* Its last letter may still lie there. */
	while (g_main_context_iteration(r->context, FALSE))
		;
	recorder_progress_clear(&r->now);
	panorama_free(r->preview);
	g_mutex_clear(&r->lock);
	g_main_context_unref(r->context);
	g_free(r->device);
	g_free(r->site_path);
	g_free(r);
}

bool recorder_is_working(const recorder *r)
{
	return r->thread;
}

bool recorder_is_checking(const recorder *r)
{
	return r->thread && r->only_check;
}

static bool is_free(const recorder *r, GError **error)
{
	if (!r->thread)
		return true;
	g_set_error_literal(error, SERVICE_ERROR, SERVICE_ERROR_BUSY,
		r->only_check ? "the scanner is being looked at"
			      : "a scan is under way: wait for it, or stop it first");
	return false;
}

static bool may_scan(recorder *r, GError **error)
{
	if (!is_free(r, error))
		return false;
	if (!recorder_is_latched(r))
		return true;
	g_set_error_literal(error, PUMP_ERROR, PUMP_ERROR_NOT_RESET, RECORDER_NOT_RESET);
	return false;
}

static void set_task(recorder *r, const char *device, const char *site_path)
{
	char *old_device = r->device, *old_site = r->site_path;
	r->device = g_strdup(device);
	r->site_path = g_strdup(site_path);
	g_free(old_device);
	g_free(old_site);
	r->hdr = r->resume = r->salvage = r->only_check = r->reset = false;
	r->stop = false;
	r->keep = true;
	r->scanning_us = 0;
	r->predicted_s = 0;
}

static void begin(recorder *r)
{
	recorder_progress_clear(&r->now);
	r->now = (struct recorder_progress){ .state = RECORDER_STARTING,
		.site = g_strdup(r->site_path),
		.preset = g_strdup(r->preset ? r->preset->name : ""),
		.seconds_left = -1 };
	g_clear_pointer(&r->preview, panorama_free);
	r->thread = g_thread_new("recorder", work, r);
}

bool recorder_start(recorder *r, const char *device, const char *site_path,
	const struct preset *preset, bool hdr, GError **error)
{
	if (!may_scan(r, error))
		return false;
	set_task(r, device, site_path);
	r->preset = preset;
	r->hdr = hdr;
	begin(r);
	return true;
}

bool recorder_resume(recorder *r, const char *site_path, bool salvage, GError **error)
{
	if (!may_scan(r, error))
		return false;
	set_task(r, NULL, site_path);
	r->preset = NULL;
	r->resume = true;
	r->salvage = salvage;
	begin(r);
	return true;
}

bool recorder_check(recorder *r, const char *device, GError **error)
{
	if (!is_free(r, error))
		return false;
	set_task(r, device, NULL);
	r->only_check = true;
	r->thread = g_thread_new("recorder", work, r);
	return true;
}

bool recorder_reset(recorder *r, const char *device, GError **error)
{
	if (!is_free(r, error))
		return false;
	set_task(r, device, NULL);
	r->only_check = r->reset = true;
	r->thread = g_thread_new("recorder", work, r);
	return true;
}

bool recorder_is_latched(recorder *r)
{
	g_mutex_lock(&r->lock);
	bool latched = r->latched;
	g_mutex_unlock(&r->lock);
	return latched;
}

bool recorder_pause(recorder *r, GError **error)
{
	g_mutex_lock(&r->lock);
	bool paused = r->now.state == RECORDER_PAUSED;
	g_mutex_unlock(&r->lock);
	return paused || recorder_stop(r, true, error);
}

bool recorder_stop(recorder *r, bool keep, GError **error)
{
	g_mutex_lock(&r->lock);
	enum recorder_state state = r->now.state;
	bool works = r->thread && !r->only_check;
	if (works) {
		r->stop = true;
		r->keep = keep;
		if (state != RECORDER_DEVELOPING)
			r->now.state = RECORDER_PAUSING;
	}
	g_mutex_unlock(&r->lock);
	if (works)
		return true;
	if (state != RECORDER_PAUSED) {
		g_set_error_literal(
			error, SERVICE_ERROR, SERVICE_ERROR_BUSY, "no scan is under way");
		return false;
	}
	g_autofree char *path = g_strdup(r->now.site);
	if (!keep)
		return recorder_discard(r, path, error);
	set_state(r, RECORDER_IDLE);
	return true;
}

bool recorder_discard(recorder *r, const char *site_path, GError **error)
{
	uint32_t partial;
	if (!is_free(r, error))
		return false;
	g_autoptr(site) s = site_open_existing(site_path, error);
	if (!s || !site_find_partial(s, &partial, error) ||
		(partial && !site_discard_partial(s, partial, error)))
		return false;
	set_state(r, RECORDER_IDLE);
	return true;
}

struct recorder_progress recorder_progress(recorder *r)
{
	g_mutex_lock(&r->lock);
	struct recorder_progress p = r->now;
	p.site = g_strdup(p.site);
	p.preset = g_strdup(p.preset);
	p.doing = g_strdup(p.doing);
	g_mutex_unlock(&r->lock);
	return p;
}

struct identity recorder_head(recorder *r)
{
	g_mutex_lock(&r->lock);
	struct identity h = r->head;
	g_mutex_unlock(&r->lock);
	return h;
}

void recorder_forget_head(recorder *r)
{
	g_mutex_lock(&r->lock);
	r->head = (struct identity){ 0 };
	g_mutex_unlock(&r->lock);
}

static uint8_t *paint(const panorama *p, enum picture plane)
{
	size_t n = (size_t)p->desc.columns * p->desc.rows;
	bool colour = plane == PICTURE_COLOUR;
	uint8_t *rgba = g_malloc0(4 * n);
	g_autofree uint8_t *rgb = colour && !p->rgb ? NULL : picture_pixels(p, plane);
	for (size_t i = 0; rgb && i < n; i++) {
		const uint8_t *c = rgb + 3 * i;
		bool seen = colour ? c[0] | c[1] | c[2] : p->cell[i] != CELL_EMPTY;
		memcpy(rgba + 4 * i, c, 3);
		rgba[4 * i + 3] = seen ? 255 : 0;
	}
	return rgba;
}

uint8_t *recorder_preview(recorder *r, enum picture plane, uint32_t *ret_columns,
	uint32_t *ret_rows, uint64_t *ret_serial)
{
	g_mutex_lock(&r->lock);
	r->asked_us = g_get_monotonic_time();
	*ret_serial = r->preview_serial;
	panorama *copy = r->preview ? copy_of(r->preview) : NULL;
	g_mutex_unlock(&r->lock);
	if (!copy)
		return NULL;
	*ret_columns = copy->desc.columns;
	*ret_rows = copy->desc.rows;
	uint8_t *rgba = paint(copy, plane);
	panorama_free(copy);
	return rgba;
}
