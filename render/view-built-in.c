#include "render/view-find.h"
#include "render/view-parallel.h"
#include <math.h>
#include <string.h>

#define ASPECT(s)       ((s)->aspect > 0 ? (s)->aspect : 4.0 / 3.0)
#define LOOK_ROWS       72u
#define OVERVIEW_FOV    40.0
#define TRIPOD_M        1.6 /* where the ground was not seen */
#define HEADINGS        24
#define GLANCE_MAX_RAD  (8 * G_PI / 180)
#define ASIDE_LEAST_RAD (1 * G_PI / 180)
#define BAND_EMPTY      0.2 /* of half the picture, at least, above and below */
#define BAND_MARGIN     1.15
#define BAND_FOV_LEAST  24.0
#define WALK_ASIDE_RAD  (22.5 * G_PI / 180) /* past a pillar */

/* A picture that is good enough to find out what is seen. */
static struct camera glance(const struct view_sources *s, const double eye_m[3], double heading_rad,
	double elevation_rad, double fov_deg)
{
	uint32_t columns = (uint32_t)CLAMP(round(LOOK_ROWS * ASPECT(s)), 8, 8 * LOOK_ROWS);
	return camera_towards(eye_m, heading_rad, elevation_rad, fov_deg, columns, LOOK_ROWS);
}

static view *view_ahead(const char *name, const char *title, const struct camera *c,
	double distance_m, double fov_deg)
{
	double target[3];
	for (int k = 0; k < 3; k++)
		target[k] = c->eye_m[k] + distance_m * c->forward[k];
	return view_new(name, title, c->eye_m, target, fov_deg);
}

/* ---- from above ---- */

static void bulk_middle(const struct view_sources *s, double ret_m[3])
{
	struct view_box bulk = view_bulk(s);
	for (int k = 0; k < 3; k++)
		ret_m[k] = (bulk.low_m[k] + bulk.high_m[k]) / 2;
}

static view *overview(const struct view_sources *s)
{
	double middle[3], most = -1, distance = 0;
	struct camera best;
	bulk_middle(s, middle);
	for (int tilt = 0; tilt < 3; tilt++)
		for (int i = 0; i < HEADINGS; i++) {
			struct camera c = glance(s, middle, 2 * G_PI * i / HEADINGS,
				-(25 + 5 * tilt) * G_PI / 180, OVERVIEW_FOV);
			double depth = view_frame(s, middle, &c);
			double points = view_look(s, &c, 0, INFINITY).points;
			if (points <= most)
				continue;
			most = points;
			best = c;
			distance = depth;
		}
	return view_ahead("overview", "Overview", &best, distance, OVERVIEW_FOV);
}

/* ---- from where scanners stood ---- */

struct middle {
	double at_m[2];
	double near_m, far_m; /* middle distance */
};

static struct middle middle_of(const struct view_sources *s)
{
	struct view_box b = view_bulk(s);
	double half = hypot(b.high_m[0] - b.low_m[0], b.high_m[1] - b.low_m[1]) / 2;
	return (struct middle){ { (b.low_m[0] + b.high_m[0]) / 2, (b.low_m[1] + b.high_m[1]) / 2 },
		fmin(half / 2, fmax(2, half / 4)), fmax(1, half) };
}

/* A lidar with some rings sees a band alone. Where the picture stays empty above and below it, the picture is of the band. */
static bool find_band(
	const struct view_sight *sight, double *ret_elevation_rad, double *ret_fov_deg)
{
	double half = VIEW_FOV_DEG * G_PI / 360, room = BAND_EMPTY * half;
	if (sight->high_rad > half - room || sight->low_rad < -half + room ||
		sight->high_rad <= sight->low_rad)
		return false;
	double high = BAND_MARGIN * (sight->high_rad - sight->low_rad);
	*ret_elevation_rad = (sight->high_rad + sight->low_rad) / 2;
	*ret_fov_deg = CLAMP(high * 180 / G_PI, BAND_FOV_LEAST, VIEW_FOV_DEG);
	return true;
}

/* Level but for a little towards what is seen, so that uprights stay nearly upright. */
static view *view_towards(const char *name, const char *title, const struct camera *c,
	const struct view_sight *sight, double otherwise_m)
{
	double elevation = CLAMP(sight->elevation_rad, -GLANCE_MAX_RAD, GLANCE_MAX_RAD),
	       fov_deg = VIEW_FOV_DEG;
	find_band(sight, &elevation, &fov_deg);
	struct camera tilted = camera_towards(
		c->eye_m, camera_heading_rad(c), elevation, fov_deg, c->width, c->height);
	return view_ahead(name, title, &tilted,
		sight->distance_m > 0 ? sight->distance_m : otherwise_m, fov_deg);
}

