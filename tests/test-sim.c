/* The simulated head: its options, its link, the stage, the camera, and how near the truth it
 * measures. */
#include "sim/lens.h"
#include "sim/options.h"
#include "sim/rig.h"
#include "sim/stage.h"
#include "sim/truth.h"
#include <math.h>
#include <string.h>

#define PIECE "hall?home_deg=350&ares=360&camera=64x96&"

static truth *hall; /* seed 1, station 1 */

static struct rig *start(const char *description)
{
	struct rig *rig = rig_start(&(struct sim_head_options){
		.description = description, .world = truth_world(hall) });

	g_assert_false(rig->gone);
	return rig;
}

static void test_options(void)
{
	static const char *const rows[][2] = {
		{ "palace?seed=1", "sim:palace: there is no such scene; there are court, street, "
				   "bridge, hall, range" },
		{ "court?noise_mm=abc", "sim:court: noise_mm=abc is not a number from 0 to 1000" },
		{ "court?noise_mm=-1", "sim:court: noise_mm=-1 is not a number from 0 to 1000" },
		{ "court?seed=1.5", "sim:court: seed=1.5 is not a whole number from 0 to 1e+15" },
		{ "hall?nois_mm=1", "sim:hall: there is no option nois_mm" },
		{ "hall?seed", "sim:hall: seed needs a value" },
		{ "hall?lidar_turn_deg=1,2",
			"sim:hall: lidar_turn_deg=1,2 is not X,Y,Z, each from -10 to 10" },
		{ "hall?centre_px=1,999",
			"sim:hall: centre_px=1,999 is not X,Y, each from -200 to 200" },
		{ "hall?speed=fast",
			"sim:hall: speed=fast is not max or a number from 0.01 to 1000" },
		{ "hall?lidar=sick", "sim:hall: lidar=sick is not " LIDAR_MAKES },
		{ "hall?ares=100", "sim:hall: ares=100 is not a multiple of 8 from 80 to 13328" },
		{ "hall?beams=300", "sim:hall: beams=300 is not 271, 541 or 811" },
		{ "hall?camera=640",
			"sim:hall: camera=640 is not WIDTHxHEIGHT, even, 16 to 4096, or none" },
		{ "hall?dropouts=yes", "sim:hall: dropouts=yes is not 0 or 1" },
		{ "hall?fault=melt@3",
			"sim:hall: fault=melt@3 is not KIND@COLUMN with a kind that exists" },
		{ "hall?fault=drop",
			"sim:hall: fault=drop is not KIND@COLUMN with a kind that exists" },
		{ "hall?fault=drop@3000", "sim:hall: fault=drop@3000 has a column that is not a "
					  "number from 0 to 2999" },
		{ "hall?fault=drop@1x0", "sim:hall: fault=drop@1x0 has a count that is not a "
					 "number from 1 to 100000" },
		{ "hall?fault=stall@1:-2", "sim:hall: fault=stall@1:-2 has a value that is not a "
					   "number from 0.001 to 3600" },
		{ "hall?fault=power@1:2",
			"sim:hall: fault=power@1:2 ends in something that its kind does not take" },
	};

	for (gsize i = 0; i < G_N_ELEMENTS(rows); i++) {
		g_autoptr(GError) error = NULL;

		g_assert_null(options_parse(rows[i][0], &error));
		g_assert_nonnull(error);
		g_assert_cmpstr(error->message, ==, rows[i][1]);
	}
	g_autoptr(sim_options) o =
		options_parse("court?seed=7&camera=none&fault=drop@12x3,unplug@400", NULL);

	g_assert_cmpuint(o->seed, ==, 7);
	g_assert_cmpuint(o->camera_width, ==, 0);
	g_assert_cmpuint(o->faults->len, ==, 2);
	g_assert_cmpfloat(o->rate_hz, ==, 40);
}

