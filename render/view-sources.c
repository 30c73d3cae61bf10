#include "render/view-sources.h"
#include "process/pose-json.h"
#include "process/scan-data.h"
#include "process/scan-geometry.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

/* ---- stations ---- */

static bool stations_fail(const model *m, GError **error)
{
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: does not tell where its scans stand", product_path(model_file(m)));
	return false;
}

static bool read_pose(JsonNode *node, struct pose *ret)
{
	double number[12];
	if (!json_read_numbers(node, 12, number))
		return false;
	memcpy(ret->rotation, number, sizeof ret->rotation);
	memcpy(ret->translation_m, number + 9, sizeof ret->translation_m);
	return pose_is_rigid(ret, 1e-4);
}

/* An entry of the manifest's "made_from" (model-inputs.h). */
static bool read_station(JsonNode *node, struct view_station *ret)
{
	if (!JSON_NODE_HOLDS_OBJECT(node))
		return false;
	JsonObject *o = json_node_get_object(node);
	JsonNode *scan = json_object_get_member(o, "scan");
	int64_t number = scan && JSON_NODE_HOLDS_VALUE(scan) ? json_node_get_int(scan) : 0;
	ret->number = (uint32_t)number;
	return number >= 1 && number <= SITE_SCANS_MAX &&
	       read_pose(json_object_get_member(o, "pose"), &ret->pose);
}

/* A site may have been copied without its scans, or what was made of them; then nothing tells of clouds. */
static bool find_scanner(const site *s, uint32_t number, bool *ret_stood, GError **error)
{
	g_autoptr(GError) missing = NULL;
	g_autoptr(scan_data) d = scan_data_peek(s, number, &missing);
	*ret_stood = !d || d->kind != SCAN_CLOUD;
	if (!*ret_stood) {
		g_autoptr(scan_geometry) g = scan_geometry_open(s, number, NULL);
		*ret_stood = g && g->rings;
	}
	if (d || g_error_matches(missing, G_IO_ERROR, G_IO_ERROR_NOT_FOUND))
		return true;
	g_propagate_error(error, g_steal_pointer(&missing));
	return false;
}

static int compare_stations(gconstpointer a, gconstpointer b)
{
	const struct view_station *p = a, *q = b;
	return (p->number > q->number) - (p->number < q->number);
}

GArray *view_stations(const site *s, const model *m, GError **error)
{
	JsonNode *node = json_object_get_member(product_manifest(model_file(m)), "made_from");
	if (!node || !JSON_NODE_HOLDS_ARRAY(node))
		return stations_fail(m, error), NULL;
	JsonArray *scans = json_node_get_array(node);
	g_autoptr(GArray) stations = g_array_new(FALSE, FALSE, sizeof(struct view_station));
	for (guint i = 0; i < json_array_get_length(scans); i++) {
		struct view_station station;
		bool stood;
		if (!read_station(json_array_get_element(scans, i), &station))
			return stations_fail(m, error), NULL;
		if (!find_scanner(s, station.number, &stood, error))
			return NULL;
		if (stood)
			g_array_append_val(stations, station);
	}
	g_array_sort(stations, compare_stations);
	return g_steal_pointer(&stations);
}

/* ---- the bulk ---- */

static double points_below(const struct view_sources *s, int axis, double at_m)
{
	double sum = 0;
	for (uint64_t i = 0; i < s->boxes->count; i++) {
		const struct model_chunk *c = &s->boxes->box[i];
		double low = c->centre_m[axis] - c->half_size_m[axis],
		       size = 2 * fmax(c->half_size_m[axis], 1e-6);
		sum += c->points * CLAMP((at_m - low) / size, 0, 1);
	}
	return sum;
}

static double percentile(
	const struct view_sources *s, int axis, double share, double low_m, double high_m)
{
	double wanted = share * points_below(s, axis, INFINITY);
	for (int i = 0; i < 50; i++) {
		double middle = (low_m + high_m) / 2;
		*(points_below(s, axis, middle) < wanted ? &low_m : &high_m) = middle;
	}
	return (low_m + high_m) / 2;
}

