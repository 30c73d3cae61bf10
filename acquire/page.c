#include "acquire/page.h"

struct page {
	GString *body;
	char *title;
	uint32_t scans;
};

static const char style[] =
	":root{color-scheme:light dark}"
	"body{font:16px/1.5 system-ui,sans-serif;margin:0;background:#f6f3ec;color:#2b2723}"
	"header,section{max-width:1500px;margin:0 auto;padding:1.2rem 1.5rem}"
	"h1{font-weight:600;margin:.4rem 0 0}h2{font-weight:600;border-top:1px solid "
	"#cfc7b8;padding-top:1.2rem;margin:0}"
	"p{margin:.2rem 0 .8rem;color:#6d645a}"
	"figure{margin:0 0 1rem}figcaption{font-size:.85rem;color:#6d645a;margin-bottom:.2rem}"
	"img{width:100%;height:auto;display:block;border-radius:4px;background:#000}"
	"@media(prefers-color-scheme:dark){body{background:#1d1b19;color:#ece6dc}p,figcaption{"
	"color:#a89f93}"
	"h2{border-color:#45403a}}";

page *page_new(const char *title)
{
	page *p = g_new0(page, 1);
	p->title = g_markup_escape_text(title, -1);
	p->body = g_string_new(NULL);
	return p;
}

void page_free(page *p)
{
	if (!p)
		return;
	g_free(p->title);
	g_string_free(p->body, TRUE);
	g_free(p);
}

void page_begin_scan(page *p, uint32_t number, const panorama *scan)
{
	struct panorama_counts n = panorama_count(scan);
	double cells = (double)scan->desc.columns * scan->desc.rows / 100;
	if (p->scans++)
		g_string_append(p->body, "</section>\n");
	g_string_append_printf(p->body,
		"<section id=\"scan-%04u\"><h2>Scan %04u</h2>\n<p>%u &times; %u cells: "
		"%.1f&nbsp;%% measured, %.1f&nbsp;%% without "
		"return, %.2f&nbsp;%% filled, %.2f&nbsp;%% empty</p>\n",
		number, number, scan->desc.columns, scan->desc.rows, (double)n.measured / cells,
		(double)n.no_return / cells, (double)n.filled / cells, (double)n.empty / cells);
}

void page_add_picture(page *p, const char *caption, const char *name)
{
	g_autofree char *text = g_markup_escape_text(caption, -1),
			*file = g_uri_escape_string(name, NULL, FALSE);
	g_string_append_printf(p->body,
		"<figure><figcaption>%s</figcaption><a href=\"%s\"><img src=\"%s\" alt=\"%s "
		"panorama\" loading=\"lazy\"></a></figure>\n",
		text, file, file, text);
}

uint32_t page_scans(const page *p)
{
	return p->scans;
}

bool page_save(const page *p, const char *path, GError **error)
{
	g_autofree char *html =
		g_strdup_printf("<!doctype html>\n<html lang=\"en\"><head><meta "
				"charset=\"utf-8\"><meta name=\"viewport\" "
				"content=\"width=device-width\"><title>%s</title><style>%s</"
				"style></head>\n<body>\n<header><h1>%s</h1>\n"
				"<p>%u %s. Azimuth rises clockwise from left to right, from 50 "
				"degrees above the horizon to 40 below. Range: near is "
				"red, far is blue. Cells: white measured, blue no return, orange "
				"filled.</p></header>\n%s%s</body></html>\n",
			p->title, style, p->title, p->scans, p->scans == 1 ? "scan" : "scans",
			p->body->str, p->scans ? "</section>\n" : "");
	return g_file_set_contents(path, html, -1, error);
}
