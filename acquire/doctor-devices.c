#include "acquire/advice.h"
#include "acquire/configuration.h"
#include "acquire/doctor.h"
#include "acquire/identify.h"
#include "acquire/rate-check.h"
#include "firmware-io/devices.h"
#include "firmware-io/parts.h"
#include <gio/gio.h>
#include <glib/gi18n.h>
#include <string.h>

#define SERVICE_NAME "org.pleinair.Acquisition1"
#define SERVICE_PATH "/org/pleinair/Acquisition1"
#define SERVICE_MS   20000

static const char *const subjects[] = { [DEVICE_USB_LIDAR] = "lidar",
	[DEVICE_SERIAL] = "serial",
	[DEVICE_CAMERA] = "camera",
	[DEVICE_PINS] = "pins" };

static const char *advice_on(const struct found_device *d)
{
	if (!d->trouble)
		return NULL;
	if (!d->may_open && d->group)
		return N_("Become a member of that group (sudo adduser $USER GROUP, then log in "
			  "again), or scan through the service.");
	return N_("Install the appliance's files: make install, then udevadm control --reload && "
		  "udevadm trigger.");
}

static void say_device(GPtrArray *findings, const struct found_device *d)
{
	doctor_say(findings, d->trouble ? FINDING_BAD : FINDING_GOOD, subjects[d->kind],
		advice_on(d), "%s%s%s%s %s", d->title, d->node ? " (" : "", d->node ? d->node : "",
		d->node ? ")" : "", d->trouble ? d->trouble : "is there");
}

static void look_at_plugs(GPtrArray *findings)
{
	g_autoptr(GPtrArray) devices = devices_find();
	g_autofree char *power = devices_over_current();
	bool lidar = false;
	for (guint i = 0; i < devices->len; i++) {
		const struct found_device *d = devices->pdata[i];
		say_device(findings, d);
		lidar |= d->kind == DEVICE_USB_LIDAR || d->kind == DEVICE_SERIAL;
	}
	if (!lidar)
		doctor_say(findings, FINDING_NOTE, "lidar",
			N_("Plug it in and give it power; without a scanner, scan with --device "
			   "sim:court."),
			"no lidar is plugged in, and no serial line that could have one");
	if (power)
		doctor_say(
			findings, FINDING_BAD, "lidar", N_("Then plug it in anew."), "%s", power);
}

/* Who owns the scanner answers for it. */
static bool ask_service(GPtrArray *findings)
{
	g_autoptr(GDBusConnection) bus = g_bus_get_sync(G_BUS_TYPE_SYSTEM, NULL, NULL);
	g_autoptr(GError) error = NULL;
	g_autoptr(GVariant) has = bus ? g_dbus_connection_call_sync(bus, "org.freedesktop.DBus",
						"/org/freedesktop/DBus", "org.freedesktop.DBus",
						"NameHasOwner", g_variant_new("(s)", SERVICE_NAME),
						G_VARIANT_TYPE("(b)"), 0, SERVICE_MS, NULL, NULL)
				      : NULL;
	gboolean owned = FALSE;
	if (has)
		g_variant_get(has, "(b)", &owned);
	if (!owned)
		return false;
	g_autoptr(GVariant) answer =
		g_dbus_connection_call_sync(bus, SERVICE_NAME, SERVICE_PATH, SERVICE_NAME, "Check",
			NULL, G_VARIANT_TYPE("(aa{sv})"), 0, SERVICE_MS, NULL, &error);
	if (!answer) {
		g_dbus_error_strip_remote_error(error);
		doctor_say(findings, FINDING_NOTE, "service",
			N_("Ask it again when it is done, or become a member of the group "
			   "'pleinair'."),
			"the scanner's service runs, and says: %s", error->message);
		return true;
	}
	doctor_say(findings, FINDING_GOOD, "service", NULL,
		"the scanner's service runs, and was asked");
	g_autoptr(GVariantIter) devices = NULL;
	GVariantIter *pairs;
	g_variant_get(answer, "(aa{sv})", &devices);
	while (g_variant_iter_loop(devices, "a{sv}", &pairs)) {
		const char *key, *title = "", *state = "", *sentence = "";
		GVariant *value;
		while (g_variant_iter_next(pairs, "{&sv}", &key, &value)) {
			const char *text = g_variant_is_of_type(value, G_VARIANT_TYPE_STRING)
						   ? g_variant_get_string(value, NULL)
						   : "";
			*(strcmp(key, "title") == 0         ? &title
				: strcmp(key, "state") == 0 ? &state
							    : &sentence) = g_intern_string(text);
			g_variant_unref(value);
		}
		bool good = strcmp(state, "good") == 0;
		doctor_say(findings,
			good                            ? FINDING_GOOD
			: strcmp(state, "unknown") == 0 ? FINDING_NOTE
							: FINDING_BAD,
			"service", NULL, "%s: %s", title, sentence);
	}
	return true;
}

