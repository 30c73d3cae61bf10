#include "process/board-camera.h"
#include "process/board-lidar.h"
#include "process/normal-equations.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define DEGREE     (G_PI / 180)
#define STEPS_MAX  40
#define BOARD_POSE 6 /* unknowns of each board: turn and shift in the scanner's frame */
/* Views of a board lie together so far. */
#define TOGETHER_M 0.35
/* Corners further off than most count less: at first, before it is known how far most are, and at least. */
#define HUBER_FIRST_PX 0.5
#define HUBER_LEAST_PX 0.01
#define HUBER_MEDIANS  3.0
/* Gauge: as good as fixed. */
#define GAUGE 1e-9
/* Of so many beams each says something of its own: walls and boards are not even to less than a tenth of a millimetre. */
#define BEAMS_WORTH 10000.0

struct bundle {
	const struct board_desc *desc;
	GArray *views;  /* of struct board_view */
	GArray *boards; /* of struct pose: board to scanner */
	struct camera_calibration camera;
	size_t unknowns;
	/* What the lidar saw of each board (struct board_plane); NULL: not yet. By how much its ranges are too short beyond
	 * what they were taken with, and what a metre is worth in pixels. */
	GArray *planes;
	double range_m, px_per_m;
	double huber_px;
};

static const double small[BOARD_UNKNOWNS] = { 1e-3, 1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-7, 1e-7, 1e-6,
	1e-7, 1e-7, 1e-7, 1e-6, 1e-6, 1e-6, 1 };

/* ---- the camera, changed a little ---- */

static void turn_camera(struct camera_calibration *c, const double turn_rad[3])
{
	const double twist[6] = { turn_rad[0], turn_rad[1], turn_rad[2] };
	struct pose body = pose_perturb(&POSE_IDENTITY, twist);
	double before[3][3];
	memcpy(before, c->rotation, sizeof before);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			c->rotation[i][j] = 0;
			for (int k = 0; k < 3; k++)
				c->rotation[i][j] += before[i][k] * body.rotation[j][k];
		}
}

static void change_camera(struct camera_calibration *c, const double change[BOARD_UNKNOWNS])
{
	c->fx += change[BOARD_FX];
	c->fy += change[BOARD_FY];
	c->cx += change[BOARD_CX];
	c->cy += change[BOARD_CY];
	for (int i = 0; i < 5; i++)
		c->distortion[i] += change[BOARD_K1 + i];
	turn_camera(c, change + BOARD_TURN_X);
	for (int i = 0; i < 3; i++)
		c->translation_m[i] += change[BOARD_X + i];
}

/* ---- what a view should show ---- */

