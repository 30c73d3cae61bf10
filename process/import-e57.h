#ifndef PROCESS_IMPORT_E57_H
#define PROCESS_IMPORT_E57_H
/* What the files of the E57 reader share: its state, the fields of points, how numbers become intensities and colours. */
#include "process/e57-vector.h"

enum e57_role {
	E57_X,
	E57_Y,
	E57_Z,
	E57_RANGE,
	E57_AZIMUTH,
	E57_ELEVATION,
	E57_STATE, /* cartesian or spherical: 0 a point, 1 a direction only, 2 nothing */
	E57_INTENSITY,
	E57_NO_INTENSITY, /* not 0: what stands there is none */
	E57_RED,
	E57_GREEN,
	E57_BLUE,
	E57_NO_COLOUR,
	E57_ROW,
	E57_COLUMN,
	E57_RETURN,
	E57_CLASS,
	E57_ROLES
};

struct e57_span {
	double least, most; /* least > most: nothing met */
};

struct e57 {
	import_source *file;
	e57_pages *pages;
	e57_tree *tree;
	unsigned next; /* scan of the tree */
	const struct e57_scan *from;
	e57_vector *vector;
	int field[E57_ROLES];            /* -1: there is none */
	const double *number[E57_ROLES]; /* of the block at hand; NULL: none */
	bool is_spherical;
	struct e57_span met[E57_ROLES];       /* over all points of the scan */
	struct e57_span intensity, colour[3]; /* what becomes 0 and the largest */
	uint64_t cells[E57_BLOCK_RECORDS];    /* of the records that were given last */
	uint8_t *has_point, *filled; /* a bit a cell: some first echo is of it; one was given */
	uint64_t given;              /* points of the scan so far */
	uint64_t sections;           /* bytes of those of the scans so far */
	uint64_t looked;             /* bytes of those that were looked through for one point */
	uint64_t no_room;            /* points whose cell had another one already */
	unsigned scans;              /* given so far */
	GString *notes;
	struct import_scan scan;
};

/* Fills field; false: these make no points. */
bool e57_find_fields(struct e57 *r);
/* Opens the scan's vector for some of the roles. */
bool e57_open_vector(struct e57 *r, const bool wanted[E57_ROLES], GError **error);
bool e57_next_block(struct e57 *r, size_t max, size_t *ret_count, GError **error);
/* A role's number of record i of the block; without, where the scan has none. */
static inline double e57_number(const struct e57 *r, enum e57_role role, size_t i, double without)
{
	return r->number[role] ? r->number[role][i] : without;
}
/* Reads all of the scan once, for what must be known before the first point is given: ranges of numbers, and whether rows and columns
 * make a grid, which scan.columns then says. */
bool e57_look_through(struct e57 *r, GError **error);
static inline bool e57_is_later_echo(const struct e57 *r, size_t i)
{
	const double *echo = r->number[E57_RETURN];
	return echo && echo[i] > 0 && echo[i] > r->met[E57_RETURN].least;
}
/* Where record i of the block belongs in the grid; false: nowhere. */
bool e57_cell(const struct e57 *r, size_t i, uint64_t *ret);
static inline bool e57_bit(const uint8_t *bits, uint64_t i)
{
	return bits[i / 8] >> i % 8 & 1;
}
/* Whether it was set before. */
static inline bool e57_set_bit(uint8_t *bits, uint64_t i)
{
	bool was = e57_bit(bits, i);
	bits[i / 8] |= (uint8_t)(1 << i % 8);
	return was;
}
void e57_add_note(struct e57 *r, const char *format, ...) G_GNUC_PRINTF(2, 3);

/* The pictures of the scan that was read last into the folder, for scan.json. */
bool e57_save_pictures(import_reader *reader, const char *folder, JsonArray *into, GError **error);

#endif
