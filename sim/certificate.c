#include "sim/certificate.h"
#include "sim/camera.h"

/* Numbers as JSON has them, whatever the locale. */
static void append_number(GString *json, const char *before, double number)
{
	char text[G_ASCII_DTOSTR_BUF_SIZE];

	g_string_append(json, before);
	g_string_append(json, g_ascii_dtostr(text, sizeof text, number));
}

static void append_camera(GString *json, const sim_options *o, const struct lens *lens)
{
	const struct camera_mount mount = camera_mount();

	g_string_append_printf(json, "{\"width\":%u,\"height\":%u", lens->width, lens->height);
	append_number(json, ",\"fx\":", lens->focal_px);
	append_number(json, ",\"fy\":", lens->focal_px);
	append_number(json, ",\"cx\":", lens->cx);
	append_number(json, ",\"cy\":", lens->cy);
	append_number(json, ",\"distortion\":[", lens->k1);
	append_number(json, ",", lens->k2);
	g_string_append(json, ",0,0,0],\"rotation\":[");
	for (int i = 0; i < 3; i++) {
		append_number(json, i ? ",[" : "[", mount.rotation[i][0]);
		append_number(json, ",", mount.rotation[i][1]);
		append_number(json, ",", mount.rotation[i][2]);
		g_string_append_c(json, ']');
	}
	append_number(json, "],\"translation_m\":[", mount.translation_m[0]);
	append_number(json, ",", mount.translation_m[1]);
	append_number(json, ",", mount.translation_m[2]);
	g_string_append_printf(json,
		"],\"clock_hz\":1000000,\"clock_bits\":32,\"readout_us\":0,\"delay_us\":"
		"%" G_GINT64_FORMAT "}",
		camera_transfer_ns(o) / 1000);
}

char *certificate_json(const sim_options *o, const struct lens *lens)
{
	GString *json = g_string_new(NULL);

	g_string_append_printf(
		json, "{\"serial\":\"SIM-%s-%" G_GUINT64_FORMAT "\",", o->scene, o->seed);
	g_string_append(json,
		"\"lidar\":{\"beam_zero_deg\":90,\"beam_direction\":1,\"range_offset_m\":0,"
		"\"rotation_deg\":[0,0,0],\"translation_m\":[0,0,0]},");
	append_number(json, "\"stage\":{\"steps_per_turn\":", o->steps_per_turn);
	g_string_append(json, ",\"index_slots\":24,\"azimuth_zero_deg\":0,\"clock_hz\":1000000,"
			      "\"clock_bits\":32},"
			      "\"camera\":");
	if (lens)
		append_camera(json, o, lens);
	else
		g_string_append(json, "null");
	g_string_append_c(json, '}');
	return g_string_free(json, FALSE);
}
