#ifndef PROCESS_STAGES_H
#define PROCESS_STAGES_H
/* What is done to a site after its scans are there, in order: each stage knows whether its products are out of date, and why.
 * A stage can be stopped or killed at any moment; what it had finished is kept, and the next run goes on from there. */
#include "acquire/site.h"
#include <glib.h>

typedef struct _JsonObject JsonObject;

struct stage_progress {
	/* 0..1 of the stage, and what is done just now; returns false to stop. */
	bool (*update)(double fraction, const char *doing, gpointer user_data);
	gpointer user_data;
};

struct stage {
	const char *name;  /* "register" */
	const char *title; /* "registration" */
	bool only_asked;   /* done where it is the last one only: the others do without it */
	/* *ret_why: a few words when it is due, "scan 3 is new"; caller frees. */
	bool (*is_due)(const site *s, bool *ret_due, char **ret_why, GError **error);
	/* *ret_summary: a sentence; figures is filled. G_IO_ERROR_CANCELLED when it was stopped. */
	bool (*run)(site *s, const struct stage_progress *progress, char **ret_summary,
		JsonObject *figures, GError **error);
};
/* Ends with a row without a name. */
extern const struct stage stages[];
/* NULL when there is none of this name. */
const struct stage *stage_find(const char *name);

#endif