static void test_refused(void)
{
	static const char *const rows[] = { "hall?x=1", "nowhere", "hall?station=999", "" };

	for (gsize i = 0; i < G_N_ELEMENTS(rows); i++) {
		struct rig *rig = rig_start(&(struct sim_head_options){ .description = rows[i] });

		rig_stop(rig);
		g_assert_true(rig->gone);
		g_assert_false(rig->good);
		g_assert_nonnull(rig->error);
		rig_free(rig);
	}
}

static void test_nonsense(void)
{
	static const uint32_t kinds[] = { 0, LINK_HELLO, 99, LINK_STAGE_MOVE,
		LINK_CAMERA_CONTROLS };

	for (gsize i = 0; i < G_N_ELEMENTS(kinds); i++) {
		struct rig *rig = start(PIECE);

		rig_send(rig, (enum link_kind)kinds[i], "abc", 3);
		g_assert_false(rig_wait(rig, 0));
		rig_stop(rig);
		g_assert_false(rig->good);
		rig_free(rig);
	}
}

static void test_certificate(void)
{
	struct rig *rig = start("hall?camera=none");

	g_assert_cmpuint(rig->hello.version, ==, LINK_VERSION);
	g_assert_cmpuint(rig->hello.real_time, ==, 0);
	g_assert_cmpstr(rig->hello.lidar_protocol, ==, "scip");
	g_assert_true(g_str_has_prefix(rig->certificate, "{\"serial\":\"SIM-hall-1\",\"lidar\":{"));
	g_assert_true(g_str_has_suffix(rig->certificate, ",\"camera\":null}"));
	rig_free(rig);
}

/* Nothing happens but while the host waits, and then nothing before its time. */
static void test_lockstep(void)
{
	struct rig *rig = start(PIECE "jitter_ms=0");
	int64_t begin_ns = rig->now_ns;

	g_assert_true(rig_wait(rig, begin_ns + 12345));
	g_assert_cmpint(rig->now_ns, ==, begin_ns + 12345);
	g_assert_true(rig_wait(rig, 0));
	g_assert_cmpint(rig->now_ns, ==, begin_ns + 12345);
	rig_send(rig, LINK_LIDAR_OPEN, NULL, 0);
	g_assert_true(rig_wait(rig, INT64_MAX));
	g_assert_cmpuint(rig->opened, ==, 1);
	g_assert_cmpint(rig->now_ns, <, begin_ns + 5000000);
	rig_say(rig, "MD0000027000000\n");
	g_assert_true(rig_wait(rig, INT64_MAX));
	g_assert_cmpstr(rig->lidar->str, ==, "MD0000027000000\n00P\n\n");
	for (int i = 0; i < 3; i++) {
		int64_t before_ns = rig->now_ns;

		g_assert_true(rig_wait(rig, INT64_MAX)); /* one scan at a time */
		g_assert_cmpuint(rig->deliveries, ==, 2 + i);
		g_assert_cmpint(rig->now_ns - before_ns, <=, 45000000);
	}
	rig_free(rig);
	rig = start("hall?camera=none");
	begin_ns = rig->now_ns;
	g_assert_true(rig_wait(rig, INT64_MAX)); /* nothing will ever come: an hour passes */
	g_assert_cmpint(rig->now_ns, ==, begin_ns + INT64_C(3600000000000));
	rig_send(rig, LINK_CAMERA_QUEUE, NULL, 0);
	rig_run(rig, 0.1);
	g_assert_cmpuint(rig->camera_gone, ==, 1);
	rig_free(rig);
}

static GByteArray *record(const char *description)
{
	struct rig *rig = start(description);

	g_assert_true(rig_open(rig));
	int64_t home = rig_home(rig);

	rig_say(rig, "ME0000027000000\n");
	rig_move(rig, home + 3000, 1000, 5000);
	for (int i = 0; i < 3; i++)
		rig_send(rig, LINK_CAMERA_QUEUE, NULL, 0);
	rig_run(rig, 1);
	GByteArray *all = g_byte_array_ref(rig->all);

	rig_free(rig);
	return all;
}

