/* E57 (e57.h): each station in its own frame with its pose. */
#include "process/export-e57.h"
#include "process/e57-write.h"
#include "process/export-verify.h"
#include <math.h>
#include <string.h>

/* Coordinates are whole numbers of it. */
#define STEP_M 1e-6

/* Of a point, as the file has it. */
struct field {
	enum field_of {
		OF_X,
		OF_Y,
		OF_Z,
		OF_INTENSITY,
		OF_RED,
		OF_GREEN,
		OF_BLUE,
		OF_ROW,
		OF_COLUMN,
		OF_RETURN,
		OF_CLASS,
		OF_STATE
	} of;
	int64_t least, most;
};
#define FIELDS_MAX 12

struct export_e57 {
	const struct export_job *job;
	e57_write *to;
	struct e57_xml *xml;
	const struct export_station *station;
	struct field fields[FIELDS_MAX];
	unsigned count;
	e57_vector_write *vector;
};

static void add_field(struct export_e57 *w, enum field_of of, double least, double most)
{
	w->fields[w->count++] = (struct field){ of, (int64_t)least, (int64_t)most };
}

static void find_fields(struct export_e57 *w, const struct export_station *s)
{
	const struct export_survey *of = &s->survey;
	w->count = 0;
	for (int i = 0; i < 3; i++)
		add_field(w, (enum field_of)(OF_X + i), rint(of->low_m[i] / STEP_M),
			rint(of->high_m[i] / STEP_M));
	if (of->has_intensity)
		add_field(w, OF_INTENSITY, 0, UINT16_MAX);
	for (int i = 0; i < 3 && of->has_colour; i++)
		add_field(w, (enum field_of)(OF_RED + i), 0, UINT8_MAX);
	if (s->columns) {
		add_field(w, OF_ROW, 0, s->rows - 1.0);
		add_field(w, OF_COLUMN, 0, s->columns - 1.0);
	} else {
		/* One at zero is a point, too: in bits it takes none. */
		add_field(w, OF_STATE, 0, 0);
	}
	if (of->return_most > 1)
		add_field(w, OF_RETURN, 0, of->return_most - 1.0);
	if (of->has_classes)
		add_field(w, OF_CLASS, 0, UINT8_MAX);
}

static int64_t number_of(const struct export_point *p, enum field_of of)
{
	switch (of) {
	case OF_X:
	case OF_Y:
	case OF_Z: return (int64_t)rint(p->at_m[of - OF_X] / STEP_M);
	case OF_INTENSITY: return p->intensity;
	case OF_RED:
	case OF_GREEN:
	case OF_BLUE: return p->rgb[of - OF_RED];
	case OF_ROW: return p->row;
	case OF_COLUMN: return p->column;
	case OF_RETURN: return p->return_number - 1;
	case OF_CLASS: return p->classification;
	default: return 0;
	}
}

/* ---- stations ---- */

static bool begin_station(export_writer *writer, const struct export_station *s, GError **error)
{
	struct export_e57 *w = (struct export_e57 *)writer;
	unsigned bits[FIELDS_MAX];
	(void)error;
	w->station = s;
	find_fields(w, s);
	for (unsigned i = 0; i < w->count; i++)
		bits[i] = e57_bits(w->fields[i].least, w->fields[i].most);
	w->vector = e57_vector_write_new(w->to, bits, w->count);
	return true;
}

static bool write_points(
	export_writer *writer, const struct export_point *p, size_t count, GError **error)
{
	struct export_e57 *w = (struct export_e57 *)writer;
	(void)error;
	for (size_t i = 0; i < count; i++) {
		uint64_t *record = e57_vector_write_next(w->vector);
		for (unsigned k = 0; k < w->count; k++)
			record[k] = (uint64_t)number_of(&p[i], w->fields[k].of) -
				    (uint64_t)w->fields[k].least;
	}
	return true;
}

static void describe_fields(struct export_e57 *w)
{
	static const char *const names[] = { [OF_X] = "cartesianX",
		[OF_Y] = "cartesianY",
		[OF_Z] = "cartesianZ",
		[OF_INTENSITY] = "intensity",
		[OF_RED] = "colorRed",
		[OF_GREEN] = "colorGreen",
		[OF_BLUE] = "colorBlue",
		[OF_ROW] = "rowIndex",
		[OF_COLUMN] = "columnIndex",
		[OF_RETURN] = "returnIndex",
		[OF_CLASS] = E57_CLASS_PREFIX ":classification",
		[OF_STATE] = "cartesianInvalidState" };
	for (unsigned i = 0; i < w->count; i++) {
		const struct field *f = &w->fields[i];
		e57_xml_field(w->xml, names[f->of], f->least, f->most, f->of <= OF_Z ? STEP_M : 0);
	}
}

static bool end_station(export_writer *writer, GError **error)
{
	struct export_e57 *w = (struct export_e57 *)writer;
	uint64_t at = e57_vector_write_end(w->vector);
	g_clear_pointer(&w->vector, e57_vector_write_free);
	e57_xml_begin_points(w->xml, w->station, at);
	describe_fields(w);
	e57_xml_end_points(w->xml);
	return export_e57_pictures(w->job, w->station, w->to, w->xml, error);
}

/* ---- the format ---- */

static export_writer *open_writer(const struct export_job *j, FILE *file, GError **error)
{
	struct export_e57 *w = g_new0(struct export_e57, 1);
	(void)error;
	w->job = j;
	w->to = e57_write_new(file);
	w->xml = e57_xml_new(j);
	return (export_writer *)w;
}

static bool finish(export_writer *writer, GError **error)
{
	struct export_e57 *w = (struct export_e57 *)writer;
	size_t length;
	(void)error;
	const char *xml = e57_xml_end(w->xml, &length);
	e57_write_end(w->to, xml, length);
	return true;
}

static void close_writer(export_writer *writer)
{
	struct export_e57 *w = (struct export_e57 *)writer;
	if (!w)
		return;
	e57_vector_write_free(w->vector);
	e57_write_free(w->to);
	e57_xml_free(w->xml);
	g_free(w);
}

static double resolution_m(const struct export_job *j)
{
	(void)j;
	return STEP_M;
}

/* Points, then each page: those of the pictures too. */
static bool check_pages(const char *path, GError **error)
{
	g_autoptr(import_source) file = import_source_open(path, error);
	g_autoptr(e57_pages) pages = file ? e57_pages_new(file) : NULL;
	uint8_t block[E57_PAGE_PAYLOAD];
	for (uint64_t at = 0; pages && at < e57_pages_size(pages); at += sizeof block)
		if (!e57_pages_read(pages, at, block, sizeof block, error))
			return false;
	return pages;
}

static bool verify(const struct export_job *j, const char *path, GError **error)
{
	return export_verify_by_import(j, &import_e57, path, true, error) &&
	       check_pages(path, error);
}

const struct export_format export_e57 = { .name = "E57",
	.extension = "e57",
	.has_map = true,
	.order = EXPORT_WALK_POINTS,
	.open = open_writer,
	.begin = begin_station,
	.write = write_points,
	.end = end_station,
	.finish = finish,
	.close = close_writer,
	.verify = verify,
	.resolution_m = resolution_m };
