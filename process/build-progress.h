#ifndef PROCESS_BUILD_PROGRESS_H
#define PROCESS_BUILD_PROGRESS_H
/* How far building the model is: each part of the work has its share of the whole. */
#include "process/build-model.h"
#include <gio/gio.h>

struct build_progress {
	const struct build_options *options;
	double from, to; /* share of the part that is being done */
};

/* fraction: 0..1 of the part. false and G_IO_ERROR_CANCELLED when whoever watches wants to stop. */
static inline bool build_progress_step(
	const struct build_progress *p, double fraction, const char *doing, GError **error)
{
	const struct build_options *o = p->options;
	if (!o->progress ||
		o->progress(p->from + (p->to - p->from) * fraction, doing, o->user_data))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped while %s", doing);
	return false;
}

static inline uint64_t build_memory(const struct build_options *o)
{
	return o->memory_bytes ? o->memory_bytes : (uint64_t)1 << 30;
}

#endif
