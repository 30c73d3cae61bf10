/* check-site SITE: what a cut of the power must not touch. Every manifest reads; every finished scan is what its manifest says it is, by size and
 * SHA-256 of each file; the record of the partial scan reads up to the cut. Prints how many scans are finished, the partial one's number (0: none), and
 * whole entries and bytes of its record; or one sentence about what is wrong, and fails. */
#include "acquire/scan.h"
#include "firmware-io/record.h"
#include <errno.h>
#include <stdio.h>

static bool check_finished(const site *s, GArray *scans, GError **error)
{
	for (guint i = 0; i < scans->len; i++) {
		g_autoptr(panorama) p =
			scan_load(s, g_array_index(scans, uint32_t, i), true, error);

		if (!p)
			return false;
	}
	return true;
}

static bool check_partial(
	const site *s, uint32_t number, uint64_t *ret_entries, uint64_t *ret_bytes, GError **error)
{
	g_autofree char *folder = site_partial_path(s, number),
			*path = g_build_filename(folder, "scan.json", NULL),
			*raw = g_build_filename(folder, "raw.rec", NULL);
	g_autoptr(manifest) m = manifest_load(path, SCAN_SCHEMA, error);

	if (!m)
		return false;
	if (!g_file_test(raw, G_FILE_TEST_EXISTS))
		return true; /* it was cut before anything came */
	g_autoptr(record_reader) r = record_open(raw, error);
	struct record_entry e;
	enum record_result got = RECORD_BAD;

	while (r && (got = record_next(r, &e, error)) == RECORD_ENTRY) {
		++*ret_entries;
		*ret_bytes = record_reader_position(r);
	}
	return r && (got == RECORD_CUT || got == RECORD_AT_END);
}

int main(int argc, char **argv)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(site) s = argc == 2 ? site_open(argv[1], &error) : NULL;
	g_autoptr(GArray) scans = s ? site_scans(s, &error) : NULL;
	uint32_t partial = 0;
	uint64_t entries = 0, bytes = 0;

	if (!scans || !check_finished(s, scans, &error) ||
		!site_find_partial(s, &partial, &error) ||
		(partial && !check_partial(s, partial, &entries, &bytes, &error))) {
		fprintf(stderr, "check-site: %s\n",
			error ? error->message : "the record is damaged");
		return 1;
	}
	printf("finished=%u partial=%u entries=%lu bytes=%lu\n", scans->len, partial,
		(unsigned long)entries, (unsigned long)bytes);
	return 0;
}
