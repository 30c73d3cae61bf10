/* PTX that is damaged is refused, with the line, and leaves the site as it was. */
#include "tests/import-made.h"
#include "tests/ptx-made.h"

static const struct bad {
	const char *path, *text, *words;
} bads[] = {
	{ "empty", "", "is empty" },
	{ "nothing", "\n\n\n", "no scan" },
	{ "size-text", "x\n2\n", "line 1: the size" },
	{ "size-zero", "0\n2\n", "line 1: a grid cannot have 0" },
	{ "size-negative", "-4\n2\n", "line 1: the size" },
	{ "size-two", "2 2\n2\n", "line 1: the size" },
	{ "size-beyond-64-bits", "99999999999999999999\n2\n", "line 1: the size" },
	{ "size-overflow", "4294967295\n4294967295\n0 0 0\n",
		"line 1: a grid cannot have 4294967295" },
	{ "size-huge", "2147483647\n2147483647\n0 0 0\n",
		"line 2: a grid of 2147483647 x 2147483647" },
	{ "size-lies", "2\n200\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" IDENTITY CELLS,
		"line 2: a grid of 2 x 200" },
	{ "no-second-size", "2\n", "line 2: the file ends" },
	{ "no-head", "1\n1\n", "line 3: the file ends, and where the scanner" },
	{ "position", "2\n2\n0 0\n" IDENTITY CELLS, "line 3: where the scanner stood" },
	{ "axis", "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1 1\n" IDENTITY CELLS, "line 6: an axis" },
	{ "transform-short", HEAD "1 0 0 0\n0 1 0\n" CELLS CELLS,
		"line 8: a line of the transform" },
	{ "transform-zero", HEAD "0 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n" CELLS,
		"line 7: the transform takes all points to one plane" },
	{ "transform-flat", HEAD "1 0 0 0\n0 1 0 0\n1 1 0 0\n0 0 0 1\n" CELLS,
		"line 7: the transform takes all points to one plane" },
	{ "transform-far", HEAD "1 0 0 0\n0 1e9 0 0\n0 0 1e9 0\n0 0 0 1\n" CELLS,
		"line 11: 2e+09 m is too far" },
	{ "transform-columns", HEAD "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n" CELLS,
		"line 7: the last number" },
	{ "transform-w", HEAD "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n" CELLS,
		"line 10: the last number" },
	{ "transform-nan", HEAD "1 0 0 0\n0 1 0 0\n0 0 nan 0\n0 0 0 1\n" CELLS, "line 9: a line" },
	{ "cells-missing", HEAD IDENTITY "1 2 3 0.5\n1 2 3 0.5\n1 2 3 0.5\n",
		"line 14: the file ends here, and 1 of the 4" },
	{ "cells-too-many", HEAD IDENTITY CELLS "1 2 3 0.5\n",
		"line 15: the size of the next grid" },
	{ "second-scan-cut", HEAD IDENTITY CELLS HEAD IDENTITY "1 2 3 0.5 1 2 3\n0 0 0 0.5 0 0 0\n",
		"line 27: the file ends here" },
	{ "third-scan-bad",
		HEAD IDENTITY CELLS HEAD TURNED CELLS HEAD IDENTITY
		"1 2 3 0.5\n1 2 3 4 5\n1 2 3 0.5\n1 2 3 0.5\n",
		"line 40: a cell is" },
	{ "cell-text", HEAD IDENTITY "1 2 3 0.5\n1 two 3 0.5\n" CELLS, "line 12: a cell is" },
	{ "cell-comma", HEAD IDENTITY "1,5 2 3 0.5\n" CELLS, "line 11: a cell is" },
	{ "cell-nan", HEAD IDENTITY "nan nan nan 0.5\n" CELLS, "line 11: a cell is" },
	{ "cell-overflow", HEAD IDENTITY "1e999 0 0 0.5\n" CELLS, "line 11: a cell is" },
	{ "cell-far", HEAD IDENTITY "1e12 0 0 0.5\n" CELLS, "line 11: 1e+12 m" },
	{ "cell-empty-line", HEAD IDENTITY "1 2 3 0.5\n\n" CELLS, "line 12: a cell is" },
	{ "cell-three", HEAD IDENTITY "1 2 3\n" CELLS CELLS, "line 11: a cell is" },
	{ "cell-five", HEAD IDENTITY "1 2 3 0.5 7\n" CELLS, "line 11: a cell is" },
	{ "cell-eight", HEAD IDENTITY "1 2 3 0.5 7 7 7 7\n" CELLS, "line 11: a cell has no more" },
	{ "cell-colour", HEAD IDENTITY "1 2 3 0.5 7 256 7\n" CELLS, "line 11: a colour of 256" },
	{ "cell-colour-real", HEAD IDENTITY "1 2 3 0.5 7 0.5 7\n" CELLS, "line 11: a cell is" },
	{ "cell-intensity", HEAD IDENTITY "1 2 3 -1e12\n" CELLS,
		"line 11: -1e+12 is too large for an intensity" },
	{ "cell-bad-when-beyond", HEAD IDENTITY "1 2 3 1507\n1 2 3 x\n" CELLS,
		"line 12: a cell is" },
	{ "cut-when-beyond", HEAD IDENTITY "1 2 3 1507\n1 2 3 0.5\n1 2 3 0.5\n",
		"line 14: the file ends here, and 1 of the 4" },
	{ "cell-colour-sometimes", HEAD IDENTITY "1 2 3 0.5 7 7 7\n" CELLS,
		"line 12: has 4 numbers" },
	{ "no-points", HEAD IDENTITY "0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n0 0 0 0.5\n", "no point" },
};

