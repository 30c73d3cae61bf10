#include "process/board-corners.h"
#include "acquire/srgb.h"
#include "process/normal-equations.h"
#include <math.h>
#include <string.h>

#define STEPS 15
/* The pixels are chosen by where the corner was thought to be: once more, by where it is. */
#define ROUNDS 2
/* What the lens adds to the pixel's own square. */
#define BLUR_PX     0.3
#define BLUR_MIN_PX 0.1
#define BLUR_MAX_PX 2.0
/* Squares beside are kept out by so much. */
#define MARGIN_PX 0.6
/* Nearer edges leave too few pixels. */
#define REACH_MIN_PX 1.2
#define PIXELS_MAX   4096
/* What it may be off at first, and how well it has to fit, by the contrast. */
#define SHIFT_MAX_PX 1.5
#define MISFIT_MAX   0.2
#define CONTRAST_MIN 0.01
#define SETTLED_PX   1e-4
/* Across a pixel and down. */
#define PLACES 5

enum { AT_X, AT_Y, TURN_1, TURN_2, BLUR, MIDDLE, CONTRAST, UNKNOWNS };

struct pixel {
	double x, y, light;
};

struct fit {
	double value[UNKNOWNS];
	struct pixel pixels[PIXELS_MAX];
	size_t count;
};

static void fill_curve(double curve[256])
{
	for (int i = 0; i < 256; i++)
		curve[i] = srgb_to_linear(CLAMP((i - 16) / 219.0, 0, 1));
}

/* ---- the model ---- */

struct edge {
	double sine, cosine, k;
};

static struct edge edge_of(const double *v, int turn)
{
	return (struct edge){ sin(v[turn]), cos(v[turn]), 1 / (M_SQRT2 * v[BLUR]) };
}

/* Between -1 and 1: on which side of an edge through the corner a place is; and what that changes by the corner's place, the edge's turn and the blur. */
static double side_of(const struct edge *e, double dx, double dy, double ret_by[4])
{
	double off = e->cosine * dy - e->sine * dx,
	       slope = M_2_SQRTPI * exp(-e->k * e->k * off * off) * e->k;
	ret_by[0] = slope * e->sine;
	ret_by[1] = -slope * e->cosine;
	ret_by[2] = -slope * (e->cosine * dx + e->sine * dy);
	ret_by[3] = -slope * off * e->k * M_SQRT2;
	return erf(e->k * off);
}

static void add_light(const struct edge e[2], double contrast, double dx, double dy, double share,
	double sum[UNKNOWNS])
{
	double one[4], two[4], a = side_of(&e[0], dx, dy, one), b = side_of(&e[1], dx, dy, two),
			       by = contrast * share;
	sum[AT_X] += by * (one[0] * b + a * two[0]);
	sum[AT_Y] += by * (one[1] * b + a * two[1]);
	sum[TURN_1] += by * one[2] * b;
	sum[TURN_2] += by * a * two[2];
	sum[BLUR] += by * (one[3] * b + a * two[3]);
	sum[CONTRAST] += share * a * b;
}

static bool is_near(const struct edge *e, double dx, double dy)
{
	return fabs(e->cosine * dy - e->sine * dx) < 0.71 + 2.5 * M_SQRT1_2 / e->k;
}

/* What a pixel gathers over its square: a few places tell enough of it, where it is beside an edge one does. */
static double light_at(
	const double *v, const struct edge e[2], const struct pixel *p, double ret_by[UNKNOWNS])
{
	double dx = p->x - v[AT_X], dy = p->y - v[AT_Y];
	int n = is_near(&e[0], dx, dy) || is_near(&e[1], dx, dy) ? PLACES : 1;
	memset(ret_by, 0, UNKNOWNS * sizeof *ret_by);
	for (int i = 0; i < n * n; i++)
		add_light(e, v[CONTRAST], dx + (i % n + 0.5) / n - 0.5,
			dy + (i / n + 0.5) / n - 0.5, 1.0 / (n * n), ret_by);
	ret_by[MIDDLE] = 1;
	return v[MIDDLE] + v[CONTRAST] * ret_by[CONTRAST];
}

static double misfit(const struct fit *f, const double *v)
{
	const struct edge e[2] = { edge_of(v, TURN_1), edge_of(v, TURN_2) };
	double sum = 0, by[UNKNOWNS];
	for (size_t i = 0; i < f->count; i++) {
		double off = f->pixels[i].light - light_at(v, e, &f->pixels[i], by);
		sum += off * off;
	}
	return sum;
}

/* ---- what it is fitted to ---- */

/* To the next corners of a row (0) or a column (1): half the way from the one before to the one after. */
static void direction(const struct board_desc *desc, double (*corner)[2], uint32_t i, uint32_t j,
	int axis, double ret[2])
{
	uint32_t step = axis ? desc->columns : 1, at = j * desc->columns + i, place = axis ? j : i,
		 last = (axis ? desc->rows : desc->columns) - 1, from = place > 0 ? at - step : at,
		 to = place < last ? at + step : at;
	for (int k = 0; k < 2; k++)
		ret[k] = (corner[to][k] - corner[from][k]) / ((to - from) / step);
}

