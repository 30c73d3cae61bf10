#include "process/job-file.h"
#include "firmware-io/files.h"
#include <errno.h>
#include <glib/gstdio.h>
#include <string.h>

/* Longer ones are not remembered: they are what a command printed, and what it made is in the site. */
#define RESULT_MAX (64 * 1024)

void job_free(gpointer data)
{
	struct job *job = data;
	g_free(job->site_path);
	g_strfreev(job->arguments);
	g_free(job->doing);
	g_free(job->result);
	g_free(job->error);
	g_free(job);
}

static bool find_state(const char *name, enum job_state *ret)
{
	for (int i = 0; i < JOB_STATES; i++)
		if (!g_strcmp0(job_state_names[i], name)) {
			*ret = (enum job_state)i;
			return true;
		}
	return false;
}

static struct job *read_job(GKeyFile *file, const char *group, GError **error)
{
	g_autofree char *kind = g_key_file_get_string(file, group, "kind", error);
	g_autofree char *state = kind ? g_key_file_get_string(file, group, "state", error) : NULL;
	if (!state)
		return NULL;
	struct job *job = g_new0(struct job, 1);
	job->number = (uint32_t)g_ascii_strtoull(group, NULL, 10);
	job->kind = job_kind_find(kind, error);
	job->site_path = g_key_file_get_string(file, group, "site", NULL);
	job->arguments = g_key_file_get_string_list(file, group, "arguments", NULL, NULL);
	job->result = g_key_file_get_string(file, group, "result", NULL);
	job->error = g_key_file_get_string(file, group, "error", NULL);
	job->tries = (uint32_t)g_key_file_get_integer(file, group, "tries", NULL);
	job->seconds_left = -1;
	bool good = job->kind && job->number && job->site_path && job->arguments &&
		    find_state(state, &job->state);
	if (good) {
		job->fraction = job->state == JOB_DONE;
		return job;
	}
	if (error && !*error)
		g_set_error(error, G_KEY_FILE_ERROR, G_KEY_FILE_ERROR_INVALID_VALUE,
			"job %s lacks something", group);
	job_free(job);
	return NULL;
}

static bool read_all(GKeyFile *file, GPtrArray *all, uint32_t *ret_next, GError **error)
{
	g_auto(GStrv) groups = g_key_file_get_groups(file, NULL);
	for (char **g = groups; *g; g++) {
		if (!strcmp(*g, "jobs"))
			continue;
		struct job *job = read_job(file, *g, error);
		if (!job)
			return false;
		g_ptr_array_add(all, job);
		*ret_next = MAX(*ret_next, job->number + 1);
	}
	*ret_next = MAX(*ret_next, (uint32_t)g_key_file_get_integer(file, "jobs", "next", NULL));
	return true;
}

GPtrArray *job_file_load(const char *path, uint32_t *ret_next)
{
	g_autoptr(GPtrArray) all = g_ptr_array_new_with_free_func(job_free);
	g_autoptr(GKeyFile) file = g_key_file_new();
	g_autoptr(GError) error = NULL;
	*ret_next = 1;
	if (!path || !g_file_test(path, G_FILE_TEST_EXISTS))
		return g_steal_pointer(&all);
	if (g_key_file_load_from_file(file, path, G_KEY_FILE_NONE, &error) &&
		read_all(file, all, ret_next, &error))
		return g_steal_pointer(&all);
	g_autofree char *aside = g_strconcat(path, ".broken", NULL);
	g_printerr("pleinair jobsd: %s: cannot be read: %s; it is moved to %s\n", path,
		error->message, aside);
	g_rename(path, aside);
	g_ptr_array_set_size(all, 0);
	return g_steal_pointer(&all);
}

static void write_job(GKeyFile *file, const struct job *job)
{
	g_autofree char *group = g_strdup_printf("%u", job->number);
	g_key_file_set_string(file, group, "kind", job->kind->name);
	g_key_file_set_string(file, group, "state", job_state_names[job->state]);
	g_key_file_set_string(file, group, "site", job->site_path);
	g_key_file_set_string_list(file, group, "arguments", (const char *const *)job->arguments,
		g_strv_length(job->arguments));
	g_key_file_set_integer(file, group, "tries", (int)job->tries);
	if (job->result && strlen(job->result) <= RESULT_MAX)
		g_key_file_set_string(file, group, "result", job->result);
	if (job->error)
		g_key_file_set_string(file, group, "error", job->error);
}

bool job_file_save(const char *path, const GPtrArray *all, uint32_t next, GError **error)
{
	g_autoptr(GKeyFile) file = g_key_file_new();
	gsize length;
	if (!path)
		return true;
	g_key_file_set_integer(file, "jobs", "next", (int)next);
	for (guint i = 0; i < all->len; i++)
		write_job(file, all->pdata[i]);
	g_autofree char *text = g_key_file_to_data(file, &length, NULL);
	return files_write(path, text, length, error);
}