/* Of headings to both sides of one; an equal one farther to the side is none better. */
static struct camera best_heading(const struct view_sources *s, const double eye_m[3],
	const struct middle *m, double heading_rad, double aside_rad, struct view_sight *ret)
{
	const double step = G_PI / HEADINGS;
	struct camera best = glance(s, eye_m, heading_rad, 0, VIEW_FOV_DEG);
	*ret = view_look(s, &best, m->near_m, m->far_m);
	for (int i = 2; (i / 2) * step <= aside_rad + 1e-9; i++) {
		double aside = (i % 2 ? -1 : 1) * (i / 2) * step;
		struct camera c = glance(s, eye_m, heading_rad + aside, 0, VIEW_FOV_DEG);
		struct view_sight sight = view_look(s, &c, m->near_m, m->far_m);
		if (sight.points <= ret->points)
			continue;
		*ret = sight;
		best = c;
	}
	return best;
}

/* A scanner may have looked one way alone: what there is comes into the middle. */
static struct camera centred(const struct view_sources *s, const struct middle *m,
	const struct camera *c, struct view_sight *sight)
{
	struct camera ret = *c;
	for (int times = 0; times < 3 && fabs(sight->aside_rad) > ASIDE_LEAST_RAD; times++) {
		ret = glance(
			s, c->eye_m, camera_heading_rad(&ret) + sight->aside_rad, 0, VIEW_FOV_DEG);
		*sight = view_look(s, &ret, m->near_m, m->far_m);
	}
	return ret;
}

static view *station_view(const struct view_sources *s, size_t k, const char *name)
{
	struct middle m = middle_of(s);
	struct view_sight sight;
	g_autofree char *title = g_strdup_printf("From scan %u", s->stations[k].number);
	struct camera c = best_heading(s, s->stations[k].pose.translation_m, &m, 0, G_PI, &sight);
	c = centred(s, &m, &c, &sight);
	return view_towards(name, title, &c, &sight, m.far_m);
}

static void stand_at(const struct view_sources *s, size_t k, double ret_eye_m[3])
{
	const double *scanner = s->stations[k].pose.translation_m;
	double ground = view_ground_m(s, scanner);
	memcpy(ret_eye_m, scanner, 3 * sizeof *scanner);
	ret_eye_m[2] = (isnan(ground) ? scanner[2] - TRIPOD_M : ground) + VIEW_PERSON_M;
}

/* From the middle itself there is no way towards it: such places count when there are no others. */
static view *walk(const struct view_sources *s)
{
	struct middle m = middle_of(s);
	struct view_sight most = { .points = -1 };
	struct camera best;
	bool is_out = false;
	for (size_t k = 0; k < s->station_count; k++) {
		double eye[3];
		stand_at(s, k, eye);
		double east = m.at_m[0] - eye[0], north = m.at_m[1] - eye[1];
		bool out = hypot(east, north) >= m.far_m / 4;
		struct view_sight sight;
		struct camera c = best_heading(
			s, eye, &m, atan2(east, north), out ? WALK_ASIDE_RAD : G_PI, &sight);
		if (out < is_out || (out == is_out && sight.points <= most.points))
			continue;
		most = sight;
		best = c;
		is_out = out;
	}
	best = centred(s, &m, &best, &most);
	return view_towards("walk", "Walk", &best, &most, m.far_m);
}

/* ---- names ---- */

/* 0: it is no station that there is. */
static size_t station_of(const struct view_sources *s, const char *name)
{
	guint64 k;
	if (!g_str_has_prefix(name, "station-") || name[strlen("station-")] == '0' ||
		!g_ascii_string_to_unsigned(
			name + strlen("station-"), 10, 1, MAX(1, s->station_count), &k, NULL))
		return 0;
	return s->station_count ? (size_t)k : 0;
}

view *view_built_in(const struct view_sources *s, const char *name)
{
	size_t station = station_of(s, name);
	if (!s->boxes)
		return NULL;
	if (station)
		return station_view(s, station - 1, name);
	if (strcmp(name, "overview") == 0)
		return overview(s);
	if (view_parallel_is(name))
		return view_parallel_find(s, name, NULL);
	return s->station_count && strcmp(name, "walk") == 0 ? walk(s) : NULL;
}

GPtrArray *view_built_in_names(const struct view_sources *s)
{
	GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
	if (!s->boxes)
		return names;
	g_ptr_array_add(names, g_strdup("overview"));
	view_parallel_add_names(names);
	if (s->station_count)
		g_ptr_array_add(names, g_strdup("walk"));
	for (size_t k = 1; k <= s->station_count; k++)
		g_ptr_array_add(names, g_strdup_printf("station-%zu", k));
	return names;
}
