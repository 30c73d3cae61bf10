#ifndef TESTS_SIMULATED_H
#define TESTS_SIMULATED_H
/* A simulated head in a thread of the test, and scans with it into a site of the test's own. */
#include "acquire/scan.h"
#include "process/pose.h"
#include "sim/head.h"

typedef struct simulated simulated;

/* Starts the simulator on one end of a socket pair and opens a head on the other. The world is
 * built once per scene and seed and shared. told may be NULL. */
simulated *simulated_start(const char *description, sim_truth_func told, gpointer truth_data);
/* Of simulated_start; goes to whoever runs the scan. */
head *simulated_take_head(simulated *s);
/* Waits for the simulator's thread: close the head first. */
void simulated_stop(simulated *s);

/* A folder that is removed with all in it when the test program ends; caller frees the path. */
char *simulated_folder(void);

/* Scans into the site (made when missing). Asserts nothing: *ret_error is set as scan_record sets
 * it. */
bool simulated_scan(const char *site_path, const char *description,
	const struct scan_options *options, sim_truth_func told, gpointer truth_data,
	struct scan_result *ret_result, uint32_t *ret_partial, GError **ret_error);

/* The same at the preset draft, which is asserted; returns the scan's number. */
uint32_t simulated_draft(const char *site_path, const char *description);
/* Where the simulator says that such a scan was made. */
struct pose simulated_pose(const char *description);

#endif
