/* The report as people get it: one page that needs nothing beside it, the same facts as JSON, and a clear word when there is
 * nothing to report. */
#include "acquire/scan.h"
#include "process/scan-graph.h"
#include "tests/commands.h"
#include "tests/simulated.h"

struct place {
	char *folder, *site;
};

static struct place scanned(const char *scene, const int *stations, size_t count)
{
	struct place p = { .folder = simulated_folder() };
	struct scan_options options = { .preset = preset_find("draft") };
	p.site = g_build_filename(p.folder, "oak", NULL);
	for (size_t i = 0; i < count; i++) {
		struct scan_result result;
		uint32_t partial;
		g_autoptr(GError) error = NULL;
		g_autofree char *description =
			g_strdup_printf("%s&camera=none&station=%d", scene, stations[i]);
		simulated_scan(
			p.site, description, &options, NULL, NULL, &result, &partial, &error);
		g_assert_no_error(error);
	}
	return p;
}

static void place_clear(struct place *p)
{
	g_free(p->folder);
	g_free(p->site);
}

static JsonObject *report_of(const struct place *p, JsonNode **ret_node)
{
	g_auto(answer) a = commands_run("report", p->site, "--json");
	commands_assert_done(&a);
	*ret_node = commands_json(&a);
	return json_node_get_object(*ret_node);
}

static void test_page_stands_alone(void)
{
	struct place p = scanned("hall?seed=4&ares=720", (const int[]){ 1, 2 }, 2);
	g_auto(answer) processed = commands_run("process", p.site, "--to", "register");
	commands_assert_done(&processed);
	g_autoptr(JsonNode) node = NULL;
	JsonObject *o = report_of(&p, &node);
	g_assert_cmpuint(json_array_get_length(json_object_get_array_member(o, "scans")), ==, 2);
	JsonObject *edge =
		json_array_get_object_element(json_object_get_array_member(o, "edges"), 0);
	g_assert_cmpstr(json_object_get_string_member(edge, "verdict"), ==, "accepted");
	g_assert_true(json_object_get_boolean_member(edge, "used"));
	g_assert_cmpfloat(json_object_get_double_member(edge, "agreement"), >, 0.5);
	g_autofree char *path = g_build_filename(p.site, "exports", "report.html", NULL);
	g_autofree char *html = NULL;
	g_assert_true(g_file_get_contents(path, &html, NULL, NULL));
	g_assert_nonnull(strstr(html, "All 2 scans stand in one frame."));
	g_assert_nonnull(strstr(html, "href=\"#edge-1-2\""));
	g_assert_nonnull(strstr(html, "id=\"edge-1-2\""));
	g_assert_nonnull(strstr(html, "src=\"data:image/png;base64,"));
	g_assert_null(strstr(html, "http"));
	g_assert_null(strstr(html, "<script"));
	place_clear(&p);
}

static void test_json_lies_beside_the_page(void)
{
	struct place p = scanned("hall?seed=4&ares=360", (const int[]){ 1 }, 1);
	g_auto(answer) processed = commands_run("process", p.site, "--to", "register");
	commands_assert_done(&processed);
	g_autofree char *page = g_build_filename(p.folder, "fit & form.html", NULL),
			*json = g_build_filename(p.folder, "fit & form.json", NULL);
	g_auto(answer) a = commands_run("report", p.site, "-o", page, "--no-maps");
	commands_assert_done(&a);
	g_assert_true(g_file_test(page, G_FILE_TEST_EXISTS));
	g_autofree char *text = NULL;
	g_assert_true(g_file_get_contents(json, &text, NULL, NULL));
	g_autoptr(JsonNode) node = json_from_string(text, NULL);
	g_assert_cmpstr(
		json_object_get_string_member(json_node_get_object(node), "site"), ==, "oak");
	place_clear(&p);
}

static void test_nothing_to_report(void)
{
	struct place p = scanned("hall?seed=4&ares=360", (const int[]){ 1 }, 1);
	g_auto(answer) a = commands_run("report", p.site);
	commands_assert_refused(&a, 1, "not registered yet");
	g_auto(answer) none = commands_run("report", p.folder);
	commands_assert_refused(&none, 1, "no site.json");
	g_auto(answer) two = commands_run("report", p.site, p.site);
	commands_assert_refused(&two, 2, NULL);
	place_clear(&p);
}

static void test_two_places_are_two_parts(void)
{
	struct place p = scanned("hall?seed=4&ares=720", (const int[]){ 1 }, 1);
	struct scan_options options = { .preset = preset_find("draft") };
	struct scan_result result;
	uint32_t partial;
	g_autoptr(GError) error = NULL;
	simulated_scan(p.site, "street?seed=8&ares=720&camera=none&station=2", &options, NULL, NULL,
		&result, &partial, &error);
	g_assert_no_error(error);
	g_auto(answer) processed = commands_run("process", p.site, "--to", "register");
	commands_assert_done(&processed);
	g_autoptr(JsonNode) node = NULL;
	JsonObject *o = report_of(&p, &node);
	JsonArray *edges = json_object_get_array_member(o, "edges");
	g_assert_cmpuint(json_array_get_length(edges), ==, 1);
	JsonObject *edge = json_array_get_object_element(edges, 0);
	g_assert_false(json_object_get_boolean_member(edge, "used"));
	g_assert_cmpuint(strlen(json_object_get_string_member(edge, "reason")), >, 20);
	place_clear(&p);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	g_test_add_func("/report/page", test_page_stands_alone);
	g_test_add_func("/report/json", test_json_lies_beside_the_page);
	g_test_add_func("/report/nothing", test_nothing_to_report);
	g_test_add_func("/report/two-places", test_two_places_are_two_parts);
	return g_test_run();
}
