#include "process/report-private.h"
#include <math.h>

static const char style[] =
	":root{color-scheme:light "
	"dark;--ink:#2b2723;--dim:#6d645a;--line-colour:#cfc7b8;--paper:#f6f3ec;"
	"--good:#2e7d32;--bad:#c62828;--hand:#b26a00;--odd:#7b1fa2}"
	"body{font:16px/1.5 system-ui,sans-serif;margin:0;background:var(--paper);color:var(--ink)}"
	"main{max-width:1300px;margin:0 auto;padding:1.2rem 1.5rem}"
	"h1,h2,h3{font-weight:600;margin:.4rem 0}h2{border-top:1px solid "
	"var(--line-colour);padding-top:1.2rem;"
	"margin-top:2rem}"
	"p{margin:.3rem 0 .8rem}.dim,figcaption,th{color:var(--dim)}"
	".wide{overflow-x:auto}table{border-collapse:collapse;font-size:.92rem}"
	"td,th{padding:.25rem .7rem .25rem 0;text-align:right;white-space:nowrap;font-weight:400;"
	"border-bottom:1px solid "
	"var(--line-colour)}td:first-child,th:first-child,td.text,th.text{text-align:left}"
	".verdict{font-weight:600}.verdict.accepted{color:var(--good)}.verdict.refused{color:var(--"
	"bad)}"
	".verdict.byhand{color:var(--hand)}.verdict.outlier{color:var(--odd)}"
	".state{padding:.6rem .9rem;border-left:5px solid;background:rgba(127,120,110,.12)}"
	".state.accepted{border-color:var(--good)}.state.refused{border-color:var(--bad)}"
	"figure{margin:.4rem 0 1rem}figcaption{font-size:.85rem;margin-top:.2rem}"
	"img{width:100%;height:auto;display:block;border-radius:4px;background:#181614}"
	"svg.plan{width:100%;max-height:85vh;background:#fff;border-radius:4px}"
	"svg.plan line{stroke-width:calc(var(--line)*1px);stroke-linecap:round}"
	"svg line.accepted{stroke:#2e7d32}svg line.byhand{stroke:#e08a00}svg "
	"line.outlier{stroke:#7b1fa2;"
	"stroke-dasharray:4 12}svg line.refused{stroke:#c62828;stroke-dasharray:2 14}"
	"svg circle{fill:#1c4f8f;stroke:#fff;stroke-width:2}svg line.home{stroke:#1c4f8f}"
	"svg text{fill:#fff;text-anchor:middle;font-family:system-ui,sans-serif}"
	"svg text.label{fill:#222}svg path.scale{fill:none;stroke:#222;stroke-width:3}"
	"svg.bars{width:100%;max-width:640px;height:120px}svg.bars rect{fill:#5b7fa8}"
	"svg.bars text{fill:currentColor;font-size:11px}"
	".key span{display:inline-block;width:.9em;height:.9em;border-radius:2px;margin:0 .3em 0 "
	".9em;"
	"vertical-align:-.1em}"
	"@media(prefers-color-scheme:dark){:root{--ink:#ece6dc;--dim:#a89f93;--line-colour:#45403a;"
	"--paper:#1d1b19;"
	"--good:#81c784;--bad:#ef9a9a;--hand:#ffcc80;--odd:#ce93d8}}"
	"@media print{body{background:#fff}h2{break-before:auto}figure{break-inside:avoid}}";

static void append_text(GString *html, const char *text)
{
	g_autofree char *escaped = g_markup_escape_text(text ? text : "", -1);
	g_string_append(html, escaped);
}

/* ---- the sum of it ---- */

static uint32_t count_placed(const report *r)
{
	uint32_t placed = 0;
	for (guint i = 0; i < r->scans->len; i++)
		placed += g_array_index(r->scans, struct report_scan, i).placed->group > 0;
	return placed;
}

static void append_state(GString *html, const report *r)
{
	uint32_t placed = count_placed(r), scans = r->scans->len, groups = r->plans->len;
	bool whole = placed == scans && groups <= 1;
	g_string_append_printf(html, "<p class=\"state %s\">", whole ? "accepted" : "refused");
	if (!scans)
		g_string_append(html, "There are no scans that registration knows of yet.");
	else if (whole)
		g_string_append_printf(html, "All %u scans stand in one frame.", scans);
	else
		g_string_append_printf(html,
			"%u of %u scans are placed%s. Those that are not, and why, stand below.",
			placed, scans, groups > 1 ? ", in parts that nothing ties together" : "");
	g_string_append(html, "</p>\n");
}

