/* E57 (e57.h) of any maker. Each scan is one: with rows and columns a grid, else a cloud. */
#include "process/import-e57.h"
#include "acquire/panorama.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define COORDINATE_MAX_M 1e9
/* No scanner reaches so far: these are coordinates of a map. */
#define SCANNER_REACH_M 10000.0

/* ---- points ---- */

/* 0 to 1; what is no number, and what is of no range, is 0. */
static double share_of(const struct e57_span *s, double value)
{
	double share = (value - s->least) / (s->most - s->least);
	return isfinite(share) ? CLAMP(share, 0, 1) : 0;
}

static uint16_t intensity_of(const struct e57 *r, size_t i)
{
	if (r->field[E57_INTENSITY] < 0 || e57_number(r, E57_NO_INTENSITY, i, 0) != 0)
		return 0;
	return (uint16_t)(share_of(&r->intensity, r->number[E57_INTENSITY][i]) * 65535 + 0.5);
}

static void colour_of(const struct e57 *r, size_t i, uint8_t rgb[3])
{
	if (r->field[E57_RED] < 0 || e57_number(r, E57_NO_COLOUR, i, 0) != 0)
		return;
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(share_of(&r->colour[k], r->number[E57_RED + k][i]) * 255 + 0.5);
}

static void locate(const struct e57 *r, size_t i, double ret[3])
{
	if (!r->is_spherical) {
		for (int k = 0; k < 3; k++)
			ret[k] = r->number[E57_X + k][i];
		return;
	}
	double range = r->number[E57_RANGE][i], azimuth = r->number[E57_AZIMUTH][i],
	       elevation = r->number[E57_ELEVATION][i];
	ret[0] = range * cos(elevation) * cos(azimuth);
	ret[1] = range * cos(elevation) * sin(azimuth);
	ret[2] = range * sin(elevation);
}

enum found { FOUND_POINT, FOUND_NO_RETURN, FOUND_NOTHING };

/* No scanner sees itself; and many writers say so that there is nothing, but for those that have a field to say it. */
static bool is_nothing_at_zero(const struct e57 *r)
{
	return r->scan.columns > 0 || r->field[E57_STATE] < 0;
}

static enum found find(const struct e57 *r, size_t i, double ret_at[3])
{
	double state = e57_number(r, E57_STATE, i, 0), *at = ret_at;
	if (state != 0)
		return state == 1 ? FOUND_NO_RETURN : FOUND_NOTHING;
	locate(r, i, at);
	bool zero = at[0] == 0 && at[1] == 0 && at[2] == 0;
	return isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]) &&
			       !(zero && is_nothing_at_zero(r))
		       ? FOUND_POINT
		       : FOUND_NOTHING;
}

static enum found take(const struct e57 *r, size_t i, struct point_record *p)
{
	double at[3];
	enum found found = find(r, i, at);
	*p = (struct point_record){ .cell = CELL_NO_RETURN, .return_number = 1 };
	if (found != FOUND_POINT)
		return found;
	p->x_m = at[0];
	p->y_m = at[1];
	p->z_m = at[2];
	p->cell = CELL_MEASURED;
	p->intensity = intensity_of(r, i);
	colour_of(r, i, p->rgb);
	double class = e57_number(r, E57_CLASS, i, 0), echo = e57_number(r, E57_RETURN, i, 0);
	p->classification = class >= 0 && class <= 255 ? (uint8_t) class : 0;
	p->return_number = echo >= 0 && echo < 255 ? (uint8_t)(echo + 1) : 1;
	return FOUND_POINT;
}

/* The first point tells whether these are the scanner's own coordinates. */
static bool place(struct e57 *r, struct point_record *p, bool *is_first, GError **error)
{
	double at[3] = { p->x_m, p->y_m, p->z_m }, *o = r->scan.origin_m;
	for (int k = 0; k < 3; k++)
		if (!(fabs(at[k]) <= COORDINATE_MAX_M))
			return import_refuse(error, r->file, G_IO_ERROR_INVALID_DATA,
				"scan %u: %g m is too far to be a point", r->next, at[k]);
	double range_m = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
	for (int k = 0; k < 3 && *is_first && range_m > SCANNER_REACH_M; k++)
		o[k] = rint(at[k]);
	*is_first = false;
	p->x_m -= o[0];
	p->y_m -= o[1];
	p->z_m -= o[2];
	return true;
}

