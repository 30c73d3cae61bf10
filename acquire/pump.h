#ifndef ACQUIRE_PUMP_H
#define ACQUIRE_PUMP_H
/* The pump moves what a head's devices say into the stream, and sleeps in between. Dialogue with
 * the lidar runs on it: a command is sent, the pump turns until the answer has come; stage and
 * camera are served meanwhile. One owner, one thread. */
#include "acquire/sniff.h"
#include "acquire/stream.h"
#include "firmware-io/head.h"

#define PUMP_ERROR (pump_error_quark())
GQuark pump_error_quark(void);
enum pump_error {
	PUMP_ERROR_LIDAR_GONE, /* unplugged: pump_open_lidar may succeed later */
	PUMP_ERROR_NO_ANSWER,
	PUMP_ERROR_REFUSED,   /* the device answered that it will not */
	PUMP_ERROR_STAGE,     /* the stage's drive stopped by itself */
	PUMP_ERROR_STOPPED,   /* somebody asked the scan to stop */
	PUMP_ERROR_ESTOP,     /* the emergency stop is, or was, pressed */
	PUMP_ERROR_INTERLOCK, /* the interlock is, or was, open */
	PUMP_ERROR_NOT_RESET, /* one of the two was, and nobody has said since that it is safe */
};

struct pump {
	head *head;
	stream *stream;
	const struct driver *driver;
	/* Called once each turn, when all that came has been taken; false with an error ends the
	 * pumping. May be NULL. It may use the head, but not pump. */
	bool (*each_turn)(gpointer user_data, GError **error);
	gpointer user_data;

	/* The pump's own. */
	bool lidar_open, camera_gone, stage_stopped, stage_fault;
	bool pressed, open;    /* how emergency stop and interlock stand */
	bool struck;           /* one of them has changed to that, and it was not told yet */
	bool button;           /* was pressed, since its owner last cleared this */
	int64_t last_bytes_ns; /* when the lidar last said something */
	struct wire_line line; /* as line_find left it, where there is one */
	struct sniff heard;    /* the lidar's last bytes, since it was opened or its line was set */
	GQueue replies;        /* of struct pump_reply, oldest first; bounded */
};

typedef struct pump_reply pump_reply;
struct pump_reply {
	int64_t arrival_ns;
	char *command, *status, *text;
};
void pump_reply_free(pump_reply *r);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(pump_reply, pump_reply_free)

void pump_clear(struct pump *p);
/* For the stream's sink. */
void pump_take_reply(struct pump *p, const struct lidar_reply *reply);

/* Writes a RECORD_MARK. */
bool pump_mark(struct pump *p, const char *text, GError **error);

bool pump_open_lidar(struct pump *p, GError **error);

/* One turn: sleeps until something comes or the deadline, then takes all there is. A pressed emergency stop and an open
 * interlock are errors of the turn that first learns of them. */
bool pump_turn(struct pump *p, int64_t deadline_ns, GError **error);
/* Turns for so long. */
bool pump_for(struct pump *p, int64_t duration_ns, GError **error);

/* Sends; the answer is taken with pump_answer. */
bool pump_send(struct pump *p, const void *bytes, size_t length, GError **error);
/* Turns until an answer to the command has come (prefix of lidar_reply.command); caller frees.
 * PUMP_ERROR_NO_ANSWER after timeout_ns. Other answers are dropped. */
struct pump_reply *pump_answer(
	struct pump *p, const char *command, int64_t timeout_ns, GError **error);

/* What the driver does, with the light that says that the laser is on: lit from before the start, dark only once the device has
 * confirmed that it stopped. Nothing is started while the emergency stop is pressed or the interlock is open. */
bool pump_prepare_lidar(struct pump *p, GError **error);
bool pump_start_lidar(struct pump *p, GError **error);
bool pump_stop_lidar(struct pump *p, GError **error);

/* Whether an error is of those that only stage_reset undoes: emergency stop, interlock, not reset. */
bool pump_error_is_safety(const GError *e);
/* stage_reset, with errors of the pump's. */
bool pump_reset_stage(stage *s, GError **error);
/* Starts a move of the stage; p->stage_stopped says when it is over. */
bool pump_start_move(struct pump *p, const struct stage_move *move, GError **error);
/* Moves the stage and turns until it has stopped. Errors of the stage are PUMP_ERROR_STAGE. */
bool pump_move(struct pump *p, const struct stage_move *move, GError **error);

#endif
