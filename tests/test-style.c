/* Styles: the table that they are read by, what every kind of mistake is told as, bases and where styles are found. */
#include "firmware-io/files.h"
#include "render/style-private.h"
#include "tests/simulated.h"
#include <glib/gstdio.h>
#include <string.h>
#include <unistd.h>

/* ---- the table ---- */

static void check_row(const struct step_kind *k, const struct step_parameter *p)
{
	g_assert_cmpuint(p->offset, <, k->size);
	g_assert_true(p->help && *p->help && p->unit);
	if (p->type == PARAMETER_NUMBER) {
		g_assert_cmpfloat(p->least, <=, p->slider_least);
		g_assert_cmpfloat(p->slider_least, <, p->slider_most);
		g_assert_cmpfloat(p->slider_most, <=, p->most);
		g_assert_true(p->least <= p->fallback && p->fallback <= p->most);
	}
	if (p->type == PARAMETER_CHOICE)
		g_assert_cmpint((int)p->fallback, <, g_strv_length((char **)p->choices));
	for (const struct step_parameter *other = p + 1; other->name; other++)
		g_assert_true(strcmp(other->name, p->name) && other->offset != p->offset);
}

static void test_table(void)
{
	static const char *const names[] = { "mask", "points", "sprites", "lines", "strokes",
		"hatching", "contours", "cut", "profile", "paint", "edl", "stipple", "kuwahara",
		"anisotropic-kuwahara", "bilateral", "gaussian", "gaps", "quantise", "dog", "edges",
		"watercolour", "flow", "oil", "pencil", "grade", "warp", "occlusion", "neural",
		"inpaint", "composite" };
	g_assert_cmpuint(G_N_ELEMENTS(names), <=, STEP_KINDS_MAX);
	for (size_t i = 0; i < G_N_ELEMENTS(names); i++) {
		const struct step_kind *k = &step_kinds[i];
		g_assert_cmpstr(k->name, ==, names[i]);
		g_assert_true(step_kind_find(names[i]) == k);
		g_assert_cmpuint(k->size, <=, STEP_SIZE_MAX);
		for (const struct step_parameter *p = k->parameters; p->name; p++)
			check_row(k, p);
		struct step s = step_defaults(k);
		g_assert_cmpfloat(k->radius_px(s.bytes), >=, 0);
	}
	g_assert_null(step_kinds[G_N_ELEMENTS(names)].name);
	g_assert_null(step_kind_find("stroke"));
}

static void test_defaults(void)
{
	struct step s = step_defaults(step_kind_find("strokes")),
		    dot = step_defaults(step_kind_find("sprites"));
	g_assert_cmpint(s.ink.points, ==, INK_DIRECTIONAL);
	g_assert_cmpstr(s.ink.texture, ==, "pencil");
	g_assert_cmpfloat(s.ink.spacing_px, ==, 9);
	g_assert_cmpmem(s.ink.ink, 4, "\x2b\x2b\x2b\xff", 4);
	g_assert_cmpfloat(s.ink.tone_white, ==, 0.95f);
	g_assert_cmpfloat(dot.ink.width_px, ==, 0);
	g_assert_null(dot.ink.texture);
	g_assert_true(step_parameter_find(s.kind->parameters, "texture"));
	g_assert_null(step_parameter_find(dot.kind->parameters, "texture"));
}

/* ---- what is wrong ---- */

#define STEPS(text) "{\"schema\":1,\n\"segments\":{\n\"site\":{\"steps\":[\n" text "]}}}"
#define NODES(text)                                                                                \
	STEPS("{\"step\":\"strokes\",\"id\":\"edges\"}]},\n" text ",\"water\":{\"add\":[")
#define AT_STEP        "x.json line 4: segments.site.steps[0]"
#define AT_NODE(text)  "x.json line 5: segments." text
#define AT_THING(text) "x.json line 5: segments" text

