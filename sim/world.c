#include "sim/world.h"

#include "sim/world-trace.h"

static const double reach_clear_m = 1.25, head_m = 1.7;

const char *const world_scene_names[] = { "court", "street", "bridge", "hall", "range", NULL };
static void (*const scenes[])(
	struct site *) = { scene_court, scene_street, scene_bridge, scene_hall, scene_range };

static enum world_class class_of(const struct world *w, const struct hit *h)
{
	return g_array_index(w->site.objects, uint8_t, h->object);
}

/* How near anything but the ground comes to someone at (x, y), or 0 where there is no ground to
 * stand on. */
static double clearance_m(const struct world *w, vec foot)
{
	double near = 100;
	for (float up = 0.3f; up < 2.4f; up += 0.16f)
		for (unsigned i = 0; i < 40; i++) {
			float a = 2 * G_PI * ((float)i + up) / 40;
			struct ray r = { foot + (vec){ 0, 0, up }, { sinf(a), cosf(a), 0 }, 2 };
			struct hit h;
			if (trace_all(w, &r, false, &h))
				near = MIN(near, h.range_m);
		}
	return near;
}

static bool find_foot(const struct world *w, float x, float y, vec *ret_foot)
{
	struct ray down = { { x, y, site_ground(&w->site, x, y) + 2.3f }, { 0, 0, -1 }, 3.5f };
	struct hit h;
	if (!trace_solid(w, &down, false, &h))
		return false;
	*ret_foot = h.place;
	return h.normal[2] > 0.8f && class_of(w, &h) == WORLD_TERRAIN &&
	       clearance_m(w, h.place) > reach_clear_m;
}

/* The wanted place, or the nearest free one on a spiral round it. */
static bool find_free(const struct world *w, vec wanted, vec *ret_foot)
{
	for (unsigned i = 0; i < 160; i++) {
		float r = 0.14f * sqrtf((float)i) * 1.6f, a = 2.399963f * (float)i;
		if (find_foot(w, wanted[0] + r * sinf(a), wanted[1] + r * cosf(a), ret_foot))
			return true;
	}
	return false;
}

static void set_rotation(struct world_station *s, struct dice *d)
{
	double yaw = 2 * G_PI * roll(d), axis = 2 * G_PI * roll(d);
	double tilt = 0.5 * roll(d) * G_PI / 180, c = cos(tilt), n = sin(tilt);
	double y[3][3] = { { cos(yaw), sin(yaw), 0 }, { -sin(yaw), cos(yaw), 0 }, { 0, 0, 1 } };
	double u = cos(axis), v = sin(axis);
	double t[3][3] = { { c + u * u * (1 - c), u * v * (1 - c), v * n },
		{ u * v * (1 - c), c + v * v * (1 - c), -u * n }, { -v * n, u * n, c } };
	for (unsigned i = 0; i < 3; i++)
		for (unsigned j = 0; j < 3; j++)
			s->rotation[i][j] =
				t[i][0] * y[0][j] + t[i][1] * y[1][j] + t[i][2] * y[2][j];
}

/* A place moved aside may have come close to the one before. */
static bool too_near(const struct world *w, vec foot)
{
	if (!w->stations->len)
		return false;
	const double *last =
		g_array_index(w->stations, struct world_station, w->stations->len - 1).position_m;
	return hypot(last[0] - foot[0], last[1] - foot[1]) < 5.05;
}

static void set_up_stations(struct world *w)
{
	struct dice d = dice_of(w->site.seed, 99);
	w->stations = g_array_new(FALSE, TRUE, sizeof(struct world_station));
	for (guint i = 0; i < w->site.walk->len; i++) {
		vec foot;
		struct world_station s = { 0 };
		double up = head_m + 0.1 * (roll(&d) - 0.5);
		set_rotation(&s, &d);
		if (!find_free(w, g_array_index(w->site.walk, vec, i), &foot))
			continue;
		if (too_near(w, foot))
			continue;
		s.position_m[0] = foot[0], s.position_m[1] = foot[1],
		s.position_m[2] = foot[2] + up;
		g_array_append_val(w->stations, s);
	}
}

