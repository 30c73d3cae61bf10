/* Sites that are damaged: each file of a scan in each way, at places drawn by a seed. A command
 * that reads what is damaged ends with status 1 and one sentence that names the file, and changes
 * nothing. */
#include "acquire/planes.h"
#include "firmware-io/record.h"
#include "tests/commands.h"
#include "tests/simulated.h"

#ifdef __SANITIZE_ADDRESS__
#define FLIPS 6
#else
#define FLIPS 16
#endif
/* The partial scan's record ends about here, in the midst of columns. */
#define PARTIAL_BYTES 900000

enum how { EMPTY, CUT, FLIP, OTHER_KIND, ABSURD_LENGTH, GROWN, FOLDER, PIPE, MISSING };

/* A file as it was, so that it can be hurt and healed. */
typedef struct patient {
	char *path, *bytes;
	gsize length;
} patient;

static char *folder, *finished, *partial;
static listener simulator;
static GRand *chance;

static patient patient_take(const char *at, const char *name)
{
	patient p = { .path = g_build_filename(at, name, NULL) };
	g_assert_true(g_file_get_contents(p.path, &p.bytes, &p.length, NULL));
	return p;
}

static void patient_put(const patient *p, const char *bytes, gsize length)
{
	g_remove(p->path);
	g_assert_true(g_file_set_contents_full(
		p->path, bytes, (gssize)length, G_FILE_SET_CONTENTS_NONE, 0666, NULL));
}

static void patient_heal(const patient *p)
{
	patient_put(p, p->bytes, p->length);
}

