#include "render/view-parallel.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define ASPECT(s) ((s)->aspect > 0 ? (s)->aspect : 4.0 / 3.0)
/* Of the picture that what is shown fills. */
#define FILL 0.92
/* What is seen through windows and gates must not make a picture small: so many of the points may be beyond each edge, but where nearly
 * all reach not much farther these are in it. */
#define FAR_PART     0.01
#define STRAY_PART   0.0005
#define NOT_FAR      1.3
#define NOT_FAR_UP   2.5 /* roofs and towers, of which little is seen, belong to it */
#define HEIGHT_MAX_M 1e4

static const char elevation[] = "elevation-", section[] = "section:", plan_at[] = "plan:";
static const struct side {
	const char *name, *title;
	double heading_rad; /* that is looked along */
} sides[] = {
	{ "north", "Elevation from the north", G_PI },
	{ "south", "Elevation from the south", 0 },
	{ "east", "Elevation from the east", -G_PI / 2 },
	{ "west", "Elevation from the west", G_PI / 2 },
};

/* ---- how far points reach ---- */

/* What counts: from a plane on so far. */
struct region {
	double from_m[3], along[3], depth_m;
};

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A box along an axis. */
struct stretch {
	double low_m, high_m, points;
};

static struct stretch stretch_of(const struct model_chunk *c, const double axis[3])
{
	double middle = dot(c->centre_m, axis), half = 1e-3;
	for (int k = 0; k < 3; k++)
		half += fabs(axis[k]) * c->half_size_m[k];
	return (struct stretch){ middle - half, middle + half, c->points };
}

/* The part of it that lies in the region. */
static double part_in(const struct region *r, const struct model_chunk *c)
{
	struct stretch s = stretch_of(c, r->along);
	double from = dot(r->from_m, r->along),
	       in = fmin(s.high_m, from + r->depth_m) - fmax(s.low_m, from);
	return CLAMP(in / (s.high_m - s.low_m), 0, 1);
}

static double points_below(const GArray *all, double at_m)
{
	double sum = 0;
	for (guint n = 0; n < all->len; n++) {
		const struct stretch *s = &g_array_index(all, struct stretch, n);
		sum += s->points * CLAMP((at_m - s->low_m) / (s->high_m - s->low_m), 0, 1);
	}
	return sum;
}

static double percentile(const GArray *all, double points, double low_m, double high_m)
{
	for (int i = 0; i < 50; i++) {
		double middle = (low_m + high_m) / 2;
		*(points_below(all, middle) < points ? &low_m : &high_m) = middle;
	}
	return (low_m + high_m) / 2;
}

/* From where to where all but a part of the region's points, at each end, are along an axis. r NULL: of all points. */
static void reach_but(const struct view_sources *s, const struct region *r, const double axis[3],
	double stray, double ret_m[2])
{
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(struct stretch));
	double low = INFINITY, high = -INFINITY, sum = 0;
	for (uint64_t n = 0; n < s->boxes->count; n++) {
		struct stretch one = stretch_of(&s->boxes->box[n], axis);
		one.points *= r ? part_in(r, &s->boxes->box[n]) : 1;
		if (!(one.points > 0))
			continue;
		g_array_append_val(all, one);
		low = fmin(low, one.low_m);
		high = fmax(high, one.high_m);
		sum += one.points;
	}
	ret_m[0] = ret_m[1] = 0;
	if (!all->len)
		return;
	ret_m[0] = percentile(all, stray * sum, low, high);
	ret_m[1] = percentile(all, (1 - stray) * sum, low, high);
}

static void reach(const struct view_sources *s, const struct region *r, const double axis[3],
	double not_far, double ret_m[2])
{
	double nearly[2];
	reach_but(s, r, axis, FAR_PART, ret_m);
	reach_but(s, r, axis, STRAY_PART, nearly);
	if (nearly[1] - nearly[0] < not_far * (ret_m[1] - ret_m[0]))
		memcpy(ret_m, nearly, sizeof nearly);
}

/* ---- framing ---- */

/* Of a view along forward whose picture has right and up: what of the region is to be seen, around what it is in the middle. across: from
 * where to where to the right; NULL: as far as points reach. */
