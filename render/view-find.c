#include "render/view-find.h"
#include "render/view-parallel.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

/* ---- eye and target ---- */

static bool read_number(const char *text, double *ret)
{
	char *end;
	*ret = g_ascii_strtod(text, &end);
	return end != text && !*end && !g_ascii_isspace(*text) && isfinite(*ret);
}

static bool read_place(const char *text, double ret_m[3])
{
	g_auto(GStrv) words = g_strsplit(text, ",", 4);
	if (g_strv_length(words) != 3)
		return false;
	for (int k = 0; k < 3; k++)
		if (!read_number(words[k], &ret_m[k]) || fabs(ret_m[k]) > VIEW_REACH_M)
			return false;
	return true;
}

static view *refuse(const char *spec, const char *what, GError **error)
{
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
		"view '%s': %s (X,Y,Z:X,Y,Z[:FOV] are eye, target and degrees from the upper to "
		"the "
		"lower edge)",
		spec, what);
	return NULL;
}

static view *read_places(const char *spec, GError **error)
{
	double eye[3], target[3], fov_deg = VIEW_FOV_DEG;
	g_auto(GStrv) words = g_strsplit(spec, ":", 4);
	guint count = g_strv_length(words);
	if (count < 2 || count > 3)
		return refuse(spec, "has not two or three parts with : between them", error);
	if (!read_place(words[0], eye))
		return refuse(spec, "the eye is not three numbers of metres", error);
	if (!read_place(words[1], target))
		return refuse(spec, "the target is not three numbers of metres", error);
	if (count == 3 && (!read_number(words[2], &fov_deg) || fov_deg < CAMERA_FOV_MIN_DEG ||
				  fov_deg > CAMERA_FOV_MAX_DEG))
		return refuse(spec, "the field of view is not 1 to 170 degrees", error);
	double distance = hypot(hypot(target[0] - eye[0], target[1] - eye[1]), target[2] - eye[2]);
	if (!(distance >= 1e-6))
		return refuse(spec, "the target is where the eye is", error);
	return view_new(spec, spec, eye, target, fov_deg);
}

/* ---- names ---- */

static bool is_saved(const struct view_sources *s, const char *name, bool *ret, GError **error)
{
	g_autoptr(GPtrArray) names = s->site ? view_names(s->site, error) : NULL;
	*ret = names && g_ptr_array_find_with_equal_func(names, name, g_str_equal, NULL);
	return names || !s->site;
}

static void add_names(GString *text, const GPtrArray *names)
{
	for (guint i = 0; names && i < names->len; i++)
		g_string_append_printf(
			text, "%s%s", text->len ? ", " : "", (char *)g_ptr_array_index(names, i));
}

static bool say_unknown(const struct view_sources *s, const char *spec, GError **error)
{
	g_autoptr(GString) text = g_string_new(NULL);
	g_autoptr(GPtrArray) saved = s->site ? view_names(s->site, NULL) : NULL;
	g_autoptr(GPtrArray) built_in = view_built_in_names(s);
	add_names(text, saved);
	add_names(text, built_in);
	if (!s->boxes)
		g_string_append(text, text->len
					      ? "; the others need a model, which the site has not"
					      : "none, since the site has no model");
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
		"there is no view '%s'; there are: %s; or eye and target in metres, as in "
		"0,-10,2:0,0,1",
		spec, text->str);
	return false;
}

static bool find_saved(const struct view_sources *s, const char *name, view **ret, GError **error)
{
	view *v = view_load(s->site, name, error);
	if (v)
		*ret = v;
	return v;
}

bool view_find(const struct view_sources *s, const char *spec, view **ret, GError **error)
{
	bool saved;
	if (!is_saved(s, spec, &saved, error))
		return false;
	if (saved)
		return find_saved(s, spec, ret, error);
	view *v = NULL;
	if (view_parallel_is(spec)) {
		if (!s->boxes)
			return say_unknown(s, spec, error);
		v = view_parallel_find(s, spec, error);
	} else if (!(v = view_built_in(s, spec))) {
		if (!strpbrk(spec, ",:"))
			return say_unknown(s, spec, error);
		v = read_places(spec, error);
	}
	if (v)
		*ret = v;
	return v;
}
