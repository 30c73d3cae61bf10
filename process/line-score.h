#ifndef PROCESS_LINE_SCORE_H
#define PROCESS_LINE_SCORE_H
/* Profile lines of a simulated site held against what really stands there: for the bench and for tests.
 *
 * The truth is what fine panoramas of the true scene show from each station (feature-score.h tells what is an edge in one). At a crease
 * the cut of both true planes is known exactly; at a depth edge its place lies between two cells. Those that lie on one line, of
 * whichever station, make a straight edge, as far as they follow each other within LINE_SCORE_GAP_M.
 *
 * - Straight building edges: longer than 1 m, at least half of their places on buildings. Two faces meet there, each at least 6 cm and 3
 *   cells of the scan wide away from it, or one that is so wide ends and stands out by 6 cm; and a station sees it whose cells are no larger
 *   there than 4 cm: by others nobody could tell a place to 2 cm. Covered: within 2 cm of the one or two lines that cover most of the edge.
 * - A line lies on an edge where within 2 cm, and one cell of the truth, there is a place of the truth that is not smooth and even,
 *   and is not of leaves; behind panes, too, for beams go through them.
 * - A face goes on until what is next to it stands off by those 6 cm. */
#include "process/bench-truth.h"
#include "process/feature-score.h"
#include "process/profile-lines.h"

#define LINE_SCORE_GAP_M    0.15
#define LINE_SCORE_WITHIN_M 0.02
#define LINE_SCORE_LONG_M   1.0
#define LINE_SCORE_COLUMNS  6000u
#define LINE_SCORE_ROWS     1584u

/* What all stations see; one owner. */
typedef struct line_truth line_truth;
line_truth *line_truth_new(void);
/* From a panorama as the simulator tells it, for the bench of LINE_SCORE_COLUMNS x LINE_SCORE_ROWS cells. light: of each cell, red, green,
 * blue; NULL: edges of colour are none. scan_columns: of the scan, whose cells tell what is fine enough. */
void line_truth_add(line_truth *t, const struct bench_truth_scan *seen, const float *light,
	uint32_t scan_columns);
/* What stands behind the panes that the station sees, of as many cells; lines may lie on its edges. */
void line_truth_add_behind(
	line_truth *t, const struct bench_truth_scan *seen, const struct bench_truth_scan *behind);
void line_truth_free(line_truth *t); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(line_truth, line_truth_free)

struct line_score {
	uint32_t edges;            /* straight building edges longer than 1 m */
	double edges_m, covered_m; /* length of these; of it covered by one or two lines each */
	double any_m;              /* covered by any number of lines */
	uint32_t lines;
	double lines_m, astray_m; /* length of all lines; of it on no edge */
	/* By distance from the nearest station that sees the place: up to 5, 10, 20, 40 m, and beyond. */
	double band_m[5], band_covered_m[5];
};
/* to_truth: from the site's frame to the truth's. */
void line_score_make(line_truth *t, const profile_lines *lines, const struct pose *to_truth,
	struct line_score *ret);

#endif