static void test_bad(gconstpointer data)
{
	const struct bad *b = data;
	struct place at = place_new();
	g_autofree char *good =
		place_write(&at, "good.ptx", HEAD IDENTITY CELLS, strlen(HEAD IDENTITY CELLS));
	g_autoptr(GArray) scans = place_import(&at, good);
	g_autofree char *path = place_write(&at, "bad.ptx", b->text, strlen(b->text));
	place_assert_refused(&at, path, G_IO_ERROR_INVALID_DATA, b->words);
	place_clear(&at);
}

static void test_bytes(void)
{
	struct place at = place_new();
	static const char zero[] = HEAD IDENTITY "1 2 3 0.5\n1 2 3\0 0.5\n" CELLS;
	g_autofree char *path = place_write(&at, "zero.ptx", zero, sizeof zero - 1);
	place_assert_refused(&at, path, G_IO_ERROR_INVALID_DATA, "line 12: ");
	g_autoptr(GString) text = g_string_new(HEAD IDENTITY "1 2 3 0.5");
	while (text->len < 3000000)
		g_string_append(text, "0000000000");
	g_autofree char *endless = place_write(&at, "endless.ptx", text->str, text->len);
	place_assert_refused(&at, endless, G_IO_ERROR_INVALID_DATA, "line 11: has more than");
	place_clear(&at);
}

/* Cut after any byte. What is left is whole only where a scan ends, or its very last number has lost digits, which nobody
 * can see. */
static void test_cut(void)
{
	struct place at = place_new();
	const char *one = HEAD IDENTITY
		"1 2 0.5 0.5 9 9 9\n1 2 0.4 0.5 9 9 9\n0 0 0 0.5 0 0 0\n1 2 0.3 0.5 9 9 9";
	g_autofree char *two = g_strconcat(one, "\n", one, "\n", NULL);
	size_t length = strlen(one);
	for (size_t cut = 1; cut < 2 * length; cut++) {
		g_autofree char *path = place_write(&at, "cut.ptx", two, cut);
		if (cut != length && cut != length + 1)
			place_assert_refused(&at, path, G_IO_ERROR_INVALID_DATA, "line ");
	}
	g_autofree char *path = place_write(&at, "cut.ptx", two, 2 * length + 1);
	g_autoptr(GArray) scans = place_import(&at, path);
	g_assert_cmpuint(scans->len, ==, 2);
	place_clear(&at);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(bads); i++) {
		g_autofree char *path = g_strconcat("/import-ptx-refused/", bads[i].path, NULL);
		g_test_add_data_func(path, &bads[i], test_bad);
	}
	g_test_add_func("/import-ptx-refused/bytes", test_bytes);
	g_test_add_func("/import-ptx-refused/cut", test_cut);
	return g_test_run();
}
