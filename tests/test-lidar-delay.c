#include "acquire/lidar-delay.h"
#include "acquire/scan.h"
#include "tests/simulated.h"
#include <math.h>

#define DEGREE    (G_PI / 180)
#define BEAMS     721u
#define RATE_HZ   40.0
#define NOISE_M   0.012
#define HALF_X_M  4.0
#define HALF_Y_M  6.5
#define CEILING_M 3.0
#define FLOOR_M   1.7

/* Inside a box, off its middle. */
static double range_in_room(double azimuth, double elevation)
{
	double d[3] = { cos(elevation) * sin(azimuth), cos(elevation) * cos(azimuth),
		sin(elevation) };
	double x = ((d[0] > 0 ? HALF_X_M : -HALF_X_M) - 0.7) / d[0],
	       y = ((d[1] > 0 ? HALF_Y_M : -HALF_Y_M) + 1.1) / d[1],
	       z = (d[2] > 0 ? CEILING_M : -FLOOR_M) / d[2];
	return fmin(fabs(x), fmin(fabs(y), fabs(z)));
}

static double noise(void)
{
	double sum = 0;
	for (int i = 0; i < 12; i++)
		sum += g_test_rand_double();
	return (sum - 6) * NOISE_M;
}

struct room {
	double delay_s, slack_rad;
	double azimuth[BEAMS];
	float elevation[BEAMS], range[BEAMS];
	uint16_t intensity[BEAMS];
};

/* A turn of the mirror at a stage angle; where the beams went, and where they are thought to have
 * gone. */
static struct placed_line line_at(struct room *r, double front_rad, double pace_rad_s)
{
	double off = pace_rad_s * r->delay_s + (pace_rad_s < 0 ? r->slack_rad : 0);
	for (uint32_t i = 0; i < BEAMS; i++) {
		double theta = -40 * DEGREE + i * (260 * DEGREE) / (BEAMS - 1);
		bool behind = theta > G_PI / 2;
		double elevation = behind ? G_PI - theta : theta,
		       azimuth = front_rad + (behind ? G_PI : 0);
		r->range[i] = (float)(range_in_room(azimuth - off, elevation) + noise());
		r->azimuth[i] = fmod(azimuth + 4 * G_PI, 2 * G_PI);
		r->elevation[i] = (float)elevation;
	}
	return (struct placed_line){ .beams = BEAMS,
		.azimuth_rad = r->azimuth,
		.elevation_rad = r->elevation,
		.range_m = r->range,
		.intensity = r->intensity,
		.turn_rad = pace_rad_s / RATE_HZ };
}

/* From rest to rest, as after homing and on the way home. */
static void go_back(
	struct room *room, lidar_delay *d, double from_rad, double angle_deg, double most_deg_s)
{
	const struct scanline line = { .scan_rate_hz = RATE_HZ, .beams = BEAMS };
	double to_rad = from_rad - angle_deg * DEGREE, a = 40 * DEGREE, speed = 0;
	for (double front = from_rad; front > to_rad; front -= speed / RATE_HZ) {
		double left = fmax(sqrt(2 * a * (front - to_rad)), a / RATE_HZ);
		speed = fmin(fmin(speed + a / RATE_HZ, most_deg_s * DEGREE), left);
		struct placed_line placed = line_at(room, front, -speed);
		lidar_delay_add(d, &line, &placed);
	}
}

