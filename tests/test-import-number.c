/* Numbers in texts: to the last bit what strtod() says, and what is none is none. */
#include "process/import-number.h"
#include <glib.h>
#include <math.h>
#include <string.h>

static void assert_number(const char *text)
{
	g_autofree char *line = g_strconcat(text, " 1\n", NULL);
	const char *at = line;
	double value, wanted = g_ascii_strtod(text, NULL);
	g_assert_true(import_number(&at, &value));
	if (memcmp(&value, &wanted, sizeof value) != 0)
		g_test_message("%s reads as %.17g", text, value);
	g_assert_cmpmem(&value, sizeof value, &wanted, sizeof wanted);
	g_assert_cmpint(at - line, ==, (int)strlen(text));
}

static void test_numbers(void)
{
	static const char *const texts[] = { "0", "-0", "+1.5", ".25", "7.", "-11.3862",
		"637012.240000", "1e22", "1e23", "123456789012345678901234567890",
		"9007199254740993", "0.1e-20", "2.2250738585072011e-308", "4.9e-324",
		"1.7976931348623157e308", "1e-400", "0.000000000000000000000000000000123456789",
		"179769313486231570000e288", "6929495644600919.5",
		"3.14159265358979323846264338327950288419716939937510" };
	for (size_t i = 0; i < G_N_ELEMENTS(texts); i++)
		assert_number(texts[i]);
	g_autoptr(GRand) rand = g_rand_new_with_seed(7);
	for (int i = 0; i < 200000; i++) {
		char text[64], format[8];
		double value =
			g_rand_double_range(rand, -1, 1) * pow(10, g_rand_int_range(rand, -12, 13));
		g_snprintf(format, sizeof format, "%%.%d%c", g_rand_int_range(rand, 0, 19),
			"fge"[g_rand_int_range(rand, 0, 3)]);
		g_ascii_formatd(text, sizeof text, format, value);
		assert_number(text);
	}
}

static void test_no_numbers(void)
{
	static const char *const texts[] = { "", "-", ".", "e5", "nan", "inf", "-inf", "1e999",
		"-1e400", "x", "+-1", " 1" };
	for (size_t i = 0; i < G_N_ELEMENTS(texts); i++) {
		const char *at = texts[i];
		double value;
		g_assert_false(import_number(&at, &value));
		g_assert_true(at == texts[i]);
	}
	uint64_t whole;
	const char *most = "18446744073709551615", *more = "18446744073709551616", *minus = "-1";
	g_assert_true(import_integer(&most, &whole));
	g_assert_cmpuint(whole, ==, UINT64_MAX);
	g_assert_false(import_integer(&more, &whole));
	g_assert_false(import_integer(&minus, &whole));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/import-number/numbers", test_numbers);
	g_test_add_func("/import-number/none", test_no_numbers);
	return g_test_run();
}
