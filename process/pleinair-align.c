/* pleinair align SITE A B: a pair of scans from picked pairs or by itself, and what people decide about it. */
#include "acquire/cli.h"
#include "process/align-scans.h"
#include "process/edge-json.h"
#include "process/pick-file.h"
#include "process/scan-moves.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define COMMAND       "align"
#define HISTORY_SHOWN 20

static char *pairs_path;
static gboolean accept_it, refuse_it, undo, list, json;

static const GOptionEntry entries[] = {
	{ "pairs", 'p', 0, G_OPTION_ARG_FILENAME, &pairs_path,
		"Begin with the picked pairs of points in this file", "FILE" },
	{ "accept", 0, 0, G_OPTION_ARG_NONE, &accept_it,
		"The pair is right, whatever the verdict: you vouch for it", NULL },
	{ "refuse", 0, 0, G_OPTION_ARG_NONE, &refuse_it, "The pair is wrong, whatever the verdict",
		NULL },
	{ "undo", 0, 0, G_OPTION_ARG_NONE, &undo, "Take the last change back", NULL },
	{ "list", 0, 0, G_OPTION_ARG_NONE, &list, "Show all pairs and the last changes", NULL },
	{ "json", 0, 0, G_OPTION_ARG_NONE, &json, "Print the result as JSON", NULL },
	{ NULL },
};

struct aligning {
	site *site;
	scan_graph *graph;
	GArray *given;  /* of struct scan_given */
	GArray *before; /* of struct placed_scan: where the scans stood */
	uint32_t a, b;  /* as they were typed */
	struct cli_bar bar;
	JsonObject *told; /* with --json */
};

typedef struct aligning aligning;
static void aligning_clear(struct aligning *w)
{
	g_clear_pointer(&w->given, g_array_unref);
	g_clear_pointer(&w->before, g_array_unref);
	scan_graph_free(w->graph);
	site_free(w->site);
	g_clear_pointer(&w->told, json_object_unref);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(aligning, aligning_clear)

/* A line on stdout; with --json nothing. */
static void say(const char *format, ...) G_GNUC_PRINTF(1, 2);
static void say(const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	if (!json) {
		vprintf(format, arguments);
		putchar('\n');
	}
	va_end(arguments);
}

/* ---- what changed ---- */

static void say_edge(const struct edge *e)
{
	static const char *const origins[] = {
		[EDGE_AUTOMATIC] = "automatic", [EDGE_PICKED] = "picked", [EDGE_GIVEN] = "given"
	};
	const struct verification *v = &e->verification;
	g_autofree char *figures =
		g_strdup_printf("overlap %.0f %%, rms %.1f mm, %.0f %% under 6 mm",
			100 * v->overlap, 1000 * v->rms_m, 100 * v->under_6mm);
	bool off = e->loop_m > 5e-5 || e->loop_rad > 5e-6;
	g_autofree char *loop = g_strdup_printf("; %.1f mm and %.3f degrees from its loops",
		1000 * e->loop_m, e->loop_rad * 180 / G_PI);
	say("scans %u and %u: %s (%s); %s%s", e->a, e->b, edge_standing(e), origins[e->origin],
		figures, off ? loop : "");
	if (v->reason[0])
		say("  %s: %s", verdict_names[v->verdict], v->reason);
}

static void tell_change(struct aligning *w)
{
	g_autoptr(GArray) moves = scan_moves(w->before, w->graph->scans);
	guint placed = scan_moves_count_placed(w->graph->scans);
	for (guint i = 0; i < moves->len; i++) {
		g_autofree char *text = scan_move_text(&g_array_index(moves, struct scan_move, i));
		say("%s", text);
	}
	if (!moves->len)
		say("no scan moved");
	say("revision %u: %s; %u of %u scans are placed", w->graph->revision, w->graph->change,
		placed, w->given->len);
	json_object_set_int_member(w->told, "revision", w->graph->revision);
	json_object_set_string_member(w->told, "change", w->graph->change);
	json_object_set_array_member(w->told, "moves", scan_moves_json(moves));
	json_object_set_int_member(w->told, "placed", placed);
	json_object_set_int_member(w->told, "scans", w->given->len);
}

static bool save(struct aligning *w, const char *change, GError **error)
{
	scan_graph_solve(
		w->graph, (const struct scan_given *)(void *)w->given->data, w->given->len);
	return scan_graph_save(w->graph, w->site, change, error);
}

/* Saves, tells, and says in one sentence when the pair is not used. Returns the exit status. */
static int finish(struct aligning *w, const char *change, GError **error)
{
	if (!save(w, change, error))
		return CLI_FAILED;
	const struct edge *e = scan_graph_edge(w->graph, w->a, w->b);
	say_edge(e);
	tell_change(w);
	json_object_set_object_member(w->told, "edge", edge_json(e));
	if (edge_is_used(e) || e->decision == DECISION_REFUSED)
		return CLI_DONE;
	if (e->outlier)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED,
			"scans %u and %u: the pair contradicts the loops that it closes", e->a,
			e->b);
	else
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED,
			"scans %u and %u: refused (%s): %s", e->a, e->b,
			verdict_names[e->verification.verdict], e->verification.reason);
	return CLI_FAILED;
}

