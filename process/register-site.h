#ifndef PROCESS_REGISTER_SITE_H
#define PROCESS_REGISTER_SITE_H
/* All scans of a site into one frame: which pairs to try, the pairs themselves, the graph, its loops. */
#include "acquire/site.h"
#include "process/scan-graph.h"

struct register_options {
	/* What is done and how far; returns false to stop: what was found so far is kept. */
	bool (*progress)(double fraction, const char *doing, gpointer user_data);
	gpointer user_data;
};
/* Aligns the pairs whose inputs changed, solves, saves a new revision when anything differs. The edges that a person decided
 * stay as they are. *ret_stopped: by progress. NULL and an error: a scan cannot be read. */
scan_graph *register_site(
	site *s, const struct register_options *options, bool *ret_stopped, GError **error);
/* Whether register_site would have anything to do; *ret_why: a few words ("scan 3 is new"), caller frees. */
bool register_site_is_due(const site *s, bool *ret_due, char **ret_why, GError **error);

#endif
