#include "render/camera-path.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define FORM_ORBIT    "orbit[:DEGREES[:FRAMES]]"
#define FORM_DOLLY    "dolly[:FACTOR[:FRAMES]]"
#define FORM_PAN      "pan[:PIXELS[:FRAMES]]"
#define FORM_STATIONS "stations[:FRAMES]"
#define FORM_VIEWS    "views:A,B,C[:FRAMES]"
#define FRAMES_NORMAL 40

const char camera_path_forms[] =
	FORM_ORBIT ", " FORM_DOLLY ", " FORM_PAN ", " FORM_STATIONS ", " FORM_VIEWS;

/* What is interpolated between views. */
enum { KEY_X, KEY_Y, KEY_Z, KEY_HEADING, KEY_ELEVATION, KEY_LOG_TANGENT, KEY_VALUES };
struct key {
	double value[KEY_VALUES];
};

struct camera_path {
	const struct kind *kind;
	double amount;
	uint32_t frames, between; /* between: from one key to the next */
	double eye_m[3], target_m[3], fov_deg, far_m;
	GArray *keys; /* of struct key */
};

void camera_path_free(camera_path *p)
{
	if (!p)
		return;
	g_array_unref(p->keys);
	g_free(p);
}

uint32_t camera_path_frames(const camera_path *p)
{
	return p->frames;
}

/* ---- from one view ---- */

static struct camera start(const camera_path *p, uint32_t width, uint32_t height)
{
	return camera_look_at(p->eye_m, p->target_m, p->fov_deg, width, height);
}

/* The whole camera turns with its place, so that it also goes around a target that is below it. */
static struct camera orbit(const camera_path *p, double frame, uint32_t width, uint32_t height)
{
	double angle = frame * p->amount * G_PI / 180, sine = sin(angle), cosine = cos(angle);
	double east = p->eye_m[0] - p->target_m[0], north = p->eye_m[1] - p->target_m[1];
	struct camera first = start(p, width, height), c = camera_turned(&first, angle);
	c.eye_m[0] = p->target_m[0] + cosine * east + sine * north;
	c.eye_m[1] = p->target_m[1] + cosine * north - sine * east;
	return c;
}

static struct camera dolly(const camera_path *p, double frame, uint32_t width, uint32_t height)
{
	double share = p->frames > 1 ? frame / (p->frames - 1.0) : 0;
	double nearer = pow(p->amount, -share);
	struct camera c = start(p, width, height);
	for (int k = 0; k < 3; k++)
		c.eye_m[k] = p->target_m[k] + nearer * (p->eye_m[k] - p->target_m[k]);
	return c;
}

/* With the elevation e, a turn by a moves what was in the middle to
 *
 *     x / focal = cos e sin a / (sin^2 e + cos^2 e cos a) = k,
 *
 * so cos e sin a - k cos^2 e cos a = k sin^2 e. Steeply up or down it cannot be moved so far by
 * turning about the vertical; then it goes as far as it can. */
static double pan_angle(const struct camera *c, double px)
{
	double k = px / c->focal_px, e = camera_elevation_rad(c), sine = sin(e), cosine = cos(e);
	double length = cosine * hypot(1, k * cosine);
	double share = length > 0 ? k * sine * sine / length : INFINITY;
	return atan(k * cosine) + asin(CLAMP(share, -1, 1));
}

static struct camera pan(const camera_path *p, double frame, uint32_t width, uint32_t height)
{
	struct camera first = start(p, width, height);
	return camera_turned(&first, frame * pan_angle(&first, p->amount));
}

/* ---- through views ---- */

static struct key key_of(const view *v)
{
	struct camera c = view_camera(v, 2, 2);
	return (struct key){ { v->eye_m[0], v->eye_m[1], v->eye_m[2], camera_heading_rad(&c),
		camera_elevation_rad(&c), log(tan(v->fov_deg * G_PI / 360)) } };
}

static double key_value(const camera_path *p, guint i, int value)
{
	return g_array_index(p->keys, struct key, i).value[value];
}

/* Of the curve at a key, per key: the harmonic mean of the slopes before and after; at rest where
 * these differ in sign, and at the ends. */
