#include "acquire/acquisition-lists.h"
#include "acquire/pump.h"
#include "acquire/service.h"
#include "firmware-io/wire.h"
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* ---- presets ---- */

static void add_prediction(GVariantBuilder *b, const struct preset *p, const struct identity *known)
{
	struct prediction says = preset_predict(
				  p, false, known->driver, &known->lidar, &known->calibration),
			  hdr = preset_predict(
				  p, true, known->driver, &known->lidar, &known->calibration);
	g_variant_builder_add(b, "{sv}", "seconds", g_variant_new_double(says.seconds));
	g_variant_builder_add(b, "{sv}", "points", g_variant_new_uint64(says.points));
	g_variant_builder_add(b, "{sv}", "bytes", g_variant_new_uint64(says.bytes));
	if (!known->has_camera)
		return;
	g_variant_builder_add(b, "{sv}", "hdr_seconds", g_variant_new_double(hdr.seconds));
	g_variant_builder_add(b, "{sv}", "hdr_bytes", g_variant_new_uint64(hdr.bytes));
}

GVariant *acquisition_presets(const struct identity *known)
{
	GVariantBuilder all;
	g_variant_builder_init(&all, G_VARIANT_TYPE("aa{sv}"));
	for (const struct preset *p = presets; p->name; p++) {
		GVariantBuilder b;
		g_variant_builder_init(&b, G_VARIANT_TYPE_VARDICT);
		g_variant_builder_add(&b, "{sv}", "name", g_variant_new_string(p->name));
		g_variant_builder_add(&b, "{sv}", "title", g_variant_new_string(p->title));
		g_variant_builder_add(&b, "{sv}", "columns", g_variant_new_uint32(p->columns));
		g_variant_builder_add(&b, "{sv}", "rows", g_variant_new_uint32(p->rows));
		g_variant_builder_add(&b, "{sv}", "photos", g_variant_new_uint32(p->photos));
		if (known->known && known->driver)
			add_prediction(&b, p, known);
		g_variant_builder_add(&all, "a{sv}", &b);
	}
	return g_variant_builder_end(&all);
}

bool acquisition_read_options(GVariant *options, bool *ret_hdr, GError **error)
{
	GVariantIter i;
	const char *key;
	GVariant *value;
	*ret_hdr = false;
	g_variant_iter_init(&i, options);
	while (g_variant_iter_loop(&i, "{&sv}", &key, &value)) {
		bool is_hdr = !strcmp(key, "hdr");
		if (is_hdr && g_variant_is_of_type(value, G_VARIANT_TYPE_BOOLEAN)) {
			*ret_hdr = g_variant_get_boolean(value);
			continue;
		}
		g_set_error(error, SERVICE_ERROR, SERVICE_ERROR_INVALID,
			is_hdr ? "the option '%s' is true or false"
			       : "a scan has no option '%s': hdr is one",
			key);
		g_variant_unref(value);
		return false;
	}
	return true;
}

/* ---- devices ---- */

struct told {
	const char *state, *sentence;
};

static void add_device(GVariantBuilder *all, const char *name, const char *title, struct told told)
{
	GVariantBuilder b;
	g_variant_builder_init(&b, G_VARIANT_TYPE_VARDICT);
	g_variant_builder_add(&b, "{sv}", "name", g_variant_new_string(name));
	g_variant_builder_add(&b, "{sv}", "title", g_variant_new_string(title));
	g_variant_builder_add(&b, "{sv}", "state", g_variant_new_string(told.state));
	g_variant_builder_add(&b, "{sv}", "sentence", g_variant_new_string(told.sentence));
	g_variant_builder_add(all, "a{sv}", &b);
}

/* "good" when no error is about it, and "unknown" where an error kept us from looking. */
static struct told tell(const GError *error, bool is_its, bool gone, bool known, const char *good)
{
	if (is_its)
		return (struct told){ gone ? "gone" : "fault", error->message };
	if (!known)
		return (struct told){ "unknown",
			error ? "Nobody could look at it." : "Nobody has looked at it yet." };
	return (struct told){ "good", good };
}

static bool is_about_stage(const GError *e)
{
	return g_error_matches(e, PUMP_ERROR, PUMP_ERROR_STAGE) || pump_error_is_safety(e);
}

static bool is_about_lidar(const GError *e)
{
	return e &&
	       ((e->domain == PUMP_ERROR && !is_about_stage(e) && e->code != PUMP_ERROR_STOPPED) ||
		       e->domain == WIRE_ERROR);
}

GVariant *acquisition_devices(const struct identity *known, const GError *error)
{
	GVariantBuilder all;
	bool gone = error && !g_error_matches(error, PUMP_ERROR, PUMP_ERROR_REFUSED);
	const struct lidar_identity *l = &known->lidar;
	g_autofree char *lidar =
		g_strdup_printf("%s, serial number %s, firmware %s: %u beams, %g turns a second",
			l->model, l->serial, l->firmware, l->beams, l->scan_rate_hz);
	g_variant_builder_init(&all, G_VARIANT_TYPE("aa{sv}"));
	add_device(&all, "lidar", "Lidar",
		tell(error, is_about_lidar(error), gone, known->known, lidar));
	add_device(&all, "stage", "Stage",
		tell(error, is_about_stage(error), false, known->known,
			"Connected; it finds its zero when a scan begins."));
	if (!known->known || known->has_camera)
		add_device(&all, "camera", "Camera",
			tell(error, false, false, known->known,
				"Connected, and calibrated to the lidar."));
	return g_variant_builder_end(&all);
}

/* ---- pictures ---- */

bool acquisition_find_plane(const char *name, enum picture *ret, GError **error)
{
	if (!strcmp(name, "range"))
		*ret = PICTURE_RANGE;
	else if (!strcmp(name, "intensity"))
		*ret = PICTURE_INTENSITY;
	else if (!strcmp(name, "colour"))
		*ret = PICTURE_COLOUR;
	else {
		g_set_error(error, SERVICE_ERROR, SERVICE_ERROR_INVALID,
			"there is no plane '%s': range, intensity or colour", name);
		return false;
	}
	return true;
}

static bool write_all(int fd, const char *at, size_t length)
{
	while (length) {
		ssize_t n = write(fd, at, length);
		if (n < 0 && errno != EINTR)
			return false;
		at += MAX(n, 0);
		length -= (size_t)MAX(n, 0);
	}
	return true;
}

int acquisition_seal(const void *bytes, size_t length, GError **error)
{
	int fd = memfd_create("pleinair-preview", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	if (fd >= 0 && write_all(fd, bytes, length) &&
		!fcntl(fd, F_ADD_SEALS, F_SEAL_SEAL | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE))
		return fd;
	g_set_error(error, G_FILE_ERROR, (gint)g_file_error_from_errno(errno),
		"the preview: no memory for it: %s", g_strerror(errno));
	if (fd >= 0)
		close(fd);
	return -1;
}