/* Scanner to head: the stage turns clockwise. */
static struct pose head_of(double front_rad)
{
	double s = sin(front_rad), c = cos(front_rad);
	return (struct pose){ { { c, -s, 0 }, { s, c, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } };
}

static void project(const struct board_desc *desc, const struct camera_calibration *lens,
	const struct pose *board, double front_rad, double (*ret)[2])
{
	struct pose head = head_of(front_rad), to_head = pose_compose(&head, board);
	for (uint32_t i = 0; i < desc->columns * desc->rows; i++) {
		double p[3] = { (i % desc->columns) * desc->square_m,
			(i / desc->columns) * desc->square_m, 0 };
		pose_apply(&to_head, p, p);
		ret[i][0] = ret[i][1] = 1e4;
		colour_project(lens, p, &ret[i][0], &ret[i][1]);
	}
}

/* ---- where the lidar saw it ---- */

/* How far it saw a board off, and tilted against, where it stands, in pixels: three residuals that say the same as all its beams.
 * Boards are not even to less than FLAT_M. */
static void plane_residuals(
	const struct bundle *b, guint i, const struct pose *board, double range_m, double ret[3])
{
	const struct board_plane *p = &g_array_index(b->planes, struct board_plane, i);
	double n[3] = { board->rotation[0][2], board->rotation[1][2], board->rotation[2][2] },
	       off = 0;
	double tilt[2] = { 0 }, scale = b->px_per_m;
	ret[0] = ret[1] = ret[2] = 0;
	if (p->beams == 0)
		return;
	if (p->beams > BEAMS_WORTH)
		scale *= sqrt(BEAMS_WORTH / p->beams);
	for (int k = 0; k < 3; k++) {
		off += n[k] * (p->mean_m[k] + range_m * p->along[k] - board->translation_m[k]);
		tilt[0] += n[k] * p->across[0][k];
		tilt[1] += n[k] * p->across[1][k];
	}
	ret[0] = scale * sqrt(p->beams) * off;
	for (int k = 0; k < 2; k++)
		ret[1 + k] = scale * sqrt(p->spread2_m2[k]) * tilt[k];
}

static double planes_error(const struct bundle *b, const GArray *boards, double range_m)
{
	double sum = 0, r[3];
	for (guint i = 0; b->planes && i < boards->len; i++) {
		plane_residuals(b, i, &g_array_index(boards, struct pose, i), range_m, r);
		sum += r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
	}
	return sum;
}

/* By differences, of the range offset and the board's pose. */
static void add_plane(const struct bundle *b, guint i, double *information, double *gradient)
{
	const struct pose *board = &g_array_index(b->boards, struct pose, i);
	double r[3], by[1 + BOARD_POSE][3];
	size_t at[1 + BOARD_POSE];
	plane_residuals(b, i, board, b->range_m, r);
	for (int u = 0; u < 1 + BOARD_POSE; u++) {
		double twist[BOARD_POSE] = { 0 }, step = 1e-6;
		if (u > 0)
			twist[u - 1] = step;
		struct pose moved = pose_perturb(board, twist);
		at[u] = u ? BOARD_UNKNOWNS + BOARD_POSE * i + u - 1 : BOARD_RANGE;
		plane_residuals(b, i, &moved, b->range_m + (u ? 0 : step), by[u]);
		for (int k = 0; k < 3; k++)
			by[u][k] = (by[u][k] - r[k]) / step;
	}
	for (int u = 0; u < 1 + BOARD_POSE; u++)
		for (int k = 0; k < 3; k++) {
			gradient[at[u]] -= by[u][k] * r[k];
			for (int v = 0; v < 1 + BOARD_POSE; v++)
				information[at[u] * b->unknowns + at[v]] += by[u][k] * by[v][k];
		}
}

static double error_of(const struct bundle *b, const struct camera_calibration *lens,
	const GArray *boards, double range_m)
{
	double(*shown)[2] = g_malloc_n(BOARD_CORNERS_MAX, sizeof *shown), sum = 0;
	uint32_t n = b->desc->columns * b->desc->rows;
	for (guint v = 0; v < b->views->len; v++) {
		const struct board_view *view = &g_array_index(b->views, struct board_view, v);
		project(b->desc, lens, &g_array_index(boards, struct pose, view->board),
			view->front_rad, shown);
		for (uint32_t i = 0; i < n; i++)
			for (int k = 0; k < 2; k++) {
				double off = fabs(view->corner[i][k] - shown[i][k]);
				sum += off < b->huber_px ? off * off
							 : b->huber_px * (2 * off - b->huber_px);
			}
	}
	g_free(shown);
	return sum + planes_error(b, boards, range_m);
}

/* ---- least squares ---- */

struct slopes {
	double (*shown)[2], (*moved)[BOARD_CORNERS_MAX][2];
};

/* By differences: of the camera's unknowns, then of the board's. */
static void differentiate(const struct bundle *b, const struct board_view *view, struct slopes *s)
{
	const struct pose *board = &g_array_index(b->boards, struct pose, view->board);
	project(b->desc, &b->camera, board, view->front_rad, s->shown);
	for (int i = 0; i < BOARD_UNKNOWNS + BOARD_POSE; i++) {
		struct camera_calibration lens = b->camera;
		struct pose moved = *board;
		double change[BOARD_UNKNOWNS] = { 0 }, twist[BOARD_POSE] = { 0 };
		double step = i < BOARD_UNKNOWNS ? small[i] : 1e-6;
		if (i < BOARD_UNKNOWNS)
			change[i] = step;
		else
			twist[i - BOARD_UNKNOWNS] = step;
		change_camera(&lens, change);
		moved = pose_perturb(&moved, twist);
		project(b->desc, &lens, &moved, view->front_rad, s->moved[i]);
		for (uint32_t k = 0; k < b->desc->columns * b->desc->rows; k++)
			for (int c = 0; c < 2; c++)
				s->moved[i][k][c] = (s->moved[i][k][c] - s->shown[k][c]) / step;
	}
}

static size_t index_of(const struct board_view *view, int i)
{
	return i < BOARD_UNKNOWNS
		       ? (size_t)i
		       : BOARD_UNKNOWNS + BOARD_POSE * view->board + (size_t)(i - BOARD_UNKNOWNS);
}

static void add_view(const struct bundle *b, const struct board_view *view, const struct slopes *s,
	double *information, double *gradient)
{
	const int n = BOARD_UNKNOWNS + BOARD_POSE;
	for (uint32_t k = 0; k < b->desc->columns * b->desc->rows; k++)
		for (int c = 0; c < 2; c++) {
			double off = view->corner[k][c] - s->shown[k][c];
			double weight = fabs(off) < b->huber_px ? 1 : b->huber_px / fabs(off);
			for (int i = 0; i < n; i++) {
				gradient[index_of(view, i)] += weight * s->moved[i][k][c] * off;
				for (int j = 0; j < n; j++)
					information[index_of(view, i) * b->unknowns +
						    index_of(view, j)] +=
						weight * s->moved[i][k][c] * s->moved[j][k][c];
			}
		}
}

static void sum_up(const struct bundle *b, double *information, double *gradient)
{
	struct slopes s = { g_malloc_n(BOARD_CORNERS_MAX, sizeof *s.shown),
		g_malloc_n(BOARD_UNKNOWNS + BOARD_POSE, sizeof *s.moved) };
	memset(information, 0, b->unknowns * b->unknowns * sizeof *information);
	memset(gradient, 0, b->unknowns * sizeof *gradient);
	for (guint v = 0; v < b->views->len; v++) {
		const struct board_view *view = &g_array_index(b->views, struct board_view, v);
		differentiate(b, view, &s);
		add_view(b, view, &s, information, gradient);
	}
	static const int gauge[] = { BOARD_TURN_Z, BOARD_Z, BOARD_RANGE };
	for (size_t i = 0; !b->planes && i < G_N_ELEMENTS(gauge); i++)
		information[(size_t)gauge[i] * (b->unknowns + 1)] += 1 / (GAUGE * GAUGE);
	for (guint i = 0; b->planes && i < b->boards->len; i++)
		add_plane(b, i, information, gradient);
	g_free(s.shown);
	g_free(s.moved);
}

static GArray *moved_boards(const struct bundle *b, const double *step)
{
	GArray *moved = g_array_copy(b->boards);
	for (guint i = 0; i < moved->len; i++) {
		struct pose *p = &g_array_index(moved, struct pose, i);
		*p = pose_perturb(p, step + BOARD_UNKNOWNS + BOARD_POSE * i);
	}
	return moved;
}

/* One step of Levenberg and Marquardt; false: nothing gets better. */
static bool step(struct bundle *b, double *damping, double *information, double *gradient)
{
	g_autofree double *damped = g_new(double, b->unknowns * b->unknowns),
			  *change = g_new(double, b->unknowns);
	double before = error_of(b, &b->camera, b->boards, b->range_m);
	sum_up(b, information, gradient);
	for (; *damping < 1e6; *damping *= 10) {
		struct camera_calibration lens = b->camera;
		memcpy(damped, information, b->unknowns * b->unknowns * sizeof *damped);
		for (size_t i = 0; i < b->unknowns; i++)
			damped[i * (b->unknowns + 1)] *= 1 + *damping;
		if (!normal_equations_solve(damped, gradient, b->unknowns, change, NULL))
			continue;
		change_camera(&lens, change);
		g_autoptr(GArray) boards = moved_boards(b, change);
		double after = error_of(b, &lens, boards, b->range_m + change[BOARD_RANGE]);
		if (!(after < before))
			continue;
		b->camera = lens;
		b->range_m += change[BOARD_RANGE];
		g_array_unref(b->boards);
		b->boards = g_steal_pointer(&boards);
		*damping /= 10;
		return before - after > 1e-9 * before;
	}
	return false;
}

static int by_size(gconstpointer a, gconstpointer b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* By how far most corners are off: one beside the picture's edge or behind a pole is not to pull at all the others. */
static double huber_px(const struct bundle *b)
{
	g_autoptr(GArray) all = g_array_new(FALSE, FALSE, sizeof(double));
	double(*shown)[2] = g_malloc_n(BOARD_CORNERS_MAX, sizeof *shown);
	for (guint v = 0; v < b->views->len; v++) {
		const struct board_view *view = &g_array_index(b->views, struct board_view, v);
		project(b->desc, &b->camera, &g_array_index(b->boards, struct pose, view->board),
			view->front_rad, shown);
		for (uint32_t i = 0; i < 2 * b->desc->columns * b->desc->rows; i++) {
			double off = fabs(view->corner[i / 2][i % 2] - shown[i / 2][i % 2]);
			g_array_append_val(all, off);
		}
	}
	g_free(shown);
	g_array_sort(all, by_size);
	double median = all->len ? g_array_index(all, double, all->len / 2) : 0;
	return CLAMP(HUBER_MEDIANS * median, HUBER_LEAST_PX, HUBER_FIRST_PX);
}

static bool solve(struct bundle *b, struct board_result *ret)
{
	b->unknowns = BOARD_UNKNOWNS + BOARD_POSE * (size_t)b->boards->len;
	size_t square = b->unknowns * b->unknowns;
	g_autofree double *information = g_new(double, square),
			  *gradient = g_new(double, b->unknowns),
			  *covariance = g_new(double, square), *change = g_new(double, b->unknowns);
	double damping = 1e-3, corners = 2.0 * b->desc->columns * b->desc->rows * b->views->len;
	for (int i = 0; i < STEPS_MAX && step(b, &damping, information, gradient); i++)
		;
	b->huber_px = huber_px(b);
	damping = 1e-3;
	for (int i = 0; i < STEPS_MAX && step(b, &damping, information, gradient); i++)
		;
	sum_up(b, information, gradient);
	double variance =
		error_of(b, &b->camera, b->boards, b->range_m) / (corners - (double)b->unknowns);
	if (!normal_equations_solve(information, gradient, b->unknowns, change, covariance))
		return false;
	for (int i = 0; i < BOARD_UNKNOWNS; i++)
		ret->deviation[i] = sqrt(variance * covariance[(size_t)i * (b->unknowns + 1)]);
	ret->rms_px = sqrt(error_of(b, &b->camera, b->boards, b->range_m) / (corners / 2));
	return true;
}

/* ---- which board is which ---- */

/* Camera to scanner, as it stood for a photo. */
static struct pose camera_pose(const struct camera_calibration *c, double front_rad)
{
	struct pose body, head = head_of(front_rad), out = pose_inverse(&head);
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			body.rotation[i][j] = c->rotation[j][i];
		body.translation_m[i] = c->translation_m[i];
	}
	return pose_compose(&out, &body);
}

static bool pose_of_view(const struct bundle *b, const struct camera_calibration *c,
	const struct board_view *view, struct pose *ret)
{
	struct pose seen, at = camera_pose(c, view->front_rad);
	if (!boards_pose(c, b->desc, view, &seen))
		return false;
	*ret = pose_compose(&at, &seen);
	return true;
}

/* Each view belongs to the board that stands there, or to a new one. */
static void name_boards(struct bundle *b)
{
	for (guint v = b->views->len; v-- > 0;) {
		struct board_view *view = &g_array_index(b->views, struct board_view, v);
		struct pose pose;
		if (!pose_of_view(b, &b->camera, view, &pose)) {
			g_array_remove_index_fast(b->views, v);
			continue;
		}
		for (view->board = 0; view->board < b->boards->len; view->board++) {
			struct pose between = pose_between(
				&g_array_index(b->boards, struct pose, view->board), &pose);
			if (pose_distance_m(&between) < TOGETHER_M)
				break;
		}
		if (view->board == b->boards->len)
			g_array_append_val(b->boards, pose);
	}
}

static bool find_views(const struct faces *f, struct bundle *b, faces_progress progress,
	gpointer user_data, struct board_result *ret, GError **error)
{
	for (guint i = 0; i < f->photos->len; i++) {
		guint before = b->views->len;
		if (progress && progress((double)i / f->photos->len, user_data)) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
			return false;
		}
		if (!boards_find(
			    &g_array_index(f->photos, struct photo, i), b->desc, b->views, error))
			return false;
		ret->photos += b->views->len > before;
	}
	return true;
}

