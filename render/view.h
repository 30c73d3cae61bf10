#ifndef RENDER_VIEW_H
#define RENDER_VIEW_H
/* From where a site is looked at, whatever the size of the picture. People save views as
 * SITE/views/NAME.json:
 *
 *     { "schema": 1, "name": "gate", "title": "The gate from the yard",      title: else the name
 *       "eye_m": [x, y, z],
 *       "target_m": [x, y, z],      or "forward": [x, y, z], of any length; the target is then
 *                                   VIEW_AHEAD_M ahead
 *       "fov_deg": 50,              from the upper to the lower edge of the picture
 *       "style": "ink" }            may be missing
 *
 * A parallel view (camera.h) has instead of "fov_deg"
 *
 *       "projection": "parallel",
 *       "height_m": 12,             from the upper to the lower edge, at any depth
 *       "depth_m": 20,              how far before the eye is drawn; missing: all
 *       "cut": true,                the plane across the view at the eye cuts (camera.h); missing: it only begins there
 *       "cut_m": 0.05,              how thick; missing: as the style has it
 *       "span_m": [30, 9]           how wide and high what it is to show is, around the middle, missing: 0 and "height_m"
 *
 * What lies behind the eye is not drawn: in a section the eye is on the cut.
 *
 * Other keys are kept. Every site has built-in views without any file (view-find.h).
 *
 * Errors of files are those of manifest.h and files.h: one sentence with the path and the key. */
#include "acquire/site.h"
#include "render/camera.h"

#define VIEW_SCHEMA   1
#define VIEW_AHEAD_M  10.0
#define VIEW_REACH_M  1e7 /* of coordinates */
#define VIEW_NAME_MAX 64
/* From upper to lower edge, of parallel views. */
#define VIEW_HEIGHT_MIN_M 0.01
#define VIEW_HEIGHT_MAX_M 1e5

typedef struct view view;
struct view {
	char *name; /* of a saved or built-in one; of another what it was asked for by */
	char *title;
	char *style; /* NULL: none */
	double eye_m[3], target_m[3];
	double fov_deg; /* CAMERA_FOV_MIN_DEG .. CAMERA_FOV_MAX_DEG; of a parallel view CAMERA_PARALLEL_FOV_DEG */
	double height_m; /* 0: a pinhole camera's; else a parallel one's, as above, and so are the rest */
	double depth_m; /* 0: all */
	bool is_cut;
	double cut_m;
	double span_m[2];
};
static inline bool view_is_parallel(const view *v)
{
	return v->height_m > 0;
}
view *view_new(const char *name, const char *title, const double eye_m[3], const double target_m[3],
	double fov_deg);
/* Parallel, without a cut, of all depths; its span is 0 and its height. */
view *view_new_parallel(const char *name, const char *title, const double eye_m[3],
	const double target_m[3], double height_m);
void view_free(view *v); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(view, view_free)
/* Of another name and title, and of no style. */
view *view_renamed(const view *v, const char *name, const char *title);
/* far_m reaches ten times as far as the target at least. */
struct camera view_camera(const view *v, uint32_t width, uint32_t height);

/* 1 to VIEW_NAME_MAX letters of a-z and A-Z, digits, - and _, first a letter or digit. */
bool view_name_is_good(const char *name);

view *view_load(const site *s, const char *name, GError **error);
/* For text at hand; path is what messages say. */
view *view_parse(const char *text, size_t length, const char *path, GError **error);
char *view_to_text(const view *v); /* as it is saved where no file was; caller frees */
/* Refuses what view_load would, and to write over a file of a later version. Views are files of
 * their own, so the site need not be open for writing, but two programs must not save one at a
 * time. */
bool view_save(const view *v, const site *s, GError **error);
/* G_IO_ERROR_NOT_FOUND when there is none. */
bool view_remove(const site *s, const char *name, GError **error);

/* Names of the files there are, sorted, damaged ones too; none where there is no folder. */
GPtrArray *view_names(const site *s, GError **error);
/* Of struct view, sorted by name. One that cannot be read is passed over; its sentence is added to
 * damaged (NULL: not wanted). Both free what is in them. */
GPtrArray *view_list(const site *s, GPtrArray *damaged, GError **error);

#endif
