#include "render/bench-machine.h"
#include "acquire/version.h"
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

#if defined(__clang__)
#define COMPILER "clang " __clang_version__
#else
#define COMPILER "gcc " __VERSION__
#endif

/* What stands behind "KEY" and separators in a file of lines; caller frees. */
static char *line_of(const char *path, const char *key, const char *separators)
{
	g_autofree char *text = NULL;
	if (!g_file_get_contents(path, &text, NULL, NULL))
		return NULL;
	g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
	for (guint n = 0; lines[n]; n++)
		if (g_str_has_prefix(lines[n], key)) {
			const char *rest = lines[n] + strlen(key);
			char *found = g_strdup(rest + strspn(rest, separators));
			return g_strchomp(g_strdelimit(found, "\"", ' '));
		}
	return NULL;
}

static void put(JsonObject *to, const char *key, char *taken)
{
	if (taken && *g_strstrip(taken))
		json_object_set_string_member(to, key, taken);
	g_free(taken);
}

/* What boards call it differs from what x86 calls it. */
static char *processor(void)
{
	static const char *const keys[] = { "model name", "Model", "Hardware" };
	for (size_t n = 0; n < G_N_ELEMENTS(keys); n++) {
		char *found = line_of("/proc/cpuinfo", keys[n], "\t :");
		if (found)
			return found;
	}
	return line_of("/proc/device-tree/model", "", "");
}

static int cores(void)
{
	cpu_set_t set;
	return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set)
							   : (int)g_get_num_processors();
}

/* Only of a repository of this program's own. */
static char *commit(void)
{
	g_autofree char *self = g_file_read_link("/proc/self/exe", NULL),
			*folder = self ? g_path_get_dirname(self) : NULL, *out = NULL;
	const char *argv[] = { "sh", "-c",
		"cd \"$0\" && top=$(git rev-parse --show-toplevel) && "
		"test -e \"$top/render/pleinair-bench.c\" && git describe --always --dirty",
		folder, NULL };
	int status;
	if (!folder ||
		!g_spawn_sync(NULL, (char **)argv, NULL,
			G_SPAWN_SEARCH_PATH | G_SPAWN_STDERR_TO_DEV_NULL, NULL, NULL, &out, NULL,
			&status, NULL) ||
		!g_spawn_check_wait_status(status, NULL))
		return NULL;
	return g_steal_pointer(&out);
}

JsonObject *bench_machine(void)
{
	JsonObject *o = json_object_new();
	struct utsname kernel;
	double load;
	g_autoptr(GDateTime) now = g_date_time_new_now_local();
	g_autofree char *memory = line_of("/proc/meminfo", "MemTotal", ": ");
	put(o, "processor", processor());
	json_object_set_int_member(o, "cores", cores());
	if (memory)
		json_object_set_double_member(
			o, "memory_gib", g_ascii_strtod(memory, NULL) / (1 << 20));
	if (uname(&kernel) == 0)
		put(o, "kernel", g_strdup_printf("%s %s", kernel.sysname, kernel.release));
	put(o, "system", line_of("/etc/os-release", "PRETTY_NAME=", ""));
	put(o, "compiler", g_strdup(COMPILER));
	put(o, "pleinair", g_strdup(PLEINAIR_VERSION));
	put(o, "commit", commit());
	put(o, "date", g_date_time_format(now, "%Y-%m-%d %H:%M"));
	if (getloadavg(&load, 1) == 1)
		json_object_set_double_member(o, "load", load);
	return o;
}

char *bench_machine_line(JsonObject *m)
{
	return g_strdup_printf("%s, %d cores, %.0f GiB, %s",
		json_object_get_string_member_with_default(m, "processor", "a processor"),
		(int)json_object_get_int_member_with_default(m, "cores", 0),
		json_object_get_double_member_with_default(m, "memory_gib", 0),
		json_object_get_string_member_with_default(m, "system", "Linux"));
}
