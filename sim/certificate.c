#include "sim/certificate.h"
#include "sim/camera.h"
#include <math.h>
#include <string.h>

/* Numbers as JSON has them, whatever the locale. */
static void append_number(GString *json, const char *before, double number)
{
	char text[G_ASCII_DTOSTR_BUF_SIZE];

	g_string_append(json, before);
	g_string_append(json, g_ascii_dtostr(text, sizeof text, number));
}

static void append_three(GString *json, const char *before, const double v[3], double scale)
{
	append_number(json, before, v[0] * scale);
	append_number(json, ",", v[1] * scale);
	append_number(json, ",", v[2] * scale);
	g_string_append_c(json, ']');
}

static void append_camera(GString *json, const sim_options *o, bool honest)
{
	const struct camera_mount mount = honest ? camera_mount_of(o) : camera_mount_drawn();
	const struct lens lens = honest ? lens_of(o) : lens_drawn(o);

	g_string_append_printf(json, "{\"width\":%u,\"height\":%u", lens.width, lens.height);
	append_number(json, ",\"fx\":", lens.focal_px);
	append_number(json, ",\"fy\":", lens.focal_px);
	append_number(json, ",\"cx\":", lens.cx);
	append_number(json, ",\"cy\":", lens.cy);
	append_number(json, ",\"distortion\":[", lens.k1);
	append_number(json, ",", lens.k2);
	g_string_append(json, ",0,0,0],\"rotation\":[");
	for (int i = 0; i < 3; i++)
		append_three(json, i ? ",[" : "[", mount.rotation[i], 1);
	append_three(json, "],\"translation_m\":[", mount.translation_m, 1);
	g_string_append_printf(json,
		",\"clock_hz\":1000000,\"clock_bits\":32,\"readout_us\":0,\"delay_us\":"
		"%" G_GINT64_FORMAT "}",
		camera_transfer_ns(o) / 1000);
}

static void append_lidar(GString *json, const sim_options *o, bool honest)
{
	static const sim_options drawn = { 0 };
	const sim_options *p = honest ? o : &drawn;

	append_number(json, "\"lidar\":{\"beam_zero_deg\":", 90 + p->beam_zero_deg);
	append_number(json, ",\"beam_direction\":1,\"range_offset_m\":", p->range_offset_mm * 1e-3);
	append_three(json, ",\"rotation_deg\":[", p->lidar_turn_deg, 1);
	append_three(json, ",\"translation_m\":[", p->lidar_shift_mm, 1e-3);
	append_number(json, "},\"stage\":{\"steps_per_turn\":", o->steps_per_turn);
	append_number(json, ",\"index_slots\":24,\"azimuth_zero_deg\":", p->home_azimuth_deg);
	g_string_append(json, ",\"clock_hz\":1000000,\"clock_bits\":32},\"camera\":");
}

static char *from_file(const char *path, GError **error)
{
	char *text = NULL;

	return g_file_get_contents(path, &text, NULL, error) ? text : NULL;
}

char *certificate_json(const sim_options *o, GError **error)
{
	bool honest = g_strcmp0(o->certificate, "true") == 0;

	if (o->certificate && !honest)
		return from_file(o->certificate, error);
	GString *json = g_string_new(NULL);

	g_string_append_printf(
		json, "{\"serial\":\"SIM-%s-%" G_GUINT64_FORMAT "\",", o->scene, o->seed);
	append_lidar(json, o, honest);
	if (o->camera_width)
		append_camera(json, o, honest);
	else
		g_string_append(json, "null");
	g_string_append_c(json, '}');
	return g_string_free(json, FALSE);
}
