#include "process/export-table.h"
#include "process/export-verify.h"
#include <math.h>
#include <string.h>

const uint8_t table_type_bytes[] = {
	[TABLE_U8] = 1, [TABLE_U16] = 2, [TABLE_U32] = 4, [TABLE_F32] = 4, [TABLE_F64] = 8
};

G_STATIC_ASSERT(G_BYTE_ORDER == G_LITTLE_ENDIAN); /* records are written as they lie in memory */

void export_table_add(struct export_table *t, enum table_column column, enum table_type type)
{
	t->fields[t->count++] = (struct table_field){ column, type };
	t->record_bytes += table_type_bytes[type];
}

struct table_extent export_table_extent(const struct export_job *j)
{
	struct table_extent e = { .points = 0 };
	for (guint i = 0; i < j->stations->len; i++) {
		const struct export_survey *s = &export_station_at(j, i)->survey;
		for (int k = 0; k < 3; k++)
			e.farthest_m = fmax(e.farthest_m, fmax(-s->low_m[k], s->high_m[k]));
		e.points += s->points;
		e.has_intensity |= s->has_intensity;
		e.has_colour |= s->has_colour;
		e.has_classes |= s->has_classes;
		e.return_most = MAX(e.return_most, s->return_most);
	}
	return e;
}

double export_table_float_step_m(const struct table_extent *e)
{
	int exponent;
	frexp(e->farthest_m, &exponent);
	return ldexp(1, exponent - 24);
}

/* ---- records ---- */

static double number_of(
	const struct export_station *s, const struct export_point *p, enum table_column column)
{
	switch (column) {
	case TABLE_X:
	case TABLE_Y:
	case TABLE_Z: return p->is_point ? p->at_m[column - TABLE_X] : NAN;
	case TABLE_INTENSITY: return p->intensity / 65535.0;
	case TABLE_RED:
	case TABLE_GREEN:
	case TABLE_BLUE: return p->rgb[column - TABLE_RED];
	case TABLE_RGB: return p->rgb[0] << 16 | p->rgb[1] << 8 | p->rgb[2];
	case TABLE_CLASS: return p->classification;
	case TABLE_ECHO: return p->return_number;
	default: return s->number;
	}
}

static void put_number(enum table_type type, double value, uint8_t *into)
{
	union {
		uint8_t u8;
		uint16_t u16;
		uint32_t u32;
		float f32;
		double f64;
	} as;
	switch (type) {
	case TABLE_U8: as.u8 = (uint8_t)value; break;
	case TABLE_U16: as.u16 = (uint16_t)value; break;
	case TABLE_U32: as.u32 = (uint32_t)value; break;
	case TABLE_F32: as.f32 = (float)value; break;
	default: as.f64 = value; break;
	}
	memcpy(into, &as, table_type_bytes[type]);
}

void export_table_record(const struct export_table *t, const struct export_station *s,
	const struct export_point *p, uint8_t *into)
{
	for (unsigned i = 0; i < t->count; i++) {
		put_number(t->fields[i].type, number_of(s, p, t->fields[i].column), into);
		into += table_type_bytes[t->fields[i].type];
	}
}

void export_table_write(const struct export_table *t, const struct export_station *s,
	const struct export_point *p, size_t count, bool cells_too, FILE *file)
{
	uint8_t record[8 * TABLE_COLUMNS];
	for (size_t i = 0; i < count; i++) {
		if (!p[i].is_point && !cells_too)
			continue;
		export_table_record(t, s, &p[i], record);
		fwrite(record, 1, t->record_bytes, file);
	}
}

/* ---- reading back ---- */

static void encode(gpointer user_data, const struct export_station *s, const struct export_point *p,
	uint8_t *into)
{
	export_table_record(user_data, s, p, into);
}

bool export_table_verify(const struct export_job *j, const struct export_table *t,
	const char *header, bool cells_too, const char *path, GError **error)
{
	struct export_records records = { .header = header,
		.header_bytes = strlen(header),
		.record_bytes = t->record_bytes,
		.cells_too = cells_too,
		.encode = encode,
		.user_data = (gpointer)t };
	return export_verify_records(j, &records, path, error);
}
