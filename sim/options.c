#include "sim/options.h"
#include "sim/fault.h"
#include "sim/world.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

struct option_row;
typedef bool (*option_parser)(const struct option_row *row, const char *text, void *ret_value);

struct option_row {
	const char *key;
	option_parser parse;
	gsize offset; /* into sim_options */
	double min, max;
	const char *wants; /* in place of "a number from MIN to MAX" */
	const char *help;
};

static bool parse_number(const struct option_row *row, const char *text, void *ret_value)
{
	char *end;
	double number = g_ascii_strtod(text, &end);

	if (end == text || *end != '\0' || !(number >= row->min && number <= row->max))
		return false;
	*(double *)ret_value = number;
	return true;
}

static bool parse_whole(const struct option_row *row, const char *text, void *ret_value)
{
	return g_ascii_string_to_unsigned(
		text, 10, (guint64)row->min, (guint64)row->max, (guint64 *)ret_value, NULL);
}

static bool parse_flag(const struct option_row *row, const char *text, void *ret_value)
{
	(void)row;
	*(bool *)ret_value = text[0] == '1';
	return (text[0] == '0' || text[0] == '1') && text[1] == '\0';
}

static bool parse_text(const struct option_row *row, const char *text, void *ret_value)
{
	(void)row;
	g_free(*(char **)ret_value);
	*(char **)ret_value = g_uri_unescape_string(text, NULL);
	return *(char **)ret_value && **(char **)ret_value;
}

/* Numbers with commas between, as many as the row's field has. */
static bool parse_numbers(const struct option_row *row, const char *text, void *ret_value, guint n)
{
	g_auto(GStrv) parts = g_strsplit(text, ",", -1);

	if (g_strv_length(parts) != n)
		return false;
	for (guint i = 0; i < n; i++)
		if (!parse_number(row, parts[i], (double *)ret_value + i))
			return false;
	return true;
}

static bool parse_two(const struct option_row *row, const char *text, void *ret_value)
{
	return parse_numbers(row, text, ret_value, 2);
}

static bool parse_three(const struct option_row *row, const char *text, void *ret_value)
{
	return parse_numbers(row, text, ret_value, 3);
}

static bool parse_speed(const struct option_row *row, const char *text, void *ret_value)
{
	if (strcmp(text, "max") != 0)
		return parse_number(row, text, ret_value);
	*(double *)ret_value = 0;
	return true;
}

static bool parse_lidar(const struct option_row *row, const char *text, void *ret_value)
{
	const struct lidar_make *make = lidar_make_find(text);

	(void)row;
	if (make)
		*(const struct lidar_make **)ret_value = make;
	return make;
}

static bool parse_format(const struct option_row *row, const char *text, void *ret_value)
{
	static const char *const names[] = { "make", "standard", "express", "ultra", "dense",
		"ultra-dense", "hq" };

	(void)row;
	for (gsize i = 1; i < G_N_ELEMENTS(names); i++)
		if (strcmp(text, names[i]) == 0) {
			*(enum sim_format *)ret_value = (enum sim_format)i;
			return true;
		}
	return false;
}

static bool parse_ares(const struct option_row *row, const char *text, void *ret_value)
{
	return parse_whole(row, text, ret_value) && *(uint64_t *)ret_value % 8 == 0;
}

static bool parse_beams(const struct option_row *row, const char *text, void *ret_value)
{
	return parse_whole(row, text, ret_value) && *(uint64_t *)ret_value % 270 == 1;
}

static bool parse_size(const struct option_row *row, const char *text, void *ret_value)
{
	uint32_t *size = ret_value;
	char *end;

	size[0] = size[1] = 0;
	if (strcmp(text, "none") == 0)
		return true;
	guint64 width = g_ascii_strtoull(text, &end, 10);

	if (*end != 'x')
		return false;
	guint64 height = g_ascii_strtoull(end + 1, &end, 10);

	size[0] = (uint32_t)width;
	size[1] = (uint32_t)height;
	return *end == '\0' && width % 2 == 0 && height % 2 == 0 &&
	       MIN(width, height) >= row->min && MAX(width, height) <= row->max;
}

