#include "acquire/decoder.h"

static const struct decoder_ops *const protocols[] = { &decoder_scip, &decoder_cola, &decoder_ld,
	&decoder_rplidar };

decoder *decoder_new(const char *protocol, const struct decoder_sink *sink)
{
	for (size_t i = 0; i < G_N_ELEMENTS(protocols); i++) {
		if (g_strcmp0(protocols[i]->protocol, protocol) != 0)
			continue;
		decoder *d = protocols[i]->create();
		d->ops = protocols[i];
		d->sink = *sink;
		return d;
	}
	return NULL;
}

void decoder_feed(decoder *d, const void *bytes, size_t length, int64_t arrival_ns)
{
	if (length > 0)
		d->ops->feed(d, bytes, length, arrival_ns);
}

const struct lidar_identity *decoder_identity(const decoder *d)
{
	return &d->identity;
}

const struct decoder_counts *decoder_get_counts(const decoder *d)
{
	return &d->counts;
}

void decoder_free(decoder *d)
{
	if (d)
		d->ops->destroy(d);
}
