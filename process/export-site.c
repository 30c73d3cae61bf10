#include "acquire/scan.h"
#include "firmware-io/files.h"
#include "process/export-stations.h"
#include "process/export-walk.h"
#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BUFFER_BYTES (1u << 20)

const struct export_format *const export_formats[] = { &export_e57, &export_ptx, &export_las,
	&export_ply, &export_pcd, NULL };

void export_result_clear(struct export_result *r)
{
	g_clear_pointer(&r->notes, g_ptr_array_unref);
}

char *export_format_names(void)
{
	g_autoptr(GString) text = g_string_new(NULL);
	for (const struct export_format *const *f = export_formats; *f; f++)
		g_string_append_printf(text, "%s%s",
			f == export_formats ? ""
			: f[1]              ? ", "
					    : " and ",
			(*f)->name);
	return g_strdup(text->str);
}

static const struct export_format *format_of(const char *path, GError **error)
{
	const char *dot = strrchr(path, '.');
	for (const struct export_format *const *f = export_formats; *f && dot; f++)
		if (g_ascii_strcasecmp(dot + 1, (*f)->extension) == 0)
			return *f;
	g_autofree char *names = export_format_names();
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
		"%s: its name must end in .e57, .ptx, .las, .ply or .pcd; %s are written", path,
		names);
	return NULL;
}

bool export_knows(const char *path)
{
	return format_of(path, NULL);
}

/* ---- progress ---- */

bool export_step(const struct export_job *j, uint64_t count, GError **error)
{
	struct export_steps *s = j->steps;
	s->done += count;
	double part = s->cells ? fmin((double)s->done / (double)s->cells, 1) : 1;
	if (!j->options->progress ||
		j->options->progress(s->before + part * s->share, s->doing, j->options->user_data))
		return true;
	g_set_error_literal(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
	return false;
}

static void next_pass(struct export_job *j, double share, const char *doing)
{
	struct export_steps *s = j->steps;
	s->before += s->share;
	s->share = share;
	s->done = 0;
	s->doing = doing;
}

/* ---- writing ---- */

static bool write_station(const struct export_job *j, const struct export_station *s,
	export_writer *w, GError **error)
{
	g_autoptr(export_walk) walk = export_walk_open(j, s, export_order_of(j, s), error);
	const struct export_point *p;
	if (!walk || !j->format->begin(w, s, error))
		return false;
	for (size_t count = 1; count;)
		if (!export_walk_next(walk, &p, &count, error) ||
			(count && !j->format->write(w, p, count, error)))
			return false;
	return j->format->end(w, error);
}

static bool write_into(const struct export_job *j, FILE *file, GError **error)
{
	export_writer *w = j->format->open(j, file, error);
	bool good = w;
	for (guint i = 0; good && i < j->stations->len; i++)
		good = write_station(j, export_station_at(j, i), w, error);
	good = good && j->format->finish(w, error);
	j->format->close(w);
	return good;
}

static bool write_file(const struct export_job *j, const char *path, GError **error)
{
	FILE *file = fopen(path, "w+e");
	if (!file)
		return files_fail(error, path, "be made");
	g_autofree char *buffer = g_malloc(BUFFER_BYTES);
	setvbuf(file, buffer, _IOFBF, BUFFER_BYTES);
	bool good = write_into(j, file, error);
	if (good && (fflush(file) || ferror(file) || fsync(fileno(file))))
		good = files_fail(error, path, "write");
	if (fclose(file) && good)
		good = files_fail(error, path, "write");
	return good;
}

/* ---- the whole ---- */

static bool check_stations(const struct export_job *j, GError **error)
{
	uint64_t count = 0;
	for (guint i = 0; i < j->stations->len; i++)
		count += export_station_at(j, i)->survey.points;
	if (count)
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, "%s: has no points",
		site_path(j->site));
	return false;
}

/* A station without any point is none. */
static void drop_empty(struct export_job *j)
{
	for (guint i = j->stations->len; i-- > 0;) {
		const struct export_station *s = export_station_at(j, i);
		if (s->survey.points)
			continue;
		g_ptr_array_add(
			j->notes, g_strdup_printf("of scan %u no point is left, so it was left out",
					  s->number));
		g_ptr_array_remove_index(j->stations, i);
	}
}

static bool make(struct export_job *j, const char *beside, GError **error)
{
	next_pass(j, 0.2, "looking through the points");
	if (!export_survey_all(j, error) || !check_stations(j, error))
		return false;
	drop_empty(j);
	next_pass(j, 0.4, "writing");
	if (!write_file(j, beside, error))
		return false;
	next_pass(j, 0.4, "reading back");
	return j->format->verify(j, beside, error);
}

static bool put_in_place(const char *beside, const char *path, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(path);
	if (g_rename(beside, path))
		return files_fail(error, path, "be put in place");
	return files_sync_folder(folder, error);
}

static void tell(struct export_job *j, const char *path, struct export_result *ret)
{
	GStatBuf st;
	*ret = (struct export_result){ .format = j->format->name, .stations = j->stations->len };
	for (guint i = 0; i < j->stations->len; i++) {
		ret->points += export_station_at(j, i)->survey.points;
		ret->left_out += export_station_at(j, i)->survey.left_out;
	}
	ret->bytes = g_stat(path, &st) ? 0 : (uint64_t)st.st_size;
	ret->resolution_m = j->format->resolution_m(j);
	ret->notes = g_ptr_array_ref(j->notes);
}

static bool check_place(const char *path, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(path);
	if (g_file_test(path, G_FILE_TEST_IS_DIR)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_IS_DIRECTORY, "%s: is a folder", path);
		return false;
	}
	if (g_file_test(folder, G_FILE_TEST_IS_DIR))
		return true;
	g_set_error(
		error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "%s: there is no folder %s", path, folder);
	return false;
}

bool export_site(const site *s, const char *path, const struct export_options *options,
	struct export_result *ret, GError **error)
{
	const struct export_format *format = format_of(path, error);
	if (!format || !check_place(path, error))
		return false;
	g_autofree char *folder = g_path_get_dirname(path), *name = g_path_get_basename(path),
			*hidden = g_strdup_printf(".%s.partial", name),
			*beside = g_build_filename(folder, hidden, NULL);
	g_autoptr(GPtrArray) stations = g_ptr_array_new_with_free_func(export_station_free);
	g_autoptr(GPtrArray) notes = g_ptr_array_new_with_free_func(g_free);
	struct export_steps steps = { 0 };
	struct export_job j = { .site = s,
		.format = format,
		.options = options,
		.stations = stations,
		.notes = notes,
		.steps = &steps };
	bool good = export_find_stations(&j, error);
	for (guint i = 0; i < stations->len; i++)
		steps.cells += export_station_at(&j, i)->cells;
	good = good && make(&j, beside, error) && put_in_place(beside, path, error);
	if (good)
		tell(&j, path, ret);
	else
		g_unlink(beside);
	return good;
}
