#ifndef ACQUIRE_SCAN_MANIFEST_H
#define ACQUIRE_SCAN_MANIFEST_H
/* What scan.json says: preset, device, firmware, calibration, times, losses, grid, sizes and
 * SHA-256 of the files. */
#include "acquire/develop.h"
#include "acquire/manifest.h"
#include "acquire/preset.h"
#include "firmware-io/head.h"

/* Of a scan about to begin. */
manifest *scan_manifest_begin(const struct preset *preset, const char *device);
/* Adds all that is known when the panorama has been developed and its planes lie in folder. */
bool scan_manifest_finish(manifest *scan, const char *folder, const panorama *p,
	const struct develop_result *d, GError **error);

/* Text of a RECORD_SESSION; caller frees. */
char *scan_session_text(const char *device, const head *h);

const struct preset *scan_manifest_preset(const manifest *scan, GError **error);
/* The grid, checked. */
bool scan_manifest_grid(const manifest *scan, struct panorama_desc *ret, GError **error);
/* Sizes and SHA-256 of the files in folder against what is written; a file more is no error, one
 * less is. */
bool scan_manifest_verify(const manifest *scan, const char *folder, GError **error);

#endif