static void patient_clear(patient *p)
{
	patient_heal(p);
	g_free(p->path);
	g_free(p->bytes);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(patient, patient_clear)

static void patient_hurt(const patient *p, enum how how, gsize at)
{
	g_autofree char *bytes = g_malloc0(p->length + 16);
	gsize length = how == EMPTY ? 0 : how == CUT ? at : p->length;
	g_assert_cmpuint(at, <, p->length);
	memcpy(bytes, p->bytes, p->length);
	if (how == FLIP)
		bytes[at] ^= (char)(1 << (at % 7));
	if (how == OTHER_KIND)
		memcpy(bytes, "\x89PNG\r\n\x1a\n", 8);
	if (how == ABSURD_LENGTH)
		memset(bytes + 24, 0xff, 4);
	if (how == GROWN)
		memset(bytes + length, 'x', 16), length += 16;
	patient_put(p, bytes, length);
	if (how >= FOLDER)
		g_unlink(p->path);
	if (how == FOLDER)
		g_assert_cmpint(g_mkdir(p->path, 0777), ==, 0);
	if (how == PIPE)
		g_assert_cmpint(mkfifo(p->path, 0666), ==, 0);
}

static const struct damage {
	enum how how;
	double where; /* share of the file's length; < 0: drawn */
	int times;
} damages[] = { { EMPTY, 0, 1 }, { CUT, 0.0001, 1 }, { CUT, 0.5, 1 }, { CUT, 0.99999, 1 },
	{ CUT, -1, 2 }, { FLIP, 0, 1 }, { FLIP, -1, 0 }, { OTHER_KIND, 0, 1 },
	{ ABSURD_LENGTH, 0, 1 }, { GROWN, 0, 1 }, { FOLDER, 0, 1 }, { PIPE, 0, 1 },
	{ MISSING, 0, 1 } };

/* Calls examine with the file hurt in each way, and heals it after the last. */
static void in_each_way(const char *at, const char *name, int flips,
	void (*examine)(const patient *, enum how, const char *at))
{
	g_auto(patient) p = patient_take(at, name);
	for (size_t i = 0; i < G_N_ELEMENTS(damages); i++)
		for (int n = 0; n < (damages[i].times ? damages[i].times : flips); n++) {
			double where =
				damages[i].where < 0 ? g_rand_double(chance) : damages[i].where;
			gsize byte = (gsize)(where * p.length);
			patient_hurt(&p, damages[i].how, byte);
			g_test_message("%s, damage %d at byte %zu", name, damages[i].how, byte);
			examine(&p, damages[i].how, at);
		}
}

/* Runs pleinair ARGUMENTS...; true when it was done. When it was refused, nothing has changed. */
static bool run_on(const char *at, const char *names, const char *const *arguments)
{
	g_autofree char *before = commands_snapshot(at);
	g_auto(answer) a = commands_run_in(NULL, arguments);
	if (a.status == 0)
		return true;
	commands_assert_refused(&a, 1, names);
	g_autofree char *after = commands_snapshot(at);
	g_assert_cmpstr(before, ==, after);
	return false;
}
#define ARGUMENTS(...) ((const char *const[]){ __VA_ARGS__, NULL })

/* ---- finished scans ---- */

static void refuse_record(const patient *p, enum how how, const char *at)
{
	(void)p, (void)how;
	g_assert_false(run_on(at, "raw.rec: ", ARGUMENTS("panoramas", at, "--develop")));
	g_assert_false(run_on(at, "raw.rec: ", ARGUMENTS("panoramas", at, "--verify")));
}

static void test_record(void)
{
	in_each_way(finished, "scans/0001/raw.rec", FLIPS, refuse_record);
}

/* Behind the sums of scan.json the decoder itself must bear what it is given. */
static void decode_plane(const char *at)
{
	const struct preset *draft = preset_find("draft");
	struct panorama_desc desc = panorama_desc_for(draft->columns, draft->rows);
	g_autofree char *in = g_build_filename(at, "scans", "0001", NULL);
	g_autoptr(GError) error = NULL;
	g_autoptr(panorama) p = planes_load(in, &desc, &error);
	g_assert_true(!p == !!error);
	if (error)
		g_assert_true(g_str_has_prefix(error->message, in));
}

static void refuse_plane(const patient *p, enum how how, const char *at)
{
	g_autofree char *name = g_path_get_basename(p->path);
	g_assert_false(run_on(at, name, ARGUMENTS("panoramas", at)));
	if (how >= ABSURD_LENGTH)
		g_assert_false(run_on(at, name, ARGUMENTS("panoramas", at, "--verify")));
	decode_plane(at);
}

/* Many more flips, for the decoder alone; most in what describes the picture, at the end. */
static void decode_flipped(const char *name)
{
	g_auto(patient) p = patient_take(finished, name);
	for (int i = 0; i < 6 * FLIPS; i++) {
		gsize end = MIN(p.length, 600);
		patient_hurt(&p, FLIP,
			i % 4 ? p.length - 1 - (gsize)g_rand_int_range(chance, 0, end)
			      : (gsize)(g_rand_double(chance) * p.length));
		decode_plane(finished);
	}
}

static void test_planes(gconstpointer plane)
{
	g_autofree char *name = g_strconcat("scans/0001/", plane, NULL);
	g_autofree char *before = commands_snapshot(finished);
	in_each_way(finished, name, FLIPS, refuse_plane);
	decode_flipped(name);
	/* The record heals it. */
	g_auto(patient) p = patient_take(finished, name);
	patient_hurt(&p, CUT, p.length / 2);
	g_auto(answer) a = commands_run("panoramas", finished, "--develop", "--verify");
	commands_assert_done(&a);
	g_autofree char *after = commands_snapshot(finished);
	g_assert_cmpstr(before, ==, after);
}

/* Nothing sums up a manifest: where the text still makes sense it may be believed. */
static void refuse_manifest(const patient *p, enum how how, const char *at)
{
	g_autofree char *name = g_path_get_basename(p->path), *before = commands_snapshot(at),
			*out = g_build_filename(folder, "out", NULL);
	bool done = run_on(at, name, ARGUMENTS("panoramas", at, "--verify", "-o", out));
	g_autofree char *after = commands_snapshot(at);
	g_assert_cmpstr(before, ==, after);
	g_assert_true(!done || how == FLIP || how == CUT);
	g_assert_true(done == g_file_test(out, G_FILE_TEST_EXISTS));
	if (done)
		commands_shell("rm -r '%s'", out);
}

static void test_manifest(gconstpointer name)
{
	in_each_way(finished, name, FLIPS, refuse_manifest);
}

/* ---- texts that are JSON, but not ours ---- */

enum reader { ALWAYS, VERIFY, RESUME };

static const struct edit {
	enum reader reader; /* which command must notice */
	const char *file, *from, *to;
} edits[] = {
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": 1000000000" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": 16384" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": -750" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": 0" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": 751" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": \"750\"" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": 750.5" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": 1e400" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": 99999999999999999999" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": null" },
	{ ALWAYS, "scan.json", "\"columns\": 750", "\"columns\": [750]" },
	{ ALWAYS, "scan.json", "\"columns\"", "\"colums\"" },
	{ ALWAYS, "scan.json", "\"rows\": 198", "\"rows\": 32768" },
	{ ALWAYS, "scan.json", "\"elevation_min_deg\": -40", "\"elevation_min_deg\": -4" },
	{ ALWAYS, "scan.json", "\"panorama\": {", "\"panorama\": 7, \"was\": {" },
	{ ALWAYS, "scan.json", "\"preset\": \"draft\"", "\"preset\": 3" },
	{ ALWAYS, "scan.json", "\"schema\": 1", "\"schema\": 2" },
	{ ALWAYS, "scan.json", "\"schema\": 1", "\"schema\": true" },
	{ ALWAYS, "scan.json", "\"losses\": []", "\"losses\": DEEP" },
	{ ALWAYS, "scan.json", "\"files\": {", "\"files\": [], \"was\": {" },
	{ ALWAYS, "scan.json", "\"files\": {", "\"files\": {}, \"was\": {" },
	{ ALWAYS, "scan.json", "\"raw.rec\": {", "\"raw.rec\": 5, \"was\": {" },
	{ VERIFY, "scan.json", "\"bytes\": ", "\"bytes\": -" },
	{ VERIFY, "scan.json", "\"bytes\": ", "\"bytes\": {}, \"was\": " },
	{ VERIFY, "scan.json", "\"bytes\": ", "\"bytes\": \"many\", \"was\": " },
	{ VERIFY, "scan.json", "\"sha256\": ", "\"sha256\": [], \"was\": " },
	{ VERIFY, "scan.json", "\"sha256\": ", "\"sha256\": 7, \"was\": " },
	{ VERIFY, "scan.json", "\"files\": {", "\"files\": { \"../../x\": {}," },
	{ VERIFY, "scan.json", "\"files\": {", "\"files\": { \"..\": {}," },
	{ VERIFY, "scan.json", "\"files\": {", "\"files\": { \"\": null," },
	{ ALWAYS, "site.json", "metres", "feet" },
	{ ALWAYS, "site.json", "\"name\"", "\"title\"" },
	{ ALWAYS, "site.json", "\"schema\": 1", "\"schema\": 1000" },
	{ ALWAYS, "site.json", "\"created\": ", "\"created\": DEEP, \"was\": " },
	{ RESUME, "scan.json", "\"columns\": 750", "\"columns\": 1000000000" },
	{ RESUME, "scan.json", "\"columns\": 750", "\"columns\": 1500" },
	{ RESUME, "scan.json", "\"preset\": \"draft\"", "\"preset\": \"rough\"" },
	{ RESUME, "scan.json", "\"preset\": \"draft\"", "\"preset\": {}" },
	{ RESUME, "scan.json", "\"schema\": 1", "\"schema\": 2" },
	{ RESUME, "site.json", "metres", "feet" },
};