static bool check_variant(const char *scene, const struct world_variant *v, GError **error)
{
	const char *what = v->symmetric && strcmp(scene, "hall")    ? "symmetric"
			   : v->repeated && strcmp(scene, "street") ? "repeated"
								    : NULL;
	if (!what)
		return true;
	g_set_error(
		error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE, "there is no %s %s", what, scene);
	return false;
}

world *world_new(
	const char *scene, uint64_t seed, const struct world_variant *variant, GError **error)
{
	guint i = 0;
	while (world_scene_names[i] && g_strcmp0(world_scene_names[i], scene))
		i++;
	if (!world_scene_names[i]) {
		g_autofree char *names = g_strjoinv(", ", (char **)world_scene_names);
		g_set_error(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
			"no scene is called '%s'; there are %s", scene ? scene : "", names);
		return NULL;
	}
	if (variant && !check_variant(scene, variant, error))
		return NULL;
	world *w = g_new0(world, 1);
	site_init(&w->site, hash_u64(seed ^ hash_u64(i)));
	if (variant) {
		w->site.variant = *variant;
		w->site.loose = dice_of(w->site.seed, 1000 + variant->moved);
	}
	light_choose(&w->site.light, &w->site.dice);
	scenes[i](&w->site);
	if (w->site.variant.symmetric)
		site_make_symmetric(&w->site);
	trace_commit(w);
	light_gather(w);
	set_up_stations(w);
	return w;
}

void world_free(world *w)
{
	if (!w)
		return;
	trace_free(w);
	site_clear(&w->site);
	g_free(w->probes.light);
	g_array_unref(w->stations);
	g_free(w);
}

uint32_t world_station_count(const world *w)
{
	return w->stations->len;
}

void world_get_station(const world *w, uint32_t number, struct world_station *ret_station)
{
	g_return_if_fail(number >= 1 && number <= w->stations->len);
	*ret_station = g_array_index(w->stations, struct world_station, number - 1);
}

static struct ray ray_of(const double origin_m[3], const double direction[3], double limit_m)
{
	return (struct ray){ { origin_m[0], origin_m[1], origin_m[2] },
		{ direction[0], direction[1], direction[2] }, limit_m };
}

bool world_cast(const world *w, const double origin_m[3], const double direction[3], double limit_m,
	struct surface *ret_surface)
{
	struct ray r = ray_of(origin_m, direction, limit_m);
	struct hit h;
	*ret_surface = (struct surface){ 0 };
	if (!trace_all(w, &r, false, &h))
		return false;
	vec albedo = material_albedo(h.material, h.place, h.normal, hit_footprint(&r, &h), h.face);
	for (unsigned i = 0; i < 3; i++) {
		ret_surface->albedo[i] = albedo[i];
		ret_surface->normal[i] = h.normal[i];
	}
	ret_surface->range_m = h.range_m;
	ret_surface->instance = h.object;
	ret_surface->class = class_of(w, &h);
	ret_surface->optics = material_optics(h.material);
	ret_surface->reflectivity = h.material->reflectivity *
				    (0.6f + 0.4f * albedo[0] / MAX(h.material->colour[0], 0.01f));
	return true;
}

void world_radiance(const world *w, const double origin_m[3], const double *direction,
	uint32_t count, float *ret_rgb)
{
	for (uint32_t first = 0; first < count; first += PACKET) {
		uint32_t some = MIN(PACKET, count - first);
		struct ray r[PACKET];
		vec light[PACKET];
		for (uint32_t i = 0; i < some; i++)
			r[i] = ray_of(origin_m, direction + 3 * (first + i), 2000);
		light_along(w, r, some, light);
		for (uint32_t i = 0; i < some; i++)
			for (unsigned k = 0; k < 3; k++)
				ret_rgb[3 * (first + i) + k] = light[i][k];
	}
}
