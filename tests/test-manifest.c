/* Manifests: strict reading with places in messages, faithful writing, and saving that a kill
 * cannot tear. */
#include "acquire/manifest.h"
#include "acquire/strict-json.h"
#include "firmware-io/files.h"
#include <glib/gstdio.h>
#include <locale.h>
#include <math.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { KILLS = 200 };

static manifest *parse(const char *text, GError **error)
{
	return manifest_parse(text, strlen(text), "oak/site.json", 1, error);
}

static void test_values(void)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(manifest) m = parse("{\"schema\": 1, \"a\": {\"b\": {\"c\": -7}}, \"whole\": 3.0,"
				      " \"x\": 0.25, \"s\": \"\\u00e4 \\ud83d\\ude00 \\\"q\\\"\"}",
		&error);
	g_assert_no_error(error);
	int64_t i;
	double d;
	g_assert_true(manifest_get_int(m, "a.b.c", -10, 0, &i, NULL) && i == -7);
	g_assert_true(manifest_get_number(m, "a.b.c", -10, 0, &d, NULL) && d == -7);
	g_assert_true(manifest_get_int(m, "whole", 0, 9, &i, NULL) && i == 3);
	g_assert_true(manifest_get_number(m, "x", 0, 1, &d, NULL) && d == 0.25);
	g_assert_cmpstr(manifest_get_string(m, "s", NULL), ==, "ä 😀 \"q\"");
	g_assert_true(manifest_has(m, "a.b") && !manifest_has(m, "a.c"));
	g_assert_false(manifest_has(m, "x.y"));
	g_assert_true(JSON_NODE_HOLDS_OBJECT(manifest_get_node(m, "a")));
}

/* A getter's sentence; ret stays untouched. */
static void check_getter(const manifest *m, const char *key, const char *as, const char *message)
{
	g_autoptr(GError) error = NULL;
	int64_t i = 42;
	double d = 42;
	if (*as == 'i')
		g_assert_false(manifest_get_int(m, key, 1, 65535, &i, &error));
	else if (*as == 'n')
		g_assert_false(manifest_get_number(m, key, 0.5, 2, &d, &error));
	else
		g_assert_null(manifest_get_string(m, key, &error));
	g_assert_true(i == 42 && d == 42);
	g_autofree char *whole = g_strdup_printf("oak/site.json: %s", message);
	g_assert_cmpstr(error->message, ==, whole);
}

static void test_getters_refuse(void)
{
	g_autoptr(manifest) m =
		parse("{\"schema\":1,\"i\":70000,\"t\":\"12\",\"h\":1.5,\"n\":null,\"l\":[1],"
		      "\"o\":{},\"b\":true,\"big\":1e300,\"odd\":9007199254740993.0}",
			NULL);
	check_getter(m, "nothing", "int", "'nothing' is missing");
	check_getter(m, "o.nothing", "text", "'o.nothing' is missing");
	check_getter(m, "i", "int", "'i' is 70000; it must be 1 to 65535");
	check_getter(m, "t", "int", "'t' is a text; it must be a whole number");
	check_getter(m, "t", "number", "'t' is a text; it must be a number");
	check_getter(m, "h", "int", "'h' is 1.5; it must be a whole number");
	check_getter(m, "big", "int", "'big' is 1e+300; it must be a whole number");
	check_getter(m, "i", "number", "'i' is 70000; it must be 0.5 to 2");
	check_getter(m, "n", "number", "'n' is null; it must be a number");
	check_getter(m, "b", "int", "'b' is true or false; it must be a whole number");
	check_getter(m, "l", "text", "'l' is a list; it must be a text");
	check_getter(m, "o", "text", "'o' is an object; it must be a text");
	check_getter(m, "i", "text", "'i' is a number; it must be a text");
}

