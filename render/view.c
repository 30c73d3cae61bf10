#include "render/view.h"
#include "firmware-io/files.h"
#include "process/pose-json.h"
#include <errno.h>
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#define SUFFIX    ".json"
#define TITLE_MAX 1000

view *view_new(const char *name, const char *title, const double eye_m[3], const double target_m[3],
	double fov_deg)
{
	view *v = g_new0(view, 1);
	v->name = g_strdup(name);
	v->title = g_strdup(title);
	memcpy(v->eye_m, eye_m, sizeof v->eye_m);
	memcpy(v->target_m, target_m, sizeof v->target_m);
	v->fov_deg = fov_deg;
	return v;
}

view *view_new_parallel(const char *name, const char *title, const double eye_m[3],
	const double target_m[3], double height_m)
{
	view *v = view_new(name, title, eye_m, target_m, CAMERA_PARALLEL_FOV_DEG);
	v->height_m = v->span_m[1] = height_m;
	return v;
}

view *view_renamed(const view *v, const char *name, const char *title)
{
	view *other = view_new(name, title, v->eye_m, v->target_m, v->fov_deg);
	other->height_m = v->height_m;
	other->depth_m = v->depth_m;
	other->is_cut = v->is_cut;
	other->cut_m = v->cut_m;
	memcpy(other->span_m, v->span_m, sizeof v->span_m);
	return other;
}

void view_free(view *v)
{
	if (!v)
		return;
	g_free(v->name);
	g_free(v->title);
	g_free(v->style);
	g_free(v);
}

static double distance_m(const double a[3], const double b[3])
{
	return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
		    (a[2] - b[2]) * (a[2] - b[2]));
}

struct camera view_camera(const view *v, uint32_t width, uint32_t height)
{
	struct camera c = camera_look_at(v->eye_m, v->target_m, v->fov_deg, width, height);
	c.far_m = fmax(CAMERA_FAR_M, 10 * distance_m(v->eye_m, v->target_m));
	if (!view_is_parallel(v))
		return c;
	c = camera_parallel(&c, v->height_m, v->depth_m > 0 ? v->depth_m : c.far_m);
	c.is_cut = v->is_cut;
	c.cut_m = v->cut_m;
	return c;
}

bool view_name_is_good(const char *name)
{
	size_t length = strspn(name, G_CSET_A_2_Z G_CSET_a_2_z G_CSET_DIGITS "-_");
	return g_ascii_isalnum(*name) && length <= VIEW_NAME_MAX && !name[length];
}

/* ---- paths ---- */

static char *folder_of(const site *s)
{
	return g_build_filename(site_path(s), "views", NULL);
}

static char *path_of(const site *s, const char *name)
{
	g_autofree char *folder = folder_of(s), *file = g_strconcat(name, SUFFIX, NULL);
	return g_build_filename(folder, file, NULL);
}

/* ---- checking ---- */

static bool refuse(GError **error, const char *path, const char *format, ...) G_GNUC_PRINTF(3, 4);

static bool refuse(GError **error, const char *path, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(error, MANIFEST_ERROR, MANIFEST_ERROR_VALUE, "%s: %s", path, what);
	return false;
}

static bool check_name(const char *name, const char *path, GError **error)
{
	if (view_name_is_good(name))
		return true;
	return refuse(error, path,
		"'name' is \"%s\"; it must be 1 to %d letters of a-z and A-Z, digits, - and _",
		name, VIEW_NAME_MAX);
}

static bool check_text(const char *text, const char *key, const char *path, GError **error)
{
	if (!g_utf8_validate(text, -1, NULL))
		return refuse(error, path, "'%s' is not UTF-8 text", key);
	if (!*text || strlen(text) > TITLE_MAX)
		return refuse(error, path, "'%s' must have 1 to %d bytes", key, TITLE_MAX);
	for (const char *c = text; *c; c++)
		if (g_ascii_iscntrl(*c))
			return refuse(error, path, "'%s' has a control character", key);
	return true;
}

