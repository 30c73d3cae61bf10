#ifndef PROCESS_JOB_KINDS_H
#define PROCESS_JOB_KINDS_H
/* What a job can be: a command on a site, and which of its options callers may give. */
#include <glib.h>
#include <stdbool.h>

enum job_option_use {
	JOB_OPTION_PLAIN,
	JOB_OPTION_INSIDE, /* a file that is written: inside the site */
	JOB_OPTION_DRIVE,  /* a folder that is written: on a drive */
	JOB_OPTION_READ,   /* a file that is read: where sites may lie */
};
struct job_option {
	const char *name; /* as the command has it, without -- */
	char type;        /* of D-Bus: s, b, i or d */
	enum job_option_use use;
};
struct job_kind {
	const char *name; /* the command's; the program is pleinair-NAME */
	bool arguments;   /* may stand behind the site */
	/* Done twice is as good as once, so that it is begun again when it was cut off. */
	bool repeatable;
	const struct job_option *options; /* ends with one without a name */
};

/* NULL with SERVICE_ERROR_INVALID. */
const struct job_kind *job_kind_find(const char *name, GError **error);

/* What callers may reach. */
struct job_limits {
	const char *folder;        /* sites must lie in it; NULL: anywhere */
	const char *const *drives; /* folders that drives are mounted in; NULL: anything goes */
};
/* The command line after the program's name, from options of type a{sv}: checked against the kind and the limits. Caller frees;
 * NULL with SERVICE_ERROR_INVALID or SERVICE_ERROR_NOT_ALLOWED. */
GStrv job_kind_arguments(const struct job_kind *kind, const char *site_path, GVariant *options,
	const struct job_limits *limits, GError **error);

#endif