static const struct {
	const char *text, *message;
} bad_texts[] = {
	{ "", "is empty" },
	{ " ", "line 1, column 2: a value is expected here" },
	{ "[1]", "does not hold an object {...}" },
	{ "{}", "'schema' is missing" },
	{ "{\"schema\":\"1\"}", "'schema' is a text; it must be a whole number" },
	{ "{\"schema\":0}", "'schema' is 0; it must be 1 to 2147483647" },
	{ "{\"schema\":2}", "was written by a later version (schema 2; this program knows 1)" },
	{ "{\n\"ä\":\n 1 2}", "line 3, column 4: a comma or '}' is expected here" },
	{ "{\"ä\" 1}", "line 1, column 6: a colon is expected here" },
	{ "{\"a\":1,}", "line 1, column 8: a text in quotation marks is expected here" },
	{ "{'a':1}", "line 1, column 2: a text in quotation marks is expected here" },
	{ "{\"a\":[1,]}", "line 1, column 9: a value is expected here" },
	{ "{\"a\":[1}", "line 1, column 8: a comma or ']' is expected here" },
	{ "{\"a\":1} x", "line 1, column 9: nothing more is expected here" },
	{ "{\"a\":1}{}", "line 1, column 8: nothing more is expected here" },
	{ "/**/{}", "line 1, column 1: there are no comments in JSON" },
	{ "{\n// x\n}", "line 2, column 1: there are no comments in JSON" },
	{ "{\"a\":1 /* x */}", "line 1, column 8: there are no comments in JSON" },
	{ "{\"a\":1,\n \"a\":2}", "line 2, column 2: this key is there twice" },
	{ "{\"a\":1,\"\\u0061\":2}", "line 1, column 8: this key is there twice" },
	{ "{\"a\":NaN}", "line 1, column 6: a value is expected here" },
	{ "{\"a\":-Infinity}", "line 1, column 6: a value is expected here" },
	{ "{\"a\":010}", "line 1, column 6: a number must not begin with a zero" },
	{ "{\"a\":0x10}", "line 1, column 7: a comma or '}' is expected here" },
	{ "{\"a\":1.}", "line 1, column 8: a digit is expected here" },
	{ "{\"a\":1,5e}", "line 1, column 8: a text in quotation marks is expected here" },
	{ "{\"a\":1e+}", "line 1, column 9: a digit is expected here" },
	{ "{\"a\":1e999}", "line 1, column 6: this number is too large" },
	{ "{\"a\":9223372036854775808}", "line 1, column 6: this number does not fit in 64 bits" },
	{ "{\"a\":-9223372036854775809}", "line 1, column 6: this number does not fit in 64 bits" },
	{ "{\"a\":tru}", "line 1, column 6: a value is expected here" },
	{ "{\"a\":\"b}", "line 1, column 6: this text has no closing quotation mark" },
	{ "{\"a\":\"b\nc\"}", "line 1, column 8: a line break or control character inside a text" },
	{ "{\"a\":\"\\x\"}", "line 1, column 7: this is no escape that JSON knows" },
	{ "{\"a\":\"\\u0000\"}", "line 1, column 7: this is no escape that JSON knows" },
	{ "{\"a\":\"\\ud83d\"}", "line 1, column 7: this is no escape that JSON knows" },
	{ "{\"a\":\"\\ude00\"}", "line 1, column 7: this is no escape that JSON knows" },
	{ "{\"a\":\"\\u12", "line 1, column 7: this is no escape that JSON knows" },
	{ "{\"a\":\"\\", "line 1, column 7: this is no escape that JSON knows" },
	{ "{\"a\":\"\xff\"}", "line 1, column 7: this is not UTF-8 text" },
	{ "{\"a\":\"\xed\xa0\x80\"}", "line 1, column 7: this is not UTF-8 text" },
};