/* Whether the record goes into the grid, and where. */
static bool find_room(struct e57 *r, size_t i, enum found found, uint64_t *ret)
{
	if (!e57_cell(r, i, ret)) {
		r->scan.left_out += found == FOUND_POINT;
		return false;
	}
	if (found == FOUND_NO_RETURN)
		return !e57_bit(r->has_point, *ret) && !e57_set_bit(r->filled, *ret);
	/* A later echo may come before the first one. */
	bool taken = (e57_is_later_echo(r, i) && e57_bit(r->has_point, *ret)) ||
		     e57_set_bit(r->filled, *ret);
	r->no_room += taken;
	return !taken;
}

static bool wants(struct e57 *r, size_t i, enum found found, uint64_t *ret_cell)
{
	if (found == FOUND_NOTHING && (r->scan.columns == 0 || e57_number(r, E57_STATE, i, 0) == 0))
		r->scan.left_out++;
	if (found == FOUND_NOTHING)
		return false;
	return r->scan.columns ? find_room(r, i, found, ret_cell) : found == FOUND_POINT;
}

static bool take_block(
	struct e57 *r, size_t count, struct point_record *into, size_t *ret_kept, GError **error)
{
	for (size_t i = 0; i < count; i++) {
		struct point_record p;
		enum found found = take(r, i, &p);
		uint64_t cell = 0;
		if (!wants(r, i, found, &cell))
			continue;
		bool is_first = r->given == 0;
		if (found == FOUND_POINT) {
			if (!place(r, &p, &is_first, error))
				return false;
			r->given++;
		}
		r->cells[*ret_kept] = cell;
		into[(*ret_kept)++] = p;
	}
	return true;
}

static bool end_scan(struct e57 *r, GError **error)
{
	if (r->given == 0)
		return import_refuse(error, r->file, G_IO_ERROR_INVALID_DATA,
			"scan %u has no points but such as it marks as none", r->next);
	if (r->no_room)
		e57_add_note(r,
			"%" G_GUINT64_FORMAT
			" points were left out: others have their rows and columns",
			r->no_room);
	r->scan.left_out += r->no_room;
	r->no_room = 0;
	/* Coordinates of a map are of no use to a grid seen from its zero. */
	if (r->scan.columns && (r->scan.origin_m[0] != 0 || r->scan.origin_m[1] != 0 ||
				       r->scan.origin_m[2] != 0)) {
		r->scan.columns = r->scan.rows = 0;
		r->scan.no_grid = "map coordinates";
	}
	r->scan.note = r->notes->len ? r->notes->str : NULL;
	return true;
}

static bool e57_read(import_reader *reader, struct point_record *into, size_t max,
	size_t *ret_count, GError **error)
{
	struct e57 *r = (struct e57 *)reader;
	size_t count = 1;
	*ret_count = 0;
	while (count && *ret_count == 0)
		if (!e57_next_block(r, max, &count, error) ||
			!take_block(r, count, into, ret_count, error))
			return false;
	return count || end_scan(r, error);
}

static const uint64_t *e57_cells(const import_reader *reader)
{
	return ((const struct e57 *)reader)->cells;
}

/* ---- scans ---- */

static bool is_identity(const struct pose *p)
{
	struct pose none = POSE_IDENTITY;
	return memcmp(p, &none, sizeof none) == 0;
}

/* All together are not more than the file: else the same points could stand for thousands of scans. */
static bool add_section(struct e57 *r, GError **error)
{
	uint64_t bytes = e57_vector_bytes(r->vector);
	if (bytes > e57_pages_size(r->pages) - r->sections)
		return e57_pages_refuse(error, r->pages, r->from->section,
			"the points of scan %u stand among those of others", r->next);
	r->sections += bytes;
	return true;
}

static bool begin_scan(struct e57 *r, GError **error)
{
	bool all[E57_ROLES];
	for (int i = 0; i < E57_ROLES; i++)
		all[i] = true;
	r->scan = (struct import_scan){ .count = r->from->count,
		.has_pose = r->from->has_pose && !is_identity(&r->from->pose),
		.pose = r->from->pose };
	r->given = r->no_room = 0;
	g_clear_pointer(&r->has_point, g_free);
	g_clear_pointer(&r->filled, g_free);
	if (!r->from->has_pose)
		r->scan.pose = POSE_IDENTITY;
	return e57_open_vector(r, all, error) && add_section(r, error) &&
	       e57_look_through(r, error) && e57_open_vector(r, all, error);
}