static void test_same_again(void)
{
	g_autoptr(GByteArray) a = record(PIECE "seed=1&fault=garble@100,slip@200");
	g_autoptr(GByteArray) b = record(PIECE "seed=1&fault=garble@100,slip@200");
	g_autoptr(GByteArray) other = record(PIECE "seed=1&noise_mm=13&fault=garble@100,slip@200");

	g_assert_cmpuint(a->len, >, 60000);
	g_assert_cmpmem(a->data, a->len, b->data, b->len);
	g_assert_true(a->len != other->len || memcmp(a->data, other->data, a->len) != 0);
}

static const struct link_stage_event *event_at(const GArray *events, guint i)
{
	return &g_array_index(events, struct link_stage_event, i);
}

/* From rest, pulse n is due at sqrt(2 n / a); at full rate, 1 / rate apart. */
static void test_stage_ramp(void)
{
	const double rate = 400, acceleration = 1000, steps = 500;
	const double ramp_steps = rate * rate / 2 / acceleration, ramp_s = rate / acceleration;
	struct rig *rig =
		start("hall?stage_ppm=0&stage_clock_start=4294900000&camera=none&home_deg=0.5");
	int64_t begin_ns = rig->now_ns;
	uint32_t begin_ticks = 4294900000u;
	double n = 0;

	rig_run(rig, 0.01);
	rig_move(rig, (int64_t)steps, rate, acceleration);
	rig_run(rig, 3);
	for (guint i = 0; i < rig->events->len; i++) {
		const struct link_stage_event *e = event_at(rig->events, i);
		double t = (uint32_t)(e->ticks_us - begin_ticks) * 1e-6 - 0.01, due;

		if (e->kind != LINK_STAGE_STEP)
			continue;
		g_assert_cmpint(e->direction, ==, 1);
		n++;
		if (n <= ramp_steps)
			due = sqrt(2 * n / acceleration);
		else if (n <= steps - ramp_steps)
			due = ramp_s + (n - ramp_steps) / rate;
		else
			due = 2 * ramp_s + (steps - 2 * ramp_steps) / rate -
			      sqrt(2 * (steps - n) / acceleration);
		g_assert_cmpfloat_with_epsilon(t, due, 1.5e-6);
	}
	g_assert_cmpfloat(n, ==, steps);
	g_assert_cmpint(event_at(rig->events, rig->events->len - 1)->kind, ==, LINK_STAGE_STOPPED);
	g_assert_cmpuint(rig_count(rig, LINK_STAGE_INDEX), ==, 1); /* 15 degrees are 495 steps */
	g_assert_cmpint(rig->now_ns - begin_ns, >=, INT64_C(3000000000));
	rig_free(rig);
}

/* Moves that replace moves, stops and turns: the count always ends at the whole step where the
 * stage stands. */
static void test_stage_turns(void)
{
	struct rig *rig = start(PIECE "backlash_steps=5");
	GRand *chance = g_rand_new_with_seed(3);
	int64_t target = 0, count = 0;

	for (int i = 0; i < 60; i++) {
		target = g_rand_int_range(chance, -1500, 1500);
		rig_move(rig, target, g_rand_double_range(chance, 10, 4000),
			g_rand_double_range(chance, 500, 30000));
		rig_run(rig, g_rand_double_range(chance, 0.001, 0.4));
		if (i % 7 == 0)
			rig_send(rig, LINK_STAGE_STOP, NULL, 0);
	}
	rig_move(rig, target, 2000, 20000);
	rig_run(rig, 3);
	uint32_t before = event_at(rig->events, 0)->ticks_us;

	for (guint i = 0; i < rig->events->len; i++) {
		const struct link_stage_event *e = event_at(rig->events, i);

		count += e->kind == LINK_STAGE_STEP ? e->direction : 0;
		g_assert_cmpint((int32_t)(e->ticks_us - before), >=, 0);
		before = e->ticks_us;
	}
	g_assert_cmpint(count, ==, target);
	g_assert_cmpint(event_at(rig->events, rig->events->len - 1)->kind, ==, LINK_STAGE_STOPPED);
	g_rand_free(chance);
	rig_free(rig);
}