/* Lines are those of values, whatever stands between them and their keys. */
static void test_lines(void)
{
	static const char text[] = "\xef\xbb\xbf\n{\"a\":\n 1, \"b\": [\n\n 2,\n{\"c\":null}]}";
	g_autoptr(GHashTable) lines = NULL;
	g_autoptr(JsonNode) root = strict_json_read_lines(text, sizeof text - 1, &lines, NULL);
	g_assert_nonnull(root);
	JsonObject *o = json_node_get_object(root);
	JsonNode *a = json_object_get_member(o, "a"), *b = json_object_get_member(o, "b");
	JsonNode *two = json_array_get_element(json_node_get_array(b), 0),
		 *c = json_array_get_element(json_node_get_array(b), 1);
	JsonNode *nodes[] = { root, a, b, two, c,
		json_object_get_member(json_node_get_object(c), "c") };
	static const guint wanted[] = { 2, 3, 3, 5, 6, 6 };
	for (size_t i = 0; i < G_N_ELEMENTS(nodes); i++)
		g_assert_cmpuint(
			GPOINTER_TO_UINT(g_hash_table_lookup(lines, nodes[i])), ==, wanted[i]);
	GHashTable *none = NULL;
	g_assert_null(strict_json_read_lines("{", 1, &none, NULL));
	g_assert_null(none);
}

static void test_bad_texts(void)
{
	for (size_t i = 0; i < G_N_ELEMENTS(bad_texts); i++) {
		g_autoptr(GError) error = NULL;
		g_autofree char *whole = g_strdup_printf("oak/site.json: %s", bad_texts[i].message);
		g_assert_null(parse(bad_texts[i].text, &error));
		g_assert_cmpstr(error->message, ==, whole);
	}
	g_autoptr(manifest) without_schema = manifest_parse("{}", 2, "x", 0, NULL);
	g_assert_nonnull(without_schema);
	g_autoptr(GError) zero = NULL;
	g_assert_null(manifest_parse("{\"a\":\"\0\"}", 9, "x", 1, &zero));
	g_assert_cmpstr(zero->message, ==, "x: line 1, column 7: this is not UTF-8 text");
}

static JsonNode *read_nested(size_t depth, GError **error)
{
	g_autoptr(GString) text = g_string_new(NULL);
	for (size_t i = 0; i < depth; i++)
		g_string_append(text, i % 2 ? "{\"a\":" : "[");
	g_string_append_c(text, '1');
	for (size_t i = depth; i--;)
		g_string_append_c(text, i % 2 ? '}' : ']');
	return strict_json_read(text->str, text->len, error);
}

static void test_depth(void)
{
	g_autoptr(GError) error = NULL, endless = NULL;
	g_autoptr(JsonNode) deep = read_nested(STRICT_JSON_DEPTH_MAX, &error);
	g_assert_no_error(error);
	g_assert_nonnull(deep);
	g_assert_null(read_nested(STRICT_JSON_DEPTH_MAX + 1, &error));
	g_assert_true(strstr(error->message, "nested too deeply"));
	g_autofree char *text = g_strnfill(1000000, '[');
	g_assert_null(manifest_parse(text, 1000000, "x", 1, &endless));
	g_assert_cmpstr(endless->message, ==, "x: line 1, column 65: this is nested too deeply");
}

/* Nothing is lost that this version does not know, and what is written is always the same. */
static void test_kept(void)
{
	static const char text[] =
		"{\n"
		"  \"schema\": 1,\n"
		"  \"z\": \"ä😀\\n\\u001b\\\\\",\n"
		"  \"numbers\": [1, -0.0, 0.1, 1e+20, 9223372036854775807, 3.0],\n"
		"  \"a.b\": true,\n"
		"  \"a\": {\n"
		"    \"y\": null,\n"
		"    \"empty\": {},\n"
		"    \"list\": [\n"
		"      [],\n"
		"      {\n"
		"        \"x\": 1\n"
		"      }\n"
		"    ]\n"
		"  },\n"
		"  \"b\": false\n"
		"}\n";
	g_autoptr(GError) error = NULL;
	g_autoptr(manifest) m = parse(text, &error);
	g_assert_no_error(error);
	g_autofree char *same = manifest_to_text(m);
	g_assert_cmpstr(same, ==, text);
	/* A value that is set again keeps its place. */
	manifest_set_string(m, "z", "last");
	g_autofree char *changed = manifest_to_text(m);
	g_assert_true(strstr(changed, "\"schema\": 1,\n  \"z\": \"last\",\n  \"numbers\""));
}

