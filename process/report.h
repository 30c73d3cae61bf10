#ifndef PROCESS_REPORT_H
#define PROCESS_REPORT_H
/* What was scanned, how well it fits, what was refused and why: one HTML page that needs nothing beside it (pictures inside,
 * no script, no network), and the same facts as JSON. */
#include "acquire/site.h"
#include "process/scan-graph.h"
#include <glib.h>

typedef struct _JsonObject JsonObject;

struct report_options {
	bool no_maps; /* without difference maps: nothing is projected again */
	bool (*progress)(
		double fraction, const char *doing, gpointer user_data); /* returns false to stop */
	gpointer user_data;
};

typedef struct report report;
/* Collects all of it; the site and the graph must live as long. G_IO_ERROR_CANCELLED when progress stopped it. */
report *report_new(
	const site *s, const scan_graph *g, const struct report_options *options, GError **error);
void report_free(report *r); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(report, report_free)

char *report_html(const report *r);       /* caller frees */
JsonObject *report_json(const report *r); /* caller unrefs */

#endif