static char *edited(const patient *p, const struct edit *e)
{
	g_autoptr(GString) text = g_string_new_len(p->bytes, (gssize)p->length);
	g_autofree char *deep = g_strnfill(100000, '[');
	g_assert_cmpuint(g_string_replace(text, e->from, e->to, 1), ==, 1);
	g_string_replace(text, "DEEP", deep, 1);
	return g_string_free(g_steal_pointer(&text), FALSE);
}

static void test_edit(gconstpointer data)
{
	const struct edit *e = data;
	const char *at = e->reader == RESUME ? partial : finished;
	bool of_scan = e->file[1] == 'c';
	g_autofree char *name = g_strconcat(!of_scan              ? ""
					    : e->reader == RESUME ? "scans/.0001.partial/"
								  : "scans/0001/",
		e->file, NULL);
	g_auto(patient) p = patient_take(at, name);
	g_autofree char *text = edited(&p, e);
	patient_put(&p, text, strlen(text));
	if (e->reader == RESUME) {
		g_assert_false(run_on(at, e->file,
			ARGUMENTS("scan", at, "--resume", "--device", simulator.device)));
		g_assert_false(run_on(at, e->file, ARGUMENTS("scan", at, "--resume")));
		return;
	}
	g_assert_false(run_on(at, e->file, ARGUMENTS("panoramas", at, "--verify")));
	if (e->reader == VERIFY)
		return;
	g_assert_false(run_on(at, e->file, ARGUMENTS("panoramas", at)));
	g_assert_false(run_on(at, e->file, ARGUMENTS("panoramas", at, "--develop")));
}

