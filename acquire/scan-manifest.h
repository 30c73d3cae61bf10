#ifndef ACQUIRE_SCAN_MANIFEST_H
#define ACQUIRE_SCAN_MANIFEST_H
/* What scan.json says: preset, device, firmware, calibration, times, losses, grid, sizes and
 * SHA-256 of the files. */
#include "acquire/develop.h"
#include "acquire/manifest.h"
#include "acquire/preset.h"
#include "firmware-io/head.h"

/* Of a scan about to begin. */
manifest *scan_manifest_begin(const struct preset *preset, bool hdr, const char *device);
/* Adds all that is known when the panorama has been developed and its planes lie in folder. */
bool scan_manifest_finish(manifest *scan, const char *folder, const panorama *p,
	const struct develop_result *d, GError **error);

/* Text of a RECORD_SESSION; caller frees. */
char *scan_session_text(const char *device, const head *h);

const struct preset *scan_manifest_preset(const manifest *scan, GError **error);
/* Photos at stops, of several exposures each, were asked for. */
bool scan_manifest_is_hdr(const manifest *scan);
/* The grid, checked: also against the preset, where this program knows it. */
bool scan_manifest_grid(const manifest *scan, struct panorama_desc *ret, GError **error);
/* Size and SHA-256 of one file in folder against what is written. */
bool scan_manifest_verify_file(
	const manifest *scan, const char *folder, const char *name, GError **error);
/* The same for the planes; all must be listed, colour.tiff where it is there. */
bool scan_manifest_verify_planes(const manifest *scan, const char *folder, GError **error);
/* The same for all that is listed; a file more is no error, one less is. */
bool scan_manifest_verify(const manifest *scan, const char *folder, GError **error);

#endif