#define AT(field) G_STRUCT_OFFSET(sim_options, field)
#define PPM       -1000, 1000, NULL
#define TICKS     0, 0xffffffff, NULL
static const struct option_row rows[] = {
	{ "seed", parse_whole, AT(seed), 0, 1e15, NULL, "of the world and of all chance (1)" },
	{ "station", parse_whole, AT(station), 1, 1000, NULL, "which tripod position (1)" },
	{ "moved", parse_whole, AT(moved), 0, 1e9, NULL,
		"people, cars and furniture stand elsewhere, where this number puts them (0)" },
	{ "symmetric", parse_flag, AT(symmetric), 0, 0, "0 or 1",
		"hall: half a turn about its middle changes nothing (0)" },
	{ "repeated", parse_flag, AT(repeated), 0, 0, "0 or 1",
		"street: the houses of a row, and what stands before them, are the same (0)" },
	{ "speed", parse_speed, AT(speed), 0.01, 1000, "max or a number from 0.01 to 1000",
		"times real time, or as fast as possible (max)" },
	{ "lidar", parse_lidar, AT(lidar), 0, 0, LIDAR_MAKES, "its make (scip)" },
	{ "ident", parse_text, AT(ident), 0, 0, "a name",
		"what a CoLa lidar says that it is (TiM571)" },
	{ "narrow", parse_flag, AT(narrow), 0, 0, "0 or 1",
		"a CoLa lidar has intensities of 8 bits alone (0)" },
	{ "format", parse_format, AT(format), 0, 0,
		"standard, express, ultra, dense, ultra-dense or hq",
		"in which an RPLIDAR measures (as its make)" },
	{ "health", parse_whole, AT(health), 0, 2, NULL,
		"of an RPLIDAR: 0 well, 1 a warning, 2 broken (0)" },
	{ "stuck", parse_flag, AT(stuck), 0, 0, "0 or 1",
		"the mirror of an ld or RPLIDAR does not turn (0)" },
	{ "baud", parse_whole, AT(baud), 0, 4000000, NULL,
		"of the line of an ld or RPLIDAR; 0 as its make (0)" },
	{ "ares", parse_ares, AT(ares), 80, 13328, "a multiple of 8 from 80 to 13328",
		"steps per turn of a SCIP lidar (3168)" },
	{ "beams", parse_beams, AT(beams), 271, 811, "271, 541 or 811",
		"beams over the 270 degrees of a CoLa lidar (811)" },
	{ "rate_hz", parse_number, AT(rate_hz), 1, 200, NULL,
		"turns of the mirror (scip 40, cola 15, ld06, ld19, stl27l and RPLIDARs 10, "
		"rplidar-a1 5.5)" },
	{ "limit_m", parse_number, AT(limit_m), 1, 200, NULL,
		"longest range (scip 200, cola 65, others as their make)" },
	{ "noise_mm", parse_number, AT(noise_mm), 0, 1000, NULL, "1 sigma of a range (12)" },
	{ "divergence_mrad", parse_number, AT(divergence_mrad), 0, 20, NULL,
		"full angle of the beam; 0 gives no mixed pixels (0.5)" },
	{ "dropouts", parse_flag, AT(dropouts), 0, 0, "0 or 1",
		"weak echoes are missed at times (1)" },
	{ "drift_ppm", parse_number, AT(drift_ppm), PPM, "of the lidar's clock (from the seed)" },
	{ "clock_start", parse_whole, AT(clock_start), TICKS,
		"first reading of the lidar's clock, ms or us (from the seed)" },
	{ "latency_ms", parse_number, AT(latency_ms), 0, 1000, NULL,
		"least delay of the cable (1)" },
	{ "jitter_ms", parse_number, AT(jitter_ms), 0, 1000, NULL,
		"mean of the delay on top, with rare spikes of a hundred times that (0.3)" },
	{ "packet", parse_whole, AT(packet), 0, 65536, NULL,
		"bytes that come together; 0 for whole telegrams (0)" },
	{ "steps_per_turn", parse_number, AT(steps_per_turn), 200, 1e6, NULL,
		"of the stage (11886)" },
	{ "home_deg", parse_number, AT(home_deg), 0, 360, NULL,
		"where the head stands at power-on, clockwise of home (from the seed)" },
	{ "backlash_steps", parse_number, AT(backlash_steps), 0, 1000, NULL, "of the gear (0)" },
	{ "stage_ppm", parse_number, AT(stage_ppm), PPM, "drift of its clock (from the seed)" },
	{ "stage_clock_start", parse_whole, AT(stage_clock_start), TICKS, "in us (from the seed)" },
	{ "camera", parse_size, AT(camera_width), 16, 4096,
		"WIDTHxHEIGHT, even, 16 to 4096, or none", "size of a frame (720x1280)" },
	{ "fps", parse_number, AT(fps), 0.1, 120, NULL, "exposures a second (10)" },
	{ "edge_rays", parse_whole, AT(edge_rays), 1, 64, NULL,
		"rays of a pixel where its neighbours differ (3, range 32)" },
	{ "distortion", parse_flag, AT(distortion), 0, 0, "0 or 1", "a real lens (1)" },
	{ "camera_ppm", parse_number, AT(camera_ppm), PPM, "drift of its clock (from the seed)" },
	{ "camera_clock_start", parse_whole, AT(camera_clock_start), TICKS,
		"in us (from the seed)" },
	{ "lidar_turn_deg", parse_three, AT(lidar_turn_deg), -10, 10, "X,Y,Z, each from -10 to 10",
		"the lidar sits turned about the head's axes (0,0,0)" },
	{ "lidar_shift_mm", parse_three, AT(lidar_shift_mm), -200, 200,
		"X,Y,Z, each from -200 to 200", "and shifted (0,0,0)" },
	{ "beam_zero_deg", parse_number, AT(beam_zero_deg), -10, 10, NULL,
		"its beams go higher by so much in front (0)" },
	{ "range_offset_mm", parse_number, AT(range_offset_mm), -200, 200, NULL,
		"ranges are longer than it says (0)" },
	{ "camera_turn_deg", parse_three, AT(camera_turn_deg), -10, 10,
		"X,Y,Z, each from -10 to 10", "the camera sits turned (0,0,0)" },
	{ "camera_shift_mm", parse_three, AT(camera_shift_mm), -200, 200,
		"X,Y,Z, each from -200 to 200", "and shifted (0,0,0)" },
	{ "focal_percent", parse_number, AT(focal_percent), -20, 20, NULL,
		"its focal length is longer (0)" },
	{ "centre_px", parse_two, AT(centre_px), -200, 200, "X,Y, each from -200 to 200",
		"the middle of its picture lies elsewhere (0,0)" },
	{ "home_azimuth_deg", parse_number, AT(home_azimuth_deg), -180, 180, NULL,
		"azimuth of the home slot (0)" },
	{ "certificate", parse_text, AT(certificate), 0, 0, "true or a file name",
		"what the head tells of itself: the truth, or what stands in a file (as drawn)" },
	{ "truth", parse_text, AT(truth), 0, 0, "a file name", "log the truth of each revolution" },
};