/* ---- partial scans ---- */

static const char partial_record[] = "scans/.0001.partial/raw.rec";
static uint32_t resumed, refused;

static char *copy_of(const char *at)
{
	char *copy = g_build_filename(folder, "copy", NULL);
	commands_shell("rm -rf '%s'; cp -a '%s' '%s'", copy, at, copy);
	return copy;
}

/* An end that was torn off is what a power cut does: the scan goes on. What else is damaged must be
 * said before the head moves. */
static void resume_hurt(const patient *p, enum how how, const char *at)
{
	(void)p;
	g_autofree char *copy = copy_of(at);
	g_auto(answer) a = { 0 };
	bool done = run_on(copy, "raw.rec: ",
		ARGUMENTS("scan", copy, "--resume", "--device", simulator.device, "--json"));
	resumed += done;
	refused += !done;
	g_assert_true(!done || how == CUT || how == GROWN || how == MISSING || how == FLIP);
}

static void test_resume_hurt(void)
{
	in_each_way(partial, partial_record, FLIPS, resume_hurt);
	g_test_message("%u were refused, %u went on", refused, resumed);
	/* All cuts behind the header, and what is not there; few flips hit nothing that counts. */
	g_assert_cmpuint(resumed, >=, 6);
	g_assert_cmpuint(refused, >=, FLIPS * 3 / 4);
}

static void assert_salvaged(const char *copy, const patient *p)
{
	g_autofree char *names = commands_names(copy);
	g_autofree char *damaged = g_build_filename(copy, "scans", "0001", "raw.rec.damaged", NULL);
	g_autofree char *bytes = NULL;
	gsize length;
	g_assert_cmpstr(names, ==,
		"scans/ scans/0001/ scans/0001/cell.tiff scans/0001/colour.tiff "
		"scans/0001/intensity.tiff scans/0001/offset.tiff scans/0001/range.tiff "
		"scans/0001/raw.rec scans/0001/raw.rec.damaged scans/0001/scan.json site.json");
	g_assert_true(g_file_get_contents(damaged, &bytes, &length, NULL));
	g_assert_cmpuint(length, ==, p->length);
	g_auto(answer) a = commands_run("panoramas", copy, "--verify", "--develop");
	commands_assert_done(&a);
	g_autofree char *path = g_build_filename(copy, "scans", "0001", "scan.json", NULL);
	g_autoptr(manifest) m = manifest_load(path, SCAN_SCHEMA, NULL);
	int64_t empty;
	g_assert_true(manifest_get_int(m, "panorama.empty", 0, 750 * 198, &empty, NULL));
	g_assert_cmpint(empty, <, 750 * 198 / 20);
}

