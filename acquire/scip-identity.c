#include "acquire/scip-identity.h"
#include "acquire/bytes.h"
#include <math.h>

/* Some firmware pads the numbers with spaces in front. */
static bool parse_number(const char *text, const char *end, uint32_t *ret)
{
	while (text < end && *text == ' ')
		text++;
	uint32_t value = 0;
	if (text == end || end - text > 9)
		return false;
	for (; text < end; text++) {
		if (!g_ascii_isdigit(*text))
			return false;
		value = value * 10 + (uint32_t)(*text - '0');
	}
	*ret = value;
	return true;
}

/* Keys have four characters. */
static bool find_value(const char *text, const char *key, const char **ret, const char **ret_end)
{
	for (const char *line = text, *end; *line; line = *end ? end + 1 : end) {
		end = strchrnul(line, '\n');
		if (end - line < 5 || memcmp(line, key, 4) != 0 || line[4] != ':')
			continue;
		*ret = line + 5;
		*ret_end = end;
		return true;
	}
	return false;
}

static void adopt_name(const char *text, const char *key, char *to, size_t size)
{
	const char *value, *end;
	if (find_value(text, key, &value, &end))
		bytes_copy_name(to, size, value, (size_t)(end - value));
}

static bool find_number(const char *text, const char *key, uint32_t *ret)
{
	const char *value, *end;
	return find_value(text, key, &value, &end) && parse_number(value, end, ret);
}

void scip_adopt_version(const char *text, struct lidar_identity *identity)
{
	/* PP has the model's bare name (MODL); here it stands in prose ("SOKUIKI Sensor URG-04LX").
	 */
	if (identity->beams == 0)
		adopt_name(text, "PROD", identity->model, sizeof identity->model);
	adopt_name(text, "SERI", identity->serial, sizeof identity->serial);
	adopt_name(text, "FIRM", identity->firmware, sizeof identity->firmware);
}

bool scip_adopt_parameters(
	const char *text, struct scip_parameters *parameters, struct lidar_identity *identity)
{
	struct scip_parameters p;
	if (!find_number(text, "DMIN", &p.range_min_mm) ||
		!find_number(text, "DMAX", &p.range_max_mm) ||
		!find_number(text, "ARES", &p.steps_per_turn) ||
		!find_number(text, "AMIN", &p.first_step) ||
		!find_number(text, "AMAX", &p.last_step) ||
		!find_number(text, "AFRT", &p.front_step) ||
		!find_number(text, "SCAN", &p.turns_per_minute))
		return false;
	if (p.steps_per_turn == 0 || p.first_step > p.last_step || p.last_step > 9999 ||
		p.front_step > 9999)
		return false;
	*parameters = p;
	adopt_name(text, "MODL", identity->model, sizeof identity->model);
	identity->angle_step_rad = 2 * M_PI / p.steps_per_turn;
	identity->first_angle_rad =
		((double)p.first_step - p.front_step) * identity->angle_step_rad;
	identity->beams = p.last_step - p.first_step + 1;
	identity->scan_rate_hz = p.turns_per_minute / 60.0;
	identity->range_max_m = p.range_max_mm / 1000.0;
	return true;
}
