/* Any text as a manifest: what is accepted is written so that it reads back and is written the same
 * again. */
#include "acquire/manifest.h"
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void get_all(const manifest *m, const char *key)
{
	int64_t whole;
	double number;
	manifest_get_int(m, key, INT64_MIN, INT64_MAX, &whole, NULL);
	manifest_get_number(m, key, -1, 1, &number, NULL);
	manifest_get_string(m, key, NULL);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(manifest) m = manifest_parse((const char *)data, size, "x", 1, &error);
	g_assert_true((m == NULL) == (error != NULL));
	if (!m)
		return 0;
	g_autofree char *text = manifest_to_text(m);
	g_autoptr(manifest) again = manifest_parse(text, strlen(text), "x", 1, &error);
	g_assert_no_error(error);
	g_autofree char *same = manifest_to_text(again);
	g_assert_cmpstr(text, ==, same);
	get_all(m, "a");
	get_all(m, "a.b");
	manifest_set_int(m, "a.b", 1);
	get_all(m, "a.b");
	return 0;
}
