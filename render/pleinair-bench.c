/* pleinair bench WHAT: measures speed, memory and truth. */
#include "acquire/bench-acquire.h"
#include "acquire/cli.h"
#include "acquire/preset.h"
#include "process/bench-export.h"
#include "process/bench-features.h"
#include "process/bench-lines.h"
#include "process/bench-model.h"
#include "process/bench-process.h"
#include "process/bench-register.h"
#include "process/bench-segments.h"
#include "render/bench-all.h"
#include "render/bench-coherence.h"
#include "render/bench-filters.h"
#include "render/bench-hatching.h"
#include "render/bench-paging.h"
#include "render/bench-render.h"
#include "render/bench-station.h"
#include "render/bench-styles.h"
#include <stdio.h>
#include <string.h>

#define COMMAND "bench"

static gboolean json;
/* 0: the default of each bench. */
static double seconds, million_points, memory_mib;
static int beams = 1081, repeats, trials = 1000, pairs_of_others = 3;
static gint64 seed = 1;
static int pairs = 8;
static char *backend, *site_folder, *preset, *keep, *folder, *size_text, *view_name, *output;
static char **style_list;

static const GOptionEntry entries[] = {
	{ "seconds", 0, 0, G_OPTION_ARG_DOUBLE, &seconds,
		"acquire: how long the lidar streams (default 60); paging: how long it flies (20)",
		"S" },
	{ "beams", 0, 0, G_OPTION_ARG_INT, &beams,
		"acquire: beams of the simulated lidar, 6 k + 1 (default 1081)", "N" },
	{ "site", 0, 0, G_OPTION_ARG_FILENAME, &site_folder,
		"process, segments, render, coherence, filters, styles, paging: a site (default: "
		"simulated)",
		"SITE" },
	{ "repeats", 0, 0, G_OPTION_ARG_INT, &repeats,
		"process, render, hatching, filters, styles: how often each is measured; the least "
		"time counts, of styles the median (default 5)",
		"N" },
	{ "preset", 0, 0, G_OPTION_ARG_STRING, &preset,
		"how finely is scanned (default fine; register, segments, features: standard)",
		"draft|standard|fine" },
	{ "trials", 0, 0, G_OPTION_ARG_INT, &trials, "register: pairs (default 1000)", "N" },
	{ "pairs-of-others", 0, 0, G_OPTION_ARG_INT, &pairs_of_others,
		"register: of the first pairs that overlap, so many are given to Open3D and PCL, "
		"too (default 3)",
		"N" },
	{ "seed", 0, 0, G_OPTION_ARG_INT64, &seed,
		"of simulated sites; another one gives others (default 1)", "S" },
	{ "keep", 0, 0, G_OPTION_ARG_FILENAME, &keep,
		"where simulated scans stay, and are taken from the next time", "FOLDER" },
	{ "size", 0, 0, G_OPTION_ARG_STRING, &size_text,
		"of pictures (default: render 1600x1200, coherence and styles 1920x1080, paging "
		"1280x800)",
		"WxH" },
	{ "style", 0, 0, G_OPTION_ARG_STRING_ARRAY, &style_list,
		"coherence, hatching, styles, paging: a style; may be given again but for paging "
		"(default: those of the paper's figures; of styles all; figure-7d)",
		"STYLE" },
	{ "view", 0, 0, G_OPTION_ARG_STRING, &view_name,
		"coherence: where the paths begin (default walk)", "VIEW" },
	{ "frames", 0, 0, G_OPTION_ARG_INT, &pairs,
		"coherence: pairs of neighbouring frames of each path, at most 39 (default 8)",
		"N" },
	{ "million-points", 0, 0, G_OPTION_ARG_DOUBLE, &million_points,
		"model, export: that the scanners measured; filters: at most in one scene; paging: "
		"of a site that is made (default 20); styles: of a town of such sites (default: "
		"one of them)",
		"N" },
	{ "memory", 0, 0, G_OPTION_ARG_DOUBLE, &memory_mib,
		"model: what building may keep in memory (default 1024); paging: what points may "
		"take "
		"(default: half of the machine's)",
		"MIB" },
	{ "folder", 0, 0, G_OPTION_ARG_FILENAME, &folder,
		"model, export: where the site is made, 150 bytes a point (default: of temporary "
		"files)",
		"FOLDER" },
	{ "backend", 0, 0, G_OPTION_ARG_STRING, &backend,
		"hatching, filters, styles, paging: what draws (default cpu; of styles auto)",
		"auto|cpu|gles" },
	{ "output", 'o', 0, G_OPTION_ARG_FILENAME, &output,
		"all: where bench.json and bench.html are written (default pleinair-bench)",
		"FOLDER" },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the figures as JSON", NULL },
	{ NULL },
};

