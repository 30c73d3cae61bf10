#include "render/bench-frames.h"
#include "render/bench-discs.h"
#include "render/view-parallel.h"
#include <math.h>
#include <string.h>

/* As good as each other: what differs by less. */
#define CLOSE 0.05

static uint64_t count_in_view(const frame *f)
{
	uint32_t count;
	uint64_t points = 0;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	for (uint32_t n = 0; n < count; n++)
		points += views[n].chunk->count;
	return points;
}

/* ---- candidates ---- */

static bool add(GArray *to, frame *f, const char *name, const struct camera *c, GError **error)
{
	struct bench_camera one = { .camera = *c };
	g_strlcpy(one.name, name, sizeof one.name);
	if (!frame_move(f, c, error))
		return false;
	one.in_view = count_in_view(f);
	g_array_append_val(to, one);
	return true;
}

static bool add_turned(GArray *to, frame *f, const GPtrArray *views, int degrees, GError **error)
{
	for (guint n = 0; n < views->len; n++) {
		const view *v = views->pdata[n];
		struct camera c = view_camera(v, f->camera.width, f->camera.height);
		g_autofree char *name =
			degrees ? g_strdup_printf("%s %+d", v->name, degrees) : g_strdup(v->name);
		if (degrees)
			c = camera_turned(&c, degrees * G_PI / 180);
		if (!add(to, f, name, &c, error))
			return false;
	}
	return true;
}

static bool add_nearer(GArray *to, frame *f, const view *v, GError **error)
{
	for (double factor = 1.25; factor < 6; factor *= 1.25) {
		double eye[3];
		for (int k = 0; k < 3; k++)
			eye[k] = v->target_m[k] + (v->eye_m[k] - v->target_m[k]) / factor;
		struct camera c = camera_look_at(
			eye, v->target_m, v->fov_deg, f->camera.width, f->camera.height);
		g_autofree char *name = g_strdup_printf("%s x%.2g", v->name, factor);
		if (!add(to, f, name, &c, error))
			return false;
	}
	return true;
}

static GArray *candidates(const bench_place *p, frame *f, GError **error)
{
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(struct bench_camera));
	g_autoptr(GPtrArray) views = g_ptr_array_new_with_free_func((GDestroyNotify)view_free);
	g_autoptr(GPtrArray) names = view_built_in_names(&p->sources);
	for (guint n = 0; n < names->len; n++)
		if (!view_parallel_is(names->pdata[n]))
			g_ptr_array_add(views, view_built_in(&p->sources, names->pdata[n]));
	if (!add_turned(all, f, views, 0, error) || !add_nearer(all, f, views->pdata[0], error))
		return NULL;
	for (int degrees = 30; degrees < 360; degrees += 30)
		if (!add_turned(all, f, views, degrees > 180 ? degrees - 360 : degrees, error))
			return NULL;
	return g_steal_pointer(&all);
}

/* ---- the closest ---- */

static const struct bench_camera *closest(const GArray *all, uint64_t wanted)
{
	const struct bench_camera *best = NULL;
	int least = G_MAXINT;
	for (guint n = 0; n < all->len; n++) {
		const struct bench_camera *c = &g_array_index(all, struct bench_camera, n);
		double off = fabs(log(fmax((double)c->in_view, 1) / (double)wanted));
		int steps = (int)(off / CLOSE);
		if (steps < least) {
			least = steps;
			best = c;
		}
	}
	return best;
}

bool bench_cameras_find(const bench_place *p, frame *f, const uint64_t *wanted_in_view,
	uint32_t count, struct bench_camera *ret, GError **error)
{
	g_autoptr(GArray) all = candidates(p, f, error);
	for (uint32_t n = 0; all && n < count; n++) {
		ret[n] = *closest(all, wanted_in_view[n]);
		if (!frame_move(f, &ret[n].camera, error))
			return false;
		ret[n].discs = bench_count_discs(f);
	}
	return all;
}
