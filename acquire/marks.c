#include "acquire/marks.h"
#include "acquire/manifest.h"

static const char *const names[EXPOSURES_MAX] = { "base", "second", "third" };

static char *controls_text(const struct camera_controls *c)
{
	return g_strdup_printf(
		"{\"exposure_100us\": %u, \"gain_percent\": %u, \"white_balance_k\": %u}",
		c->exposure_100us, c->gain_percent, c->white_balance_k);
}

char *mark_lock_text(const struct camera_controls *c)
{
	g_autofree char *controls = controls_text(c);
	return g_strdup_printf("{\"camera\": %s}", controls);
}

char *mark_pause_text(void)
{
	return g_strdup("{\"lidar\": \"paused\"}");
}

char *mark_stop_text(const struct exposures *e)
{
	GString *s = g_string_new("{\"stop\": {");
	for (uint32_t i = 0; i < e->count; i++) {
		g_autofree char *controls = controls_text(&e->controls[i]);
		g_string_append_printf(s, "%s\"%s\": %s", i ? ", " : "", names[i], controls);
	}
	return g_string_free(g_string_append(s, "}}"), FALSE);
}

static bool read_controls(const manifest *m, const char *key, struct camera_controls *ret)
{
	g_autofree char *exposure = g_strconcat(key, ".exposure_100us", NULL),
			*gain = g_strconcat(key, ".gain_percent", NULL),
			*balance = g_strconcat(key, ".white_balance_k", NULL);
	int64_t n[3];
	if (!manifest_get_int(m, exposure, 0, UINT32_MAX, &n[0], NULL) ||
		!manifest_get_int(m, gain, 0, UINT32_MAX, &n[1], NULL) ||
		!manifest_get_int(m, balance, 0, UINT32_MAX, &n[2], NULL))
		return false;
	*ret = (struct camera_controls){ (uint32_t)n[0], (uint32_t)n[1], (uint32_t)n[2] };
	return true;
}

static struct exposures read_stop(const manifest *m)
{
	struct exposures e = { 0 };
	for (int i = 0; i < EXPOSURES_MAX; i++) {
		struct camera_controls c;
		g_autofree char *key = g_strconcat("stop.", names[i], NULL);
		if (!read_controls(m, key, &c))
			break;
		if (i == 0)
			e = (struct exposures){ 1, { c } };
		else
			exposures_add(&e, &c);
	}
	return e;
}

struct mark mark_read(const void *text, size_t length)
{
	g_autoptr(manifest) m = manifest_parse(text, length, "mark", 0, NULL);
	struct mark mark = { 0 };
	if (!m)
		return mark;
	mark.pauses = manifest_has(m, "lidar") &&
		      g_strcmp0(manifest_get_string(m, "lidar", NULL), "paused") == 0;
	mark.locks = read_controls(m, "camera", &mark.locked);
	mark.stops = manifest_has(m, "stop");
	if (mark.stops)
		mark.stop = read_stop(m);
	return mark;
}
