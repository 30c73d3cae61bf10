/* One picture, two backends: the small scene by every shipped style. */
#include "tests/parity-drawn.h"

static void test_style(gconstpointer data)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(gles_draw) d = gles_here_draw();
	if (!d)
		return;
	g_autoptr(style) how = style_load(data, &error);
	g_assert_no_error(error);
	compare(d, how->name, how);
}

static void add_styles(void)
{
	const char *source = g_getenv("PLEINAIR_SOURCE");
	g_autofree char *folder = g_build_filename(source ? source : ".", "render", "styles", NULL);
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	for (const char *name; dir && (name = g_dir_read_name(dir));) {
		g_autofree char *test = g_strdup_printf("/parity/style/%s", name);
		g_test_add_data_func_full(
			test, g_build_filename(folder, name, NULL), test_style, g_free);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	add_styles();
	int status = g_test_run();
	gles_context_free(gles_here_context);
	return status;
}