/* Home and index slots stand where the certificate says, from both sides, and move when steps are
 * lost. */
static void test_stage_slots(void)
{
	struct rig *rig = start(PIECE "fault=slip@400:32,stagefault@1000");
	int64_t home = rig_home(rig), count = 0;
	int64_t passed[4] = { 0 };
	guint slots = 0;

	g_assert_cmpint(home, ==, 330); /* 10 degrees are 330.2 steps */
	g_assert_true(rig_open(rig));
	rig_say(rig, "MD0000027000000\n");
	rig_run(rig, 0.2);
	rig_move(rig, home + 8000, 1000, 20000);
	rig_run(rig, 6);
	g_assert_cmpuint(rig_count(rig, LINK_STAGE_FAULT), ==, 1);
	g_assert_cmpint(event_at(rig->events, rig->events->len - 1)->kind, ==, LINK_STAGE_FAULT);
	for (guint i = 0; i < rig->events->len && slots < 4; i++) {
		const struct link_stage_event *e = event_at(rig->events, i);

		count += e->kind == LINK_STAGE_STEP ? e->direction : 0;
		if (e->kind == LINK_STAGE_INDEX)
			passed[slots++] = count;
	}
	/* Slots are 495.25 steps apart; the slip came at 48 degrees, between the third and the
	 * fourth. */
	g_assert_cmpint(passed[1] - passed[0], >=, 495);
	g_assert_cmpint(passed[1] - passed[0], <=, 496);
	g_assert_cmpint(passed[3] - passed[2], >=, 527);
	g_assert_cmpint(passed[3] - passed[2], <=, 528);
	rig_free(rig);
}

static struct link_frame frame_at(const struct rig *rig, guint i)
{
	struct link_frame frame;

	memcpy(&frame, ((GByteArray *)g_ptr_array_index(rig->frames, i))->data, sizeof frame);
	return frame;
}

static double mean_luma(const struct rig *rig, guint i)
{
	const GByteArray *bytes = g_ptr_array_index(rig->frames, i);
	double sum = 0;

	for (guint k = 0; k < 64 * 96; k++)
		sum += bytes->data[sizeof(struct link_frame) + k];
	return sum / (64 * 96);
}

static void queue(struct rig *rig, int buffers, double seconds)
{
	for (int i = 0; i < buffers; i++)
		rig_send(rig, LINK_CAMERA_QUEUE, NULL, 0);
	rig_run(rig, seconds);
}

static void test_camera(void)
{
	struct rig *rig = start(PIECE "camera_ppm=0&camera_clock_start=4294967295");
	struct link_camera_controls dark = { 25, 50, 5500 };

	queue(rig, 2, 1.05);
	rig_send(rig, LINK_CAMERA_CONTROLS, &dark, sizeof dark);
	queue(rig, 1, 0.3);
	g_assert_cmpuint(rig->frames->len, ==, 3);
	g_assert_cmpuint(frame_at(rig, 0).sequence, ==, 0);
	g_assert_cmpuint(frame_at(rig, 1).sequence, ==, 1);
	g_assert_cmpuint(frame_at(rig, 2).sequence, >=, 10); /* those between had no buffer */
	g_assert_cmpuint(frame_at(rig, 2).ticks_us - frame_at(rig, 0).ticks_us, ==,
		frame_at(rig, 2).sequence * 100000);
	g_assert_cmpuint(frame_at(rig, 2).exposure_100us, ==, 25);
	g_assert_cmpfloat(mean_luma(rig, 0), >, 30);
	g_assert_cmpfloat(mean_luma(rig, 2) - 16, <, 0.7 * (mean_luma(rig, 0) - 16));
	int64_t stamp_ns = INT64_C(1000000000000) +
			   (int64_t)(uint32_t)(frame_at(rig, 0).ticks_us - 4294967295u) * 1000;
	int64_t delay_ns = g_array_index(rig->frame_ns, int64_t, 0) - stamp_ns;

	g_assert_cmpint(delay_ns, >=, 34999000); /* 5 ms of exposure, 30 ms of transfer */
	g_assert_cmpint(delay_ns, <=, 35001000);
	rig_free(rig);
}