static double slope_at(const camera_path *p, guint i, int value)
{
	if (i == 0 || i + 1 == p->keys->len)
		return 0;
	double here = key_value(p, i, value), before = here - key_value(p, i - 1, value),
	       after = key_value(p, i + 1, value) - here;
	return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

static double value_at(const camera_path *p, guint i, double t, int value)
{
	double from = key_value(p, i, value), to = key_value(p, i + 1, value);
	double s = t * t * (3 - 2 * t), rest = (1 - t) * t;
	return (1 - s) * from + s * to + rest * (1 - t) * slope_at(p, i, value) -
	       rest * t * slope_at(p, i + 1, value);
}

static struct camera through(const camera_path *p, double frame, uint32_t width, uint32_t height)
{
	guint i = MIN((guint)(frame / p->between), p->keys->len - 2);
	double t = (frame - (double)i * p->between) / p->between, v[KEY_VALUES];
	for (int k = 0; k < KEY_VALUES; k++)
		v[k] = value_at(p, i, t, k);
	return camera_towards(v, v[KEY_HEADING], v[KEY_ELEVATION],
		360 / G_PI * atan(exp(v[KEY_LOG_TANGENT])), width, height);
}

/* ---- kinds ---- */

struct number {
	const char *what;
	double min, max, normal;
};
static const struct kind {
	const char *name, *form;
	struct number amount; /* what NULL: it goes through views */
	struct camera (*at)(const camera_path *p, double frame, uint32_t width, uint32_t height);
} kinds[] = {
	{ "orbit", FORM_ORBIT, { "degrees a frame", -180, 180, 0.5 }, orbit },
	{ "dolly", FORM_DOLLY, { "the factor", 0.001, 1000, 2 }, dolly },
	{ "pan", FORM_PAN, { "pixels a frame", -10000, 10000, 8 }, pan },
	{ "stations", FORM_STATIONS, { 0 }, through },
	{ "views", FORM_VIEWS, { 0 }, through },
};

struct camera camera_path_at(const camera_path *p, double frame, uint32_t width, uint32_t height)
{
	g_assert(frame >= 0 && frame <= p->frames - 1);
	struct camera c = p->kind->at(p, frame, width, height);
	c.far_m = p->far_m;
	return c;
}

/* ---- reading ---- */

struct reading {
	const char *spec;
	char **words;
	guint count;
	const struct view_sources *sources;
	GError **error;
};

static bool refuse(const struct reading *r, const camera_path *p, const char *format, ...)
	G_GNUC_PRINTF(3, 4);

static bool refuse(const struct reading *r, const camera_path *p, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(r->error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, "path '%s': %s (%s)",
		r->spec, what, p->kind->form);
	return false;
}

static bool read_number(const struct reading *r, const camera_path *p, guint i,
	const struct number *number, double *ret)
{
	*ret = number->normal;
	if (i >= r->count)
		return true;
	char *end;
	const char *word = r->words[i];
	*ret = g_ascii_strtod(word, &end);
	if (end != word && !*end && !g_ascii_isspace(*word) && *ret >= number->min &&
		*ret <= number->max)
		return true;
	return refuse(
		r, p, "'%s' is not %s from %g to %g", word, number->what, number->min, number->max);
}

static bool read_frames(const struct reading *r, const camera_path *p, guint i, uint32_t *ret)
{
	guint64 frames = FRAMES_NORMAL;
	if (i < r->count && !g_ascii_string_to_unsigned(
				    r->words[i], 10, 1, CAMERA_PATH_FRAMES_MAX, &frames, NULL))
		return refuse(r, p, "'%s' is no number of frames from 1 to %u", r->words[i],
			CAMERA_PATH_FRAMES_MAX);
	*ret = (uint32_t)frames;
	return i + 1 >= r->count || refuse(r, p, "'%s' is one part too many", r->words[i + 1]);
}

static bool read_moves(const struct reading *r, camera_path *p)
{
	struct camera c = start(p, 2, 2);
	if (!read_number(r, p, 1, &p->kind->amount, &p->amount) ||
		!read_frames(r, p, 2, &p->frames))
		return false;
	if (p->kind->at == pan && fabs(camera_elevation_rad(&c)) > 80 * G_PI / 180)
		return refuse(r, p, "the view is too steep to pan, more than 80 degrees");
	return true;
}

static bool has_perspective(const struct reading *r, camera_path *p, const view *v)
{
	return !view_is_parallel(v) ||
	       refuse(r, p, "the camera moves in perspective, which the view '%s' has not",
		       v->name);
}

static bool add_key(const struct reading *r, camera_path *p, const char *name)
{
	g_autoptr(view) v = NULL;
	if (!view_find(r->sources, name, &v, r->error)) {
		g_prefix_error(r->error, "path '%s': ", r->spec);
		return false;
	}
	if (!has_perspective(r, p, v))
		return false;
	struct key key = key_of(v);
	if (p->keys->len) { /* the shorter way round */
		double before = key_value(p, p->keys->len - 1, KEY_HEADING);
		key.value[KEY_HEADING] =
			before + remainder(key.value[KEY_HEADING] - before, 2 * G_PI);
	}
	g_array_append_val(p->keys, key);
	p->far_m = fmax(p->far_m, view_camera(v, 2, 2).far_m);
	return true;
}

static bool count_frames(const struct reading *r, camera_path *p)
{
	uint64_t frames = (uint64_t)(p->keys->len - 1) * p->between + 1;
	p->frames = (uint32_t)MIN(frames, CAMERA_PATH_FRAMES_MAX);
	return frames <= CAMERA_PATH_FRAMES_MAX ||
	       refuse(r, p, "has %" G_GUINT64_FORMAT " frames; %u are the most", frames,
		       CAMERA_PATH_FRAMES_MAX);
}

static bool read_stations(const struct reading *r, camera_path *p)
{
	size_t count = r->sources->boxes ? r->sources->station_count : 0;
	if (!read_frames(r, p, 1, &p->between))
		return false;
	if (count < 2)
		return refuse(r, p, "the site has %zu stations; two are the least", count);
	for (size_t k = 1; k <= count; k++) {
		g_autofree char *name = g_strdup_printf("station-%zu", k);
		if (!add_key(r, p, name))
			return false;
	}
	return count_frames(r, p);
}

static bool read_views(const struct reading *r, camera_path *p)
{
	g_auto(GStrv) names = g_strsplit(r->count > 1 ? r->words[1] : "", ",", -1);
	if (!read_frames(r, p, 2, &p->between))
		return false;
	if (g_strv_length(names) < 2)
		return refuse(r, p, "two views are the least");
	for (char **name = names; *name; name++)
		if (!add_key(r, p, *name))
			return false;
	return count_frames(r, p);
}

static const struct kind *find_kind(const char *name, GError **error)
{
	for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++)
		if (strcmp(kinds[i].name, name) == 0)
			return &kinds[i];
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
		"there is no path '%s'; there are: %s", name, camera_path_forms);
	return NULL;
}

static camera_path *path_from(const struct kind *kind, const view *v)
{
	camera_path *p = g_new0(camera_path, 1);
	p->kind = kind;
	p->keys = g_array_new(FALSE, FALSE, sizeof(struct key));
	p->fov_deg = v->fov_deg;
	p->far_m = view_camera(v, 2, 2).far_m;
	memcpy(p->eye_m, v->eye_m, sizeof p->eye_m);
	memcpy(p->target_m, v->target_m, sizeof p->target_m);
	return p;
}

camera_path *camera_path_parse(
	const char *spec, const view *v, const struct view_sources *s, GError **error)
{
	g_auto(GStrv) words = g_strsplit(spec, ":", -1);
	struct reading r = { spec, words, g_strv_length(words), s, error };
	const struct kind *kind = find_kind(r.count ? words[0] : "", error);
	if (!kind)
		return NULL;
	g_autoptr(camera_path) p = path_from(kind, v);
	bool good = kind->amount.what ? has_perspective(&r, p, v) && read_moves(&r, p)
		    : strcmp(kind->name, "stations") == 0 ? read_stations(&r, p)
							  : read_views(&r, p);
	return good ? g_steal_pointer(&p) : NULL;
}