static void test_setters(void)
{
	g_autoptr(manifest) m = manifest_new("x.json");
	manifest_set_int(m, "schema", 1);
	manifest_set_number(m, "panorama.step_rad", M_PI / 1500);
	manifest_set_int(m, "panorama.columns", INT64_MIN);
	manifest_set_number(m, "panorama.lost", NAN);
	manifest_set_string(m, "schema.over", "an integer");
	manifest_set_node(m, "list", json_node_init_array(json_node_alloc(), json_array_new()));
	g_autofree char *text = manifest_to_text(m);
	g_assert_cmpstr(text, ==,
		"{\n  \"schema\": {\n    \"over\": \"an integer\"\n  },\n  \"panorama\": {\n"
		"    \"step_rad\": 0.0020943951023931952,\n"
		"    \"columns\": -9223372036854775808,\n    \"lost\": null\n  },\n"
		"  \"list\": []\n}\n");
}

/* Every double comes back as it was. */
static void test_doubles(void)
{
	for (int i = 0; i < 20000; i++) {
		union {
			uint64_t bits;
			double value;
		} d = { .bits = (uint64_t)g_test_rand_int() << 32 | (uint32_t)g_test_rand_int() };
		if (!isfinite(d.value))
			continue;
		g_autoptr(JsonNode) node = json_node_init_double(json_node_alloc(), d.value);
		g_autofree char *text = strict_json_write(node);
		g_autoptr(JsonNode) back = strict_json_read(text, strlen(text), NULL);
		g_assert_true(json_node_get_value_type(back) == G_TYPE_DOUBLE);
		g_assert_true(json_node_get_double(back) == d.value);
	}
}

static void test_locale(void)
{
	static const char *const with_comma[] = { "de_DE.UTF-8", "fr_FR.UTF-8", "nl_NL.UTF-8" };
	const char *set = NULL;
	for (size_t i = 0; i < G_N_ELEMENTS(with_comma) && !set; i++)
		set = setlocale(LC_ALL, with_comma[i]);
	if (!set) {
		g_test_skip("no locale that writes 0,5 is installed");
		return;
	}
	test_kept();
	test_doubles();
	setlocale(LC_ALL, "C");
}

struct folder {
	char *path, *file;
};

static void set_up(struct folder *f, gconstpointer data)
{
	(void)data;
	f->path = g_dir_make_tmp("manifest-XXXXXX", NULL);
	f->file = g_build_filename(f->path, "scan.json", NULL);
}

static void tear_down(struct folder *f, gconstpointer data)
{
	(void)data;
	g_assert_true(files_remove_tree(f->path, NULL));
	g_free(f->file);
	g_free(f->path);
}

