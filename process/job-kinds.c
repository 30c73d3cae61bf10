#include "process/job-kinds.h"
#include "acquire/service.h"
#include <string.h>

static const struct job_option process_options[] = { { "to", 's', JOB_OPTION_PLAIN }, { 0 } };
static const struct job_option import_options[] = { { "again", 'b', JOB_OPTION_PLAIN },
	{ "points", 'i', JOB_OPTION_PLAIN }, { "spacing", 'd', JOB_OPTION_PLAIN },
	{ "sampling", 's', JOB_OPTION_PLAIN }, { "unit", 's', JOB_OPTION_PLAIN },
	{ "up", 's', JOB_OPTION_PLAIN }, { 0 } };
static const struct job_option align_options[] = { { "pairs", 's', JOB_OPTION_READ },
	{ "accept", 'b', JOB_OPTION_PLAIN }, { "refuse", 'b', JOB_OPTION_PLAIN },
	{ "undo", 'b', JOB_OPTION_PLAIN }, { "list", 'b', JOB_OPTION_PLAIN }, { 0 } };
static const struct job_option segments_options[] = { { "name", 's', JOB_OPTION_PLAIN },
	{ "gap", 'd', JOB_OPTION_PLAIN }, { "level", 'i', JOB_OPTION_PLAIN },
	{ "points", 'i', JOB_OPTION_PLAIN }, { "inside", 's', JOB_OPTION_PLAIN },
	{ "outside", 's', JOB_OPTION_PLAIN }, { "radius", 'd', JOB_OPTION_PLAIN },
	{ "class", 's', JOB_OPTION_PLAIN }, { "into", 's', JOB_OPTION_PLAIN }, { 0 } };
static const struct job_option report_options[] = { { "output", 's', JOB_OPTION_INSIDE },
	{ "no-maps", 'b', JOB_OPTION_PLAIN }, { 0 } };
static const struct job_option styles_options[] = { { "thumbnails", 's', JOB_OPTION_INSIDE },
	{ "view", 's', JOB_OPTION_PLAIN }, { "size", 's', JOB_OPTION_PLAIN }, { 0 } };
static const struct job_option render_options[] = { { "style", 's', JOB_OPTION_READ },
	{ "size", 's', JOB_OPTION_PLAIN }, { "dpi", 'd', JOB_OPTION_PLAIN },
	{ "view", 's', JOB_OPTION_PLAIN }, { "output", 's', JOB_OPTION_INSIDE },
	{ "path", 's', JOB_OPTION_PLAIN }, { "seconds", 'd', JOB_OPTION_PLAIN },
	{ "fps", 'd', JOB_OPTION_PLAIN }, { "title", 's', JOB_OPTION_PLAIN },
	{ "no-paper", 'b', JOB_OPTION_PLAIN }, { "supersample", 'i', JOB_OPTION_PLAIN },
	{ "backend", 's', JOB_OPTION_PLAIN }, { 0 } };
static const struct job_option export_options[] = { { "output", 's', JOB_OPTION_INSIDE },
	{ "scans", 's', JOB_OPTION_PLAIN }, { "spacing", 'd', JOB_OPTION_PLAIN },
	{ "raw", 'b', JOB_OPTION_PLAIN }, { 0 } };
static const struct job_option copy_options[] = { { "to", 's', JOB_OPTION_DRIVE },
	{ "what", 's', JOB_OPTION_PLAIN }, { 0 } };
static const struct job_option calibrate_options[] = { { "check", 'b', JOB_OPTION_PLAIN }, { 0 } };

static const struct job_kind kinds[] = {
	{ "process", false, true, process_options },
	{ "import", true, true, import_options },
	{ "align", true, false, align_options },
	{ "segments", true, false, segments_options },
	{ "report", false, true, report_options },
	{ "styles", false, true, styles_options },
	{ "render", false, true, render_options },
	{ "export", false, true, export_options },
	{ "copy", false, true, copy_options },
	{ "calibrate", false, true, calibrate_options },
};

const struct job_kind *job_kind_find(const char *name, GError **error)
{
	for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++)
		if (!strcmp(kinds[i].name, name))
			return &kinds[i];
	g_set_error(
		error, SERVICE_ERROR, SERVICE_ERROR_INVALID, "there is no kind of job '%s'", name);
	return NULL;
}

static bool refuse(GError **error, const char *name, const char *why)
{
	g_set_error(error, SERVICE_ERROR, SERVICE_ERROR_INVALID, "%s: %s", name, why);
	return false;
}

/* ---- paths ---- */

static bool lies_on_drive(const struct job_limits *limits, const char *path, GError **error)
{
	for (const char *const *d = limits->drives; *d; d++)
		if (service_allows(*d, path, NULL))
			return true;
	g_set_error(error, SERVICE_ERROR, SERVICE_ERROR_NOT_ALLOWED,
		"%s does not lie on a drive that is plugged in", path);
	return false;
}