static bool check_place(const double place_m[3], const char *key, const char *path, GError **error)
{
	for (int k = 0; k < 3; k++)
		if (!(fabs(place_m[k]) <= VIEW_REACH_M))
			return refuse(error, path, "'%s' is more than %g km away", key,
				VIEW_REACH_M / 1000);
	return true;
}

static bool check_metres(double m, const char *key, const char *path, GError **error)
{
	if (m == 0 || (m >= 1e-3 && m <= VIEW_HEIGHT_MAX_M))
		return true;
	return refuse(
		error, path, "'%s' is %g m; it must be 0.001 to %g", key, m, VIEW_HEIGHT_MAX_M);
}

static bool check_parallel(const view *v, const char *path, GError **error)
{
	if (!(v->height_m >= VIEW_HEIGHT_MIN_M && v->height_m <= VIEW_HEIGHT_MAX_M))
		return refuse(error, path, "'height_m' is %g m; it must be %g to %g", v->height_m,
			VIEW_HEIGHT_MIN_M, VIEW_HEIGHT_MAX_M);
	return check_metres(v->depth_m, "depth_m", path, error) &&
	       check_metres(v->cut_m, "cut_m", path, error) &&
	       check_metres(v->span_m[0], "span_m", path, error) &&
	       check_metres(v->span_m[1], "span_m", path, error);
}

static bool check(const view *v, const char *path, GError **error)
{
	if (!check_name(v->name, path, error) || !check_text(v->title, "title", path, error) ||
		(v->style && !check_text(v->style, "style", path, error)) ||
		!check_place(v->eye_m, "eye_m", path, error) ||
		!check_place(v->target_m, "target_m", path, error))
		return false;
	if (!(distance_m(v->eye_m, v->target_m) >= 1e-6))
		return refuse(error, path, "'target_m' is where 'eye_m' is");
	if (view_is_parallel(v))
		return check_parallel(v, path, error);
	if (v->fov_deg >= CAMERA_FOV_MIN_DEG && v->fov_deg <= CAMERA_FOV_MAX_DEG)
		return true;
	return refuse(error, path, "'fov_deg' is %g; it must be %g to %g", v->fov_deg,
		CAMERA_FOV_MIN_DEG, CAMERA_FOV_MAX_DEG);
}

/* ---- reading ---- */

static bool read_three(const manifest *m, const char *key, double ret[3], GError **error)
{
	JsonNode *node = manifest_get_node(m, key);
	if (json_read_numbers(node, 3, ret))
		return true;
	return refuse(error, manifest_path(m),
		node ? "'%s' is not three numbers" : "'%s' is missing", key);
}

static bool read_target(const manifest *m, view *v, GError **error)
{
	double forward[3], none[3] = { 0 };
	if (manifest_has(m, "target_m") || !manifest_has(m, "forward"))
		return read_three(m, "target_m", v->target_m, error);
	if (!read_three(m, "forward", forward, error))
		return false;
	double length = distance_m(forward, none);
	if (!(length > 1e-9) || !isfinite(length))
		return refuse(error, manifest_path(m), "'forward' is no direction");
	for (int k = 0; k < 3; k++)
		v->target_m[k] = v->eye_m[k] + VIEW_AHEAD_M / length * forward[k];
	return true;
}

static bool read_text(
	const manifest *m, const char *key, const char *otherwise, char **ret, GError **error)
{
	const char *text = manifest_has(m, key) ? manifest_get_string(m, key, error) : otherwise;
	*ret = g_strdup(text);
	return text || !manifest_has(m, key);
}

/* What may be missing stays 0. */
static bool read_metres(const manifest *m, const char *key, double *ret, GError **error)
{
	return !manifest_has(m, key) ||
	       manifest_get_number(m, key, 1e-3, VIEW_HEIGHT_MAX_M, ret, error);
}