struct view_box view_bulk(const struct view_sources *s)
{
	struct view_box bulk;
	for (int k = 0; k < 3; k++) {
		double low = INFINITY, high = -INFINITY;
		for (uint64_t i = 0; i < s->boxes->count; i++) {
			const struct model_chunk *c = &s->boxes->box[i];
			low = fmin(low, c->centre_m[k] - c->half_size_m[k]);
			high = fmax(high, c->centre_m[k] + c->half_size_m[k]);
		}
		bulk.low_m[k] = percentile(s, k, 0.02, low, high);
		bulk.high_m[k] = percentile(s, k, 0.98, low, high);
	}
	return bulk;
}

/* ---- framing ---- */

/* An eye that is d behind a middle and o aside along an axis has a point p (from the middle) inside
 * both edges when
 *
 *     axis.p - slope * forward.p <= slope * d + o   and   -axis.p - slope * forward.p <= slope * d - o,
 *
 * so the greatest left sides tell d and o. How far a chunk reaches along the vector on the left: */
static double reach(const struct model_chunk *c, const double middle_m[3], const double v[3])
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (c->centre_m[k] - middle_m[k]) * v[k] + c->half_size_m[k] * fabs(v[k]);
	return sum;
}

static double points_beyond(const struct view_sources *s, const double *reach_m, double at_m)
{
	double sum = 0;
	for (uint64_t i = 0; i < s->boxes->count; i++)
		sum += reach_m[i] > at_m ? s->boxes->box[i].points : 0;
	return sum;
}

/* How far all but a part of the points reach at most. */
static double reach_of_all_but(
	const struct view_sources *s, const double *reach_m, double low, double high, double part)
{
	double allowed = part * points_beyond(s, reach_m, -INFINITY);
	for (int i = 0; i < 30; i++) {
		double middle = (low + high) / 2;
		*(points_beyond(s, reach_m, middle) > allowed ? &low : &high) = middle;
	}
	return high;
}

/* What was seen far away through windows and gates must not make the picture small; but of something small the top, which may be few
 * points, belongs to it. */
#define FAR_PART   0.01
#define STRAY_PART 0.0005
#define NOT_FAR    1.3

static double reach_of_most(
	const struct view_sources *s, const double middle_m[3], const double v[3])
{
	g_autofree double *reach_m = g_new(double, s->boxes->count);
	double low = INFINITY, high = -INFINITY;
	for (uint64_t i = 0; i < s->boxes->count; i++) {
		reach_m[i] = reach(&s->boxes->box[i], middle_m, v);
		low = fmin(low, reach_m[i]);
		high = fmax(high, reach_m[i]);
	}
	double most = reach_of_all_but(s, reach_m, low, high, FAR_PART),
	       nearly_all = reach_of_all_but(s, reach_m, low, high, STRAY_PART);
	return s->boxes->facing && nearly_all < NOT_FAR * most ? nearly_all : most;
}

/* Both edges along an axis. */
static void fit(const struct view_sources *s, const double middle_m[3], const double axis[3],
	const double forward[3], double slope, double *ret_depth_m, double *ret_aside_m)
{
	double plus[3], minus[3];
	for (int k = 0; k < 3; k++) {
		plus[k] = axis[k] - slope * forward[k];
		minus[k] = -axis[k] - slope * forward[k];
	}
	double most = reach_of_most(s, middle_m, plus), least = reach_of_most(s, middle_m, minus);
	*ret_depth_m = (most + least) / 2 / slope;
	*ret_aside_m = (most - least) / 2;
}

double view_frame(const struct view_sources *s, const double middle_m[3], struct camera *c)
{
	const double fill = 0.92 / 2 / c->focal_px;
	double across_m, down_m, depth_m, other_m;
	fit(s, middle_m, c->right, c->forward, fill * c->width, &depth_m, &across_m);
	fit(s, middle_m, c->down, c->forward, fill * c->height, &other_m, &down_m);
	depth_m = fmax(1, fmax(depth_m, other_m));
	for (int k = 0; k < 3; k++)
		c->eye_m[k] = middle_m[k] - depth_m * c->forward[k] + across_m * c->right[k] +
			      down_m * c->down[k];
	return depth_m;
}