/* The pixels of the four squares that meet there, without what the next edges touch. */
static bool gather(const uint8_t *luma, uint32_t width, uint32_t height, const double curve[256],
	const double along[2][2], const double at[2], struct fit *f)
{
	double length[2] = { hypot(along[0][0], along[0][1]), hypot(along[1][0], along[1][1]) },
	       area = fabs(along[0][0] * along[1][1] - along[0][1] * along[1][0]);
	/* How far from each edge the next one of its direction is, halved. */
	double reach[2] = { 0.5 * area / length[0] - MARGIN_PX,
		0.5 * area / length[1] - MARGIN_PX };
	double side = 0.5 * (length[0] + length[1]);
	int x0 = (int)ceil(fmax(at[0] - side, 0)), y0 = (int)ceil(fmax(at[1] - side, 0)),
	    x1 = (int)floor(fmin(at[0] + side, width - 1.0)),
	    y1 = (int)floor(fmin(at[1] + side, height - 1.0));
	/* Beside the picture's edge some of the four squares is not seen. */
	bool inside_picture = at[0] > REACH_MIN_PX && at[1] > REACH_MIN_PX &&
			      at[0] < width - 1 - REACH_MIN_PX && at[1] < height - 1 - REACH_MIN_PX;
	if (!(reach[0] >= REACH_MIN_PX && reach[1] >= REACH_MIN_PX) || !inside_picture)
		return false;
	f->count = 0;
	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1 && f->count < PIXELS_MAX; x++) {
			double dx = x - at[0], dy = y - at[1];
			bool inside = true;
			for (int k = 0; k < 2; k++)
				inside &= fabs(along[k][0] * dy - along[k][1] * dx) / length[k] <
					  reach[k];
			if (inside)
				f->pixels[f->count++] = (struct pixel){ x, y,
					curve[luma[(size_t)y * width + (uint32_t)x]] };
		}
	return f->count > 2 * UNKNOWNS;
}

static void begin(struct fit *f, const double along[2][2], const double at[2])
{
	double by[UNKNOWNS], sum = 0, product = 0, square = 0, signs = 0;
	double first[UNKNOWNS] = { at[0], at[1], atan2(along[0][1], along[0][0]),
		atan2(along[1][1], along[1][0]), BLUR_PX, 0, 1 };
	memcpy(f->value, first, sizeof first);
	const struct edge e[2] = { edge_of(first, TURN_1), edge_of(first, TURN_2) };
	for (size_t i = 0; i < f->count; i++) {
		double sign = light_at(f->value, e, &f->pixels[i], by);
		sum += f->pixels[i].light;
		signs += sign;
		product += sign * f->pixels[i].light;
		square += sign * sign;
	}
	double n = (double)f->count,
	       contrast = (n * product - signs * sum) / (n * square - signs * signs);
	f->value[CONTRAST] = contrast;
	f->value[MIDDLE] = (sum - contrast * signs) / n;
}

/* Levenberg and Marquardt's. */
static bool settle(struct fit *f)
{
	double damping = 1e-3, now = misfit(f, f->value);
	for (int n = 0; n < STEPS; n++) {
		double information[UNKNOWNS * UNKNOWNS] = { 0 }, gradient[UNKNOWNS] = { 0 },
					      by[UNKNOWNS];
		double change[UNKNOWNS], moved[UNKNOWNS];
		const struct edge e[2] = { edge_of(f->value, TURN_1), edge_of(f->value, TURN_2) };
		for (size_t p = 0; p < f->count; p++) {
			double off = f->pixels[p].light - light_at(f->value, e, &f->pixels[p], by);
			for (int i = 0; i < UNKNOWNS; i++) {
				gradient[i] += by[i] * off;
				for (int k = 0; k < UNKNOWNS; k++)
					information[i * UNKNOWNS + k] += by[i] * by[k];
			}
		}
		for (int i = 0; i < UNKNOWNS; i++)
			information[i * (UNKNOWNS + 1)] *= 1 + damping;
		if (!normal_equations_solve(information, gradient, UNKNOWNS, change, NULL))
			return false;
		for (int i = 0; i < UNKNOWNS; i++)
			moved[i] = f->value[i] + change[i];
		moved[BLUR] = CLAMP(moved[BLUR], BLUR_MIN_PX, BLUR_MAX_PX);
		double then = misfit(f, moved);
		damping *= then < now ? 0.2 : 10;
		if (!(then < now))
			continue;
		memcpy(f->value, moved, sizeof moved);
		now = then;
		if (hypot(change[AT_X], change[AT_Y]) < SETTLED_PX)
			break;
	}
	double contrast = fabs(f->value[CONTRAST]);
	return contrast > CONTRAST_MIN && sqrt(now / (double)f->count) < MISFIT_MAX * contrast;
}

static void refine_once(const uint8_t *luma, uint32_t width, uint32_t height,
	const double curve[256], const struct board_desc *desc, double (*corner)[2], struct fit *f)
{
	double found[BOARD_CORNERS_MAX][2];
	for (uint32_t j = 0; j < desc->rows; j++)
		for (uint32_t i = 0; i < desc->columns; i++) {
			const double *at = corner[j * desc->columns + i];
			double along[2][2], *to = found[j * desc->columns + i];
			direction(desc, corner, i, j, 0, along[0]);
			direction(desc, corner, i, j, 1, along[1]);
			memcpy(to, at, sizeof *found);
			if (!gather(luma, width, height, curve, along, at, f))
				continue;
			begin(f, along, at);
			if (settle(f) && hypot(f->value[AT_X] - at[0], f->value[AT_Y] - at[1]) <
						 SHIFT_MAX_PX)
				memcpy(to, f->value, sizeof *found);
		}
	memcpy(corner, found, desc->columns * desc->rows * sizeof *found);
}

void board_corners_refine(const uint8_t *luma, uint32_t width, uint32_t height,
	const struct board_desc *desc, double (*corner)[2])
{
	double curve[256];
	struct fit *f = g_new(struct fit, 1);
	fill_curve(curve);
	for (int i = 0; i < ROUNDS; i++)
		refine_once(luma, width, height, curve, desc, corner, f);
	g_free(f);
}
