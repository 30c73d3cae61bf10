#ifndef ACQUIRE_PANORAMA_H
#define ACQUIRE_PANORAMA_H
/* A panorama is one full turn of the head as a grid: columns of rising azimuth from left to right
 * (clockwise seen from above, so that it looks as the place does), rows of falling elevation from
 * top to bottom. Cells are equal in angle.
 *
 * A cell keeps the beam that passed nearest its centre, as measured, with the beam's own direction
 * as an offset from the centre. So a measured cell is a point as exact as the scanner made it; where
 * several beams of a cell met one surface, their mean is more exact (panorama-means.h). Cells that
 * no beam came near are filled from their neighbours for looking at, and say so; nothing downstream
 * may treat them as measured. One owner; not thread-safe while written, const after. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct panorama panorama;

enum panorama_cell {
	CELL_EMPTY, /* no beam went there */
	CELL_MEASURED,
	CELL_FILLED,    /* interpolated */
	CELL_NO_RETURN, /* a beam went there and nothing came back: open sky, water, glass */
};

struct panorama_desc {
	uint32_t columns, rows;
	double elevation_min_rad,
		elevation_max_rad; /* lower edge of the last row, upper edge of row 0 */
};

#define PANORAMA_COLUMNS_MAX 65536u
#define PANORAMA_ROWS_MAX    32768u
#define PANORAMA_CELLS_MAX   (256u << 20)
#define PANORAMA_RANGE_MAX_M 1e6f

/* Offsets from the cell's centre, in cells: value / PANORAMA_OFFSET_ONE, within half a cell. */
#define PANORAMA_OFFSET_ONE 65534.0

struct panorama {
	struct panorama_desc desc;
	double column_rad, row_rad; /* size of a cell */
	/* Planes of rows * columns, row by row. */
	float *range_m; /* 0 where there is none */
	uint16_t *intensity;
	uint8_t *cell; /* enum panorama_cell */
	int16_t *azimuth_offset, *elevation_offset;
	uint8_t *rgb; /* 3 bytes a cell, sRGB; NULL: no colour */
};

/* Refuses sizes of zero or beyond the maxima, and elevations beyond the zenith or the nadir. */
panorama *panorama_new(const struct panorama_desc *desc, GError **error);
void panorama_free(panorama *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(panorama, panorama_free)

/* The grid of a preset: columns over a full turn, rows over 90 degrees from 40 below to 50 above
 * the horizon, laid so that the centre of a row is at elevation 0. */
struct panorama_desc panorama_desc_for(uint32_t columns, uint32_t rows);

/* A beam in its cell. */
struct panorama_beam {
	uint32_t cell;      /* panorama_index */
	int16_t across, up; /* from the centre, in units of an offset */
	float range_m;      /* 0 = no return */
	uint16_t intensity;
};
/* false: it is outside the rows. */
bool panorama_find_beam(const panorama *p, double azimuth_rad, double elevation_rad, float range_m,
	uint16_t intensity, struct panorama_beam *ret);
void panorama_add_beam(panorama *p, const struct panorama_beam *beam);

/* Beams in any order; azimuth 0..2 pi; range 0 = no return, and so is what is no range (negative,
 * beyond PANORAMA_RANGE_MAX_M). Beams outside the rows are passed over. */
void panorama_add(panorama *p, const double *azimuth_rad, const float *elevation_rad,
	const float *range_m, const uint16_t *intensity, size_t beams);

/* Fills empty cells between beams up to reach cells apart in a row or column; ranges across an edge
 * are not mixed. */
void panorama_fill(panorama *p, uint32_t reach);

static inline size_t panorama_index(const panorama *p, uint32_t row, uint32_t column)
{
	return (size_t)row * p->desc.columns + column;
}

/* Direction of a cell's point: of its own beam when measured, of the centre otherwise. */
double panorama_azimuth_rad(const panorama *p, uint32_t row, uint32_t column);
double panorama_elevation_rad(const panorama *p, uint32_t row, uint32_t column);
/* The point in the scanner frame (x right of home, y along it, z up). Needs a range. */
void panorama_point(const panorama *p, uint32_t row, uint32_t column, double ret_m[3]);
/* Diameter of the patch that the cell stands for, at its range (Xu & Chen 2004, section 3): the
 * larger side of the cell. */
float panorama_point_size_m(const panorama *p, uint32_t row, uint32_t column);
/* Share of the cells of a column that a beam went to, 0..1. */
double panorama_column_coverage(const panorama *p, uint32_t column);

struct panorama_counts {
	size_t measured, filled, no_return, empty;
};
struct panorama_counts panorama_count(const panorama *p);

#endif
