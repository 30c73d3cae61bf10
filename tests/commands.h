#ifndef TESTS_COMMANDS_H
#define TESTS_COMMANDS_H
/* Commands as people type them: the programs of $PLEINAIR_BIN with arguments, what they printed and
 * how they ended; and sites as they were before and after. */
#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <grp.h>
#include <json-glib/json-glib.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* A draft scan of it takes less than a second. */
#define COMMANDS_SCENE "hall?seed=3&ares=360&camera=64x96&divergence_mrad=0"
/* A command that takes longer is hung, and is ended by a signal. */
#define COMMANDS_PATIENCE_S 300
#define COMMANDS_NOBODY     65534

/* How the world looks to a command. */
struct surroundings {
	uint64_t file_bytes_max; /* 0: no limit */
	bool nobody;             /* runs without the rights of root */
	const char *stdout_path; /* NULL: into the answer */
};

typedef struct answer {
	int status; /* exit status; -1: ended by a signal */
	char *out, *err;
} answer;

static inline void answer_clear(answer *a)
{
	g_free(a->out);
	g_free(a->err);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(answer, answer_clear)

static inline void commands_enter(gpointer user_data)
{
	const struct surroundings *s = user_data;
	prctl(PR_SET_PDEATHSIG, SIGTERM);
	alarm(COMMANDS_PATIENCE_S);
	if (!s)
		return;
	struct rlimit limit = { s->file_bytes_max, s->file_bytes_max };
	if (s->file_bytes_max && setrlimit(RLIMIT_FSIZE, &limit))
		_exit(99);
	if (s->nobody && getuid() == 0 &&
		(setgroups(0, NULL) || setgid(COMMANDS_NOBODY) || setuid(COMMANDS_NOBODY)))
		_exit(99);
	if (s->stdout_path && !freopen(s->stdout_path, "w", stdout))
		_exit(99);
}

/* Tests may go to another folder: the programs' is made absolute. */
static inline void commands_find_programs(void)
{
	const char *bin = g_getenv("PLEINAIR_BIN");
	g_autofree char *whole = g_canonicalize_filename(bin ? bin : "build/bin", NULL);
	g_setenv("PLEINAIR_BIN", whole, TRUE);
}

/* Adds GROUP/NUMBER. */
static inline void commands_add(
	const char *group, size_t number, gconstpointer data, GTestDataFunc test)
{
	g_autofree char *path = g_strdup_printf("%s/%zu", group, number);
	g_test_add_data_func(path, data, test);
}

static inline char *commands_program(const char *name)
{
	return g_build_filename(g_getenv("PLEINAIR_BIN"), name, NULL);
}

/* pleinair ARGUMENTS..., which are copied. */
static inline answer commands_run_in(const struct surroundings *s, const char *const *arguments)
{
	answer a = { 0 };
	int status;
	g_autoptr(GError) error = NULL;
	g_autoptr(GPtrArray) argv = g_ptr_array_new();
	g_autofree char *program = commands_program("pleinair");
	g_ptr_array_add(argv, program);
	for (const char *const *argument = arguments; *argument; argument++)
		g_ptr_array_add(argv, (gpointer)*argument);
	g_ptr_array_add(argv, NULL);
	bool to_file = s && s->stdout_path;
	g_spawn_sync(NULL, (char **)argv->pdata, NULL,
		to_file ? G_SPAWN_CHILD_INHERITS_STDIN : G_SPAWN_DEFAULT, commands_enter,
		(gpointer)s, to_file ? NULL : &a.out, &a.err, &status, &error);
	g_assert_no_error(error);
	a.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
	if (a.status < 0)
		g_test_message("signal %d: %s", WTERMSIG(status), a.err);
	return a;
}

#define commands_run(...) commands_run_in(NULL, (const char *const[]){ __VA_ARGS__, NULL })

/* A command that goes on while the test does. */
typedef struct running {
	GPid pid;
	int out, err;
} running;

static inline running commands_start(const char *const *arguments)
{
	running r;
	g_autoptr(GError) error = NULL;
	g_autoptr(GPtrArray) argv = g_ptr_array_new();
	g_autofree char *program = commands_program("pleinair");
	g_ptr_array_add(argv, program);
	for (const char *const *argument = arguments; *argument; argument++)
		g_ptr_array_add(argv, (gpointer)*argument);
	g_ptr_array_add(argv, NULL);
	g_spawn_async_with_pipes(NULL, (char **)argv->pdata, NULL, G_SPAWN_DO_NOT_REAP_CHILD,
		commands_enter, NULL, &r.pid, NULL, &r.out, &r.err, &error);
	g_assert_no_error(error);
	return r;
}

static inline char *commands_read_all(int fd)
{
	g_autoptr(GString) text = g_string_new(NULL);
	char bytes[4096];
	for (ssize_t n; (n = read(fd, bytes, sizeof bytes)) > 0;)
		g_string_append_len(text, bytes, n);
	close(fd);
	return g_strdup(text->str);
}

/* Waits for it. */
static inline answer commands_end(running *r)
{
	answer a = { .err = commands_read_all(r->err), .out = commands_read_all(r->out) };
	int status;
	g_assert_cmpint(waitpid(r->pid, &status, 0), ==, r->pid);
	a.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
	return a;
}

/* 700,000 bytes of a draft's record: some of its columns, so that it is worth keeping. */
static inline void commands_wait_for_size(const char *path, off_t bytes)
{
	GStatBuf st = { 0 };
	for (int i = 0; i < 60000 && (g_stat(path, &st) || st.st_size < bytes); i++)
		g_usleep(500);
	g_assert_cmpint(st.st_size, >=, bytes);
}

/* One sentence for people on stderr, nothing on stdout. */
static inline void commands_assert_refused(const answer *a, int status, const char *names)
{
	const char *end = strchr(a->err, '\n');
	bool one_line = end && end > a->err && !end[1];
	if (a->status != status || !one_line || !g_str_has_prefix(a->err, "pleinair") ||
		(names && !strstr(a->err, names)) || (a->out && *a->out))
		g_test_message("status %d, stdout \"%s\", stderr \"%s\", names \"%s\"", a->status,
			a->out, a->err, names ? names : "");
	g_assert_cmpint(a->status, ==, status);
	g_assert_true(one_line);
	g_assert_true(g_str_has_prefix(a->err, "pleinair"));
	if (names)
		g_assert_nonnull(strstr(a->err, names));
	if (a->out)
		g_assert_cmpstr(a->out, ==, "");
}

static inline void commands_assert_done(const answer *a)
{
	if (a->status)
		g_test_message("status %d, stderr: %s", a->status, a->err);
	g_assert_cmpint(a->status, ==, 0);
}

/* stdout is one JSON object; caller unrefs. */
static inline JsonNode *commands_json(const answer *a)
{
	g_autoptr(GError) error = NULL;
	g_assert_true(g_utf8_validate(a->out, -1, NULL));
	JsonNode *node = json_from_string(a->out, &error);
	g_assert_no_error(error);
	g_assert_true(node && JSON_NODE_HOLDS_OBJECT(node));
	return node;
}

/* ---- sites ---- */

static inline int commands_by_name(gconstpointer a, gconstpointer b)
{
	return strcmp(*(char *const *)a, *(char *const *)b);
}

static inline void commands_list(GString *into, const char *folder, const char *prefix, bool hashes)
{
	g_autoptr(GPtrArray) names = g_ptr_array_new_with_free_func(g_free);
	g_autoptr(GDir) dir = g_dir_open(folder, 0, NULL);
	for (const char *name; dir && (name = g_dir_read_name(dir));)
		g_ptr_array_add(names, g_strdup(name));
	g_ptr_array_sort(names, commands_by_name);
	for (guint i = 0; i < names->len; i++) {
		g_autofree char *path = g_build_filename(folder, names->pdata[i], NULL);
		g_autofree char *shown = g_strconcat(prefix, names->pdata[i], NULL);
		g_autofree char *bytes = NULL;
		gsize length = 0;
		GStatBuf st;
		/* A program at work may take away what its folder held just now. */
		if (g_lstat(path, &st)) {
			g_assert_cmpint(errno, ==, ENOENT);
			continue;
		}
		if (S_ISREG(st.st_mode) && hashes)
			g_file_get_contents(path, &bytes, &length, NULL);
		g_autofree char *sum = bytes ? g_compute_checksum_for_data(G_CHECKSUM_SHA1,
						       (const guchar *)bytes, length)
					     : g_strdup("");
		g_string_append_printf(into, "%s%s %s\n", shown,
			S_ISDIR(st.st_mode)   ? "/"
			: S_ISREG(st.st_mode) ? ""
					      : "?",
			sum);
		g_autofree char *deeper = g_strconcat(shown, "/", NULL);
		if (S_ISDIR(st.st_mode))
			commands_list(into, path, deeper, hashes);
	}
}

/* A line for each file with its SHA-1; caller frees. */
static inline char *commands_snapshot(const char *folder)
{
	GString *text = g_string_new(NULL);
	commands_list(text, folder, "", true);
	return g_string_free(text, FALSE);
}

/* The names alone, "scans/ scans/0001/ site.json"; caller frees. */
static inline char *commands_names(const char *folder)
{
	g_autoptr(GString) text = g_string_new(NULL);
	commands_list(text, folder, "", false);
	g_auto(GStrv) lines = g_strsplit(g_strstrip(text->str), " \n", -1);
	return g_strjoinv(" ", lines);
}

static inline void commands_shell(const char *format, ...) G_GNUC_PRINTF(1, 2);
static inline void commands_shell(const char *format, ...)
{
	va_list arguments;
	int status;
	va_start(arguments, format);
	g_autofree char *command = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	char *argv[] = { (char *)"sh", (char *)"-c", command, NULL };
	g_assert_true(g_spawn_sync(
		NULL, argv, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, NULL, NULL, &status, NULL));
	if (status)
		g_test_message("%s", command);
	g_assert_cmpint(status, ==, 0);
}

/* ---- a simulator for many scans ---- */

typedef struct listener {
	char *socket, *device; /* "sim:SOCKET" */
	GPid pid;
} listener;

/* It goes with the test, also when that is killed. */
static inline void commands_follow(gpointer user_data)
{
	(void)user_data;
	prctl(PR_SET_PDEATHSIG, SIGTERM);
}

static inline listener commands_listen(const char *folder, const char *description)
{
	listener l = { .socket = g_build_filename(folder, "sim", NULL) };
	g_autofree char *program = commands_program("pleinair-sim");
	g_autoptr(GError) error = NULL;
	char *argv[] = { program, (char *)"--listen", l.socket, (char *)description, NULL };
	l.device = g_strconcat("sim:", l.socket, NULL);
	g_spawn_async(NULL, argv, NULL,
		G_SPAWN_DO_NOT_REAP_CHILD | G_SPAWN_STDOUT_TO_DEV_NULL | G_SPAWN_STDERR_TO_DEV_NULL,
		commands_follow, NULL, &l.pid, &error);
	g_assert_no_error(error);
	for (int i = 0; i < 3000 && !g_file_test(l.socket, G_FILE_TEST_EXISTS); i++)
		g_usleep(10000);
	g_assert_true(g_file_test(l.socket, G_FILE_TEST_EXISTS));
	return l;
}

static inline void listener_clear(listener *l)
{
	kill(l->pid, SIGTERM);
	waitpid(l->pid, NULL, 0);
	g_free(l->socket);
	g_free(l->device);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(listener, listener_clear)

#endif