/* Places: in the text of the first session, then wherever. */
static void test_salvage(void)
{
	g_auto(patient) p = patient_take(partial, partial_record);
	gsize places[] = { 60, p.length / 3, p.length * 2 / 3 };
	for (size_t i = 0; i < G_N_ELEMENTS(places); i++) {
		patient_hurt(&p, FLIP, places[i]);
		g_autofree char *copy = copy_of(partial);
		g_auto(answer) told = commands_run("scan", copy, "--resume");
		commands_assert_refused(&told, 1, "--salvage");
		g_auto(answer) a = commands_run("scan", copy, "--resume", "--salvage", "--json",
			"--device", simulator.device);
		commands_assert_done(&a);
		assert_salvaged(copy, &p);
	}
}

/* Whole records need no salvage, and those that are none are beyond it. */
static void test_salvage_for_nothing(void)
{
	g_auto(patient) p = patient_take(partial, partial_record);
	g_autofree char *copy = copy_of(partial);
	g_auto(answer) a = commands_run(
		"scan", copy, "--resume", "--salvage", "--json", "--device", simulator.device);
	commands_assert_done(&a);
	g_autofree char *names = commands_names(copy);
	g_assert_null(strstr(names, "damaged"));
	patient_hurt(&p, OTHER_KIND, 0);
	g_assert_false(
		run_on(partial, "raw.rec: ", ARGUMENTS("scan", partial, "--resume", "--salvage")));
}

static void test_discard_hurt(void)
{
	g_auto(patient) p = patient_take(partial, "scans/.0001.partial/scan.json");
	patient_hurt(&p, CUT, 10);
	g_autofree char *copy = copy_of(partial);
	g_auto(answer) a = commands_run("scan", copy, "--discard");
	commands_assert_done(&a);
	g_autofree char *names = commands_names(copy);
	g_assert_cmpstr(names, ==, "scans/ site.json");
}

/* ---- records that are whole, but not ours ---- */

static const char *const sessions[] = { "", "hello", "{}", "[]", "null", "DEEP",
	"{\"protocol\": 5, \"calibration\": {}}", "{\"protocol\": \"scip\", \"calibration\": 5}",
	"{\"protocol\": {}, \"calibration\": []}",
	"{\"protocol\": \"smoke\", \"calibration\": {\"stage\": {\"steps_per_turn\": 1e300}}}" };

static void write_record(const char *path, const char *session)
{
	static const uint8_t junk[100] = { 0xff, 0xff, 0xff, 0xff, 0x7f };
	g_autoptr(GError) error = NULL;
	g_autoptr(GString) text = g_string_new(session);
	g_autofree char *deep = g_strnfill(100000, '[');
	g_string_replace(text, "DEEP", deep, 1);
	g_unlink(path);
	record_writer *w = record_create(path, &error);
	g_assert_no_error(error);
	record_write(w, RECORD_SESSION, 1, text->str, text->len, NULL, 0, &error);
	for (int kind = RECORD_LIDAR_IN; kind < RECORD_KINDS; kind++)
		record_write(w, kind, INT64_MAX - kind, junk, sizeof junk, NULL, 0, &error);
	record_close(w, &error);
	g_assert_no_error(error);
}