static view *frame_view(const struct view_sources *s, const char *name, const char *title,
	const struct region *r, const double right[3], const double up[3], const double *across_m)
{
	double across[2], upright[2], deep[2], eye[3], target[3];
	if (across_m)
		memcpy(across, across_m, sizeof across);
	else
		reach(s, r, right, NOT_FAR, across);
	reach(s, r, up, up[2] > 0 ? NOT_FAR_UP : NOT_FAR, upright);
	reach(s, r, r->along, NOT_FAR, deep);
	double from = dot(r->from_m, r->along);
	double span[2] = { fmax(across[1] - across[0], 0.1), fmax(upright[1] - upright[0], 0.1) };
	double ahead = fmax((deep[0] + deep[1]) / 2 - from, 0.1);
	for (int k = 0; k < 3; k++) {
		eye[k] = (across[0] + across[1]) / 2 * right[k] +
			 (upright[0] + upright[1]) / 2 * up[k] + from * r->along[k];
		target[k] = eye[k] + ahead * r->along[k];
	}
	view *v = view_new_parallel(
		name, title, eye, target, fmax(span[1], span[0] / ASPECT(s)) / FILL);
	memcpy(v->span_m, span, sizeof span);
	v->depth_m = r->depth_m < CAMERA_FAR_M ? r->depth_m : 0;
	return v;
}

/* Level. */
static view *frame_upright(const struct view_sources *s, const char *name, const char *title,
	const struct region *r, const double *across_m)
{
	const double right[3] = { r->along[1], -r->along[0], 0 }, up[3] = { 0, 0, 1 };
	return frame_view(s, name, title, r, right, up, across_m);
}

/* Begins before all there is. */
static struct region region_of_all(const struct view_sources *s, const double along[3])
{
	double deep[2];
	struct region r = { .depth_m = CAMERA_FAR_M };
	reach_but(s, NULL, along, 0, deep);
	for (int k = 0; k < 3; k++) {
		r.along[k] = along[k];
		r.from_m[k] = (deep[0] - 0.1) * along[k];
	}
	return r;
}

/* ---- plans ---- */

/* What most scanners stand on. */
static int compare_heights(gconstpointer a, gconstpointer b)
{
	const double *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

static double ground_m(const struct view_sources *s)
{
	g_autoptr(GArray) heights = g_array_new(FALSE, FALSE, sizeof(double));
	for (size_t k = 0; k < s->station_count; k++) {
		double here = view_ground_m(s, s->stations[k].pose.translation_m);
		if (!isnan(here))
			g_array_append_val(heights, here);
	}
	g_array_sort(heights, compare_heights);
	return heights->len ? g_array_index(heights, double, heights->len / 2)
			    : view_bulk(s).low_m[2];
}

static view *look_down(
	const struct view_sources *s, const char *name, const char *title, const struct region *r)
{
	static const double east[3] = { 1, 0, 0 }, north[3] = { 0, 1, 0 };
	view *v = frame_view(s, name, title, r, east, north, NULL);
	v->target_m[0] = v->eye_m[0]; /* straight down to the last bit */
	v->target_m[1] = v->eye_m[1];
	return v;
}

static const double downwards[3] = { 0, 0, -1 };

static view *plan(const struct view_sources *s)
{
	struct region r = region_of_all(s, downwards);
	return look_down(s, "plan", "Plan", &r);
}

static view *plan_cut_at(const struct view_sources *s, const char *spec, double height_m)
{
	struct region r = { .from_m = { 0, 0, ground_m(s) + height_m },
		.along = { 0, 0, -1 },
		.depth_m = CAMERA_FAR_M };
	g_autofree char *title = g_strdup_printf("Plan at %g m", height_m);
	view *v = look_down(s, spec, title, &r);
	v->is_cut = true;
	return v;
}

/* ---- elevations ---- */

/* The heading nearest to one that goes along walls, or across them. */
static double turned_to_walls(const struct view_sources *s, double heading_rad)
{
	double walls = s->boxes->walls_rad;
	return walls + round((heading_rad - walls) / (G_PI / 2)) * (G_PI / 2);
}

static view *elevation_from(const struct view_sources *s, const char *spec, const struct side *side)
{
	double heading = turned_to_walls(s, side->heading_rad);
	double along[3] = { sin(heading), cos(heading), 0 };
	struct region r = region_of_all(s, along);
	return frame_upright(s, spec, side->title, &r, NULL);
}

/* ---- sections ---- */

static view *section_along(const struct view_sources *s, const char *spec, const char *title,
	const double from_m[2], const double to_m[2], double depth_m, bool whole_line)
{
	double length = hypot(to_m[0] - from_m[0], to_m[1] - from_m[1]);
	double right[3] = { (to_m[0] - from_m[0]) / length, (to_m[1] - from_m[1]) / length, 0 };
	struct region r = { .from_m = { from_m[0], from_m[1], 0 },
		.along = { -right[1], right[0], 0 },
		.depth_m = depth_m };
	double begin = from_m[0] * right[0] + from_m[1] * right[1],
	       across[2] = { begin, begin + length };
	view *v = frame_upright(s, spec, title, &r, whole_line ? across : NULL);
	v->is_cut = true;
	return v;
}

/* Through the middle of the bulk, looking to where the north is, or the west. */
static view *section_through(const struct view_sources *s, const char *name)
{
	struct view_box bulk = view_bulk(s);
	double east = turned_to_walls(s, G_PI / 2), north = turned_to_walls(s, 0), reaches[2][2];
	double ways[2][3] = { { sin(east), cos(east), 0 }, { sin(north), cos(north), 0 } };
	for (int k = 0; k < 2; k++)
		reach_but(s, NULL, ways[k], FAR_PART, reaches[k]);
	bool is_east = reaches[0][1] - reaches[0][0] >= reaches[1][1] - reaches[1][0],
	     is_a = g_str_has_suffix(name, "-a");
	const double *way = ways[is_east == is_a ? 0 : 1];
	double from[2] = { (bulk.low_m[0] + bulk.high_m[0]) / 2,
		(bulk.low_m[1] + bulk.high_m[1]) / 2 };
	double to[2] = { from[0] + way[0], from[1] + way[1] };
	return section_along(
		s, name, is_a ? "Section A" : "Section B", from, to, CAMERA_FAR_M, false);
}

/* ---- what people write ---- */

static view *refuse(const char *spec, const char *what, GError **error)
{
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, "view '%s': %s", spec, what);
	return NULL;
}