static bool find_delay(double delay_s, double slack_rad, uint32_t columns, uint32_t rows,
	double back_deg, struct lidar_delay_result *ret)
{
	const struct scanline line = { .scan_rate_hz = RATE_HZ, .beams = BEAMS };
	g_autofree struct room *room = g_new0(struct room, 1);
	struct panorama_desc desc = panorama_desc_for(columns, rows);
	g_autoptr(panorama) p = panorama_new(&desc, NULL);
	g_autoptr(lidar_delay) d = lidar_delay_new();
	double pace = 2 * G_PI / columns * RATE_HZ / 1.06;
	*room = (struct room){ .delay_s = delay_s, .slack_rad = slack_rad };
	for (double front = 0; front < G_PI + 0.1; front += pace / RATE_HZ) {
		struct placed_line placed = line_at(room, front, pace);
		lidar_delay_add(d, &line, &placed);
		panorama_add(p, placed.azimuth_rad, placed.elevation_rad, placed.range_m,
			placed.intensity, placed.beams);
	}
	go_back(room, d, 25 * DEGREE, fmin(25, back_deg), 45);
	go_back(room, d, 200 * DEGREE, fmin(40, back_deg), 10);
	go_back(room, d, 160 * DEGREE, fmax(back_deg - 40, 0), 45);
	return lidar_delay_estimate(d, p, ret);
}

static const struct {
	const char *name;
	double delay_s, slack_deg;
	uint32_t columns, rows;
} rooms[] = {
	{ "draft", 0.9e-3, 0, 750, 198 },
	{ "standard", 0.9e-3, 0, 1500, 396 },
	{ "none", 0, 0, 1500, 396 },
	{ "early", -1.2e-3, 0, 1500, 396 },
	{ "slack", 0.7e-3, 0.06, 1500, 396 },
	{ "long", 4e-3, 0, 750, 198 },
};

static void test_room(gconstpointer data)
{
	size_t i = GPOINTER_TO_SIZE(data);
	struct lidar_delay_result found;
	g_assert_true(find_delay(rooms[i].delay_s, rooms[i].slack_deg * DEGREE, rooms[i].columns,
		rooms[i].rows, 200, &found));
	g_test_message("delay %.0f us, found %.0f +- %.0f, slack %.4f deg", 1e6 * rooms[i].delay_s,
		1e6 * found.delay_s, 1e6 * found.deviation_s, found.slack_rad / DEGREE);
	g_assert_cmpfloat(fabs(found.delay_s - rooms[i].delay_s), <, 0.5e-3);
	g_assert_cmpfloat(fabs(found.slack_rad / DEGREE - rooms[i].slack_deg), <, 0.025);
	g_assert_cmpfloat(found.deviation_s, <, 0.2e-3);
}

static void test_too_little_tells_nothing(void)
{
	struct lidar_delay_result found;
	g_assert_false(find_delay(1e-3, 0, 750, 198, 0, &found));
	g_assert_false(find_delay(1e-3, 0, 750, 198, 4, &found));
}

/* What scan.json says of a scan whose cable delays so much; in microseconds. */
static double delay_of_scan(const char *description)
{
	g_autofree char *folder = simulated_folder();
	g_autofree char *path = g_build_filename(folder, "site", NULL);
	struct scan_options options = { .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	double delay_us;
	g_autoptr(GError) error = NULL;
	simulated_scan(path, description, &options, NULL, NULL, &result, &partial, &error);
	g_assert_no_error(error);
	g_autofree char *file = g_build_filename(path, "scans", "0001", "scan.json", NULL);
	g_autoptr(manifest) m = manifest_load(file, SCAN_SCHEMA, &error);
	g_assert_no_error(error);
	manifest_get_number(m, "lidar.delay_us", -1e5, 1e5, &delay_us, &error);
	g_assert_no_error(error);
	return delay_us;
}

/* Questions and answers already give half of what the cable delays. */
static void test_cable_shows(void)
{
	double less = delay_of_scan("hall?seed=5&ares=720&camera=none&latency_ms=1"),
	       more = delay_of_scan("hall?seed=5&ares=720&camera=none&latency_ms=7");
	g_test_message("%.0f us, %.0f us", less, more);
	g_assert_cmpfloat(fabs(more - less - 3000), <, 700);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(rooms); i++) {
		g_autofree char *path = g_strdup_printf("/lidar-delay/room/%s", rooms[i].name);
		g_test_add_data_func(path, GSIZE_TO_POINTER(i), test_room);
	}
	g_test_add_func("/lidar-delay/too-little", test_too_little_tells_nothing);
	g_test_add_func("/lidar-delay/cable", test_cable_shows);
	return g_test_run();
}
