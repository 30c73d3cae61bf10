#include "process/certificate.h"
#include "acquire/manifest.h"
#include "firmware-io/files.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define DEGREE (G_PI / 180)

static void set_numbers(manifest *m, const char *key, const double *v, guint n)
{
	JsonArray *array = json_array_new();
	for (guint i = 0; i < n; i++)
		json_array_add_double_element(array, v[i]);
	manifest_set_node(m, key, json_node_init_array(json_node_alloc(), array));
	json_array_unref(array);
}

static void set_rows(manifest *m, const char *key, const double r[3][3])
{
	JsonArray *rows = json_array_new();
	for (int i = 0; i < 3; i++) {
		JsonArray *row = json_array_new();
		for (int j = 0; j < 3; j++)
			json_array_add_double_element(row, r[i][j]);
		json_array_add_array_element(rows, row);
	}
	manifest_set_node(m, key, json_node_init_array(json_node_alloc(), rows));
	json_array_unref(rows);
}

static void set_lidar(manifest *m, const struct measured *d)
{
	const struct lidar_calibration *l = &d->lidar->lidar;
	double degrees[3], range_m = d->boards && d->boards->met ? d->boards->range_offset_m
								 : l->range_offset_m;
	two_face_angles(l->rotation, degrees);
	manifest_set_number(m, "lidar.beam_zero_deg", l->beam_zero_rad / DEGREE);
	manifest_set_number(m, "lidar.range_offset_m", range_m);
	set_numbers(m, "lidar.rotation_deg", degrees, 3);
	set_numbers(m, "lidar.translation_m", l->translation_m, 3);
}

static void set_camera(manifest *m, const struct camera_calibration *c)
{
	manifest_set_number(m, "camera.fx", c->fx);
	manifest_set_number(m, "camera.fy", c->fy);
	manifest_set_number(m, "camera.cx", c->cx);
	manifest_set_number(m, "camera.cy", c->cy);
	set_numbers(m, "camera.distortion", c->distortion, 5);
	set_rows(m, "camera.rotation", c->rotation);
	set_numbers(m, "camera.translation_m", c->translation_m, 3);
}

static void tell_lidar(manifest *m, const struct two_face_result *r)
{
	static const char *const keys[TWO_FACE_UNKNOWNS] = { "beam_zero_deg", "tilt_deg", "x_mm",
		"y_mm", "range_offset_mm", "delay_ms", "slack_deg" };
	for (int i = 0; i < TWO_FACE_UNKNOWNS; i++) {
		g_autofree char *deviation =
					g_strdup_printf("measured.two_faces.%s.deviation", keys[i]),
				*value = g_strdup_printf("measured.two_faces.%s.value", keys[i]);
		if (r->value[i].seen)
			manifest_set_number(m, value, two_face_in_unit(i, r->value[i].value));
		manifest_set_number(m, deviation, two_face_in_unit(i, r->value[i].deviation));
	}
	manifest_set_number(m, "measured.two_faces.error_before_mm", 1e3 * r->error_before_m);
	manifest_set_number(m, "measured.two_faces.error_mm", 1e3 * r->error_after_m);
	manifest_set_number(m, "measured.two_faces.noise_mm", 1e3 * r->noise_error_m);
	manifest_set_int(m, "measured.two_faces.patches", r->patches);
}

static void tell_boards(manifest *m, const struct board_result *r)
{
	manifest_set_int(m, "measured.boards.boards", r->boards);
	manifest_set_int(m, "measured.boards.views", r->views);
	manifest_set_number(m, "measured.boards.error_before_px", r->first_rms_px);
	manifest_set_number(m, "measured.boards.error_px", r->rms_px);
	/* In the order of enum board_unknown: px, none, rad, m. */
	set_numbers(m, "measured.boards.deviations", r->deviation, BOARD_UNKNOWNS);
	if (r->met) {
		manifest_set_int(m, "measured.boards.beams", r->beams);
		manifest_set_number(m, "measured.boards.range_offset_mm", 1e3 * r->range_offset_m);
		manifest_set_number(
			m, "measured.boards.range_deviation_mm", 1e3 * r->range_deviation_m);
	}
}

static manifest *make(const struct measured *d, const char *path, GError **error)
{
	const char *text = d->faces->certificate;
	manifest *m = manifest_parse(text, strlen(text), path, 0, error);
	g_autoptr(GDateTime) now = g_date_time_new_now_utc();
	g_autofree char *when = g_date_time_format(now, "%Y-%m-%dT%H:%M:%SZ");
	if (!m)
		return NULL;
	set_lidar(m, d);
	manifest_remove(m, "measured");
	manifest_set_string(m, "measured.date", when);
	manifest_set_string(m, "measured.from", d->source);
	tell_lidar(m, d->lidar);
	if (d->boards)
		set_camera(m, &d->boards->camera);
	if (d->boards)
		tell_boards(m, d->boards);
	return m;
}

char *certificate_text(const struct measured *d, GError **error)
{
	g_autoptr(manifest) m = make(d, "certificate", error);
	return m ? manifest_to_text(m) : NULL;
}

/* The old one is under both names for a moment, so there is a certificate at any time. */
static bool keep_old(const char *path, char **ret_kept_as, GError **error)
{
	g_autofree char *name = g_strconcat(path, ".1", NULL);
	if (!g_file_test(path, G_FILE_TEST_EXISTS))
		return true;
	for (int i = 2; g_file_test(name, G_FILE_TEST_EXISTS); i++) {
		g_free(name);
		name = g_strdup_printf("%s.%d", path, i);
	}
	if (link(path, name) != 0 && rename(path, name) != 0)
		return files_fail(error, name, "write");
	*ret_kept_as = g_steal_pointer(&name);
	return true;
}

bool certificate_save(
	const struct measured *d, const char *path, char **ret_kept_as, GError **error)
{
	g_autoptr(manifest) m = make(d, path, error);
	*ret_kept_as = NULL;
	return m && keep_old(path, ret_kept_as, error) && manifest_save(m, error);
}