/* Its folder is there, and lies in the site (or is it) by its true path. */
static bool lies_in_site(const char *site_path, const char *path, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(path), *base = g_path_get_basename(path);
	g_autofree char *exports = g_build_filename(site_path, "exports", NULL);
	bool plain = strcmp(base, ".") && strcmp(base, "..") &&
		     !g_file_test(path, G_FILE_TEST_IS_SYMLINK);
	if (plain && (!strcmp(folder, exports) || service_allows(site_path, folder, NULL)))
		return true;
	g_set_error(error, SERVICE_ERROR, SERVICE_ERROR_NOT_ALLOWED, "%s does not lie in %s", path,
		site_path);
	return false;
}

static bool may_use(const struct job_option *o, const char *path, const char *site_path,
	const struct job_limits *limits, GError **error)
{
	if (o->use == JOB_OPTION_PLAIN || !limits->folder)
		return true;
	/* A style has a name, or is a file of the site's. */
	if (o->use == JOB_OPTION_READ && !strchr(path, '/'))
		return true;
	if (o->use == JOB_OPTION_READ)
		return service_allows(limits->folder, path, error);
	if (o->use == JOB_OPTION_DRIVE)
		return lies_on_drive(limits, path, error);
	return lies_in_site(site_path, path, error);
}

/* ---- options ---- */

static const struct job_option *find_option(const struct job_kind *kind, const char *name)
{
	for (const struct job_option *o = kind->options; o->name; o++)
		if (!strcmp(o->name, name))
			return o;
	return NULL;
}

static bool is_plain_text(const char *text)
{
	for (; *text; text++)
		if (g_ascii_iscntrl(*text))
			return false;
	return true;
}

static char *text_of(const struct job_option *o, GVariant *value)
{
	char number[G_ASCII_DTOSTR_BUF_SIZE];
	if (o->type == 's')
		return g_variant_dup_string(value, NULL);
	if (o->type == 'i')
		return g_strdup_printf("%d", g_variant_get_int32(value));
	return g_strdup(g_ascii_dtostr(number, sizeof number, g_variant_get_double(value)));
}

static bool add_option(GPtrArray *argv, const struct job_option *o, GVariant *value,
	const char *site_path, const struct job_limits *limits, GError **error)
{
	const char type[] = { o->type, '\0' };
	if (!g_variant_is_of_type(value, G_VARIANT_TYPE(type)))
		return refuse(error, o->name, "is an option of another type");
	if (o->type == 'b') {
		if (g_variant_get_boolean(value))
			g_ptr_array_add(argv, g_strconcat("--", o->name, NULL));
		return true;
	}
	g_autofree char *text = text_of(o, value);
	if (!is_plain_text(text))
		return refuse(error, o->name, "has characters that cannot be");
	if (!may_use(o, text, site_path, limits, error))
		return false;
	g_ptr_array_add(argv, g_strconcat("--", o->name, "=", text, NULL));
	return true;
}

static bool read_arguments(GVariant *value, const char **ret[], GError **error)
{
	if (!g_variant_is_of_type(value, G_VARIANT_TYPE_STRING_ARRAY))
		return refuse(error, "arguments", "is an option of another type");
	*ret = g_variant_get_strv(value, NULL);
	for (const char **a = *ret; *a; a++)
		if (!is_plain_text(*a))
			return refuse(error, "arguments", "has characters that cannot be");
	return true;
}

/* What an import reads. */
static bool may_name(const struct job_kind *kind, const char *const *arguments,
	const struct job_limits *limits, GError **error)
{
	for (; !strcmp(kind->name, "import") && limits->folder && *arguments; arguments++)
		if (!service_allows(limits->folder, *arguments, NULL) &&
			!lies_on_drive(limits, *arguments, error))
			return false;
	return true;
}

GStrv job_kind_arguments(const struct job_kind *kind, const char *site_path, GVariant *options,
	const struct job_limits *limits, GError **error)
{
	g_autoptr(GPtrArray) argv = g_ptr_array_new_with_free_func(g_free);
	g_autofree const char **arguments = NULL;
	GVariantIter i;
	const char *name;
	GVariant *value;
	bool good = service_allows(limits->folder, site_path, error);
	g_variant_iter_init(&i, options);
	while (good && g_variant_iter_next(&i, "{&sv}", &name, &value)) {
		const struct job_option *o = find_option(kind, name);
		if (kind->arguments && !strcmp(name, "arguments") && !arguments)
			good = read_arguments(value, &arguments, error) &&
			       may_name(kind, arguments, limits, error);
		else if (o)
			good = add_option(argv, o, value, site_path, limits, error);
		else
			good = refuse(error, name, "there is no such option of this kind of job");
		g_variant_unref(value);
	}
	if (!good)
		return NULL;
	g_ptr_array_add(argv, g_strdup("--json"));
	/* From here on nothing is an option. */
	g_ptr_array_add(argv, g_strdup("--"));
	g_ptr_array_add(argv, g_strdup(site_path));
	for (const char **a = arguments; a && *a; a++)
		g_ptr_array_add(argv, g_strdup(*a));
	g_ptr_array_add(argv, NULL);
	return (GStrv)g_ptr_array_free(g_steal_pointer(&argv), FALSE);
}