static const struct wrong {
	const char *text, *message;
} wrongs[] = {
	/* the text */
	{ "", "x.json line 1, column 1: a value is expected here" },
	{ "{\"schema\":1,\n// pencil\n}",
		"x.json line 2, column 1: there are no comments in JSON" },
	{ "{\"schema\":1,\n\"schema\":1}", "x.json line 2, column 1: this key is there twice" },
	{ "{\"schema\":1,\n\"title\":\"\xff\"}",
		"x.json line 2, column 10: this is not UTF-8 text" },
	/* a style */
	{ "\n[]", "x.json line 2: this is a list; it must be an object {...}" },
	{ "\n{}", "x.json line 2: 'schema' is missing; it is 1" },
	{ "{\"schema\":\"1\"}",
		"x.json line 1: schema: this is a text; it must be a whole number" },
	{ "{\"schema\":\n2,\"other\":1}",
		"x.json line 2: schema: a later version made this style; this one knows 1" },
	{ "{\"schema\":0}", "x.json line 1: schema: it is 1" },
	{ "{\"schema\":1}",
		"x.json line 1: nothing is drawn; it needs \"segments\", or a \"base\"" },
	{ "{\"schema\":1,\n\"segment\":{}}",
		"x.json line 2: segment: a style has no such field; did you mean 'segments'?" },
	{ "{\"schema\":1,\n\"x\":{}}", "x.json line 2: x: a style has no such field; there is "
				       "$schema, schema, name, title, "
				       "source, description, base, segments, paper, light, focus" },
	{ "{\"schema\":1,\"title\":\"\"}",
		"x.json line 1: title: a text has 1 to 1000 bytes; this one has 0" },
	{ "{\"schema\":1,\"title\":\"a\\u001b[2J\"}",
		"x.json line 1: title: line breaks and control characters cannot be in it" },
	{ "{\"schema\":1,\"name\":\"a/b\"}", "x.json line 1: name: 'a/b' is not a name of a style; "
					     "it has letters, digits, '-' and "
					     "'_', and at most 64 of them" },
	{ "{\"schema\":1,\n\"base\":\"pointz\"}",
		"x.json line 2: base: there is no style 'pointz'; did you mean 'points'?" },
	{ "{\"schema\":1,\n\"base\":\"no/such.json\"}",
		"x.json line 2: base: no/such.json: cannot open: No such file or directory" },
	/* the paper */
	{ "{\"schema\":1,\"paper\":[]}",
		"x.json line 1: paper: this is a list; it must be an object" },
	{ "{\"schema\":1,\"paper\":{\n\"color\":\"#fff\"}}",
		"x.json line 2: paper.color: paper has no such field; did you mean 'colour'?" },
	{ "{\"schema\":1,\"paper\":{\n\"colour\":\"#fff\"}}",
		"x.json line 2: paper.colour: '#fff' is no colour; colours are \"#rrggbb\"" },
	{ "{\"schema\":1,\"paper\":{\"colour\":\"#ffgfff\"}}",
		"x.json line 1: paper.colour: '#ffgfff' is no colour; colours are \"#rrggbb\"" },
	{ "{\"schema\":1,\"paper\":{\"colour\":0}}",
		"x.json line 1: paper.colour: this is a number; it must be a colour \"#rrggbb\"" },
	{ "{\"schema\":1,\"paper\":{\"grain\":-1}}",
		"x.json line 1: paper.grain: -1 is too little; it goes from 0 to 1" },
	/* steps */
	{ STEPS("{\"step\":\"strokes\",\n\"length_px\":900}"),
		"x.json line 5: segments.site.steps[0].length_px: 900 is too much; it goes from 1 "
		"to "
		"400 px" },
	{ STEPS("{\"step\":\"points\"},\n{\"step\":\"strokes\",\"length_px\":0.5}"),
		"x.json line 5: segments.site.steps[1].length_px: 0.5 is too little; it goes from "
		"1 to "
		"400 px" },
	{ STEPS("{\"step\":\"strokes\",\"length_px\":\"9\"}"),
		AT_STEP ".length_px: this is a text; it must be a number from 1 to 400 px" },
	{ STEPS("{\"step\":\"strokes\",\"lenght_px\":9}"),
		AT_STEP ".lenght_px: 'strokes' has no such field; did you mean 'length_px'?" },
	{ STEPS("{\"step\":\"lines\",\"angle\":9}"),
		AT_STEP ".angle: 'lines' has no such field; did you mean 'angle_deg'?" },
	{ STEPS("{\"step\":\"lines\",\"texture\":\"pencil\"}"),
		AT_STEP ".texture: 'lines' has no such parameter; 'strokes' has" },
	{ STEPS("{\"step\":\"edl\",\"x\":1}"),
		AT_STEP ".x: 'edl' has no such field; there is strength, radius_px" },
	{ STEPS("{\"step\":\"strokes\",\"points\":\"directionel\"}"),
		AT_STEP ".points: there is no 'directionel'; it is one of all, surface, features, "
			"directional, non-directional, dithering; did you mean 'directional'?" },
	{ STEPS("{\"step\":\"strokes\",\"tone\":\"dotted\"}"),
		AT_STEP ".tone: there is no 'dotted'; it is one of even, colour" },
	{ STEPS("{\"step\":\"strokes\",\"tone\":1}"),
		AT_STEP ".tone: this is a number; it must be one of even, colour" },
	{ STEPS("{\"step\":\"strokes\",\"texture\":\"a b\"}"), AT_STEP
		".texture: 'a b' is not the name of a texture, or the path of a PNG; it has "
		"letters, digits, '-' and '_', and at most 64 of them" },
	{ STEPS("{\"step\":\"strokes\",\"texture\":\"a/b.jpg\"}"),
		AT_STEP ".texture: a texture is the path of a .png" },
	{ STEPS("{\"step\":\"storkes\"}"),
		AT_STEP ".step: there is no step 'storkes'; did you mean 'strokes'?" },
	{ STEPS("{\"id\":\"x\"}"), AT_STEP ": 'step' is missing; 'pleinair styles --steps' "
					   "tells what there is" },
	{ STEPS("{\"step\":\"neural\",\"model\":\"a.png\"}"),
		AT_STEP ".model: a network is the path of a .onnx" },
	{ STEPS("{\"step\":\"inpaint\"},{\"step\":\"inpaint\",\"id\":\"again\"}"),
		"x.json line 4: segments.site.steps[1]: there is 'inpaint' already, and only one "
		"in "
		"a pipeline; change it" },
	{ STEPS("{\"step\":\"composite\"}"), AT_STEP ": 'composite' is of \"picture\" alone" },
	{ "{\"schema\":1,\n\"segments\":{\"picture\":{\"steps\":[\n{\"step\":\"lines\"}]}}}",
		"x.json line 3: segments.picture.steps[0]: 'lines' is of points; a picture has "
		"filters alone" },
	/* lists */
	{ STEPS("{\"step\":\"hatching\",\"xtoon\":[]}"),
		AT_STEP ".xtoon: it has 1 to 64 elements; these are 0" },
	{ STEPS("{\"step\":\"hatching\",\"xtoon\":{}}"),
		AT_STEP ".xtoon: this is an object; it must be a list" },
	{ STEPS("{\"step\":\"hatching\",\"xtoon\":\"ramp\"}"),
		AT_STEP ".xtoon: it is a list of stops, or the path of a .png" },
	{ STEPS("{\"step\":\"hatching\",\"xtoon\":[\n{\"brightness\":2}]}"),
		"x.json line 5: segments.site.steps[0].xtoon[0].brightness: 2 is too much; it goes "
		"from 0 to 1" },
	{ STEPS("{\"step\":\"hatching\",\"xtoon\":[{\"chance\":1}]}"),
		AT_STEP ".xtoon[0]: \"brightness\" is missing" },
	{ STEPS("{\"step\":\"hatching\",\"xtoon\":[{\"brightness\":1,\"color\":1}]}"),
		AT_STEP ".xtoon[0].color: a stop has no such field; did you mean 'colour'?" },
	{ STEPS("{\"step\":\"hatching\",\"pencils\":[\"#ff0000\",\n\"red\"]}"),
		"x.json line 5: segments.site.steps[0].pencils[1]: 'red' is no colour; colours are "
		"\"#rrggbb\"" },
	{ STEPS("{\"step\":\"hatching\",\"pencils\":\"#ff0000\"}"),
		AT_STEP ".pencils: this is a text; it must be a list" },
	{ STEPS("{\"step\":null}"), AT_STEP ".step: this is null; it must be the name of a step" },
	{ STEPS("\"points\""), AT_STEP ": this is a text; it must be a step {\"step\": ...}" },
	{ STEPS("{\"step\":\"points\",\"id\":\"\"}"), AT_STEP
		".id: '' is not an id; it has letters, digits, '-' and '_', and at most 64 of "
		"them" },
	{ STEPS("{\"step\":\"points\"},\n{\"step\":\"points\"}"),
		"x.json line 5: segments.site.steps[1]: there is a step with the id 'points' "
		"already; "
		"give this one another \"id\"" },
	{ STEPS("{\"step\":\"points\",\"id\":\"mask\"}"), AT_STEP
		": there is a step with the id 'mask' already; give this one another \"id\"" },
	{ STEPS("{\"step\":\"mask\",\"id\":\"m\"}"),
		AT_STEP ".id: the id of a mask is always 'mask'" },
	{ STEPS("{\"step\":\"mask\"},\n{\"step\":\"mask\"}"),
		"x.json line 5: segments.site.steps[1]: there is a mask already, and only one in a "
		"pipeline; change it" },
	/* nodes */
	{ "{\"schema\":1,\"segments\":[]}",
		"x.json line 1: segments: this is a list; it must be an object of nodes" },
	{ NODES("\"building\":[]"),
		AT_NODE("building: this is a list; it must be an object with \"steps\", or with "
			"\"change\", \"remove\" and \"add\"") },
	{ NODES("\"\":{}"), AT_THING("[\"\"]: a node without a name") },
	{ NODES("\"#0\":{}"),
		AT_NODE("#0: behind a # stands the number of a segment, 1 to 65535") },
	{ NODES("\"#x\":{}"),
		AT_NODE("#x: behind a # stands the number of a segment, 1 to 65535") },
	{ NODES("\"Tree 4\":{\"stepps\":[]}"),
		AT_THING("[\"Tree 4\"].stepps: a node has no such field; did you mean 'steps'?") },
	{ NODES("\"building\":{\"steps\":[],\"add\":[]}"),
		AT_NODE("building.add: 'steps' replaces all that is inherited, so nothing else can "
			"stand beside it") },
	{ NODES("\"building\":{\"steps\":{}}"),
		AT_NODE("building.steps: this is an object; it must be a list of steps") },
	{ NODES("\"building\":{\"change\":[]}"),
		AT_NODE("building.change: this is a list; it must be an object of ids") },
	{ NODES("\"building\":{\"change\":{\"edges\":1}}"),
		AT_NODE("building.change.edges: this is a number; it must be an object of "
			"parameters") },
	{ NODES("\"building\":{\"change\":{\"edge\":{}}}"),
		AT_NODE("building.change.edge: no step with the id 'edge' is inherited here; did "
			"you "
			"mean 'edges'?") },
	{ NODES("\"building\":{\"change\":{\"edges\":{\"opacity\":2}}}"),
		AT_NODE("building.change.edges.opacity: 2 is too much; it goes from 0 to 1") },
	{ NODES("\"building\":{\"change\":{\"edges\":{\"step\":\"lines\"}}}"),
		AT_NODE("building.change.edges.step: a step stays what it is; remove it, and add "
			"another one") },
	{ NODES("\"building\":{\"remove\":\"edges\"}"),
		AT_NODE("building.remove: this is a text; it must be a list of ids") },
	{ NODES("\"building\":{\"remove\":[\"edges\",1]}"),
		AT_NODE("building.remove[1]: this is a number; it must be the id of a step") },
	{ NODES("\"building\":{\"remove\":[\"edges\",\"edges\"]}"),
		AT_NODE("building.remove[1]: no step with the id 'edges' is inherited here; there "
			"is "
			"mask") },
	{ NODES("\"building\":{\"remove\":[\"mask\"]}"),
		AT_NODE("building.remove[0]: every pipeline has a mask; change it") },
	{ NODES("\"building\":{\"add\":[{\"step\":\"lines\",\"id\":\"edges\"}]}"),
		AT_NODE("building.add[0]: there is a step with the id 'edges' already; give this "
			"one "
			"another \"id\"") },
	/* things, whose place in a tree is not known */
	{ NODES("\"Tree 4\":{\"change\":{\"leaves\":{}}}"),
		AT_THING("[\"Tree 4\"].change.leaves: no step of this style has the id 'leaves'") },
	{ NODES("\"Tree 4\":{\"remove\":[\"leaves\"]}"),
		AT_THING("[\"Tree 4\"].remove[0]: no step of this style has the id 'leaves'") },
	{ NODES("\"#19\":{\"change\":{\"edges\":{\"size\":2}}}"),
		AT_NODE("#19.change.edges.size: 'strokes' has no such parameter; 'points' has") },
	{ NODES("\"a\\u001b[1m\":{\"x\":0}"), AT_THING("[\"a\xef\xbf\xbd[1m\"].x: a node has no "
						       "such field; there is steps, change, "
						       "remove, add") },
};