static bool read_numbers(const char *text, guint count, double *ret)
{
	g_auto(GStrv) words = g_strsplit(text, ",", -1);
	if (g_strv_length(words) != count)
		return false;
	for (guint n = 0; n < count; n++) {
		char *end;
		ret[n] = g_ascii_strtod(words[n], &end);
		if (end == words[n] || *end || g_ascii_isspace(*words[n]) ||
			!(fabs(ret[n]) <= VIEW_REACH_M))
			return false;
	}
	return true;
}

static view *read_plan(const struct view_sources *s, const char *spec, GError **error)
{
	double height;
	if (!read_numbers(spec + strlen(plan_at), 1, &height) || fabs(height) > HEIGHT_MAX_M)
		return refuse(spec,
			"what follows plan: is how many metres above the ground it is cut, as in "
			"plan:1.2",
			error);
	return plan_cut_at(s, spec, height);
}

static view *read_section(const struct view_sources *s, const char *spec, GError **error)
{
	static const char form[] =
		"a section is two places in metres and how deep it is, if not to the end: "
		"section:X1,Y1:X2,Y2 or section:X1,Y1:X2,Y2:DEPTH";
	double from[2], to[2], depth = CAMERA_FAR_M;
	g_auto(GStrv) words = g_strsplit(spec + strlen(section), ":", -1);
	guint count = g_strv_length(words);
	if (count < 2 || count > 3 || !read_numbers(words[0], 2, from) ||
		!read_numbers(words[1], 2, to) ||
		(count == 3 && !read_numbers(words[2], 1, &depth)))
		return refuse(spec, form, error);
	if (!(hypot(to[0] - from[0], to[1] - from[1]) >= 0.01))
		return refuse(spec, "both places of the section are the same", error);
	if (!(depth >= 0.01 && depth <= CAMERA_FAR_M))
		return refuse(spec, "a section is 0.01 to 10000 m deep", error);
	return section_along(s, spec, "Section", from, to, depth, true);
}

static const struct side *side_of(const char *spec)
{
	for (size_t n = 0; g_str_has_prefix(spec, elevation) && n < G_N_ELEMENTS(sides); n++)
		if (strcmp(spec + strlen(elevation), sides[n].name) == 0)
			return &sides[n];
	return NULL;
}

static bool is_section_through(const char *spec)
{
	return strcmp(spec, "section-a") == 0 || strcmp(spec, "section-b") == 0;
}

bool view_parallel_is(const char *spec)
{
	return strcmp(spec, "plan") == 0 || g_str_has_prefix(spec, plan_at) || side_of(spec) ||
	       is_section_through(spec) || g_str_has_prefix(spec, section);
}

view *view_parallel_find(const struct view_sources *s, const char *spec, GError **error)
{
	const struct side *side = side_of(spec);
	if (side)
		return elevation_from(s, spec, side);
	if (is_section_through(spec))
		return section_through(s, spec);
	if (g_str_has_prefix(spec, section))
		return read_section(s, spec, error);
	return g_str_has_prefix(spec, plan_at) ? read_plan(s, spec, error) : plan(s);
}

void view_parallel_add_names(GPtrArray *names)
{
	char text[G_ASCII_DTOSTR_BUF_SIZE];
	g_ptr_array_add(names, g_strdup("plan"));
	g_ascii_dtostr(text, sizeof text, VIEW_PLAN_CUT_M);
	g_ptr_array_add(names, g_strconcat(plan_at, text, NULL));
	for (size_t n = 0; n < G_N_ELEMENTS(sides); n++)
		g_ptr_array_add(names, g_strconcat(elevation, sides[n].name, NULL));
	g_ptr_array_add(names, g_strdup("section-a"));
	g_ptr_array_add(names, g_strdup("section-b"));
}