static bool read_cut(const manifest *m, view *v, GError **error)
{
	JsonNode *node = manifest_get_node(m, "cut");
	if (node &&
		(!JSON_NODE_HOLDS_VALUE(node) || json_node_get_value_type(node) != G_TYPE_BOOLEAN))
		return refuse(error, manifest_path(m), "'cut' is neither true nor false");
	v->is_cut = node && json_node_get_boolean(node);
	return read_metres(m, "cut_m", &v->cut_m, error);
}

static bool read_parallel(const manifest *m, view *v, GError **error)
{
	v->fov_deg = CAMERA_PARALLEL_FOV_DEG;
	if (!manifest_get_number(
		    m, "height_m", VIEW_HEIGHT_MIN_M, VIEW_HEIGHT_MAX_M, &v->height_m, error) ||
		!read_metres(m, "depth_m", &v->depth_m, error) || !read_cut(m, v, error))
		return false;
	v->span_m[1] = v->height_m;
	return !manifest_has(m, "span_m") ||
	       json_read_numbers(manifest_get_node(m, "span_m"), 2, v->span_m) ||
	       refuse(error, manifest_path(m), "'span_m' is not two numbers");
}

static bool read_projection(const manifest *m, view *v, GError **error)
{
	const char *how = manifest_has(m, "projection")
				  ? manifest_get_string(m, "projection", error)
				  : "perspective";
	if (!how)
		return false;
	if (strcmp(how, "parallel") == 0)
		return read_parallel(m, v, error);
	if (strcmp(how, "perspective") != 0)
		return refuse(error, manifest_path(m),
			"'projection' is \"%s\"; it must be \"perspective\" or \"parallel\"", how);
	return manifest_get_number(
		m, "fov_deg", CAMERA_FOV_MIN_DEG, CAMERA_FOV_MAX_DEG, &v->fov_deg, error);
}

static view *read_view(const manifest *m, GError **error)
{
	g_autoptr(view) v = g_new0(view, 1);
	v->name = g_strdup(manifest_get_string(m, "name", error));
	if (!v->name || !read_text(m, "title", v->name, &v->title, error) ||
		!read_text(m, "style", NULL, &v->style, error) ||
		!read_three(m, "eye_m", v->eye_m, error) || !read_target(m, v, error) ||
		!read_projection(m, v, error) || !check(v, manifest_path(m), error))
		return NULL;
	return g_steal_pointer(&v);
}

view *view_parse(const char *text, size_t length, const char *path, GError **error)
{
	g_autoptr(manifest) m = manifest_parse(text, length, path, VIEW_SCHEMA, error);
	return m ? read_view(m, error) : NULL;
}

view *view_load(const site *s, const char *name, GError **error)
{
	g_autofree char *path = path_of(s, name);
	if (!check_name(name, path, error))
		return NULL;
	g_autoptr(manifest) m = manifest_load(path, VIEW_SCHEMA, error);
	g_autoptr(view) v = m ? read_view(m, error) : NULL;
	if (v && strcmp(v->name, name)) {
		refuse(error, path, "'name' is \"%s\", not that of the file", v->name);
		return NULL;
	}
	return g_steal_pointer(&v);
}

/* ---- writing ---- */

/* What is 0 is said by being missing. */
static void write_metres(manifest *m, const char *key, double metres)
{
	if (metres > 0)
		manifest_set_number(m, key, metres);
	else
		manifest_remove(m, key);
}

static void write_projection(const view *v, manifest *m)
{
	static const char *const keys[] = { "projection", "height_m", "depth_m", "cut", "cut_m",
		"span_m" };
	for (size_t n = 0; n < G_N_ELEMENTS(keys); n++)
		manifest_remove(m, keys[n]);
	if (!view_is_parallel(v)) {
		manifest_set_number(m, "fov_deg", v->fov_deg);
		return;
	}
	manifest_remove(m, "fov_deg");
	manifest_set_string(m, "projection", "parallel");
	manifest_set_number(m, "height_m", v->height_m);
	write_metres(m, "depth_m", v->depth_m);
	write_metres(m, "cut_m", v->cut_m);
	manifest_set_node(m, "span_m", json_write_numbers(v->span_m, 2));
	if (v->is_cut)
		manifest_set_node(m, "cut", json_node_init_boolean(json_node_alloc(), TRUE));
}

