/* What of a scan must be known before its points can be given. */
#include "acquire/panorama.h"
#include "process/import-e57.h"
#include <math.h>
#include <string.h>

/* Names as the standard has them. */
static const struct {
	enum e57_role role;
	const char *name;
	bool is_extension;
} names[] = { { E57_X, "cartesianX", false }, { E57_Y, "cartesianY", false },
	{ E57_Z, "cartesianZ", false }, { E57_RANGE, "sphericalRange", false },
	{ E57_AZIMUTH, "sphericalAzimuth", false }, { E57_ELEVATION, "sphericalElevation", false },
	{ E57_INTENSITY, "intensity", false }, { E57_NO_INTENSITY, "isIntensityInvalid", false },
	{ E57_RED, "colorRed", false }, { E57_GREEN, "colorGreen", false },
	{ E57_BLUE, "colorBlue", false }, { E57_NO_COLOUR, "isColorInvalid", false },
	{ E57_ROW, "rowIndex", false }, { E57_COLUMN, "columnIndex", false },
	{ E57_RETURN, "returnIndex", false }, { E57_CLASS, "classification", true } };

/* What is wrong a thousand times need not be said so often. */
#define NOTES_MAX 1000

static int find_field(const struct e57 *r, const char *name, bool is_extension_too)
{
	for (guint i = 0; i < r->from->fields->len; i++) {
		const struct e57_field *f = &g_array_index(r->from->fields, struct e57_field, i);
		if (!strcmp(f->name, name) && f->kind != E57_STRING &&
			(!f->is_extension || is_extension_too))
			return (int)i;
	}
	return -1;
}

bool e57_find_fields(struct e57 *r)
{
	int *f = r->field;
	f[E57_STATE] = -1;
	for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
		f[names[i].role] = find_field(r, names[i].name, names[i].is_extension);
	bool cartesian = f[E57_X] >= 0 && f[E57_Y] >= 0 && f[E57_Z] >= 0;
	r->is_spherical =
		!cartesian && f[E57_RANGE] >= 0 && f[E57_AZIMUTH] >= 0 && f[E57_ELEVATION] >= 0;
	f[E57_STATE] = find_field(
		r, r->is_spherical ? "sphericalInvalidState" : "cartesianInvalidState", false);
	for (int i = E57_X; i <= E57_ELEVATION; i++)
		if ((i >= E57_RANGE) != r->is_spherical)
			f[i] = -1;
	if (f[E57_RED] < 0 || f[E57_GREEN] < 0 || f[E57_BLUE] < 0)
		f[E57_RED] = f[E57_GREEN] = f[E57_BLUE] = -1;
	return cartesian || r->is_spherical;
}

bool e57_open_vector(struct e57 *r, const bool wanted[E57_ROLES], GError **error)
{
	g_autofree bool *of_field = g_new0(bool, r->from->fields->len + 1);
	for (int i = 0; i < E57_ROLES; i++)
		if (r->field[i] >= 0 && wanted[i])
			of_field[r->field[i]] = true;
	g_clear_pointer(&r->vector, e57_vector_free);
	r->vector = e57_vector_open(r->pages, r->from, of_field, error);
	for (int i = 0; i < E57_ROLES && r->vector; i++)
		r->number[i] = r->field[i] >= 0 && wanted[i]
				       ? e57_vector_numbers(r->vector, (unsigned)r->field[i])
				       : NULL;
	return r->vector;
}

bool e57_next_block(struct e57 *r, size_t max, size_t *ret_count, GError **error)
{
	return e57_vector_read(r->vector, max, ret_count, error);
}

void e57_add_note(struct e57 *r, const char *format, ...)
{
	va_list args;
	if (r->notes->len > NOTES_MAX)
		return;
	va_start(args, format);
	if (r->notes->len)
		g_string_append(r->notes, "; ");
	g_string_append_vprintf(r->notes, format, args);
	va_end(args);
}

/* ---- ranges ---- */

static void meet(struct e57_span *s, double value)
{
	if (!isfinite(value))
		return;
	if (value < s->least)
		s->least = value;
	if (value > s->most)
		s->most = value;
}

/* Numbers of a block, but where one of the others is not 0. */
static void meet_numbers(
	struct e57 *r, enum e57_role role, const double *state, const double *none, size_t count)
{
	const double *number = r->number[role];
	for (size_t i = 0; number && i < count; i++)
		if ((!state || state[i] == 0) && (!none || none[i] == 0))
			meet(&r->met[role], number[i]);
}

static void meet_block(struct e57 *r, size_t count)
{
	const double *state = r->number[E57_STATE];
	meet_numbers(r, E57_ROW, NULL, NULL, count);
	meet_numbers(r, E57_COLUMN, NULL, NULL, count);
	meet_numbers(r, E57_RETURN, NULL, NULL, count);
	meet_numbers(r, E57_INTENSITY, state, r->number[E57_NO_INTENSITY], count);
	for (int k = E57_RED; k <= E57_BLUE; k++)
		meet_numbers(r, (enum e57_role)k, state, r->number[E57_NO_COLOUR], count);
}

static bool find_ranges(struct e57 *r, GError **error)
{
	bool wanted[E57_ROLES];
	size_t count = 1;
	for (int i = 0; i < E57_ROLES; i++) {
		wanted[i] = i >= E57_STATE || i == E57_X || i == E57_RANGE;
		r->met[i] = (struct e57_span){ INFINITY, -INFINITY };
	}
	if (!e57_open_vector(r, wanted, error))
		return false;
	while (count) {
		if (!e57_next_block(r, E57_BLOCK_RECORDS, &count, error))
			return false;
		meet_block(r, count);
	}
	return true;
}