static void talk_to(GPtrArray *findings, const char *uri)
{
	struct identity who;
	g_autoptr(GError) error = NULL;
	if (!identify_head(uri, &who, &error)) {
		doctor_say(findings, FINDING_BAD, "head", advice_for(error), "%s: %s", uri,
			error->message);
		return;
	}
	doctor_say(findings, FINDING_GOOD, "head", NULL,
		"%s: %s answers, %u beams at %g Hz, firmware %s", uri, who.lidar.model,
		who.lidar.beams, who.lidar.scan_rate_hz, who.lidar.firmware);
	if (strcmp(who.calibration.serial, "uncalibrated") == 0)
		doctor_say(findings, FINDING_NOTE, "head",
			N_("Calibrate it: pleinair calibrate; then name the certificate in "
			   "/etc/pleinair.conf."),
			"it was never calibrated: its parts are taken to be where they are meant "
			"to be");
	if (!who.has_camera)
		doctor_say(findings, FINDING_NOTE, "camera",
			N_("Set it up in [camera] of /etc/pleinair.conf, and calibrate it, for "
			   "scans in colour."),
			"it has no camera whose place is known: scans have no colour");
}

static void let_stream(GPtrArray *findings, const char *uri, const struct doctor_options *o)
{
	struct rate_check r;
	g_autoptr(GError) error = NULL;
	if (!rate_check(uri, o->stream_s, o->goes_on, o->user_data, &r, &error)) {
		doctor_say(findings, FINDING_BAD, "stream", advice_for(error), "%s: %s", uri,
			error->message);
		return;
	}
	uint64_t lost = r.report.lost_revolutions + r.report.bad_telegrams + r.counts.lost_bytes +
			r.counts.overruns;
	doctor_say(findings, lost ? FINDING_BAD : FINDING_GOOD, "stream",
		lost ? N_("Try another cable or port, and close other programs.") : NULL,
		"%s: %" G_GUINT64_FORMAT " revolutions of %u beams in %.1f s, %" G_GUINT64_FORMAT
		" lost, %" G_GUINT64_FORMAT " telegrams damaged, %" G_GUINT64_FORMAT
		" bytes lost; %u of %u bytes of room used at most, %.1f %% of a core",
		uri, r.report.revolutions, r.lidar.beams, r.seconds, r.report.lost_revolutions,
		r.report.bad_telegrams, r.counts.lost_bytes + r.counts.overruns,
		r.counts.waiting_most, r.counts.room, r.core_percent);
}

/* A file that names pins wrongly must be known of before a head is opened. */
static bool look_at_configuration(GPtrArray *findings, const char *uri)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(parts) p = parts_read(uri ? uri : "tim:", &error);
	if (p)
		return true;
	doctor_say(findings, FINDING_BAD, "configuration",
		N_("Correct it; pleinair.conf(5) lists all keys."), "%s", error->message);
	return false;
}

void doctor_look_at_devices(GPtrArray *findings, const struct doctor_options *o)
{
	g_autofree char *configured = configuration_device();
	const char *uri = o->device ? o->device : configured;
	look_at_plugs(findings);
	if (!look_at_configuration(findings,
		    uri && !g_str_has_prefix(uri, "sim:") && !g_str_has_prefix(uri, "replay:")
			    ? uri
			    : NULL) ||
		o->only_look || (!o->device && ask_service(findings)))
		return;
	if (uri && o->stream_s > 0)
		let_stream(findings, uri, o);
	else if (uri)
		talk_to(findings, uri);
	else
		doctor_say(findings, FINDING_NOTE, "head",
			N_("Name one in [head] of /etc/pleinair.conf, or with --device."),
			"no head is set up to be talked to");
}
