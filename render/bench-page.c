#include "render/bench-page.h"
#include "render/bench-bars.h"
#include "render/bench-machine.h"
#include "render/bench-reach.h"
#include "render/bench-tables.h"
#include <stdbool.h>
#include <string.h>

/* More than this was waiting for each core: figures are not what the machine can do. */
#define BUSY 0.5

static const char style[] =
	"body{font:16px/1.5 system-ui,'DejaVu Sans',sans-serif;margin:0 "
	"auto;padding:1rem;max-width:"
	"76rem;background:#fff;color:#1c2226}"
	"h1{font-size:1.7rem;margin:.2rem 0 .4rem}"
	"h2{font-size:1.25rem;margin:2.2rem 0 .3rem;padding-top:.7rem;border-top:2px solid #1c2226}"
	"h3{font-size:1rem;margin:0 0 .1rem}h4{font-size:.95rem;margin:1rem 0 .2rem}"
	"p{margin:.2rem 0 .6rem;max-width:46rem}small,.quiet{color:#4b545b;font-size:.88rem}"
	".plots{display:grid;gap:1rem;grid-template-columns:repeat(auto-fill,minmax(min(100%,20rem)"
	","
	"1fr))}"
	".plot{border:1px solid #c9cfd4;border-radius:6px;padding:.7rem .8rem .5rem;break-inside:"
	"avoid}"
	".plot svg{display:block;width:100%;max-width:30rem;height:auto;margin-top:.3rem}"
	".verdict{display:inline-block;font-weight:700;font-size:.85rem;border:2px solid;border-"
	"radius:4px;padding:0 .45rem;margin:.1rem 0}"
	".yes{color:#14632f}.no{color:#a31d16}.none{color:#4b545b;border-style:dashed}"
	".wide{overflow-x:auto;margin:.3rem 0 1rem}"
	"table{border-collapse:collapse;font-size:.85rem;font-variant-numeric:tabular-nums}"
	"th,td{padding:.15rem .6rem .15rem 0;text-align:left;border-bottom:1px solid #dfe3e6;"
	"vertical-align:top}"
	"th{font-weight:600;border-color:#1c2226}.num{text-align:right}"
	"summary{cursor:pointer;font-weight:600;font-size:1.05rem;padding:.4rem 0}"
	"@media "
	"print{body{font-size:10pt;max-width:none;padding:0}.plots{grid-template-columns:1fr "
	"1fr}.wide{overflow:visible}table{font-size:6.5pt}th,td{white-space:normal;padding-right:"
	".3rem}a{color:inherit}}";

static void append(GString *to, const char *before, const char *text, const char *after)
{
	g_autofree char *safe = g_markup_escape_text(text, -1);
	g_string_append_printf(to, "%s%s%s", before, safe, after);
}

static const char *text_of(JsonObject *o, const char *name, const char *otherwise)
{
	return json_object_get_string_member_with_default(o, name, otherwise);
}

/* ---- the machine ---- */

static void append_machine(GString *to, JsonObject *m)
{
	static const char *const keys[] = { "kernel", "compiler", "pleinair", "commit" };
	g_autofree char *line = bench_machine_line(m);
	double load = json_object_get_double_member_with_default(m, "load", 0);
	double cores = (double)json_object_get_int_member_with_default(m, "cores", 1);
	append(to, "<p><strong>", line, "</strong>");
	for (size_t n = 0; n < G_N_ELEMENTS(keys); n++)
		if (json_object_has_member(m, keys[n])) {
			append(to, "; ", keys[n], " ");
			append(to, "", text_of(m, keys[n], ""), "");
		}
	append(to, "; ", text_of(m, "date", ""), ".</p>\n");
	if (load > BUSY * cores)
		g_string_append_printf(to,
			"<p class=\"no\">The machine was busy with something else when this began "
			"(load %.1f on %.0f cores): it can do better than this.</p>\n",
			load, cores);
}

/* ---- what is to reach ---- */

static void append_verdict(GString *to, JsonObject *row)
{
	bool reached = json_object_get_boolean_member_with_default(row, "reached", FALSE);
	const char *why_not = text_of(row, "why_not", NULL);
	if (why_not)
		append(to, "<span class=\"verdict none\">? not measured</span> <small>", why_not,
			"</small>");
	else if (reached)
		g_string_append(to, "<span class=\"verdict yes\">\u2713 reached</span>");
	else
		g_string_append(to, "<span class=\"verdict no\">\u2717 not reached</span>");
}

