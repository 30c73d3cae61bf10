/* Where beams go, against the formula of calibration.h written out in the plainest way; and what a
 * calibration may say. */
#include "acquire/placement.h"
#include <math.h>
#include <string.h>

#define SECOND_NS INT64_C(1000000000)
#define DEGREE    (G_PI / 180)
#define TURN      3600.0 /* steps */
#define BEAMS     541u

/* ---- the plain way ---- */

struct matrix {
	double m[3][3];
};

static struct matrix times(struct matrix a, struct matrix b)
{
	struct matrix c = { 0 };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			for (int k = 0; k < 3; k++)
				c.m[i][j] += a.m[i][k] * b.m[k][j];
	return c;
}

/* About axis 0, 1 or 2, right-handed. */
static struct matrix turn_about(int axis, double degrees)
{
	int a = (axis + 1) % 3, b = (axis + 2) % 3;
	double s = sin(degrees * DEGREE), c = cos(degrees * DEGREE);
	struct matrix r = { 0 };
	r.m[axis][axis] = 1;
	r.m[a][a] = r.m[b][b] = c;
	r.m[a][b] = -s;
	r.m[b][a] = s;
	return r;
}

static struct matrix turned(const double degrees[3])
{
	return times(turn_about(2, degrees[2]),
		times(turn_about(1, degrees[1]), turn_about(0, degrees[0])));
}

struct polar {
	double azimuth_rad, elevation_rad, range_m;
};

struct head_facts {
	double beam_zero_deg, beam_direction, range_offset_m;
	double rotation_deg[3], translation_m[3];
	double azimuth_zero_deg;
};

static struct polar expected(
	const struct head_facts *h, double beam_angle, double range_m, double front)
{
	double theta = h->beam_zero_deg * DEGREE + h->beam_direction * beam_angle,
	       r = range_m + h->range_offset_m, v[3];
	double beam[3] = { 0, r * cos(theta), r * sin(theta) };
	struct matrix rotation = turned(h->rotation_deg);
	for (int i = 0; i < 3; i++)
		v[i] = rotation.m[i][0] * beam[0] + rotation.m[i][1] * beam[1] +
		       rotation.m[i][2] * beam[2] + h->translation_m[i];
	/* The head frame stands clockwise by the front's azimuth in the scanner frame. */
	double a = front + h->azimuth_zero_deg * DEGREE;
	double x = v[0] * cos(a) + v[1] * sin(a), y = v[1] * cos(a) - v[0] * sin(a);
	double azimuth = atan2(x, y);
	return (struct polar){ azimuth < 0 ? azimuth + 2 * G_PI : azimuth, atan2(v[2], hypot(x, y)),
		sqrt(x * x + y * y + v[2] * v[2]) };
}

/* ---- a head, a stage that turns evenly, a scanline ---- */

static struct calibration calibration_of(const struct head_facts *h)
{
	struct calibration c;
	g_autoptr(GError) error = NULL;
	g_autofree char *text = g_strdup_printf(
		"{\"serial\":\"T1\",\"lidar\":{\"beam_zero_deg\":%.17g,\"beam_direction\":%g,"
		"\"range_offset_m\":%.17g,\"rotation_deg\":[%.17g,%.17g,%.17g],\"translation_m\":"
		"[%.17g,%.17g,%.17g]},\"stage\":{\"steps_per_turn\":%g,\"index_slots\":0,"
		"\"azimuth_zero_deg\":%.17g,\"clock_hz\":1000000,\"clock_bits\":32},\"camera\":"
		"null}",
		h->beam_zero_deg, h->beam_direction, h->range_offset_m, h->rotation_deg[0],
		h->rotation_deg[1], h->rotation_deg[2], h->translation_m[0], h->translation_m[1],
		h->translation_m[2], TURN, h->azimuth_zero_deg);
	g_assert_true(calibration_parse(text, "test", &c, &error));
	g_assert_no_error(error);
	g_assert_false(c.has_camera);
	return c;
}

/* At home at one second, one pulse each interval from then on. */
static stage_track *track_at(double steps_s, int direction, int steps)
{
	stage_track *t = stage_track_new(TURN, 0);
	struct stage_event home = { .kind = STAGE_HOME, .direction = 1 },
			   step = { .kind = STAGE_STEP, .direction = (int8_t)direction };
	stage_track_feed(t, &home, SECOND_NS);
	for (int i = 1; i <= steps; i++)
		stage_track_feed(t, &step, SECOND_NS + llround(i / steps_s * 1e9));
	return t;
}

