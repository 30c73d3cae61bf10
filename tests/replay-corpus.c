/* Stands in for libFuzzer in plain builds: gives every file of a corpus to LLVMFuzzerTestOneInput
 * and prints TAP. A crash ends the program before the plan, which prove reports. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int compare(gconstpointer a, gconstpointer b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* The files of a folder, in order; NULL with a diagnosis when it cannot be read. */
static GPtrArray *list_files(const char *folder)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(GDir) dir = g_dir_open(folder, 0, &error);
	if (!dir) {
		printf("# %s\n", error->message);
		return NULL;
	}
	GPtrArray *files = g_ptr_array_new_with_free_func(g_free);
	for (const char *name; (name = g_dir_read_name(dir));)
		g_ptr_array_add(files, g_build_filename(folder, name, NULL));
	g_ptr_array_sort(files, compare);
	return files;
}

static bool replay(const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *bytes = NULL;
	gsize length;
	if (!g_file_get_contents(path, &bytes, &length, &error)) {
		printf("# %s\n", error->message);
		return false;
	}
	/* Exactly as long as the input, so that a sanitizer sees a read behind it; contents end in
	 * a NUL. */
	g_autofree uint8_t *input = g_memdup2(bytes, length);
	LLVMFuzzerTestOneInput(input, length);
	return true;
}

static bool replay_folder(const char *folder, unsigned *cases)
{
	g_autoptr(GPtrArray) files = list_files(folder);
	bool good = files && files->len > 0;
	for (guint i = 0; files && i < files->len; i++) {
		const char *path = g_ptr_array_index(files, i);
		bool ok = replay(path);
		good = good && ok;
		printf("%sok %u - %s\n", ok ? "" : "not ", ++*cases, path);
		fflush(stdout);
	}
	if (!files || files->len == 0)
		printf("not ok %u - %s has no inputs\n", ++*cases, folder);
	return good;
}

/* build/tests/fuzz-scip replays tests/corpus/scip. */
static char *default_folder(const char *program)
{
	const char *source = g_getenv("PLEINAIR_SOURCE");
	g_autofree char *name = g_path_get_basename(program);
	const char *noun = g_str_has_prefix(name, "fuzz-") ? name + strlen("fuzz-") : name;
	return g_build_filename(source ? source : ".", "tests", "corpus", noun, NULL);
}

int main(int argc, char **argv)
{
	bool good = true;
	unsigned cases = 0;
	if (argc < 2) {
		g_autofree char *folder = default_folder(argv[0]);
		good = replay_folder(folder, &cases);
	}
	for (int i = 1; i < argc; i++)
		good = replay_folder(argv[i], &cases) && good;
	printf("1..%u\n", cases);
	return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