static void test_wrong(gconstpointer data)
{
	const struct wrong *w = data;
	g_autoptr(GError) error = NULL;
	g_assert_null(style_parse(w->text, -1, "x.json", &error));
	g_assert_nonnull(error);
	g_assert_cmpstr(error->message, ==, w->message);
	g_assert_true(error->domain == STYLE_ERROR);
	g_assert_null(style_parse(w->text, -1, "x.json", NULL));
}

static char *many_steps(int count)
{
	GString *text = g_string_new("{\"schema\":1,\"segments\":{\"site\":{\"steps\":[");
	for (int i = 0; i < count; i++)
		g_string_append_printf(
			text, "%s{\"step\":\"points\",\"id\":\"p%d\"}", i ? ",\n" : "", i);
	g_string_append(text, "]}}}");
	return g_string_free(text, FALSE);
}

static void test_limits(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *few = many_steps(16), *many = many_steps(17), *deep = g_strnfill(100, '['),
			*large = g_strnfill(STYLE_BYTES_MAX + 1, ' ');
	g_autoptr(style) s = style_parse(few, -1, "x.json", &error);
	g_assert_no_error(error);
	g_assert_null(style_parse(many, -1, "x.json", &error));
	g_assert_cmpstr(error->message, ==,
		"x.json line 17: segments.site.steps[16]: this is one step too many; a pipeline "
		"has "
		"at most 16 beside the mask");
	g_clear_error(&error);
	g_assert_null(style_parse(deep, -1, "x.json", &error));
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_JSON);
	g_assert_cmpstr(error->message, ==, "x.json line 1, column 65: this is nested too deeply");
	g_clear_error(&error);
	g_assert_null(style_parse(large, -1, "x.json", &error));
	g_assert_cmpstr(
		error->message, ==, "x.json has 1048577 bytes; a style has at most 1048576");
}

