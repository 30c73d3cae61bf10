/* Any text as a style, and, before a zero byte, as the base of it. What is accepted is drawn on a small site: every leaf has one of
 * the pipelines, these are all different, and every parameter is within its range. What is refused is refused in one line. */
#include "firmware-io/files.h"
#include "render/style.h"
#include <math.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* ---- what there is once ---- */

static segments *tree;
static char *folder;

static void clear(void)
{
	files_remove_tree(folder, NULL);
	g_free(folder);
	segments_free(tree);
}

static void set_up(void)
{
	tree = segments_new();
	segments_add(tree, segment_of_class(CLASS_VEGETATION), "Tree 1", "rules");
	uint32_t house = segments_add(tree, segment_of_class(CLASS_BUILDING), "House", "rules");
	uint32_t wall = segments_add(tree, house, "Wall", "user");
	segments_add(tree, wall, "Door", "user");
	segments_add(tree, wall, "site", "user");
	folder = g_dir_make_tmp("fuzz-style-XXXXXX", NULL);
	atexit(clear);
}

/* ---- what holds always ---- */

static void check_parameter(const struct step_parameter *p, const void *in)
{
	const void *at = (const char *)in + p->offset;
	float number;
	int32_t whole;
	memcpy(&number, at, sizeof number);
	memcpy(&whole, at, sizeof whole);
	if (p->type == PARAMETER_NUMBER)
		g_assert_true(number >= (float)p->least && number <= (float)p->most);
	else if (p->type == PARAMETER_CHOICE)
		g_assert_true(whole >= 0 && whole < (int)g_strv_length((char **)p->choices));
	else if (p->type == PARAMETER_TEXTURE)
		g_assert_true(**(const char *const *)at);
	else if (p->type == PARAMETER_COLOUR)
		g_assert_cmpuint(((const uint8_t *)at)[3], ==, 255);
}

static void check_parameters(const struct step_parameter *p, const void *in)
{
	for (; p->name; p++)
		check_parameter(p, in);
}

static void check_pipeline(const struct pipeline *p)
{
	g_assert_cmpuint(p->layers + p->filters, <=, PIPELINE_STEPS_MAX);
	check_parameters(step_kind_find("mask")->parameters, &p->mask);
	for (uint32_t i = 0; i < p->layers + p->filters; i++) {
		const struct step *s = &p->steps[i];
		g_assert_true(s->kind->stage == (i < p->layers ? STEP_LAYER : STEP_FILTER));
		g_assert_true(isfinite(s->kind->radius_px(s->bytes)));
		check_parameters(s->kind->parameters, s->bytes);
		for (uint32_t k = 0; k < i; k++)
			g_assert_cmpstr(p->steps[k].id, !=, s->id);
	}
}

static void check_drawing(const drawing *d)
{
	g_assert_cmpuint(d->pipelines->len, >=, 1);
	g_assert_cmpuint(d->pipelines->len, <=, PIPELINES_MAX);
	for (const struct style_section *n = style_sections; n->name; n++)
		check_parameters(n->parameters, (const char *)&d->whole + n->offset);
	for (guint i = 0; i < d->pipelines->len; i++)
		check_pipeline(&g_array_index(d->pipelines, struct pipeline, i));
	for (uint32_t id = 0; id <= SEGMENTS_MAX; id++)
		g_assert_cmpuint(d->pipeline_of[id], <, d->pipelines->len);
}

static void check_error(const GError *error)
{
	g_assert_nonnull(error);
	g_assert_true(*error->message && g_utf8_validate(error->message, -1, NULL));
	for (const char *c = error->message; *c; c++)
		g_assert_false(g_ascii_iscntrl(*c));
}

static void draw(const style *s, const segments *on)
{
	g_autoptr(GError) error = NULL;
	g_auto(GStrv) unused = NULL;
	g_autoptr(drawing) d = drawing_new(s, on, &unused, &error);
	if (!d) {
		check_error(error);
		return;
	}
	check_drawing(d);
	g_assert_cmpuint(g_strv_length(unused), <=, s->nodes->len);
}

/* ---- an input ---- */

static style *load_both(
	const char *base, size_t base_length, const char *text, size_t length, GError **error)
{
	g_autofree char *base_path = g_build_filename(folder, "base.json", NULL),
			*path = g_build_filename(folder, "style.json", NULL);
	g_assert_true(g_file_set_contents(base_path, base, (gssize)base_length, NULL));
	g_assert_true(g_file_set_contents(path, text, (gssize)length, NULL));
	return style_load(path, error);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autoptr(GError) error = NULL;
	if (!tree)
		set_up();
	const char *text = (const char *)data, *zero = size ? memchr(data, 0, size) : NULL;
	size_t base = zero ? (size_t)(zero - text) : 0;
	g_autoptr(style) s =
		zero ? load_both(text, base, zero + 1, size - base - 1, &error)
		     : style_parse(size ? text : "", (gssize)size, "style.json", &error);
	if (!s) {
		check_error(error);
		return 0;
	}
	g_assert_true(s->name && s->title && s->source && s->description);
	draw(s, tree);
	draw(s, NULL);
	return 0;
}