static bool refuse(GError **error, const struct board_result *r)
{
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
		"a checkerboard is seen in %u photos of %u views: it has to be seen at %u angles "
		"of the head at least",
		r->photos, r->views, BOARD_ANGLES_MIN);
	return false;
}

static double rms_of(const struct bundle *b)
{
	return sqrt(error_of(b, &b->camera, b->boards, b->range_m) /
		    (b->desc->columns * b->desc->rows * b->views->len));
}

static bool calibrate(struct bundle *b, struct board_result *ret, GError **error)
{
	double rms_px;
	ret->first_rms_px = rms_of(b);
	if (!boards_intrinsics(b->desc, b->views, &b->camera, &rms_px, error))
		return false;
	g_array_set_size(b->boards, 0);
	name_boards(b);
	if (solve(b, ret))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
		"the checkerboards do not tell all of the camera");
	return false;
}

/* Once more, with what the lidar saw of the boards. */
static bool solve_with_lidar(const struct faces *f, struct bundle *b,
	const struct two_face_result *lidar, struct board_result *ret, GError **error)
{
	g_autoptr(GArray) planes = g_array_new(FALSE, FALSE, sizeof(struct board_plane));
	ret->camera = b->camera;
	board_lidar_meet(f, b->desc, b->boards, lidar, ret, planes);
	if (!ret->met)
		return true;
	b->camera = ret->camera;
	b->planes = planes;
	b->px_per_m = ret->rms_px / sqrt(2) / ret->plane_rms_m;
	if (!solve(b, ret)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"the checkerboards do not tell all of the camera");
		return false;
	}
	b->planes = NULL;
	ret->rms_px = rms_of(b);
	ret->camera = b->camera;
	ret->range_offset_m += b->range_m;
	ret->range_deviation_m = ret->deviation[BOARD_RANGE];
	return true;
}

bool board_camera_solve(const struct faces *f, const struct board_desc *desc,
	const struct two_face_result *lidar, faces_progress progress, gpointer user_data,
	struct board_result *ret, GError **error)
{
	g_autoptr(GArray) views = g_array_new(FALSE, FALSE, sizeof(struct board_view));
	struct bundle b = { .desc = desc,
		.views = views,
		.camera = f->calibration.camera,
		.huber_px = HUBER_FIRST_PX };
	*ret = (struct board_result){ .camera = b.camera };
	if (!f->calibration.has_camera || !find_views(f, &b, progress, user_data, ret, error))
		return !f->calibration.has_camera;
	b.boards = g_array_new(FALSE, FALSE, sizeof(struct pose));
	name_boards(&b);
	ret->views = views->len;
	bool good = ret->photos >= BOARD_ANGLES_MIN ? calibrate(&b, ret, error)
						    : ret->photos == 0 || refuse(error, ret);
	ret->boards = b.boards->len;
	ret->camera = b.camera;
	good = good && (!ret->boards || solve_with_lidar(f, &b, lidar, ret, error));
	g_array_unref(b.boards);
	return good;
}