/* ---- what is read ---- */

static void test_fields(void)
{
	static const char text[] =
		"{\"schema\":1,\"name\":\"mine\",\"title\":\"T\\u00ef\",\"source\":\"pleinair\","
		"\"description\":\"D\",\"paper\":{\"colour\":\"#10aBfe\",\"grain\":1,\"scale\":2.5,"
		"\"texture\":\"/p/w.png\"},\"segments\":{\"site\":{}}}";
	g_autoptr(GError) error = NULL;
	g_autoptr(style) s = style_parse(text, sizeof text - 1, "x.json", &error);
	g_assert_no_error(error);
	g_assert_cmpstr(s->name, ==, "mine");
	g_assert_cmpstr(s->title, ==, "T\xc3\xaf");
	g_assert_cmpstr(s->source, ==, "pleinair");
	g_assert_cmpstr(s->description, ==, "D");
	g_assert_null(s->path);
	g_assert_cmpmem(s->whole.paper.colour, 4, "\x10\xab\xfe\xff", 4);
	g_assert_cmpfloat(s->whole.paper.grain, ==, 1);
	g_assert_cmpfloat(s->whole.paper.scale, ==, 2.5f);
	g_assert_cmpstr(s->whole.paper.texture, ==, "/p/w.png");
	g_autoptr(style) plain = style_parse(
		"{\"schema\":1,\"segments\":{\"site\":{}}}", -1, "a/plain.json", &error);
	g_assert_no_error(error);
	g_assert_cmpstr(plain->name, ==, "plain");
	g_assert_cmpstr(plain->title, ==, "plain");
	g_assert_cmpstr(plain->source, ==, "user");
	g_assert_cmpstr(plain->description, ==, "");
	g_assert_cmpstr(plain->whole.paper.texture, ==, "cartridge");
}