/* ---- what becomes dark and bright ---- */

/* As the file says, where all numbers keep to it; else as the numbers themselves tell. */
static struct e57_span span_of(
	const struct e57 *r, enum e57_role role, const struct e57_limits *limits, bool *ret_beyond)
{
	struct e57_span met = r->met[role], told = { 0, 1 };
	const struct e57_field *f =
		&g_array_index(r->from->fields, struct e57_field, (guint)r->field[role]);
	*ret_beyond = false;
	if (met.least > met.most)
		return told;
	if (limits->given)
		told = (struct e57_span){ limits->least, limits->most };
	else if (f->most > f->least && f->most - f->least <= 65535 && role == E57_INTENSITY)
		told = (struct e57_span){ f->least, f->most };
	else
		told.most = met.most <= 1 && f->kind != E57_INTEGER ? 1
			    : met.most <= 255                       ? 255
								    : 65535;
	double slack = 1e-6 * (told.most - told.least); /* singles are rounded */
	if (met.least >= told.least - slack && met.most <= told.most + slack)
		return told;
	*ret_beyond = true;
	return (struct e57_span){ fmin(met.least, 0), fmax(met.most, met.least + 1e-9) };
}

static void settle_spans(struct e57 *r)
{
	bool beyond = false, any = false;
	if (r->field[E57_INTENSITY] >= 0)
		r->intensity = span_of(r, E57_INTENSITY, &r->from->intensity, &beyond);
	if (beyond)
		e57_add_note(r, "intensities of %g to %g were scaled from %g to %g",
			r->met[E57_INTENSITY].least, r->met[E57_INTENSITY].most, r->intensity.least,
			r->intensity.most);
	for (int k = 0; k < 3 && r->field[E57_RED] >= 0; k++) {
		r->colour[k] = span_of(r, E57_RED + k, &r->from->colour[k], &beyond);
		any |= beyond;
	}
	if (any)
		e57_add_note(r, "colours go beyond the limits that the file tells");
}

/* ---- the grid ---- */

bool e57_cell(const struct e57 *r, size_t i, uint64_t *ret)
{
	double row = r->number[E57_ROW][i] - r->met[E57_ROW].least,
	       column = r->number[E57_COLUMN][i] - r->met[E57_COLUMN].least;
	if (!(row >= 0 && row < r->scan.rows && column >= 0 && column < r->scan.columns))
		return false;
	*ret = (uint64_t)row * r->scan.columns + (uint64_t)column;
	return true;
}

static uint32_t extent(const struct e57_span *s, uint32_t most)
{
	double cells = s->most - s->least + 1;
	return cells >= 2 && cells <= most ? (uint32_t)cells : 0;
}

/* Of the first echoes, how many have a cell that another one has. */
static bool count_shared(struct e57 *r, uint64_t *ret_first, uint64_t *ret_shared, GError **error)
{
	bool wanted[E57_ROLES] = {
		[E57_ROW] = true, [E57_COLUMN] = true, [E57_RETURN] = true, [E57_STATE] = true
	};
	size_t count = 1;
	*ret_first = *ret_shared = 0;
	if (!e57_open_vector(r, wanted, error))
		return false;
	while (count) {
		if (!e57_next_block(r, E57_BLOCK_RECORDS, &count, error))
			return false;
		for (size_t i = 0; i < count; i++) {
			uint64_t cell;
			if (e57_is_later_echo(r, i) || e57_number(r, E57_STATE, i, 0) != 0 ||
				!e57_cell(r, i, &cell))
				continue;
			(*ret_first)++;
			*ret_shared += e57_set_bit(r->has_point, cell);
		}
	}
	return true;
}

/* Rows and columns at the edge may have no points. What is told counts as long as it is not much more than what is there. */
static void widen(struct e57_span *met, const struct e57_limits *told)
{
	double cells = met->most - met->least + 1;
	if (!told->given || told->least > met->least || told->most < met->most ||
		told->most - told->least + 1 > 4 * cells)
		return;
	met->least = floor(told->least);
	met->most = floor(told->most);
}

static bool find_grid(struct e57 *r, GError **error)
{
	uint64_t first, shared;
	struct import_scan *s = &r->scan;
	if (r->field[E57_ROW] < 0 || r->field[E57_COLUMN] < 0)
		return true;
	widen(&r->met[E57_ROW], &r->from->rows);
	widen(&r->met[E57_COLUMN], &r->from->columns);
	s->columns = extent(&r->met[E57_COLUMN], PANORAMA_COLUMNS_MAX);
	s->rows = extent(&r->met[E57_ROW], PANORAMA_ROWS_MAX);
	uint64_t cells = (uint64_t)s->columns * s->rows;
	if (!cells || cells > PANORAMA_CELLS_MAX || cells / 1000 > s->count) {
		s->columns = s->rows = 0;
		s->no_grid = "its rows and columns make none";
		return true;
	}
	r->has_point = g_malloc0(cells / 8 + 1);
	if (!count_shared(r, &first, &shared, error))
		return false;
	r->filled = g_malloc0(cells / 8 + 1);
	s->order = IMPORT_SCATTERED;
	if (shared <= first / 100)
		return true;
	s->columns = s->rows = 0;
	s->no_grid = "points share rows and columns";
	return true;
}

bool e57_look_through(struct e57 *r, GError **error)
{
	if (!find_ranges(r, error))
		return false;
	settle_spans(r);
	return find_grid(r, error);
}