static enum import_result e57_next_scan(
	import_reader *reader, const struct import_scan **ret, GError **error)
{
	struct e57 *r = (struct e57 *)reader;
	g_string_truncate(r->notes, 0);
	for (guint i = 0; r->next == 0 && i < r->tree->passed_over->len; i++)
		e57_add_note(r, "%s", (const char *)r->tree->passed_over->pdata[i]);
	while (r->next < r->tree->scans->len) {
		r->from = r->tree->scans->pdata[r->next++];
		if (!r->from->has_points || !e57_find_fields(r))
			continue;
		if (!begin_scan(r, error))
			return IMPORT_BAD;
		r->scans++;
		*ret = &r->scan;
		return IMPORT_SCAN;
	}
	if (r->scans)
		return IMPORT_END;
	const GPtrArray *why = r->tree->passed_over;
	import_refuse(error, r->file, G_IO_ERROR_INVALID_DATA, "has no scan with points%s%s",
		why->len ? ": " : "", why->len ? (const char *)why->pdata[0] : "");
	return IMPORT_BAD;
}

/* ---- the format ---- */

static bool e57_probe(const uint8_t *start, size_t length)
{
	return length >= 8 && memcmp(start, E57_SIGNATURE, 8) == 0;
}

static void e57_close(import_reader *reader)
{
	struct e57 *r = (struct e57 *)reader;
	if (!r)
		return;
	e57_vector_free(r->vector);
	e57_tree_free(r->tree);
	e57_pages_free(r->pages);
	g_string_free(r->notes, true);
	g_free(r->has_point);
	g_free(r->filled);
	g_free(r);
}

/* Whether one record at least is a point. What is damaged has some: it is told when it is read. All together no more than the file is
 * looked through. */
static bool has_any(struct e57 *r)
{
	bool wanted[E57_ROLES] = { [E57_X] = true,
		[E57_Y] = true,
		[E57_Z] = true,
		[E57_RANGE] = true,
		[E57_AZIMUTH] = true,
		[E57_ELEVATION] = true,
		[E57_STATE] = true };
	size_t count = 1;
	double at[3];
	if (!e57_open_vector(r, wanted, NULL) ||
		(r->looked += e57_vector_bytes(r->vector)) > e57_pages_size(r->pages))
		return true;
	while (count) {
		if (!e57_next_block(r, E57_BLOCK_RECORDS, &count, NULL))
			return true;
		for (size_t i = 0; i < count; i++)
			if (find(r, i, at) == FOUND_POINT)
				return true;
	}
	return false;
}

/* NULL, or why the scan has no points for us; caller frees. */
static char *why_none(struct e57 *r)
{
	if (!r->from->has_points)
		return g_strdup("has no points");
	if (r->from->codec)
		return g_strdup_printf("is packed by '%s', which is not read here", r->from->codec);
	if (!e57_find_fields(r))
		return g_strdup("has no coordinates");
	return has_any(r) ? NULL : g_strdup("has no points but such as it marks as none");
}

/* Pictures of a scan without points go with the first that has some. */
static void pass_over(struct e57 *r, guint scan, const char *why)
{
	struct e57_scan *s = r->tree->scans->pdata[scan];
	s->has_points = false;
	g_ptr_array_add(
		r->tree->passed_over, g_strdup_printf("scan %u of the file %s", scan + 1, why));
	for (guint i = 0; i < r->tree->images->len; i++) {
		struct e57_image *image = r->tree->images->pdata[i];
		if (image->scan == scan)
			image->scan = E57_NO_SCAN;
	}
}

static void pass_over_empty(struct e57 *r)
{
	for (guint i = 0; i < r->tree->scans->len; i++) {
		r->from = r->tree->scans->pdata[i];
		g_autofree char *why = why_none(r);
		if (why)
			pass_over(r, i, why);
	}
}

static import_reader *e57_open(
	import_source *file, const struct import_options *options, GError **error)
{
	(void)options;
	struct e57 *r = g_new0(struct e57, 1);
	r->file = file;
	r->notes = g_string_new(NULL);
	r->pages = e57_pages_new(file);
	r->tree = e57_tree_read(r->pages, file, error);
	if (r->tree) {
		pass_over_empty(r);
		return (import_reader *)r;
	}
	e57_close((import_reader *)r);
	return NULL;
}

static double e57_fraction(const import_reader *reader)
{
	const struct e57 *r = (const struct e57 *)reader;
	double scans = MAX(r->tree->scans->len, 1), before = r->next ? r->next - 1 : 0;
	return (before + (r->vector ? e57_vector_fraction(r->vector) : 0)) / scans;
}

const struct import_format import_e57 = { "E57", "e57", e57_probe, e57_open, e57_next_scan,
	e57_read, e57_fraction, e57_close, .cells = e57_cells, .save_pictures = e57_save_pictures };