static void append_plot(GString *to, JsonObject *row, guint number)
{
	append(to, "<div class=\"plot\"><h3>", text_of(row, "what", ""), "</h3>\n");
	append_verdict(to, row);
	bench_bars_append(to, row, number);
	append(to, "<small>wanted by ", text_of(row, "source", ""), "</small></div>\n");
}

static void append_reach(GString *to, JsonArray *reach)
{
	const char *work = NULL;
	for (guint n = 0; n < json_array_get_length(reach); n++) {
		JsonObject *row = json_array_get_object_element(reach, n);
		const char *name = text_of(row, "work", "");
		if (!work || strcmp(work, name) != 0) {
			if (work)
				g_string_append(to, "</div>\n");
			append(to, "<h2>", name, "</h2>\n<div class=\"plots\">\n");
			work = name;
		}
		append_plot(to, row, n);
	}
	if (work)
		g_string_append(to, "</div>\n");
}

/* ---- all that was said ---- */

static void append_cells(
	GString *to, const bench_tables_table *t, const GPtrArray *cells, const char *element)
{
	g_string_append(to, "<tr>");
	for (guint c = 0; c < cells->len; c++) {
		bool number = g_array_index(t->numbers, bool, c);
		g_autofree char *open = g_strdup_printf(
					"<%s%s>", element, number ? " class=\"num\"" : ""),
				*close = g_strdup_printf("</%s>", element);
		append(to, open, cells->pdata[c], close);
	}
	g_string_append(to, "</tr>\n");
}

static void append_table(GString *to, const bench_tables_table *t)
{
	if (*t->title)
		append(to, "<h4>", t->title, "</h4>\n");
	g_string_append(to, "<div class=\"wide\"><table>\n");
	if (t->columns->len) {
		g_string_append(to, "<thead>");
		append_cells(to, t, t->columns, "th");
		g_string_append(to, "</thead>");
	}
	g_string_append(to, "<tbody>\n");
	for (guint n = 0; n < t->rows->len; n++)
		append_cells(to, t, t->rows->pdata[n], "td");
	g_string_append(to, "</tbody></table></div>\n");
}

static void append_bench(GString *to, JsonObject *bench)
{
	const char *error = text_of(bench, "error", NULL);
	g_autofree char *heading = g_strdup_printf("%s (%.0f s)%s", text_of(bench, "command", ""),
		json_object_get_double_member_with_default(bench, "seconds", 0),
		error ? ": failed" : "");
	append(to, "<details open=\"open\"><summary>", heading, "</summary>\n");
	if (error)
		append(to, "<p class=\"no\">", error, "</p>\n");
	if (json_object_has_member(bench, "result")) {
		g_autoptr(GPtrArray) tables =
			bench_tables_of(json_object_get_object_member(bench, "result"));
		for (guint n = 0; n < tables->len; n++)
			append_table(to, tables->pdata[n]);
	}
	g_string_append(to, "</details>\n");
}

char *bench_page_of(JsonObject *document)
{
	GString *to = g_string_new(
		"<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>"
		"<meta charset=\"utf-8\"/><meta name=\"viewport\" "
		"content=\"width=device-width,initial-scale=1\"/><title>What pleinair "
		"measures</title>\n<style>");
	JsonArray *reach = json_object_get_array_member(document, "reach"),
		  *benches = json_object_get_array_member(document, "benches");
	g_autofree char *sum = bench_reach_sum(reach);
	g_string_append_printf(
		to, "%s</style></head>\n<body>\n<h1>What pleinair measures</h1>\n", style);
	append_machine(to, json_object_get_object_member(document, "machine"));
	append(to, "<p>", sum,
		". A full bar is a figure that is reached, a hatched one a figure that is not; the "
		"line across is what is wanted. All programs were measured in the same run.</p>\n");
	if (json_object_has_member(document, "stopped"))
		g_string_append(to, "<p class=\"no\">It was stopped before its end.</p>\n");
	append_reach(to, reach);
	g_string_append(to, "<h2>All that was measured</h2>\n");
	for (guint n = 0; n < json_array_get_length(benches); n++)
		append_bench(to, json_array_get_object_element(benches, n));
	g_string_append(to, "</body></html>\n");
	return g_string_free(to, FALSE);
}
