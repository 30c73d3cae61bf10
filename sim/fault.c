#include "sim/fault.h"
#include <gio/gio.h>
#include <math.h>

struct fault_row {
	const char *name;
	bool counted;              /* takes xCOUNT */
	bool parametric;           /* takes :PARAM */
	double standard, min, max; /* of the parameter */
};

static const struct fault_row rows[FAULT_KINDS] = {
	[FAULT_DROP] = { "drop", .counted = true },
	[FAULT_STALL] = { "stall", .parametric = true, .standard = NAN, .min = 0.001, .max = 3600 },
	[FAULT_GARBLE] = { "garble", .counted = true },
	[FAULT_SPLIT] = { "split", .parametric = true, .standard = 7, .min = 1, .max = 65536 },
	[FAULT_MERGE] = { "merge", .counted = true },
	[FAULT_JUMP] = { "jump", .parametric = true, .standard = 5, .min = 1, .max = 65535 },
	[FAULT_ERROR] = { "error" },
	[FAULT_UNPLUG] = { "unplug", .parametric = true, .standard = 2, .min = 0.001, .max = 3600 },
	[FAULT_POWER] = { "power" },
	[FAULT_STAGE] = { "stagefault" },
	[FAULT_SLIP] = { "slip", .parametric = true, .standard = 16, .min = -10000, .max = 10000 },
	[FAULT_BADFRAME] = { "badframe", .counted = true },
	[FAULT_FRAMELOSS] = { "frameloss", .parametric = true, .standard = 1, .min = 1,
		.max = 1000 },
	[FAULT_CAMERAGONE] = { "cameragone" },
	[FAULT_CODES] = { "codes", true, true, 100, 1, 100000 },
	[FAULT_EPSTALL] = { "epstall" },
	[FAULT_ESTOP] = { "estop", .parametric = true, .standard = 2, .min = 0.001, .max = 3600 },
	[FAULT_INTERLOCK] = { "interlock", .parametric = true, .standard = 2, .min = 0.001,
		.max = 3600 },
};

bool fault_is_of_camera(enum fault_kind kind)
{
	return kind == FAULT_BADFRAME || kind == FAULT_FRAMELOSS || kind == FAULT_CAMERAGONE;
}

static bool refuse(const char *text, const char *why, GError **error)
{
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT, "fault=%s %s", text, why);
	return false;
}

static bool find_kind(const char *text, gsize length, enum fault_kind *ret_kind)
{
	for (int i = 0; i < FAULT_KINDS; i++)
		if (strlen(rows[i].name) == length && strncmp(rows[i].name, text, length) == 0) {
			*ret_kind = (enum fault_kind)i;
			return true;
		}
	return false;
}

static bool parse_param(const char *text, const char *digits, const struct fault_row *row,
	double *ret_param, GError **error)
{
	char *end;
	double param = g_ascii_strtod(digits, &end);

	if (end == digits || *end != '\0' || !(param >= row->min && param <= row->max)) {
		g_autofree char *why = g_strdup_printf(
			"has a value that is not a number from %g to %g", row->min, row->max);

		return refuse(text, why, error);
	}
	*ret_param = param;
	return true;
}

static bool parse_one(const char *text, struct fault *ret_fault, GError **error)
{
	const char *at = strchr(text, '@');
	struct fault fault = { .count = 1 };
	char *end;

	if (!at || !find_kind(text, (gsize)(at - text), &fault.kind))
		return refuse(text, "is not KIND@COLUMN with a kind that exists", error);
	const struct fault_row *row = &rows[fault.kind];

	fault.param = row->standard;
	guint64 column = g_ascii_strtoull(at + 1, &end, 10);

	if (!g_ascii_isdigit(at[1]) || column >= FAULT_COLUMNS)
		return refuse(text, "has a column that is not a number from 0 to 2999", error);
	fault.column = (uint32_t)column;
	if (*end == 'x' && row->counted) {
		guint64 count = g_ascii_isdigit(end[1]) ? g_ascii_strtoull(end + 1, &end, 10) : 0;

		if (count < 1 || count > 100000)
			return refuse(
				text, "has a count that is not a number from 1 to 100000", error);
		fault.count = (uint32_t)count;
	}
	if (*end == ':' && row->parametric) {
		if (!parse_param(text, end + 1, row, &fault.param, error))
			return false;
	} else if (*end != '\0') {
		return refuse(text, "ends in something that its kind does not take", error);
	}
	*ret_fault = fault;
	return true;
}

bool fault_parse(const char *list, GArray *faults, GError **error)
{
	g_auto(GStrv) parts = g_strsplit(list, ",", -1);

	for (char **part = parts; *part; part++) {
		struct fault fault;

		if (!parse_one(*part, &fault, error))
			return false;
		g_array_append_val(faults, fault);
	}
	return true;
}

static bool passed(double column, double from, double to)
{
	double low = MIN(from, to) - 1e-9, high = MAX(from, to) + 1e-9;
	double first = column + FAULT_COLUMNS * ceil((low - column) / FAULT_COLUMNS);

	return first <= high;
}

const struct fault *fault_take(GArray *faults, double from_column, double to_column, bool camera)
{
	for (guint i = 0; i < faults->len; i++) {
		struct fault *fault = &g_array_index(faults, struct fault, i);

		if (!fault->fired && fault_is_of_camera(fault->kind) == camera &&
			passed(fault->column, from_column, to_column)) {
			fault->fired = true;
			return fault;
		}
	}
	return NULL;
}