/* ---- looking ---- */

/* A chunk before a camera: the middle of its box, and how far that goes to the sides and in depth. */
struct seen {
	double px[2], half_px[2];
	double depth_m, half_m;
};

static double half_along(const struct model_chunk *c, const double axis[3])
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += fabs(axis[k]) * c->half_size_m[k];
	return sum;
}

static bool see(const struct camera *c, const struct model_chunk *chunk, struct seen *ret)
{
	if (!camera_project(c, chunk->centre_m, ret->px, &ret->depth_m))
		return false;
	ret->half_px[0] = c->focal_px * half_along(chunk, c->right) / ret->depth_m;
	ret->half_px[1] = c->focal_px * half_along(chunk, c->down) / ret->depth_m;
	ret->half_m = half_along(chunk, c->forward);
	return true;
}

static int pixel(double at, uint32_t side)
{
	return (int)CLAMP(floor(at), -1, (double)side);
}

static void draw(const struct camera *c, const struct seen *s, float *depths_m)
{
	int left = MAX(0, pixel(s->px[0] - s->half_px[0], c->width)),
	    right = MIN((int)c->width - 1, pixel(s->px[0] + s->half_px[0], c->width)),
	    top = MAX(0, pixel(s->px[1] - s->half_px[1], c->height)),
	    bottom = MIN((int)c->height - 1, pixel(s->px[1] + s->half_px[1], c->height));
	float behind = (float)(s->depth_m + s->half_m);
	for (int y = top; y <= bottom; y++)
		for (int x = left; x <= right; x++) {
			float *at = &depths_m[(size_t)y * c->width + (size_t)x];
			*at = fminf(*at, behind);
		}
}

static float *draw_depths(const struct view_sources *s, const struct camera *c)
{
	size_t pixels = (size_t)c->width * c->height;
	float *depths_m = g_new(float, pixels);
	for (size_t i = 0; i < pixels; i++)
		depths_m[i] = INFINITY;
	for (uint64_t i = 0; i < s->boxes->count; i++) {
		struct seen seen;
		if (s->boxes->box[i].points >= s->boxes->solid_points &&
			see(c, &s->boxes->box[i], &seen))
			draw(c, &seen, depths_m);
	}
	return depths_m;
}

static bool is_hidden(const struct camera *c, const struct seen *s, const float *depths_m)
{
	if (!(s->px[0] >= 0 && s->px[0] < c->width && s->px[1] >= 0 && s->px[1] < c->height))
		return true;
	return s->depth_m - s->half_m > depths_m[(size_t)s->px[1] * c->width + (size_t)s->px[0]];
}

static double elevation_rad(const struct camera *c, const double place_m[3])
{
	return atan2(place_m[2] - c->eye_m[2],
		hypot(place_m[0] - c->eye_m[0], place_m[1] - c->eye_m[1]));
}

/* How much of it faces the camera: 2 before a wall and 0 behind it, 1 of leaves, which face any way. */
static double facing(const struct view_sources *s, uint64_t i, const struct camera *c)
{
	double along = 0, far2 = 0;
	if (!s->boxes->facing)
		return 1;
	for (int k = 0; k < 3; k++) {
		double to = c->eye_m[k] - s->boxes->box[i].centre_m[k];
		along += to * (double)s->boxes->facing[i][k];
		far2 += to * to;
	}
	return far2 > 0 ? 1 + along / sqrt(far2) : 1;
}

/* With fewer pixels a line is as good as empty. */
#define LINE_LEAST 3

/* Lines of a picture, one pixel beside the other: how many there are, how long, and how many pixels from one to the next of each. */
struct picture_lines {
	uint32_t count, length;
	size_t to_line, to_pixel;
};

