#include "render/large.h"
#include <stdint.h>
#include <string.h>

#define PAGE_BYTES ((size_t)2 << 20)

/* In kilobytes. */
static double resident(void)
{
	g_autofree char *text = NULL;
	g_assert_true(g_file_get_contents("/proc/self/status", &text, NULL, NULL));
	return g_ascii_strtod(strstr(text, "VmRSS:") + strlen("VmRSS:"), NULL);
}

/* All of it can be written, it begins on a page, and what is freed does not take what is beside it. */
static void test_sizes(void)
{
	static const size_t bytes[] = { 1, 4096, 100000, PAGE_BYTES - 1, PAGE_BYTES, PAGE_BYTES + 1,
		2093808, 3 * PAGE_BYTES + 12345 };
	enum { SIZES = G_N_ELEMENTS(bytes) };
	uint8_t *memory[SIZES];
	for (int n = 0; n < SIZES; n++) {
		memory[n] = large_new(bytes[n]);
		g_assert_cmpuint((uintptr_t)memory[n] % PAGE_BYTES, ==, 0);
		memset(memory[n], n + 1, bytes[n]);
	}
	for (int n = 0; n < SIZES; n += 2)
		large_free(memory[n]);
	for (int n = 1; n < SIZES; n += 2) {
		for (size_t i = 0; i < bytes[n]; i++)
			g_assert_cmpuint(memory[n][i], ==, n + 1);
		large_free(memory[n]);
	}
	large_free(NULL);
}

/* What is freed goes back to the system, also where malloc has room for it between smaller pieces. */
static void test_goes_back(void)
{
	enum { PIECES = 400, SLABS = 40, PIECE = 200000 };
	g_autoptr(GPtrArray) pieces = g_ptr_array_new(), slabs = g_ptr_array_new();
	for (int n = 0; n < PIECES; n++)
		g_ptr_array_add(pieces, memset(g_malloc(PIECE), 1, PIECE));
	for (int n = 0; n < PIECES - 1; n++)
		g_free(pieces->pdata[n]);
	double before = resident();
	for (int n = 0; n < SLABS; n++)
		g_ptr_array_add(slabs, memset(large_new(PAGE_BYTES), 1, PAGE_BYTES));
	g_assert_cmpfloat(resident() - before, >, SLABS * 2048 * 0.9);
	for (int n = 0; n < SLABS; n++)
		large_free(slabs->pdata[n]);
	g_assert_cmpfloat(resident() - before, <, SLABS * 2048 * 0.1);
	g_free(pieces->pdata[PIECES - 1]);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/large/sizes", test_sizes);
#if !defined __SANITIZE_ADDRESS__ /* which keeps what was freed, to tell who still uses it */
	g_test_add_func("/large/goes-back", test_goes_back);
#else
	(void)test_goes_back;
#endif
	return g_test_run();
}