static void test_save(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL, folder = NULL, missing = NULL;
	g_autoptr(manifest) m = manifest_new(f->file);
	manifest_set_int(m, "schema", 1);
	for (int i = 0; i < 3; i++) {
		manifest_set_int(m, "number", i);
		g_assert_true(manifest_save(m, &error));
	}
	g_autoptr(manifest) back = manifest_load(f->file, 1, &error);
	g_assert_no_error(error);
	int64_t number;
	g_assert_true(manifest_get_int(back, "number", 2, 2, &number, NULL));
	g_autoptr(GPtrArray) names = files_names(f->path, NULL);
	g_assert_cmpuint(names->len, ==, 1);

	g_assert_null(manifest_load(f->path, 1, &folder));
	g_assert_error(folder, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
	g_assert_false(manifest_save_as(m, "/nowhere/at/all.json", &missing));
	g_assert_cmpstr(missing->message, ==,
		"/nowhere/at/all.json: cannot write: No such file or directory");
	g_clear_error(&missing);
	g_remove(f->file);
	g_assert_null(manifest_load(f->file, 1, &missing));
	g_assert_error(missing, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
}

static void test_too_large(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	g_autofree char *text = g_strnfill(MANIFEST_BYTES_MAX + 1, ' ');
	g_assert_true(g_file_set_contents(f->file, text, MANIFEST_BYTES_MAX + 1, NULL));
	g_assert_null(manifest_load(f->file, 1, &error));
	g_assert_true(
		g_str_has_suffix(error->message, "has 33554433 bytes; at most 33554432 are read"));
	g_clear_error(&error);
	g_assert_null(manifest_parse(text, MANIFEST_BYTES_MAX + 1, "x", 1, &error));
	g_assert_cmpstr(
		error->message, ==, "x: has 33554433 bytes; a manifest has at most 33554432");
}

/* The check that makes it whole: 'twice' is always twice 'number', whatever the length of the text
 * between them. */
static void save_until_killed(const char *path, int64_t number)
{
	alarm(60); /* should the parent end first */
	g_autoptr(manifest) m = manifest_new(path);
	manifest_set_int(m, "schema", 1);
	for (;; number++) {
		g_autofree char *filling = g_strnfill((gsize)(number * 7919 % 30000), 'x');
		manifest_set_int(m, "number", number);
		manifest_set_string(m, "filling", filling);
		manifest_set_int(m, "twice", 2 * number);
		if (!manifest_save(m, NULL))
			_exit(1);
	}
}

static void test_kills(struct folder *f, gconstpointer data)
{
	(void)data;
	int64_t number = 0, twice, before = 0;
	g_autoptr(manifest) first = manifest_new(f->file);
	manifest_set_int(first, "schema", 1);
	manifest_set_int(first, "number", 0);
	manifest_set_int(first, "twice", 0);
	g_assert_true(manifest_save(first, NULL));
	for (int i = 0; i < KILLS; i++, before = number) {
		pid_t child = fork();
		int status;
		if (child == 0)
			save_until_killed(f->file, before + 1);
		g_usleep((gulong)g_test_rand_int_range(0, 6000));
		kill(child, SIGKILL);
		g_assert_cmpint(waitpid(child, &status, 0), ==, child);
		g_assert_true(WIFSIGNALED(status));
		g_autoptr(GError) error = NULL;
		g_autoptr(manifest) m = manifest_load(f->file, 1, &error);
		g_assert_no_error(error);
		g_assert_true(manifest_get_int(m, "number", before, INT64_MAX, &number, NULL));
		g_assert_true(manifest_get_int(m, "twice", 2 * number, 2 * number, &twice, NULL));
	}
	g_test_message("%d saves by %d killed writers", (int)number, KILLS);
	g_autoptr(GPtrArray) names = files_names(f->path, NULL);
	g_assert_cmpuint(names->len, <=, 2);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/manifest/lines", test_lines);
	g_test_add_func("/manifest/values", test_values);
	g_test_add_func("/manifest/getters-refuse", test_getters_refuse);
	g_test_add_func("/manifest/bad-texts", test_bad_texts);
	g_test_add_func("/manifest/depth", test_depth);
	g_test_add_func("/manifest/kept", test_kept);
	g_test_add_func("/manifest/setters", test_setters);
	g_test_add_func("/manifest/doubles", test_doubles);
	g_test_add_func("/manifest/locale", test_locale);
#define ADD(name, test) g_test_add("/manifest/" name, struct folder, NULL, set_up, test, tear_down)
	ADD("save", test_save);
	ADD("too-large", test_too_large);
	ADD("kills", test_kills);
	return g_test_run();
}