struct sweep {
	struct scanline line;
	uint32_t range_mm[BEAMS];
	uint16_t intensity[BEAMS];
};

static void fill_sweep(struct sweep *s, double first_deg, double step_deg, double rate_hz)
{
	for (uint32_t i = 0; i < BEAMS; i++) {
		s->range_mm[i] = i % 7 == 3 ? 0 : i % 7 == 5 ? 2 : 700 + 37 * i;
		s->intensity[i] = (uint16_t)(i * 11);
	}
	s->line = (struct scanline){ .first_angle_rad = first_deg * DEGREE,
		.angle_step_rad = step_deg * DEGREE,
		.scan_rate_hz = rate_hz,
		.beams = BEAMS,
		.range_mm = s->range_mm,
		.intensity = s->intensity,
		.range_min_mm = 16 };
}

static const struct scene {
	const char *path;
	struct head_facts head;
	double first_deg, step_deg, rate_hz, steps_s;
	int direction;
} scenes[] = {
	{ "/placement/plain", { 90, 1, 0, { 0 }, { 0 }, 0 }, -135, 0.5, 40, 40, 1 },
	{ "/placement/turned", { 88.7, 1, 0.013, { 0.8, -1.1, 0.6 }, { 0 }, 0 }, -135, 0.5, 40, 40,
		1 },
	{ "/placement/mirrored", { 271, -1, -0.02, { 0.2, 0.1, 3 }, { 0 }, 33 }, -45, 0.5, 40, 40,
		1 },
	{ "/placement/beside-the-axis",
		{ 90, 1, 0.01, { 0.5, 0.3, -0.4 }, { 0.03, -0.05, 0.02 }, 211 }, -135, 0.5, 15, 60,
		1 },
	{ "/placement/backwards", { 90, 1, 0, { 0.5, 0.3, -0.4 }, { 0.03, -0.05, 0 }, -70 }, -135,
		0.5, 15, 60, -1 },
	{ "/placement/clockwise-sweep", { 90, 1, 0, { 1, 1, 1 }, { 0, 0.01, 0 }, 5 }, 135, -0.5, 40,
		40, 1 },
};

static double off(double a, double b)
{
	return fabs(remainder(a - b, 2 * G_PI));
}

static void compare(const struct scene *s, const struct sweep *w, const struct placed_line *placed,
	double front_first, double front_per_beam)
{
	g_assert_cmpuint(placed->beams, ==, BEAMS);
	for (uint32_t i = 0; i < BEAMS; i++) {
		double angle = w->line.first_angle_rad + i * w->line.angle_step_rad;
		bool hit = w->range_mm[i] >= 16;
		struct polar e = expected(&s->head, angle, hit ? w->range_mm[i] * 1e-3 : 1e6,
			front_first + i * front_per_beam);
		/* Near the zenith an azimuth means little. */
		double slack = 1e-6 / fmax(cos(e.elevation_rad), 1e-3);
		g_assert_cmpfloat(off(placed->azimuth_rad[i], e.azimuth_rad), <, slack);
		g_assert_cmpfloat(
			fabs((double)placed->elevation_rad[i] - e.elevation_rad), <, 1e-6);
		g_assert_true(placed->azimuth_rad[i] >= 0 && placed->azimuth_rad[i] < 2 * G_PI);
		if (hit)
			g_assert_cmpfloat(fabs((double)placed->range_m[i] - e.range_m), <, 2e-6);
		else
			g_assert_cmpfloat(placed->range_m[i], ==, 0);
		g_assert_cmpint(placed->intensity[i], ==, w->intensity[i]);
	}
}

