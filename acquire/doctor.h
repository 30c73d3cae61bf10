#ifndef ACQUIRE_DOCTOR_H
#define ACQUIRE_DOCTOR_H
/* What is wrong with this machine as a scanner, and what to do about it: devices, rights, clocks, free space, what the kernel can do. Looking
 * changes nothing but a file of some megabytes in the folder of sites, which is removed again. Blocks for some seconds. */
#include <glib.h>
#include <stdbool.h>

enum finding_state { FINDING_GOOD, FINDING_NOTE, FINDING_BAD };
extern const char *const finding_state_names[]; /* "good", "note", "bad" */

struct finding {
	enum finding_state state;
	const char *subject; /* "lidar", "space"; static */
	char *sentence;      /* how it is */
	char *advice;        /* what to do; NULL: nothing */
};
void finding_free(struct finding *f); /* NULL is fine */

struct doctor_options {
	const char *
		folder; /* of sites; NULL: that of the appliance if it is there, else the current one */
	const char *device; /* to be talked to; NULL: what /etc/pleinair.conf names, if it does */
	bool only_look;     /* talks to no device */
	double stream_s;    /* > 0: ranges flow for so long, and what gets lost is counted */
	bool (*goes_on)(double fraction, gpointer user_data); /* meanwhile; may be NULL */
	gpointer user_data;
};
/* Of struct finding; caller unrefs. */
GPtrArray *doctor_look(const struct doctor_options *options);

/* For its parts. */
void doctor_say(GPtrArray *findings, enum finding_state state, const char *subject,
	const char *advice, const char *format, ...) G_GNUC_PRINTF(5, 6);
void doctor_look_at_devices(GPtrArray *findings, const struct doctor_options *options);

#endif
