#include "acquire/calibration.h"
#include "acquire/manifest.h"
#include <math.h>
#include <string.h>

static bool get_numbers(
	const manifest *m, const char *key, double *ret, guint n, double limit, GError **error)
{
	JsonNode *node = manifest_get_node(m, key);
	JsonArray *array = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	for (guint i = 0; i < n; i++) {
		JsonNode *e = array && json_array_get_length(array) == n
				      ? json_array_get_element(array, i)
				      : NULL;
		double v = e && JSON_NODE_HOLDS_VALUE(e) ? json_node_get_double(e) : NAN;
		if (!(fabs(v) <= limit)) {
			g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
				"%s: '%s' must be %u numbers within %g", manifest_path(m), key, n,
				limit);
			return false;
		}
		ret[i] = v;
	}
	return true;
}

static bool get_matrix(const manifest *m, const char *key, double ret[3][3], GError **error)
{
	JsonNode *node = manifest_get_node(m, key);
	JsonArray *rows = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	bool good = rows && json_array_get_length(rows) == 3;
	for (guint i = 0; good && i < 3; i++) {
		JsonNode *rn = json_array_get_element(rows, i);
		JsonArray *row = JSON_NODE_HOLDS_ARRAY(rn) ? json_node_get_array(rn) : NULL;
		good = row && json_array_get_length(row) == 3;
		double norm = 0;
		for (guint j = 0; good && j < 3; j++) {
			ret[i][j] = json_array_get_double_element(row, j);
			norm += ret[i][j] * ret[i][j];
		}
		good = good && fabs(norm - 1) < 1e-3;
	}
	if (!good)
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"%s: '%s' must be a rotation: three rows of three numbers",
			manifest_path(m), key);
	return good;
}

/* R = Rz Ry Rx of angles in degrees. */
static void rotation_of(const double degrees[3], double r[3][3])
{
	double a = degrees[0] * G_PI / 180, b = degrees[1] * G_PI / 180,
	       c = degrees[2] * G_PI / 180;
	double sa = sin(a), ca = cos(a), sb = sin(b), cb = cos(b), sc = sin(c), cc = cos(c);
	double m[3][3] = { { cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa },
		{ sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa },
		{ -sb, cb * sa, cb * ca } };
	memcpy(r, m, sizeof m);
}

static bool parse_lidar(const manifest *m, struct lidar_calibration *l, GError **error)
{
	double degrees[3];
	if (!manifest_get_number(m, "lidar.beam_zero_deg", -360, 360, &l->beam_zero_rad, error) ||
		!manifest_get_number(m, "lidar.beam_direction", -1, 1, &l->beam_direction, error) ||
		!manifest_get_number(
			m, "lidar.range_offset_m", -10, 10, &l->range_offset_m, error) ||
		!get_numbers(m, "lidar.rotation_deg", degrees, 3, 180, error) ||
		!get_numbers(m, "lidar.translation_m", l->translation_m, 3, 10, error))
		return false;
	l->beam_zero_rad *= G_PI / 180;
	l->beam_direction = l->beam_direction < 0 ? -1 : 1;
	rotation_of(degrees, l->rotation);
	return true;
}

static bool parse_stage(const manifest *m, struct stage_calibration *s, GError **error)
{
	int64_t slots, bits;
	if (!manifest_get_number(m, "stage.steps_per_turn", 16, 1e8, &s->steps_per_turn, error) ||
		!manifest_get_int(m, "stage.index_slots", 0, 100000, &slots, error) ||
		!manifest_get_number(
			m, "stage.azimuth_zero_deg", -360, 360, &s->azimuth_zero_rad, error) ||
		!manifest_get_number(m, "stage.clock_hz", 1, 1e10, &s->clock_hz, error) ||
		!manifest_get_int(m, "stage.clock_bits", 8, 64, &bits, error))
		return false;
	s->azimuth_zero_rad *= G_PI / 180;
	s->index_slots = slots;
	s->clock_bits = bits;
	return true;
}

static bool parse_camera(const manifest *m, struct camera_calibration *c, GError **error)
{
	int64_t width, height, bits;
	if (!manifest_get_int(m, "camera.width", 2, 16384, &width, error) ||
		!manifest_get_int(m, "camera.height", 2, 16384, &height, error) ||
		!manifest_get_number(m, "camera.fx", 1, 1e6, &c->fx, error) ||
		!manifest_get_number(m, "camera.fy", 1, 1e6, &c->fy, error) ||
		!manifest_get_number(m, "camera.cx", -1e5, 1e5, &c->cx, error) ||
		!manifest_get_number(m, "camera.cy", -1e5, 1e5, &c->cy, error) ||
		!get_numbers(m, "camera.distortion", c->distortion, 5, 10, error) ||
		!get_matrix(m, "camera.rotation", c->rotation, error) ||
		!get_numbers(m, "camera.translation_m", c->translation_m, 3, 10, error) ||
		!manifest_get_number(m, "camera.clock_hz", 1, 1e10, &c->clock_hz, error) ||
		!manifest_get_int(m, "camera.clock_bits", 8, 64, &bits, error) ||
		!manifest_get_number(m, "camera.readout_us", 0, 1e6, &c->readout_us, error))
		return false;
	c->width = width;
	c->height = height;
	c->clock_bits = bits;
	return true;
}

bool calibration_parse(const char *text, const char *name, struct calibration *ret, GError **error)
{
	g_autoptr(manifest) m = manifest_parse(text, strlen(text), name, 0, error);
	struct calibration c = { 0 };
	const char *serial = m ? manifest_get_string(m, "serial", error) : NULL;
	if (!serial || !parse_lidar(m, &c.lidar, error) || !parse_stage(m, &c.stage, error))
		return false;
	JsonNode *camera = manifest_get_node(m, "camera");
	c.has_camera = camera && JSON_NODE_HOLDS_OBJECT(camera);
	if (c.has_camera && !parse_camera(m, &c.camera, error))
		return false;
	g_strlcpy(c.serial, serial, sizeof c.serial);
	*ret = c;
	return true;
}