/* ---- files ---- */

static char *folder;

/* Caller frees the path. */
static char *put(const char *name, const char *text)
{
	char *path = g_build_filename(folder, name, NULL);
	g_autofree char *in = g_path_get_dirname(path);
	g_assert_cmpint(g_mkdir_with_parents(in, 0700), ==, 0);
	g_assert_true(g_file_set_contents(path, text, -1, NULL));
	return path;
}

#define BASE                                                                                       \
	"{\"schema\":1,\"source\":\"Paper "                                                        \
	"2004\",\"paper\":{\"colour\":\"#112233\",\"grain\":0.5},"                                 \
	"\"light\":{\"amount\":0.5,\"azimuth_deg\":90},\"focus\":{\"radius_m\":3},"                \
	"\"segments\":{\"site\":{\"steps\":[{\"step\":\"strokes\",\"texture\":\"t/a.png\"},"       \
	"{\"step\":\"points\"}]},\"water\":{\"remove\":[\"points\"]}}}"

static void test_base(void)
{
	g_autofree char *base = put("base/one.json", BASE);
	g_autofree char *path = put("base/two.json",
		"{\"schema\":1,\"base\":\"one\",\"paper\":{\"grain\":0.25},"
		"\"light\":{\"amount\":0.75},\"focus\":{\"x_m\":-7},\"segments\":{"
		"\"site\":{\"change\":{\"strokes\":{\"length_px\":77}}},"
		"\"water\":{\"steps\":[{\"step\":\"edl\"}]}}}");
	g_autoptr(GError) error = NULL;
	g_autoptr(style) s = style_load(path, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(s->name, ==, "two");
	g_assert_cmpstr(s->source, ==, "Paper 2004");
	g_assert_cmpmem(s->whole.paper.colour, 3, "\x11\x22\x33", 3);
	g_assert_cmpfloat(s->whole.paper.grain, ==, 0.25f);
	g_assert_cmpfloat(s->whole.light.amount, ==, 0.75f);
	g_assert_cmpfloat(s->whole.light.azimuth_deg, ==, 90);
	g_assert_cmpfloat(s->whole.light.elevation_deg, ==, 45);
	g_assert_cmpfloat(s->whole.focus.x_m, ==, -7);
	g_assert_cmpfloat(s->whole.focus.radius_m, ==, 3);
	g_assert_false(style_focus_is_there(&s->whole.focus));
	g_autoptr(drawing) d = drawing_new(s, NULL, NULL, &error);
	g_assert_no_error(error);
	const struct pipeline *p = &g_array_index(d->pipelines, struct pipeline, 0);
	g_autofree char *texture = g_build_filename(folder, "base", "t/a.png", NULL);
	g_assert_cmpuint(p->layers, ==, 2);
	g_assert_cmpfloat(p->steps[0].ink.length_px, ==, 77);
	g_assert_cmpstr(p->steps[0].ink.texture, ==, texture);
	/* a base that is wrong, and one that a change here makes wrong */
	g_autofree char
		*bad = put("base/bad.json", "{\"schema\":1,\"base\":\"./three.json\"}"),
		*three = put("base/three.json", "{\"schema\":1,\n\"x\":1}"),
		*other = put("base/other.json",
			"{\"schema\":1,\"base\":\"one\",\"segments\":{\"site\":{\"steps\":[]}}}");
	g_assert_null(style_load(bad, &error));
	g_autofree char *start =
		g_strdup_printf("%s line 1: base: %s/base/./three.json line 2: x: ", bad, folder);
	g_assert_true(g_str_has_prefix(error->message, start));
	g_clear_error(&error);
	g_assert_null(style_load(other, &error));
	g_autofree char *inherited =
		g_strdup_printf("%s line 1: segments.water.remove[0]: no step "
				"with the id 'points' is inherited here; there "
				"is mask",
			base);
	g_assert_cmpstr(error->message, ==, inherited);
}

static void test_circle(void)
{
	g_autofree char *one = put("circle/one.json", "{\"schema\":1,\n\"base\":\"two\"}"),
			*two = put("circle/two.json", "{\"schema\":1,\n\n\"base\":\"one\"}"),
			*self = put("circle/self.json", "{\"schema\":1,\"base\":\"self\"}");
	g_autoptr(GError) error = NULL;
	g_assert_null(style_load(one, &error));
	g_autofree char *message = g_strdup_printf(
		"%s line 2: base: %s line 3: base: %s is based on what it is the base of", one, two,
		one);
	g_assert_cmpstr(error->message, ==, message);
	g_clear_error(&error);
	g_assert_null(style_load(self, &error));
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_FIELD);
	g_clear_error(&error);
	for (int i = 0; i < 20; i++) {
		g_autofree char *name = g_strdup_printf("circle/c%d.json", i),
				*text = g_strdup_printf("{\"schema\":1,\"base\":\"c%d\"}", i + 1),
				*path = put(name, text);
	}
	g_autofree char *chain = g_build_filename(folder, "circle", "c0.json", NULL);
	g_assert_null(style_load(chain, &error));
	g_assert_true(g_str_has_suffix(error->message, "is the base of too many bases"));
}

