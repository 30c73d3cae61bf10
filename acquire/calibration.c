#include "acquire/calibration.h"
#include "acquire/manifest.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

/* Ticks in a record have 32 bits (stage.h, camera.h). */
#define CLOCK_BITS_MAX 32
/* Below, a frame has no room for its chroma's neighbours. */
#define CAMERA_SIDE_MIN 16

static double number_of(JsonNode *node)
{
	GType type = node && JSON_NODE_HOLDS_VALUE(node) ? json_node_get_value_type(node)
							 : G_TYPE_INVALID;
	return type == G_TYPE_INT64 || type == G_TYPE_DOUBLE ? json_node_get_double(node) : NAN;
}

static bool get_numbers(
	const manifest *m, const char *key, double *ret, guint n, double limit, GError **error)
{
	JsonNode *node = manifest_get_node(m, key);
	JsonArray *array = node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
	for (guint i = 0; i < n; i++) {
		JsonNode *e = array && json_array_get_length(array) == n
				      ? json_array_get_element(array, i)
				      : NULL;
		double v = number_of(e);
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

/* Rows of length one, at right angles, and no mirror: the third is the cross product of the others.
 */
static bool is_rotation(const double r[3][3])
{
	double off = 0, dot = 0, norm[2] = { 0 };
	for (int i = 0; i < 3; i++) {
		int a = (i + 1) % 3, b = (i + 2) % 3;
		dot += r[0][i] * r[1][i];
		norm[0] += r[0][i] * r[0][i];
		norm[1] += r[1][i] * r[1][i];
		off = fmax(off, fabs(r[0][a] * r[1][b] - r[0][b] * r[1][a] - r[2][i]));
	}
	return off < 1e-3 && fabs(dot) < 1e-3 && fabs(norm[0] - 1) < 1e-3 &&
	       fabs(norm[1] - 1) < 1e-3;
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
		for (guint j = 0; good && j < 3; j++) {
			ret[i][j] = number_of(json_array_get_element(row, j));
			good = isfinite(ret[i][j]);
		}
	}
	good = good && is_rotation(ret);
	if (!good)
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"%s: '%s' must be a rotation: three rows of three numbers",
			manifest_path(m), key);
	return good;
}

void calibration_rotation(const double degrees[3], double r[3][3])
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
	if (fabs(l->beam_direction) != 1) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"%s: 'lidar.beam_direction' must be 1 or -1", manifest_path(m));
		return false;
	}
	l->beam_zero_rad *= G_PI / 180;
	calibration_rotation(degrees, l->rotation);
	return true;
}

static bool parse_stage(const manifest *m, struct stage_calibration *s, GError **error)
{
	int64_t slots, bits;
	if (!manifest_get_number(m, "stage.steps_per_turn", 16, 1e8, &s->steps_per_turn, error) ||
		!manifest_get_int(m, "stage.index_slots", 0, 100000, &slots, error) ||
		!manifest_get_number(
			m, "stage.azimuth_zero_deg", -360, 360, &s->azimuth_zero_rad, error) ||
		!manifest_get_number(m, "stage.clock_hz", 1, 1e9, &s->clock_hz, error) ||
		!manifest_get_int(m, "stage.clock_bits", 8, CLOCK_BITS_MAX, &bits, error))
		return false;
	s->azimuth_zero_rad *= G_PI / 180;
	s->index_slots = slots;
	s->clock_bits = bits;
	return true;
}

static bool parse_camera(const manifest *m, struct camera_calibration *c, GError **error)
{
	int64_t width, height, bits;
	if (!manifest_get_int(m, "camera.width", CAMERA_SIDE_MIN, 16384, &width, error) ||
		!manifest_get_int(m, "camera.height", CAMERA_SIDE_MIN, 16384, &height, error) ||
		!manifest_get_number(m, "camera.fx", 1, 1e6, &c->fx, error) ||
		!manifest_get_number(m, "camera.fy", 1, 1e6, &c->fy, error) ||
		!manifest_get_number(m, "camera.cx", -1e5, 1e5, &c->cx, error) ||
		!manifest_get_number(m, "camera.cy", -1e5, 1e5, &c->cy, error) ||
		!get_numbers(m, "camera.distortion", c->distortion, 5, 10, error) ||
		!get_matrix(m, "camera.rotation", c->rotation, error) ||
		!get_numbers(m, "camera.translation_m", c->translation_m, 3, 10, error) ||
		!manifest_get_number(m, "camera.clock_hz", 1, 1e9, &c->clock_hz, error) ||
		!manifest_get_int(m, "camera.clock_bits", 8, CLOCK_BITS_MAX, &bits, error) ||
		!manifest_get_number(m, "camera.readout_us", 0, 1e6, &c->readout_us, error) ||
		(manifest_has(m, "camera.delay_us") &&
			!manifest_get_number(m, "camera.delay_us", 0, 1e6, &c->delay_us, error)))
		return false;
	if (width % 2 || height % 2) {
		g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
			"%s: 'camera.width' and 'camera.height' must be even", manifest_path(m));
		return false;
	}
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