/* ---- picked pairs ---- */

static void tell_pairs(struct aligning *w, const GArray *pairs, const struct picks_fit *fit)
{
	JsonArray *array = json_array_new();
	for (guint i = 0; i < pairs->len; i++) {
		const struct picked_pair *p = &g_array_index(pairs, struct picked_pair, i);
		double mm = 1000 * fit->residual_m[i];
		say("pair %u (line %u): %.1f mm%s", i + 1, p->line, mm,
			fit->blunder[i] ? ": does not fit the others, left out" : "");
		JsonObject *o = json_object_new();
		json_object_set_int_member(o, "line", p->line);
		json_object_set_double_member(o, "residual_mm", mm);
		json_object_set_boolean_member(o, "blunder", fit->blunder[i]);
		json_array_add_object_element(array, o);
	}
	say("%zu of %u pairs fit to %.1f mm (rms)", pairs->len - fit->blunders, pairs->len,
		1000 * fit->rms_m);
	json_object_set_array_member(w->told, "pairs", array);
	json_object_set_double_member(w->told, "pairs_rms_mm", 1000 * fit->rms_m);
}

/* The pose that the pairs tell: takes the scan with the higher number to the other. */
static bool fit_pairs(struct aligning *w, const GArray *pairs, const scan_data *low,
	const scan_data *high, struct pose *ret, guint *ret_pairs, GError **error)
{
	struct picks_fit fit;
	g_autofree struct pick *pick = g_new(struct pick, pairs->len + 1);
	bool swapped = w->a > w->b;
	if (!pick_file_resolve(
		    pairs_path, pairs, swapped ? high : low, swapped ? low : high, pick, error))
		return false;
	if (!picks_fit(pick, pairs->len, &fit, error)) {
		g_prefix_error(error, "%s: ", pairs_path);
		return false;
	}
	*ret = swapped ? pose_inverse(&fit.pose) : fit.pose;
	*ret_pairs = (guint)(pairs->len - fit.blunders);
	tell_pairs(w, pairs, &fit);
	picks_fit_clear(&fit);
	return true;
}

/* ---- aligning ---- */

static bool step_on(struct aligning *w, double fraction, const char *doing, GError **error)
{
	cli_bar_update(&w->bar, fraction, doing);
	if (!cli_interrupted())
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped; nothing was changed");
	return false;
}

/* Both scans ready for aligning, and where to begin. */
struct ready {
	align_scan *low, *high;
	bool has_start;
	struct pose start;
	guint pairs;
};

