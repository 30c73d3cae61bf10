#ifndef PROCESS_SCAN_GRAPH_H
#define PROCESS_SCAN_GRAPH_H
/* The scans of a site, how pairs of them fit, and where each stands: SITE/poses/0007.json. Every change writes a new file with
 * the next number; the highest counts. To undo is to write the one before once more, so nothing is ever lost.
 *
 * A scan is placed when a chain of accepted edges ties it to the first placed scan of its group, whose pose is the identity or
 * the one that it was given. Errors are those of manifest.h and of G_IO_ERROR. */
#include "acquire/site.h"
#include "process/pair.h"

enum edge_origin {
	EDGE_AUTOMATIC,
	EDGE_PICKED, /* from picked pairs */
	EDGE_GIVEN,  /* both poses came with the imported file */
};
enum edge_decision {
	DECISION_NONE,     /* the verdict counts */
	DECISION_ACCEPTED, /* a person said so, against or with the verdict */
	DECISION_REFUSED,
};

struct edge {
	uint32_t a, b; /* numbers of scans, a < b */
	enum edge_origin origin;
	enum edge_decision decision;
	struct pose pose;        /* takes b to a */
	double covariance[6][6]; /* as fine_result's */
	struct verification verification;
	double loop_rad,
		loop_m; /* after the graph was solved: how far this edge is from the poses */
	bool outlier;   /* disagrees with the loops that it closes; weighed down */
	char *inputs; /* fingerprints of both scans and the version of the method: what it was computed from */
};
bool edge_is_used(const struct edge *e); /* accepted by verdict or by a person, and no outlier */

struct placed_scan {
	uint32_t number;
	uint32_t group;   /* 1..: scans of one group are tied together; 0: not placed */
	struct pose pose; /* scan to site; identity when not placed */
	double deviation_m, deviation_rad; /* 1 sigma, relative to the first of the group */
};

typedef struct scan_graph scan_graph;
struct scan_graph {
	uint32_t revision, parent; /* number of the file; of the one it was made from, 0: none */
	char *change;              /* what was done, a sentence */
	char *time;                /* UTC */
	char *inputs;  /* of register_site, when it came to its end with these edges; else NULL */
	GArray *edges; /* of struct edge, sorted by a, b */
	GArray *scans; /* of struct placed_scan, sorted by number */
};

scan_graph *scan_graph_new(void);
/* The graph that counts; an empty one with revision 0 where there is none. */
scan_graph *scan_graph_load(const site *s, GError **error);
/* As the next revision; sets revision, parent, change and time. The site must be open for writing. */
bool scan_graph_save(scan_graph *g, const site *s, const char *change, GError **error);
/* Writes what stood before the last change that was not undone. Refused when there is none. The site must be open for
 * writing. */
scan_graph *scan_graph_undo(const site *s, GError **error);
/* The same text in any file: what is not finished yet. */
scan_graph *scan_graph_load_file(const char *path, GError **error);
/* The same for text at hand; path is what messages say. */
scan_graph *scan_graph_parse(const char *text, size_t length, const char *path, GError **error);
bool scan_graph_save_file(const scan_graph *g, const char *path, GError **error);
/* Whether edges, poses and inputs are the same: the rest tells only of how they came about. */
bool scan_graph_equal(const scan_graph *a, const scan_graph *b);
void scan_graph_free(scan_graph *g); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scan_graph, scan_graph_free)

struct edge *scan_graph_edge(
	const scan_graph *g, uint32_t a, uint32_t b); /* in any order; NULL: none */
struct placed_scan *scan_graph_scan(const scan_graph *g, uint32_t number);
/* Takes edge's strings; replaces one of the same pair. */
void scan_graph_set_edge(scan_graph *g, const struct edge *edge);
void scan_graph_remove_edge(scan_graph *g, uint32_t a, uint32_t b);
void edge_clear(struct edge *e); /* frees its strings */

/* Where a file said that a scan stands. */
struct scan_given {
	uint32_t number;
	bool has_pose;
	struct pose pose; /* scan to site */
};
/* Poses of all scans (given: one entry for each scan of the site) from the accepted edges: pose-graph.h; edges that disagree
 * with loops are marked and left out. Scans with a given pose stay where it is, unless the comparison with another such scan
 * refuted it. The group of the given poses is the first, the others go by their size. A scan that nothing ties to another has
 * no group; where no scan has one, the first scan is group 1, at the identity. */
void scan_graph_solve(scan_graph *g, const struct scan_given *given, size_t count);
/* The entries of all scans of a site, in their order, of struct scan_given; caller frees. */
GArray *scan_graph_given(const site *s, GError **error);

#endif