static void append_plans(GString *html, const report *r)
{
	for (guint i = 0; i < r->plans->len; i++) {
		const struct report_plan *plan = &g_array_index(r->plans, struct report_plan, i);
		g_string_append(html, "<figure>");
		report_append_plan(html, r, plan);
		g_string_append(html, "<figcaption>");
		if (r->plans->len > 1)
			g_string_append_printf(html, "Part %u. ", plan->group);
		g_string_append(html,
			"What stands upright, from above. A stroke shows where each station's zero "
			"azimuth points. Pairs: green accepted, orange accepted by hand, red "
			"refused, "
			"violet contradicts its loops.</figcaption></figure>\n");
	}
}

/* ---- scans ---- */

static void append_scan(GString *html, const struct report_scan *s)
{
	const struct placed_scan *p = s->placed;
	g_string_append_printf(
		html, "<tr id=\"scan-%u\"><td>%u</td><td class=\"text\">", p->number, p->number);
	append_text(html, s->what);
	g_string_append(html, "</td><td class=\"text\">");
	append_text(html, s->when);
	g_string_append_printf(html, "</td><td>%.2f</td>", (double)s->points / 1e6);
	if (!p->group) {
		g_string_append(html,
			"<td colspan=\"7\" class=\"text verdict refused\">not placed</td></tr>\n");
		return;
	}
	g_string_append_printf(html,
		"<td>%u</td><td>%.3f</td><td>%.3f</td><td>%.3f</td><td>%.2f</td><td>%.2f</td>"
		"<td>%.1f&nbsp;mm, %.3f&deg;</td></tr>\n",
		p->group, p->pose.translation_m[0], p->pose.translation_m[1],
		p->pose.translation_m[2], s->yaw_deg, s->tilt_deg, 1000 * p->deviation_m,
		p->deviation_rad * 180 / G_PI);
}

static void append_scans(GString *html, const report *r)
{
	g_string_append(html,
		"<h2>Scans</h2>\n<div class=\"wide\"><table><tr><th>Scan</th><th "
		"class=\"text\">What</th><th class=\"text\">When</th>"
		"<th>Million points</th><th>Part</th><th>x m</th><th>y m</th><th>z m</th>"
		"<th>Yaw &deg;</th><th>Tilt &deg;</th><th>1 &sigma;</th></tr>\n");
	for (guint i = 0; i < r->scans->len; i++)
		append_scan(html, &g_array_index(r->scans, struct report_scan, i));
	g_string_append(html, "</table></div>\n");
}

/* ---- pairs ---- */

static void append_row(GString *html, const struct edge *e)
{
	const struct verification *v = &e->verification;
	g_string_append_printf(html,
		"<tr><td><a href=\"#edge-%u-%u\">%u &ndash; %u</a></td>"
		"<td class=\"text verdict %s\">%s</td><td>%.0f</td><td>%.1f</td><td>%.1f</td>"
		"<td>%.0f</td><td>%.2f</td><td>%.2f, %.4f&deg;</td><td>%.1f, %.3f&deg;</td></tr>\n",
		e->a, e->b, e->a, e->b, report_standing_class(e), edge_standing(e),
		100 * v->overlap, 100 * v->agreement, 1000 * v->rms_m, 100 * v->under_6mm,
		v->balance, 1000 * v->deviation_m, v->deviation_rad * 180 / G_PI, 1000 * e->loop_m,
		e->loop_rad * 180 / G_PI);
}

static void append_table(GString *html, const report *r)
{
	g_string_append(html,
		"<h2>Pairs</h2>\n<div class=\"wide\"><table><tr><th>Pair</th><th "
		"class=\"text\">Verdict</th><th>Overlap %</th><th>Agreement %</th><th>RMS mm</th>"
		"<th>Under 6 mm %</th><th>Balance</th><th>1 &sigma; mm</th><th>From its loops "
		"mm</th></tr>\n");
	for (guint i = 0; i < r->edges->len; i++)
		append_row(html, g_array_index(r->edges, struct report_edge, i).edge);
	g_string_append(html,
		"</table></div>\n<p class=\"dim\">Overlap: what both scans measured, of all that "
		"both could see. Agreement: of what both looked at, the share where they saw the "
		"same surface; the rest contradicts itself, or moved. Balance: how evenly the "
		"shared "
		"surfaces hold the three directions, 1 is best.</p>\n");
}