static bool is_line_empty(const float *depths_m, const struct picture_lines *l, uint32_t line)
{
	int filled = 0;
	for (uint32_t n = 0; n < l->length; n++)
		filled += isfinite(depths_m[line * l->to_line + n * l->to_pixel]);
	return filled < LINE_LEAST;
}

/* Between which angles from the axis, across the lines, anything stands; false: nothing does. */
static bool find_extent(const float *depths_m, const struct picture_lines *l, double focal_px,
	double *ret_least_rad, double *ret_most_rad)
{
	uint32_t first = 0, end = l->count;
	while (first < end && is_line_empty(depths_m, l, first))
		first++;
	while (end > first && is_line_empty(depths_m, l, end - 1))
		end--;
	*ret_least_rad = atan((first - l->count / 2.0) / focal_px);
	*ret_most_rad = atan((end - l->count / 2.0) / focal_px);
	return first < end;
}

static void find_extents(const struct camera *c, const float *depths_m, struct view_sight *ret)
{
	const struct picture_lines columns = { c->width, c->height, 1, c->width },
				   rows = { c->height, c->width, c->width, 1 };
	double left, right, top, bottom;
	if (!find_extent(depths_m, &columns, c->focal_px, &left, &right) ||
		!find_extent(depths_m, &rows, c->focal_px, &top, &bottom))
		return;
	ret->aside_rad = (left + right) / 2;
	ret->high_rad = -top; /* of a level camera */
	ret->low_rad = -bottom;
}

struct view_sight view_look(
	const struct view_sources *s, const struct camera *c, double near_m, double far_m)
{
	struct view_sight sight = { 0 };
	g_autofree float *depths_m = draw_depths(s, c);
	find_extents(c, depths_m, &sight);
	for (uint64_t i = 0; i < s->boxes->count; i++) {
		const struct model_chunk *chunk = &s->boxes->box[i];
		struct seen seen;
		if (!see(c, chunk, &seen) || seen.depth_m < near_m || seen.depth_m > far_m ||
			is_hidden(c, &seen, depths_m))
			continue;
		double aside = 2 * seen.px[0] / c->width - 1;
		double weight = chunk->points * (1 - aside * aside / 2) * facing(s, i, c);
		sight.points += weight;
		sight.distance_m += weight * seen.depth_m;
		sight.elevation_rad += weight * elevation_rad(c, chunk->centre_m);
	}
	if (sight.points > 0) {
		sight.distance_m /= sight.points;
		sight.elevation_rad /= sight.points;
	}
	return sight;
}

/* ---- ground ---- */

struct level {
	double height_m, points;
};

static int compare_levels(gconstpointer a, gconstpointer b)
{
	const struct level *p = a, *q = b;
	return (p->height_m > q->height_m) - (p->height_m < q->height_m);
}

static bool is_ground_below(const struct model_chunk *c, const double place_m[3])
{
	const double reach_m = 3, clearance_m = 0.4, flat_m = 0.3;
	double out[2];
	for (int k = 0; k < 2; k++)
		out[k] = fmax(0, fabs(place_m[k] - c->centre_m[k]) - c->half_size_m[k]);
	return hypot(out[0], out[1]) <= reach_m && c->half_size_m[2] <= flat_m &&
	       c->centre_m[2] + c->half_size_m[2] <= place_m[2] - clearance_m;
}

double view_ground_m(const struct view_sources *s, const double place_m[3])
{
	g_autoptr(GArray) levels = g_array_new(FALSE, FALSE, sizeof(struct level));
	double half = 0;
	for (uint64_t i = 0; i < s->boxes->count; i++) {
		const struct model_chunk *c = &s->boxes->box[i];
		struct level level = { c->centre_m[2], c->points };
		if (!is_ground_below(c, place_m))
			continue;
		g_array_append_val(levels, level);
		half += level.points / 2;
	}
	g_array_sort(levels, compare_levels);
	for (guint i = 0; i < levels->len; i++)
		if ((half -= g_array_index(levels, struct level, i).points) <= 0)
			return g_array_index(levels, struct level, i).height_m;
	return NAN;
}