/* Once from home, once over azimuth 2 pi, with the same tables; then without intensities. */
static void test_scene(gconstpointer data)
{
	const struct scene *s = data;
	static struct sweep w;
	struct calibration c = calibration_of(&s->head);
	g_autoptr(placement) p = placement_new(&c);
	g_autoptr(stage_track) t = track_at(s->steps_s, s->direction, 8000);
	double rad_s = s->direction * s->steps_s * 2 * G_PI / TURN;
	fill_sweep(&w, s->first_deg, s->step_deg, s->rate_hz);
	for (double start_s = 2; start_s < 8000 / s->steps_s - 2; start_s += 7.77) {
		struct placed_line placed;
		int64_t first_ns, last_ns;
		placement_sweep(&w.line, STAMP_FIRST_BEAM, SECOND_NS + llround(start_s * 1e9),
			&first_ns, &last_ns);
		placement_place(p, &w.line, t, first_ns, last_ns, &placed);
		double beam_s = fabs(w.line.angle_step_rad) / (2 * G_PI * s->rate_hz);
		compare(s, &w, &placed, start_s * rad_s, beam_s * rad_s);
		g_assert_cmpfloat(fabs(placed.front_first_rad - start_s * rad_s), <, 1e-7);
		g_assert_cmpfloat(
			fabs(placed.front_last_rad - (start_s + beam_s * (BEAMS - 1)) * rad_s), <,
			1e-7);
		g_assert_cmpfloat(fabs(placed.turn_rad - rad_s / s->rate_hz), <, 1e-7);
		g_assert_false(placed.suspect);
	}
	struct placed_line placed;
	w.line.intensity = NULL;
	placement_place(p, &w.line, t, SECOND_NS, 2 * SECOND_NS, &placed);
	g_assert_cmpint(placed.intensity[100], ==, 0);
}

/* Another geometry must not be read with the first one's tables. */
static void test_geometry_changes(void)
{
	static struct sweep w;
	const struct scene *s = &scenes[1];
	struct calibration c = calibration_of(&s->head);
	g_autoptr(placement) p = placement_new(&c);
	g_autoptr(stage_track) t = track_at(1, 1, 3);
	static const struct {
		double first_deg, step_deg;
		uint32_t beams;
	} shapes[] = { { -135, 0.5, 541 }, { -120, 0.5, 541 }, { -120, 0.4, 541 }, { -120, 0.4, 7 },
		{ -120, 0.4, 1 }, { -120, 0.4, 541 } };
	for (size_t i = 0; i < G_N_ELEMENTS(shapes); i++) {
		struct placed_line placed;
		fill_sweep(&w, shapes[i].first_deg, shapes[i].step_deg, 40);
		w.line.beams = shapes[i].beams;
		placement_place(p, &w.line, t, 0, 0, &placed);
		g_assert_cmpuint(placed.beams, ==, shapes[i].beams);
		uint32_t last = shapes[i].beams - 1;
		struct polar e = expected(&s->head,
			(shapes[i].first_deg + last * shapes[i].step_deg) * DEGREE, 1e6, 0);
		g_assert_cmpfloat(off(placed.azimuth_rad[last], e.azimuth_rad), <, 1e-5);
		g_assert_cmpfloat(
			fabs((double)placed.elevation_rad[last] - e.elevation_rad), <, 1e-6);
		g_assert_cmpfloat(placed.turn_rad, ==, 0);
	}
}

/* ---- times ---- */

static const struct {
	const char *who;
	enum stamp_instant stamp;
	uint32_t beams;
	double step_deg, rate_hz;
	int64_t stamp_ns, first_ns, last_ns;
} sweeps[] = {
	/* SCIP stamps the first beam; 270 degrees at 40 Hz last 18.75 ms. */
	{ "scip", STAMP_FIRST_BEAM, 1081, 0.25, 40, 5000000000, 5000000000, 5018750000 },
	/* A TiM5xx stamps the last; 270 degrees at 15 Hz last 50 ms. */
	{ "cola", STAMP_LAST_BEAM, 271, 1, 15, 5000000000, 4950000000, 5000000000 },
	{ "clockwise", STAMP_LAST_BEAM, 541, -0.5, 50, 100000000, 85000000, 100000000 },
	{ "one beam", STAMP_LAST_BEAM, 1, 1, 15, 7, 7, 7 },
};

static void test_sweep(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(sweeps); i++) {
		struct scanline line = { .beams = sweeps[i].beams,
			.angle_step_rad = sweeps[i].step_deg * DEGREE,
			.scan_rate_hz = sweeps[i].rate_hz };
		int64_t first_ns, last_ns;
		placement_sweep(&line, sweeps[i].stamp, sweeps[i].stamp_ns, &first_ns, &last_ns);
		g_assert_cmpint(ABS(first_ns - sweeps[i].first_ns), <=, 1);
		g_assert_cmpint(ABS(last_ns - sweeps[i].last_ns), <=, 1);
	}
}

/* ---- what may be used ---- */