static void append_bars(GString *html, const struct report_edge *e)
{
	uint64_t top = 1;
	for (int i = 0; i < REPORT_BINS; i++)
		top = MAX(top, e->bins[i]);
	g_string_append(html, "<svg class=\"bars\" viewBox=\"0 0 640 120\" role=\"img\" "
			      "aria-label=\"distances of the shared surfaces\">");
	for (int i = 0; i < REPORT_BINS; i++) {
		double height = 95.0 * (double)e->bins[i] / (double)top,
		       width = 600.0 / REPORT_BINS;
		g_string_append_printf(html,
			"<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>",
			20 + i * width, 100 - height, width - 1, height);
	}
	for (int mm = -30; mm <= 30; mm += 10)
		g_string_append_printf(html,
			"<text x=\"%.1f\" y=\"115\" text-anchor=\"middle\">%d mm</text>",
			320 + mm * 10.0, mm);
	g_string_append(html, "</svg>\n");
}

static void append_map(GString *html, const struct report_edge *e)
{
	if (!e->map_png)
		return;
	g_string_append_printf(html,
		"<figure><img alt=\"differences, seen from scan %u\" width=\"%u\" height=\"%u\" "
		"src=\"data:image/png;base64,%s\">"
		"<figcaption>Scan %u, cell by cell, against scan %u.<span class=\"key\">"
		"<span style=\"background:#2166ac\"></span>20 mm nearer"
		"<span style=\"background:#e2e6de\"></span>same surface"
		"<span style=\"background:#d66014\"></span>20 mm behind"
		"<span style=\"background:#787080\"></span>hidden from the other"
		"<span style=\"background:#c8003c\"></span>the other saw through here"
		"<span style=\"background:#3c3836\"></span>outside its view</span></figcaption>"
		"</figure>\n",
		e->edge->b, e->map_columns, e->map_rows, e->map_png, e->edge->b, e->edge->a);
	if (e->agreeing)
		append_bars(html, e);
}

static void append_edge(GString *html, const struct report_edge *facts)
{
	const struct edge *e = facts->edge;
	g_string_append_printf(html,
		"<h3 id=\"edge-%u-%u\">%u &ndash; %u: <span class=\"verdict "
		"%s\">%s</span></h3>\n<p>",
		e->a, e->b, e->a, e->b, report_standing_class(e), edge_standing(e));
	append_text(html, e->verification.reason);
	if (e->origin != EDGE_AUTOMATIC)
		g_string_append(html, e->origin == EDGE_PICKED
					      ? " Started from picked pairs."
					      : " Both poses came with the imported file.");
	g_string_append(html, "</p>\n");
	append_map(html, facts);
}

char *report_html(const report *r)
{
	GString *html =
		g_string_new("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
			     "<meta name=\"viewport\" content=\"width=device-width\"><title>");
	const char *name = manifest_get_string(site_manifest(r->site), "name", NULL);
	append_text(html, name);
	g_string_append_printf(html, "</title><style>%s</style></head>\n<body><main>\n<h1>", style);
	append_text(html, name);
	g_string_append(html, "</h1>\n<p class=\"dim\">Registration report");
	if (r->graph->revision) {
		g_string_append_printf(html, ", revision %u: ", r->graph->revision);
		append_text(html, r->graph->change);
		g_string_append(html, " (");
		append_text(html, r->graph->time);
		g_string_append(html, ")");
	}
	g_string_append(html, ". Metres, degrees.</p>\n");
	append_state(html, r);
	append_plans(html, r);
	append_scans(html, r);
	if (r->edges->len)
		append_table(html, r);
	for (guint i = 0; i < r->edges->len; i++)
		append_edge(html, &g_array_index(r->edges, struct report_edge, i));
	g_string_append(html, "</main></body></html>\n");
	return g_string_free(html, FALSE);
}