static void test_camera_faults(void)
{
	struct rig *rig = start(PIECE "fault=badframe@100x1,frameloss@300:3,cameragone@600");
	int64_t home = rig_home(rig);
	guint bad = 0, lost = 0;

	queue(rig, 60, 0.2);
	rig_move(rig, home + 5000, 1000, 20000);
	queue(rig, 1, 4);
	g_assert_cmpuint(rig->camera_gone, ==, 1);
	g_assert_cmpuint(rig->frames->len, >, 15);
	g_assert_cmpuint(rig->frames->len, <, 30);
	for (guint i = 0; i < rig->frames->len; i++) {
		bad += frame_at(rig, i).flags & LINK_FRAME_ERROR ? 1 : 0;
		lost += i > 0 ? frame_at(rig, i).sequence - frame_at(rig, i - 1).sequence - 1 : 0;
	}
	g_assert_cmpuint(bad, ==, 1);
	g_assert_cmpuint(lost, ==, 3);
	rig_free(rig);
}

static void test_lens(void)
{
	const struct lens lens = lens_for_size(720, 1280, 1);

	for (int v = 0; v < 1280; v += 213)
		for (int u = 0; u < 720; u += 119) {
			double d[3];

			lens_ray(&lens, u, v, d);
			double x = d[0] / d[2], y = d[1] / d[2], r2 = x * x + y * y;
			double grows = 1 + lens.k1 * r2 + lens.k2 * r2 * r2; /* OpenCV's model */

			g_assert_cmpfloat_with_epsilon(
				lens.focal_px * x * grows + lens.cx, u, 1e-9);
			g_assert_cmpfloat_with_epsilon(
				lens.focal_px * y * grows + lens.cy, v, 1e-9);
			g_assert_cmpfloat_with_epsilon(
				d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1, 1e-12);
		}
}

static double srgb(double linear)
{
	double x = CLAMP(linear, 0, 1);

	return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
}

/* The luma that a pixel should have, from where the camera sits and looks: 45 mm before and 70 mm
 * above the centre, 5 degrees up. */
static double expected_luma(double azimuth, double u, double v)
{
	const struct world_station *station = truth_station(hall);
	const struct lens lens = lens_for_size(64, 96, 0);
	double pitch = 5 * M_PI / 180, x = (u - lens.cx) / lens.focal_px,
	       y = (lens.cy - v) / lens.focal_px;
	double front = cos(pitch) - y * sin(pitch), up = sin(pitch) + y * cos(pitch);
	double norm = sqrt(1 + x * x + y * y), origin[3], direction[3];
	double looks[3] = { x * cos(azimuth) + front * sin(azimuth),
		-x * sin(azimuth) + front * cos(azimuth), up };
	double sits[3] = { 0.045 * sin(azimuth), 0.045 * cos(azimuth), 0.07 };
	float rgb[3];

	for (int i = 0; i < 3; i++) {
		origin[i] = station->position_m[i];
		direction[i] = 0;
		for (int k = 0; k < 3; k++) {
			origin[i] += station->rotation[i][k] * sits[k];
			direction[i] += station->rotation[i][k] * looks[k] / norm;
		}
	}
	world_radiance(truth_world(hall), origin, direction, 1, rgb);
	return 16 + 65.481 * srgb(rgb[0]) + 128.553 * srgb(rgb[1]) + 24.966 * srgb(rgb[2]);
}