static void test_usable(void)
{
	double column = 2 * G_PI / 3000;
	static const struct {
		double columns_a_turn;
		bool suspect, usable;
	} rows[] = { { 0, false, true }, { 0.94, false, true }, { -0.94, false, true },
		{ 1.49, false, true }, { 1.51, false, false }, { -1.51, false, false },
		{ 20, false, false }, { 0.94, true, false } };
	for (size_t i = 0; i < G_N_ELEMENTS(rows); i++) {
		struct placed_line placed = { .turn_rad = rows[i].columns_a_turn * column,
			.suspect = rows[i].suspect };
		g_assert_true(placement_is_usable(&placed, 3000) == rows[i].usable);
	}
}

/* Slots every 100 steps; 40 steps are lost between the slots at 300 and 400. */
static stage_track *slipping_track(void)
{
	stage_track *t = stage_track_new(TURN, 36);
	for (int i = 1, behind = 0; i <= 1000; i++) {
		struct stage_event step = { .kind = STAGE_STEP, .direction = 1 },
				   slot = { .kind = STAGE_INDEX, .direction = 1 },
				   home = { .kind = STAGE_HOME, .direction = 1 };
		stage_track_feed(t, &step, SECOND_NS + i * SECOND_NS / 10);
		behind = i >= 350 ? 40 : 0;
		if ((i - behind) % 100)
			continue;
		stage_track_feed(t, &slot, SECOND_NS + i * SECOND_NS / 10 + 1);
		if (i == 100)
			stage_track_feed(t, &home, SECOND_NS + i * SECOND_NS / 10 + 1);
	}
	return t;
}

/* A line is suspect when any of its beams is. */
static void test_suspect(void)
{
	static struct sweep w;
	struct calibration c = calibration_of(&scenes[0].head);
	g_autoptr(placement) p = placement_new(&c);
	g_autoptr(stage_track) t = slipping_track();
	static const struct {
		double first_step, last_step;
		bool suspect;
	} lines[] = { { 290, 299, false }, { 299, 302, true }, { 310, 320, true },
		{ 430, 445, true }, { 441, 450, false } };
	fill_sweep(&w, -135, 0.5, 1);
	for (size_t i = 0; i < G_N_ELEMENTS(lines); i++) {
		struct placed_line placed;
		placement_place(p, &w.line, t, SECOND_NS + llround(lines[i].first_step * 1e8),
			SECOND_NS + llround(lines[i].last_step * 1e8), &placed);
		g_assert_true(placed.suspect == lines[i].suspect);
	}
}

/* ---- what a calibration may say ---- */

#define LIDAR                                                                                      \
	"\"lidar\":{\"beam_zero_deg\":90,\"beam_direction\":-1,\"range_offset_m\":0.01,"           \
	"\"rotation_deg\":[1,2,3],\"translation_m\":[0.1,0.2,0.3]}"
#define STAGE                                                                                      \
	"\"stage\":{\"steps_per_turn\":11886,\"index_slots\":24,\"azimuth_zero_deg\":10,"          \
	"\"clock_hz\":1000000,\"clock_bits\":32}"
#define CAMERA                                                                                     \
	"\"camera\":{\"width\":720,\"height\":1280,\"fx\":500,\"fy\":510,\"cx\":360,\"cy\":640,"   \
	"\"distortion\":[0.1,0.2,0.3,0.4,0.5],\"rotation\":[[1,0,0],[0,0,-1],[0,1,0]],"            \
	"\"translation_m\":[0,0.05,0.07],\"clock_hz\":1000000,\"clock_bits\":32,\"readout_us\":5}"
#define WHOLE "{\"serial\":\"A7\"," LIDAR "," STAGE "," CAMERA "}"

