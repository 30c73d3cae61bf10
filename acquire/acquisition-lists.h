#ifndef ACQUIRE_ACQUISITION_LISTS_H
#define ACQUIRE_ACQUISITION_LISTS_H
/* What org.pleinair.Acquisition1 says of presets and devices, what it is told of scans and planes, and pictures as file descriptors. */
#include "acquire/recorder.h"

/* aa{sv}, floating: of each preset, with what it takes where the head is known. */
GVariant *acquisition_presets(const struct identity *known);
/* aa{sv}, floating: of each device of the head, known or not. error: what the last look or scan ended with, or NULL. */
GVariant *acquisition_devices(const struct identity *known, const GError *error);

/* Options of a scan (a{sv}). SERVICE_ERROR_INVALID for one that there is not, or of another type. */
bool acquisition_read_options(GVariant *options, bool *ret_hdr, GError **error);
/* "range", "intensity", "colour"; SERVICE_ERROR_INVALID. */
bool acquisition_find_plane(const char *name, enum picture *ret, GError **error);

/* A sealed memfd with these bytes; -1 with error. */
int acquisition_seal(const void *bytes, size_t length, GError **error);

#endif
