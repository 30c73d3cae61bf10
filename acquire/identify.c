#include "acquire/identify.h"
#include "acquire/pump.h"
#include "acquire/run.h"
#include "acquire/scan-manifest.h"
#include "firmware-io/devices.h"
#include <string.h>

static bool learn(
	const head *h, const struct lidar_identity *lidar, struct identity *ret, GError **error)
{
	struct identity known = {
		.known = true, .lidar = *lidar, .driver = driver_find(h->lidar_protocol)
	};
	if (!calibration_parse(h->calibration, "the head's calibration", &known.calibration, error))
		return false;
	known.has_camera = h->camera && known.calibration.has_camera;
	*ret = known;
	return true;
}

bool identify_opened(head *h, const char *uri, struct identity *ret, GError **error)
{
	struct run_options o = { .preset = preset_find("draft") };
	g_autofree char *text = scan_session_text(uri, h);
	struct record_entry e = { .kind = RECORD_SESSION,
		.length = strlen(text),
		.time_ns = head_now_ns(h),
		.payload = text };
	g_autoptr(run) looking = run_new(h, &o);
	return run_begin(looking, &e, error) && run_prepare(looking, error) &&
	       learn(h, run_lidar(looking), ret, error);
}

bool identify_head(const char *uri, struct identity *ret, GError **error)
{
	g_autoptr(head) h = head_open(uri, error);
	return h && identify_opened(h, uri, ret, error);
}

/* Those that speak without being asked first: asking could disturb one that is none of ours. */
static const char *const serial_schemes[] = { "ld:", "rplidar:", "scip:" };

/* NULL: nobody that we know. */
static char *ask_line(const char *node)
{
	for (size_t i = 0; i < G_N_ELEMENTS(serial_schemes); i++) {
		g_autofree char *uri = g_strconcat(serial_schemes[i], node, NULL);
		struct identity who;
		if (identify_head(uri, &who, NULL))
			return g_steal_pointer(&uri);
	}
	return NULL;
}

/* A Hokuyo has a serial line and a USB name: the line of one that was found by name is not asked again. */
static bool is_named(const GPtrArray *devices, const struct found_device *line)
{
	for (guint i = 0; i < devices->len; i++) {
		const struct found_device *d = devices->pdata[i];
		if (d->kind == DEVICE_USB_LIDAR && d->vendor == line->vendor &&
			d->product == line->product)
			return true;
	}
	return false;
}

static void find_all(const GPtrArray *devices, GPtrArray *uris)
{
	for (guint i = 0; i < devices->len; i++) {
		const struct found_device *d = devices->pdata[i];
		char *uri = NULL;
		if (d->kind == DEVICE_USB_LIDAR)
			uri = g_strdup(d->uri);
		else if (d->kind == DEVICE_SERIAL && d->may_open && !is_named(devices, d))
			uri = ask_line(d->node);
		if (uri)
			g_ptr_array_add(uris, uri);
	}
}

char *identify_find(GError **error)
{
	g_autoptr(GPtrArray) devices = devices_find(),
			     uris = g_ptr_array_new_with_free_func(g_free);
	find_all(devices, uris);
	if (uris->len == 1)
		return g_strdup(uris->pdata[0]);
	g_ptr_array_add(uris, NULL);
	g_autofree char *list = g_strjoinv(", ", (char **)uris->pdata);
	if (uris->len > 1)
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
			"more than one lidar is plugged in: choose one with --device (%s)", list);
	else
		g_set_error(error, WIRE_ERROR, WIRE_ERROR_GONE,
			"no lidar was found: check its plug and its power ('pleinair doctor' tells "
			"more); without a scanner try --device "
			"sim:court");
	return NULL;
}