static void test_parse(void)
{
	struct calibration c;
	g_autoptr(GError) error = NULL;
	g_assert_true(calibration_parse(WHOLE, "paper", &c, &error));
	g_assert_no_error(error);
	g_assert_cmpstr(c.serial, ==, "A7");
	g_assert_cmpfloat(fabs(c.lidar.beam_zero_rad - G_PI / 2), <, 1e-12);
	g_assert_cmpfloat(c.lidar.beam_direction, ==, -1);
	g_assert_cmpfloat(c.lidar.range_offset_m, ==, 0.01);
	g_assert_cmpfloat(c.lidar.translation_m[2], ==, 0.3);
	struct matrix r = turned((double[]){ 1, 2, 3 });
	for (int i = 0; i < 9; i++)
		g_assert_cmpfloat(
			fabs(c.lidar.rotation[i / 3][i % 3] - r.m[i / 3][i % 3]), <, 1e-12);
	g_assert_cmpfloat(c.stage.steps_per_turn, ==, 11886);
	g_assert_cmpuint(c.stage.index_slots, ==, 24);
	g_assert_cmpfloat(fabs(c.stage.azimuth_zero_rad - 10 * DEGREE), <, 1e-12);
	g_assert_cmpuint(c.stage.clock_bits, ==, 32);
	g_assert_true(c.has_camera);
	g_assert_cmpuint(c.camera.width, ==, 720);
	g_assert_cmpuint(c.camera.height, ==, 1280);
	g_assert_cmpfloat(c.camera.fy, ==, 510);
	g_assert_cmpfloat(c.camera.distortion[4], ==, 0.5);
	g_assert_cmpfloat(c.camera.rotation[1][2], ==, -1);
	g_assert_cmpfloat(c.camera.readout_us, ==, 5);
}

/* A piece of the whole, what it is replaced by, and the key that the refusal must name. */
static const struct {
	const char *piece, *by, *key;
} refusals[] = {
	{ "\"serial\":\"A7\",", "", "serial" },
	{ "\"A7\"", "7", "serial" },
	{ "\"beam_zero_deg\":90,", "", "lidar.beam_zero_deg" },
	{ "\"beam_zero_deg\":90", "\"beam_zero_deg\":400", "lidar.beam_zero_deg" },
	{ "\"beam_direction\":-1", "\"beam_direction\":2", "lidar.beam_direction" },
	{ "\"beam_direction\":-1", "\"beam_direction\":0", "lidar.beam_direction" },
	{ "\"beam_direction\":-1", "\"beam_direction\":0.5", "lidar.beam_direction" },
	{ "\"range_offset_m\":0.01", "\"range_offset_m\":\"0\"", "lidar.range_offset_m" },
	{ "\"range_offset_m\":0.01", "\"range_offset_m\":-11", "lidar.range_offset_m" },
	{ "[1,2,3]", "[1,2]", "lidar.rotation_deg" },
	{ "[1,2,3]", "[1,2,3,4]", "lidar.rotation_deg" },
	{ "[1,2,3]", "[1,2,\"3\"]", "lidar.rotation_deg" },
	{ "[1,2,3]", "[1,2,null]", "lidar.rotation_deg" },
	{ "[1,2,3]", "[1,2,[3]]", "lidar.rotation_deg" },
	{ "[1,2,3]", "[1,2,true]", "lidar.rotation_deg" },
	{ "[1,2,3]", "[1,2,181]", "lidar.rotation_deg" },
	{ "[1,2,3]", "1", "lidar.rotation_deg" },
	{ "[0.1,0.2,0.3]", "[0.1,0.2,30]", "lidar.translation_m" },
	{ LIDAR, "\"lidar\":[]", "lidar.beam_zero_deg" },
	{ "\"steps_per_turn\":11886", "\"steps_per_turn\":0", "stage.steps_per_turn" },
	{ "\"steps_per_turn\":11886", "\"steps_per_turn\":1e300", "stage.steps_per_turn" },
	{ "\"index_slots\":24", "\"index_slots\":-1", "stage.index_slots" },
	{ "\"index_slots\":24", "\"index_slots\":2.5", "stage.index_slots" },
	{ "\"azimuth_zero_deg\":10", "\"azimuth_zero_deg\":1000", "stage.azimuth_zero_deg" },
	{ "\"azimuth_zero_deg\":10,\"clock_hz\":1000000", "\"azimuth_zero_deg\":10,\"clock_hz\":0",
		"stage.clock_hz" },
	{ "\"clock_hz\":1000000,\"clock_bits\":32},", "\"clock_hz\":1000000,\"clock_bits\":0},",
		"stage.clock_bits" },
	/* The records' ticks have 32 bits: a clock of more would wrap unnoticed. */
	{ "\"clock_hz\":1000000,\"clock_bits\":32},", "\"clock_hz\":1000000,\"clock_bits\":33},",
		"stage.clock_bits" },
	{ STAGE ",", "", "stage.steps_per_turn" },
	{ "\"width\":720", "\"width\":20000", "camera.width" },
	{ "\"width\":720", "\"width\":721", "camera.width" },
	{ "\"width\":720", "\"width\":2", "camera.width" },
	{ "\"height\":1280", "\"height\":0", "camera.height" },
	{ "\"height\":1280", "\"height\":1281", "camera.height" },
	{ "\"fx\":500", "\"fx\":0", "camera.fx" },
	{ "\"fy\":510", "\"fy\":-510", "camera.fy" },
	{ "\"cx\":360", "\"cx\":1e9", "camera.cx" },
	{ "\"cy\":640,", "", "camera.cy" },
	{ "[0.1,0.2,0.3,0.4,0.5]", "[0.1,0.2,0.3,0.4]", "camera.distortion" },
	{ "[[1,0,0],[0,0,-1],[0,1,0]]", "[[1,0,0],[0,0,-1]]", "camera.rotation" },
	{ "[[1,0,0],[0,0,-1],[0,1,0]]", "[[1,0,0],[0,0,-1],[0,1]]", "camera.rotation" },
	{ "[[1,0,0],[0,0,-1],[0,1,0]]", "[[1,0,0],[0,0,-1],[0,\"1\",0]]", "camera.rotation" },
	{ "[[1,0,0],[0,0,-1],[0,1,0]]", "[[1,0,0],[0,0,-1],[0,{},0]]", "camera.rotation" },
	{ "[[1,0,0],[0,0,-1],[0,1,0]]", "[[1,0,0],[0,0,-1],1]", "camera.rotation" },
	{ "[[1,0,0],[0,0,-1],[0,1,0]]", "[[2,0,0],[0,0,-1],[0,1,0]]", "camera.rotation" },
	{ "[[1,0,0],[0,0,-1],[0,1,0]]", "[[1,0,0],[1,0,0],[1,0,0]]", "camera.rotation" },
	/* Its mirror image is no rotation. */
	{ "[[1,0,0],[0,0,-1],[0,1,0]]", "[[1,0,0],[0,0,1],[0,1,0]]", "camera.rotation" },
	{ "[0,0.05,0.07]", "[0,0.05,70]", "camera.translation_m" },
	{ "\"clock_bits\":32,\"readout_us\":5", "\"clock_bits\":64,\"readout_us\":5",
		"camera.clock_bits" },
	{ "\"readout_us\":5", "\"readout_us\":-5", "camera.readout_us" },
};