static void test_camera_looks(void)
{
	struct rig *rig = start("hall?home_deg=77&camera=64x96&distortion=0");
	guint right = 0, pixels = 0;

	queue(rig, 1, 0.3);
	g_assert_cmpuint(rig->frames->len, ==, 1);
	const guint8 *luma =
		((GByteArray *)g_ptr_array_index(rig->frames, 0))->data + sizeof(struct link_frame);

	for (int v = 0; v < 96; v += 5)
		for (int u = 0; u < 64; u += 5, pixels++)
			right += fabs(luma[64 * v + u] - expected_luma(77 * M_PI / 180, u, v)) < 8;
	g_assert_cmpuint(
		right, >=, pixels * 95 / 100); /* at an edge, rounding decides what is seen */
	rig_free(rig);
}

/* Collects what the lidar should have read, next to what it said. */
struct survey {
	struct rig *rig;
	GArray *azimuth, *range; /* double, revolution by revolution */
	guint beams;
};

static void keep_truth(const struct sim_truth_revolution *r, gpointer user_data)
{
	struct survey *survey = user_data;

	survey->beams = r->beams;
	g_array_append_vals(survey->azimuth, r->azimuth_rad, r->beams);
	g_array_append_vals(survey->range, r->range_m, r->beams);
}

static double at(const GArray *values, guint i)
{
	return g_array_index(values, double, i);
}

/* On a plane, the inverse range is a sine of the angle: so neighbours tell whether a beam meets a
 * flat surface. */
static bool is_flat(const struct survey *s, guint i, double step_rad)
{
	double before = at(s->range, i - 1), here = at(s->range, i), after = at(s->range, i + 1);
	bool inside = i % s->beams > 0 && i % s->beams < s->beams - 1;

	if (!inside || before <= 0 || here <= 0 || after <= 0 || here > 20)
		return false;
	return fabs(here / before + here / after - 2 * cos(step_rad)) < 1e-7;
}

static void decode_ranges(const struct survey *s, GArray *ranges)
{
	g_auto(GStrv) lines = g_strsplit(s->rig->lidar->str, "\n", -1);
	g_autoptr(GString) data = g_string_new(NULL);

	for (char **line = lines; *line; line++) {
		if (strcmp(*line, "99b") != 0)
			continue;
		for (line += 2; **line; line++)
			g_string_append_len(data, *line, (gssize)strlen(*line) - 1);
	}
	for (gsize i = 0; i + 3 <= data->len; i += 3) {
		double mm = 0;

		for (int k = 0; k < 3; k++)
			mm = 64 * mm + (data->str[i + k] - 0x30);
		g_array_append_val(ranges, mm);
	}
}

/* Beams that are five sigma off have met an edge, and are counted. */
static void compare(const struct survey *s, double *ret_mean_mm, double *ret_sigma_mm,
	guint *ret_count, guint *ret_edges)
{
	g_autoptr(GArray) said = g_array_new(FALSE, FALSE, sizeof(double));
	double sum = 0, squares = 0;
	guint count = 0;

	decode_ranges(s, said);
	g_assert_cmpuint(said->len, ==, s->range->len);
	for (guint i = 1; i + 1 < said->len; i++) {
		double error = at(said, i) - 1000 * at(s->range, i);

		if (at(said, i) < 23 || !is_flat(s, i, 2 * M_PI / 1440))
			continue;
		if (fabs(error) > 60) {
			++*ret_edges;
			continue;
		}
		count++;
		sum += error;
		squares += error * error;
	}
	*ret_mean_mm = sum / count;
	*ret_sigma_mm = sqrt(squares / count - *ret_mean_mm * *ret_mean_mm);
	*ret_count = count;
}