static void write_view(const view *v, manifest *m)
{
	manifest_set_int(m, "schema", VIEW_SCHEMA);
	manifest_set_string(m, "name", v->name);
	manifest_set_string(m, "title", v->title);
	manifest_set_node(m, "eye_m", json_write_numbers(v->eye_m, 3));
	manifest_set_node(m, "target_m", json_write_numbers(v->target_m, 3));
	write_projection(v, m);
	if (v->style)
		manifest_set_string(m, "style", v->style);
	else
		manifest_remove(m, "style");
	manifest_remove(m, "forward");
}

char *view_to_text(const view *v)
{
	g_autoptr(manifest) m = manifest_new("view");
	write_view(v, m);
	return manifest_to_text(m);
}

/* The file there is, so that its other keys stay; one that nobody can read is no loss. */
static manifest *manifest_before(const char *path, GError **error)
{
	g_autoptr(GError) unreadable = NULL;
	manifest *m = manifest_load(path, VIEW_SCHEMA, &unreadable);
	if (m)
		return m;
	if (!g_error_matches(unreadable, MANIFEST_ERROR, MANIFEST_ERROR_SCHEMA))
		return manifest_new(path);
	g_propagate_error(error, g_steal_pointer(&unreadable));
	return NULL;
}

bool view_save(const view *v, const site *s, GError **error)
{
	g_autofree char *folder = folder_of(s), *path = path_of(s, v->name);
	if (!check(v, path, error) || !files_make_folder(folder, error))
		return false;
	g_autoptr(manifest) m = manifest_before(path, error);
	if (!m)
		return false;
	write_view(v, m);
	return manifest_save(m, error);
}

bool view_remove(const site *s, const char *name, GError **error)
{
	g_autofree char *folder = folder_of(s), *path = path_of(s, name);
	if (!check_name(name, path, error))
		return false;
	if (unlink(path))
		return files_fail(error, path, "remove it");
	return files_sync_folder(folder, error);
}

/* ---- all of them ---- */

/* Caller frees; NULL: no view's file, as .gate.json.new. */
static char *name_of(const char *file)
{
	if (!g_str_has_suffix(file, SUFFIX))
		return NULL;
	g_autofree char *name = g_strndup(file, strlen(file) - strlen(SUFFIX));
	return view_name_is_good(name) ? g_steal_pointer(&name) : NULL;
}

static int compare_names(gconstpointer a, gconstpointer b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

GPtrArray *view_names(const site *s, GError **error)
{
	g_autofree char *folder = folder_of(s);
	g_autoptr(GPtrArray) names = g_ptr_array_new_with_free_func(g_free);
	if (!g_file_test(folder, G_FILE_TEST_EXISTS))
		return g_steal_pointer(&names);
	g_autoptr(GPtrArray) files = files_names(folder, error);
	for (guint i = 0; files && i < files->len; i++) {
		char *name = name_of(g_ptr_array_index(files, i));
		if (name)
			g_ptr_array_add(names, name);
	}
	g_ptr_array_sort(names, compare_names); /* files are sorted with their suffix */
	return files ? g_steal_pointer(&names) : NULL;
}

GPtrArray *view_list(const site *s, GPtrArray *damaged, GError **error)
{
	g_autoptr(GPtrArray) names = view_names(s, error);
	GPtrArray *views = names ? g_ptr_array_new_with_free_func((GDestroyNotify)view_free) : NULL;
	for (guint i = 0; names && i < names->len; i++) {
		g_autoptr(GError) unreadable = NULL;
		view *v = view_load(s, g_ptr_array_index(names, i), &unreadable);
		if (v)
			g_ptr_array_add(views, v);
		else if (damaged)
			g_ptr_array_add(damaged, g_strdup(unreadable->message));
	}
	return views;
}