static char *replaced(const char *text, const char *piece, const char *by)
{
	const char *at = strstr(text, piece);
	g_assert_nonnull(at);
	return g_strdup_printf("%.*s%s%s", (int)(at - text), text, by, at + strlen(piece));
}

static void test_refusals(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(refusals); i++) {
		struct calibration c = { .serial = "before" };
		g_autoptr(GError) error = NULL;
		g_autofree char *text = replaced(WHOLE, refusals[i].piece, refusals[i].by);
		g_autofree char *key = g_strdup_printf("'%s'", refusals[i].key);
		bool taken = calibration_parse(text, "paper", &c, &error);
		g_test_message("%s -> %s: %s", refusals[i].piece, refusals[i].by,
			error ? error->message : "taken");
		g_assert_false(taken);
		g_assert_nonnull(error);
		g_assert_true(g_str_has_prefix(error->message, "paper: "));
		g_assert_nonnull(strstr(error->message, key));
		g_assert_cmpstr(c.serial, ==, "before");
	}
}

static void test_no_json(void)
{
	static const char *const texts[] = { "", "{", "[]", "null", "{\"serial\":\"A\"}" };
	for (size_t i = 0; i < G_N_ELEMENTS(texts); i++) {
		struct calibration c;
		g_autoptr(GError) error = NULL;
		g_assert_false(calibration_parse(texts[i], "paper", &c, &error));
		g_assert_nonnull(error);
		g_assert_nonnull(strstr(error->message, "paper"));
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(scenes); i++)
		g_test_add_data_func(scenes[i].path, &scenes[i], test_scene);
	g_test_add_func("/placement/geometry-changes", test_geometry_changes);
	g_test_add_func("/placement/sweep", test_sweep);
	g_test_add_func("/placement/usable", test_usable);
	g_test_add_func("/placement/suspect", test_suspect);
	g_test_add_func("/calibration/parse", test_parse);
	g_test_add_func("/calibration/refusals", test_refusals);
	g_test_add_func("/calibration/no-json", test_no_json);
	return g_test_run();
}