static void test_ranges(void)
{
	struct survey s = { .azimuth = g_array_new(FALSE, FALSE, sizeof(double)),
		.range = g_array_new(FALSE, FALSE, sizeof(double)) };
	double mean_mm, sigma_mm;
	guint count, edges = 0, compared = 0;

	s.rig = rig_start(&(struct sim_head_options){
		.description = "hall?home_deg=350&ares=1440&jitter_ms=0&noise_mm=12&camera=none",
		.world = truth_world(hall),
		.truth = keep_truth,
		.truth_data = &s });
	g_assert_true(rig_open(s.rig));
	rig_move(s.rig, 6300, 1200, 20000);
	rig_say(s.rig, "MD0000108000000\n");
	rig_run(s.rig, 5);
	rig_say(s.rig, "QT\n");
	rig_run(s.rig, 0.1);
	rig_stop(s.rig);
	compare(&s, &mean_mm, &sigma_mm, &count, &edges);
	g_test_message(
		"%u flat beams: mean error %.3f mm, sigma %.3f mm", count, mean_mm, sigma_mm);
	g_assert_cmpuint(count, >, 50000);
	g_assert_cmpfloat(fabs(mean_mm), <, 0.3);
	g_assert_cmpfloat(fabs(sigma_mm / 12 - 1), <, 0.05);
	/* The log agrees with the truth for any direction: beam 0 looks 45 degrees below the front.
	 */
	for (guint i = 0; i < s.range->len; i += s.beams / 7) {
		double elevation = (i % s.beams) * 2 * M_PI / 1440 - M_PI / 4;
		struct truth_cell cell = truth_look(hall, at(s.azimuth, i), elevation);

		if (cell.optics != WORLD_DIFFUSE)
			continue;
		g_assert_cmpfloat_with_epsilon(
			cell.range_m, at(s.range, i), 1e-5 * (1 + cell.range_m));
		compared++;
	}
	g_assert_cmpuint(compared, >, 100);
	rig_free(s.rig);
	g_array_unref(s.azimuth);
	g_array_unref(s.range);
}

/* In real time, host_ns is the clock and a scan comes when it is due. */
static void test_real_time(void)
{
	struct rig *rig = start("hall?speed=1&ares=1440&jitter_ms=0&camera=none");
	int64_t begin_ns = g_get_monotonic_time() * 1000;

	g_assert_cmpuint(rig->hello.real_time, ==, 1);
	g_assert_cmpint(ABS(rig->now_ns - begin_ns), <, INT64_C(2000000000));
	g_assert_true(rig_open(rig));
	rig_say(rig, "MD0000108001000\n");
	rig_run(rig, 0.4);
	g_assert_cmpuint(rig->deliveries, >=, 10); /* 16, on a machine with nothing else to do */
	g_assert_cmpint(g_get_monotonic_time() * 1000 - rig->lidar_ns, <, INT64_C(500000000));
	rig_free(rig);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_autoptr(truth) t = truth_new("hall", NULL);

	hall = t;
	g_test_add_func("/sim/options", test_options);
	g_test_add_func("/sim/refused", test_refused);
	g_test_add_func("/sim/nonsense", test_nonsense);
	g_test_add_func("/sim/certificate", test_certificate);
	g_test_add_func("/sim/lockstep", test_lockstep);
	g_test_add_func("/sim/same-again", test_same_again);
	g_test_add_func("/sim/stage/ramp", test_stage_ramp);
	g_test_add_func("/sim/stage/turns", test_stage_turns);
	g_test_add_func("/sim/stage/slots", test_stage_slots);
	g_test_add_func("/sim/camera/frames", test_camera);
	g_test_add_func("/sim/camera/looks", test_camera_looks);
	g_test_add_func("/sim/camera/faults", test_camera_faults);
	g_test_add_func("/sim/lens", test_lens);
	g_test_add_func("/sim/ranges", test_ranges);
	g_test_add_func("/sim/real-time", test_real_time);
	return g_test_run();
}