static const struct option_row *find_row(const char *key)
{
	for (gsize i = 0; i < G_N_ELEMENTS(rows); i++)
		if (strcmp(rows[i].key, key) == 0)
			return &rows[i];
	return NULL;
}

static bool refuse_value(
	const sim_options *o, const struct option_row *row, const char *text, GError **error)
{
	g_autofree char *range = g_strdup_printf("a%s number from %.10g to %.10g",
		row->parse == parse_whole ? " whole" : "", row->min, row->max);

	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, "sim:%s: %s=%s is not %s",
		o->scene, row->key, text, row->wants ? row->wants : range);
	return false;
}

static bool set_option(sim_options *o, const char *pair, GError **error)
{
	const char *equals = strchr(pair, '=');
	g_autofree char *key = equals ? g_strndup(pair, (gsize)(equals - pair)) : g_strdup(pair);

	if (equals && strcmp(key, "fault") == 0) {
		if (fault_parse(equals + 1, o->faults, error))
			return true;
		g_prefix_error(error, "sim:%s: ", o->scene);
		return false;
	}
	const struct option_row *row = find_row(key);

	if (!row || !equals) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			row ? "sim:%s: %s needs a value" : "sim:%s: there is no option %s",
			o->scene, key);
		return false;
	}
	return row->parse(row, equals + 1, G_STRUCT_MEMBER_P(o, row->offset)) ||
	       refuse_value(o, row, equals + 1, error);
}