static void test_session(gconstpointer text)
{
	g_auto(patient) p = patient_take(partial, partial_record);
	g_autofree char *device = g_strconcat("replay:", p.path, NULL),
			*fresh = g_build_filename(folder, "fresh", NULL);
	write_record(p.path, text);
	g_assert_false(run_on(partial,
		"raw.rec: ", ARGUMENTS("scan", partial, "--resume", "--device", simulator.device)));
	/* The head that the record stands for is refused before there is a site. */
	g_auto(answer) a = commands_run("scan", fresh, "--device", device, "--json");
	commands_assert_refused(&a, 1, NULL);
	g_assert_false(g_file_test(fresh, G_FILE_TEST_EXISTS));
}

static void replay_hurt(const patient *p, enum how how, const char *at)
{
	g_autofree char *device = g_strconcat("replay:", p->path, NULL),
			*fresh = g_build_filename(folder, "fresh", NULL),
			*before = commands_snapshot(at);
	g_auto(answer) a =
		commands_run("scan", fresh, "--device", device, "--preset", "draft", "--json");
	g_autofree char *after = commands_snapshot(at);
	g_assert_cmpstr(before, ==, after);
	g_assert_true(a.status == 0 || a.status == 1);
	g_autofree char *partial_path = g_build_filename(fresh, "scans", ".0001.partial", NULL);
	if (a.status && !g_file_test(partial_path, G_FILE_TEST_EXISTS)) {
		commands_assert_refused(&a, 1, NULL);
		g_assert_false(g_file_test(fresh, G_FILE_TEST_EXISTS));
	}
	g_assert_true(a.status == 1 || how == FLIP || how == CUT || how == GROWN);
	commands_shell("rm -rf '%s'", fresh);
}

static void test_replay_hurt(void)
{
	in_each_way(finished, "scans/0001/raw.rec", 3, replay_hurt);
}

/* ---- */

static void make_sites(void)
{
	const struct surroundings short_of_space = { .file_bytes_max = PARTIAL_BYTES };
	finished = g_build_filename(folder, "finished", NULL);
	partial = g_build_filename(folder, "partial", NULL);
	g_auto(answer) a =
		commands_run("scan", finished, "--device", simulator.device, "--preset", "draft");
	commands_assert_done(&a);
	g_auto(answer) b = commands_run("panoramas", finished);
	commands_assert_done(&b);
	g_auto(answer) c = commands_run_in(&short_of_space,
		ARGUMENTS("scan", partial, "--device", simulator.device, "--preset", "draft"));
	g_assert_cmpint(c.status, ==, 1);
}

int main(int argc, char **argv)
{
	static const char *const planes[] = { "range.tiff", "intensity.tiff", "cell.tiff",
		"offset.tiff", "colour.tiff" };
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	g_setenv("OMP_NUM_THREADS", "1", TRUE); /* small pictures; the cores are shared */
	chance = g_rand_new_with_seed(20261122);
	folder = simulated_folder();
	simulator = commands_listen(folder, COMMANDS_SCENE);
	make_sites();
	g_test_add_func("/damage/record", test_record);
	for (size_t i = 0; i < G_N_ELEMENTS(planes); i++)
		commands_add("/damage/plane", i, planes[i], test_planes);
	g_test_add_data_func("/damage/scan.json", "scans/0001/scan.json", test_manifest);
	g_test_add_data_func("/damage/site.json", "site.json", test_manifest);
	for (size_t i = 0; i < G_N_ELEMENTS(edits); i++)
		commands_add("/damage/edit", i, &edits[i], test_edit);
	g_test_add_func("/damage/resume", test_resume_hurt);
	g_test_add_func("/damage/salvage", test_salvage);
	g_test_add_func("/damage/salvage-for-nothing", test_salvage_for_nothing);
	g_test_add_func("/damage/discard", test_discard_hurt);
	for (size_t i = 0; i < G_N_ELEMENTS(sessions); i++)
		commands_add("/damage/session", i, sessions[i], test_session);
	g_test_add_func("/damage/replay", test_replay_hurt);
	int status = g_test_run();
	listener_clear(&simulator);
	g_rand_free(chance);
	g_free(folder);
	g_free(finished);
	g_free(partial);
	return status;
}