typedef struct ready ready;
static void ready_clear(struct ready *r)
{
	align_scan_free(r->low);
	align_scan_free(r->high);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(ready, ready_clear)

static gpointer make_one(gpointer data)
{
	return align_scan_new(data, NULL);
}

/* Both at once. They were loaded with their points, so nothing is refused. */
static void make_both(scan_data *low, scan_data *high, struct ready *ret)
{
	GThread *other = g_thread_new("align", make_one, high);
	ret->low = make_one(low);
	ret->high = g_thread_join(other);
}

static bool prepare(struct aligning *w, struct ready *ret, GError **error)
{
	g_autoptr(scan_data) low = NULL;
	g_autoptr(scan_data) high = NULL;
	g_autoptr(GArray) pairs = pairs_path ? pick_file_read(pairs_path, error) : NULL;
	if (pairs_path && !pairs)
		return false;
	if (!step_on(w, 0, "reading", error) ||
		!(low = scan_data_load(w->site, MIN(w->a, w->b), error)) ||
		!(high = scan_data_load(w->site, MAX(w->a, w->b), error)))
		return false;
	ret->has_start = pairs != NULL;
	if (pairs && !fit_pairs(w, pairs, low, high, &ret->start, &ret->pairs, error))
		return false;
	if (!step_on(w, 0.2, "preparing", error))
		return false;
	make_both(low, high, ret);
	return step_on(w, 0.5, "aligning", error);
}

static char *describe(const struct edge *e, const struct ready *r)
{
	const char *standing = e->decision == DECISION_ACCEPTED              ? "accepted by hand"
			       : e->verification.verdict == VERDICT_ACCEPTED ? "accepted"
									     : "refused";
	if (!r->has_start)
		return g_strdup_printf("scans %u and %u aligned, %s", e->a, e->b, standing);
	return g_strdup_printf(
		"scans %u and %u aligned from %u picked pairs, %s", e->a, e->b, r->pairs, standing);
}

static void tell_refinement(struct aligning *w, const struct ready *r, const struct edge *e)
{
	if (!r->has_start)
		return;
	struct pose d = pose_between(&r->start, &e->pose);
	double mm = 1000 * pose_distance_m(&d), deg = pose_angle_rad(&d) * 180 / G_PI;
	say("refined by %.1f mm and %.3f degrees", mm, deg);
	json_object_set_double_member(w->told, "refined_mm", mm);
	json_object_set_double_member(w->told, "refined_deg", deg);
}

static bool align(struct aligning *w, struct ready *r, struct edge *ret, GError **error)
{
	w->bar = cli_bar_begin(COMMAND);
	bool good = prepare(w, r, error) &&
		    align_scans(r->low, r->high, r->has_start ? &r->start : NULL,
			    r->has_start ? EDGE_PICKED : EDGE_AUTOMATIC, ret, error);
	cli_bar_end(&w->bar);
	if (good && cli_interrupted()) {
		edge_clear(ret);
		good = step_on(w, 1, "", error);
	}
	return good;
}

static int align_pair(struct aligning *w, GError **error)
{
	g_auto(ready) r = { 0 };
	struct edge e;
	if (!align(w, &r, &e, error))
		return CLI_FAILED;
	e.decision = accept_it ? DECISION_ACCEPTED : DECISION_NONE;
	tell_refinement(w, &r, &e);
	scan_graph_set_edge(w->graph, &e);
	g_autofree char *change = describe(&e, &r);
	return finish(w, change, error);
}

/* ---- decisions ---- */

static int decide(struct aligning *w, GError **error)
{
	struct edge *e = scan_graph_edge(w->graph, w->a, w->b);
	uint32_t low = MIN(w->a, w->b), high = MAX(w->a, w->b);
	if (!e) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"scans %u and %u have not been aligned yet; pleinair align %s %u %u does "
			"that",
			low, high, site_path(w->site), low, high);
		return CLI_FAILED;
	}
	if (accept_it && e->verification.verdict == VERDICT_NO_SOLUTION &&
		e->origin == EDGE_AUTOMATIC) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"scans %u and %u: no pose was found that could be accepted; --pairs tells "
			"one",
			low, high);
		return CLI_FAILED;
	}
	e->decision = accept_it ? DECISION_ACCEPTED : DECISION_REFUSED;
	g_autofree char *change = g_strdup_printf("pair of scans %u and %u %s by hand", low, high,
		accept_it ? "accepted" : "refused");
	return finish(w, change, error);
}

static int undo_last(struct aligning *w, GError **error)
{
	scan_graph *g = scan_graph_undo(w->site, error);
	if (!g)
		return CLI_FAILED;
	scan_graph_free(w->graph);
	w->graph = g;
	tell_change(w);
	return CLI_DONE;
}

/* ---- the list ---- */

/* Of one that is damaged or gone nothing is told. */
static void add_revision(const site *s, uint32_t number, JsonArray *history)
{
	g_autofree char *name = g_strdup_printf("%04u.json", number);
	g_autofree char *path = g_build_filename(site_path(s), "poses", name, NULL);
	g_autoptr(scan_graph) g = scan_graph_load_file(path, NULL);
	if (!g)
		return;
	say("revision %u, from %u, %s: %s", g->revision, g->parent, g->time, g->change);
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "revision", g->revision);
	json_object_set_int_member(o, "parent", g->parent);
	json_object_set_string_member(o, "time", g->time);
	json_object_set_string_member(o, "change", g->change);
	json_array_add_object_element(history, o);
}

