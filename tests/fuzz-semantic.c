/* Any text as what stands beside a semantic model: what is accepted keeps what semantic-manifest.h promises. */
#include "process/semantic-manifest.h"
#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(semantic_manifest) m =
		semantic_manifest_parse((const char *)data, size, "x", &error);
	g_assert_true((m == NULL) == (error != NULL));
	if (!m)
		return 0;
	g_assert_true(m->inputs >= 1 && m->inputs <= SEMANTIC_CHANNELS);
	for (uint32_t i = 0; i < m->inputs; i++) {
		g_assert_true(m->input[i].channel < SEMANTIC_CHANNELS);
		g_assert_true(isfinite(m->input[i].mean) && isfinite(m->input[i].scale));
	}
	g_assert_true(m->classes >= 1 && m->classes <= SEMANTIC_CLASSES_MAX);
	g_assert_cmpuint(g_strv_length(m->class_name), ==, m->classes);
	g_assert_true((m->tile_columns == 0) == (m->tile_rows == 0));
	if (m->tile_columns)
		g_assert_cmpuint(2 * m->overlap, <, MIN(m->tile_columns, m->tile_rows));
	return 0;
}