static void test_file(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *missing = g_build_filename(folder, "none.json", NULL);
	g_assert_null(style_load(missing, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_clear_error(&error);
	g_assert_null(style_load(folder, &error));
	g_clear_error(&error);
	g_autofree char *named = put("file/a.json", "{\"schema\":1,\"name\":\"b\"}");
	g_assert_null(style_load(named, &error));
	g_assert_nonnull(strstr(error->message,
		"line 1: name: a style has the name of its file, 'a'; leave this out"));
}

#define TITLED(title) "{\"schema\":1,\"title\":\"" title "\",\"segments\":{\"site\":{}}}"

static void assert_found(const char *name, const char *site_path, const char *title)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(style) s = style_find(name, site_path, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(s->title, ==, title);
}

/* Sorted, each once, and only what can be typed. */
static void assert_names(const char *site_path)
{
	static const char *const wanted[] = { "mixed", "pencil", "points", "quill" };
	g_auto(GStrv) names = style_names(site_path);
	for (char **name = names; *name; name++) {
		g_assert_true(name == names || strcmp(name[-1], *name) < 0);
		g_assert_null(strpbrk(*name, " ."));
	}
	for (size_t i = 0; i < G_N_ELEMENTS(wanted); i++)
		g_assert_true(g_strv_contains((const char *const *)names, wanted[i]));
}

/* The site's own first, then the variable's, the user's, and the shipped ones. */
static void test_find(void)
{
	g_autofree char *site_path = g_build_filename(folder, "site", NULL),
			*listed = g_strdup_printf("%s/list-a::%s/list-b", folder, folder);
	g_autofree char *a = put("site/styles/pencil.json", TITLED("site's")),
			*b = put("list-a/pencil.json", TITLED("a's")),
			*c = put("list-b/pencil.json", TITLED("b's")),
			*d = put("list-b/quill.json", TITLED("b's")),
			*e = put("data/pleinair/styles/quill.json", TITLED("user's")),
			*f = put("data/pleinair/styles/points.json", TITLED("user's points")),
			*g = put("list-a/not a name.json", "x"), *h = put("list-a/other.txt", "x");
	g_setenv("PLEINAIR_STYLES", listed, TRUE);
	assert_found("pencil", site_path, "site's");
	assert_found("pencil", NULL, "a's");
	assert_found("quill", NULL, "b's");
	assert_found("points", NULL, "user's points");
	assert_found("mixed", NULL, "Ink among coloured points");
	assert_found(d, NULL, "b's");
	assert_names(site_path);
	g_autoptr(GError) error = NULL;
	g_assert_null(style_find("Pensil", NULL, &error));
	g_assert_error(error, STYLE_ERROR, STYLE_ERROR_UNKNOWN);
	g_assert_cmpstr(error->message, ==, "there is no style 'Pensil'; did you mean 'pencil'?");
	g_clear_error(&error);
	g_assert_null(style_find("./pencil", NULL, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_unsetenv("PLEINAIR_STYLES");
}

/* ---- what is shipped ---- */

static void test_shipped(void)
{
	g_autoptr(GError) error = NULL;
	g_auto(GStrv) names = style_names(NULL);
	g_assert_cmpuint(g_strv_length(names), >=, 10);
	for (char **name = names; *name; name++) {
		g_autoptr(style) s = style_find(*name, NULL, &error);
		g_assert_no_error(error);
		g_assert_true(*s->title && *s->description && strcmp(s->source, "user"));
		g_autoptr(drawing) d = drawing_new(s, NULL, NULL, &error);
		g_assert_no_error(error);
		g_assert_cmpuint(g_array_index(d->pipelines, struct pipeline, 0).layers, >, 0);
	}
}

/* render/style.schema.json is what `pleinair styles --schema` prints. */
static void test_schema(void)
{
	const char *source = g_getenv("PLEINAIR_SOURCE");
	g_autofree char *path =
		g_build_filename(source ? source : ".", "render", "style.schema.json", NULL);
	g_autofree char *committed = NULL, *made = style_schema();
	g_assert_true(g_file_get_contents(path, &committed, NULL, NULL));
	if (strcmp(committed, made))
		g_test_message("renew it: build/bin/pleinair styles --schema > %s", path);
	g_assert_cmpstr(committed, ==, made);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	folder = simulated_folder();
	g_autofree char *data = g_build_filename(folder, "data", NULL);
	g_setenv("XDG_DATA_HOME", data, TRUE); /* before anything asks for it */
	g_test_add_func("/style/table", test_table);
	g_test_add_func("/style/defaults", test_defaults);
	for (size_t i = 0; i < G_N_ELEMENTS(wrongs); i++) {
		g_autofree char *path = g_strdup_printf("/style/wrong/%zu", i);
		g_test_add_data_func(path, &wrongs[i], test_wrong);
	}
	g_test_add_func("/style/limits", test_limits);
	g_test_add_func("/style/fields", test_fields);
	g_test_add_func("/style/shipped", test_shipped);
	g_test_add_func("/style/base", test_base);
	g_test_add_func("/style/circle", test_circle);
	g_test_add_func("/style/file", test_file);
	g_test_add_func("/style/find", test_find);
	g_test_add_func("/style/schema", test_schema);
	int status = g_test_run();
	files_remove_tree(folder, NULL);
	g_free(folder);
	return status;
}