static int show_list(struct aligning *w)
{
	JsonArray *edges = json_array_new(), *history = json_array_new();
	guint placed = scan_moves_count_placed(w->graph->scans);
	for (guint i = 0; i < w->graph->edges->len; i++) {
		const struct edge *e = &g_array_index(w->graph->edges, struct edge, i);
		say_edge(e);
		json_array_add_object_element(edges, edge_json(e));
	}
	say("%u pairs; %u of %u scans are placed", w->graph->edges->len, placed, w->given->len);
	for (uint32_t i = 0; i < HISTORY_SHOWN && i < w->graph->revision; i++)
		add_revision(w->site, w->graph->revision - i, history);
	json_object_set_int_member(w->told, "revision", w->graph->revision);
	json_object_set_string_member(w->told, "change", w->graph->change ? w->graph->change : "");
	json_object_set_int_member(w->told, "placed", placed);
	json_object_set_int_member(w->told, "scans", w->given->len);
	json_object_set_array_member(w->told, "edges", edges);
	json_object_set_array_member(w->told, "history", history);
	return CLI_DONE;
}

/* ---- the command ---- */

static bool has_scan(const struct aligning *w, uint32_t number, GError **error)
{
	for (guint i = 0; i < w->given->len; i++)
		if (g_array_index(w->given, struct scan_given, i).number == number)
			return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "%s: there is no scan %u",
		site_path(w->site), number);
	return false;
}

static bool begin(struct aligning *w, const char *path, GError **error)
{
	w->site = list ? site_open(path, error) : site_open_existing(path, error);
	if (!w->site || !(w->graph = scan_graph_load(w->site, error)) ||
		!(w->given = scan_graph_given(w->site, error)))
		return false;
	w->before = g_array_copy(w->graph->scans);
	w->told = json_object_new();
	return list || undo || (has_scan(w, w->a, error) && has_scan(w, w->b, error));
}

static int run(struct aligning *w, GError **error)
{
	if (list)
		return show_list(w);
	if (undo)
		return undo_last(w, error);
	if ((accept_it && !pairs_path) || refuse_it)
		return decide(w, error);
	return align_pair(w, error);
}

static bool parse_number(const char *text, uint32_t *ret)
{
	guint64 value;
	if (!g_ascii_string_to_unsigned(text, 10, 1, SITE_SCANS_MAX, &value, NULL))
		return false;
	*ret = (uint32_t)value;
	return true;
}

/* Returns CLI_DONE, or says what is wrong. */
static int check_usage(int argc, char **argv, struct aligning *w)
{
	if (argc < 2 || !*argv[1])
		return cli_misuse(COMMAND, "which site?");
	if (accept_it + refuse_it + undo + list > 1)
		return cli_misuse(
			COMMAND, "only one of --accept, --refuse, --undo, --list at a time");
	if (pairs_path && (refuse_it || undo || list))
		return cli_misuse(COMMAND, "--pairs goes with --accept alone");
	if (undo || list)
		return argc == 2 ? CLI_DONE
				 : cli_misuse(COMMAND, "--%s is for the whole site, without scans",
					   undo ? "undo" : "list");
	if (argc != 4)
		return cli_misuse(COMMAND, "which two scans?");
	for (int i = 2; i < 4; i++)
		if (!parse_number(argv[i], i == 2 ? &w->a : &w->b))
			return cli_misuse(COMMAND, "'%s' is no number of a scan", argv[i]);
	if (w->a == w->b)
		return cli_misuse(COMMAND, "a scan cannot be aligned with itself");
	return CLI_DONE;
}

int main(int argc, char **argv)
{
	int status;
	g_autoptr(GError) error = NULL;
	g_auto(aligning) w = { 0 };
	if (!cli_parse(COMMAND, "SITE [A B]",
		    "Aligns two scans of a site, from picked pairs or by itself, and checks how "
		    "they fit.",
		    "With --accept or --refuse alone: a decision about a pair that was aligned "
		    "before. Every change is a revision of its own in SITE/poses; --undo goes "
		    "back.\n",
		    entries, &argc, &argv, &status))
		return status;
	status = check_usage(argc, argv, &w);
	if (status != CLI_DONE)
		return status;
	cli_catch_interrupts();
	if (!begin(&w, argv[1], &error))
		return cli_fail(COMMAND, error);
	status = run(&w, &error);
	if (json && json_object_get_size(w.told) && json_object_has_member(w.told, "revision"))
		cli_print_json(json_object_ref(w.told));
	if (error) {
		fflush(stdout);
		return cli_fail(COMMAND, error);
	}
	return status == CLI_DONE ? cli_done(COMMAND) : status;
}
