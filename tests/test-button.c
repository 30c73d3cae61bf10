/* The scanner's button while no head is open, on a made chip. */
#include "firmware-io/button.h"
#include "tests/gpio-made.h"

#define URI "tim:?stage.chip=made&stage.button=button"

struct bench {
	button *b;
	int presses;
	bool leaves; /* at the first press */
};

static void press(gpointer user_data)
{
	struct bench *t = user_data;
	t->presses++;
	if (t->leaves)
		g_clear_pointer(&t->b, button_free);
}

static void run_for(int64_t time_us)
{
	for (int64_t until_us = g_get_monotonic_time() + time_us;
		g_get_monotonic_time() < until_us;) {
		g_main_context_iteration(NULL, FALSE);
		g_usleep(1000);
	}
}

static void open_bench(struct bench *t)
{
	g_autoptr(GError) error = NULL;
	t->b = button_new_on(URI, made_open, press, t, &error);
	g_assert_no_error(error);
	g_assert_nonnull(t->b);
}

/* One that bounces counts once, and its release not at all. */
static void test_bounces(void)
{
	struct bench t = { 0 };
	open_bench(&t);
	run_for(5000);
	g_assert_cmpint(t.presses, ==, 0);
	for (int i = 0; i < 3; i++) {
		made_pull("button", true);
		made_pull("button", false);
	}
	made_pull("button", true);
	run_for(50000);
	g_assert_cmpint(t.presses, ==, 1);
	made_pull("button", false);
	made_pull("button", true);
	made_pull("button", false);
	run_for(50000);
	g_assert_cmpint(t.presses, ==, 1);
	made_pull("button", true);
	run_for(50000);
	g_assert_cmpint(t.presses, ==, 2);
	button_free(t.b);
}

/* Who is pressed lets go of the pins, to open a head. */
static void test_freed_when_pressed(void)
{
	struct bench t = { .leaves = true };
	open_bench(&t);
	made_pull("button", true);
	run_for(50000);
	g_assert_cmpint(t.presses, ==, 1);
	g_assert_null(t.b);
	g_assert_null(made_chip);
}

static void test_none(void)
{
	static const char *const without[] = { "sim:hall?seed=3", "replay:/nowhere",
		"tim:", "tim:?stage.chip=none&stage.button=button", "tim:?stage.chip=made" };
	for (size_t i = 0; i < G_N_ELEMENTS(without); i++) {
		g_autoptr(GError) error = NULL;
		g_assert_null(button_new_on(without[i], made_open, press, NULL, &error));
		g_assert_no_error(error);
	}
	g_autoptr(GError) error = NULL;
	g_assert_null(button_new_on("tim:?stage.buton=3", made_open, press, NULL, &error));
	g_assert_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/button/bounces", test_bounces);
	g_test_add_func("/button/freed-when-pressed", test_freed_when_pressed);
	g_test_add_func("/button/none", test_none);
	return g_test_run();
}
