#include "process/part-point.h"
#include "process/model.h"
#include <string.h>

static uint16_t tenth_mm(float length_m, uint16_t max)
{
	return length_m > 0 ? (uint16_t)fminf(roundf(length_m * 1e4f), max) : 0;
}

/* Surface met at a lower cosine counts as met at this one. */
#define COSINE_LEAST 0.05f

/* Where a surface is met aslant, a cell stands for more of it. But so many cells beside it must lie on its plane, for any three
 * points do on one: a leaf, or the edge of a roof that is just seen, is no wide floor. */
#define SLANTED      0.6f
#define BESIDE       3 /* columns and rows */
#define BESIDE_LEAST 4
#define OFF_PLANE    0.25f /* of how far the cell is away */
#define OFF_NOISE_M  0.01f
#define REACH        2 /* times the edge of what the cell would stand for */

static bool is_on_patch(
	const range_grid *g, uint64_t i, uint64_t j, const float normal[3], float reach_m)
{
	float to[3] = { g->x_m[j] - g->x_m[i], g->y_m[j] - g->y_m[i], g->z_m[j] - g->z_m[i] };
	float off = fabsf(to[0] * normal[0] + to[1] * normal[1] + to[2] * normal[2]);
	float far = sqrtf(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
	return far < reach_m && off < OFF_PLANE * far + OFF_NOISE_M;
}

static bool has_patch(const range_grid *g, uint64_t i, const int16_t packed[2], float reach_m)
{
	int row = (int)(i / g->columns), column = (int)(i % g->columns), found = 0;
	int columns = (int)g->columns, rows = (int)g->rows;
	float normal[3];
	model_unpack_normal(packed, normal);
	for (int r = MAX(row - BESIDE, 0); r <= MIN(row + BESIDE, rows - 1); r++)
		for (int c = column - BESIDE; c <= column + BESIDE; c++) {
			if ((c < 0 || c >= columns) && !g->wraps)
				continue;
			uint64_t j = (uint64_t)r * g->columns + (uint64_t)((c + columns) % columns);
			if (j != i && g->range_m[j] > 0 && is_on_patch(g, i, j, normal, reach_m))
				found++;
		}
	return found >= BESIDE_LEAST;
}

/* Columns from one beam to the next; what is less or more is not for lines that stand otherwise than columns. */
#define GAP_LEAST 0.5f
#define GAP_MOST  2.f

/* Columns from this cell's beam to that of the cell beside it; 1 where that has no point. */
static float gap(const range_grid *g, uint64_t i, int right)
{
	size_t j;
	if (!range_grid_step(
		    g, (uint32_t)(i / g->columns), (uint32_t)(i % g->columns), 0, right, &j) ||
		!(g->range_m[j] > 0))
		return 1;
	float across = fabsf(g->x_m[i] * g->y_m[j] - g->y_m[i] * g->x_m[j]);
	float both = hypotf(g->x_m[i], g->y_m[i]) * hypotf(g->x_m[j], g->y_m[j]);
	float columns = both > 0 ? across / (both * (float)g->column_rad) : 1;
	return CLAMP(columns, GAP_LEAST, GAP_MOST);
}

/* A scanner's lines seldom stand as its columns do: where two lines are in one, and became one point or left one out, there is a gap
 * beside it, and the points at both sides stand for half of that, too. */
static float columns_wide(const range_grid *g, uint64_t i)
{
	return (gap(g, i, -1) + gap(g, i, 1)) / 2;
}

/* Of the surface that the cell's beam stands for, slanted as it is; of a cloud's points their patch. */
static float spacing_m(const struct scan_points *s, uint64_t i, const double normal[3])
{
	const range_grid *g = s->data->grid;
	double at[3], ray[3], cosine = 1;
	if (!g)
		return scan_points_size_m(s, i);
	scan_points_position(s, i, at);
	for (int k = 0; k < 3; k++)
		ray[k] = at[k] - s->pose.translation_m[k];
	if (normal[0] != 0 || normal[1] != 0 || normal[2] != 0)
		cosine = fabs(normal[0] * ray[0] + normal[1] * ray[1] + normal[2] * ray[2]) /
			 g->range_m[i];
	float size_m = g->range_m[i] * sqrtf(scan_points_solid_angle_sr(s, i) * columns_wide(g, i));
	if (cosine < SLANTED && !has_patch(g, i, s->geometry->normal[i],
					REACH * size_m / sqrtf(fmaxf((float)cosine, COSINE_LEAST))))
		cosine = 1;
	return size_m / sqrtf(fmaxf((float)cosine, COSINE_LEAST));
}

static void take_geometry(const struct scan_points *s, uint64_t i, struct part_point *p)
{
	double n[3] = { 0 };
	p->normal[0] = p->normal[1] = MODEL_NORMAL_NONE;
	p->plane_error = MODEL_ERROR_NONE;
	p->size = tenth_mm(scan_points_size_m(s, i), UINT16_MAX);
	if (s->geometry)
		scan_points_normal(s, i, n);
	p->spacing = tenth_mm(spacing_m(s, i, n), UINT16_MAX);
	if (!s->geometry)
		return;
	model_pack_normal((float[3]){ (float)n[0], (float)n[1], (float)n[2] }, p->normal);
	if (isfinite(s->geometry->plane_error_m[i]))
		p->plane_error = tenth_mm(s->geometry->plane_error_m[i], MODEL_ERROR_NONE - 1);
}

static void take_look(const struct scan_points *s, uint64_t i, struct part_point *p)
{
	const uint8_t *rgb = scan_points_rgb(s, i);
	p->intensity = scan_points_intensity(s, i);
	p->classification = scan_points_classification(s, i);
	if (!rgb)
		return;
	memcpy(p->rgba, rgb, 3);
	p->rgba[3] = 255;
}

static void turn(const struct pose *p, const int16_t packed[2], int16_t ret[2])
{
	float along[3];
	double turned[3];
	ret[0] = ret[1] = MODEL_NORMAL_NONE;
	if (packed[0] == MODEL_NORMAL_NONE && packed[1] == MODEL_NORMAL_NONE)
		return;
	model_unpack_normal(packed, along);
	pose_rotate(p, (double[3]){ along[0], along[1], along[2] }, turned);
	model_pack_normal((float[3]){ (float)turned[0], (float)turned[1], (float)turned[2] }, ret);
}

static void take_features(const struct part_source *s, uint64_t i, struct part_point *p)
{
	const scan_features *f = s->features;
	p->direction[0] = p->direction[1] = p->principal[0] = p->principal[1] = MODEL_NORMAL_NONE;
	p->k1 = p->k2 = MODEL_HALF_NONE;
	if (!f)
		return;
	p->feature = f->degree[i];
	p->kind = f->kind[i];
	p->flags = f->flags[i];
	turn(&s->points.pose, f->direction[i], p->direction);
	turn(&s->points.pose, f->principal[i], p->principal);
	p->k1 = model_pack_half(f->k1[i]);
	p->k2 = model_pack_half(f->k2[i]);
}

bool part_point_take(const struct part_source *s, uint64_t i, double cell_m, struct part_point *ret,
	double *reach_m)
{
	double at[3];
	struct morton_place place;
	scan_points_position(&s->points, i, at);
	for (int k = 0; k < 3; k++)
		*reach_m = fmax(*reach_m, fabs(at[k]));
	if (!morton_from_point(at, cell_m, &place))
		return false;
	*ret = (struct part_point){ .code = place.code,
		.leaf = s->segments ? s->segments->leaf[i] : 0 };
	memcpy(ret->within, place.within, sizeof ret->within);
	take_geometry(&s->points, i, ret);
	take_look(&s->points, i, ret);
	take_features(s, i, ret);
	return true;
}