static sim_options *options_new(const char *scene)
{
	sim_options *o = g_new0(sim_options, 1);

	*o = (sim_options){ .scene = g_strdup(scene),
		.seed = 1,
		.station = 1,
		.lidar = lidar_make_find("scip"),
		.ares = 3168,
		.beams = 811,
		.rate_hz = NAN,
		.limit_m = NAN,
		.noise_mm = 12,
		.divergence_mrad = 0.5,
		.dropouts = true,
		.drift_ppm = NAN,
		.clock_start = UINT64_MAX,
		.latency_ms = 1,
		.jitter_ms = 0.3,
		.steps_per_turn = 11886,
		.home_deg = NAN,
		.stage_ppm = NAN,
		.stage_clock_start = UINT64_MAX,
		.camera_width = 720,
		.camera_height = 1280,
		.fps = 10,
		.distortion = true,
		.camera_ppm = NAN,
		.camera_clock_start = UINT64_MAX,
		.faults = g_array_new(FALSE, FALSE, sizeof(struct fault)) };
	return o;
}

/* A serial lidar measures no faster than its line carries. */
static void fill_serial(sim_options *o)
{
	const struct lidar_make *make = o->lidar;

	if (o->baud == 0)
		o->baud = make->baud;
	if (o->format == SIM_AS_MADE)
		o->format = make->format;
	lidar_make_portion(make, o->format, (uint32_t)o->baud, &o->sample_us, &o->portion);
}

static void fill_what_depends(sim_options *o)
{
	if (isnan(o->rate_hz))
		o->rate_hz = o->lidar->rate_hz;
	/* Corners are found to a hundredth of a pixel, so an edge has to lie where a real sensor sees it. */
	if (o->edge_rays == 0)
		o->edge_rays = strcmp(o->scene, "range") == 0 ? 32 : 3;
	if (isnan(o->limit_m))
		o->limit_m = o->lidar->limit_m;
	if (o->lidar->baud)
		fill_serial(o);
}

static bool check_scene(const char *scene, GError **error)
{
	if (g_strv_contains(world_scene_names, scene))
		return true;
	g_autofree char *names = g_strjoinv(", ", (char **)world_scene_names);

	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
		"sim:%s: there is no such scene; there are %s", scene, names);
	return false;
}

sim_options *options_parse(const char *description, GError **error)
{
	g_auto(GStrv) halves = g_strsplit(description, "?", 2);
	g_autoptr(sim_options) o = options_new(halves[0] ? halves[0] : "");
	g_auto(GStrv) pairs = g_strsplit(halves[0] && halves[1] ? halves[1] : "", "&", -1);

	if (!check_scene(o->scene, error))
		return NULL;
	for (char **pair = pairs; *pair; pair++)
		if (**pair && !set_option(o, *pair, error))
			return NULL;
	fill_what_depends(o);
	return g_steal_pointer(&o);
}

void options_free(sim_options *o)
{
	if (!o)
		return;
	g_free(o->scene);
	g_free(o->ident);
	g_free(o->truth);
	g_free(o->certificate);
	g_array_unref(o->faults);
	g_free(o);
}

char *options_help(void)
{
	GString *text = g_string_new("Options of a description (defaults in brackets):\n");

	for (gsize i = 0; i < G_N_ELEMENTS(rows); i++)
		g_string_append_printf(text, "  %-20s %s\n", rows[i].key, rows[i].help);
	g_string_append(text,
		"  fault                what goes wrong where: KIND@COLUMN[xCOUNT][:PARAM],...\n");
	return g_string_free(text, FALSE);
}

struct world_variant options_variant(const sim_options *o)
{
	return (struct world_variant){ o->moved, o->symmetric, o->repeated };
}