static uint32_t repeats_wanted(void)
{
	return repeats ? (uint32_t)repeats : 5;
}

static bool bad_repeats(void)
{
	return repeats < 0 || repeats > 1000;
}

static double points_wanted(void)
{
	return million_points != 0 ? million_points : 20;
}

static int run_acquire(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_acquire_options options = {
		.seconds = seconds != 0 ? seconds : 60, .beams = (uint32_t)beams, .json = json
	};
	if (!(options.seconds >= 1 && options.seconds <= 3600) || beams < 100 || beams > 9000 ||
		beams % 6 != 1)
		return cli_misuse(
			COMMAND, "seconds go from 1 to 3600, beams from 103 to 8995 in steps of 6");
	return bench_acquire(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_process(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_process_options options = { .site = site_folder,
		.preset = preset,
		.seed = (uint64_t)seed,
		.keep = keep,
		.repeats = repeats_wanted(),
		.json = json };
	if (bad_repeats() || seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND, "repeats go from 1 to 1000, seeds from 0 to 1000000000");
	return bench_process(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_model(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_model_options options = { .million_points = points_wanted(),
		.memory_bytes = (uint64_t)((memory_mib != 0 ? memory_mib : 1024) * 1048576),
		.folder = folder,
		.json = json };
	if (!(options.million_points >= 1 && options.million_points <= 10000) ||
		options.memory_bytes < (uint64_t)64 << 20 || !(memory_mib <= 1e6))
		return cli_misuse(COMMAND,
			"million points go from 1 to 10000, MiB of memory from 64 to 1000000");
	return bench_model(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_export(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_export_options options = {
		.million_points = points_wanted(), .folder = folder, .json = json
	};
	if (!(options.million_points >= 1 && options.million_points <= 10000))
		return cli_misuse(COMMAND, "million points go from 1 to 10000");
	return bench_export(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static struct cli_bar bar;

static void show(double fraction, const char *doing)
{
	if (doing)
		cli_bar_update(&bar, fraction, doing);
	else
		cli_bar_end(&bar);
}

static int run_register(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_register_options options = { .trials = (uint32_t)trials,
		.seed = (uint64_t)seed,
		.preset = preset ? preset : "standard",
		.keep = keep,
		.pairs_of_others = (uint32_t)pairs_of_others,
		.json = json,
		.stop = cli_interrupted,
		.progress = show };
	if (trials < 1 || trials > 100000 || pairs_of_others < 0 || pairs_of_others > 100 ||
		seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND,
			"trials go from 1 to 100000, pairs of others from 0 to 100, seeds from 0 "
			"to 1000000000");
	cli_catch_interrupts();
	bar = cli_bar_begin(COMMAND);
	bool good = bench_register(&options, &error);
	cli_bar_end(&bar);
	return good ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_segments(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_segments_options options = { .site = site_folder,
		.preset = preset,
		.seed = (uint64_t)seed,
		.keep = keep,
		.json = json };
	if (seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND, "seeds go from 0 to 1000000000");
	return bench_segments(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_features(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_features_options options = {
		.seed = (uint64_t)seed, .preset = preset, .keep = keep, .json = json
	};
	if (seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND, "seeds go from 0 to 1000000000");
	return bench_features(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_lines(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_lines_options options = {
		.seed = (uint64_t)seed, .preset = preset, .keep = keep, .json = json
	};
	if (seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND, "seeds go from 0 to 1000000000");
	return bench_lines(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

/* ---- pictures ---- */

static bool read_size(const char *text, uint32_t *ret_width, uint32_t *ret_height)
{
	unsigned width, height;
	char rest;
	if (sscanf(text, "%5ux%5u%c", &width, &height, &rest) != 2 || width < 64 || height < 64 ||
		width > 8192 || height > 8192)
		return false;
	*ret_width = width;
	*ret_height = height;
	return true;
}

static struct bench_place_options place_options(void)
{
	return (struct bench_place_options){
		.site = site_folder, .preset = preset, .seed = (uint64_t)seed, .keep = keep
	};
}

static int run_render(void)
{
	g_autoptr(GError) error = NULL;
	enum backend_wish wish;
	if (!backend_wish_parse(backend ? backend : "auto", &wish, &error))
		return cli_misuse(COMMAND, "%s", error->message);
	struct bench_render_options options = { .place = place_options(),
		.repeats = repeats_wanted(),
		.cpu_only = wish == BACKEND_WISH_CPU,
		.json = json };
	if (!read_size(size_text ? size_text : "1600x1200", &options.width, &options.height) ||
		bad_repeats() || seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND,
			"sizes go from 64x64 to 8192x8192, repeats from 1 to 1000, seeds from 0 "
			"to 1000000000");
	return bench_render(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_coherence(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_coherence_options options = { .place = place_options(),
		.styles = style_list,
		.view = view_name,
		.pairs = (uint32_t)pairs,
		.json = json };
	if (!read_size(size_text ? size_text : "1920x1080", &options.width, &options.height) ||
		pairs < 1 || pairs > (int)BENCH_COHERENCE_PAIRS_MAX || seed < 0 ||
		seed > 1000000000)
		return cli_misuse(COMMAND,
			"sizes go from 64x64 to 8192x8192, frames from 1 to %u, seeds from 0 to "
			"1000000000",
			BENCH_COHERENCE_PAIRS_MAX);
	return bench_coherence(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_hatching(void)
{
	g_autoptr(GError) error = NULL;
	enum backend_wish wish;
	if (!backend_wish_parse(backend ? backend : "cpu", &wish, &error))
		return cli_misuse(COMMAND, "%s", error->message);
	struct bench_hatching_options options = {
		.repeats = repeats_wanted(), .backend = wish, .styles = style_list, .json = json
	};
	if (bad_repeats())
		return cli_misuse(COMMAND, "repeats go from 1 to 1000");
	return bench_hatching(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_filters(void)
{
	g_autoptr(GError) error = NULL;
	enum backend_wish wish;
	if (!backend_wish_parse(backend ? backend : "cpu", &wish, &error))
		return cli_misuse(COMMAND, "%s", error->message);
	struct bench_filters_options options = { .place = place_options(),
		.repeats = repeats_wanted(),
		.backend = wish,
		.million_points_most = points_wanted(),
		.json = json };
	if (bad_repeats() || seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND, "repeats go from 1 to 1000, seeds from 0 to 1000000000");
	return bench_filters(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_styles(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_styles_options options = { .place = place_options(),
		.million_points = million_points,
		.repeats = repeats_wanted(),
		.styles = style_list,
		.json = json };
	if (!backend_wish_parse(backend ? backend : "auto", &options.backend, &error))
		return cli_misuse(COMMAND, "%s", error->message);
	if (!read_size(size_text ? size_text : "1920x1080", &options.width, &options.height) ||
		bad_repeats() || !(million_points >= 0 && million_points <= 1000) || seed < 0 ||
		seed > 1000000000)
		return cli_misuse(COMMAND,
			"sizes go from 64x64 to 8192x8192, repeats from 1 to 1000, million points "
			"to 1000, seeds from 0 to 1000000000");
	return bench_styles(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_paging(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_paging_options options = { .place = place_options(),
		.million_points = points_wanted(),
		.memory_bytes = (uint64_t)(memory_mib * (1 << 20)),
		.seconds = seconds > 0 ? seconds : 20,
		.style = style_list ? style_list[0] : "figure-7d",
		.backend = backend ? backend : "cpu",
		.json = json };
	if (!read_size(size_text ? size_text : "1280x800", &options.width, &options.height) ||
		!(options.million_points >= 1 && options.million_points <= 10000) ||
		!(memory_mib >= 0 && memory_mib <= 1000000) || !(seconds >= 0 && seconds <= 3600) ||
		seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND,
			"sizes go from 64x64 to 8192x8192, million points from 1 to 10000, MiB of "
			"memory to 1000000, seconds to 3600, seeds from 0 to 1000000000");
	return bench_paging(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

/* ---- all ---- */

static int run_station(void)
{
	g_autoptr(GError) error = NULL;
	struct bench_station_options options = {
		.preset = preset, .seed = (uint64_t)seed, .keep = keep, .json = json
	};
	if (seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND, "seeds go from 0 to 1000000000");
	return bench_station(&options, &error) ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static int run_all(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL);
	struct bench_all_options options = { .program = self ? self : "pleinair-bench",
		.output = output ? output : "pleinair-bench",
		.site = site_folder,
		.keep = keep,
		.seed = (uint64_t)seed,
		.repeats = (uint32_t)repeats,
		.json = json,
		.stop = cli_interrupted,
		.progress = show };
	if (bad_repeats() || seed < 0 || seed > 1000000000)
		return cli_misuse(COMMAND, "repeats go from 1 to 1000, seeds from 0 to 1000000000");
	if (seconds != 0 || million_points != 0 || memory_mib != 0 || folder || preset ||
		size_text || view_name || style_list || backend)
		return cli_misuse(COMMAND,
			"of all benches only --seed, --repeats, --site, --keep, --output and "
			"--json "
			"can be told; the other options are those of one: name it");
	cli_catch_interrupts();
	bar = cli_bar_begin(COMMAND);
	bool good = bench_all(&options, &error);
	cli_bar_end(&bar);
	return good ? cli_done(COMMAND) : cli_fail(COMMAND, error);
}

static const struct part {
	const char *name;
	int (*run)(void);
} parts[] = {
	{ "all", run_all }, /* the one without a name given */
	{ "acquire", run_acquire },
	{ "station", run_station },
	{ "process", run_process },
	{ "register", run_register },
	{ "model", run_model },
	{ "export", run_export },
	{ "segments", run_segments },
	{ "features", run_features },
	{ "lines", run_lines },
	{ "render", run_render },
	{ "coherence", run_coherence },
	{ "hatching", run_hatching },
	{ "filters", run_filters },
	{ "styles", run_styles },
	{ "paging", run_paging },
	{ NULL },
};

static const struct part *find_part(const char *name)
{
	for (const struct part *p = parts; p->name; p++)
		if (!name || strcmp(p->name, name) == 0)
			return p;
	return NULL;
}

int main(int argc, char **argv)
{
	int status;
	if (!cli_parse(COMMAND,
		    "[all | acquire | station | process | register | model | export | segments | "
		    "features | lines "
		    "| render | coherence | hatching | filters | styles | paging]",
		    "Measures speed, memory and truth on this machine.",
		    "Without a name all of them, in about 20 minutes on two cores, with a page of "
		    "plots of what is to reach.\n"
		    "acquire: records a simulated lidar at its full rate in real time, and decodes "
		    "what was recorded.\n"
		    "station: how long it is from the last beam of a scan to a registered, styled "
		    "picture.\n"
		    "process: normals of a scan and fine alignment of two, beside those by PCL, "
		    "Open3D and CloudCompare.\n"
		    "register: aligns pairs of scans of simulated sites, and counts what was "
		    "found, refused, and accepted although wrong.\n"
		    "model: builds the model of a large site, then adds one more scan.\n"
		    "export: writes a large site in each format that is exported.\n"
		    "segments: tells apart what stands in simulated sites, or in one whose points "
		    "have classes, and counts what is right.\n"
		    "features: finds features in simulated scenes, and counts what was found and "
		    "what is none.\n"
		    "lines: links features into profile lines in simulated scenes, and counts what "
		    "they cover.\n"
		    "render: draws scenes as large as a paper's, and VTK does, where it is "
		    "installed.\n"
		    "coherence: how calm drawings are when the camera moves, and how dark.\n"
		    "hatching: draws closed things of as many points as two papers have, and tells "
		    "how long it takes.\n"
		    "filters: how long filters of pictures take, each alone and in whole frames as "
		    "two papers have them.\n"
		    "styles: frames of each style of a site as large as one likes.\n"
		    "paging: flies through a site that is larger than the memory it may take.\n",
		    entries, &argc, &argv, &status))
		return status;
	const struct part *part = argc > 2 ? NULL : find_part(argc == 2 ? argv[1] : NULL);
	if (!part)
		return cli_misuse(COMMAND,
			"there is no bench '%s': all, acquire, station, process, register, model, "
			"export, "
			"segments, "
			"features, lines, render, coherence, hatching, filters, styles, paging",
			argv[argc - 1]);
	if (preset && !preset_find(preset))
		return cli_misuse(
			COMMAND, "there is no preset '%s': draft, standard, fine", preset);
	return part->run();
}
