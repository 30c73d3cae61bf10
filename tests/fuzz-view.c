/* Any text as a saved view: what is accepted makes a camera, and is written so that it reads back the same. */
#include "render/view.h"
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_same(const view *a, const view *b)
{
	g_assert_cmpstr(a->name, ==, b->name);
	g_assert_cmpstr(a->title, ==, b->title);
	g_assert_cmpstr(a->style, ==, b->style);
	for (int k = 0; k < 3; k++) {
		g_assert_true(a->eye_m[k] == b->eye_m[k]);
		g_assert_true(a->target_m[k] == b->target_m[k]);
	}
	g_assert_true(a->fov_deg == b->fov_deg && a->height_m == b->height_m &&
		      a->depth_m == b->depth_m && a->is_cut == b->is_cut && a->cut_m == b->cut_m &&
		      a->span_m[0] == b->span_m[0] && a->span_m[1] == b->span_m[1]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(view) v = view_parse((const char *)data, size, "x", &error);
	g_assert_true((v == NULL) == (error != NULL));
	if (!v)
		return 0;
	struct camera c = view_camera(v, 640, 480);
	g_assert_true(camera_validate(&c, &error));
	g_autofree char *text = view_to_text(v);
	g_autoptr(view) again = view_parse(text, strlen(text), "x", &error);
	g_assert_no_error(error);
	check_same(v, again);
	return 0;
}
