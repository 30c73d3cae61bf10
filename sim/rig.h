#ifndef SIM_RIG_H
#define SIM_RIG_H
/* A host for a simulated head, for tests of the simulator itself: runs the head in a thread, speaks
 * the link by hand and collects what comes. Any failure of the link is a failure of the test. */
#include "sim/head.h"
#include "sim/link.h"

struct rig {
	int fd;
	GThread *thread;
	struct sim_head_options options;
	GError *error; /* of the head, after rig_stop() */
	bool good;     /* what sim_head_serve() returned */

	int64_t now_ns;
	bool gone; /* the head closed the link */
	struct link_hello hello;
	char *certificate;
	GByteArray *all;  /* every byte that came over the link, for comparisons */
	GString *lidar;   /* bytes of the lidar since last cleared */
	int64_t lidar_ns; /* when the last of them arrived */
	guint deliveries; /* of lidar bytes */
	guint opened, unplugged, camera_gone;
	GArray *events;    /* struct link_stage_event */
	GPtrArray *frames; /* GByteArray: struct link_frame and pixels */
	GArray *frame_ns;  /* int64_t, their arrival */
};

struct rig *rig_start(
	const struct sim_head_options *options); /* what it points to must outlive the rig */
void rig_stop(struct rig *rig);                  /* hangs up and waits for the head */
void rig_free(struct rig *rig);                  /* stops it if need be */

void rig_send(struct rig *rig, enum link_kind kind, const void *payload, gsize length);
/* One LINK_WAIT, or in real time one message; false when the head hung up. */
bool rig_wait(struct rig *rig, int64_t deadline_ns);
void rig_run(struct rig *rig, double seconds); /* waits until so much time has passed */

void rig_say(struct rig *rig, const char *text); /* to the lidar */
/* Opens the lidar's port; true if it is there. */
bool rig_open(struct rig *rig);
/* Says a command and gives all that comes within 20 ms (rig->lidar keeps it as well). */
char *rig_ask(struct rig *rig, const char *text);
void rig_move(struct rig *rig, int64_t target, double rate, double acceleration);
/* Turns clockwise to the home slot and stops a little after it; returns the step count at home. */
int64_t rig_home(struct rig *rig);
guint rig_count(const struct rig *rig, enum link_stage_kind kind);

#endif
