#ifndef PROCESS_SCAN_POINTS_H
#define PROCESS_SCAN_POINTS_H
/* The points of a scan one by one, whether they lie in a grid or not, with what is known of the surface there, in the site's
 * frame. Index: of the grid's cell or of the record, as in scan-geometry.h. Const: any number of threads may read. */
#include "process/model.h"
#include "process/scan-data.h"
#include "process/scan-geometry.h"
#include <math.h>
#include <string.h>

/* All that it points to stays with whoever made it. */
struct scan_points {
	const scan_data *data;
	const scan_geometry *geometry; /* NULL: none */
	struct pose pose;              /* scan to site */
	uint64_t count;                /* of cells, or of records */
};

static inline struct scan_points scan_points_of(
	const scan_data *data, const scan_geometry *of_them, const struct pose *pose)
{
	return (struct scan_points){ data, of_them, *pose,
		data->grid ? range_grid_cells(data->grid) : data->points->count };
}

static inline bool scan_points_has(const struct scan_points *s, uint64_t i)
{
	if (s->data->grid)
		return s->data->grid->range_m[i] > 0;
	return s->data->points->record[i].cell == CELL_MEASURED;
}

static inline void scan_points_position(const struct scan_points *s, uint64_t i, double ret_m[3])
{
	const range_grid *g = s->data->grid;
	if (s->data->points) {
		const struct point_record *r = &s->data->points->record[i];
		double at[3] = { r->x_m, r->y_m, r->z_m };
		memcpy(ret_m, at, sizeof at);
	} else {
		double at[3] = { g->x_m[i], g->y_m[i], g->z_m[i] };
		memcpy(ret_m, at, sizeof at);
	}
	pose_apply(&s->pose, ret_m, ret_m);
}

/* 0 0 0: none. */
static inline void scan_points_normal(const struct scan_points *s, uint64_t i, double ret[3])
{
	float n[3] = { 0 };
	if (s->geometry)
		model_unpack_normal(s->geometry->normal[i], n);
	double turned[3] = { n[0], n[1], n[2] };
	pose_rotate(&s->pose, turned, ret);
}

/* Diameter of the patch that a point stands for; 0: not known. */
static inline float scan_points_size_m(const struct scan_points *s, uint64_t i)
{
	if (s->geometry && isfinite(s->geometry->point_size_m[i]))
		return s->geometry->point_size_m[i];
	return s->data->grid ? range_grid_point_size_m(s->data->grid, i) : 0;
}

/* Solid angle of the cell of a grid; 0 for a cloud. */
static inline float scan_points_solid_angle_sr(const struct scan_points *s, uint64_t i)
{
	const range_grid *g = s->data->grid;
	if (!g)
		return 0;
	double level = sqrt((double)g->x_m[i] * g->x_m[i] + (double)g->y_m[i] * g->y_m[i]);
	return (float)(g->column_rad * g->row_rad * level / g->range_m[i]);
}

/* NULL: no colour. */
static inline const uint8_t *scan_points_rgb(const struct scan_points *s, uint64_t i)
{
	if (!s->data->points)
		return s->data->grid->rgb ? s->data->grid->rgb + 3 * i : NULL;
	return s->data->points->have & POINTS_HAVE_COLOUR ? s->data->points->record[i].rgb : NULL;
}

static inline uint16_t scan_points_intensity(const struct scan_points *s, uint64_t i)
{
	if (s->data->points)
		return s->data->points->record[i].intensity;
	return s->data->grid->intensity ? s->data->grid->intensity[i] : 0;
}

/* As LAS 1.4 numbers them; 0: never classified. */
static inline uint8_t scan_points_classification(const struct scan_points *s, uint64_t i)
{
	return s->data->points ? s->data->points->record[i].classification : 0;
}

#endif
